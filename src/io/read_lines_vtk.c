/* Points and lines of VTK's legacy files, text and binary: VERTICES and LINES of polygons, and the cells of unstructured grids
 * that are points and lines.
 *
 * A file is a head of four lines, then sections that start with a word. Binary numbers are big-endian. Cells stand in one of two
 * ways: each with its count in front (up to version 4), or as offsets and connectivity (version 5); a `cells` walks either. What
 * cells are comes behind them in unstructured grids, so their place is kept and they are read then. Sizes are never believed:
 * every number is looked for in the bytes of the file.
 * Source: VTK file formats, "Simple Legacy Formats", https://docs.vtk.org/en/latest/vtk_file_formats/index.html */
#include <string.h>

#include "io/binary.h"
#include "io/read_lines.h"

typedef enum number_kind { INT8, UINT8, INT16, UINT16, INT32, UINT32, INT64, UINT64, FLOAT32, FLOAT64, KINDS } number_kind;

/* Names of the file format; vtkIdType is written as int. */
static const struct {
  const char *name;
  number_kind kind;
} kind_names[] = {{"char", INT8},           {"unsigned_char", UINT8}, {"short", INT16},     {"unsigned_short", UINT16},
                  {"int", INT32},           {"unsigned_int", UINT32}, {"long", INT64},      {"unsigned_long", UINT64},
                  {"float", FLOAT32},       {"double", FLOAT64},      {"vtkIdType", INT32}, {"vtktypeint64", INT64},
                  {"vtktypeuint64", UINT64}};
static const size_t kind_bytes[KINDS] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};

/* A row of numbers in the file. */
typedef struct row {
  const char *at;
  number_kind kind;
} row;

typedef struct cells {
  bool known;
  bool split; /* offsets and connectivity, else counts within connectivity */
  size_t count;
  row offsets, connectivity;
  int64_t offset; /* of the cell that comes next, when split */
} cells;

typedef struct reader {
  laves__mesh_input *input;
  laves__scan scan;
  bool binary;
  cells grid; /* of an unstructured grid, until its types come */
} reader;

/* ---- numbers ---- */

static laves_result fail_short(const reader *r, const char *at, const char *what, laves_error *error) {
  laves__scan scan = r->scan;
  scan.at = at;
  if (!r->binary) return laves__scan_fail_expected(&scan, error, what);
  return laves__mesh_input_fail(r->input, error, "the file ends at byte %zu where %s should be", (size_t)(scan.end - scan.begin),
                                what);
}

static uint64_t big_endian(const char *at, size_t bytes) {
  LAVES_ASSERT(at);
  uint64_t bits = 0;
  for (size_t i = 0; i < bytes; i++) bits = bits << 8 | (uint8_t)at[i];
  return bits;
}

/* The next number of a row as an integer; unsigned ones beyond 2^63 become negative and are refused as indices. */
static bool next_integer(const reader *r, row *numbers, int64_t *value) {
  if (!r->binary) {
    laves__scan scan = r->scan;
    scan.at = numbers->at;
    if (!laves__scan_space(&scan) || !laves__scan_int(&scan, value)) return false;
    numbers->at = scan.at;
    return true;
  }
  const size_t bytes = kind_bytes[numbers->kind];
  if ((size_t)(r->scan.end - numbers->at) < bytes || numbers->kind >= FLOAT32) return false;
  const uint64_t bits = big_endian(numbers->at, bytes);
  numbers->at += bytes;
  switch (numbers->kind) {
    case INT8:
      *value = (int8_t)bits;
      return true;
    case INT16:
      *value = (int16_t)bits;
      return true;
    case INT32:
      *value = (int32_t)bits;
      return true;
    default:
      *value = (int64_t)bits;
      return true;
  }
}

