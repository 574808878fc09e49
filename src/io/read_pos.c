/* Gmsh's parsed post-processing views: text such as
 *
 *   View "size" { SP(0,0,0){0.1}; SS(0,0,0, 1,0,0, 0,1,0, 0,0,1){0.1,0.2,0.2,0.2}; };
 *
 * Elements of the kinds SP (a number at a point) and SS (numbers at the corners of a tet) are taken, each with points of its
 * own; others are passed over. Where an element has numbers for several time steps, the first are taken. The file is walked
 * twice: once for the names of the views, once for the elements of the chosen one.
 * Source: Gmsh reference manual, "Legacy formats": parsed post-processing views. */
#include <string.h>

#include "io/mesh_input.h"
#include "io/scan.h"

enum { CORNERS_MAX = 4, NUMBERS_MAX = 3 * CORNERS_MAX };

typedef struct reader {
  laves__mesh_input *input;
  laves__scan scan;
  laves__word *names;
  size_t name_count, name_capacity;
  size_t view, chosen; /* of the walk: the view it is in; the one to keep, or SIZE_MAX */
} reader;

/* ---- words ---- */

/* Crosses white space and both kinds of comments; false at the end. */
static bool skip_space(laves__scan *scan) {
  for (;;) {
    if (!laves__scan_space(scan)) return false;
    const size_t left = (size_t)(scan->end - scan->at);
    if (left < 2 || scan->at[0] != '/' || (scan->at[1] != '/' && scan->at[1] != '*')) return true;
    if (scan->at[1] == '/') {
      laves__scan_next_line(scan);
      continue;
    }
    const char *at = scan->at + 2;
    while (at < scan->end && (at[0] != '/' || at[-1] != '*' || at - scan->at < 3)) at++;
    scan->at = at < scan->end ? at + 1 : scan->end;
  }
}

static bool take(laves__scan *scan, char c) {
  if (!skip_space(scan) || *scan->at != c) return false;
  scan->at++;
  return true;
}

static bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; }

static bool take_name(laves__scan *scan, laves__word *name) {
  if (!skip_space(scan)) return false;
  const char *begin = scan->at;
  while (scan->at < scan->end && is_letter(*scan->at)) scan->at++;
  *name = (laves__word){begin, (size_t)(scan->at - begin)};
  return name->length > 0;
}

static bool take_quoted(laves__scan *scan, laves__word *text) {
  if (!skip_space(scan) || (*scan->at != '"' && *scan->at != '\'')) return false;
  const char *begin = scan->at + 1, *end = memchr(begin, *scan->at, (size_t)(scan->end - begin));
  if (!end) return false;
  *text = (laves__word){begin, (size_t)(end - begin)};
  scan->at = end + 1;
  return true;
}

/* "open number, number, ... close": keeps the first `wanted` and tells how many there were. */
static laves_result take_numbers(reader *r, const char brackets[2], size_t wanted, double *numbers, size_t *count,
                                 laves_error *error) {
  *count = 0;
  if (!take(&r->scan, brackets[0])) return laves__scan_fail_expected(&r->scan, error, brackets[0] == '(' ? "'('" : "'{'");
  if (take(&r->scan, brackets[1])) return LAVES_OK;
  do {
    double number;
    const char *after = skip_space(&r->scan) ? laves__parse_double(r->scan.at, r->scan.end, &number) : NULL;
    if (!after) return laves__scan_fail_expected(&r->scan, error, "a number");
    r->scan.at = after;
    if ((*count)++ < wanted) numbers[*count - 1] = number;
    if (*count % 65536 == 0 && laves__mesh_input_cancelled(r->input, r->scan.at)) return laves__fail_cancelled(error);
  } while (take(&r->scan, ','));
  if (take(&r->scan, brackets[1])) return LAVES_OK;
  return laves__scan_fail_expected(&r->scan, error, brackets[1] == ')' ? "',' or ')'" : "',' or '}'");
}

/* ---- views ---- */

enum { ITEMS_PER_QUESTION = 1 << 13 }; /* read between two questions whether to cancel */

static laves_result add_corners(reader *r, size_t corners, const double *coordinates, const double *values, laves_error *error) {
  laves__mesh_input *input = r->input;
  if (input->point_count > INT32_MAX - corners) return laves__mesh_input_fail(input, error, "it has more than 2147483647 points");
  const int32_t first = (int32_t)input->point_count, tet[4] = {first, first + 1, first + 2, first + 3};
  bool enough = true;
  for (size_t i = 0; i < corners && enough; i++)
    enough = laves__mesh_input_add_point(input, v3(coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2])) &&
             laves__mesh_input_add_value(input, values[i]);
  if (enough && corners == 4) enough = laves__mesh_input_add_tet(input, tet, 1);
  if (!enough) return laves__fail_memory(input->context, error);
  return LAVES_OK;
}

