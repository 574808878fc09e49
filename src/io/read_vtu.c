/* VTK's XML files of unstructured grids, and of polygons where their vertices and lines are asked for: inline text and base64,
 * appended raw and base64, plain and compressed by zlib, headers of 32 and 64 bits, any number type, any number of pieces.
 *
 * First the XML is walked (vtu_structure.c); then the arrays of each piece are decoded and its tets and triangles picked out,
 * with one array of values for points or tets where the caller asks for it. Sizes that the XML claims are believed only as far as
 * the bytes in the file can make them true: compressed bytes expand by at most 1032, the limit of deflate. Source: VTK file
 * formats, https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html */
#include <string.h>
#include <zlib.h>

#include "io/line_list.h"
#include "io/mesh_input.h"
#include "io/scan.h"
#include "io/vtu.h"
#include "io/zlib_memory.h"

enum { PIECE_BYTES = 1 << 20 }; /* between two questions whether to cancel */

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

static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

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

static bool stream_header(const laves__vtu *r, stream *s, uint64_t *value) {
  uint32_t narrow;
  if (r->wide_header) return stream_read(s, value, sizeof *value);
  if (!stream_read(s, &narrow, sizeof narrow)) return false;
  *value = narrow;
  return true;
}

/* ---- arrays ---- */

typedef struct array {
  laves__vtu_kind kind;
  size_t count, bytes;
  char *data;
} array;

static void free_array(laves__vtu *r, array *a) {
  laves__free(r->input->context, a->data, a->bytes, 1);
  a->data = NULL;
}

static void put_value(array *a, size_t i, double real, int64_t integer) {
  const size_t size = laves__vtu_kinds[a->kind].bytes;
  const float narrow = (float)real;
  if (a->kind == LAVES__VTU_FLOAT64)
    memcpy(a->data + i * size, &real, size);
  else if (a->kind == LAVES__VTU_FLOAT32)
    memcpy(a->data + i * size, &narrow, size);
  else
    memcpy(a->data + i * size, &integer, size); /* the low bytes come first */
}

static laves_result read_text(laves__vtu *r, const laves__vtu_source *s, const char *name, array *a, laves_error *error) {
  laves__scan scan = laves__scan_begin(r->input->name, r->input->begin, (size_t)(s->end - r->input->begin));
  scan.at = s->begin;
  for (size_t i = 0; i < a->count; i++) {
    double real = 0;
    int64_t integer = 0;
    const bool found = laves__scan_space(&scan) &&
                       (a->kind >= LAVES__VTU_FLOAT32 ? laves__scan_double(&scan, &real) : laves__scan_int(&scan, &integer));
    if (!found) return laves__scan_fail_expected(&scan, error, name);
    put_value(a, i, real, integer);
    if (laves__cancelled_at(r->input->context, "read", i, a->count)) return laves__fail_cancelled(error);
  }
  return LAVES_OK;
}

