/* Least significant digit radix sort, eight bits at a time; digits that are all alike are skipped. */
#include "base/sort.h"

#include <string.h>

enum { DIGITS = 8, RADIX = 256 };

void laves__sort_u64(uint64_t *items, uint64_t *scratch, size_t count) {
  size_t histogram[DIGITS][RADIX];
  memset(histogram, 0, sizeof histogram);
  for (size_t i = 0; i < count; i++)
    for (int d = 0; d < DIGITS; d++) histogram[d][items[i] >> (8 * d) & 255]++;
  uint64_t *from = items, *to = scratch;
  for (int d = 0; d < DIGITS; d++) {
    if (count == 0 || histogram[d][from[0] >> (8 * d) & 255] == count) continue;
    size_t place[RADIX], sum = 0;
    for (int r = 0; r < RADIX; r++) {
      place[r] = sum;
      sum += histogram[d][r];
    }
    for (size_t i = 0; i < count; i++) to[place[from[i] >> (8 * d) & 255]++] = from[i];
    uint64_t *other = from;
    from = to;
    to = other;
  }
  if (from != items && count) memcpy(items, from, count * sizeof *items);
}
