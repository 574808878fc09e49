/* VTK's XML file for unstructured grids: Float64 points, Int32 connectivity, offsets of 32 bits where they suffice, cell
 * data "region", "class" (0: tile of the lattice, 1: boundary layer, 2: boundary triangle), and "source_face" where it is known.
 *
 * Tetrahedra come first. When the mesh carries face tags or sources, its boundary triangles follow as cells of their own with the
 * tag as their "region", so that tags survive; without either the file holds tetrahedra only.
 *
 * Names of groups are field data (io/mesh_cells.h).
 *
 * Binary arrays are appended as raw bytes behind the XML, each after a header of UInt64: its byte count, or for compressed
 * arrays the number of blocks, their size, the size of the last (0 when full) and every block's compressed size. The XML names
 * the positions of all arrays. Of compressed ones these and the headers are known only in the end: blocks are written as they are
 * made, and what stands before them once more. Where there is no going back, in a pipe, all blocks are kept until then. Source:
 * VTK file formats, https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

#include "io/mesh_cells.h"
#include "io/write_mesh.h"
#include "io/write_text.h"
#include "io/zlib_memory.h"

typedef struct grid {
  const laves_mesh *mesh;
  size_t cells;
} grid;

/* ---- arrays, item by item; an item is one number, for points one coordinate ---- */

static int64_t offset(const grid *g, size_t i) { return (int64_t)laves__cell_offset(g->mesh, i + 1); }
static int64_t type(const grid *g, size_t i) { return laves__cell_type(g->mesh, i); }
static int64_t region(const grid *g, size_t i) { return laves__cell_region(g->mesh, i); }
static int64_t class(const grid *g, size_t i) { return laves__cell_class(g->mesh, i); }
static int64_t source_face(const grid *g, size_t i) { return laves__cell_source(g->mesh, i); }

typedef enum kind { FLOAT64, INT32, INT64, UINT8 } kind;
static const char *const kind_names[] = {"Float64", "Int32", "Int64", "UInt8"};
static const size_t kind_bytes[] = {8, 4, 8, 1};

typedef struct array {
  const grid *grid;
  const char *name;
  kind kind;
  int components;
  size_t count;
  int64_t (*integer)(const grid *g, size_t i); /* NULL: coordinates, or corners */
  /* Compressed form; unused otherwise. */
  size_t block_count;
  uint64_t *header;
  uint8_t **blocks;
} array;

enum { POINTS, CONNECTIVITY, OFFSETS, TYPES, REGION, CLASS, SOURCE_FACE, ARRAY_COUNT };

static void describe_arrays(const grid *g, array arrays[ARRAY_COUNT]) {
  const size_t corners = laves__cell_corners(g->mesh);
  const kind offset_kind = corners <= INT32_MAX ? INT32 : INT64;
  arrays[POINTS] = (array){g, "Points", FLOAT64, 3, 3 * g->mesh->vertex_count, NULL, 0, NULL, NULL};
  arrays[CONNECTIVITY] = (array){g, "connectivity", INT32, 1, corners, NULL, 0, NULL, NULL};
  arrays[OFFSETS] = (array){g, "offsets", offset_kind, 1, g->cells, offset, 0, NULL, NULL};
  arrays[TYPES] = (array){g, "types", UINT8, 1, g->cells, type, 0, NULL, NULL};
  arrays[REGION] = (array){g, "region", INT32, 1, g->cells, region, 0, NULL, NULL};
  arrays[CLASS] = (array){g, "class", UINT8, 1, g->cells, class, 0, NULL, NULL};
  arrays[SOURCE_FACE] = (array){g, "source_face", INT32, 1, g->cells, source_face, 0, NULL, NULL};
}

/* An array that the mesh has no values for is left out; it is the last one. */
static int array_count(const grid *g) { return g->mesh->face_sources ? ARRAY_COUNT : SOURCE_FACE; }

static uint64_t raw_bytes(const array *a) { return (uint64_t)a->count * kind_bytes[a->kind]; }

/* ---- raw ---- */

