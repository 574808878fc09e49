/* VTU files of any size, read by ranges.
 *
 * The XML in front is read and walked as for whole files (vtu_structure.c); where each array stands in the file, and that it is
 * there as long as it should be, is settled when the file is opened. Then points are read by ranges, and cells in the order of
 * the file: types and offsets a few thousand at a time, and of the connectivity what lies between the first and the last of them
 * that is wanted. Of compressed arrays one block at a time is held.
 *
 * Everything is read with pread: a mapped file that becomes shorter meanwhile would end the program. */
#include "io/vtu_ranges.h"

#include <string.h>
#include <zlib.h>

#include "io/file.h"
#include "io/vtu.h"
#include "io/zlib_memory.h"

enum {
  HEAD_BYTES = 1 << 14,      /* of the file that are searched for XML first; then twice as many, and so on */
  HEAD_BYTES_MAX = 1 << 24,  /* XML in front of appended data is much shorter */
  BLOCK_BYTES_MAX = 1 << 26, /* of a compressed array; VTK writes 32 KiB, laves 256 KiB */
  CHUNK_CELLS = 1 << 12,     /* types and offsets that are read at once */
  CHUNK_NUMBERS = 1 << 15,   /* corners that are read at once */
  POINT_NUMBERS = 3 << 10,   /* coordinates that are converted at once */
};

/* An array in the file. */
typedef struct ranged {
  const char *name;
  laves__vtu_kind kind;
  size_t count;   /* numbers */
  uint64_t begin; /* in the file, behind the header */
  uint64_t bytes; /* before compression */
  /* Compressed: */
  size_t block_count, block_bytes;
  size_t packed_max; /* the largest block in the file */
  uint64_t *starts;  /* [block_count + 1] in the file; NULL: the array is plain */
  char *block;       /* [block_bytes] */
  size_t held;       /* number of the block that is in `block`; SIZE_MAX: none */
} ranged;

typedef struct ranges {
  laves__mesh_stream stream;
  laves__mesh_input input; /* its name, context, and the head of the file */
  laves__ranged_file file;
  laves__vtu structure;
  char *head;
  size_t head_bytes;
  ranged arrays[LAVES__VTU_REGION + 1];
  z_stream inflater;
  bool inflater_made;
  char *packed;
  size_t packed_bytes;
  size_t cell_count;
  /* Where reading is. */
  int corner_count;     /* wanted */
  size_t chunk_first;   /* cell */
  size_t chunk_count;   /* cells of which type and end are known */
  size_t at;            /* next of them */
  int64_t begin;        /* of cell `at` in the connectivity */
  size_t numbers_first; /* of the connectivity, in `numbers` */
  size_t numbers_count;
  int64_t types[CHUNK_CELLS], ends[CHUNK_CELLS];
  char numbers[CHUNK_NUMBERS * 8];
  char scratch[CHUNK_CELLS * 8];
} ranges;

/* ---- arrays by ranges ---- */

static laves_result fail_array(ranges *r, const ranged *a, laves_error *error) {
  return laves__vtu_fail_array(&r->structure, a->name, error);
}

static size_t bytes_of_block(const ranged *a, size_t i) {
  return i + 1 == a->block_count ? (size_t)(a->bytes - (uint64_t)i * a->block_bytes) : a->block_bytes;
}

/* Inflates a block into the array's place for it. */
static laves_result hold_block(ranges *r, ranged *a, size_t i, laves_error *error) {
  const size_t packed = (size_t)(a->starts[i + 1] - a->starts[i]), bytes = bytes_of_block(a, i);
  if (a->held == i) return LAVES_OK;
  a->held = SIZE_MAX;
  const laves_result result = laves__ranged_file_read(&r->file, a->starts[i], r->packed, packed, error);
  if (result != LAVES_OK) return result;
  if (inflateReset(&r->inflater) != Z_OK) return fail_array(r, a, error);
  r->inflater.next_in = (Bytef *)r->packed;
  r->inflater.avail_in = (uInt)packed;
  r->inflater.next_out = (Bytef *)a->block;
  r->inflater.avail_out = (uInt)bytes;
  const int outcome = inflate(&r->inflater, Z_FINISH);
  if (outcome == Z_MEM_ERROR) return laves__fail_memory(r->input.context, error);
  if (outcome != Z_STREAM_END || r->inflater.avail_out > 0) return fail_array(r, a, error);
  a->held = i;
  return LAVES_OK;
}

