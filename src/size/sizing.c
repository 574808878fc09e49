/* The list of sources of sizes, as the caller gives them.
 *
 * In: texts, files, points, names.  Out: copies of them, checked as far as they can be without a domain: scripts are run once
 * to find what is wrong with them, backgrounds are read. Each is bound to a domain by laves__size_create(). */
#include "size/sizing.h"

#include <string.h>

#include "domain/script.h"
#include "io/file.h"
#include "io/read_lines.h"

laves_result laves_sizing_create(laves_context *context, laves_sizing **sizing, laves_error *error) {
  *sizing = laves__alloc_zeroed(context, 1, sizeof **sizing);
  if (!*sizing) return laves__fail_memory(context, error);
  (*sizing)->context = context;
  return LAVES_OK;
}

static void free_text(laves_context *context, char *text, size_t length) {
  if (text) laves__free(context, text, length + 1, 1);
}

static void free_source(laves_context *context, laves__source *s) {
  free_text(context, s->text, s->text_length);
  free_text(context, s->name, s->name_length);
  free_text(context, s->folder, s->folder_length);
  laves__background_free(s->background);
  laves__free(context, s->points, s->point_count, sizeof *s->points);
}

void laves_sizing_free(laves_sizing *sizing) {
  if (!sizing) return;
  laves_context *context = sizing->context;
  for (size_t i = 0; i < sizing->count; i++) free_source(context, &sizing->sources[i]);
  laves__free(context, sizing->sources, sizing->capacity, sizeof *sizing->sources);
  laves__free(context, sizing, 1, sizeof *sizing);
}

/* Takes the source over, whatever the result. */
static laves_result add(laves_sizing *sizing, laves__source *source, laves_result result, laves_error *error) {
  laves_context *context = sizing->context;
  if (result == LAVES_OK &&
      !laves__grow(context, &sizing->sources, &sizing->capacity, sizing->count + 1, sizeof *sizing->sources))
    result = laves__fail_memory(context, error);
  if (result == LAVES_OK)
    sizing->sources[sizing->count++] = *source;
  else
    free_source(context, source);
  return result;
}

static laves_result copy_text(laves_context *context, const char *text, size_t length, char **copy, size_t *copy_length,
                              laves_error *error) {
  *copy = laves__alloc(context, length + 1, 1);
  if (!*copy) return laves__fail_memory(context, error);
  memcpy(*copy, text, length);
  (*copy)[length] = '\0';
  *copy_length = length;
  return LAVES_OK;
}

/* ---- scripts ---- */

/* The field is made anew for each domain; here it only has to be one. */
static laves_result try_script(laves_context *context, const laves__source *s, laves_error *error) {
  laves__model model;
  laves__progress_reset(context);
  const laves_result result =
      laves__script_run_size(context, s->text, s->text_length, s->is_expression, s->name, s->folder, &model, error);
  laves__model_free(context, &model);
  return result;
}

laves_result laves_sizing_add_expression(laves_sizing *sizing, const char *text, laves_error *error) {
  static const char name[] = "size field";
  laves_context *context = sizing->context;
  laves__source s = {.kind = LAVES__SOURCE_SCRIPT, .is_expression = true};
  laves_result result = copy_text(context, text, strlen(text), &s.text, &s.text_length, error);
  if (result == LAVES_OK) result = copy_text(context, name, sizeof name - 1, &s.name, &s.name_length, error);
  if (result == LAVES_OK) result = try_script(context, &s, error);
  return add(sizing, &s, result, error);
}

laves_result laves_sizing_add_script(laves_sizing *sizing, const char *path, laves_error *error) {
  laves_context *context = sizing->context;
  laves__source s = {.kind = LAVES__SOURCE_SCRIPT};
  const char *slash = strrchr(path, '/');
  laves__progress_reset(context);
  laves_result result = laves__input_read(context, path, &s.text, &s.text_length, error);
  if (result == LAVES_OK) result = copy_text(context, path, strlen(path), &s.name, &s.name_length, error);
  if (result == LAVES_OK && slash)
    result = copy_text(context, path, (size_t)(slash - path) + (slash == path), &s.folder, &s.folder_length, error);
  if (result == LAVES_OK) result = try_script(context, &s, error);
  return add(sizing, &s, result, error);
}

laves_result laves_sizing_add_background(laves_sizing *sizing, const char *path, const char *array_name, laves_error *error) {
  laves_context *context = sizing->context;
  laves__source s = {.kind = LAVES__SOURCE_BACKGROUND};
  laves__progress_reset(context);
  laves_result result = copy_text(context, path, strlen(path), &s.name, &s.name_length, error);
  if (result == LAVES_OK) result = laves__background_load(context, path, array_name, &s.background, error);
  return add(sizing, &s, result, error);
}

