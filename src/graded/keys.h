/* Places with whole coordinates as keys, and a table from key to number.
 *
 * A key interleaves the bits of the coordinates, so keys in order follow the Morton curve. */
#ifndef LAVES_GRADED_KEYS_H
#define LAVES_GRADED_KEYS_H

#include "base/base.h"

static inline uint64_t laves__spread_bits(uint64_t x) {
  x = (x | x << 32) & UINT64_C(0x1f00000000ffff);
  x = (x | x << 16) & UINT64_C(0x1f0000ff0000ff);
  x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
  x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
  return (x | x << 2) & UINT64_C(0x1249249249249249);
}

static inline int32_t laves__gather_bits(uint64_t x) {
  x &= UINT64_C(0x1249249249249249);
  x = (x | x >> 2) & UINT64_C(0x10c30c30c30c30c3);
  x = (x | x >> 4) & UINT64_C(0x100f00f00f00f00f);
  x = (x | x >> 8) & UINT64_C(0x1f0000ff0000ff);
  x = (x | x >> 16) & UINT64_C(0x1f00000000ffff);
  return (int32_t)((x | x >> 32) & UINT64_C(0x1fffff));
}

/* Coordinates from 0 to 2^21 - 1. */
static inline uint64_t laves__key_of(int32_t x, int32_t y, int32_t z) {
  return laves__spread_bits((uint64_t)x) | laves__spread_bits((uint64_t)y) << 1 | laves__spread_bits((uint64_t)z) << 2;
}

static inline void laves__key_place(uint64_t key, int32_t at[3]) {
  for (int axis = 0; axis < 3; axis++) at[axis] = laves__gather_bits(key >> axis);
}

/* Ascending keys without repetition, and where to find them. */
typedef struct laves__key_table {
  laves_context *context;
  uint64_t *key; /* [count] */
  size_t count, capacity;
  int32_t *slot; /* [slot_count] a power of two; index of the key, or -1 */
  size_t slot_count;
} laves__key_table;

/* Takes `keys` over (allocated with `capacity`), sorts them and leaves each once; false when memory is short or it is cancelled,
 * with the keys taken over all the same. */
bool laves__key_table_make(laves_context *context, uint64_t *keys, size_t count, size_t capacity, laves__key_table *table);
/* The number of a key, or -1. */
int32_t laves__key_find(const laves__key_table *table, uint64_t key);
void laves__key_table_free(laves__key_table *table);

#endif
