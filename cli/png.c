/* A PNG writer: eight bits a channel, no palette, one IDAT chunk.
 *
 * Each row is stored by the one of the five filters whose bytes, read as signed, have the smallest sum of magnitudes;
 * the heuristic is the one that the standard recommends and suits flat shading with thin lines well.
 *
 * Source: [iso15948], sections 5 (chunks), 9 (filters) and 12.8 (choice of filter). */
#include "png.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "interrupt.h"
#include "whole_file.h"

enum { filter_count = 5, colour_rgb = 2, colour_rgba = 6 };

static void put_u32(uint8_t *out, uint32_t value) {
  for (int i = 0; i < 4; i++) {
    out[i] = (uint8_t)(value >> (24 - 8 * i));
  }
}

static bool write_chunk(FILE *file, const char type[4], const uint8_t *data, size_t size) {
  uint8_t head[8], tail[4];
  put_u32(head, (uint32_t)size);
  memcpy(head + 4, type, 4);
  uLong crc = crc32(crc32(0, Z_NULL, 0), head + 4, 4);
  if (size > 0) {
    crc = crc32_z(crc, data, size);
  }
  put_u32(tail, (uint32_t)crc);
  return fwrite(head, 1, 8, file) == 8 && fwrite(data, 1, size, file) == size && fwrite(tail, 1, 4, file) == 4;
}

/* The nearest of left, above and upper left to left + above - upper_left; ties go in that order. */
static uint8_t paeth(int left, int above, int upper_left) {
  int guess = left + above - upper_left;
  int to_left = abs(guess - left), to_above = abs(guess - above), to_corner = abs(guess - upper_left);
  if (to_left <= to_above && to_left <= to_corner) {
    return (uint8_t)left;
  }
  return (uint8_t)(to_above <= to_corner ? above : upper_left);
}

/* Filters one row into `out`; `above` is the row before it (zeros for the first). Returns the sum of magnitudes. */
static unsigned long filter_row(int filter, const uint8_t *row, const uint8_t *above, size_t size, int step, uint8_t *out) {
  unsigned long sum = 0;
  for (size_t i = 0; i < size; i++) {
    int left = i >= (size_t)step ? row[i - (size_t)step] : 0;
    int corner = i >= (size_t)step ? above[i - (size_t)step] : 0;
    int guess[filter_count] = {0, left, above[i], (left + above[i]) / 2, 0};
    if (filter == 4) {
      guess[4] = paeth(left, above[i], corner);
    }
    out[i] = (uint8_t)(row[i] - guess[filter]);
    sum += (unsigned long)abs((int8_t)out[i]);
  }
  return sum;
}

/* All rows, each preceded by the number of its filter. NULL when memory is short. */
static uint8_t *filter_rows(const uint8_t *pixels, size_t row_size, int height, int step) {
  uint8_t *out = malloc((row_size + 1) * (size_t)height);
  uint8_t *scratch = calloc(2, row_size);
  if (!out || !scratch) {
    free(out);
    free(scratch);
    return NULL;
  }
  const uint8_t *zeros = scratch + row_size;
  for (int y = 0; y < height && !interrupt_asked(); y++) {
    const uint8_t *row = pixels + row_size * (size_t)y;
    const uint8_t *above = y > 0 ? row - row_size : zeros;
    uint8_t *target = out + (row_size + 1) * (size_t)y;
    unsigned long best = (unsigned long)-1;
    for (int filter = 0; filter < filter_count; filter++) {
      unsigned long sum = filter_row(filter, row, above, row_size, step, scratch);
      if (sum < best) {
        best = sum;
        target[0] = (uint8_t)filter;
        memcpy(target + 1, scratch, row_size);
      }
    }
  }
  free(scratch);
  return out;
}

/* Compresses in pieces, between which the work may stop. *packed_size: the room, then what is used of it. */
static bool pack(const uint8_t *raw, size_t raw_size, uint8_t *packed, size_t *packed_size) {
  enum { BEST = 9, PIECE = 1 << 16 };
  z_stream z = {.next_in = (Bytef *)raw, .next_out = packed};
  if (deflateInit(&z, BEST) != Z_OK) {
    return false;
  }
  int status = Z_OK;
  while (status == Z_OK && !interrupt_asked()) {
    size_t done = (size_t)(z.next_in - raw), room = *packed_size - (size_t)(z.next_out - packed);
    z.avail_in = (uInt)(raw_size - done < PIECE ? raw_size - done : PIECE);
    z.avail_out = (uInt)(room < PIECE ? room : PIECE);
    status = deflate(&z, done + z.avail_in == raw_size ? Z_FINISH : Z_NO_FLUSH);
  }
  *packed_size = (size_t)(z.next_out - packed);
  deflateEnd(&z);
  return status == Z_STREAM_END;
}

static bool write_chunks(FILE *file, const uint8_t *packed, size_t packed_size, int width, int height, int channels) {
  static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  uint8_t header[13] = {0};
  put_u32(header, (uint32_t)width);
  put_u32(header + 4, (uint32_t)height);
  header[8] = 8;
  header[9] = channels == 4 ? colour_rgba : colour_rgb;
  const uint8_t perceptual = 0;
  return fwrite(signature, 1, 8, file) == 8 && write_chunk(file, "IHDR", header, sizeof header) &&
         write_chunk(file, "sRGB", &perceptual, 1) && write_chunk(file, "IDAT", packed, packed_size) &&
         write_chunk(file, "IEND", &perceptual, 0);
}

bool png_write(const char *path, const uint8_t *pixels, int width, int height, int channels) {
  whole_file out;
  size_t row_size = (size_t)width * (size_t)channels;
  size_t raw_size = (row_size + 1) * (size_t)height;
  size_t packed_size = compressBound((uLong)raw_size);
  uint8_t *raw = filter_rows(pixels, row_size, height, channels);
  uint8_t *packed = malloc(packed_size);
  bool done = raw && packed && pack(raw, raw_size, packed, &packed_size);
  if (!done) {
    errno = ENOMEM;
  }
  done = done && whole_file_open(&out, path) &&
         whole_file_close(&out, write_chunks(out.file, packed, packed_size, width, height, channels));
  int reason = errno;
  free(raw);
  free(packed);
  errno = reason;
  return done;
}
