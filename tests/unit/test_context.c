/* The context counts every byte, holds its limit and passes failures on. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/base.h"

/* A reallocate hook that counts calls and fails from the `fail_from`-th request on. */
typedef struct hook {
  size_t bytes, requests, fail_from;
} hook;

static void *hooked(void *user, void *pointer, size_t old_bytes, size_t new_bytes) {
  hook *h = user;
  if (new_bytes == 0) {
    h->bytes -= old_bytes;
    free(pointer);
    return NULL;
  }
  if (++h->requests > h->fail_from) return NULL;
  void *block = realloc(pointer, new_bytes);
  if (block) h->bytes += new_bytes - old_bytes;
  return block;
}

static laves_context *create(size_t limit, hook *h) {
  laves_context_options options = laves_context_options_default();
  options.memory_limit = limit;
  if (h) {
    options.reallocate = hooked;
    options.reallocate_user = h;
  }
  laves_context *context = laves_context_create(&options);
  assert_non_null(context);
  return context;
}

static void bytes_and_peak_are_counted(void **state) {
  (void)state;
  laves_context *context = create(0, NULL);
  void *a = laves__alloc(context, 100, 8), *b = laves__alloc_zeroed(context, 50, 4);
  assert_int_equal(laves_context_bytes(context), 1000);
  for (int i = 0; i < 200; i++) assert_int_equal(((char *)b)[i], 0);
  laves__free(context, a, 100, 8);
  assert_int_equal(laves_context_bytes(context), 200);
  assert_int_equal(laves_context_peak_bytes(context), 1000);
  laves__free(context, b, 50, 4);
  laves__free(context, NULL, 50, 4);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void limit_refuses_and_leaves_the_count(void **state) {
  (void)state;
  laves_context *context = create(1000, NULL);
  char *a = laves__alloc(context, 600, 1);
  assert_non_null(a);
  memset(a, 7, 600);
  assert_null(laves__alloc(context, 401, 1));
  assert_null(laves__realloc(context, a, 600, 1001, 1));
  assert_int_equal(laves_context_bytes(context), 600);
  for (int i = 0; i < 600; i++) assert_int_equal(a[i], 7);
  a = laves__realloc(context, a, 600, 1000, 1);
  assert_non_null(a);
  laves__free(context, a, 1000, 1);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_error error;
  assert_int_equal(laves__fail_memory(context, &error), LAVES_ERROR_MEMORY);
  assert_true(error.text[0]);
  laves_context_free(context);
}

static void sizes_that_overflow_are_refused(void **state) {
  (void)state;
  laves_context *context = create(0, NULL);
  assert_null(laves__alloc(context, SIZE_MAX / 2, 4));
  assert_null(laves__alloc_zeroed(context, SIZE_MAX, SIZE_MAX));
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void empty_blocks_are_blocks(void **state) {
  (void)state;
  laves_context *context = create(0, NULL);
  void *a = laves__alloc(context, 0, 8);
  assert_non_null(a);
  a = laves__realloc(context, a, 0, 5, 8);
  assert_int_equal(laves_context_bytes(context), 40);
  a = laves__realloc(context, a, 5, 0, 8);
  assert_non_null(a);
  laves__free(context, a, 0, 8);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void growing_keeps_contents(void **state) {
  (void)state;
  laves_context *context = create(0, NULL);
  int *items = NULL;
  size_t capacity = 0;
  for (size_t i = 0; i < 1000; i++) {
    assert_true(laves__grow(context, &items, &capacity, i + 1, sizeof *items));
    assert_true(capacity > i);
    items[i] = (int)i;
  }
  for (int i = 0; i < 1000; i++) assert_int_equal(items[i], i);
  assert_false(laves__grow(context, &items, &capacity, SIZE_MAX / 2, sizeof *items));
  assert_int_equal(items[999], 999);
  laves__free(context, items, capacity, sizeof *items);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void hook_sees_true_sizes_and_its_failures_are_passed_on(void **state) {
  (void)state;
  hook h = {.fail_from = 3};
  laves_context *context = create(0, &h);
  const size_t own = h.bytes;
  void *a = laves__alloc(context, 10, 10);
  assert_non_null(a);
  a = laves__realloc(context, a, 10, 30, 10);
  assert_int_equal(h.bytes, own + 300);
  assert_null(laves__alloc(context, 1, 1));
  assert_null(laves__realloc(context, a, 30, 40, 10));
  assert_int_equal(laves_context_bytes(context), 300);
  laves__free(context, a, 30, 10);
  laves_context_free(context);
  assert_int_equal(h.bytes, 0);
}

static void foreign_options_are_refused(void **state) {
  (void)state;
  laves_context_options options = laves_context_options_default();
  options.cookie++;
  assert_null(laves_context_create(&options));
  memset(&options, 0, sizeof options);
  assert_null(laves_context_create(&options));
  laves_context_free(NULL);
  hook h = {.fail_from = 0};
  options = laves_context_options_default();
  options.reallocate = hooked;
  options.reallocate_user = &h;
  assert_null(laves_context_create(&options));
}

static bool count_reports(void *user, const char *phase, double fraction) {
  (void)phase;
  (void)fraction;
  return ++*(int *)user < 5;
}

/* With an hour between calls, the callback hears of each new phase, and again after a reset; without, of every turn. */
static void progress_keeps_its_interval(void **state) {
  (void)state;
  for (int hours = 0; hours < 2; hours++) {
    int reports = 0;
    laves_context_options options = laves_context_options_default();
    options.progress = count_reports;
    options.progress_user = &reports;
    options.progress_interval = 3600 * hours;
    laves_context *context = laves_context_create(&options);
    static const char one[] = "one", two[] = "two";
    assert_false(laves__cancelled(context, one, 0));
    assert_false(laves__cancelled(context, one, 0.5));
    assert_int_equal(reports, hours ? 1 : 2);
    assert_false(laves__cancelled(context, two, 0));
    laves__progress_reset(context);
    assert_false(laves__cancelled(context, two, 0.5));
    assert_int_equal(reports, hours ? 3 : 4);
    laves__progress_reset(context);
    reports = 4;
    assert_true(laves__cancelled(context, two, 0.6));
    assert_true(laves__cancelled(context, two, 0.7)); /* it stays so, without a call */
    assert_int_equal(reports, 5);
    laves_context_free(context);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bytes_and_peak_are_counted),      cmocka_unit_test(limit_refuses_and_leaves_the_count),
      cmocka_unit_test(sizes_that_overflow_are_refused), cmocka_unit_test(empty_blocks_are_blocks),
      cmocka_unit_test(growing_keeps_contents),          cmocka_unit_test(hook_sees_true_sizes_and_its_failures_are_passed_on),
      cmocka_unit_test(foreign_options_are_refused),     cmocka_unit_test(progress_keeps_its_interval),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
