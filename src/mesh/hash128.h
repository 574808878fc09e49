/* A 128-bit hash of bytes, for telling meshes and files apart; no protection against forgery. */
#ifndef LAVES_MESH_HASH128_H
#define LAVES_MESH_HASH128_H

#include "base/base.h"

typedef struct laves__hash128 {
  uint64_t low, high;
} laves__hash128;

/* MurmurHash3, the variant for 64-bit machines with 128 bits, of an array of elements of `element` bytes (1, 4 or 8)
 * as they stand in little-endian memory, on any machine. */
laves__hash128 laves__hash_bytes(const void *data, size_t bytes, size_t element, laves__hash128 seed);

/* 32 hexadecimal digits, low half first, and NUL. */
void laves__hash_text(laves__hash128 hash, char text[33]);

#endif
