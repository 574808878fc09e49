/* The structure of VTK's XML files of unstructured grids, and of polygons where their vertices and lines are asked for.
 *
 * The XML is walked tag by tag, which yields the pieces and for each array of interest where its data stands. What the XML
 * claims is checked by those who decode it.
 * Source: VTK file formats, https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html */
#include "io/vtu.h"

#include <string.h>

#include "io/scan.h"

const laves__vtu_kind_info laves__vtu_kinds[LAVES__VTU_KIND_COUNT] = {{"Int8", 1},    {"UInt8", 1},  {"Int16", 2}, {"UInt16", 2},
                                                                      {"Int32", 4},   {"UInt32", 4}, {"Int64", 8}, {"UInt64", 8},
                                                                      {"Float32", 4}, {"Float64", 8}};

const char *const laves__vtu_array_names[LAVES__VTU_ARRAY_COUNT] = {"the points",
                                                                    "connectivity",
                                                                    "offsets",
                                                                    "types",
                                                                    "the regions",
                                                                    "the values",
                                                                    "the connectivity of vertices",
                                                                    "the offsets of vertices",
                                                                    "the connectivity of lines",
                                                                    "the offsets of lines"};

/* ---- XML ---- */

typedef struct tag {
  laves__word name;     /* with its '/' if it closes */
  const char *at, *end; /* the attributes */
} tag;

static bool find_byte(const char **at, const char *end, char byte) {
  const char *found = *at < end ? memchr(*at, byte, (size_t)(end - *at)) : NULL;
  if (found) *at = found;
  return found != NULL;
}

static bool starts_with(const char *at, const char *end, const char *text) {
  const size_t length = strlen(text);
  return (size_t)(end - at) >= length && memcmp(at, text, length) == 0;
}

/* Behind a comment's "-->", or behind the next '>' of anything else. */
static const char *tag_end(const char *at, const char *end) {
  if (starts_with(at, end, "<!--")) {
    for (at += 4; find_byte(&at, end, '>'); at++)
      if (at[-1] == '-' && at[-2] == '-') return at + 1;
    return NULL;
  }
  return find_byte(&at, end, '>') ? at + 1 : NULL;
}

static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/* The next tag at or behind *at, which moves behind it; false at the end. */
static bool next_tag(const char **at, const char *end, tag *t) {
  while (find_byte(at, end, '<')) {
    const char *begin = *at, *after = tag_end(begin, end);
    if (!after) return false;
    *at = after;
    if (starts_with(begin, end, "<!") || starts_with(begin, end, "<?")) continue;
    t->end = after - 1;
    t->name.at = begin + 1;
    const char *name_end = begin + 1;
    if (name_end < t->end && *name_end == '/') name_end++;
    while (name_end < t->end && !is_space(*name_end) && *name_end != '/') name_end++;
    t->name.length = (size_t)(name_end - t->name.at);
    t->at = name_end;
    return true;
  }
  return false;
}

/* The value of an attribute; false when there is none of that name, and then value stays as it was. */
static bool attribute(const tag *t, const char *name, laves__word *value) {
  const char *at = t->at;
  const size_t length = strlen(name);
  while (at < t->end) {
    while (at < t->end && (is_space(*at) || *at == '/')) at++;
    const char *begin = at;
    if (!find_byte(&at, t->end, '=')) return false;
    const char *name_end = at;
    while (name_end > begin && is_space(name_end[-1])) name_end--;
    at++;
    while (at < t->end && is_space(*at)) at++;
    if (at == t->end || (*at != '"' && *at != '\'')) return false;
    const char quote = *at++;
    const char *content = at;
    if (!find_byte(&at, t->end, quote)) return false;
    const char *content_end = at++;
    if ((size_t)(name_end - begin) != length || memcmp(begin, name, length) != 0) continue;
    *value = (laves__word){content, (size_t)(content_end - content)};
    return true;
  }
  return false;
}

static bool attribute_is(const tag *t, const char *name, const char *expected) {
  laves__word value;
  return attribute(t, name, &value) && laves__word_is(value, expected);
}

static bool attribute_count(const tag *t, const char *name, size_t *count) {
  laves__word value;
  if (!attribute(t, name, &value)) return false;
  laves__scan scan = laves__scan_begin(NULL, value.at, value.length);
  return laves__scan_count(&scan, SIZE_MAX / 64, count);
}

/* ---- the structure of the file ---- */

