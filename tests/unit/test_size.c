/* Sizes over space: limits, growth inside, expressions with the depth, places, tags, and what is refused. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/assert_close.h"
#include "fixtures/folders.h"
#include "fixtures/shapes.h"
#include "size/size.h"

typedef struct made {
  laves_context *context;
  laves_domain *domain;
  laves_sizing *sizing;
  laves_options options;
  laves__size *size;
  laves_error error;
} made;

static made with_context(void) {
  made m = {.context = laves_context_create(NULL), .options = laves_options_default()};
  assert_int_equal(laves_sizing_create(m.context, &m.sizing, &m.error), LAVES_OK);
  m.options.sizing = m.sizing;
  return m;
}

static made of_expression(const char *text) {
  made m = with_context();
  if (laves_domain_from_expression(m.context, text, &m.domain, &m.error) != LAVES_OK) fail_msg("%s: %s", text, m.error.text);
  return m;
}

static void bind(made *m, double base) {
  if (laves__size_create(m->context, m->domain, &m->options, base, &m->size, &m->error) != LAVES_OK)
    fail_msg("%s", m->error.text);
}

static void expect_refusal(made *m, double base, laves_result result, const char *words) {
  assert_int_equal(laves__size_create(m->context, m->domain, &m->options, base, &m->size, &m->error), result);
  assert_null(m->size);
  if (!strstr(m->error.text, words)) fail_msg("\"%s\" does not say \"%s\"", m->error.text, words);
}

static void drop(made *m) {
  laves__size_free(m->size);
  laves_sizing_free(m->sizing);
  laves_domain_free(m->domain);
  assert_int_equal(laves_context_bytes(m->context), 0);
  laves_context_free(m->context);
}

/* The size at a place in input coordinates. */
static double size_at(const made *m, double x, double y, double z) {
  const laves__vec3 p = v3_sub(v3(x, y, z), m->domain->oracle.origin);
  double size;
  laves__size_evaluate(m->size, 1, &p, &size);
  return size;
}

static void nothing_asked_is_constant(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  bind(&m, 0.1);
  assert_true(laves__size_is_constant(m.size));
  assert_close(laves__size_ceiling(m.size), 0.1, 0);
  assert_close(laves__size_floor(m.size), 0.1 / 64, 0);
  assert_close(size_at(&m, 0.3, 0, 0), 0.1, 0);
  laves__size_sample *samples;
  size_t count;
  assert_int_equal(laves__size_samples(m.size, &samples, &count, &m.error), LAVES_OK);
  assert_null(samples);
  assert_int_equal(count, 0);
  drop(&m);
}

static void a_number_lowers_the_size(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  assert_int_equal(laves_sizing_add_expression(m.sizing, "0.05", &m.error), LAVES_OK);
  assert_int_equal(laves_sizing_add_expression(m.sizing, "0.5", &m.error), LAVES_OK);
  bind(&m, 0.1);
  assert_true(laves__size_is_constant(m.size));
  assert_close(laves__size_ceiling(m.size), 0.05, 0);
  drop(&m);
}

static void expressions_of_place(void **state) {
  (void)state;
  made m = of_expression("sphere(1):move(1000, 0, 0)"); /* an origin of its own */
  assert_int_equal(laves_sizing_add_expression(m.sizing, "0.02 + 0.1*abs(x - 1000)", &m.error), LAVES_OK);
  bind(&m, 0.1);
  assert_false(laves__size_is_constant(m.size));
  assert_close(size_at(&m, 1000.3, 0.5, 0), 0.05, 1e-12);
  assert_close(size_at(&m, 1000.9, 0, 0), 0.1, 1e-12); /* size is the largest */
  assert_close(size_at(&m, 1000, 50, 0), 0.02, 1e-12); /* beyond the box */
  drop(&m);
}

static void expressions_of_depth(void **state) {
  (void)state;
  static const char *const solids[] = {"sphere(1)", "x*x + y*y + z*z - 1"};
  for (int i = 0; i < 2; i++) {
    made m = of_expression(solids[i]);
    assert_int_equal(laves_sizing_add_expression(m.sizing, "0.03 + d/10", &m.error), LAVES_OK);
    bind(&m, 0.2);
    assert_close(size_at(&m, 0, 0.5, 0), 0.08, 0.002);
    assert_close(size_at(&m, 0, 0, 0), 0.13, 0.002);
    assert_close(size_at(&m, 0, 0, 1.5), 0.03, 1e-12); /* outside the depth is zero */
    drop(&m);
  }
}

