/* NumPy's .npz.
 *
 * Each member of the archive has its checksum before its bytes, so arrays are made twice: once to sum, in parallel by blocks
 * whose sums are then combined, and once to write. Sizes and places that do not fit into 32 bits go into ZIP64's fields. Times
 * are those of 1 January 1980, so that the same arrays have the same bytes. Source: NumPy manual, numpy.lib.format; PKWARE,
 * "APPNOTE.TXT - .ZIP File Format Specification", 6.3.10, sections 4.3 and 4.5.3. */
#include "io/npz_file.h"

#include <stdio.h>
#include <string.h>
#include <zlib.h>

enum { BLOCK_BYTES = 1 << 18, WAVE_BLOCKS = 64, HEADER_MAX = 256, NAME_MAX_BYTES = 40 };
static const uint64_t narrow_max = 0xffffffff; /* stands for "see ZIP64" */

/* ---- .npy ---- */

/* What stands before the numbers; a multiple of 64 bytes. */
static size_t make_header(const laves__npz_array *a, char header[HEADER_MAX]) {
  char shape[60];
  if (a->columns > 0)
    snprintf(shape, sizeof shape, "(%zu, %d)", a->rows, a->columns);
  else
    snprintf(shape, sizeof shape, "(%zu,)", a->rows);
  const size_t start = 10;
  const int length =
      snprintf(header + start, HEADER_MAX - start, "{'descr': '%s', 'fortran_order': False, 'shape': %s, }", a->type, shape);
  const size_t end = (start + (size_t)length + 1 + 63) / 64 * 64;
  LAVES_ASSERT(end <= HEADER_MAX);
  memset(header + start + length, ' ', end - start - (size_t)length - 1);
  header[end - 1] = '\n';
  const uint16_t text_bytes = (uint16_t)(end - start);
  memcpy(header, "\x93NUMPY\x01\x00", 8);
  memcpy(header + 8, &text_bytes, 2);
  return end;
}

static uint64_t member_bytes(const laves__npz_array *a) {
  char header[HEADER_MAX];
  return make_header(a, header) + (uint64_t)a->rows * a->row_bytes;
}

/* ---- checksums ---- */

typedef struct summing {
  const laves__npz_array *array;
  size_t first, rows_per_block; /* block */
  uint32_t sums[WAVE_BLOCKS];
  char *scratch; /* a block for each worker */
} summing;

static size_t block_end(const summing *s, size_t block) {
  const size_t end = (block + 1) * s->rows_per_block;
  return end < s->array->rows ? end : s->array->rows;
}

static void sum_blocks(void *user, size_t begin, size_t end, int worker) {
  summing *s = user;
  char *bytes = s->scratch + (size_t)worker * BLOCK_BYTES;
  for (size_t i = begin; i < end; i++) {
    const size_t block = s->first + i;
    const size_t length = s->array->pack(s->array->user, block * s->rows_per_block, block_end(s, block), bytes);
    s->sums[i] = (uint32_t)crc32(0, (const Bytef *)bytes, (uInt)length);
  }
}

/* Sets the checksum of a member; `done` and `share` are parts of the whole work. */
static void sum_member(laves__output *out, laves__npz_array *a, double done, double share) {
  char header[HEADER_MAX];
  summing s = {.array = a, .rows_per_block = BLOCK_BYTES / a->row_bytes};
  const size_t blocks = (a->rows + s.rows_per_block - 1) / s.rows_per_block;
  a->checksum = (uint32_t)crc32(0, (const Bytef *)header, (uInt)make_header(a, header));
  s.scratch = laves__alloc(out->context, (size_t)laves__workers(out->context), BLOCK_BYTES);
  if (!s.scratch) laves__output_fail_memory(out);
  for (; s.first < blocks && out->error.result == LAVES_OK; s.first += WAVE_BLOCKS) {
    const size_t count = blocks - s.first < WAVE_BLOCKS ? blocks - s.first : WAVE_BLOCKS;
    if (laves__cancelled(out->context, "write", done + share * (double)s.first / (double)blocks) ||
        !laves__parallel_for(out->context, NULL, count, 1, sum_blocks, &s)) {
      laves__fail_cancelled(&out->error);
      break;
    }
    for (size_t i = 0; i < count; i++) {
      const size_t rows = block_end(&s, s.first + i) - (s.first + i) * s.rows_per_block;
      a->checksum = (uint32_t)crc32_combine(a->checksum, s.sums[i], (z_off_t)(rows * a->row_bytes));
    }
  }
  laves__free(out->context, s.scratch, (size_t)laves__workers(out->context), BLOCK_BYTES);
}

/* ---- ZIP ---- */

static void put(laves__output *out, uint64_t value, size_t bytes) { laves__output_bytes(out, &value, bytes); }
static uint64_t narrow(uint64_t value) { return value < narrow_max ? value : narrow_max; }