/* One loop for each array, so that the compiler sees what it writes: size and value_of are constants where this is called. */
static inline __attribute__((always_inline)) void pack_integers(const grid *g, size_t begin, size_t end, char *bytes, size_t size,
                                                                int64_t (*value_of)(const grid *g, size_t i)) {
  for (size_t i = begin; i < end; i++, bytes += size) {
    const int64_t value = value_of(g, i);
    memcpy(bytes, &value, size); /* the low bytes come first */
  }
}

static void pack_coordinates(const grid *g, size_t begin, size_t end, double *out) {
  const bool made = laves__mesh_coordinates(g->mesh, begin, end, out);
  LAVES_ASSERT(made);
  (void)made;
}

static size_t pack(const void *user, size_t begin, size_t end, char *bytes) {
  const array *a = user;
  const grid *g = a->grid;
  const size_t size = kind_bytes[a->kind];
  if (a->kind == FLOAT64)
    pack_coordinates(g, begin, end, (double *)(void *)bytes);
  else if (!a->integer)
    laves__cell_pack_corners(g->mesh, begin, end, (int32_t *)(void *)bytes);
  else if (a->integer == offset && a->kind == INT32)
    pack_integers(g, begin, end, bytes, sizeof(int32_t), offset);
  else if (a->integer == offset)
    pack_integers(g, begin, end, bytes, sizeof(int64_t), offset);
  else if (a->integer == type)
    pack_integers(g, begin, end, bytes, sizeof(uint8_t), type);
  else if (a->integer == region)
    pack_integers(g, begin, end, bytes, sizeof(int32_t), region);
  else if (a->integer == source_face)
    pack_integers(g, begin, end, bytes, sizeof(int32_t), source_face);
  else
    pack_integers(g, begin, end, bytes, sizeof(uint8_t), class);
  return (end - begin) * size;
}

static void write_raw(laves__output *out, const array *a) {
  const uint64_t bytes = raw_bytes(a);
  laves__output_bytes(out, &bytes, sizeof bytes);
  laves__output_rows(out, a->count, kind_bytes[a->kind], pack, a);
}

/* ---- compressed ---- */

/* Bytes of a block before compression: large enough that its header and dictionary cost little, small enough to share the
 * work out. A multiple of every item's size. */
enum { BLOCK_BYTES = 1 << 18 };
/* From this one on compression takes many times as long. */
enum { SLOW_LEVEL = 4 };

typedef struct compression {
  laves_context *context;
  array *array;
  size_t first; /* block */
  int level;
} compression;

/* Compresses one block of the array; leaves blocks[i] NULL when memory is short. */
static void compress_block(const compression *c, z_stream *stream, size_t i, char *raw, char *packed, size_t capacity) {
  array *a = c->array;
  const size_t per_block = BLOCK_BYTES / kind_bytes[a->kind];
  const size_t begin = i * per_block, end = begin + per_block < a->count ? begin + per_block : a->count;
  stream->next_in = (Bytef *)raw;
  stream->avail_in = (uInt)pack(a, begin, end, raw);
  stream->next_out = (Bytef *)packed;
  stream->avail_out = (uInt)capacity;
  if (deflateReset(stream) != Z_OK || deflate(stream, Z_FINISH) != Z_STREAM_END) return;
  const size_t length = stream->total_out;
  a->blocks[i] = laves__alloc(c->context, length, 1);
  if (!a->blocks[i]) return;
  memcpy(a->blocks[i], packed, length);
  a->header[3 + i] = length;
}

/* Every block and its length have one writer: the thread that got the block's index. */
static void compress_range(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const compression *c = user;
  z_stream stream = {.zalloc = laves__zlib_allocate, .zfree = laves__zlib_free, .opaque = c->context};
  if (deflateInit(&stream, c->level) != Z_OK) return;
  const size_t capacity = deflateBound(&stream, BLOCK_BYTES);
  char *scratch = laves__alloc(c->context, BLOCK_BYTES + capacity, 1);
  for (size_t i = begin; i < end && scratch; i++)
    compress_block(c, &stream, c->first + i, scratch, scratch + BLOCK_BYTES, capacity);
  laves__free(c->context, scratch, BLOCK_BYTES + capacity, 1);
  deflateEnd(&stream);
}

