/* Points and polylines of an OBJ file: `v x y z`, `p v1 v2 ...` and `l v1/vt1 v2/vt2 ...`, of which the numbers behind a slash
 * are passed over; negative numbers count back from the latest vertex. All other lines are passed over. */
#include "io/read_lines.h"

static laves_result read_vertex(laves__mesh_input *input, laves__scan *scan, laves_error *error) {
  double x[3];
  for (int i = 0; i < 3; i++)
    if (!laves__scan_double(scan, &x[i])) return laves__scan_fail_expected(scan, error, "a coordinate (a finite number)");
  if (input->point_count == INT32_MAX) return laves__scan_fail(scan, error, "there are more than 2147483647 vertices");
  return laves__mesh_input_add_point(input, v3(x[0], x[1], x[2])) ? LAVES_OK : laves__fail_memory(input->context, error);
}

/* One index, as a number from 0. Positive ones may be of vertices that come later, and are checked at the end. */
static laves_result read_index(const laves__mesh_input *input, laves__scan *scan, int32_t *point, laves_error *error) {
  const int64_t count = (int64_t)input->point_count;
  int64_t index;
  const char *stop = laves__parse_int(scan->at, scan->end, &index);
  const bool ends = stop && (stop == scan->end || *stop == '/' || *stop == ' ' || *stop == '\t' || *stop == '\r' ||
                             *stop == '\n' || *stop == '#' || *stop == '\\');
  if (!ends || index == 0 || index > INT32_MAX)
    return laves__scan_fail_expected(scan, error, "the index of a vertex (1, 2, ... or -1, -2, ...)");
  if (index < -count)
    return laves__scan_fail(scan, error, "vertex %lld is used, but only %lld stand before it", (long long)index,
                            (long long)count);
  *point = (int32_t)(index < 0 ? count + index : index - 1);
  scan->at = stop;
  laves__word rest;
  if (stop < scan->end && *stop == '/') laves__scan_word(scan, &rest);
  return LAVES_OK;
}

/* The indices of a line element, or of a list of points. */
static laves_result read_element(laves__mesh_input *input, laves__scan *scan, bool is_line, laves_error *error) {
  int32_t point = 0;
  if (!laves__scan_blanks(scan))
    return laves__scan_fail_expected(scan, error, "the index of a vertex (1, 2, ... or -1, -2, ...)");
  while (laves__scan_blanks(scan)) {
    const laves_result result = read_index(input, scan, &point, error);
    if (result != LAVES_OK) return result;
    const bool enough =
        is_line ? laves__line_list_add_node(input->lines, point) : laves__line_list_add_single(input->lines, point);
    if (!enough) return laves__fail_memory(input->context, error);
  }
  return laves__line_list_end(input->lines) ? LAVES_OK : laves__fail_memory(input->context, error);
}

static laves_result read_line(laves__mesh_input *input, laves__scan *scan, laves_error *error) {
  laves__word word;
  if (!laves__scan_word(scan, &word) || word.length != 1) return LAVES_OK;
  if (*word.at == 'v') return read_vertex(input, scan, error);
  return *word.at == 'p' || *word.at == 'l' ? read_element(input, scan, *word.at == 'l', error) : LAVES_OK;
}

laves_result laves__read_lines_obj(laves__mesh_input *input, laves_error *error) {
  laves__scan scan = laves__scan_begin(input->name, input->begin, (size_t)(input->end - input->begin));
  laves_result result = LAVES_OK;
  scan.comment = '#';
  scan.continuation = true;
  for (size_t line = 1; result == LAVES_OK && laves__scan_space(&scan); line++) {
    result = read_line(input, &scan, error);
    laves__scan_next_line(&scan);
    if (line % 65536 == 0 && laves__mesh_input_cancelled(input, scan.at)) return laves__fail_cancelled(error);
  }
  return result;
}