/* The fields that both kinds of header share, from the version needed on. */
static void put_common(laves__output *out, const laves__npz_array *a, size_t name_bytes, size_t extra_bytes) {
  enum { PLAIN_VERSION = 20, ZIP64_VERSION = 45, FIRST_DAY = 0x21 };
  put(out, extra_bytes ? ZIP64_VERSION : PLAIN_VERSION, 2);
  put(out, 0, 2); /* flags */
  put(out, 0, 2); /* stored */
  put(out, 0, 2);
  put(out, FIRST_DAY, 2);
  put(out, a->checksum, 4);
  for (int i = 0; i < 2; i++) put(out, narrow(member_bytes(a)), 4); /* as stored, and as it is */
  put(out, name_bytes, 2);
  put(out, extra_bytes, 2);
}

static size_t make_name(const laves__npz_array *a, char name[NAME_MAX_BYTES]) {
  return (size_t)snprintf(name, NAME_MAX_BYTES, "%s.npy", a->name);
}

static void write_member(laves__output *out, laves__npz_array *a) {
  char name[NAME_MAX_BYTES], header[HEADER_MAX];
  const size_t name_bytes = make_name(a, name);
  const uint64_t bytes = member_bytes(a);
  const bool wide = bytes >= narrow_max;
  a->place = out->written;
  put(out, 0x04034b50, 4);
  put_common(out, a, name_bytes, wide ? 20 : 0);
  laves__output_bytes(out, name, name_bytes);
  if (wide) {
    put(out, 1, 2);
    put(out, 16, 2);
    for (int i = 0; i < 2; i++) put(out, bytes, 8);
  }
  laves__output_bytes(out, header, make_header(a, header));
  laves__output_rows(out, a->rows, a->row_bytes, a->pack, a->user);
}

static void write_entry(laves__output *out, const laves__npz_array *a) {
  char name[NAME_MAX_BYTES];
  const size_t name_bytes = make_name(a, name);
  const uint64_t bytes = member_bytes(a);
  const bool wide = bytes >= narrow_max, far = a->place >= narrow_max;
  const size_t fields = (wide ? 16u : 0u) + (far ? 8u : 0u), extra = fields ? fields + 4 : 0;
  enum { MADE_BY_UNIX = 3 << 8 | 20 };
  put(out, 0x02014b50, 4);
  put(out, MADE_BY_UNIX, 2);
  put_common(out, a, name_bytes, extra);
  put(out, 0, 2);                       /* comment */
  put(out, 0, 2);                       /* disk */
  put(out, 0, 2);                       /* internal attributes */
  put(out, (uint64_t)0100644 << 16, 4); /* a file that all may read */
  put(out, narrow(a->place), 4);
  laves__output_bytes(out, name, name_bytes);
  if (extra) {
    put(out, 1, 2);
    put(out, fields, 2);
  }
  for (int i = 0; i < 2 && wide; i++) put(out, bytes, 8);
  if (far) put(out, a->place, 8);
}

static void write_directory(laves__output *out, const laves__npz_array *arrays, int count) {
  const uint64_t start = out->written;
  for (int i = 0; i < count; i++) write_entry(out, &arrays[i]);
  const uint64_t end = out->written;
  if (end >= narrow_max) {
    put(out, 0x06064b50, 4);
    put(out, 44, 8);
    put(out, 45, 2);
    put(out, 45, 2);
    put(out, 0, 8); /* disks */
    for (int i = 0; i < 2; i++) put(out, (uint64_t)count, 8);
    put(out, end - start, 8);
    put(out, start, 8);
    put(out, 0x07064b50, 4);
    put(out, 0, 4);
    put(out, end, 8);
    put(out, 1, 4);
  }
  put(out, 0x06054b50, 4);
  put(out, 0, 4); /* disks */
  for (int i = 0; i < 2; i++) put(out, (uint64_t)count, 2);
  put(out, end - start, 4);
  put(out, narrow(start), 4);
  put(out, 0, 2);
}

/* Making the rows a second time and writing them takes about as long as making and summing them. */
static const double summing_share = 0.5;

void laves__write_npz_arrays(laves__output *out, laves__npz_array *arrays, int count) {
  double total = 0;
  for (int i = 0; i < count; i++) total += (double)member_bytes(&arrays[i]);
  for (int i = 0; i < count && out->error.result == LAVES_OK; i++) {
    const double share = summing_share * (double)member_bytes(&arrays[i]) / total;
    sum_member(out, &arrays[i], out->prepared, share);
    out->prepared += share;
  }
  out->expected = total;
  for (int i = 0; i < count; i++) write_member(out, &arrays[i]);
  write_directory(out, arrays, count);
}
