/* VTK's XML files of unstructured grids, and of polygons where their vertices and lines are asked for: inline text and base64,
 * appended raw and base64, plain and compressed by zlib, headers of 32 and 64 bits, any number type, any number of pieces.
 *
 * First the XML is walked, which yields the pieces and for each array of interest where its data stands; then the arrays of
 * each piece are decoded and its tets and triangles picked out, with one array of values for points or tets where the caller
 * asks for it. Sizes that the XML claims are believed only as far as the
 * bytes in the file can make them true: compressed bytes expand by at most 1032, the limit of deflate.
 * Source: VTK file formats, https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html */
#include <string.h>
#include <zlib.h>

#include "io/line_list.h"
#include "io/mesh_input.h"
#include "io/scan.h"
#include "io/zlib_memory.h"

/* How many bytes of numbers one byte of the file can hold: the limit of deflate; 8 for text ("1 " may be an Int64, and
 * there must be room left for rounding) and for plain bytes. */
enum { COMPRESSED_LIMIT = 1032, PLAIN_LIMIT = 8 };

enum { PIECE_BYTES = 1 << 20 }; /* between two questions whether to cancel */

typedef enum kind { INT8, UINT8, INT16, UINT16, INT32, UINT32, INT64, UINT64, FLOAT32, FLOAT64, KIND_COUNT } kind;
static const struct {
  const char *name;
  size_t bytes;
} kinds[KIND_COUNT] = {{"Int8", 1},   {"UInt8", 1}, {"Int16", 2},  {"UInt16", 2},  {"Int32", 4},
                       {"UInt32", 4}, {"Int64", 8}, {"UInt64", 8}, {"Float32", 4}, {"Float64", 8}};

typedef enum place { ABSENT, INLINE_TEXT, INLINE_BASE64, APPENDED } place;

/* Where an array's data is, as the XML says. */
typedef struct source {
  place place;
  kind kind;
  size_t offset;           /* of appended data */
  const char *begin, *end; /* of inline data */
} source;

/* The last four are those of polygon files. */
enum {
  POINTS,
  CONNECTIVITY,
  OFFSETS,
  TYPES,
  REGION,
  VALUES,
  VERT_CONNECTIVITY,
  VERT_OFFSETS,
  LINE_CONNECTIVITY,
  LINE_OFFSETS,
  ARRAY_COUNT
};
static const char *const array_names[] = {"the points",
                                          "connectivity",
                                          "offsets",
                                          "types",
                                          "the regions",
                                          "the values",
                                          "the connectivity of vertices",
                                          "the offsets of vertices",
                                          "the connectivity of lines",
                                          "the offsets of lines"};

typedef struct piece {
  size_t point_count, cell_count; /* polygon files: of vertices and lines in the place of cells */
  size_t vert_count, line_count;
  source sources[ARRAY_COUNT];
} piece;

/* An array that may be the one with the wanted values: one number for each point or cell. */
typedef struct candidate {
  bool per_cell;
  size_t piece;
  source source;
} candidate;

typedef struct reader {
  laves__mesh_input *input;
  bool polygons; /* PolyData */
  bool wide_header, compressed;
  bool appended_base64;
  const char *appended; /* first byte behind the '_'; NULL: none */
  double decoded;       /* bytes of all arrays so far; pieces may share data, so each alone tells too little */
  piece *pieces;
  size_t piece_count, piece_capacity;
  candidate *candidates;
  laves__word *candidate_names;
  size_t candidate_count, candidate_capacity, candidate_name_capacity;
} reader;

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

