/* Sizes that the surface asks for, where the answers are known: spheres, cylinders, plates, gaps, creases. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/assert_close.h"
#include "fixtures/shapes.h"
#include "size/size.h"

static const double two_pi = 6.283185307179586;

typedef struct made {
  laves_context *context;
  laves_domain *domain;
  laves__size_sample *samples;
  size_t count;
} made;

static made of_expression(const char *text) {
  made m = {.context = laves_context_create(NULL)};
  laves_error error;
  if (laves_domain_from_expression(m.context, text, &m.domain, &error) != LAVES_OK) fail_msg("%s: %s", text, error.text);
  return m;
}

static made of_shape(shape s) {
  made m = {.context = laves_context_create(NULL)};
  laves_error error;
  if (laves_domain_from_triangles(m.context, s.points, s.point_count, s.triangles, s.triangle_count, NULL, &m.domain, &error) !=
      LAVES_OK)
    fail_msg("%s", error.text);
  shape_free(&s);
  return m;
}

static void drop(made *m) {
  laves__free(m->context, m->samples, m->count, sizeof *m->samples);
  laves_domain_free(m->domain);
  assert_int_equal(laves_context_bytes(m->context), 0);
  laves_context_free(m->context);
}

static void ask(made *m, const laves_options *options, double base) {
  laves__size *size;
  laves_error error;
  if (laves__size_create(m->context, m->domain, options, base, &size, &error) != LAVES_OK) fail_msg("%s", error.text);
  assert_false(laves__size_is_constant(size));
  assert_int_equal(laves__size_samples(size, &m->samples, &m->count, &error), LAVES_OK);
  laves__size_free(size);
}

/* All samples lie between the sizes, and there are enough of them to cover an area at 0.7 sizes. */
static void expect_all(const made *m, double low, double high, double area) {
  for (size_t i = 0; i < m->count; i++) {
    assert_true(m->samples[i].size >= low);
    assert_true(m->samples[i].size <= high);
  }
  assert_true((double)m->count * high * high > area);
}

/* The least size of the samples within `range` of a place; INFINITY: none. */
static double least_near(const made *m, double x, double y, double z, double range) {
  double least = INFINITY;
  for (size_t i = 0; i < m->count; i++)
    if (v3_distance(m->samples[i].point, v3(x, y, z)) < range) least = fmin(least, m->samples[i].size);
  return least;
}

/* ---- curvature ---- */

static void curvature_of_spheres(void **state) {
  (void)state;
  laves_options options = laves_options_default();
  options.curvature_elements = 24;
  const double wanted = two_pi * 0.5 / 24;
  made m = of_expression("sphere(0.5)");
  ask(&m, &options, 0.4);
  expect_all(&m, 0.98 * wanted, 1.02 * wanted, 3.14159);
  drop(&m);
  m = of_expression("x*x + y*y + z*z - 0.25"); /* phi is no distance */
  ask(&m, &options, 0.4);
  expect_all(&m, 0.98 * wanted, 1.02 * wanted, 3.14159);
  drop(&m);
  m = of_shape(shape_sphere(0.5, 12));
  ask(&m, &options, 0.4);
  expect_all(&m, 0.93 * wanted, 1.07 * wanted, 3.14159);
  drop(&m);
}

static void curvature_of_cylinders(void **state) {
  (void)state;
  laves_options options = laves_options_default();
  options.curvature_elements = 20;
  shape cylinder = shape_cylinder(1, 3, 32); /* facets as a program for construction draws them: long triangles from cap to cap */
  shape_move(&cylinder, 0, 0, 1.5);
  made m = of_shape(cylinder);
  ask(&m, &options, 0.8);
  expect_all(&m, 0.93 * two_pi / 20, 1.07 * two_pi / 20, 6 * 3.14159);
  assert_true(isinf(least_near(&m, 0, 0, 3, 0.9))); /* the caps are flat */
  drop(&m);
  m = of_expression("cylinder{r=1, h=3}");
  ask(&m, &options, 0.8);
  assert_close(least_near(&m, 1, 0, 0, 0.4), two_pi / 20, 0.02 * two_pi / 20);
  assert_true(isinf(least_near(&m, 0, 0, 1.5, 0.8)));
  drop(&m);
}