/* Inflates `left` bytes, piece by piece; Z_STREAM_END when that was all and nothing was missing. */
static int inflate_pieces(laves__vtu *r, z_stream *z, size_t left) {
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
static laves_result inflate_block(laves__vtu *r, const char *name, const char *bytes, size_t count, char *out, size_t out_count,
                                  laves_error *error) {
  laves_context *context = r->input->context;
  z_stream z = {.zalloc = laves__zlib_allocate, .zfree = laves__zlib_free, .opaque = context};
  if (count > UINT32_MAX || out_count > UINT32_MAX) return laves__vtu_fail_array(r, name, error);
  if (inflateInit(&z) != Z_OK) return laves__fail_memory(context, error);
  z.next_in = (Bytef *)bytes;
  z.avail_in = (uInt)count;
  z.next_out = (Bytef *)out;
  const int status = inflate_pieces(r, &z, out_count);
  inflateEnd(&z);
  if (laves__is_cancelled(context)) return laves__fail_cancelled(error);
  if (status == Z_MEM_ERROR) return laves__fail_memory(context, error);
  return status == Z_STREAM_END ? LAVES_OK : laves__vtu_fail_array(r, name, error);
}

static laves_result read_block(laves__vtu *r, stream *s, const char *name, size_t packed_bytes, char *out, size_t out_bytes,
                               laves_error *error) {
  laves_context *context = r->input->context;
  if (packed_bytes > (size_t)(s->end - s->at)) return laves__vtu_fail_array(r, name, error);
  if (laves__mesh_input_cancelled(r->input, s->at)) return laves__fail_cancelled(error);
  char *packed = laves__alloc(context, packed_bytes, 1);
  if (!packed) return laves__fail_memory(context, error);
  const laves_result result = stream_read(s, packed, packed_bytes)
                                  ? inflate_block(r, name, packed, packed_bytes, out, out_bytes, error)
                                  : laves__vtu_fail_array(r, name, error);
  laves__free(context, packed, packed_bytes, 1);
  return result;
}

/* Reads the block sizes that follow the three numbers of the header, then each block. */
static laves_result read_blocks(laves__vtu *r, stream *s, const uint64_t head[3], const char *name, array *a,
                                laves_error *error) {
  laves_context *context = r->input->context;
  const size_t blocks = (size_t)head[0];
  uint64_t *sizes = laves__alloc(context, blocks, sizeof *sizes);
  if (!sizes) return laves__fail_memory(context, error);
  laves_result result = LAVES_OK;
  for (size_t i = 0; i < blocks && result == LAVES_OK; i++)
    if (!stream_header(r, s, &sizes[i])) result = laves__vtu_fail_array(r, name, error);
  size_t done = 0;
  for (size_t i = 0; i < blocks && result == LAVES_OK; i++) {
    const uint64_t bytes = i + 1 == blocks && head[2] > 0 ? head[2] : head[1];
    result = bytes > a->bytes - done ? laves__vtu_fail_array(r, name, error)
                                     : read_block(r, s, name, sizes[i], a->data + done, (size_t)bytes, error);
    done += (size_t)bytes;
  }
  laves__free(context, sizes, blocks, sizeof *sizes);
  return result == LAVES_OK && done != a->bytes ? laves__vtu_fail_array(r, name, error) : result;
}

static laves_result read_compressed(laves__vtu *r, stream *s, const char *name, array *a, laves_error *error) {
  uint64_t head[3]; /* number of blocks, size of each, size of the last or 0 */
  for (int i = 0; i < 3; i++)
    if (!stream_header(r, s, &head[i])) return laves__vtu_fail_array(r, name, error);
  if (head[0] > (uint64_t)(s->end - s->at) / 4)
    return laves__vtu_fail_array(r, name, error); /* each has a size of 4 bytes or more */
  return read_blocks(r, s, head, name, a, error);
}

static laves_result read_plain(laves__vtu *r, stream *s, const char *name, array *a, laves_error *error) {
  uint64_t bytes;
  if (!stream_header(r, s, &bytes) || bytes != a->bytes) return laves__vtu_fail_array(r, name, error);
  for (size_t done = 0, part; done < a->bytes; done += part) {
    part = a->bytes - done < PIECE_BYTES ? a->bytes - done : PIECE_BYTES;
    if (laves__mesh_input_cancelled(r->input, s->at)) return laves__fail_cancelled(error);
    if (!stream_read(s, a->data + done, part)) return laves__vtu_fail_array(r, name, error);
  }
  return LAVES_OK;
}

/* Decodes an array of which `count` numbers are needed. */
static laves_result read_array(laves__vtu *r, const laves__vtu_piece *p, int which, size_t count, array *a, laves_error *error) {
  const laves__vtu_source *s = &p->sources[which];
  const char *name = laves__vtu_array_names[which];
  laves_context *context = r->input->context;
  const size_t length = (size_t)(r->input->end - r->input->begin);
  *a = (array){.kind = s->kind, .count = count, .bytes = count * laves__vtu_kinds[s->kind].bytes};
  if (s->place == LAVES__VTU_ABSENT) return laves__mesh_input_fail(r->input, error, "a piece lacks %s", name);
  r->decoded += (double)a->bytes;
  if (r->decoded > (double)length * (r->compressed ? LAVES__VTU_COMPRESSED_LIMIT : LAVES__VTU_PLAIN_LIMIT))
    return laves__vtu_fail_array(r, name, error);
  stream st = {.at = s->begin, .end = s->end, .base64 = true};
  if (s->place == LAVES__VTU_APPENDED) {
    if (!r->appended || s->offset > (size_t)(r->input->end - r->appended)) return laves__vtu_fail_array(r, name, error);
    st = (stream){.at = r->appended + s->offset, .end = r->input->end, .base64 = r->appended_base64};
  }
  a->data = laves__alloc(context, a->bytes, 1);
  if (!a->data) return laves__fail_memory(context, error);
  if (s->place == LAVES__VTU_INLINE_TEXT) return read_text(r, s, name, a, error);
  if (count == 0) return LAVES_OK;
  return r->compressed ? read_compressed(r, &st, name, a, error) : read_plain(r, &st, name, a, error);
}

static int64_t integer_at(const array *a, size_t i) {
  return laves__vtu_integer(a->kind, a->data + i * laves__vtu_kinds[a->kind].bytes);
}

static double real_at(const array *a, size_t i) {
  return laves__vtu_real(a->kind, a->data + i * laves__vtu_kinds[a->kind].bytes);
}

static int32_t region_at(const array *a, size_t i) {
  if (!a->data) return 1;
  const double value = real_at(a, i);
  if (!(value >= INT32_MIN)) return INT32_MIN;
  return value > INT32_MAX ? INT32_MAX : (int32_t)value;
}

/* ---- pieces ---- */

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
static laves_result add_line_cell(laves__vtu *r, const array *connectivity, line_kind use, int64_t first, int64_t size,
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
static laves_result add_polygon_lines(laves__vtu *r, const laves__vtu_piece *p, bool is_line, size_t point_base,
                                      laves_error *error) {
  const int first_array = is_line ? LAVES__VTU_LINE_CONNECTIVITY : LAVES__VTU_VERT_CONNECTIVITY;
  const size_t count = is_line ? p->line_count : p->vert_count;
  array connectivity = {0}, offsets = {0};
  if (count == 0) return LAVES_OK;
  for (int i = first_array; i < first_array + 2; i++)
    if (p->sources[i].place != LAVES__VTU_ABSENT && p->sources[i].kind >= LAVES__VTU_FLOAT32)
      return laves__mesh_input_fail(r->input, error, "the array of %s must hold integers", laves__vtu_array_names[i]);
  laves_result result = read_array(r, p, first_array + 1, count, &offsets, error);
  const int64_t used = result == LAVES_OK ? integer_at(&offsets, count - 1) : 0;
  if (result == LAVES_OK && (used < 0 || (uint64_t)used > SIZE_MAX / 64))
    result = laves__vtu_fail_array(r, laves__vtu_array_names[first_array + 1], error);
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

static laves_result add_cell(laves__vtu *r, const array arrays[LAVES__VTU_ARRAY_COUNT], size_t cell, int64_t first, int64_t size,
                             size_t point_base, size_t point_count, laves_error *error) {
  const int64_t type = integer_at(&arrays[LAVES__VTU_TYPES], cell);
  const int corners = laves__vtu_corner_count(type);
  const line_kind use = r->input->lines ? line_kind_of(type) : NO_LINE;
  if (use != NO_LINE) return add_line_cell(r, &arrays[LAVES__VTU_CONNECTIVITY], use, first, size, point_base, point_count, error);
  if (corners == 0) return LAVES_OK;
  if (size < corners) return laves__mesh_input_fail(r->input, error, "cell %zu (counted from 0) has too few corners", cell);
  int32_t indices[4];
  for (int j = 0; j < corners; j++) {
    const int64_t index = integer_at(&arrays[LAVES__VTU_CONNECTIVITY], (size_t)(first + j));
    if (index < 0 || (uint64_t)index >= point_count)
      return laves__mesh_input_fail(r->input, error, "cell %zu uses point %lld, but the points are 0 to %lld", cell,
                                    (long long)index, (long long)point_count - 1);
    indices[j] = (int32_t)(point_base + (size_t)index);
  }
  r->input->higher_order |= size > corners;
  const int32_t region = region_at(&arrays[LAVES__VTU_REGION], cell);
  if (corners == 4 && arrays[LAVES__VTU_VALUES].data &&
      !laves__mesh_input_add_value(r->input, real_at(&arrays[LAVES__VTU_VALUES], cell)))
    return laves__fail_memory(r->input->context, error);
  const bool enough =
      corners == 4 ? laves__mesh_input_add_tet(r->input, indices, region) : laves__mesh_input_add_face(r->input, indices, region);
  return enough ? LAVES_OK : laves__fail_memory(r->input->context, error);
}

static laves_result add_cells(laves__vtu *r, const laves__vtu_piece *p, array arrays[LAVES__VTU_ARRAY_COUNT], size_t point_base,
                              laves_error *error) {
  laves_result result = LAVES_OK;
  int64_t first = 0;
  for (size_t i = 0; i < p->cell_count && result == LAVES_OK; i++) {
    const int64_t end = integer_at(&arrays[LAVES__VTU_OFFSETS], i);
    if (end < first || (uint64_t)end > arrays[LAVES__VTU_CONNECTIVITY].count)
      return laves__mesh_input_fail(r->input, error, "the offset of cell %zu (counted from 0) is out of order", i);
    result = add_cell(r, arrays, i, first, end - first, point_base, p->point_count, error);
    if (i % 65536 == 65535 && laves__mesh_input_cancelled(r->input, r->input->end)) return laves__fail_cancelled(error);
    first = end;
  }
  return result;
}

static laves_result add_points(laves__vtu *r, const laves__vtu_piece *p, laves_error *error) {
  array points;
  laves_result result = read_array(r, p, LAVES__VTU_POINTS, 3 * p->point_count, &points, error);
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
static laves_result add_values(laves__vtu *r, const laves__vtu_piece *p, laves_error *error) {
  array values = {0};
  laves_result result = read_array(r, p, LAVES__VTU_VALUES, p->point_count, &values, error);
  for (size_t i = 0; i < p->point_count && result == LAVES_OK; i++) {
    if (!laves__mesh_input_add_value(r->input, real_at(&values, i))) result = laves__fail_memory(r->input->context, error);
    if (laves__cancelled_at(r->input->context, "read", i, p->point_count)) result = laves__fail_cancelled(error);
  }
  free_array(r, &values);
  return result;
}

static laves_result read_piece(laves__vtu *r, const laves__vtu_piece *p, laves_error *error) {
  if (p->cell_count == 0 && p->point_count == 0) return LAVES_OK;
  array arrays[LAVES__VTU_ARRAY_COUNT] = {0};
  const size_t point_base = r->input->point_count;
  laves_result result = laves__vtu_check_integers(r, p, error);
  if (result == LAVES_OK) result = add_points(r, p, error);
  const laves__mesh_values *values = &r->input->values;
  if (result == LAVES_OK && values->wanted && !values->per_tet) result = add_values(r, p, error);
  if (result == LAVES_OK && r->polygons) result = add_polygon_lines(r, p, false, point_base, error);
  if (result == LAVES_OK && r->polygons) result = add_polygon_lines(r, p, true, point_base, error);
  if (result != LAVES_OK || p->cell_count == 0) return result;
  result = read_array(r, p, LAVES__VTU_OFFSETS, p->cell_count, &arrays[LAVES__VTU_OFFSETS], error);
  if (result == LAVES_OK) result = read_array(r, p, LAVES__VTU_TYPES, p->cell_count, &arrays[LAVES__VTU_TYPES], error);
  if (result == LAVES_OK && p->sources[LAVES__VTU_REGION].place != LAVES__VTU_ABSENT)
    result = read_array(r, p, LAVES__VTU_REGION, p->cell_count, &arrays[LAVES__VTU_REGION], error);
  if (result == LAVES_OK && values->wanted && values->per_tet)
    result = read_array(r, p, LAVES__VTU_VALUES, p->cell_count, &arrays[LAVES__VTU_VALUES], error);
  if (result == LAVES_OK) {
    const int64_t corners = integer_at(&arrays[LAVES__VTU_OFFSETS], p->cell_count - 1);
    if (corners < 0 || (uint64_t)corners > SIZE_MAX / 64)
      result = laves__vtu_fail_array(r, laves__vtu_array_names[LAVES__VTU_OFFSETS], error);
    if (result == LAVES_OK)
      result = read_array(r, p, LAVES__VTU_CONNECTIVITY, (size_t)corners, &arrays[LAVES__VTU_CONNECTIVITY], error);
  }
  if (result == LAVES_OK) result = add_cells(r, p, arrays, point_base, error);
  for (int i = 0; i < LAVES__VTU_ARRAY_COUNT; i++) free_array(r, &arrays[i]);
  return result;
}

laves_result laves__read_vtu(laves__mesh_input *input, laves_error *error) {
  laves__vtu r = {.input = input};
  laves_result result = laves__vtu_read_structure(&r, error);
  for (size_t i = 0; i < r.piece_count && result == LAVES_OK; i++) result = read_piece(&r, &r.pieces[i], error);
  laves__vtu_free(&r);
  return result;
}
