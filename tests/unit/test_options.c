/* Every option out of its range is refused with its name; sizes from counts and their correction. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/assert_close.h"
#include "options.h"

static void assert_refused(const laves_options *options, const char *phrase) {
  laves_error error = {.text = ""};
  assert_int_equal(laves__options_check(options, &error), LAVES_ERROR_OPTION);
  if (!strstr(error.text, phrase)) fail_msg("'%s' does not hold '%s'", error.text, phrase);
}

static void assert_taken(const laves_options *options) {
  laves_error error = {.text = ""};
  if (laves__options_check(options, &error) != LAVES_OK) fail_msg("%s", error.text);
}

/* The value is refused, and so is NAN; `good` is taken. */
#define ASSERT_RANGE(field, bad, good)         \
  do {                                         \
    laves_options o = laves_options_default(); \
    o.field = (bad);                           \
    assert_refused(&o, #field);                \
    o.field = (good);                          \
    assert_taken(&o);                          \
  } while (0)

static void ranges_are_checked(void **state) {
  (void)state;
  ASSERT_RANGE(size, -1, 1e-300);
  ASSERT_RANGE(size, INFINITY, 1e300);
  ASSERT_RANGE(size, NAN, 1);
  ASSERT_RANGE(relative_size, 0.51, 0.5);
  ASSERT_RANGE(relative_size, 1e-7, 1e-6);
  ASSERT_RANGE(relative_size, -0.1, 0.1);
  ASSERT_RANGE(relative_size, NAN, 0.1);
  ASSERT_RANGE(tet_target, -1, 1);
  ASSERT_RANGE(tet_target, INT64_C(100000000001), INT64_C(100000000000));
  ASSERT_RANGE(vertex_target, -1, 1);
  ASSERT_RANGE(vertex_target, INT64_C(2147483648), INT64_C(2147483647));
  ASSERT_RANGE(min_dihedral, -0.1, 0);
  ASSERT_RANGE(min_dihedral, 60.1, 60);
  ASSERT_RANGE(min_dihedral, NAN, 30);
  ASSERT_RANGE(max_dihedral, 79.9, 80);
  ASSERT_RANGE(max_dihedral, 180.1, 180);
  ASSERT_RANGE(max_dihedral, NAN, 130);
  ASSERT_RANGE(volume_length, -0.1, 0);
  ASSERT_RANGE(volume_length, 0.81, 0.8);
  ASSERT_RANGE(volume_length, NAN, 0.5);
  ASSERT_RANGE(align, (laves_align)3, LAVES_ALIGN_PCA);
}

static void one_size_only(void **state) {
  (void)state;
  laves_options o = laves_options_default();
  assert_taken(&o);
  o.size = 1;
  o.tet_target = 100;
  assert_refused(&o, "give one");
  o.vertex_target = 100;
  assert_refused(&o, "3 of");
}

static void foreign_options_are_refused(void **state) {
  (void)state;
  laves_options o = laves_options_default();
  o.cookie = 0;
  assert_refused(&o, "laves_options_default");
}

static void rotations_are_checked(void **state) {
  (void)state;
  laves_options o = laves_options_default();
  o.align = LAVES_ALIGN_ROTATION;
  assert_taken(&o);
  o.rotation[0] = 1.001;
  assert_refused(&o, "rotation");
  const double mirror[9] = {1, 0, 0, 0, 1, 0, 0, 0, -1};
  memcpy(o.rotation, mirror, sizeof mirror);
  assert_refused(&o, "mirrors");
  o.rotation[4] = NAN;
  assert_refused(&o, "rotation");
  o.align = LAVES_ALIGN_NONE; /* not used, not checked */
  assert_taken(&o);
}

static void sizes_come_from_the_options(void **state) {
  (void)state;
  const laves__oracle oracle = {.bounds = {v3(0, 0, 0), v3(3, 4, 12)}, .area = NAN};
  laves_options o = laves_options_default();
  o.size = 0.25;
  assert_close(laves__options_size(&o, &oracle, 5), 0.25, 0);
  o.size = 0;
  o.relative_size = 0.1;
  assert_close(laves__options_size(&o, &oracle, 5), 1.3, 1e-12);
  o.relative_size = 0;
  const double by_default = laves__options_size(&o, &oracle, 5);
  o.tet_target = 50000;
  assert_close(laves__options_size(&o, &oracle, 5), by_default, 0);
  assert_close(50000 * pow(by_default, 3), 8.5815 * 5, 0.01);
  o.tet_target *= 8;
  assert_close(laves__options_size(&o, &oracle, 5), by_default / 2, 1e-9);
}

static void counts_are_corrected_until_near(void **state) {
  (void)state;
  laves_options o = laves_options_default();
  assert_close(laves__options_correction(&o, 10, 10), 1, 0);
  o.tet_target = 1000;
  assert_close(laves__options_correction(&o, 1010, 0), 1, 0);
  assert_close(laves__options_correction(&o, 8000, 0), 2, 1e-12);
  assert_true(laves__options_correction(&o, 950, 0) < 1);
  o.tet_target = 0;
  o.vertex_target = 1000;
  assert_close(laves__options_correction(&o, 1, 995), 1, 0);
  assert_close(laves__options_correction(&o, 1, 125), 0.5, 1e-12);
  assert_close(laves__options_correction(&o, 0, 0), 1, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(ranges_are_checked),          cmocka_unit_test(one_size_only),
      cmocka_unit_test(foreign_options_are_refused), cmocka_unit_test(rotations_are_checked),
      cmocka_unit_test(sizes_come_from_the_options), cmocka_unit_test(counts_are_corrected_until_near),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