static bool next_real(const reader *r, row *numbers, double *value) {
  if (!r->binary) {
    laves__scan scan = r->scan;
    scan.at = numbers->at;
    if (!laves__scan_space(&scan) || !laves__scan_double(&scan, value)) return false;
    numbers->at = scan.at;
    return true;
  }
  int64_t integer;
  if (numbers->kind < FLOAT32) {
    if (!next_integer(r, numbers, &integer)) return false;
    *value = (double)integer;
    return true;
  }
  if ((size_t)(r->scan.end - numbers->at) < kind_bytes[numbers->kind]) return false;
  const uint64_t bits = big_endian(numbers->at, kind_bytes[numbers->kind]);
  const uint32_t narrow_bits = (uint32_t)bits;
  float narrow;
  if (numbers->kind == FLOAT32) {
    memcpy(&narrow, &narrow_bits, sizeof narrow);
    *value = narrow;
  } else {
    memcpy(value, &bits, sizeof bits);
  }
  numbers->at += kind_bytes[numbers->kind];
  return true;
}

/* Moves behind `count` numbers of any kind. */
static bool skip_numbers(const reader *r, row *numbers, size_t count) {
  if (r->binary) {
    if (count > (size_t)(r->scan.end - numbers->at) / kind_bytes[numbers->kind]) return false;
    numbers->at += count * kind_bytes[numbers->kind];
    return true;
  }
  laves__scan scan = r->scan;
  laves__word word;
  scan.at = numbers->at;
  for (size_t i = 0; i < count; i++)
    if (!laves__scan_space(&scan) || !laves__scan_word(&scan, &word)) return false;
  numbers->at = scan.at;
  return true;
}

static laves_result read_kind(reader *r, number_kind *kind, laves_error *error) {
  laves__word word;
  if (!laves__scan_word(&r->scan, &word)) return laves__scan_fail_expected(&r->scan, error, "the type of the numbers");
  for (size_t i = 0; i < LAVES__COUNT_OF(kind_names); i++)
    if (laves__word_is(word, kind_names[i].name)) {
      *kind = kind_names[i].kind;
      return LAVES_OK;
    }
  char quote[LAVES__QUOTE_SIZE];
  return laves__scan_fail(&r->scan, error, "the type of numbers %s is not known", laves__quote(word, quote));
}

static laves_result read_count(reader *r, size_t *count, laves_error *error) {
  return laves__scan_count(&r->scan, SIZE_MAX / 64, count) ? LAVES_OK : laves__scan_fail_expected(&r->scan, error, "a count");
}

/* Numbers start behind the line that tells of them. */
static row begin_row(reader *r, number_kind kind) {
  laves__scan_next_line(&r->scan);
  return (row){r->scan.at, kind};
}

/* ---- points ---- */

static laves_result read_points(reader *r, laves_error *error) {
  size_t count;
  number_kind kind;
  laves_result result = read_count(r, &count, error);
  if (result == LAVES_OK) result = read_kind(r, &kind, error);
  if (result != LAVES_OK) return result;
  if (r->input->point_count + count > INT32_MAX) return laves__scan_fail(&r->scan, error, "it has more than 2147483647 points");
  row numbers = begin_row(r, kind);
  for (size_t i = 0; i < count; i++) {
    laves__vec3 p;
    if (!next_real(r, &numbers, &p.x) || !next_real(r, &numbers, &p.y) || !next_real(r, &numbers, &p.z))
      return fail_short(r, numbers.at, "a coordinate", error);
    if (!laves__mesh_input_add_point(r->input, p)) return laves__fail_memory(r->input->context, error);
    if (i % 65536 == 65535 && laves__mesh_input_cancelled(r->input, numbers.at)) return laves__fail_cancelled(error);
  }
  r->scan.at = numbers.at;
  return LAVES_OK;
}

/* ---- cells ---- */

static laves_result read_part(reader *r, const char *keyword, size_t count, row *numbers, laves_error *error) {
  number_kind kind = INT8;
  if (!laves__scan_space(&r->scan) || !laves__scan_keyword(&r->scan, keyword))
    return laves__scan_fail_expected(&r->scan, error, keyword);
  const laves_result result = read_kind(r, &kind, error);
  if (result != LAVES_OK) return result;
  if (kind >= FLOAT32) return laves__scan_fail(&r->scan, error, "%s must be integers", keyword);
  *numbers = begin_row(r, kind);
  row end = *numbers;
  if (!skip_numbers(r, &end, count)) return fail_short(r, end.at, keyword, error);
  r->scan.at = end.at;
  return LAVES_OK;
}