/* Numbers [first, first + count) as they stand in the file. */
static laves_result read_range(ranges *r, ranged *a, size_t first, size_t count, char *out, laves_error *error) {
  const size_t size = laves__vtu_kinds[a->kind].bytes;
  uint64_t at = (uint64_t)first * size;
  if (!a->starts) return laves__ranged_file_read(&r->file, a->begin + at, out, count * size, error);
  for (size_t left = count * size; left > 0;) {
    const size_t block = (size_t)(at / a->block_bytes), within = (size_t)(at % a->block_bytes);
    const laves_result result = hold_block(r, a, block, error);
    if (result != LAVES_OK) return result;
    const size_t rest = bytes_of_block(a, block) - within, part = left < rest ? left : rest;
    memcpy(out, a->block + within, part);
    out += part;
    at += part;
    left -= part;
  }
  return LAVES_OK;
}

/* Integers [first, first + count), at most CHUNK_CELLS. */
static laves_result read_integers(ranges *r, ranged *a, size_t first, size_t count, int64_t *out, laves_error *error) {
  const size_t size = laves__vtu_kinds[a->kind].bytes;
  const laves_result result = read_range(r, a, first, count, r->scratch, error);
  for (size_t i = 0; i < count && result == LAVES_OK; i++) out[i] = laves__vtu_integer(a->kind, r->scratch + i * size);
  return result;
}

/* ---- finding the arrays ---- */

/* A number of a header, which moves `at` behind it. */
static laves_result read_header(ranges *r, const ranged *a, uint64_t *at, uint64_t *value, laves_error *error) {
  const size_t size = r->structure.wide_header ? 8 : 4;
  char bytes[8];
  if (*at > r->file.bytes || r->file.bytes - *at < size) return fail_array(r, a, error);
  const laves_result result = laves__ranged_file_read(&r->file, *at, bytes, size, error);
  *value = (uint64_t)laves__vtu_integer(size == 8 ? LAVES__VTU_UINT64 : LAVES__VTU_UINT32, bytes);
  *at += size;
  return result;
}

static laves_result find_plain(ranges *r, ranged *a, uint64_t at, laves_error *error) {
  uint64_t bytes = 0;
  const laves_result result = read_header(r, a, &at, &bytes, error);
  if (result != LAVES_OK) return result;
  if (bytes != a->bytes || bytes > r->file.bytes - at) return fail_array(r, a, error);
  a->begin = at;
  return LAVES_OK;
}

/* Reads the compressed sizes and turns them into places. */
static laves_result find_blocks(ranges *r, ranged *a, uint64_t at, laves_error *error) {
  const size_t size = r->structure.wide_header ? 8 : 4;
  laves_result result = LAVES_OK;
  a->starts = laves__alloc(r->input.context, a->block_count + 1, sizeof *a->starts);
  a->block = laves__alloc(r->input.context, a->block_bytes, 1);
  if (!a->starts || !a->block) return laves__fail_memory(r->input.context, error);
  a->starts[0] = at + (uint64_t)a->block_count * size;
  for (size_t i = 0; i < a->block_count; i++) {
    if (i % CHUNK_CELLS == 0) {
      const size_t left = a->block_count - i, count = left < CHUNK_CELLS ? left : CHUNK_CELLS;
      result = laves__ranged_file_read(&r->file, at + (uint64_t)i * size, r->scratch, count * size, error);
      if (result != LAVES_OK) return result;
    }
    const uint64_t packed =
        (uint64_t)laves__vtu_integer(size == 8 ? LAVES__VTU_UINT64 : LAVES__VTU_UINT32, r->scratch + i % CHUNK_CELLS * size);
    if (packed > r->file.bytes - a->starts[i] || packed > 2 * (uint64_t)BLOCK_BYTES_MAX) return fail_array(r, a, error);
    a->starts[i + 1] = a->starts[i] + packed;
    if (packed > a->packed_max) a->packed_max = (size_t)packed;
  }
  return LAVES_OK;
}