static size_t header_bytes(const array *a) { return (3 + a->block_count) * sizeof *a->header; }

/* Makes the header, without the sizes of compressed blocks, and room for these. */
static void make_header(laves__output *out, array *a) {
  const uint64_t bytes = raw_bytes(a);
  a->block_count = (size_t)((bytes + BLOCK_BYTES - 1) / BLOCK_BYTES);
  a->header = laves__alloc_zeroed(out->context, 3 + a->block_count, sizeof *a->header);
  a->blocks = laves__alloc_zeroed(out->context, a->block_count, sizeof *a->blocks);
  if (!a->header || !a->blocks) {
    laves__output_fail_memory(out);
    return;
  }
  a->header[0] = a->block_count;
  a->header[1] = BLOCK_BYTES;
  a->header[2] = bytes % BLOCK_BYTES;
}

static void write_blocks(laves__output *out, array *a, size_t begin, size_t end) {
  for (size_t i = begin; i < end; i++) {
    laves__output_bytes(out, a->blocks[i], a->header[3 + i]);
    laves__free(out->context, a->blocks[i], a->header[3 + i], 1);
    a->blocks[i] = NULL;
  }
}

/* Compresses an array; writes its blocks unless they are to be kept. `share` is the array's part of all work. */
static void compress_array(laves__output *out, array *a, int level, bool keep, double share) {
  /* A block takes some milliseconds, or a tenth of a second at high levels; a wave is what is between two questions. */
  const bool slow = level >= SLOW_LEVEL;
  const size_t wave = (size_t)laves__workers(out->context) * (slow ? 1 : 16), range = slow ? 1 : 4;
  const double before = out->prepared;
  for (size_t i = 0; i < a->block_count && out->error.result == LAVES_OK; i += wave) {
    const size_t count = a->block_count - i < wave ? a->block_count - i : wave;
    compression c = {out->context, a, i, level};
    out->prepared = before + share * (double)i / (double)a->block_count;
    if (laves__cancelled(out->context, "write", out->prepared) ||
        !laves__parallel_for(out->context, NULL, count, range, compress_range, &c)) {
      laves__fail_cancelled(&out->error);
      return;
    }
    for (size_t k = i; k < i + count; k++)
      if (!a->blocks[k]) laves__output_fail_memory(out);
    if (!keep && out->error.result == LAVES_OK) write_blocks(out, a, i, i + count);
  }
  out->prepared = before + share;
}

static uint64_t compressed_bytes(const array *a) {
  uint64_t sum = header_bytes(a);
  for (size_t i = 0; i < a->block_count; i++) sum += a->header[3 + i];
  return sum;
}

static void free_compressed(laves_context *context, array *a) {
  for (size_t i = 0; i < a->block_count && a->blocks && a->header; i++) laves__free(context, a->blocks[i], a->header[3 + i], 1);
  laves__free(context, a->blocks, a->block_count, sizeof *a->blocks);
  laves__free(context, a->header, 3 + a->block_count, sizeof *a->header);
}

/* ---- text ---- */

/* Numbers are had in pieces of so many. */
enum { PIECE = 512 };

static size_t put_coordinates(const void *user, size_t begin, size_t end, char *bytes) {
  const array *a = user;
  char *text = bytes;
  double piece[PIECE];
  for (size_t first = begin, last; first < end; first = last) {
    last = end - first < PIECE ? end : first + PIECE;
    pack_coordinates(a->grid, first, last, piece);
    for (size_t i = first; i < last; i++) {
      text = laves__put_double(text, piece[i - first]);
      *text++ = i % 3 == 2 ? '\n' : ' ';
    }
  }
  return (size_t)(text - bytes);
}

static char *put_integer(char *text, int64_t value, size_t i) {
  text = laves__put_integer(text, value);
  *text++ = i % 12 == 11 ? '\n' : ' ';
  return text;
}

static size_t put_integers(const void *user, size_t begin, size_t end, char *bytes) {
  const array *a = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) text = put_integer(text, a->integer(a->grid, i), i);
  return (size_t)(text - bytes);
}

