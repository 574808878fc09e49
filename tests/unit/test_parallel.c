/* The parallel loop: every index once, workers in range, cancelling, progress from the calling thread only. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/base.h"

typedef struct visits {
  unsigned char *count; /* written by the index's worker only */
  atomic_int worker_max;
  atomic_size_t blocks, least_block;
  size_t total;
} visits;

static void visit(void *user, size_t begin, size_t end, int worker) {
  visits *v = user;
  for (size_t i = begin; i < end; i++) v->count[i]++;
  int highest = atomic_load(&v->worker_max);
  while (worker > highest && !atomic_compare_exchange_weak(&v->worker_max, &highest, worker)) {
  }
  size_t least = atomic_load(&v->least_block);
  while (end != v->total && end - begin < least && !atomic_compare_exchange_weak(&v->least_block, &least, end - begin)) {
  }
  atomic_fetch_add(&v->blocks, 1);
}

static laves_context *create(int threads, laves_progress_fn *progress, void *user) {
  laves_context_options options = laves_context_options_default();
  options.thread_count = threads;
  options.progress = progress;
  options.progress_user = user;
  return laves_context_create(&options);
}

static void every_index_is_visited_once(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 3, 7};
  static const size_t counts[] = {0, 1, 2, 15, 16, 17, 1000, 100003}, blocks[] = {0, 1, 64, 5000};
  for (size_t t = 0; t < LAVES__COUNT_OF(threads); t++) {
    laves_context *context = create(threads[t], NULL, NULL);
    assert_int_equal(laves__workers(context), threads[t]);
    for (size_t c = 0; c < LAVES__COUNT_OF(counts); c++)
      for (size_t b = 0; b < LAVES__COUNT_OF(blocks); b++) {
        visits v = {.count = calloc(counts[c] + 1, 1), .least_block = SIZE_MAX, .total = counts[c]};
        assert_true(laves__parallel_for(context, NULL, counts[c], blocks[b], visit, &v));
        for (size_t i = 0; i < counts[c]; i++) assert_int_equal(v.count[i], 1);
        assert_int_equal(v.count[counts[c]], 0);
        assert_in_range(v.worker_max, 0, threads[t] - 1);
        assert_true(v.least_block >= blocks[b]);
        free(v.count);
      }
    laves_context_free(context);
  }
}

typedef struct stopper {
  int calls, allowed;
  double last;
} stopper;

static bool stop(void *user, const char *phase, double fraction) {
  stopper *s = user;
  assert_string_equal(phase, "testing");
  assert_true(fraction >= s->last && fraction <= 1);
  s->last = fraction;
  return ++s->calls <= s->allowed;
}

static void cancelling_skips_the_rest(void **state) {
  (void)state;
  stopper s = {.allowed = 3};
  laves_context *context = create(1, stop, &s);
  visits v = {.count = calloc(1601, 1), .least_block = SIZE_MAX, .total = 1600};
  assert_false(laves__parallel_for(context, "testing", 1600, 1, visit, &v));
  assert_int_equal(v.blocks, 3);
  assert_true(laves__is_cancelled(context));
  /* It stays so until the next public call. */
  assert_false(laves__parallel_for(context, "testing", 1600, 1, visit, &v));
  assert_int_equal(v.blocks, 3);
  assert_int_equal(s.calls, 4);
  laves__progress_reset(context);
  s = (stopper){.allowed = 1 << 30};
  assert_true(laves__parallel_for(context, "testing", 1600, 1, visit, &v));
  assert_true(v.blocks >= 3 + 16); /* their size follows the clock, up to a sixteenth */
  free(v.count);
  laves_context_free(context);
}

static void cancelling_ends_all_workers(void **state) {
  (void)state;
  stopper s = {.allowed = 0};
  laves_context *context = create(4, stop, &s);
  visits v = {.count = calloc(100001, 1), .least_block = SIZE_MAX, .total = 100000};
  (void)laves__parallel_for(context, "testing", 100000, 1, visit, &v);
  for (size_t i = 0; i < 100000; i++) assert_true(v.count[i] <= 1);
  free(v.count);
  laves_context_free(context);
}

static double add(const void *user, size_t begin, size_t end) {
  const double *value = user;
  double sum = 0;
  for (size_t i = begin; i < end; i++) sum += value[i];
  return sum;
}

/* Values whose sum depends on the order in which they are added. */
static void sums_have_the_same_bits_for_any_number_of_threads(void **state) {
  (void)state;
  enum { COUNT = 100003 };
  static const size_t counts[] = {0, 1, 31, 32, 33, 1024 * 32, 1024 * 32 + 1, COUNT};
  static double value[COUNT];
  for (size_t i = 0; i < COUNT; i++) value[i] = 1e8 / (double)(1 + i * 7919 % COUNT) - 1;
  for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
    double first = 0;
    for (int threads = 1; threads <= 4; threads++) {
      laves_context *context = create(threads, NULL, NULL);
      const double sum = laves__parallel_sum(context, NULL, counts[c], add, value);
      if (threads == 1) first = sum;
      assert_memory_equal(&sum, &first, sizeof sum);
      laves_context_free(context);
    }
    const double plain = add(value, 0, counts[c]);
    assert_true(fabs(first - plain) <= 1e-10 * (1 + fabs(plain)));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_index_is_visited_once),
      cmocka_unit_test(cancelling_skips_the_rest),
      cmocka_unit_test(cancelling_ends_all_workers),
      cmocka_unit_test(sums_have_the_same_bits_for_any_number_of_threads),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
