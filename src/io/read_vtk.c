/* Tetrahedra and triangles of VTK's legacy unstructured grids, straight or of second order; regions are cell data by one of the
 * names that VTU's reader knows. */
#include <string.h>

#include "io/legacy_vtk.h"
#include "io/vtu.h"

typedef struct grid {
  laves__legacy file;
  laves__legacy_row types; /* of the cells, for their data; at NULL before they are read */
  size_t cell_count;
} grid;

/* Corners of the cells that are read; 0: passed over. */
static int corner_count(int64_t type) {
  if (type == 10 || type == 24 || type == 71 || type == 78) return 4; /* tet: linear, quadratic, Lagrange, Bezier */
  return type == 5 || type == 22 || type == 69 || type == 76 ? 3 : 0;
}

static laves_result read_cell(laves__legacy *r, int corners, size_t cell, laves_error *error) {
  int64_t size = 0, point;
  int32_t corner[4] = {0};
  const laves_result result = laves__legacy_begin_cell(r, &r->grid, &size, error);
  if (result != LAVES_OK) return result;
  if (size < corners) return laves__mesh_input_fail(r->input, error, "cell %zu (counted from 0) has too few corners", cell);
  for (int64_t i = 0; i < size; i++) {
    if (!laves__legacy_integer(r, &r->grid.connectivity, &point))
      return laves__legacy_fail_short(r, r->grid.connectivity.at, "a point of a cell", error);
    if (i < corners) corner[i] = point >= 0 && point <= INT32_MAX ? (int32_t)point : -1; /* refused in the end */
  }
  if (corners == 0) return LAVES_OK;
  r->input->higher_order |= size > corners;
  const bool enough =
      corners == 4 ? laves__mesh_input_add_tet(r->input, corner, 1) : laves__mesh_input_add_face(r->input, corner, 1);
  return enough ? LAVES_OK : laves__fail_memory(r->input->context, error);
}

static laves_result read_types(grid *g, laves_error *error) {
  laves__legacy *r = &g->file;
  size_t count;
  laves_result result = laves__legacy_read_count(r, &count, error);
  if (result != LAVES_OK) return result;
  if (!r->grid.known || r->grid.count != count)
    return laves__scan_fail(&r->scan, error, "there are %zu types, but %zu cells", count, r->grid.known ? r->grid.count : 0);
  laves__legacy_row types = g->types = laves__legacy_begin_row(r, LAVES__LEGACY_INT32);
  g->cell_count = count;
  for (size_t i = 0; i < count && result == LAVES_OK; i++) {
    int64_t type;
    if (!laves__legacy_integer(r, &types, &type)) return laves__legacy_fail_short(r, types.at, "the type of a cell", error);
    result = read_cell(r, corner_count(type), i, error);
    if (i % 65536 == 65535 && laves__mesh_input_cancelled(r->input, types.at)) return laves__fail_cancelled(error);
  }
  r->scan.at = types.at;
  r->grid.known = false;
  return result;
}

/* ---- data of cells ---- */

static int32_t clamp(double value) {
  if (!(value >= INT32_MIN)) return INT32_MIN;
  return value > INT32_MAX ? INT32_MAX : (int32_t)value;
}

/* One number for each cell. */
static laves_result take_regions(grid *g, laves__legacy_row numbers, laves_error *error) {
  laves__legacy *r = &g->file;
  laves__legacy_row types = g->types;
  size_t tet = 0, face = 0;
  for (size_t i = 0; i < g->cell_count; i++) {
    int64_t type;
    double value;
    if (!laves__legacy_integer(r, &types, &type) || !laves__legacy_real(r, &numbers, &value))
      return laves__legacy_fail_short(r, numbers.at, "a region", error);
    const int corners = corner_count(type);
    if (corners == 4) r->input->regions[tet++] = clamp(value);
    if (corners == 3) r->input->face_tags[face++] = clamp(value);
    if (i % 65536 == 65535 && laves__mesh_input_cancelled(r->input, numbers.at)) return laves__fail_cancelled(error);
  }
  return LAVES_OK;
}

/* An array of `count` numbers begins behind this line; it is taken when it holds regions. */
static laves_result pass_array(grid *g, laves__word name, laves__legacy_kind kind, size_t count, laves_error *error) {
  laves__legacy *r = &g->file;
  const laves__legacy_row numbers = laves__legacy_begin_row(r, kind);
  laves__legacy_row end = numbers;
  if (!laves__legacy_skip(r, &end, count)) return laves__legacy_fail_short(r, end.at, "a number of an array", error);
  r->scan.at = end.at;
  return count == g->cell_count && laves__vtu_is_region_name(name) ? take_regions(g, numbers, error) : LAVES_OK;
}