static size_t put_corners(const void *user, size_t begin, size_t end, char *bytes) {
  const array *a = user;
  char *text = bytes;
  int32_t piece[PIECE];
  for (size_t first = begin, last; first < end; first = last) {
    last = end - first < PIECE ? end : first + PIECE;
    laves__cell_pack_corners(a->grid->mesh, first, last, piece);
    for (size_t i = first; i < last; i++) text = put_integer(text, piece[i - first], i);
  }
  return (size_t)(text - bytes);
}

static void write_inline(laves__output *out, const array *a) {
  if (a->kind == FLOAT64)
    laves__output_items(out, a->count, LAVES__DOUBLE_TEXT_MAX + 1, put_coordinates, a);
  else
    laves__output_items(out, a->count, LAVES__INTEGER_TEXT_MAX + 1, a->integer ? put_integers : put_corners, a);
}

/* ---- the file ---- */

typedef enum form { TEXT, RAW, COMPRESSED } form;

static const char before_appended[] = "  <AppendedData encoding=\"raw\">\n_",
                  behind_appended[] = "\n  </AppendedData>\n</VTKFile>\n";

enum { POSITION_DIGITS = 20 };
/* Of blocks that are kept, compression takes nearly all of the time; writing them the rest. */
#define COMPRESSING_SHARE 0.9

/* One element of the XML; *position is where its data starts behind the XML. What follows the position of a compressed array is
 * padded, so that the XML has one length whatever the positions are. */
static void write_element(laves__output *out, const array *a, form f, uint64_t *position) {
  laves__output_printf(out, "        <DataArray type=\"%s\" Name=\"%s\"", kind_names[a->kind], a->name);
  if (a->components > 1) laves__output_printf(out, " NumberOfComponents=\"%d\"", a->components);
  if (f == TEXT) {
    laves__output_printf(out, " format=\"ascii\">\n");
    write_inline(out, a);
    laves__output_printf(out, "\n        </DataArray>\n");
    return;
  }
  char number[24];
  const int digits = snprintf(number, sizeof number, "%llu", (unsigned long long)*position);
  laves__output_printf(out, " format=\"appended\" offset=\"%s\"%*s/>\n", number, f == COMPRESSED ? POSITION_DIGITS - digits : 0,
                       "");
  *position += f == RAW ? sizeof(uint64_t) + raw_bytes(a) : compressed_bytes(a);
}

/* One array for all groups of the name that group i has. */
static void write_name(laves__output *out, const laves_mesh *mesh, size_t i) {
  const size_t pairs = laves__cell_name_pairs(mesh, i);
  if (pairs == 0) return;
  laves__output_printf(out, "      <DataArray type=\"Int32\" Name=\"");
  laves__write_escaped(out, mesh->groups[i].name);
  laves__output_printf(out, "\" NumberOfComponents=\"2\" NumberOfTuples=\"%zu\" format=\"ascii\">", pairs);
  for (size_t j = i; j < mesh->group_count; j++)
    if (laves__cell_same_name(mesh, i, j))
      laves__output_printf(out, " %ld %d", (long)mesh->groups[j].tag, mesh->groups[j].dimension);
  laves__output_printf(out, " </DataArray>\n");
}

static void write_names(laves__output *out, const laves_mesh *mesh) {
  if (laves__cell_name_count(mesh) == 0) return;
  laves__output_printf(out, "    <FieldData>\n");
  for (size_t i = 0; i < mesh->group_count; i++) write_name(out, mesh, i);
  laves__output_printf(out, "    </FieldData>\n");
}

static void write_xml(laves__output *out, const grid *g, const array *arrays, form f) {
  laves__output_printf(
      out,
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"%s>\n"
      "  <UnstructuredGrid>\n",
      f == COMPRESSED ? " compressor=\"vtkZLibDataCompressor\"" : "");
  write_names(out, g->mesh);
  laves__output_printf(out,
                       "    <Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n"
                       "      <Points>\n",
                       g->mesh->vertex_count, g->cells);
  uint64_t position = 0;
  write_element(out, &arrays[POINTS], f, &position);
  laves__output_printf(out, "      </Points>\n      <Cells>\n");
  write_element(out, &arrays[CONNECTIVITY], f, &position);
  write_element(out, &arrays[OFFSETS], f, &position);
  write_element(out, &arrays[TYPES], f, &position);
  laves__output_printf(out, "      </Cells>\n      <CellData Scalars=\"region\">\n");
  write_element(out, &arrays[REGION], f, &position);
  for (int i = CLASS; i < array_count(g); i++) write_element(out, &arrays[i], f, &position);
  laves__output_printf(out, "      </CellData>\n    </Piece>\n  </UnstructuredGrid>\n");
}