static void curvature_of_boxes_is_none(void **state) {
  (void)state;
  laves_options options = laves_options_default();
  options.curvature_elements = 20;
  options.max_distance = 1e-3;
  made m = of_shape(shape_box((double[3]){0, 0, 0}, (double[3]){1, 2, 3}, 4));
  ask(&m, &options, 0.3);
  assert_int_equal(m.count, 0);
  drop(&m);
  m = of_expression("box(1, 2, 3)");
  options.min_size = 0.05;
  ask(&m, &options, 0.3);
  assert_int_equal(m.count, 0);
  drop(&m);
}

/* A sphere that stands a little out of a box: the edge there turns by 34 degrees, and is no bend. */
static void blunt_edges_are_no_bends(void **state) {
  (void)state;
  laves_options options = laves_options_default();
  options.curvature_elements = 12;
  made m = of_expression("box(1, 1, 1) | sphere(0.6)");
  ask(&m, &options, 0.1);
  assert_int_equal(m.count, 0);
  drop(&m);
}

static void distance_by_curvature(void **state) {
  (void)state;
  laves_options options = laves_options_default();
  options.max_distance = 0.001;
  made m = of_expression("sphere(2)");
  ask(&m, &options, 0.5);
  const double wanted = sqrt(6 * 0.001 * 2);
  expect_all(&m, 0.98 * wanted, 1.02 * wanted, 50.2);
  drop(&m);
}

static void floor_holds(void **state) {
  (void)state;
  laves_options options = laves_options_default();
  options.curvature_elements = 100;
  options.min_size = 0.2;
  made m = of_expression("sphere(1)");
  ask(&m, &options, 0.5);
  expect_all(&m, 0.2, 0.2, 12.5);
  drop(&m);
}

/* ---- thickness ---- */

static void thickness_of_plates(void **state) {
  (void)state;
  laves_options options = laves_options_default();
  options.thickness_elements = 2;
  made m = of_shape(shape_box((double[3]){0, 0, 0}, (double[3]){2, 2, 0.1}, 2));
  ask(&m, &options, 0.3);
  expect_all(&m, 0.05 * (1 - 1e-9), 0.05 * (1 + 1e-9), 8);
  drop(&m);
  m = of_expression("box(2, 2, 0.1)");
  ask(&m, &options, 0.3);
  expect_all(&m, 0.05 * (1 - 1e-6), 0.05 * (1 + 1e-6), 8);
  drop(&m);
  m = of_expression("max(x^4 + y^4 - 1, 100*z*z - 0.25)"); /* phi is no distance; 0.1 thick */
  ask(&m, &options, 0.3);
  assert_close(least_near(&m, 0, 0, 0, 0.2), 0.05, 1e-6);
  drop(&m);
}

static void thickness_of_gaps(void **state) {
  (void)state;
  laves_options options = laves_options_default();
  options.thickness_elements = 1;
  shape s = shape_box((double[3]){0, 0, 0}, (double[3]){1, 1, 1}, 2);
  shape other = shape_box((double[3]){1.05, 0, 0}, (double[3]){2.05, 1, 1}, 2);
  shape_append(&s, &other);
  shape_free(&other);
  made m = of_shape(s);
  ask(&m, &options, 0.3);
  expect_all(&m, 0.05 * (1 - 1e-9), 0.05 * (1 + 1e-9), 2);
  assert_true(isinf(least_near(&m, 0, 0.5, 0.5, 0.5)));
  drop(&m);
  m = of_expression("box(1, 1, 1) | box(1, 1, 1):move(1.05, 0, 0)");
  ask(&m, &options, 0.3);
  assert_close(least_near(&m, 0.5, 0, 0, 0.3), 0.05, 1e-6);
  drop(&m);
}