static void limits_hold(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  m.options.min_size = 0.05;
  assert_int_equal(laves_sizing_add_expression(m.sizing, "0.001 + x*x", &m.error), LAVES_OK);
  bind(&m, 0.1);
  assert_close(size_at(&m, 0, 0, 0), 0.05, 0);
  assert_close(size_at(&m, 1, 0, 0), 0.1, 0);
  drop(&m);
}

static void interior_grows(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  m.options.interior_growth = 0.5;
  m.options.grading = 0.2; /* which is less, and holds */
  m.options.max_size = 0.25;
  bind(&m, 0.1);
  assert_false(laves__size_is_constant(m.size));
  assert_close(size_at(&m, 1.5, 0, 0), 0.1, 0);
  assert_close(size_at(&m, 0.95, 0, 0), 0.1, 0); /* the boundary layer */
  assert_close(size_at(&m, 0.5, 0, 0), 0.1 + 0.2 * (0.5 - 0.075), 1e-9);
  assert_close(size_at(&m, 0, 0, 0), 0.25, 0);
  assert_close(laves__size_ceiling(m.size), 0.25, 0);
  drop(&m);
}

static void places_grow_with_the_grading(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  const double points[] = {1, 0, 0, 0, 0, 1}, curve[] = {-1, -1, 0, -1, 1, 0};
  assert_int_equal(laves_sizing_add_points(m.sizing, points, 2, 0.01, 0.1, &m.error), LAVES_OK);
  assert_int_equal(laves_sizing_add_curve(m.sizing, curve, 2, 0.02, 0, &m.error), LAVES_OK);
  bind(&m, 0.2);
  assert_close(size_at(&m, 1, 0.1, 0), 0.01, 1e-12);
  assert_close(size_at(&m, 0, 0, 0.7), 0.01 + 0.3 * 0.2, 1e-12);
  assert_close(size_at(&m, -0.9, 0.3, 0), 0.02 + 0.3 * 0.1, 1e-12); /* between the curve's points */
  assert_close(size_at(&m, 0, -0.5, -0.5), 0.2, 0);
  drop(&m);
}

static void tags_are_refined(void **state) {
  (void)state;
  made m = with_context();
  shape s = shape_box((double[3]){0, 0, 0}, (double[3]){1, 1, 1}, 1);
  int32_t tags[12];
  for (size_t f = 0; f < 12; f++) { /* 7 where all corners are at z = 0 */
    bool low = true;
    for (int i = 0; i < 3; i++) low &= s.points[3 * s.triangles[3 * f + (size_t)i] + 2] == 0;
    tags[f] = low ? 7 : 1;
  }
  assert_int_equal(laves_domain_from_triangles(m.context, s.points, 8, s.triangles, 12, tags, &m.domain, &m.error), LAVES_OK);
  shape_free(&s);
  assert_int_equal(laves_sizing_add_tag(m.sizing, "7", 0.02, 0.05, &m.error), LAVES_OK);
  bind(&m, 0.5);
  assert_close(size_at(&m, 0.5, 0.5, 0.05), 0.02, 1e-12);
  assert_close(size_at(&m, 0.3, 0.9, 0.55), 0.02 + 0.3 * 0.5, 1e-12);
  laves__size_free(m.size);
  m.size = NULL;
  assert_int_equal(laves_sizing_add_tag(m.sizing, "inlet", 0.02, 0, &m.error), LAVES_OK);
  expect_refusal(&m, 0.5, LAVES_ERROR_INPUT, "no tag 'inlet'");
  drop(&m);
}

static void scripts_are_read(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 20];
  assert_true(fixture_folder_make(folder));
  snprintf(path, sizeof path, "%s/size.lua", folder);
  FILE *file = fopen(path, "w");
  fputs("local fine = 0.01\nreturn min(0.1, fine + 0.2*length(x, y, z - 1))\n", file);
  fclose(file);
  assert_int_equal(laves_sizing_add_script(m.sizing, path, &m.error), LAVES_OK);
  fixture_folder_remove(folder);
  bind(&m, 1);
  assert_close(size_at(&m, 0, 0, 0.9), 0.03, 1e-12);
  assert_close(size_at(&m, 0, 0, 0), 0.1, 1e-12);
  drop(&m);
}

