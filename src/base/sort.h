/* Sorting of 64-bit keys, and of anything by all threads. */
#ifndef LAVES_BASE_SORT_H
#define LAVES_BASE_SORT_H

#include "base/base.h"

/* Sorts ascending, stable, by radix; scratch has the same size as items. */
void laves__sort_u64(uint64_t *items, uint64_t *scratch, size_t count);

/* Sorts items of `size` bytes by all threads: what qsort() does, but equal items may end in any order, so `compare` should tell
 * all items apart. scratch has the same size as items. False, with items in disorder, on a cancel. */
bool laves__sort(laves_context *context, void *items, void *scratch, size_t count, size_t size,
                 int (*compare)(const void *, const void *));

/* A key that sorts by a non-negative value first, then by index: the bits of a float rise with its value. */
static inline uint64_t laves__sort_key(double value, uint32_t index) {
  union {
    float f;
    uint32_t u;
  } bits = {.f = (float)value};
  return (uint64_t)bits.u << 32 | index;
}

#endif
