/* Walking VTK's legacy files. */
#include "io/legacy_vtk.h"

#include <string.h>

#include "io/binary.h"

/* Names of the file format; vtkIdType is written as int. */
static const struct {
  const char *name;
  laves__legacy_kind kind;
} kind_names[] = {{"char", LAVES__LEGACY_INT8},           {"unsigned_char", LAVES__LEGACY_UINT8},
                  {"short", LAVES__LEGACY_INT16},         {"unsigned_short", LAVES__LEGACY_UINT16},
                  {"int", LAVES__LEGACY_INT32},           {"unsigned_int", LAVES__LEGACY_UINT32},
                  {"long", LAVES__LEGACY_INT64},          {"unsigned_long", LAVES__LEGACY_UINT64},
                  {"float", LAVES__LEGACY_FLOAT32},       {"double", LAVES__LEGACY_FLOAT64},
                  {"vtkIdType", LAVES__LEGACY_INT32},     {"vtktypeint64", LAVES__LEGACY_INT64},
                  {"vtktypeuint64", LAVES__LEGACY_UINT64}};
static const size_t kind_bytes[LAVES__LEGACY_KINDS] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};

/* ---- numbers ---- */

laves_result laves__legacy_fail_short(const laves__legacy *r, const char *at, const char *what, laves_error *error) {
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
bool laves__legacy_integer(const laves__legacy *r, laves__legacy_row *numbers, int64_t *value) {
  if (!r->binary) {
    laves__scan scan = r->scan;
    scan.at = numbers->at;
    if (!laves__scan_space(&scan) || !laves__scan_int(&scan, value)) return false;
    numbers->at = scan.at;
    return true;
  }
  const size_t bytes = kind_bytes[numbers->kind];
  if ((size_t)(r->scan.end - numbers->at) < bytes || numbers->kind >= LAVES__LEGACY_FLOAT32) return false;
  const uint64_t bits = big_endian(numbers->at, bytes);
  numbers->at += bytes;
  switch (numbers->kind) {
    case LAVES__LEGACY_INT8:
      *value = (int8_t)bits;
      return true;
    case LAVES__LEGACY_INT16:
      *value = (int16_t)bits;
      return true;
    case LAVES__LEGACY_INT32:
      *value = (int32_t)bits;
      return true;
    default:
      *value = (int64_t)bits;
      return true;
  }
}

bool laves__legacy_real(const laves__legacy *r, laves__legacy_row *numbers, double *value) {
  if (!r->binary) {
    laves__scan scan = r->scan;
    scan.at = numbers->at;
    if (!laves__scan_space(&scan) || !laves__scan_double(&scan, value)) return false;
    numbers->at = scan.at;
    return true;
  }
  int64_t integer;
  if (numbers->kind < LAVES__LEGACY_FLOAT32) {
    if (!laves__legacy_integer(r, numbers, &integer)) return false;
    *value = (double)integer;
    return true;
  }
  if ((size_t)(r->scan.end - numbers->at) < kind_bytes[numbers->kind]) return false;
  const uint64_t bits = big_endian(numbers->at, kind_bytes[numbers->kind]);
  const uint32_t narrow_bits = (uint32_t)bits;
  float narrow;
  if (numbers->kind == LAVES__LEGACY_FLOAT32) {
    memcpy(&narrow, &narrow_bits, sizeof narrow);
    *value = narrow;
  } else {
    memcpy(value, &bits, sizeof bits);
  }
  numbers->at += kind_bytes[numbers->kind];
  return true;
}

/* Moves behind `count` numbers of any kind. */
bool laves__legacy_skip(const laves__legacy *r, laves__legacy_row *numbers, size_t count) {
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

laves_result laves__legacy_read_kind(laves__legacy *r, laves__legacy_kind *kind, laves_error *error) {
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

laves_result laves__legacy_read_count(laves__legacy *r, size_t *count, laves_error *error) {
  return laves__scan_count(&r->scan, SIZE_MAX / 64, count) ? LAVES_OK : laves__scan_fail_expected(&r->scan, error, "a count");
}

/* Numbers start behind the line that tells of them. */
laves__legacy_row laves__legacy_begin_row(laves__legacy *r, laves__legacy_kind kind) {
  laves__scan_next_line(&r->scan);
  return (laves__legacy_row){r->scan.at, kind};
}

/* ---- points ---- */

laves_result laves__legacy_read_points(laves__legacy *r, laves_error *error) {
  size_t count;
  laves__legacy_kind kind;
  laves_result result = laves__legacy_read_count(r, &count, error);
  if (result == LAVES_OK) result = laves__legacy_read_kind(r, &kind, error);
  if (result != LAVES_OK) return result;
  if (r->input->point_count + count > INT32_MAX) return laves__scan_fail(&r->scan, error, "it has more than 2147483647 points");
  laves__legacy_row numbers = laves__legacy_begin_row(r, kind);
  for (size_t i = 0; i < count; i++) {
    laves__vec3 p;
    if (!laves__legacy_real(r, &numbers, &p.x) || !laves__legacy_real(r, &numbers, &p.y) ||
        !laves__legacy_real(r, &numbers, &p.z))
      return laves__legacy_fail_short(r, numbers.at, "a coordinate", error);
    if (!laves__mesh_input_add_point(r->input, p)) return laves__fail_memory(r->input->context, error);
    if (i % 65536 == 65535 && laves__mesh_input_cancelled(r->input, numbers.at)) return laves__fail_cancelled(error);
  }
  r->scan.at = numbers.at;
  return LAVES_OK;
}

/* ---- cells ---- */

static laves_result read_part(laves__legacy *r, const char *keyword, size_t count, laves__legacy_row *numbers,
                              laves_error *error) {
  laves__legacy_kind kind = LAVES__LEGACY_INT8;
  if (!laves__scan_space(&r->scan) || !laves__scan_keyword(&r->scan, keyword))
    return laves__scan_fail_expected(&r->scan, error, keyword);
  const laves_result result = laves__legacy_read_kind(r, &kind, error);
  if (result != LAVES_OK) return result;
  if (kind >= LAVES__LEGACY_FLOAT32) return laves__scan_fail(&r->scan, error, "%s must be integers", keyword);
  *numbers = laves__legacy_begin_row(r, kind);
  laves__legacy_row end = *numbers;
  if (!laves__legacy_skip(r, &end, count)) return laves__legacy_fail_short(r, end.at, keyword, error);
  r->scan.at = end.at;
  return LAVES_OK;
}

/* The head of cells, in either form; the place moves behind them. */
laves_result laves__legacy_find_cells(laves__legacy *r, laves__legacy_cells *c, laves_error *error) {
  size_t count, size;
  laves_result result = laves__legacy_read_count(r, &count, error);
  if (result == LAVES_OK) result = laves__legacy_read_count(r, &size, error);
  if (result != LAVES_OK) return result;
  *c = (laves__legacy_cells){.known = true, .count = count, .connectivity = laves__legacy_begin_row(r, LAVES__LEGACY_INT32)};
  laves__scan ahead = r->scan;
  if (laves__scan_space(&ahead) && laves__scan_keyword(&ahead, "OFFSETS")) {
    c->split = true;
    c->count = count > 0 ? count - 1 : 0;
    result = read_part(r, "OFFSETS", count, &c->offsets, error);
    if (result == LAVES_OK) result = read_part(r, "CONNECTIVITY", size, &c->connectivity, error);
    if (result == LAVES_OK && count > 0 && (!laves__legacy_integer(r, &c->offsets, &c->offset) || c->offset != 0))
      result = laves__mesh_input_fail(r->input, error, "the first offset of its cells is not 0");
    return result;
  }
  laves__legacy_row end = c->connectivity;
  if (!laves__legacy_skip(r, &end, size)) return laves__legacy_fail_short(r, end.at, "a point of a cell", error);
  r->scan.at = end.at;
  return LAVES_OK;
}

/* How many points the next cell has. */
laves_result laves__legacy_begin_cell(const laves__legacy *r, laves__legacy_cells *c, int64_t *size, laves_error *error) {
  int64_t end;
  if (!c->split) {
    if (laves__legacy_integer(r, &c->connectivity, size) && *size >= 0) return LAVES_OK;
    return laves__legacy_fail_short(r, c->connectivity.at, "the number of points of a cell", error);
  }
  if (!laves__legacy_integer(r, &c->offsets, &end))
    return laves__legacy_fail_short(r, c->offsets.at, "the offset of a cell", error);
  if (end < c->offset) return laves__mesh_input_fail(r->input, error, "the offsets of its cells are out of order");
  *size = end - c->offset;
  c->offset = end;
  return LAVES_OK;
}

/* ---- what is passed over ---- */

/* FIELD name count, then for each array: name, components, tuples, type. */
laves_result laves__legacy_skip_field(laves__legacy *r, laves_error *error) {
  laves__word name;
  size_t arrays, components, tuples;
  laves__legacy_kind kind = LAVES__LEGACY_INT8;
  if (!laves__scan_word(&r->scan, &name)) return laves__scan_fail_expected(&r->scan, error, "the name of a field");
  laves_result result = laves__legacy_read_count(r, &arrays, error);
  for (size_t i = 0; i < arrays && result == LAVES_OK; i++) {
    if (!laves__scan_space(&r->scan) || !laves__scan_word(&r->scan, &name))
      return laves__scan_fail_expected(&r->scan, error, "the name of an array");
    result = laves__legacy_read_count(r, &components, error);
    if (result == LAVES_OK) result = laves__legacy_read_count(r, &tuples, error);
    if (result == LAVES_OK) result = laves__legacy_read_kind(r, &kind, error);
    if (result != LAVES_OK) break;
    laves__legacy_row numbers = laves__legacy_begin_row(r, kind);
    if ((components > 0 && tuples > SIZE_MAX / components) || !laves__legacy_skip(r, &numbers, components * tuples))
      return laves__legacy_fail_short(r, numbers.at, "a number of a field", error);
    r->scan.at = numbers.at;
  }
  return result;
}

/* Text until an empty line. */
void laves__legacy_skip_metadata(laves__legacy *r) {
  while (laves__scan_next_line(&r->scan) && laves__scan_blanks(&r->scan)) {
  }
}

/* Lines with the version, the title, ASCII or BINARY, and the kind of the data. */
laves_result laves__legacy_read_head(laves__legacy *r, laves_error *error) {
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
