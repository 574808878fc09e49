/* Growing a surface while a file is read.  Corners are checked against the number of points at the end, because formats
 * may give faces first; the place of the highest index is kept, and that one is the culprit if there is any. */
#include "io/surface_build.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Points or faces between two looks at the caller's wish to cancel: about a millisecond of reading. */
enum { PROGRESS_MASK = 0x3FFF };

static laves_result report_progress(const laves__surface_build *build) {
  const laves__scan *scan = &build->scan;
  const double fraction = (double)(scan->at - scan->begin) / (double)(scan->end - scan->begin);
  return laves__cancelled(build->context, "read", fraction) ? laves__fail_cancelled(build->error) : LAVES_OK;
}

static laves_result grow_points(laves__surface_build *build, size_t needed) {
  laves__surface_input *input = build->input;
  if (needed > UINT32_MAX) {
    return laves__build_fail(build, "more than 4294967295 points; the surface is too large");
  }
  const bool grown = laves__grow(build->context, &input->points, &input->point_capacity, needed, sizeof *input->points);
  return grown ? LAVES_OK : laves__fail_memory(build->context, build->error);
}

static laves_result grow_triangles(laves__surface_build *build, size_t needed) {
  laves__surface_input *input = build->input;
  const bool grown = laves__grow(build->context, &input->triangles, &input->triangle_capacity, needed, sizeof *input->triangles);
  return grown ? LAVES_OK : laves__fail_memory(build->context, build->error);
}

laves_result laves__build_point(laves__surface_build *build, double x, double y, double z) {
  laves__surface_input *input = build->input;
  if (input->point_count == input->point_capacity) {
    const laves_result result = grow_points(build, input->point_count + 1);
    if (result != LAVES_OK) return result;
  }
  LAVES_ASSERT(v3_finite(v3(x, y, z)));
  input->points[input->point_count++] = v3(x, y, z);
  return (input->point_count & PROGRESS_MASK) == 0 ? report_progress(build) : LAVES_OK;
}

void laves__build_face(laves__surface_build *build) {
  build->corner_count = 0;
  ++build->face_count;
}

/* Notes the face of the newest triangle. Until a face is more than a triangle there is nothing to note. */
static laves_result note_source(laves__surface_build *build) {
  const size_t count = build->input->triangle_count;
  if (!build->sources && build->corner_count == 2) return LAVES_OK;
  const bool first = !build->sources;
  if (!laves__grow(build->context, &build->sources, &build->source_capacity, count, sizeof *build->sources)) {
    return laves__fail_memory(build->context, build->error);
  }
  for (size_t i = 0; first && i + 1 < count; ++i) build->sources[i] = (uint32_t)i;
  build->sources[count - 1] = (uint32_t)(build->face_count - 1);
  return LAVES_OK;
}

laves_result laves__build_corner(laves__surface_build *build, int64_t index) {
  laves__surface_input *input = build->input;
  if (index < 0 || index >= UINT32_MAX) {
    return laves__build_fail(build, "face %zu uses point %lld (from 0), which cannot be", build->face_count, (long long)index);
  }
  const uint32_t corner = (uint32_t)index;
  if (corner > build->highest || build->highest_at == NULL) {
    build->highest = corner;
    build->highest_at = build->scan.at;
    build->highest_face = build->face_count;
  }
  if (build->corner_count >= 2) {
    if (input->triangle_count == input->triangle_capacity) {
      const laves_result result = grow_triangles(build, input->triangle_count + 1);
      if (result != LAVES_OK) return result;
    }
    uint32_t *triangle = input->triangles[input->triangle_count++];
    triangle[0] = build->fan[0];
    triangle[1] = build->fan[1];
    triangle[2] = corner;
    const laves_result noted = note_source(build);
    if (noted != LAVES_OK) return noted;
  }
  build->fan[build->corner_count > 0] = corner;
  ++build->corner_count;
  return LAVES_OK;
}

laves_result laves__build_face_end(laves__surface_build *build) {
  if (build->corner_count < 3) {
    return laves__build_fail(build, "face %zu has %zu corners; at least 3 are needed", build->face_count, build->corner_count);
  }
  return (build->face_count & PROGRESS_MASK) == 0 ? report_progress(build) : LAVES_OK;
}

laves_result laves__build_tag(laves__surface_build *build, laves__word name, const char *before) {
  const bool started =
      laves__tag_list_start(build->context, &build->tags, name.at, name.length, build->input->triangle_count, before);
  return started ? LAVES_OK : laves__fail_memory(build->context, build->error);
}

/* Makes a growing array exactly `count` items long, which may be fewer than its capacity. */
static bool fit(laves_context *context, void *block, size_t *capacity, size_t count, size_t size) {
  void *old;
  memcpy(&old, block, sizeof old);
  void *fitted = laves__realloc(context, old, *capacity, count, size);
  if (fitted == NULL) return false;
  memcpy(block, &fitted, sizeof fitted);
  *capacity = count;
  return true;
}