/* What follows the kind of an element: "(coordinates){values};". */
static laves_result read_element(reader *r, laves__word kind, laves_error *error) {
  const size_t corners = laves__word_is(kind, "SP") ? 1 : laves__word_is(kind, "SS") ? 4 : 0;
  double coordinates[NUMBERS_MAX] = {0}, values[CORNERS_MAX] = {0};
  size_t coordinate_count, value_count;
  const laves__scan start = r->scan;
  laves_result result = take_numbers(r, "()", 3 * corners, coordinates, &coordinate_count, error);
  if (result == LAVES_OK) result = take_numbers(r, "{}", corners, values, &value_count, error);
  if (result != LAVES_OK) return result;
  if (!take(&r->scan, ';')) return laves__scan_fail_expected(&r->scan, error, "';'");
  if (corners == 0) return LAVES_OK;
  if (coordinate_count != 3 * corners || value_count < corners)
    return laves__scan_fail(&start, error, "an element %s has %zu coordinates and %zu values, but needs %zu and %zu",
                            corners == 1 ? "SP" : "SS", coordinate_count, value_count, 3 * corners, corners);
  return r->view == r->chosen ? add_corners(r, corners, coordinates, values, error) : LAVES_OK;
}

/* "T2(...){...};" and "T3" hold texts, "INTERPOLATION_SCHEME" nested lists, "TIME" no place: passed over up to the ';'. */
static bool skip_statement(laves__scan *scan) {
  laves__word text;
  while (skip_space(scan) && *scan->at != ';')
    if (!take_quoted(scan, &text)) scan->at++;
  return take(scan, ';');
}

static laves_result read_item(reader *r, laves_error *error) {
  laves__word kind;
  if (!take_name(&r->scan, &kind)) return laves__scan_fail_expected(&r->scan, error, "an element such as SS, or '}'");
  if (kind.length == 2 && kind.at[0] != 'T') return read_element(r, kind, error);
  return skip_statement(&r->scan) ? LAVES_OK : laves__scan_fail_expected(&r->scan, error, "';'");
}

/* What follows "View": "name" { items }; */
static laves_result read_view(reader *r, laves_error *error) {
  laves__word name;
  if (!take_quoted(&r->scan, &name)) return laves__scan_fail_expected(&r->scan, error, "the name of the view in quotes");
  if (r->chosen == SIZE_MAX) {
    if (!laves__grow(r->input->context, &r->names, &r->name_capacity, r->name_count + 1, sizeof *r->names))
      return laves__fail_memory(r->input->context, error);
    r->names[r->name_count++] = name;
  }
  if (!take(&r->scan, '{')) return laves__scan_fail_expected(&r->scan, error, "'{'");
  laves_result result = LAVES_OK;
  for (size_t item = 1; result == LAVES_OK && !take(&r->scan, '}'); item++) {
    result = read_item(r, error);
    if (result == LAVES_OK && item % ITEMS_PER_QUESTION == 0 && laves__mesh_input_cancelled(r->input, r->scan.at))
      result = laves__fail_cancelled(error);
  }
  if (result == LAVES_OK && !take(&r->scan, ';')) return laves__scan_fail_expected(&r->scan, error, "';' behind the view");
  return result;
}

/* Walks the whole file; statements that are not views, such as settings, are passed over. */
static laves_result walk(reader *r, laves_error *error) {
  laves_result result = LAVES_OK;
  laves__word name;
  r->scan = laves__scan_begin(r->input->name, r->input->begin, (size_t)(r->input->end - r->input->begin));
  r->view = 0;
  while (result == LAVES_OK && skip_space(&r->scan)) {
    if (!take_name(&r->scan, &name)) return laves__scan_fail_expected(&r->scan, error, "View");
    if (laves__word_is(name, "View") && skip_space(&r->scan) && (*r->scan.at == '"' || *r->scan.at == '\'')) {
      result = read_view(r, error);
      r->view++;
    } else if (!skip_statement(&r->scan)) {
      return laves__scan_fail_expected(&r->scan, error, "';'");
    }
  }
  return result;
}

laves_result laves__read_pos(laves__mesh_input *input, laves_error *error) {
  reader r = {.input = input, .chosen = SIZE_MAX};
  size_t chosen;
  laves_result result = walk(&r, error);
  if (result == LAVES_OK) result = laves__mesh_input_choose_array(input, r.names, r.name_count, &chosen, error);
  if (result == LAVES_OK) {
    r.chosen = chosen;
    result = walk(&r, error);
  }
  if (result == LAVES_OK && input->point_count == 0)
    result = laves__mesh_input_fail(input, error, "the view has no scalar tetrahedra (SS) and no scalar points (SP)");
  laves__free(input->context, r.names, r.name_capacity, sizeof *r.names);
  return result;
}
