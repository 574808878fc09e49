/* TetGen's .node, .ele and .face. Points may be numbered from 0 or 1; elements count from the same. Ten-node tets give
 * their four corners. The first attribute of a tet is its region, the marker of a face its tag. Source: see write_tetgen.c. */
#include <math.h>

#include "io/mesh_input.h"
#include "io/scan.h"

static laves__scan begin_scan(const laves__mesh_input *input) {
  laves__scan scan = laves__scan_begin(input->name, input->begin, (size_t)(input->end - input->begin));
  scan.comment = '#';
  return scan;
}

/* The numbers of the first line: a count that the file has room for, and up to three more, 0 where the line ends. */
static laves_result read_head(laves__scan *scan, int64_t head[4], laves_error *error) {
  size_t count;
  if (!laves__scan_space(scan) || !laves__scan_count(scan, (size_t)(scan->end - scan->begin), &count))
    return laves__scan_fail_expected(scan, error, "a count that the file has room for");
  head[0] = (int64_t)count;
  for (int i = 1; i < 4; i++)
    if (!laves__scan_int(scan, &head[i])) head[i] = 0;
  laves__scan_next_line(scan);
  return LAVES_OK;
}

static laves_result check_pause(const laves__mesh_input *input, const laves__scan *scan, int64_t i, laves_error *error) {
  if (i % 65536 == 65535 && laves__mesh_input_cancelled(input, scan->at)) return laves__fail_cancelled(error);
  return LAVES_OK;
}

laves_result laves__read_tetgen_node(laves__mesh_input *input, int64_t *base, laves_error *error) {
  laves__scan scan = begin_scan(input);
  int64_t head[4] = {0}, number;
  laves_result result = read_head(&scan, head, error);
  if (result == LAVES_OK && head[1] != 3) return laves__scan_fail(&scan, error, "the points must have 3 coordinates");
  *base = 0;
  for (int64_t i = 0; i < head[0] && result == LAVES_OK; i++) {
    laves__vec3 p;
    if (!laves__scan_space(&scan) || !laves__scan_int(&scan, &number))
      return laves__scan_fail_expected(&scan, error, "a point's number");
    if (i == 0) *base = number;
    if ((*base != 0 && *base != 1) || number != *base + i)
      return laves__scan_fail(&scan, error, "points must be numbered 0, 1, 2, ... or 1, 2, 3, ...; this is %lld",
                              (long long)number);
    if (!laves__scan_double(&scan, &p.x) || !laves__scan_double(&scan, &p.y) || !laves__scan_double(&scan, &p.z))
      return laves__scan_fail_expected(&scan, error, "a coordinate");
    if (!laves__mesh_input_add_point(input, p)) return laves__fail_memory(input->context, error);
    laves__scan_next_line(&scan);
    result = check_pause(input, &scan, i, error);
  }
  return result;
}

/* Corners of one row; what does not fit becomes -1 and is refused later. */
static laves_result read_corners(laves__scan *scan, int64_t base, int count, int32_t *corners, laves_error *error) {
  int64_t number;
  if (!laves__scan_space(scan) || !laves__scan_int(scan, &number))
    return laves__scan_fail_expected(scan, error, "an element's number");
  for (int j = 0; j < count; j++) {
    if (!laves__scan_int(scan, &number)) return laves__scan_fail_expected(scan, error, "a point's number");
    corners[j] = number >= base && number <= INT32_MAX ? (int32_t)(number - base) : -1;
  }
  return LAVES_OK;
}

laves_result laves__read_tetgen_ele(laves__mesh_input *input, int64_t base, laves_error *error) {
  laves__scan scan = begin_scan(input);
  int64_t head[4] = {0}, further;
  laves_result result = read_head(&scan, head, error);
  if (result == LAVES_OK && head[1] != 4 && head[1] != 10)
    return laves__scan_fail(&scan, error, "the elements must have 4 or 10 points");
  input->higher_order = head[1] == 10;
  for (int64_t i = 0; i < head[0] && result == LAVES_OK; i++) {
    int32_t corners[4];
    result = read_corners(&scan, base, 4, corners, error);
    if (result != LAVES_OK) return result;
    for (int64_t j = 4; j < head[1]; j++)
      if (!laves__scan_int(&scan, &further)) return laves__scan_fail_expected(&scan, error, "a point's number");
    double region = 1;
    if (head[2] > 0 && !laves__scan_double(&scan, &region)) return laves__scan_fail_expected(&scan, error, "an attribute");
    region = fmin(fmax(region, INT32_MIN), INT32_MAX);
    if (!laves__mesh_input_add_tet(input, corners, (int32_t)region)) return laves__fail_memory(input->context, error);
    laves__scan_next_line(&scan);
    result = check_pause(input, &scan, i, error);
  }
  return result;
}

/* The marker stands behind the three corners, and in meshes of ten-node tets behind three more nodes, which the head of
 * the file does not tell. */
static bool read_marker(const laves__mesh_input *input, laves__scan *scan, int64_t *marker) {
  int64_t further[4];
  int count = 0;
  while (count < 4 && laves__scan_int(scan, &further[count])) count++;
  if (count == 0) return false;
  *marker = input->higher_order && count == 4 ? further[3] : further[0];
  return true;
}

laves_result laves__read_tetgen_face(laves__mesh_input *input, int64_t base, laves_error *error) {
  laves__scan scan = begin_scan(input);
  int64_t head[4] = {0};
  laves_result result = read_head(&scan, head, error);
  for (int64_t i = 0; i < head[0] && result == LAVES_OK; i++) {
    int32_t corners[3];
    int64_t marker = 1;
    result = read_corners(&scan, base, 3, corners, error);
    if (result != LAVES_OK) return result;
    if (head[1] > 0 && !read_marker(input, &scan, &marker)) return laves__scan_fail_expected(&scan, error, "a marker");
    if (marker < INT32_MIN || marker > INT32_MAX) return laves__scan_fail(&scan, error, "the marker is too large");
    if (!laves__mesh_input_add_face(input, corners, (int32_t)marker)) return laves__fail_memory(input->context, error);
    laves__scan_next_line(&scan);
    result = check_pause(input, &scan, i, error);
  }
  return result;
}