static laves_result find_compressed(ranges *r, ranged *a, uint64_t at, laves_error *error) {
  uint64_t head[3] = {0}; /* number of blocks, size of each, size of the last or 0 */
  laves_result result = LAVES_OK;
  for (int i = 0; i < 3 && result == LAVES_OK; i++) result = read_header(r, a, &at, &head[i], error);
  if (result != LAVES_OK) return result;
  if (a->bytes == 0 && head[0] == 0) return LAVES_OK;
  if (head[0] == 0 || head[0] > (r->file.bytes - at) / (r->structure.wide_header ? 8 : 4)) return fail_array(r, a, error);
  if (head[1] > BLOCK_BYTES_MAX)
    return laves__mesh_input_fail(&r->input, error,
                                  "its compressed blocks of %llu bytes are too large to be read one by one (at most %d); save it "
                                  "without compression, or check it without --stream",
                                  (unsigned long long)head[1], BLOCK_BYTES_MAX);
  const uint64_t last = head[2] > 0 ? head[2] : head[1];
  if (head[1] == 0 || last > head[1] || head[0] - 1 > a->bytes / head[1] || (head[0] - 1) * head[1] + last != a->bytes)
    return fail_array(r, a, error);
  a->block_count = (size_t)head[0];
  /* A single block may be announced as larger than what is in it. */
  a->block_bytes = (size_t)(head[1] < a->bytes ? head[1] : a->bytes);
  return find_blocks(r, a, at, error);
}

/* Finds an array of which `count` numbers are needed. */
static laves_result find_array(ranges *r, const laves__vtu_piece *p, int which, size_t count, laves_error *error) {
  const laves__vtu_source *s = &p->sources[which];
  const uint64_t behind_xml = (uint64_t)(r->structure.appended - r->head);
  ranged *a = &r->arrays[which];
  *a = (ranged){.name = laves__vtu_array_names[which], .kind = s->kind, .count = count, .held = SIZE_MAX};
  a->bytes = (uint64_t)count * laves__vtu_kinds[s->kind].bytes;
  if (s->place == LAVES__VTU_ABSENT) return laves__mesh_input_fail(&r->input, error, "a piece lacks %s", a->name);
  if (s->place != LAVES__VTU_APPENDED)
    return laves__mesh_input_fail(&r->input, error,
                                  "%s are inline, and only appended raw data can be read piece by piece; check it without "
                                  "--stream",
                                  a->name);
  r->structure.decoded += (double)a->bytes;
  if (r->structure.decoded >
      (double)r->file.bytes * (r->structure.compressed ? LAVES__VTU_COMPRESSED_LIMIT : LAVES__VTU_PLAIN_LIMIT))
    return fail_array(r, a, error);
  if (s->offset > r->file.bytes - behind_xml) return fail_array(r, a, error);
  if (count == 0) return LAVES_OK;
  return (r->structure.compressed ? find_compressed : find_plain)(r, a, behind_xml + s->offset, error);
}

/* The piece that has something in it. */
static laves_result only_piece(ranges *r, const laves__vtu_piece **only, laves_error *error) {
  *only = NULL;
  for (size_t i = 0; i < r->structure.piece_count; i++) {
    const laves__vtu_piece *p = &r->structure.pieces[i];
    if (p->cell_count == 0 && p->point_count == 0) continue;
    if (*only)
      return laves__mesh_input_fail(&r->input, error,
                                    "it has several pieces, and only one can be read piece by piece; check it "
                                    "without --stream");
    *only = p;
  }
  return *only ? LAVES_OK : laves__mesh_input_fail(&r->input, error, "there are no tetrahedra in it");
}

static laves_result find_arrays(ranges *r, laves_error *error) {
  const laves__vtu_piece *p;
  laves_result result = only_piece(r, &p, error);
  if (!p) return result;
  if (result == LAVES_OK) result = laves__vtu_check_integers(&r->structure, p, error);
  if (result == LAVES_OK && p->cell_count == 0)
    result = laves__mesh_input_fail(&r->input, error, "there are no tetrahedra in it");
  if (result == LAVES_OK && p->point_count > INT32_MAX)
    result = laves__mesh_input_fail(&r->input, error, "it has more than 2147483647 points");
  if (result == LAVES_OK) result = find_array(r, p, LAVES__VTU_POINTS, 3 * p->point_count, error);
  if (result == LAVES_OK) result = find_array(r, p, LAVES__VTU_OFFSETS, p->cell_count, error);
  if (result == LAVES_OK) result = find_array(r, p, LAVES__VTU_TYPES, p->cell_count, error);
  /* Nobody asks for regions, but a file that is cut off within them is damaged. */
  if (result == LAVES_OK && p->sources[LAVES__VTU_REGION].place != LAVES__VTU_ABSENT)
    result = find_array(r, p, LAVES__VTU_REGION, p->cell_count, error);
  return result;
}

