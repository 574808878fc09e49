/* Radix sort, lowest byte first, leaving out the bytes that all keys share. Its time depends on nothing but the count. */
#include <string.h>

#include "certify/certify.h"

static void distribute(const laves__keyed *from, laves__keyed *to, size_t count, int shift, size_t start[256]) {
  size_t next = 0;
  for (int digit = 0; digit < 256; digit++) {
    const size_t here = start[digit];
    start[digit] = next;
    next += here;
  }
  for (size_t i = 0; i < count; i++) to[start[from[i].key >> shift & 255]++] = from[i];
}

bool laves__sort_keyed(laves_context *context, laves__keyed *items, laves__keyed *scratch, size_t count) {
  laves__keyed *from = items, *to = scratch;
  bool done = true;
  for (int shift = 0; shift < 64 && done; shift += 8) {
    size_t counts[256] = {0};
    for (size_t i = 0; i < count; i++) counts[from[i].key >> shift & 255]++;
    if (count == 0 || counts[from[0].key >> shift & 255] == count) continue;
    distribute(from, to, count, shift, counts);
    laves__keyed *swap = from;
    from = to;
    to = swap;
    done = !context || !laves__cancelled(context, "check", 0.8);
  }
  if (from != items) memcpy(items, from, count * sizeof *items);
  return done;
}