/* The head of cells, in either form; the place moves behind them. */
static laves_result find_cells(reader *r, cells *c, laves_error *error) {
  size_t count, size;
  laves_result result = read_count(r, &count, error);
  if (result == LAVES_OK) result = read_count(r, &size, error);
  if (result != LAVES_OK) return result;
  *c = (cells){.known = true, .count = count, .connectivity = begin_row(r, INT32)};
  laves__scan ahead = r->scan;
  if (laves__scan_space(&ahead) && laves__scan_keyword(&ahead, "OFFSETS")) {
    c->split = true;
    c->count = count > 0 ? count - 1 : 0;
    result = read_part(r, "OFFSETS", count, &c->offsets, error);
    if (result == LAVES_OK) result = read_part(r, "CONNECTIVITY", size, &c->connectivity, error);
    if (result == LAVES_OK && count > 0 && (!next_integer(r, &c->offsets, &c->offset) || c->offset != 0))
      result = laves__mesh_input_fail(r->input, error, "the first offset of its cells is not 0");
    return result;
  }
  row end = c->connectivity;
  if (!skip_numbers(r, &end, size)) return fail_short(r, end.at, "a point of a cell", error);
  r->scan.at = end.at;
  return LAVES_OK;
}

/* How many points the next cell has. */
static laves_result begin_cell(const reader *r, cells *c, int64_t *size, laves_error *error) {
  int64_t end;
  if (!c->split) {
    if (next_integer(r, &c->connectivity, size) && *size >= 0) return LAVES_OK;
    return fail_short(r, c->connectivity.at, "the number of points of a cell", error);
  }
  if (!next_integer(r, &c->offsets, &end)) return fail_short(r, c->offsets.at, "the offset of a cell", error);
  if (end < c->offset) return laves__mesh_input_fail(r->input, error, "the offsets of its cells are out of order");
  *size = end - c->offset;
  c->offset = end;
  return LAVES_OK;
}

typedef enum cell_use { IGNORED, SINGLES, LINE, CURVE } cell_use;

/* Of a cell's type; a curve's ends come first, then what lies between them. */
static cell_use use_of(int64_t type) {
  if (type == 1 || type == 2) return SINGLES;
  if (type == 3 || type == 4) return LINE;
  return type == 21 || type == 35 || type == 68 ? CURVE : IGNORED;
}

