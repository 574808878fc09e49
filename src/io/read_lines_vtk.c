/* Points and lines of VTK's legacy files: VERTICES and LINES of polygons, and the cells of unstructured grids that are points and
 * lines. */
#include "io/legacy_vtk.h"
#include "io/read_lines.h"

typedef enum cell_use { IGNORED, SINGLES, LINE, CURVE } cell_use;

/* Of a cell's type; a curve's ends come first, then what lies between them. */
static cell_use use_of(int64_t type) {
  if (type == 1 || type == 2) return SINGLES;
  if (type == 3 || type == 4) return LINE;
  return type == 21 || type == 35 || type == 68 ? CURVE : IGNORED;
}

static laves_result read_cell(const laves__legacy *r, laves__legacy_cells *c, cell_use use, laves_error *error) {
  laves__line_list *list = r->input->lines;
  int64_t size = 0, point, last = -1;
  laves_result result = laves__legacy_begin_cell(r, c, &size, error);
  if (result != LAVES_OK) return result;
  bool enough = true;
  for (int64_t i = 0; i < size && enough; i++) {
    if (!laves__legacy_integer(r, &c->connectivity, &point))
      return laves__legacy_fail_short(r, c->connectivity.at, "a point of a cell", error);
    if (use == IGNORED) continue;
    if (point < 0 || point > INT32_MAX)
      return laves__mesh_input_fail(r->input, error, "a line uses point %lld, which the file does not have", (long long)point);
    if (use == SINGLES)
      enough = laves__line_list_add_single(list, (int32_t)point);
    else if (use == CURVE && i == 1)
      last = point;
    else
      enough = laves__line_list_add_node(list, (int32_t)point);
  }
  if (enough && last >= 0) enough = laves__line_list_add_node(list, (int32_t)last);
  return enough && laves__line_list_end(list) ? LAVES_OK : laves__fail_memory(r->input->context, error);
}

/* All cells are used alike, but where `types` has a type for each. */
static laves_result read_cells(const laves__legacy *r, laves__legacy_cells *c, cell_use use, laves__legacy_row *types,
                               laves_error *error) {
  laves_result result = LAVES_OK;
  for (size_t i = 0; i < c->count && result == LAVES_OK; i++) {
    int64_t type;
    if (types && !laves__legacy_integer(r, types, &type))
      return laves__legacy_fail_short(r, types->at, "the type of a cell", error);
    result = read_cell(r, c, types ? use_of(type) : use, error);
    if (i % 65536 == 65535 && laves__mesh_input_cancelled(r->input, c->connectivity.at)) return laves__fail_cancelled(error);
  }
  return result;
}

static laves_result read_types(laves__legacy *r, laves_error *error) {
  size_t count;
  const laves_result result = laves__legacy_read_count(r, &count, error);
  if (result != LAVES_OK) return result;
  if (!r->grid.known || r->grid.count != count)
    return laves__scan_fail(&r->scan, error, "there are %zu types, but %zu cells", count, r->grid.known ? r->grid.count : 0);
  laves__legacy_row types = laves__legacy_begin_row(r, LAVES__LEGACY_INT32);
  const laves_result read = read_cells(r, &r->grid, IGNORED, &types, error);
  r->scan.at = types.at;
  r->grid.known = false;
  return read;
}

/* One section; *done at the data of points and cells, which come last. */
static laves_result read_section(laves__legacy *r, bool *done, laves_error *error) {
  static const char *const polygons[] = {"POLYGONS", "TRIANGLE_STRIPS"};
  laves__word name;
  laves__legacy_cells c;
  laves_result result;
  if (!laves__scan_word(&r->scan, &name)) return laves__scan_fail_expected(&r->scan, error, "the name of a section");
  if (laves__word_is(name, "POINTS")) return laves__legacy_read_points(r, error);
  if (laves__word_is(name, "VERTICES") || laves__word_is(name, "LINES")) {
    result = laves__legacy_find_cells(r, &c, error);
    return result == LAVES_OK ? read_cells(r, &c, laves__word_is(name, "LINES") ? LINE : SINGLES, NULL, error) : result;
  }
  if (laves__word_is(name, "CELLS")) return laves__legacy_find_cells(r, &r->grid, error);
  if (laves__word_is(name, "CELL_TYPES")) return read_types(r, error);
  if (laves__word_is(name, "FIELD")) return laves__legacy_skip_field(r, error);
  for (size_t i = 0; i < LAVES__COUNT_OF(polygons); i++)
    if (laves__word_is(name, polygons[i])) return laves__legacy_find_cells(r, &c, error);
  if (laves__word_is(name, "METADATA")) {
    laves__legacy_skip_metadata(r);
    return LAVES_OK;
  }
  *done = laves__word_is(name, "POINT_DATA") || laves__word_is(name, "CELL_DATA");
  char quote[LAVES__QUOTE_SIZE];
  return *done ? LAVES_OK : laves__scan_fail(&r->scan, error, "the section %s is not known", laves__quote(name, quote));
}

laves_result laves__read_lines_vtk(laves__mesh_input *input, laves_error *error) {
  laves__legacy r = {.input = input, .scan = laves__scan_begin(input->name, input->begin, (size_t)(input->end - input->begin))};
  laves_result result = laves__legacy_read_head(&r, error);
  bool done = false;
  while (result == LAVES_OK && !done && laves__scan_space(&r.scan)) result = read_section(&r, &done, error);
  return result;
}