static void write_raw_grid(laves__output *out, const grid *g, const array *arrays) {
  const int count = array_count(g);
  for (int i = 0; i < count; i++) out->expected += (double)raw_bytes(&arrays[i]);
  write_xml(out, g, arrays, RAW);
  laves__output_printf(out, "%s", before_appended);
  for (int i = 0; i < count; i++) write_raw(out, &arrays[i]);
  laves__output_printf(out, "%s", behind_appended);
}

/* Compresses all arrays, and writes each array's header, to be written once more, and blocks as they are made. */
static void compress_arrays(laves__output *out, array *arrays, int count, int level, bool keep, uint64_t *headers_at) {
  const double whole = keep ? COMPRESSING_SHARE : 1 - out->prepared;
  double total = 0;
  for (int i = 0; i < count; i++) total += (double)raw_bytes(&arrays[i]);
  for (int i = 0; i < count && out->error.result == LAVES_OK; i++) {
    array *a = &arrays[i];
    headers_at[i] = out->written;
    if (!keep) laves__output_bytes(out, a->header, header_bytes(a));
    compress_array(out, a, level, keep, total > 0 ? whole * (double)raw_bytes(a) / total : 0);
  }
}

/* Writes the same once more, with the sizes that are known now. */
static void write_sizes(laves__output *out, const grid *g, const array *arrays, const uint64_t *headers_at) {
  const uint64_t end = laves__output_seek(out, 0);
  write_xml(out, g, arrays, COMPRESSED);
  for (int i = 0; i < array_count(g); i++) {
    laves__output_seek(out, headers_at[i]);
    laves__output_bytes(out, arrays[i].header, header_bytes(&arrays[i]));
  }
  laves__output_seek(out, end);
}

static void write_compressed_grid(laves__output *out, const grid *g, array *arrays, int level) {
  const int count = array_count(g);
  const bool keep = out->direct;
  uint64_t headers_at[ARRAY_COUNT];
  out->expected = keep ? 0 : HUGE_VAL; /* how much is prepared is all that progress tells */
  for (int i = 0; i < count; i++) make_header(out, &arrays[i]);
  if (out->error.result != LAVES_OK) return;
  if (keep) compress_arrays(out, arrays, count, level, keep, headers_at);
  for (int i = 0; i < count; i++) out->expected += (double)compressed_bytes(&arrays[i]);
  write_xml(out, g, arrays, COMPRESSED);
  laves__output_printf(out, "%s", before_appended);
  if (!keep) compress_arrays(out, arrays, count, level, keep, headers_at);
  for (int i = 0; i < count && keep && out->error.result == LAVES_OK; i++) {
    laves__output_bytes(out, arrays[i].header, header_bytes(&arrays[i]));
    write_blocks(out, &arrays[i], 0, arrays[i].block_count);
  }
  laves__output_printf(out, "%s", behind_appended);
  if (!keep) write_sizes(out, g, arrays, headers_at);
}

void laves__write_vtu(laves__output *out, const laves_mesh *mesh, bool ascii, int compression_level) {
  const grid g = {mesh, laves__cell_count(mesh)};
  array arrays[ARRAY_COUNT];
  describe_arrays(&g, arrays);
  if (ascii) {
    for (int i = 0; i < array_count(&g); i++) out->expected += (double)raw_bytes(&arrays[i]);
    write_xml(out, &g, arrays, TEXT);
    laves__output_printf(out, "</VTKFile>\n");
  } else if (compression_level > 0) {
    write_compressed_grid(out, &g, arrays, compression_level);
  } else {
    write_raw_grid(out, &g, arrays);
  }
  for (int i = 0; i < ARRAY_COUNT; i++) free_compressed(out->context, &arrays[i]);
}
