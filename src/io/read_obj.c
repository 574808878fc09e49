/* OBJ, the polygons of Wavefront's Advanced Visualizer (file format in its manual, appendix B1).
 *
 * Used: `v x y z` (what follows, a weight or a colour, is ignored), `f` with corners `v`, `v/vt`, `v//vn`, `v/vt/vn`,
 * negative indices counting back from the latest vertex, `\` at the end of a line. All other lines are passed over.
 *
 * Tags: a face belongs to the latest `g` or `o`. When these tell nothing apart (all faces in one, or none given) and there
 * are materials, the latest `usemtl` is its tag instead. */
#include <string.h>

#include "io/surface_build.h"

/* The lines that OBJ files consist of; those that begin with one decide that a file is an OBJ. */
static bool is_obj_keyword(laves__word word) {
  static const char *const WORDS[] = {"v", "vt", "vn", "vp", "f", "g", "o", "s", "l", "p", "mtllib", "usemtl", "cstype", "deg"};
  for (size_t i = 0; i < LAVES__COUNT_OF(WORDS); ++i) {
    if (laves__word_is(word, WORDS[i])) return true;
  }
  return false;
}

bool laves__is_obj(laves__scan scan) {
  laves__word word;
  scan.comment = '#';
  scan.continuation = true;
  return laves__scan_space(&scan) && laves__scan_word(&scan, &word) && is_obj_keyword(word);
}

static laves_result read_vertex(laves__surface_build *build) {
  double x[3];
  for (int i = 0; i < 3; ++i) {
    if (!laves__scan_double(&build->scan, &x[i])) {
      return laves__scan_fail_expected(&build->scan, build->error, "a coordinate (a finite number)");
    }
  }
  return laves__build_point(build, x[0], x[1], x[2]);
}

/* One corner, of which the scan is at the first character. */
static laves_result read_corner(laves__surface_build *build) {
  laves__scan *scan = &build->scan;
  int64_t index;
  const char *stop = laves__parse_int(scan->at, scan->end, &index);
  if (stop == NULL || index == 0) {
    return laves__scan_fail_expected(scan, build->error, "the index of a vertex (1, 2, ... or -1, -2, ...)");
  }
  const int64_t count = (int64_t)build->input->point_count;
  if (index < -count) {
    return laves__build_fail(build, "face %zu uses vertex %lld, but only %lld stand before it", build->face_count,
                             (long long)index, (long long)count);
  }
  const laves_result result = laves__build_corner(build, index < 0 ? count + index : index - 1);
  if (result != LAVES_OK) return result;
  laves__word rest;
  scan->at = stop;
  if (stop < scan->end && *stop == '/') {
    laves__scan_word(scan, &rest);
  } else if (laves__scan_blanks(scan) && scan->at == stop) {
    return laves__scan_fail_expected(scan, build->error, "a space or '/' behind the index of a vertex");
  }
  return LAVES_OK;
}

static laves_result read_face(laves__surface_build *build) {
  laves_result result = LAVES_OK;
  laves__build_face(build);
  while (result == LAVES_OK && laves__scan_blanks(&build->scan)) {
    result = read_corner(build);
  }
  return result == LAVES_OK ? laves__build_face_end(build) : result;
}

static laves_result read_material(laves__surface_build *build, laves__tag_list *materials) {
  const laves__word name = laves__scan_rest(&build->scan);
  const bool started =
      laves__tag_list_start(build->context, materials, name.at, name.length, build->input->triangle_count, "none");
  return started ? LAVES_OK : laves__fail_memory(build->context, build->error);
}

/* The line at the place, which is not empty. */
static laves_result read_line(laves__surface_build *build, laves__tag_list *materials) {
  laves__word word;
  if (!laves__scan_word(&build->scan, &word)) return LAVES_OK;
  if (word.length == 1) {
    switch (*word.at) {
      case 'v':
        return read_vertex(build);
      case 'f':
        return read_face(build);
      case 'g':
      case 'o': {
        const laves__word name = laves__scan_rest(&build->scan);
        return laves__build_tag(build, name.length > 0 ? name : (laves__word){"default", 7}, "default");
      }
      default:
        return LAVES_OK;
    }
  }
  return laves__word_is(word, "usemtl") ? read_material(build, materials) : LAVES_OK;
}

/* Puts the materials in the place of the groups when they tell more. */
static laves_result choose_tags(laves__surface_build *build, laves__tag_list *materials) {
  const size_t triangle_count = build->input->triangle_count;
  if (materials->count == 0) return LAVES_OK;
  if (!laves__tag_list_end(build->context, &build->tags, triangle_count) ||
      !laves__tag_list_end(build->context, materials, triangle_count)) {
    return laves__fail_memory(build->context, build->error);
  }
  if (laves__tag_list_variety(materials) > laves__tag_list_variety(&build->tags)) {
    const laves__tag_list groups = build->tags;
    build->tags = *materials;
    *materials = groups;
  }
  return LAVES_OK;
}

laves_result laves__read_obj(laves__surface_build *build) {
  laves__scan *scan = &build->scan;
  laves__tag_list materials = {0};
  laves_result result = LAVES_OK;
  strcpy(build->input->format, "OBJ");
  scan->comment = '#';
  scan->continuation = true;
  while (result == LAVES_OK && laves__scan_space(scan)) {
    result = read_line(build, &materials);
    laves__scan_next_line(scan);
  }
  if (result == LAVES_OK) result = choose_tags(build, &materials);
  laves__tag_list_free(build->context, &materials);
  return result;
}