/* The connectivity is as long as the last offset says. */
static laves_result find_connectivity(ranges *r, laves_error *error) {
  const laves__vtu_piece *p;
  int64_t corners = 0;
  laves_result result = only_piece(r, &p, error);
  if (!p) return result;
  if (result == LAVES_OK) result = read_integers(r, &r->arrays[LAVES__VTU_OFFSETS], p->cell_count - 1, 1, &corners, error);
  if (result != LAVES_OK) return result;
  if (corners < 0 || (uint64_t)corners > SIZE_MAX / 64) return fail_array(r, &r->arrays[LAVES__VTU_OFFSETS], error);
  r->cell_count = p->cell_count;
  r->stream.point_count = p->point_count;
  return find_array(r, p, LAVES__VTU_CONNECTIVITY, (size_t)corners, error);
}

/* Room for the packed blocks of all arrays found so far, and the inflater. */
static laves_result make_inflater(ranges *r, laves_error *error) {
  laves_context *context = r->input.context;
  size_t most = 0;
  if (!r->structure.compressed) return LAVES_OK;
  for (size_t i = 0; i < LAVES__COUNT_OF(r->arrays); i++)
    if (r->arrays[i].packed_max > most) most = r->arrays[i].packed_max;
  if (most > r->packed_bytes || !r->packed) {
    laves__free(context, r->packed, r->packed_bytes, 1);
    r->packed = laves__alloc(context, most, 1);
    r->packed_bytes = r->packed ? most : 0;
    if (!r->packed) return laves__fail_memory(context, error);
  }
  if (r->inflater_made) return LAVES_OK;
  r->inflater = (z_stream){.zalloc = laves__zlib_allocate, .zfree = laves__zlib_free, .opaque = context};
  r->inflater_made = inflateInit(&r->inflater) == Z_OK;
  return r->inflater_made ? LAVES_OK : laves__fail_memory(context, error);
}

/* ---- the head ---- */

/* Reads the first bytes of the file. */
static laves_result read_head(ranges *r, size_t bytes, laves_error *error) {
  laves_context *context = r->input.context;
  laves__vtu_free(&r->structure);
  laves__free(context, r->head, r->head_bytes, 1);
  r->head = laves__alloc(context, bytes, 1);
  r->head_bytes = r->head ? bytes : 0;
  if (!r->head) return laves__fail_memory(context, error);
  r->input.begin = r->head;
  r->input.end = r->head + bytes;
  r->structure = (laves__vtu){.input = &r->input};
  return laves__ranged_file_read(&r->file, 0, r->head, bytes, error);
}

/* Whether the head is XML, and no other format that has some within. */
static bool begins_as_xml(const ranges *r) {
  static const char mark[] = "\xEF\xBB\xBF"; /* of the byte order, which some programs write */
  const char *at = r->head, *end = r->head + r->head_bytes;
  if (end - at >= 3 && memcmp(at, mark, 3) == 0) at += 3;
  while (at < end && (*at == ' ' || *at == '\t' || *at == '\r' || *at == '\n')) at++;
  return at < end && *at == '<';
}

/* Walks longer and longer heads of the file until one ends behind the XML. What a short one says wrongly, because it cuts a tag
 * in two, a longer one corrects. */
static laves_result read_structure(ranges *r, laves_error *error) {
  for (uint64_t bytes = HEAD_BYTES;; bytes *= 2) {
    const bool whole = bytes >= r->file.bytes;
    laves_result result = read_head(r, (size_t)(whole ? r->file.bytes : bytes), error);
    if (result != LAVES_OK) return result;
    if (!begins_as_xml(r) || !laves__is_vtu(&r->input))
      return laves__mesh_input_fail(&r->input, error, "it does not begin as a VTU file does; check it without --stream");
    result = laves__vtu_read_structure(&r->structure, error);
    if (result == LAVES_ERROR_MEMORY || (result == LAVES_OK && r->structure.appended)) return result;
    if (!whole && bytes < HEAD_BYTES_MAX) continue;
    if (result != LAVES_OK) return result;
    return laves__mesh_input_fail(&r->input, error,
                                  "it has no appended data, which alone can be read piece by piece; check it without --stream");
  }
}