/* ---- places ---- */

static laves_result check_place(double size, double radius, laves_error *error) {
  if (!(size > 0) || !isfinite(size))
    return laves__fail(error, LAVES_ERROR_OPTION, "the size to refine to is %g but must be a positive number", size);
  if (!(radius >= 0) || !isfinite(radius))
    return laves__fail(error, LAVES_ERROR_OPTION, "the radius to refine in is %g but must be zero or a positive number", radius);
  return LAVES_OK;
}

static laves_result copy_points(laves_context *context, const double *points, size_t count, laves__source *s,
                                laves_error *error) {
  for (size_t i = 0; i < 3 * count; i++)
    if (!isfinite(points[i]))
      return laves__fail(error, LAVES_ERROR_OPTION, "point %zu of those to refine near is not finite", i / 3);
  s->points = laves__alloc(context, count, sizeof *s->points);
  if (!s->points) return laves__fail_memory(context, error);
  s->point_count = count;
  memcpy(s->points, points, count * sizeof *s->points);
  return LAVES_OK;
}

static laves_result add_place(laves_sizing *sizing, laves__source_kind kind, const double *points, size_t count, double size,
                              double radius, laves_error *error) {
  static const size_t count_max = (size_t)1 << 27; /* the tree counts in 28 bits */
  laves__source s = {.kind = kind, .size = size, .radius = radius};
  laves_result result = check_place(size, radius, error);
  if (result == LAVES_OK && (count == 0 || count > count_max))
    result = laves__fail(error, LAVES_ERROR_OPTION, "%zu points to refine near are given; give 1 to %zu", count, count_max);
  if (result == LAVES_OK) result = copy_points(sizing->context, points, count, &s, error);
  return add(sizing, &s, result, error);
}

laves_result laves_sizing_add_points(laves_sizing *sizing, const double *points, size_t count, double size, double radius,
                                     laves_error *error) {
  return add_place(sizing, LAVES__SOURCE_POINTS, points, count, size, radius, error);
}

laves_result laves_sizing_add_curve(laves_sizing *sizing, const double *points, size_t count, double size, double radius,
                                    laves_error *error) {
  return add_place(sizing, LAVES__SOURCE_CURVE, points, count, size, radius, error);
}

/* Points that stand alone are one source, each polyline is one. */
static laves_result add_lines(laves_sizing *sizing, const laves__lines *lines, double size, double radius, laves_error *error) {
  const laves__line_list *list = &lines->list;
  const size_t most = list->single_count > list->node_count ? list->single_count : list->node_count;
  laves__vec3 *points = laves__alloc(sizing->context, most, sizeof *points);
  if (!points) return laves__fail_memory(sizing->context, error);
  laves_result result = LAVES_OK;
  for (size_t i = 0; i < list->single_count; i++) points[i] = lines->points[list->single[i]];
  if (list->single_count) result = laves_sizing_add_points(sizing, &points->x, list->single_count, size, radius, error);
  for (size_t i = 0; i < list->node_count; i++) points[i] = lines->points[list->node[i]];
  for (size_t i = 0; i < list->line_count && result == LAVES_OK; i++) {
    const size_t first = laves__line_list_first(list, i);
    result = laves_sizing_add_curve(sizing, &points[first].x, list->line_end[i] - first, size, radius, error);
  }
  laves__free(sizing->context, points, most, sizeof *points);
  return result;
}

laves_result laves_sizing_add_curve_file(laves_sizing *sizing, const char *path, double size, double radius, laves_error *error) {
  laves__lines lines;
  const size_t before = sizing->count;
  laves__progress_reset(sizing->context);
  laves_result result = laves__lines_read(sizing->context, path, &lines, error);
  if (result == LAVES_OK) result = add_lines(sizing, &lines, size, radius, error);
  laves__lines_free(&lines);
  while (result != LAVES_OK && sizing->count > before) free_source(sizing->context, &sizing->sources[--sizing->count]);
  return result;
}

laves_result laves_sizing_add_tag(laves_sizing *sizing, const char *name, double size, double radius, laves_error *error) {
  laves__source s = {.kind = LAVES__SOURCE_TAG, .size = size, .radius = radius};
  laves_result result = check_place(size, radius, error);
  if (result == LAVES_OK) result = copy_text(sizing->context, name, strlen(name), &s.text, &s.text_length, error);
  return add(sizing, &s, result, error);
}