/* Makes points and triangles exactly so many. */
static laves_result fit_all(laves__surface_build *build, size_t point_count, size_t triangle_count) {
  laves__surface_input *input = build->input;
  const bool fitted = fit(build->context, &input->points, &input->point_capacity, point_count, sizeof *input->points) &&
                      fit(build->context, &input->triangles, &input->triangle_capacity, triangle_count, sizeof *input->triangles);
  return fitted ? LAVES_OK : laves__fail_memory(build->context, build->error);
}

laves_result laves__build_reserve(laves__surface_build *build, uint64_t point_count, size_t point_bytes, uint64_t face_count,
                                  size_t face_bytes) {
  const laves__surface_input *input = build->input;
  const size_t left = laves__build_left(build);
  size_t points = input->point_count + (size_t)(point_count < left / point_bytes ? point_count : left / point_bytes);
  const size_t faces = input->triangle_count + (size_t)(face_count < left / face_bytes ? face_count : left / face_bytes);
  points = points < UINT32_MAX ? points : UINT32_MAX;  // more are refused when they come
  return fit_all(build, points > input->point_capacity ? points : input->point_capacity,
                 faces > input->triangle_capacity ? faces : input->triangle_capacity);
}

size_t laves__build_left(const laves__surface_build *build) { return (size_t)(build->scan.end - build->scan.at); }

laves_result laves__build_fail(const laves__surface_build *build, const char *format, ...) {
  char sentence[400];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(sentence, sizeof sentence, format, arguments);
  va_end(arguments);
  const laves__scan *scan = &build->scan;
  if (!build->binary) {
    return laves__scan_fail(scan, build->error, "%s", sentence);
  }
  return laves__fail(build->error, LAVES_ERROR_INPUT, "%s%sbyte %zu: %s", scan->name ? scan->name : "", scan->name ? ", " : "",
                     (size_t)(scan->at - scan->begin), sentence);
}

/* ---- the end ---- */

static laves_result check_all(laves__surface_build *build) {
  const laves__surface_input *input = build->input;
  const char *name = build->scan.name;
  if (input->triangle_count == 0) {
    return laves__fail(build->error, LAVES_ERROR_INPUT, "%s%sthe %s file has no faces, so it bounds no solid", name ? name : "",
                       name ? ": " : "", input->format);
  }
  if (build->highest_at != NULL && build->highest >= input->point_count) {
    build->scan.at = build->highest_at;
    return laves__build_fail(build, "face %zu uses point %zu of %zu (counted from 1)", build->highest_face,
                             (size_t)build->highest + 1, input->point_count);
  }
  return LAVES_OK;
}

/* Moves the tags from the list to the input, in the sizes that the input promises. */
static laves_result hand_over_tags(laves__surface_build *build) {
  laves__surface_input *input = build->input;
  laves__tag_list *list = &build->tags;
  if (list->count == 0) return LAVES_OK;
  if (!laves__tag_list_end(build->context, list, input->triangle_count) ||
      !fit(build->context, &list->tags, &list->tag_capacity, input->triangle_capacity, sizeof *list->tags) ||
      !fit(build->context, &list->names, &list->capacity, list->count, sizeof *list->names)) {
    return laves__fail_memory(build->context, build->error);
  }
  input->tags = list->tags;
  input->tag_names = list->names;
  input->tag_count = (int)list->count;
  list->tags = NULL;
  list->names = NULL;
  list->tag_capacity = list->capacity = list->count = 0;
  return LAVES_OK;
}

static laves_result hand_over_sources(laves__surface_build *build) {
  laves__surface_input *input = build->input;
  if (build->sources == NULL) return LAVES_OK;
  if (!fit(build->context, &build->sources, &build->source_capacity, input->triangle_capacity, sizeof *build->sources)) {
    return laves__fail_memory(build->context, build->error);
  }
  input->sources = build->sources;
  build->sources = NULL;
  build->source_capacity = 0;
  return LAVES_OK;
}

laves_result laves__build_finish(laves__surface_build *build, laves_result result) {
  if (result == LAVES_OK) result = check_all(build);
  if (result == LAVES_OK) result = fit_all(build, build->input->point_count, build->input->triangle_count);
  if (result == LAVES_OK) result = hand_over_tags(build);
  if (result == LAVES_OK) result = hand_over_sources(build);
  laves__free(build->context, build->sources, build->source_capacity, sizeof *build->sources);
  laves__tag_list_free(build->context, &build->tags);
  if (result != LAVES_OK) laves__surface_input_free(build->context, build->input);
  return result;
}
