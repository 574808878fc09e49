/* laves' own text of points and polylines: `x y z` on each line, with spaces or commas between; what follows a # is passed over;
 * an empty line (or one with a comment alone) ends a polyline, and a polyline of one point is a point. */
#include "io/read_lines.h"

/* One coordinate and the comma behind it. */
static bool take_coordinate(laves__scan *scan, double *value) {
  if (!laves__scan_blanks(scan)) return false;
  const char *stop = laves__parse_double(scan->at, scan->end, value);
  if (!stop) return false;
  if (stop < scan->end && *stop != ',' && *stop != '#' && *stop != ' ' && *stop != '\t' && *stop != '\r' && *stop != '\n')
    return false;
  scan->at = stop;
  if (laves__scan_blanks(scan) && *scan->at == ',') scan->at++;
  return true;
}

/* The line at the place, which is not empty. */
static laves_result read_point(laves__mesh_input *input, laves__scan *scan, laves_error *error) {
  double x[3];
  for (int i = 0; i < 3; i++)
    if (!take_coordinate(scan, &x[i])) return laves__scan_fail_expected(scan, error, "three coordinates (finite numbers)");
  if (laves__scan_blanks(scan)) return laves__scan_fail_expected(scan, error, "the end of the line behind three coordinates");
  if (input->point_count == INT32_MAX) return laves__scan_fail(scan, error, "there are more than 2147483647 points");
  const bool enough = laves__line_list_add_node(input->lines, (int32_t)input->point_count) &&
                      laves__mesh_input_add_point(input, v3(x[0], x[1], x[2]));
  return enough ? LAVES_OK : laves__fail_memory(input->context, error);
}

laves_result laves__read_lines_text(laves__mesh_input *input, laves_error *error) {
  laves__scan scan = laves__scan_begin(input->name, input->begin, (size_t)(input->end - input->begin));
  laves_result result = LAVES_OK;
  bool more = true;
  scan.comment = '#';
  for (size_t line = 1; result == LAVES_OK && more; line++) {
    if (laves__scan_blanks(&scan))
      result = read_point(input, &scan, error);
    else if (!laves__line_list_end(input->lines))
      result = laves__fail_memory(input->context, error);
    if (result != LAVES_OK) return result;
    more = laves__scan_next_line(&scan);
    if (line % 65536 == 0 && laves__mesh_input_cancelled(input, scan.at)) return laves__fail_cancelled(error);
  }
  return laves__line_list_end(input->lines) ? LAVES_OK : laves__fail_memory(input->context, error);
}