static laves_result find_all(ranges *r, laves_error *error) {
  laves_result result = read_structure(r, error);
  if (result == LAVES_OK && r->structure.appended_base64)
    result = laves__mesh_input_fail(&r->input, error,
                                    "its appended data is base64, and only raw data can be read piece by piece; check it without "
                                    "--stream");
  if (result == LAVES_OK) result = find_arrays(r, error);
  if (result == LAVES_OK) result = make_inflater(r, error);
  if (result == LAVES_OK) result = find_connectivity(r, error);
  if (result == LAVES_OK) result = make_inflater(r, error);
  return result;
}

/* ---- points ---- */

static laves_result read_points(void *user, size_t first, size_t count, laves__vec3 *points, laves_error *error) {
  ranges *r = user;
  ranged *a = &r->arrays[LAVES__VTU_POINTS];
  if (a->kind == LAVES__VTU_FLOAT64) return read_range(r, a, 3 * first, 3 * count, (char *)points, error);
  const size_t size = laves__vtu_kinds[a->kind].bytes;
  char bytes[POINT_NUMBERS * 8];
  for (size_t done = 0, part; done < 3 * count; done += part) {
    part = 3 * count - done < POINT_NUMBERS ? 3 * count - done : POINT_NUMBERS;
    const laves_result result = read_range(r, a, 3 * first + done, part, bytes, error);
    if (result != LAVES_OK) return result;
    for (size_t i = 0; i < part; i++)
      *v3_slot(&points[(done + i) / 3], (int)((done + i) % 3)) = laves__vtu_real(a->kind, bytes + i * size);
  }
  return LAVES_OK;
}

/* ---- cells ---- */

static void rewind_cells(void *user, int corner_count) {
  ranges *r = user;
  r->corner_count = corner_count;
  r->chunk_first = r->chunk_count = r->at = 0;
  r->begin = 0;
  r->numbers_first = r->numbers_count = 0;
  r->stream.fraction = 0;
  if (corner_count == 4) r->stream.triangle_count = 0;
}

/* The next types and offsets. */
static laves_result next_chunk(ranges *r, laves_error *error) {
  r->chunk_first += r->chunk_count;
  r->at = 0;
  const size_t left = r->cell_count - r->chunk_first, count = left < CHUNK_CELLS ? left : CHUNK_CELLS;
  laves_result result = read_integers(r, &r->arrays[LAVES__VTU_TYPES], r->chunk_first, count, r->types, error);
  if (result == LAVES_OK) result = read_integers(r, &r->arrays[LAVES__VTU_OFFSETS], r->chunk_first, count, r->ends, error);
  if (result != LAVES_OK) return result;
  int64_t end = r->begin;
  for (size_t i = 0; i < count; i++) {
    if (r->ends[i] < end || (uint64_t)r->ends[i] > r->arrays[LAVES__VTU_CONNECTIVITY].count)
      return laves__mesh_input_fail(&r->input, error, "the offset of cell %zu (counted from 0) is out of order",
                                    r->chunk_first + i);
    end = r->ends[i];
    r->types[i] = laves__vtu_corner_count(r->types[i]);
    if (r->corner_count == 4 && r->types[i] == 3) r->stream.triangle_count++;
  }
  r->chunk_count = count;
  r->stream.fraction = (double)r->chunk_first / (double)r->cell_count;
  return LAVES_OK;
}

/* Makes sure that the corners of cell `at`, which is wanted, are in `numbers`; takes as many of the cells behind it as there is
 * room for, up to the last one of the chunk that is wanted. */
static laves_result load_numbers(ranges *r, laves_error *error) {
  const size_t first = (size_t)r->begin, held_end = r->numbers_first + r->numbers_count;
  if (first >= r->numbers_first && first + (size_t)r->corner_count <= held_end) return LAVES_OK;
  size_t end = first + (size_t)r->corner_count;
  for (size_t i = r->at; i < r->chunk_count && (size_t)r->ends[i] - first <= CHUNK_NUMBERS; i++)
    if (r->types[i] == r->corner_count) end = (size_t)r->ends[i];
  r->numbers_first = first;
  r->numbers_count = 0;
  const laves_result result = read_range(r, &r->arrays[LAVES__VTU_CONNECTIVITY], first, end - first, r->numbers, error);
  if (result == LAVES_OK) r->numbers_count = end - first;
  return result;
}