/* SCALARS name type components, and on a line of its own LOOKUP_TABLE name. */
static laves_result read_scalars(grid *g, laves_error *error) {
  laves__legacy *r = &g->file;
  laves__word name;
  laves__legacy_kind kind;
  size_t components = 1;
  if (!laves__scan_word(&r->scan, &name)) return laves__scan_fail_expected(&r->scan, error, "the name of an array");
  laves_result result = laves__legacy_read_kind(r, &kind, error);
  if (result == LAVES_OK && laves__scan_blanks(&r->scan)) result = laves__legacy_read_count(r, &components, error);
  if (result != LAVES_OK) return result;
  laves__scan ahead = r->scan;
  laves__scan_next_line(&ahead);
  if (laves__scan_keyword(&ahead, "LOOKUP_TABLE")) r->scan = ahead;
  if (components > 0 && g->cell_count > SIZE_MAX / components)
    return laves__scan_fail(&r->scan, error, "there are too many components");
  return pass_array(g, name, kind, components * g->cell_count, error);
}

/* FIELD name count, then for each array: name, components, tuples, type. */
static laves_result read_field(grid *g, laves_error *error) {
  laves__legacy *r = &g->file;
  laves__word name;
  size_t arrays, components, tuples;
  laves__legacy_kind kind;
  if (!laves__scan_word(&r->scan, &name)) return laves__scan_fail_expected(&r->scan, error, "the name of a field");
  laves_result result = laves__legacy_read_count(r, &arrays, error);
  for (size_t i = 0; i < arrays && result == LAVES_OK; i++) {
    if (!laves__scan_space(&r->scan) || !laves__scan_word(&r->scan, &name))
      return laves__scan_fail_expected(&r->scan, error, "the name of an array");
    if (laves__word_is(name, "METADATA")) {
      laves__legacy_skip_metadata(r);
      i--;
      continue;
    }
    result = laves__legacy_read_count(r, &components, error);
    if (result == LAVES_OK) result = laves__legacy_read_count(r, &tuples, error);
    if (result == LAVES_OK) result = laves__legacy_read_kind(r, &kind, error);
    if (result != LAVES_OK) break;
    if (components > 0 && tuples > SIZE_MAX / components)
      return laves__scan_fail(&r->scan, error, "the array has too many numbers");
    result = pass_array(g, name, kind, components * tuples, error);
  }
  return result;
}

/* What comes behind CELL_DATA, as far as it is arrays of the usual kinds; anything else ends it, since nothing more is wanted. */
static laves_result read_cell_data(grid *g, laves_error *error) {
  laves__legacy *r = &g->file;
  laves_result result = LAVES_OK;
  laves__word word;
  laves__scan_next_line(&r->scan);
  while (result == LAVES_OK && laves__scan_space(&r->scan) && laves__scan_word(&r->scan, &word)) {
    if (laves__word_is(word, "SCALARS"))
      result = read_scalars(g, error);
    else if (laves__word_is(word, "FIELD"))
      result = read_field(g, error);
    else if (laves__word_is(word, "METADATA"))
      laves__legacy_skip_metadata(r);
    else
      break;
  }
  return result;
}

/* ---- the file ---- */

/* Data of points may come before those of cells, and may be of any kind: the line that begins the latter is looked for. In a
 * binary file numbers could look like it, but not for a whole line. */
static bool find_cell_data(grid *g) {
  laves__scan *scan = &g->file.scan;
  do {
    laves__scan ahead = *scan;
    size_t count;
    if (!laves__scan_keyword(&ahead, "CELL_DATA") || !laves__scan_count(&ahead, g->cell_count, &count) || count != g->cell_count)
      continue;
    if (laves__scan_blanks(&ahead)) continue;
    *scan = ahead;
    return true;
  } while (laves__scan_next_line(scan));
  return false;
}

/* One section; *done where data begin. */
static laves_result read_section(grid *g, bool *done, laves_error *error) {
  laves__legacy *r = &g->file;
  const laves__scan before = r->scan;
  laves__word name;
  if (!laves__scan_word(&r->scan, &name)) return laves__scan_fail_expected(&r->scan, error, "the name of a section");
  if (laves__word_is(name, "POINTS")) return laves__legacy_read_points(r, error);
  if (laves__word_is(name, "CELLS")) return laves__legacy_find_cells(r, &r->grid, error);
  if (laves__word_is(name, "CELL_TYPES")) return read_types(g, error);
  if (laves__word_is(name, "FIELD")) return laves__legacy_skip_field(r, error);
  if (laves__word_is(name, "METADATA")) {
    laves__legacy_skip_metadata(r);
    return LAVES_OK;
  }
  *done = laves__word_is(name, "POINT_DATA") || laves__word_is(name, "CELL_DATA");
  if (*done) {
    r->scan = before;
    return LAVES_OK;
  }
  char quote[LAVES__QUOTE_SIZE];
  return laves__scan_fail(&r->scan, error, "the section %s is not one of an unstructured grid", laves__quote(name, quote));
}

laves_result laves__read_vtk(laves__mesh_input *input, laves_error *error) {
  grid g = {.file = {.input = input, .scan = laves__scan_begin(input->name, input->begin, (size_t)(input->end - input->begin))}};
  laves_result result = laves__legacy_read_head(&g.file, error);
  bool done = false;
  while (result == LAVES_OK && !done && laves__scan_space(&g.file.scan)) result = read_section(&g, &done, error);
  return result == LAVES_OK && done && find_cell_data(&g) ? read_cell_data(&g, error) : result;
}
