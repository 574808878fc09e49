/* Numbers from the bytes of binary files, which may have the other byte order. */
#ifndef LAVES_IO_BINARY_H
#define LAVES_IO_BINARY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

typedef struct laves__binary {
  const char *at, *end;
  bool swapped; /* the file's byte order is not this machine's */
} laves__binary;

static inline size_t laves__binary_left(const laves__binary *b) { return (size_t)(b->end - b->at); }

/* The next 4 or 8 bytes; false at the end, where the place stays. */
static inline bool laves__binary_u32(laves__binary *b, uint32_t *value) {
  if (laves__binary_left(b) < sizeof *value) return false;
  memcpy(value, b->at, sizeof *value);
  b->at += sizeof *value;
  if (b->swapped) *value = __builtin_bswap32(*value);
  return true;
}

static inline bool laves__binary_u64(laves__binary *b, uint64_t *value) {
  if (laves__binary_left(b) < sizeof *value) return false;
  memcpy(value, b->at, sizeof *value);
  b->at += sizeof *value;
  if (b->swapped) *value = __builtin_bswap64(*value);
  return true;
}

static inline bool laves__binary_i32(laves__binary *b, int32_t *value) {
  uint32_t bits;
  if (!laves__binary_u32(b, &bits)) return false;
  memcpy(value, &bits, sizeof bits);
  return true;
}

static inline bool laves__binary_float(laves__binary *b, double *value) {
  uint32_t bits;
  float narrow;
  if (!laves__binary_u32(b, &bits)) return false;
  memcpy(&narrow, &bits, sizeof bits);
  *value = narrow;
  return true;
}

static inline bool laves__binary_double(laves__binary *b, double *value) {
  uint64_t bits;
  if (!laves__binary_u64(b, &bits)) return false;
  memcpy(value, &bits, sizeof bits);
  return true;
}

#endif
