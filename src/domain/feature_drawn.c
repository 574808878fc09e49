/* Points and lines as the user gives them: copies, in input coordinates, checked as far as they can be without a domain. */
#include <string.h>

#include "domain/features.h"
#include "io/read_lines.h"

/* Of points, of vertices of lines, and of lines: indices have 32 bits, and lines are cut into pieces later. */
static const size_t count_max = (size_t)1 << 27;

laves_result laves_features_create(laves_context *context, laves_features **features, laves_error *error) {
  *features = laves__alloc_zeroed(context, 1, sizeof **features);
  if (!*features) return laves__fail_memory(context, error);
  (*features)->context = context;
  return LAVES_OK;
}

void laves_features_free(laves_features *f) {
  if (!f) return;
  laves_context *context = f->context;
  laves__free(context, f->point, f->point_capacity, sizeof *f->point);
  laves__free(context, f->vertex, f->vertex_capacity, sizeof *f->vertex);
  laves__free(context, f->line_end, f->line_capacity, sizeof *f->line_end);
  laves__free(context, f, 1, sizeof *f);
}

static laves_result check(const double *points, size_t count, size_t there, const char *what, laves_error *error) {
  if (count > count_max - there)
    return laves__fail(error, LAVES_ERROR_OPTION, "%zu %s are drawn; at most %zu can be", there + count, what, count_max);
  for (size_t i = 0; i < 3 * count; i++)
    if (!isfinite(points[i]))
      return laves__fail(error, LAVES_ERROR_OPTION, "point %zu of the %s to keep is not finite", i / 3, what);
  return LAVES_OK;
}

/* Room for `count` more points and vertices and one more line, so that what follows cannot fail. */
static laves_result make_room(laves_features *f, size_t points, size_t vertices, size_t lines, laves_error *error) {
  laves_context *c = f->context;
  const bool enough = laves__grow(c, &f->point, &f->point_capacity, f->point_count + points, sizeof *f->point) &&
                      laves__grow(c, &f->vertex, &f->vertex_capacity, f->vertex_count + vertices, sizeof *f->vertex) &&
                      laves__grow(c, &f->line_end, &f->line_capacity, f->line_count + lines, sizeof *f->line_end);
  return enough ? LAVES_OK : laves__fail_memory(c, error);
}

laves_result laves_features_add_points(laves_features *f, const double *points, size_t count, laves_error *error) {
  laves_result result = check(points, count, f->point_count, "points", error);
  if (result == LAVES_OK) result = make_room(f, count, 0, 0, error);
  if (result != LAVES_OK) return result;
  for (size_t i = 0; i < count; i++) f->point[f->point_count++] = v3(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
  return LAVES_OK;
}

laves_result laves_features_add_line(laves_features *f, const double *points, size_t count, laves_error *error) {
  if (count < 2)
    return laves__fail(error, LAVES_ERROR_OPTION, "a line to keep has %zu points; give two or more, or add it as a point", count);
  laves_result result = check(points, count, f->vertex_count, "lines", error);
  if (result == LAVES_OK) result = make_room(f, 0, count, 1, error);
  if (result != LAVES_OK) return result;
  for (size_t i = 0; i < count; i++) f->vertex[f->vertex_count++] = v3(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
  f->line_end[f->line_count++] = f->vertex_count;
  return LAVES_OK;
}

/* All of a file, or nothing. */
static laves_result add_lines(laves_features *f, const laves__lines *lines, const char *path, laves_error *error) {
  const laves__line_list *list = &lines->list;
  if (list->single_count > count_max - f->point_count || list->node_count > count_max - f->vertex_count)
    return laves__fail(error, LAVES_ERROR_INPUT, "%s: more than %zu points are drawn", path, count_max);
  const laves_result result = make_room(f, list->single_count, list->node_count, list->line_count, error);
  if (result != LAVES_OK) return result;
  for (size_t i = 0; i < list->single_count; i++) f->point[f->point_count++] = lines->points[list->single[i]];
  const size_t base = f->vertex_count;
  for (size_t i = 0; i < list->node_count; i++) f->vertex[f->vertex_count++] = lines->points[list->node[i]];
  for (size_t i = 0; i < list->line_count; i++) f->line_end[f->line_count++] = base + list->line_end[i];
  return LAVES_OK;
}

laves_result laves_features_add_file(laves_features *features, const char *path, laves_error *error) {
  laves__lines lines;
  laves__progress_reset(features->context);
  laves_result result = laves__lines_read(features->context, path, &lines, error);
  if (result == LAVES_OK) result = add_lines(features, &lines, path, error);
  laves__lines_free(&lines);
  return result;
}
