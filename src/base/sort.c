/* Least significant digit radix sort, eight bits at a time; digits that are all alike are skipped. And a merge sort for all
 * threads: each sorts a piece, then pieces are merged two by two, each pair from both ends at once, so that the last pair, too,
 * is work for two. */
#include "base/sort.h"

#include <stdlib.h>
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

enum { SORT_ALONE = 2048 }; /* fewer items are not worth a thread */

typedef struct sorting {
  char *from, *to;
  size_t count, size, piece;
  int (*compare)(const void *, const void *);
} sorting;

static void sort_pieces(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const sorting *s = user;
  for (size_t i = begin; i < end; i++) {
    const size_t first = i * s->piece, rest = s->count - first;
    qsort(s->from + first * s->size, rest < s->piece ? rest : s->piece, s->size, s->compare);
  }
}

/* The lower half of what a and b hold, ascending. */
static void merge_front(const sorting *s, const char *a, const char *a_end, const char *b, const char *b_end, char *out,
                        size_t count) {
  for (size_t i = 0; i < count; i++, out += s->size) {
    const bool first = b == b_end || (a < a_end && s->compare(a, b) <= 0);
    memcpy(out, first ? a : b, s->size);
    if (first)
      a += s->size;
    else
      b += s->size;
  }
}

/* The upper half, from its end downwards. */
static void merge_back(const sorting *s, const char *a, const char *a_end, const char *b, const char *b_end, char *out_end,
                       size_t count) {
  for (size_t i = 0; i < count; i++) {
    const bool second = a == a_end || (b < b_end && s->compare(a_end - s->size, b_end - s->size) <= 0);
    const char *last = second ? b_end : a_end;
    out_end -= s->size;
    memcpy(out_end, last - s->size, s->size);
    if (second)
      b_end -= s->size;
    else
      a_end -= s->size;
  }
}

/* Task 2 i is the lower half of pair i, task 2 i + 1 the upper one. */
static void merge_pairs(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const sorting *s = user;
  for (size_t task = begin; task < end; task++) {
    const size_t first = task / 2 * 2 * s->piece, rest = s->count - first;
    const size_t count = rest < 2 * s->piece ? rest : 2 * s->piece, middle = count < s->piece ? count : s->piece;
    const char *a = s->from + first * s->size, *b = a + middle * s->size, *b_end = a + count * s->size;
    char *out = s->to + first * s->size;
    if (task % 2 == 0)
      merge_front(s, a, b, b, b_end, out, count / 2);
    else
      merge_back(s, a, b, b, b_end, out + count * s->size, count - count / 2);
  }
}

bool laves__sort(laves_context *context, void *items, void *scratch, size_t count, size_t size,
                 int (*compare)(const void *, const void *)) {
  const size_t workers = count < SORT_ALONE ? 1 : (size_t)laves__workers(context);
  sorting s = {items, scratch, count, size, count / workers + 1, compare};
  if (count == 0) return !laves__is_cancelled(context);
  if (!laves__parallel_for(context, NULL, (count - 1) / s.piece + 1, 0, sort_pieces, &s)) return false;
  for (; s.piece < count; s.piece *= 2) {
    const size_t pairs = (count - 1) / (2 * s.piece) + 1;
    if (!laves__parallel_for(context, NULL, 2 * pairs, 0, merge_pairs, &s)) return false;
    char *sorted = s.to;
    s.to = s.from;
    s.from = sorted;
  }
  if (s.from != items) memcpy(items, s.from, count * size);
  return true;
}