/* Walls that lie within the solid bound nothing: a thin box in a thick one, and one that stands out of it. */
static void hidden_walls_do_not_count(void **state) {
  (void)state;
  laves_options options = laves_options_default();
  options.thickness_elements = 2;
  shape s = shape_box((double[3]){0, 0, 0}, (double[3]){1, 1, 1}, 1);
  shape thin = shape_box((double[3]){-0.5, 0.3, 0.45}, (double[3]){0.5, 0.7, 0.5}, 1);
  shape_append(&s, &thin);
  shape_free(&thin);
  made m = of_shape(s);
  ask(&m, &options, 0.15);
  expect_all(&m, 0.025 * (1 - 1e-9), 0.025 * (1 + 1e-9), 0);
  assert_close(least_near(&m, -0.25, 0.5, 0.5, 0.2), 0.025, 1e-9);
  assert_true(isinf(least_near(&m, 0.3, 0.5, 0.5, 0.25))); /* within the thick one */
  drop(&m);
}

/* A wedge at a right angle is no wall: nothing is asked for near the edges of a cube. */
static void thickness_leaves_edges_alone(void **state) {
  (void)state;
  laves_options options = laves_options_default();
  options.thickness_elements = 2;
  made m = of_shape(shape_box((double[3]){0, 0, 0}, (double[3]){1, 1, 1}, 3));
  ask(&m, &options, 0.3);
  assert_int_equal(m.count, 0);
  drop(&m);
}

/* ---- features ---- */

static void features_of_boxes(void **state) {
  (void)state;
  laves_options options = laves_options_default();
  options.feature_elements = 3;
  made m = of_shape(shape_box((double[3]){0, 0, 0}, (double[3]){2, 2, 0.3}, 4));
  ask(&m, &options, 0.4);
  assert_close(least_near(&m, 1, 0, 0, 0.2), 0.1, 1e-12); /* the edge above */
  assert_true(isinf(least_near(&m, 1, 1, 0.3, 0.5)));     /* no crease there */
  double least = INFINITY;
  for (size_t i = 0; i < m.count; i++) least = fmin(least, m.samples[i].size);
  assert_close(least, 0.1, 1e-12); /* not less where edges meet at corners */
  drop(&m);
}

static void features_of_the_ell(void **state) {
  (void)state;
  laves_options options = laves_options_default();
  options.feature_elements = 2;
  made m = of_shape(shape_ell());
  ask(&m, &options, 0.9);
  double least = INFINITY;
  for (size_t i = 0; i < m.count; i++) least = fmin(least, m.samples[i].size);
  assert_close(least, 0.5, 1e-12); /* all edges are 1 apart, two elements between them */
  drop(&m);
  m = of_expression("box(1, 1, 1)");
  ask(&m, &options, 0.3);
  assert_int_equal(m.count, 0); /* creases are known of surfaces only */
  drop(&m);
}

/* ---- all ---- */

static void threads_do_not_matter(void **state) {
  (void)state;
  laves_options options = laves_options_default();
  options.curvature_elements = 16;
  options.thickness_elements = 2;
  made two[2];
  for (int i = 0; i < 2; i++) {
    laves_context_options threads = laves_context_options_default();
    threads.thread_count = i ? 4 : 1;
    two[i] = (made){.context = laves_context_create(&threads)};
    assert_int_equal(laves_domain_from_expression(two[i].context, "torus(1, 0.2)", &two[i].domain, NULL), LAVES_OK);
    ask(&two[i], &options, 0.3);
  }
  assert_int_equal(two[0].count, two[1].count);
  assert_memory_equal(two[0].samples, two[1].samples, two[0].count * sizeof *two[0].samples);
  for (int i = 0; i < 2; i++) drop(&two[i]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(curvature_of_spheres),
      cmocka_unit_test(curvature_of_cylinders),
      cmocka_unit_test(curvature_of_boxes_is_none),
      cmocka_unit_test(distance_by_curvature),
      cmocka_unit_test(floor_holds),
      cmocka_unit_test(thickness_of_plates),
      cmocka_unit_test(thickness_of_gaps),
      cmocka_unit_test(thickness_leaves_edges_alone),
      cmocka_unit_test(features_of_boxes),
      cmocka_unit_test(features_of_the_ell),
      cmocka_unit_test(threads_do_not_matter),
      cmocka_unit_test(blunt_edges_are_no_bends),
      cmocka_unit_test(hidden_walls_do_not_count),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