static laves_result read_cell(const reader *r, cells *c, cell_use use, laves_error *error) {
  laves__line_list *list = r->input->lines;
  int64_t size = 0, point, last = -1;
  laves_result result = begin_cell(r, c, &size, error);
  if (result != LAVES_OK) return result;
  bool enough = true;
  for (int64_t i = 0; i < size && enough; i++) {
    if (!next_integer(r, &c->connectivity, &point)) return fail_short(r, c->connectivity.at, "a point of a cell", error);
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
static laves_result read_cells(const reader *r, cells *c, cell_use use, row *types, laves_error *error) {
  laves_result result = LAVES_OK;
  for (size_t i = 0; i < c->count && result == LAVES_OK; i++) {
    int64_t type;
    if (types && !next_integer(r, types, &type)) return fail_short(r, types->at, "the type of a cell", error);
    result = read_cell(r, c, types ? use_of(type) : use, error);
    if (i % 65536 == 65535 && laves__mesh_input_cancelled(r->input, c->connectivity.at)) return laves__fail_cancelled(error);
  }
  return result;
}

static laves_result read_types(reader *r, laves_error *error) {
  size_t count;
  const laves_result result = read_count(r, &count, error);
  if (result != LAVES_OK) return result;
  if (!r->grid.known || r->grid.count != count)
    return laves__scan_fail(&r->scan, error, "there are %zu types, but %zu cells", count, r->grid.known ? r->grid.count : 0);
  row types = begin_row(r, INT32);
  const laves_result read = read_cells(r, &r->grid, IGNORED, &types, error);
  r->scan.at = types.at;
  r->grid.known = false;
  return read;
}

/* ---- what is passed over ---- */

/* FIELD name count, then for each array: name, components, tuples, type. */
static laves_result skip_field(reader *r, laves_error *error) {
  laves__word name;
  size_t arrays, components, tuples;
  number_kind kind;
  if (!laves__scan_word(&r->scan, &name)) return laves__scan_fail_expected(&r->scan, error, "the name of a field");
  laves_result result = read_count(r, &arrays, error);
  for (size_t i = 0; i < arrays && result == LAVES_OK; i++) {
    if (!laves__scan_space(&r->scan) || !laves__scan_word(&r->scan, &name))
      return laves__scan_fail_expected(&r->scan, error, "the name of an array");
    result = read_count(r, &components, error);
    if (result == LAVES_OK) result = read_count(r, &tuples, error);
    if (result == LAVES_OK) result = read_kind(r, &kind, error);
    if (result != LAVES_OK) break;
    row numbers = begin_row(r, kind);
    if ((components > 0 && tuples > SIZE_MAX / components) || !skip_numbers(r, &numbers, components * tuples))
      return fail_short(r, numbers.at, "a number of a field", error);
    r->scan.at = numbers.at;
  }
  return result;
}

/* Text until an empty line. */
static void skip_metadata(reader *r) {
  while (laves__scan_next_line(&r->scan) && laves__scan_blanks(&r->scan)) {
  }
}

/* ---- the file ---- */

/* Lines with the version, the title, ASCII or BINARY, and the kind of the data. */
static laves_result read_head(reader *r, laves_error *error) {
  laves__scan_next_line(&r->scan);
  laves__scan_next_line(&r->scan);
  laves__word word;
  r->binary = laves__scan_keyword(&r->scan, "BINARY");
  if (!r->binary && !laves__scan_keyword(&r->scan, "ASCII")) return laves__scan_fail_expected(&r->scan, error, "ASCII or BINARY");
  laves__scan_next_line(&r->scan);
  if (!laves__scan_space(&r->scan) || !laves__scan_keyword(&r->scan, "DATASET") || !laves__scan_word(&r->scan, &word))
    return laves__scan_fail_expected(&r->scan, error, "DATASET and its kind");
  if (laves__word_is(word, "POLYDATA") || laves__word_is(word, "UNSTRUCTURED_GRID")) return LAVES_OK;
  char quote[LAVES__QUOTE_SIZE];
  return laves__scan_fail(&r->scan, error, "a data set of the kind %s has no points and lines; POLYDATA or UNSTRUCTURED_GRID has",
                          laves__quote(word, quote));
}

/* One section; *done at the data of points and cells, which come last. */
static laves_result read_section(reader *r, bool *done, laves_error *error) {
  static const char *const polygons[] = {"POLYGONS", "TRIANGLE_STRIPS"};
  laves__word name;
  cells c;
  laves_result result;
  if (!laves__scan_word(&r->scan, &name)) return laves__scan_fail_expected(&r->scan, error, "the name of a section");
  if (laves__word_is(name, "POINTS")) return read_points(r, error);
  if (laves__word_is(name, "VERTICES") || laves__word_is(name, "LINES")) {
    result = find_cells(r, &c, error);
    return result == LAVES_OK ? read_cells(r, &c, laves__word_is(name, "LINES") ? LINE : SINGLES, NULL, error) : result;
  }
  if (laves__word_is(name, "CELLS")) return find_cells(r, &r->grid, error);
  if (laves__word_is(name, "CELL_TYPES")) return read_types(r, error);
  if (laves__word_is(name, "FIELD")) return skip_field(r, error);
  for (size_t i = 0; i < LAVES__COUNT_OF(polygons); i++)
    if (laves__word_is(name, polygons[i])) return find_cells(r, &c, error);
  if (laves__word_is(name, "METADATA")) {
    skip_metadata(r);
    return LAVES_OK;
  }
  *done = laves__word_is(name, "POINT_DATA") || laves__word_is(name, "CELL_DATA");
  char quote[LAVES__QUOTE_SIZE];
  return *done ? LAVES_OK : laves__scan_fail(&r->scan, error, "the section %s is not known", laves__quote(name, quote));
}

laves_result laves__read_lines_vtk(laves__mesh_input *input, laves_error *error) {
  reader r = {.input = input, .scan = laves__scan_begin(input->name, input->begin, (size_t)(input->end - input->begin))};
  laves_result result = read_head(&r, error);
  bool done = false;
  while (result == LAVES_OK && !done && laves__scan_space(&r.scan)) result = read_section(&r, &done, error);
  return result;
}