static laves_result read_file_tag(reader *r, const tag *t, laves_error *error) {
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

static laves_result add_piece(reader *r, const tag *t, laves_error *error) {
  if (!laves__grow(r->input->context, &r->pieces, &r->piece_capacity, r->piece_count + 1, sizeof *r->pieces))
    return laves__fail_memory(r->input->context, error);
  piece *p = &r->pieces[r->piece_count++];
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
static bool is_region_name(laves__word name) {
  static const char *const known[] = {"region",      "gmsh:physical", "medit:ref", "tetgen:ref",
                                      "MaterialIds", "CellEntityIds", "material"};
  for (size_t i = 0; i < LAVES__COUNT_OF(known); i++)
    if (laves__word_is(name, known[i])) return true;
  return false;
}

/* Which array an element in this section is, or ARRAY_COUNT. */
static int array_of(laves__word section, const tag *t) {
  laves__word name = {"", 0};
  attribute(t, "Name", &name);
  if (laves__word_is(section, "Points")) return POINTS;
  if (laves__word_is(section, "CellData") && is_region_name(name)) return REGION;
  if (laves__word_is(section, "Verts") || laves__word_is(section, "Lines")) {
    const bool is_line = laves__word_is(section, "Lines");
    if (laves__word_is(name, "connectivity")) return is_line ? LINE_CONNECTIVITY : VERT_CONNECTIVITY;
    return laves__word_is(name, "offsets") ? (is_line ? LINE_OFFSETS : VERT_OFFSETS) : ARRAY_COUNT;
  }
  if (!laves__word_is(section, "Cells")) return ARRAY_COUNT;
  for (int i = CONNECTIVITY; i <= TYPES; i++)
    if (laves__word_is(name, array_names[i])) return i;
  return ARRAY_COUNT;
}

static laves_result read_source(reader *r, const tag *t, const char *content, source *s, laves_error *error) {
  laves__word type = {"", 0};
  char quote[LAVES__QUOTE_SIZE];
  attribute(t, "type", &type);
  int k = 0;
  while (k < KIND_COUNT && !laves__word_is(type, kinds[k].name)) k++;
  if (k == KIND_COUNT)
    return laves__mesh_input_fail(r->input, error, "an array has the type %s, which is not a number", laves__quote(type, quote));
  s->kind = (kind)k;
  s->begin = s->end = content;
  if (!find_byte(&s->end, r->input->end, '<')) s->end = r->input->end;
  s->place = attribute_is(t, "format", "appended") ? APPENDED : attribute_is(t, "format", "binary") ? INLINE_BASE64 : INLINE_TEXT;
  if (s->place == APPENDED && !attribute_count(t, "offset", &s->offset))
    return laves__mesh_input_fail(r->input, error, "an appended array has no offset");
  return LAVES_OK;
}

/* Keeps an array that may be wanted; arrays of vectors and of text are none. */
static laves_result add_candidate(reader *r, laves__word section, const tag *t, const char *content, laves_error *error) {
  laves_context *context = r->input->context;
  candidate c = {.per_cell = laves__word_is(section, "CellData"), .piece = r->piece_count - 1};
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
static laves_result read_group_name(reader *r, const tag *t, const char *content, laves_error *error) {
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

static laves_result find_appended(reader *r, const tag *t, const char *content, laves_error *error) {
  r->appended_base64 = attribute_is(t, "encoding", "base64");
  while (content < r->input->end && is_space(*content)) content++;
  if (content == r->input->end || *content != '_')
    return laves__mesh_input_fail(r->input, error, "the appended data does not start with '_'");
  r->appended = content + 1;
  return LAVES_OK;
}

static laves_result read_structure(reader *r, laves_error *error) {
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
      if (array < ARRAY_COUNT) result = read_source(r, &t, at, &r->pieces[r->piece_count - 1].sources[array], error);
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
static void keep_candidates(reader *r, bool per_cell) {
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
static bool prefer_points(const reader *r) {
  const char *wanted = r->input->values.array;
  for (size_t i = 0; i < r->candidate_count; i++)
    if (!r->candidates[i].per_cell && (!wanted || same_name(r->candidate_names[i], (laves__word){wanted, strlen(wanted)})))
      return true;
  return false;
}

/* Gives each piece the source of the values. */
static laves_result choose_values(reader *r, laves_error *error) {
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
    if (same_name(r->candidate_names[i], name)) r->pieces[r->candidates[i].piece].sources[VALUES] = r->candidates[i].source;
  return LAVES_OK;
}

/* ---- bytes ---- */

/* Bytes as they come, or decoded from base64 group by group: header and data may be one stream of groups or two. */
typedef struct stream {
  const char *at, *end;
  bool base64;
  uint8_t held[3];
  int held_count, held_used;
} stream;

static int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/* Decodes the next four characters. */
static bool next_group(stream *s) {
  uint32_t bits = 0;
  int digits = 0, padding = 0;
  while (digits + padding < 4) {
    while (s->at < s->end && is_space(*s->at)) s->at++;
    if (s->at == s->end) return false;
    const char c = *s->at++;
    const int value = base64_value(c);
    if (c == '=')
      padding++;
    else if (value < 0 || padding > 0)
      return false;
    else
      digits++;
    bits = bits << 6 | (uint32_t)(value < 0 ? 0 : value);
  }
  for (int i = 0; i < 3; i++) s->held[i] = (uint8_t)(bits >> (16 - 8 * i));
  s->held_count = digits - 1;
  s->held_used = 0;
  return digits >= 2;
}

static bool stream_read(stream *s, void *bytes, size_t count) {
  if (!s->base64) {
    if ((size_t)(s->end - s->at) < count) return false;
    memcpy(bytes, s->at, count);
    s->at += count;
    return true;
  }
  for (uint8_t *to = bytes; count > 0; count--) {
    if (s->held_used == s->held_count && !next_group(s)) return false;
    *to++ = s->held[s->held_used++];
  }
  return true;
}

static bool stream_header(const reader *r, stream *s, uint64_t *value) {
  uint32_t narrow;
  if (r->wide_header) return stream_read(s, value, sizeof *value);
  if (!stream_read(s, &narrow, sizeof narrow)) return false;
  *value = narrow;
  return true;
}

/* ---- arrays ---- */

typedef struct array {
  kind kind;
  size_t count, bytes;
  char *data;
} array;

static void free_array(reader *r, array *a) {
  laves__free(r->input->context, a->data, a->bytes, 1);
  a->data = NULL;
}

static laves_result fail_array(reader *r, const char *name, laves_error *error) {
  return laves__mesh_input_fail(r->input, error, "the data of %s is shorter than announced or damaged", name);
}

static void put_value(array *a, size_t i, double real, int64_t integer) {
  const size_t size = kinds[a->kind].bytes;
  const float narrow = (float)real;
  if (a->kind == FLOAT64)
    memcpy(a->data + i * size, &real, size);
  else if (a->kind == FLOAT32)
    memcpy(a->data + i * size, &narrow, size);
  else
    memcpy(a->data + i * size, &integer, size); /* the low bytes come first */
}

static laves_result read_text(reader *r, const source *s, const char *name, array *a, laves_error *error) {
  laves__scan scan = laves__scan_begin(r->input->name, r->input->begin, (size_t)(s->end - r->input->begin));
  scan.at = s->begin;
  for (size_t i = 0; i < a->count; i++) {
    double real = 0;
    int64_t integer = 0;
    const bool found =
        laves__scan_space(&scan) && (a->kind >= FLOAT32 ? laves__scan_double(&scan, &real) : laves__scan_int(&scan, &integer));
    if (!found) return laves__scan_fail_expected(&scan, error, name);
    put_value(a, i, real, integer);
    if (laves__cancelled_at(r->input->context, "read", i, a->count)) return laves__fail_cancelled(error);
  }
  return LAVES_OK;
}

/* Inflates `left` bytes, piece by piece; Z_STREAM_END when that was all and nothing was missing. */
static int inflate_pieces(reader *r, z_stream *z, size_t left) {
  int status;
  do {
    if (laves__cancelled(r->input->context, "read", 0)) return Z_BUF_ERROR;
    z->avail_out = (uInt)(left < PIECE_BYTES ? left : PIECE_BYTES);
    left -= z->avail_out;
    status = inflate(z, left > 0 ? Z_NO_FLUSH : Z_FINISH);
  } while (status == Z_OK && z->avail_out == 0 && left > 0);
  return status == Z_STREAM_END && (z->avail_out > 0 || left > 0) ? Z_BUF_ERROR : status;
}

/* Inflates one block of exactly out_count bytes. */
static laves_result inflate_block(reader *r, const char *name, const char *bytes, size_t count, char *out, size_t out_count,
                                  laves_error *error) {
  laves_context *context = r->input->context;
  z_stream z = {.zalloc = laves__zlib_allocate, .zfree = laves__zlib_free, .opaque = context};
  if (count > UINT32_MAX || out_count > UINT32_MAX) return fail_array(r, name, error);
  if (inflateInit(&z) != Z_OK) return laves__fail_memory(context, error);
  z.next_in = (Bytef *)bytes;
  z.avail_in = (uInt)count;
  z.next_out = (Bytef *)out;
  const int status = inflate_pieces(r, &z, out_count);
  inflateEnd(&z);
  if (laves__is_cancelled(context)) return laves__fail_cancelled(error);
  if (status == Z_MEM_ERROR) return laves__fail_memory(context, error);
  return status == Z_STREAM_END ? LAVES_OK : fail_array(r, name, error);
}

static laves_result read_block(reader *r, stream *s, const char *name, size_t packed_bytes, char *out, size_t out_bytes,
                               laves_error *error) {
  laves_context *context = r->input->context;
  if (packed_bytes > (size_t)(s->end - s->at)) return fail_array(r, name, error);
  if (laves__mesh_input_cancelled(r->input, s->at)) return laves__fail_cancelled(error);
  char *packed = laves__alloc(context, packed_bytes, 1);
  if (!packed) return laves__fail_memory(context, error);
  const laves_result result = stream_read(s, packed, packed_bytes)
                                  ? inflate_block(r, name, packed, packed_bytes, out, out_bytes, error)
                                  : fail_array(r, name, error);
  laves__free(context, packed, packed_bytes, 1);
  return result;
}

/* Reads the block sizes that follow the three numbers of the header, then each block. */
static laves_result read_blocks(reader *r, stream *s, const uint64_t head[3], const char *name, array *a, laves_error *error) {
  laves_context *context = r->input->context;
  const size_t blocks = (size_t)head[0];
  uint64_t *sizes = laves__alloc(context, blocks, sizeof *sizes);
  if (!sizes) return laves__fail_memory(context, error);
  laves_result result = LAVES_OK;
  for (size_t i = 0; i < blocks && result == LAVES_OK; i++)
    if (!stream_header(r, s, &sizes[i])) result = fail_array(r, name, error);
  size_t done = 0;
  for (size_t i = 0; i < blocks && result == LAVES_OK; i++) {
    const uint64_t bytes = i + 1 == blocks && head[2] > 0 ? head[2] : head[1];
    result = bytes > a->bytes - done ? fail_array(r, name, error)
                                     : read_block(r, s, name, sizes[i], a->data + done, (size_t)bytes, error);
    done += (size_t)bytes;
  }
  laves__free(context, sizes, blocks, sizeof *sizes);
  return result == LAVES_OK && done != a->bytes ? fail_array(r, name, error) : result;
}

static laves_result read_compressed(reader *r, stream *s, const char *name, array *a, laves_error *error) {
  uint64_t head[3]; /* number of blocks, size of each, size of the last or 0 */
  for (int i = 0; i < 3; i++)
    if (!stream_header(r, s, &head[i])) return fail_array(r, name, error);
  if (head[0] > (uint64_t)(s->end - s->at) / 4) return fail_array(r, name, error); /* each has a size of 4 bytes or more */
  return read_blocks(r, s, head, name, a, error);
}

static laves_result read_plain(reader *r, stream *s, const char *name, array *a, laves_error *error) {
  uint64_t bytes;
  if (!stream_header(r, s, &bytes) || bytes != a->bytes) return fail_array(r, name, error);
  for (size_t done = 0, part; done < a->bytes; done += part) {
    part = a->bytes - done < PIECE_BYTES ? a->bytes - done : PIECE_BYTES;
    if (laves__mesh_input_cancelled(r->input, s->at)) return laves__fail_cancelled(error);
    if (!stream_read(s, a->data + done, part)) return fail_array(r, name, error);
  }
  return LAVES_OK;
}

/* Decodes an array of which `count` numbers are needed. */
static laves_result read_array(reader *r, const piece *p, int which, size_t count, array *a, laves_error *error) {
  const source *s = &p->sources[which];
  const char *name = array_names[which];
  laves_context *context = r->input->context;
  const size_t length = (size_t)(r->input->end - r->input->begin);
  *a = (array){.kind = s->kind, .count = count, .bytes = count * kinds[s->kind].bytes};
  if (s->place == ABSENT) return laves__mesh_input_fail(r->input, error, "a piece lacks %s", name);
  r->decoded += (double)a->bytes;
  if (r->decoded > (double)length * (r->compressed ? COMPRESSED_LIMIT : PLAIN_LIMIT)) return fail_array(r, name, error);
  stream st = {.at = s->begin, .end = s->end, .base64 = true};
  if (s->place == APPENDED) {
    if (!r->appended || s->offset > (size_t)(r->input->end - r->appended)) return fail_array(r, name, error);
    st = (stream){.at = r->appended + s->offset, .end = r->input->end, .base64 = r->appended_base64};
  }
  a->data = laves__alloc(context, a->bytes, 1);
  if (!a->data) return laves__fail_memory(context, error);
  if (s->place == INLINE_TEXT) return read_text(r, s, name, a, error);
  if (count == 0) return LAVES_OK;
  return r->compressed ? read_compressed(r, &st, name, a, error) : read_plain(r, &st, name, a, error);
}

/* Integers of all kinds but UInt64 beyond 2^63, which becomes negative and is refused as an index. */
static int64_t integer_at(const array *a, size_t i) {
  const char *at = a->data + i * kinds[a->kind].bytes;
  uint64_t bits = 0;
  memcpy(&bits, at, kinds[a->kind].bytes); /* the low bytes come first */
  switch (a->kind) {
    case INT8:
      return (int8_t)bits;
    case INT16:
      return (int16_t)bits;
    case INT32:
      return (int32_t)bits;
    default:
      return (int64_t)bits;
  }
}

static double real_at(const array *a, size_t i) {
  const char *at = a->data + i * kinds[a->kind].bytes;
  if (a->kind == FLOAT64) {
    double value;
    memcpy(&value, at, sizeof value);
    return value;
  }
  if (a->kind == FLOAT32) {
    float value;
    memcpy(&value, at, sizeof value);
    return value;
  }
  return (double)integer_at(a, i);
}

static int32_t region_at(const array *a, size_t i) {
  if (!a->data) return 1;
  const double value = real_at(a, i);
  if (!(value >= INT32_MIN)) return INT32_MIN;
  return value > INT32_MAX ? INT32_MAX : (int32_t)value;
}

/* ---- pieces ---- */

/* Corners of a linear cell or of a curved one, whose corners come first; 0: another shape. */
static int corner_count(int64_t type) {
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

/* ---- points and lines ---- */

/* What a cell is to those who ask for points and lines. */
typedef enum line_kind { NO_LINE, SINGLES, STRAIGHT, CURVED } line_kind;

static line_kind line_kind_of(int64_t type) {
  switch (type) {
    case 1:
    case 2:
      return SINGLES; /* vertex, vertices */
    case 3:
    case 4:
      return STRAIGHT; /* line, polyline */
    case 21:
    case 35:
    case 68:
    case 75:
      return CURVED; /* quadratic, cubic, Lagrange, Bezier: the ends come first, then what lies between them */
    default:
      return NO_LINE;
  }
}

/* One cell of `size` points, of which the first stands at `first` of the connectivity. */
static laves_result add_line_cell(reader *r, const array *connectivity, line_kind use, int64_t first, int64_t size,
                                  size_t point_base, size_t point_count, laves_error *error) {
  laves__line_list *list = r->input->lines;
  bool enough = true;
  for (int64_t j = 0; j < size && enough; j++) {
    const int64_t at = use != CURVED || j == 0 ? j : j == size - 1 ? 1 : j + 1;
    const int64_t index = integer_at(connectivity, (size_t)(first + at));
    if (index < 0 || (uint64_t)index >= point_count)
      return laves__mesh_input_fail(r->input, error, "a line uses point %lld, but the points are 0 to %lld", (long long)index,
                                    (long long)point_count - 1);
    const int32_t point = (int32_t)(point_base + (size_t)index);
    enough = use == SINGLES ? laves__line_list_add_single(list, point) : laves__line_list_add_node(list, point);
  }
  return enough && laves__line_list_end(list) ? LAVES_OK : laves__fail_memory(r->input->context, error);
}

/* The vertices or lines of a polygon file. */
static laves_result add_polygon_lines(reader *r, const piece *p, bool is_line, size_t point_base, laves_error *error) {
  const int first_array = is_line ? LINE_CONNECTIVITY : VERT_CONNECTIVITY;
  const size_t count = is_line ? p->line_count : p->vert_count;
  array connectivity = {0}, offsets = {0};
  if (count == 0) return LAVES_OK;
  for (int i = first_array; i < first_array + 2; i++)
    if (p->sources[i].place != ABSENT && p->sources[i].kind >= FLOAT32)
      return laves__mesh_input_fail(r->input, error, "the array of %s must hold integers", array_names[i]);
  laves_result result = read_array(r, p, first_array + 1, count, &offsets, error);
  const int64_t used = result == LAVES_OK ? integer_at(&offsets, count - 1) : 0;
  if (result == LAVES_OK && (used < 0 || (uint64_t)used > SIZE_MAX / 64))
    result = fail_array(r, array_names[first_array + 1], error);
  if (result == LAVES_OK) result = read_array(r, p, first_array, (size_t)used, &connectivity, error);
  int64_t first = 0;
  for (size_t i = 0; i < count && result == LAVES_OK; i++) {
    const int64_t end = integer_at(&offsets, i);
    if (end < first || end > used)
      result = laves__mesh_input_fail(r->input, error, "the offset of line %zu (counted from 0) is out of order", i);
    else
      result =
          add_line_cell(r, &connectivity, is_line ? STRAIGHT : SINGLES, first, end - first, point_base, p->point_count, error);
    first = end;
  }
  free_array(r, &offsets);
  free_array(r, &connectivity);
  return result;
}

/* ---- cells ---- */

static laves_result add_cell(reader *r, const array arrays[ARRAY_COUNT], size_t cell, int64_t first, int64_t size,
                             size_t point_base, size_t point_count, laves_error *error) {
  const int64_t type = integer_at(&arrays[TYPES], cell);
  const int corners = corner_count(type);
  const line_kind use = r->input->lines ? line_kind_of(type) : NO_LINE;
  if (use != NO_LINE) return add_line_cell(r, &arrays[CONNECTIVITY], use, first, size, point_base, point_count, error);
  if (corners == 0) return LAVES_OK;
  if (size < corners) return laves__mesh_input_fail(r->input, error, "cell %zu (counted from 0) has too few corners", cell);
  int32_t indices[4];
  for (int j = 0; j < corners; j++) {
    const int64_t index = integer_at(&arrays[CONNECTIVITY], (size_t)(first + j));
    if (index < 0 || (uint64_t)index >= point_count)
      return laves__mesh_input_fail(r->input, error, "cell %zu uses point %lld, but the points are 0 to %lld", cell,
                                    (long long)index, (long long)point_count - 1);
    indices[j] = (int32_t)(point_base + (size_t)index);
  }
  r->input->higher_order |= size > corners;
  const int32_t region = region_at(&arrays[REGION], cell);
  if (corners == 4 && arrays[VALUES].data && !laves__mesh_input_add_value(r->input, real_at(&arrays[VALUES], cell)))
    return laves__fail_memory(r->input->context, error);
  const bool enough =
      corners == 4 ? laves__mesh_input_add_tet(r->input, indices, region) : laves__mesh_input_add_face(r->input, indices, region);
  return enough ? LAVES_OK : laves__fail_memory(r->input->context, error);
}

static laves_result add_cells(reader *r, const piece *p, array arrays[ARRAY_COUNT], size_t point_base, laves_error *error) {
  laves_result result = LAVES_OK;
  int64_t first = 0;
  for (size_t i = 0; i < p->cell_count && result == LAVES_OK; i++) {
    const int64_t end = integer_at(&arrays[OFFSETS], i);
    if (end < first || (uint64_t)end > arrays[CONNECTIVITY].count)
      return laves__mesh_input_fail(r->input, error, "the offset of cell %zu (counted from 0) is out of order", i);
    result = add_cell(r, arrays, i, first, end - first, point_base, p->point_count, error);
    if (i % 65536 == 65535 && laves__mesh_input_cancelled(r->input, r->input->end)) return laves__fail_cancelled(error);
    first = end;
  }
  return result;
}

static laves_result add_points(reader *r, const piece *p, laves_error *error) {
  array points;
  laves_result result = read_array(r, p, POINTS, 3 * p->point_count, &points, error);
  if (result == LAVES_OK && r->input->point_count + p->point_count > INT32_MAX)
    result = laves__mesh_input_fail(r->input, error, "it has more than 2147483647 points");
  for (size_t i = 0; i < p->point_count && result == LAVES_OK; i++) {
    const laves__vec3 point = v3(real_at(&points, 3 * i), real_at(&points, 3 * i + 1), real_at(&points, 3 * i + 2));
    if (!laves__mesh_input_add_point(r->input, point)) result = laves__fail_memory(r->input->context, error);
    if (laves__cancelled_at(r->input->context, "read", i, p->point_count)) result = laves__fail_cancelled(error);
  }
  free_array(r, &points);
  return result;
}

/* The values of a piece's points; those of tets are picked out with the cells. */
static laves_result add_values(reader *r, const piece *p, laves_error *error) {
  array values = {0};
  laves_result result = read_array(r, p, VALUES, p->point_count, &values, error);
  for (size_t i = 0; i < p->point_count && result == LAVES_OK; i++) {
    if (!laves__mesh_input_add_value(r->input, real_at(&values, i))) result = laves__fail_memory(r->input->context, error);
    if (laves__cancelled_at(r->input->context, "read", i, p->point_count)) result = laves__fail_cancelled(error);
  }
  free_array(r, &values);
  return result;
}

static laves_result check_integers(reader *r, const piece *p, laves_error *error) {
  for (int i = CONNECTIVITY; i <= TYPES; i++)
    if (p->sources[i].place != ABSENT && p->sources[i].kind >= FLOAT32)
      return laves__mesh_input_fail(r->input, error, "the array %s must hold integers", array_names[i]);
  return LAVES_OK;
}

static laves_result read_piece(reader *r, const piece *p, laves_error *error) {
  if (p->cell_count == 0 && p->point_count == 0) return LAVES_OK;
  array arrays[ARRAY_COUNT] = {0};
  const size_t point_base = r->input->point_count;
  laves_result result = check_integers(r, p, error);
  if (result == LAVES_OK) result = add_points(r, p, error);
  const laves__mesh_values *values = &r->input->values;
  if (result == LAVES_OK && values->wanted && !values->per_tet) result = add_values(r, p, error);
  if (result == LAVES_OK && r->polygons) result = add_polygon_lines(r, p, false, point_base, error);
  if (result == LAVES_OK && r->polygons) result = add_polygon_lines(r, p, true, point_base, error);
  if (result != LAVES_OK || p->cell_count == 0) return result;
  result = read_array(r, p, OFFSETS, p->cell_count, &arrays[OFFSETS], error);
  if (result == LAVES_OK) result = read_array(r, p, TYPES, p->cell_count, &arrays[TYPES], error);
  if (result == LAVES_OK && p->sources[REGION].place != ABSENT)
    result = read_array(r, p, REGION, p->cell_count, &arrays[REGION], error);
  if (result == LAVES_OK && values->wanted && values->per_tet)
    result = read_array(r, p, VALUES, p->cell_count, &arrays[VALUES], error);
  if (result == LAVES_OK) {
    const int64_t corners = integer_at(&arrays[OFFSETS], p->cell_count - 1);
    if (corners < 0 || (uint64_t)corners > SIZE_MAX / 64) result = fail_array(r, array_names[OFFSETS], error);
    if (result == LAVES_OK) result = read_array(r, p, CONNECTIVITY, (size_t)corners, &arrays[CONNECTIVITY], error);
  }
  if (result == LAVES_OK) result = add_cells(r, p, arrays, point_base, error);
  for (int i = 0; i < ARRAY_COUNT; i++) free_array(r, &arrays[i]);
  return result;
}

laves_result laves__read_vtu(laves__mesh_input *input, laves_error *error) {
  reader r = {.input = input};
  laves_result result = read_structure(&r, error);
  if (result == LAVES_OK) result = choose_values(&r, error);
  for (size_t i = 0; i < r.piece_count && result == LAVES_OK; i++) result = read_piece(&r, &r.pieces[i], error);
  laves__free(input->context, r.pieces, r.piece_capacity, sizeof *r.pieces);
  laves__free(input->context, r.candidates, r.candidate_capacity, sizeof *r.candidates);
  laves__free(input->context, r.candidate_names, r.candidate_name_capacity, sizeof *r.candidate_names);
  return result;
}