static void scripts_must_yield_sizes(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  assert_int_equal(laves_sizing_add_expression(m.sizing, "sphere(1)", &m.error), LAVES_ERROR_INPUT);
  assert_non_null(strstr(m.error.text, "the script yields a solid; a size must be a number or a field of x, y, z and d"));
  assert_int_equal(laves_sizing_add_expression(m.sizing, "0.1 +", &m.error), LAVES_ERROR_INPUT);
  assert_int_equal(laves_sizing_add_script(m.sizing, "no/such.lua", &m.error), LAVES_ERROR_INPUT);
  assert_int_equal(laves_sizing_add_expression(m.sizing, "-1", &m.error), LAVES_OK);
  expect_refusal(&m, 0.1, LAVES_ERROR_INPUT, "the size is -1, but sizes must be positive");
  drop(&m);
  m = of_expression("sphere(1)");
  assert_int_equal(laves_sizing_add_expression(m.sizing, "0.1*x", &m.error), LAVES_OK);
  expect_refusal(&m, 0.1, LAVES_ERROR_INPUT, ", but sizes must be positive");
  drop(&m);
  m = of_expression("sphere(1)");
  assert_int_equal(laves_sizing_add_expression(m.sizing, "0.1 + log(x)", &m.error), LAVES_OK);
  expect_refusal(&m, 0.1, LAVES_ERROR_INPUT, "but sizes must be positive");
  drop(&m);
}

/* Outside the solid an expression may be anything. */
static void outside_is_not_judged(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  assert_int_equal(laves_sizing_add_expression(m.sizing, "0.02*(3.2 - length(x, y, z)*3)", &m.error), LAVES_OK);
  bind(&m, 0.1);
  assert_close(size_at(&m, 0.99, 0.99, 0.99), 0.1, 0);
  assert_int_equal(laves__size_status(m.size, &m.error), LAVES_OK);
  drop(&m);
}

/* A place that the trial at the start misses is found when it is asked. */
static void late_failures_are_told(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  assert_int_equal(laves_sizing_add_expression(m.sizing, "length(x - 0.3, y - 0.301, z - 0.302) - 0.001", &m.error), LAVES_OK);
  bind(&m, 0.1);
  assert_int_equal(laves__size_status(m.size, &m.error), LAVES_OK);
  assert_close(size_at(&m, 0.3, 0.301, 0.302), 0.1, 0);
  assert_int_equal(laves__size_status(m.size, &m.error), LAVES_ERROR_INPUT);
  assert_non_null(strstr(m.error.text, "(0.3, 0.301, 0.302) is -0.001"));
  drop(&m);
}

static void wrong_arguments_are_refused(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  const double point[3] = {0, NAN, 0}, right[3] = {0, 0, 0};
  assert_int_equal(laves_sizing_add_points(m.sizing, point, 1, 1, 0, &m.error), LAVES_ERROR_OPTION);
  assert_int_equal(laves_sizing_add_points(m.sizing, right, 0, 1, 0, &m.error), LAVES_ERROR_OPTION);
  assert_int_equal(laves_sizing_add_points(m.sizing, right, 1, 0, 0, &m.error), LAVES_ERROR_OPTION);
  assert_int_equal(laves_sizing_add_curve(m.sizing, right, 1, 1, -1, &m.error), LAVES_ERROR_OPTION);
  m.options.min_size = 0.2;
  expect_refusal(&m, 0.1, LAVES_ERROR_OPTION, "min_size is 0.2 but the size is 0.1");
  m.options.min_size = 0;
  m.options.max_size = 0.05;
  expect_refusal(&m, 0.1, LAVES_ERROR_OPTION, "max_size is 0.05 but the size is 0.1");
  assert_int_equal(laves_sizing_add_tag(m.sizing, "lid", 1, 0, &m.error), LAVES_OK);
  expect_refusal(&m, 0.1, LAVES_ERROR_INPUT, "no tag 'lid' to refine near: the input has no named parts");
  drop(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(nothing_asked_is_constant),
      cmocka_unit_test(a_number_lowers_the_size),
      cmocka_unit_test(expressions_of_place),
      cmocka_unit_test(expressions_of_depth),
      cmocka_unit_test(limits_hold),
      cmocka_unit_test(interior_grows),
      cmocka_unit_test(places_grow_with_the_grading),
      cmocka_unit_test(tags_are_refined),
      cmocka_unit_test(scripts_are_read),
      cmocka_unit_test(scripts_must_yield_sizes),
      cmocka_unit_test(outside_is_not_judged),
      cmocka_unit_test(late_failures_are_told),
      cmocka_unit_test(wrong_arguments_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