static laves_result read_file_tag(laves__vtu *r, const tag *t, laves_error *error) {
  laves__word value;
  char quote[LAVES__QUOTE_SIZE];
  r->polygons = r->input->lines && attribute_is(t, "type", "PolyData");
  if (!r->polygons && !attribute_is(t, "type", "UnstructuredGrid"))
    return laves__mesh_input_fail(r->input, error, "it is a VTK file, but not of an unstructured grid");
  if (attribute_is(t, "byte_order", "BigEndian"))
    return laves__mesh_input_fail(r->input, error, "its byte order is big-endian, which is not read; save it as little-endian");
  r->wide_header = attribute_is(t, "header_type", "UInt64");
  r->compressed = attribute(t, "compressor", &value) && value.length > 0;
  if (r->compressed && !laves__word_is(value, "vtkZLibDataCompressor"))
    return laves__mesh_input_fail(r->input, error, "its compression %s is not read; save it with zlib or without compression",
                                  laves__quote(value, quote));
  return LAVES_OK;
}

static laves_result add_piece(laves__vtu *r, const tag *t, laves_error *error) {
  if (!laves__grow(r->input->context, &r->pieces, &r->piece_capacity, r->piece_count + 1, sizeof *r->pieces))
    return laves__fail_memory(r->input->context, error);
  laves__vtu_piece *p = &r->pieces[r->piece_count++];
  memset(p, 0, sizeof *p);
  if (r->polygons) {
    attribute_count(t, "NumberOfVerts", &p->vert_count); /* none where it is not said */
    attribute_count(t, "NumberOfLines", &p->line_count);
    if (attribute_count(t, "NumberOfPoints", &p->point_count)) return LAVES_OK;
    return laves__mesh_input_fail(r->input, error, "a piece does not say its number of points");
  }
  if (attribute_count(t, "NumberOfPoints", &p->point_count) && attribute_count(t, "NumberOfCells", &p->cell_count))
    return LAVES_OK;
  return laves__mesh_input_fail(r->input, error, "a piece does not say its number of points and cells");
}

/* Names that programs give to the material of a cell. */
bool laves__vtu_is_region_name(laves__word name) {
  static const char *const known[] = {"region",      "gmsh:physical", "medit:ref", "tetgen:ref",
                                      "MaterialIds", "CellEntityIds", "material"};
  for (size_t i = 0; i < LAVES__COUNT_OF(known); i++)
    if (laves__word_is(name, known[i])) return true;
  return false;
}

/* Which array an element in this section is, or LAVES__VTU_ARRAY_COUNT. */
static int array_of(laves__word section, const tag *t) {
  laves__word name = {"", 0};
  attribute(t, "Name", &name);
  if (laves__word_is(section, "Points")) return LAVES__VTU_POINTS;
  if (laves__word_is(section, "CellData") && laves__vtu_is_region_name(name)) return LAVES__VTU_REGION;
  if (laves__word_is(section, "Verts") || laves__word_is(section, "Lines")) {
    const bool is_line = laves__word_is(section, "Lines");
    if (laves__word_is(name, "connectivity")) return is_line ? LAVES__VTU_LINE_CONNECTIVITY : LAVES__VTU_VERT_CONNECTIVITY;
    return laves__word_is(name, "offsets") ? (is_line ? LAVES__VTU_LINE_OFFSETS : LAVES__VTU_VERT_OFFSETS)
                                           : LAVES__VTU_ARRAY_COUNT;
  }
  if (!laves__word_is(section, "Cells")) return LAVES__VTU_ARRAY_COUNT;
  for (int i = LAVES__VTU_CONNECTIVITY; i <= LAVES__VTU_TYPES; i++)
    if (laves__word_is(name, laves__vtu_array_names[i])) return i;
  return LAVES__VTU_ARRAY_COUNT;
}

static laves_result read_source(laves__vtu *r, const tag *t, const char *content, laves__vtu_source *s, laves_error *error) {
  laves__word type = {"", 0};
  char quote[LAVES__QUOTE_SIZE];
  attribute(t, "type", &type);
  int k = 0;
  while (k < LAVES__VTU_KIND_COUNT && !laves__word_is(type, laves__vtu_kinds[k].name)) k++;
  if (k == LAVES__VTU_KIND_COUNT)
    return laves__mesh_input_fail(r->input, error, "an array has the type %s, which is not a number", laves__quote(type, quote));
  s->kind = (laves__vtu_kind)k;
  s->begin = s->end = content;
  if (!find_byte(&s->end, r->input->end, '<')) s->end = r->input->end;
  s->place = attribute_is(t, "format", "appended") ? LAVES__VTU_APPENDED
             : attribute_is(t, "format", "binary") ? LAVES__VTU_INLINE_BASE64
                                                   : LAVES__VTU_INLINE_TEXT;
  if (s->place == LAVES__VTU_APPENDED && !attribute_count(t, "offset", &s->offset))
    return laves__mesh_input_fail(r->input, error, "an appended array has no offset");
  return LAVES_OK;
}

