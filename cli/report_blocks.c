/* Arrays of numbers as text inside a page: predicted, split into planes of bytes, deflated, base64.
 *
 * Neighbours in a mesh have numbers that are near one another, so differences are small and their upper bytes mostly zero; with
 * equal bytes side by side, deflate finds them. web/src/blocks.js is the inverse. */
#include "report_blocks.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "interrupt.h"

enum { LEVEL = 6 };

static uint8_t *extend(report_block *block, size_t count) {
  if (block->failed) return NULL;
  if (count > block->capacity - block->count) {
    const size_t capacity = 2 * block->capacity + count + 1024;
    uint8_t *bytes = realloc(block->bytes, capacity);
    if (!bytes) {
      block->failed = true;
      return NULL;
    }
    block->bytes = bytes;
    block->capacity = capacity;
  }
  block->count += count;
  return block->bytes + block->count - count;
}

void report_block_bytes(report_block *block, const uint8_t *values, size_t count) {
  uint8_t *out = extend(block, count);
  if (out && count > 0) memcpy(out, values, count);
}

void report_block_shorts(report_block *block, const uint16_t *values, size_t count) {
  uint8_t *out = extend(block, 2 * count);
  for (size_t i = 0; out && i < count; ++i) {
    out[i] = (uint8_t)values[i];
    out[count + i] = (uint8_t)(values[i] >> 8);
  }
}

static void put_planes(uint8_t *out, size_t i, size_t count, uint32_t value) {
  for (size_t plane = 0; plane < 4; ++plane) out[plane * count + i] = (uint8_t)(value >> 8 * plane);
}

void report_block_floats(report_block *block, const float *values, size_t count) {
  uint8_t *out = extend(block, 4 * count);
  for (size_t i = 0; out && i < count; ++i) {
    uint32_t bits;
    memcpy(&bits, &values[i], sizeof bits);
    put_planes(out, i, count, bits);
  }
}

void report_block_indices(report_block *block, const uint32_t *values, size_t count) {
  uint8_t *out = extend(block, 4 * count);
  uint32_t before = 0;
  for (size_t i = 0; out && i < count; ++i) {
    const uint32_t difference = values[i] - before, sign = difference >> 31;
    put_planes(out, i, count, difference << 1 ^ (0 - sign));
    before = values[i];
  }
}

static void write_base64(FILE *file, const uint8_t *bytes, size_t count) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  char line[4096];
  size_t used = 0;
  for (size_t i = 0; i < count; i += 3) {
    const uint32_t second = i + 1 < count ? bytes[i + 1] : 0, third = i + 2 < count ? bytes[i + 2] : 0;
    const uint32_t group = (uint32_t)bytes[i] << 16 | second << 8 | third;
    line[used++] = digits[group >> 18];
    line[used++] = digits[group >> 12 & 63];
    line[used++] = i + 1 < count ? digits[group >> 6 & 63] : '=';
    line[used++] = i + 2 < count ? digits[group & 63] : '=';
    if (used == sizeof line) {
      fwrite(line, 1, used, file);
      used = 0;
    }
  }
  fwrite(line, 1, used, file);
}

/* Deflates in pieces, between which the work may be asked to stop. */
static bool pack(const report_block *block, uint8_t *packed, size_t capacity, size_t *count) {
  static const size_t piece = 1 << 18;
  z_stream stream = {0};
  if (deflateInit(&stream, LEVEL) != Z_OK) return false;
  stream.next_out = packed;
  stream.avail_out = (uInt)capacity;
  int result = Z_OK;
  while (result == Z_OK && !interrupt_asked()) {
    const size_t at = stream.total_in, left = block->count - at;
    stream.next_in = left > 0 ? block->bytes + at : packed; /* an empty block has no bytes */
    stream.avail_in = (uInt)(left < piece ? left : piece);
    result = deflate(&stream, left <= piece ? Z_FINISH : Z_NO_FLUSH);
  }
  *count = stream.total_out;
  deflateEnd(&stream);
  return result == Z_STREAM_END;
}

bool report_block_write(FILE *file, const char *id, report_block *block) {
  const uLong capacity = compressBound((uLong)block->count);
  uint8_t *packed = block->failed ? NULL : calloc(capacity, 1);
  size_t count = 0;
  const bool done = packed && pack(block, packed, capacity, &count);
  if (done) {
    fprintf(file, "<script type=\"application/octet-stream\" id=\"%s\">", id);
    write_base64(file, packed, count);
    fputs("</script>\n", file);
  }
  free(packed);
  block->count = 0;
  return done;
}

void report_block_free(report_block *block) {
  free(block->bytes);
  *block = (report_block){0};
}
