/* Reading points and polylines: finds the format from the content, calls its reader, checks, and joins what is loose.
 *
 * In: the bytes of a file.  Out: its points, and polylines by indices into them.
 *
 * laves' own text has nothing by which to know it but that it starts with a number, behind comments; so it comes last. */
#include "io/read_lines.h"

#include <string.h>

#include "io/file.h"

typedef laves_result read_fn(laves__mesh_input *input, laves_error *error);

static bool starts_number(char c) { return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.'; }

/* Whether the first word behind comments is one of OBJ's. */
static bool is_obj(laves__scan scan) {
  static const char *const words[] = {"v", "vt", "vn", "vp", "p", "l", "f", "g", "o", "s", "mtllib", "usemtl"};
  laves__word word;
  if (!laves__scan_word(&scan, &word)) return false;
  for (size_t i = 0; i < LAVES__COUNT_OF(words); i++)
    if (laves__word_is(word, words[i])) return true;
  return false;
}

static read_fn *find_reader(const laves__mesh_input *input) {
  static const char vtk[] = "# vtk DataFile";
  laves__scan scan = laves__scan_begin(input->name, input->begin, (size_t)(input->end - input->begin));
  if ((size_t)(scan.end - scan.at) >= sizeof vtk - 1 && memcmp(scan.at, vtk, sizeof vtk - 1) == 0) return laves__read_lines_vtk;
  scan.comment = '#';
  if (!laves__scan_space(&scan)) return NULL;
  if (*scan.at == '<') return laves__read_vtu;
  if (*scan.at == '$') return laves__read_gmsh;
  if (starts_number(*scan.at)) return laves__read_lines_text;
  return is_obj(scan) ? laves__read_lines_obj : NULL;
}

/* The points that are used exist and are finite, and there are some. */
static laves_result check(const laves__mesh_input *input, laves_error *error) {
  const laves__line_list *l = input->lines;
  const size_t used = l->single_count + l->node_count;
  for (size_t i = 0; i < used; i++) {
    const int32_t p = i < l->single_count ? l->single[i] : l->node[i - l->single_count];
    if (p < 0 || (size_t)p >= input->point_count)
      return laves__mesh_input_fail(input, error, "a point or line uses point %ld (counted from 0), but there are %zu", (long)p,
                                    input->point_count);
    if (!v3_finite(input->points[p]))
      return laves__mesh_input_fail(input, error, "point %ld (counted from 0) has a coordinate that is not finite", (long)p);
  }
  if (used == 0)
    return laves__mesh_input_fail(input, error, "it has no points or lines; faces and solid elements are passed over");
  return LAVES_OK;
}

static laves_result read_all(laves__mesh_input *input, laves_error *error) {
  read_fn *read = find_reader(input);
  if (!read)
    return laves__mesh_input_fail(input, error,
                                  "it holds no points or lines in a form that is known (text with three coordinates on each "
                                  "line, OBJ, Gmsh, VTK, VTU, VTP)");
  laves_result result = read(input, error);
  if (result == LAVES_OK) result = check(input, error);
  if (result == LAVES_OK && !laves__line_list_join(input->lines, input->point_count))
    result = laves__fail_memory(input->context, error);
  return result;
}

laves_result laves__lines_parse(laves_context *context, const char *name, const char *bytes, size_t length, laves__lines *lines,
                                laves_error *error) {
  *lines = (laves__lines){.context = context, .list = {.context = context}};
  laves__mesh_input input = {.context = context, .name = name, .begin = bytes, .end = bytes + length, .lines = &lines->list};
  const laves_result result = read_all(&input, error);
  lines->points = input.points; /* they stay */
  lines->point_count = input.point_count;
  lines->point_capacity = input.point_capacity;
  input.points = NULL;
  input.point_capacity = 0;
  laves__mesh_input_free(&input);
  return result;
}

laves_result laves__lines_read(laves_context *context, const char *path, laves__lines *lines, laves_error *error) {
  char *bytes;
  size_t length;
  *lines = (laves__lines){0};
  laves_result result = laves__input_read(context, path, &bytes, &length, error);
  if (result != LAVES_OK) return result;
  result = laves__lines_parse(context, path, bytes, length, lines, error);
  laves__free(context, bytes, length + 1, 1);
  return result;
}

void laves__lines_free(laves__lines *l) {
  if (!l->context) return;
  laves__free(l->context, l->points, l->point_capacity, sizeof *l->points);
  laves__line_list_free(&l->list);
  memset(l, 0, sizeof *l);
}