/* Keeps an array that may be wanted; arrays of vectors and of text are none. */
static laves_result add_candidate(laves__vtu *r, laves__word section, const tag *t, const char *content, laves_error *error) {
  laves_context *context = r->input->context;
  laves__vtu_candidate c = {.per_cell = laves__word_is(section, "CellData"), .piece = r->piece_count - 1};
  laves__word name = {"", 0};
  size_t components;
  if (!r->input->values.wanted || (!c.per_cell && !laves__word_is(section, "PointData"))) return LAVES_OK;
  if ((attribute_count(t, "NumberOfComponents", &components) && components > 1) || attribute_is(t, "type", "String"))
    return LAVES_OK;
  attribute(t, "Name", &name);
  const laves_result result = read_source(r, t, content, &c.source, error);
  if (result != LAVES_OK) return result;
  const size_t needed = r->candidate_count + 1;
  if (!laves__grow(context, &r->candidates, &r->candidate_capacity, needed, sizeof *r->candidates) ||
      !laves__grow(context, &r->candidate_names, &r->candidate_name_capacity, needed, sizeof *r->candidate_names))
    return laves__fail_memory(context, error);
  r->candidates[r->candidate_count] = c;
  r->candidate_names[r->candidate_count++] = name;
  return LAVES_OK;
}