/* The corners of cell `at`, which is wanted. */
static laves_result take_cell(ranges *r, int32_t cell[4], laves_error *error) {
  const size_t number = r->chunk_first + r->at, size = (size_t)(r->ends[r->at] - r->begin);
  if (size < (size_t)r->corner_count)
    return laves__mesh_input_fail(&r->input, error, "cell %zu (counted from 0) has too few corners", number);
  const laves_result result = load_numbers(r, error);
  if (result != LAVES_OK) return result;
  const laves__vtu_kind kind = r->arrays[LAVES__VTU_CONNECTIVITY].kind;
  const size_t bytes = laves__vtu_kinds[kind].bytes;
  const char *at = r->numbers + ((size_t)r->begin - r->numbers_first) * bytes;
  cell[3] = -1;
  for (int j = 0; j < r->corner_count; j++, at += bytes) {
    const int64_t index = laves__vtu_integer(kind, at);
    if (index < 0 || (uint64_t)index >= r->stream.point_count)
      return laves__mesh_input_fail(&r->input, error, "cell %zu uses point %lld, but the points are 0 to %lld", number,
                                    (long long)index, (long long)r->stream.point_count - 1);
    cell[j] = (int32_t)index;
  }
  r->stream.higher_order |= size > (size_t)r->corner_count;
  return LAVES_OK;
}

static laves_result next_cells(void *user, int32_t (*cells)[4], size_t capacity, size_t *count, laves_error *error) {
  ranges *r = user;
  *count = 0;
  while (*count < capacity) {
    if (r->at == r->chunk_count) {
      if (laves__is_cancelled(r->input.context)) return laves__fail_cancelled(error);
      if (r->chunk_first + r->chunk_count == r->cell_count) break;
      const laves_result result = next_chunk(r, error);
      if (result != LAVES_OK) return result;
    }
    if (r->types[r->at] == r->corner_count) {
      const laves_result result = take_cell(r, cells[*count], error);
      if (result != LAVES_OK) return result;
      ++*count;
    }
    r->begin = r->ends[r->at++];
  }
  return LAVES_OK;
}

/* ---- open and close ---- */

void laves__vtu_ranges_close(laves__mesh_stream *stream) {
  if (!stream) return;
  ranges *r = stream->user;
  laves_context *context = r->input.context;
  if (r->inflater_made) inflateEnd(&r->inflater);
  for (size_t i = 0; i < LAVES__COUNT_OF(r->arrays); i++) {
    laves__free(context, r->arrays[i].starts, r->arrays[i].block_count + 1, sizeof *r->arrays[i].starts);
    laves__free(context, r->arrays[i].block, r->arrays[i].block_bytes, 1);
  }
  laves__free(context, r->packed, r->packed_bytes, 1);
  laves__vtu_free(&r->structure);
  laves__free(context, r->head, r->head_bytes, 1);
  laves__ranged_file_close(&r->file);
  laves__mesh_input_free(&r->input);
  laves__free(context, r, 1, sizeof *r);
}

laves_result laves__vtu_ranges_open(laves_context *context, const char *path, laves__mesh_stream **stream, laves_error *error) {
  *stream = NULL;
  laves__ranged_file file;
  laves_result result = laves__ranged_file_open(&file, path, error);
  if (result != LAVES_OK) return result;
  ranges *r = laves__alloc_zeroed(context, 1, sizeof *r);
  if (!r) {
    laves__ranged_file_close(&file);
    return laves__fail_memory(context, error);
  }
  r->file = file;
  r->input = (laves__mesh_input){.context = context, .name = path};
  r->structure.input = &r->input;
  r->stream =
      (laves__mesh_stream){.user = r, .name = path, .read_points = read_points, .rewind = rewind_cells, .next = next_cells};
  result = find_all(r, error);
  if (result == LAVES_OK)
    *stream = &r->stream;
  else
    laves__vtu_ranges_close(&r->stream);
  return result;
}
