/* Radix sort against the library's qsort. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/sort.h"
#include "fixtures/random_expression.h"

static int compare(const void *left, const void *right) {
  const uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
  return a < b ? -1 : a > b;
}

/* Sorts `count` random numbers below 2^bits. */
static void sort_and_compare(size_t count, int bits, uint64_t seed) {
  uint64_t *items = malloc((count + 1) * sizeof *items), *scratch = malloc((count + 1) * sizeof *scratch);
  uint64_t *expected = malloc((count + 1) * sizeof *expected);
  assert_true(items && scratch && expected);
  for (size_t i = 0; i < count; i++) items[i] = (uint64_t)(random_unit(&seed) * ldexp(1, bits));
  memcpy(expected, items, count * sizeof *items);
  qsort(expected, count, sizeof *expected, compare);
  laves__sort_u64(items, scratch, count);
  assert_memory_equal(items, expected, count * sizeof *items);
  free(items);
  free(scratch);
  free(expected);
}

static void sorts_all_widths(void **state) {
  (void)state;
  static const size_t counts[] = {0, 1, 2, 3, 255, 256, 1000, 20001};
  for (size_t i = 0; i < LAVES__COUNT_OF(counts); i++)
    for (int bits = 1; bits <= 64; bits += 7) sort_and_compare(counts[i], bits, i * 64 + (uint64_t)bits);
}

static void sorts_by_the_highest_and_lowest_digit(void **state) {
  (void)state;
  uint64_t items[6] = {UINT64_MAX, 0, UINT64_C(1) << 63, 1, UINT64_C(1) << 56, 255}, scratch[6];
  laves__sort_u64(items, scratch, 6);
  const uint64_t expected[6] = {0, 1, 255, UINT64_C(1) << 56, UINT64_C(1) << 63, UINT64_MAX};
  assert_memory_equal(items, expected, sizeof expected);
}

static void keys_order_by_value_then_index(void **state) {
  (void)state;
  static const double rising[] = {0, 1e-40, 1e-30, 0.1, 0.5, 0.50001, 1, 1.25, 1e9, 1e30};
  for (size_t i = 0; i + 1 < LAVES__COUNT_OF(rising); i++) {
    assert_true(laves__sort_key(rising[i], UINT32_MAX) < laves__sort_key(rising[i + 1], 0));
    assert_true(laves__sort_key(rising[i], 3) < laves__sort_key(rising[i], 4));
    assert_int_equal((uint32_t)laves__sort_key(rising[i], 123456789), 123456789);
  }
}

/* An item is more than its key, so that what moves is seen. */
typedef struct pair {
  uint64_t key, echo[4];
} pair;

static void all_threads_sort_like_qsort(void **state) {
  (void)state;
  static const size_t counts[] = {0, 1, 2, 2047, 2048, 2049, 5000, 30011};
  for (int threads = 1; threads <= 7; threads += 2) {
    laves_context_options options = laves_context_options_default();
    options.thread_count = threads;
    laves_context *context = laves_context_create(&options);
    for (size_t i = 0; i < LAVES__COUNT_OF(counts); i++) {
      const size_t count = counts[i];
      pair *items = malloc((count + 1) * sizeof *items), *scratch = malloc((count + 1) * sizeof *scratch);
      uint64_t *expected = malloc((count + 1) * sizeof *expected), seed = i;
      assert_true(context && items && scratch && expected);
      for (size_t k = 0; k < count; k++) {
        expected[k] = (uint64_t)(random_unit(&seed) * (i % 2 ? 1e3 : 1e15)); /* many alike, and none */
        items[k] = (pair){expected[k], {expected[k], expected[k], expected[k], expected[k]}};
      }
      qsort(expected, count, sizeof *expected, compare);
      assert_true(laves__sort(context, items, scratch, count, sizeof *items, compare));
      for (size_t k = 0; k < count; k++) {
        assert_int_equal(items[k].key, expected[k]);
        assert_int_equal(items[k].echo[3], expected[k]);
      }
      free(items);
      free(scratch);
      free(expected);
    }
    laves_context_free(context);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sorts_all_widths),
      cmocka_unit_test(sorts_by_the_highest_and_lowest_digit),
      cmocka_unit_test(all_threads_sort_like_qsort),
      cmocka_unit_test(keys_order_by_value_then_index),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