/* What a character reference in an attribute stands for; *at moves behind it. */
static char unescaped(const char **at, const char *end) {
  static const struct {
    const char *text;
    char character;
  } references[] = {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
  for (size_t i = 0; i < LAVES__COUNT_OF(references); i++)
    if (starts_with(*at, end, references[i].text)) {
      *at += strlen(references[i].text);
      return references[i].character;
    }
  return *(*at)++;
}

/* An array of the field data of pairs (number, dimension), inline: its name is that of regions and face tags, as write_vtu.c
 * tells. Any other array is passed over. */
static laves_result read_group_name(laves__vtu *r, const tag *t, const char *content, laves_error *error) {
  laves__word raw = {"", 0};
  char name[sizeof r->input->groups->name];
  size_t length = 0;
  if (!attribute_is(t, "type", "Int32") || !attribute_is(t, "NumberOfComponents", "2") || !attribute_is(t, "format", "ascii") ||
      !attribute(t, "Name", &raw))
    return LAVES_OK;
  for (const char *at = raw.at, *end = raw.at + raw.length; at < end && length < sizeof name - 1;)
    name[length++] = unescaped(&at, end);
  const char *end = content;
  if (!find_byte(&end, r->input->end, '<')) end = r->input->end;
  laves__scan scan = laves__scan_begin(NULL, content, (size_t)(end - content));
  int64_t number, dimension;
  while (laves__scan_space(&scan) && laves__scan_int(&scan, &number) && laves__scan_space(&scan) &&
         laves__scan_int(&scan, &dimension)) {
    if ((dimension != 2 && dimension != 3) || number < INT32_MIN || number > INT32_MAX) continue;
    if (!laves__mesh_input_add_group(r->input, (int)dimension, (int32_t)number, name, length))
      return laves__fail_memory(r->input->context, error);
  }
  return LAVES_OK;
}

static laves_result find_appended(laves__vtu *r, const tag *t, const char *content, laves_error *error) {
  r->appended_base64 = attribute_is(t, "encoding", "base64");
  while (content < r->input->end && is_space(*content)) content++;
  if (content == r->input->end || *content != '_')
    return laves__mesh_input_fail(r->input, error, "the appended data does not start with '_'");
  r->appended = content + 1;
  return LAVES_OK;
}

static laves_result walk(laves__vtu *r, laves_error *error) {
  const char *at = r->input->begin;
  laves__word section = {"", 0};
  laves_result result = LAVES_OK;
  bool file_seen = false;
  for (tag t; result == LAVES_OK && next_tag(&at, r->input->end, &t);) {
    if (laves__word_is(t.name, "VTKFile")) {
      result = read_file_tag(r, &t, error);
      file_seen = true;
    } else if (laves__word_is(t.name, "Piece")) {
      result = add_piece(r, &t, error);
    } else if (laves__word_is(t.name, "AppendedData")) {
      result = find_appended(r, &t, at, error);
      break; /* what follows is not XML */
    } else if (laves__word_is(t.name, "DataArray") && r->piece_count > 0) {
      const int array = array_of(section, &t);
      if (array < LAVES__VTU_ARRAY_COUNT) result = read_source(r, &t, at, &r->pieces[r->piece_count - 1].sources[array], error);
      if (result == LAVES_OK) result = add_candidate(r, section, &t, at, error);
    } else if (laves__word_is(t.name, "DataArray") && laves__word_is(section, "FieldData")) {
      result = read_group_name(r, &t, at, error);
    } else if (!laves__word_is(t.name, "/DataArray")) {
      section = t.name;
    }
  }
  if (result == LAVES_OK && !file_seen) return laves__mesh_input_fail(r->input, error, "there is no VTKFile element in it");
  return result;
}

/* Leaves only the candidates of points, or of cells. */
static void keep_candidates(laves__vtu *r, bool per_cell) {
  size_t kept = 0;
  for (size_t i = 0; i < r->candidate_count; i++) {
    if (r->candidates[i].per_cell != per_cell) continue;
    r->candidates[kept] = r->candidates[i];
    r->candidate_names[kept++] = r->candidate_names[i];
  }
  r->candidate_count = kept;
}

static bool same_name(laves__word a, laves__word b) { return a.length == b.length && memcmp(a.at, b.at, a.length) == 0; }

/* Arrays of points come first: only without any that is meant are those of cells looked at. */
static bool prefer_points(const laves__vtu *r) {
  const char *wanted = r->input->values.array;
  for (size_t i = 0; i < r->candidate_count; i++)
    if (!r->candidates[i].per_cell && (!wanted || same_name(r->candidate_names[i], (laves__word){wanted, strlen(wanted)})))
      return true;
  return false;
}

/* Gives each piece the source of the values. */
static laves_result choose_values(laves__vtu *r, laves_error *error) {
  laves__mesh_values *values = &r->input->values;
  if (!values->wanted) return LAVES_OK;
  size_t chosen = 0;
  values->per_tet = !prefer_points(r);
  if (!values->array || !values->per_tet) keep_candidates(r, values->per_tet);
  const laves_result result = laves__mesh_input_choose_array(r->input, r->candidate_names, r->candidate_count, &chosen, error);
  if (result != LAVES_OK) return result;
  LAVES_ASSERT(r->candidate_count > 0 && r->candidate_names);
  const laves__word name = r->candidate_names[chosen];
  for (size_t i = r->candidate_count; i-- > 0;) /* backwards: of two equal names in a piece the first counts */
    if (same_name(r->candidate_names[i], name))
      r->pieces[r->candidates[i].piece].sources[LAVES__VTU_VALUES] = r->candidates[i].source;
  return LAVES_OK;
}

/* ---- for who decodes ---- */

laves_result laves__vtu_read_structure(laves__vtu *r, laves_error *error) {
  const laves_result result = walk(r, error);
  return result == LAVES_OK ? choose_values(r, error) : result;
}

bool laves__is_vtu(const laves__mesh_input *input) { return laves__mesh_input_mentions(input, "<VTKFile"); }

void laves__vtu_free(laves__vtu *r) {
  laves_context *context = r->input->context;
  laves__free(context, r->pieces, r->piece_capacity, sizeof *r->pieces);
  laves__free(context, r->candidates, r->candidate_capacity, sizeof *r->candidates);
  laves__free(context, r->candidate_names, r->candidate_name_capacity, sizeof *r->candidate_names);
  r->pieces = NULL;
  r->candidates = NULL;
  r->candidate_names = NULL;
}

laves_result laves__vtu_fail_array(const laves__vtu *r, const char *name, laves_error *error) {
  return laves__mesh_input_fail(r->input, error, "the data of %s is shorter than announced or damaged", name);
}

laves_result laves__vtu_check_integers(const laves__vtu *r, const laves__vtu_piece *p, laves_error *error) {
  for (int i = LAVES__VTU_CONNECTIVITY; i <= LAVES__VTU_TYPES; i++)
    if (p->sources[i].place != LAVES__VTU_ABSENT && p->sources[i].kind >= LAVES__VTU_FLOAT32)
      return laves__mesh_input_fail(r->input, error, "the array %s must hold integers", laves__vtu_array_names[i]);
  return LAVES_OK;
}

int laves__vtu_corner_count(int64_t type) {
  switch (type) {
    case 10:
    case 24:
    case 71:
    case 79:
      return 4; /* tetrahedron: linear, quadratic, Lagrange, Bezier */
    case 5:
    case 22:
    case 34:
    case 69:
    case 76:
      return 3; /* triangle: linear, quadratic, biquadratic, Lagrange, Bezier */
    default:
      return 0;
  }
}

int64_t laves__vtu_integer(laves__vtu_kind kind, const char *at) {
  uint64_t bits = 0;
  memcpy(&bits, at, laves__vtu_kinds[kind].bytes); /* the low bytes come first */
  switch (kind) {
    case LAVES__VTU_INT8:
      return (int8_t)bits;
    case LAVES__VTU_INT16:
      return (int16_t)bits;
    case LAVES__VTU_INT32:
      return (int32_t)bits;
    default:
      return (int64_t)bits;
  }
}

double laves__vtu_real(laves__vtu_kind kind, const char *at) {
  if (kind == LAVES__VTU_FLOAT64) {
    double value;
    memcpy(&value, at, sizeof value);
    return value;
  }
  if (kind == LAVES__VTU_FLOAT32) {
    float value;
    memcpy(&value, at, sizeof value);
    return value;
  }
  return (double)laves__vtu_integer(kind, at);
}
