/* Expected counts against those of the meshes that are made. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "laves/laves.h"

typedef struct made {
  laves_context *context;
  laves_domain *domain;
  laves_sizing *sizing;
  laves_options options;
} made;

static made of_expression(const char *text) {
  made m = {.context = laves_context_create(NULL), .options = laves_options_default()};
  assert_int_equal(laves_domain_from_expression(m.context, text, &m.domain, NULL), LAVES_OK);
  assert_int_equal(laves_sizing_create(m.context, &m.sizing, NULL), LAVES_OK);
  m.options.sizing = m.sizing;
  m.options.improve = false;
  return m;
}

static void drop(made *m) {
  laves_sizing_free(m->sizing);
  laves_domain_free(m->domain);
  assert_int_equal(laves_context_bytes(m->context), 0);
  laves_context_free(m->context);
}

/* The expectation is within `slack` of the mesh, as a share. */
static void expect_near(made *m, double slack) {
  laves_expectation expected;
  laves_error error;
  laves_mesh *mesh;
  if (laves_estimate(m->context, m->domain, &m->options, &expected, &error) != LAVES_OK) fail_msg("%s", error.text);
  assert_int_equal(laves_generate(m->context, m->domain, &m->options, &mesh, NULL, &error), LAVES_OK);
  const double share = expected.tets / (double)laves_mesh_tet_count(mesh);
  if (!(fabs(share - 1) <= slack)) fail_msg("%g of the tets that are made were expected", share);
  laves_mesh_free(mesh);
}

static void uniform(void **state) {
  (void)state;
  made m = of_expression("torus(1, 0.4)");
  m.options.size = 0.08;
  expect_near(&m, 0.05);
  drop(&m);
}

/* Of surfaces, as many as the mesh is made with; others are not searched. */
static void creases_of_surfaces(void **state) {
  (void)state;
  static const double points[] = {0, 0, 0, 3, 0, 0, 0, 3, 0, 0, 0, 3};
  static const uint32_t faces[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  made m = of_expression("box(1, 1, 1)");
  laves_expectation expected;
  laves_report report;
  laves_mesh *mesh;
  m.options.size = 0.3;
  assert_int_equal(laves_estimate(m.context, m.domain, &m.options, &expected, NULL), LAVES_OK);
  assert_int_equal(expected.creases, 0);
  laves_domain_free(m.domain);
  assert_int_equal(laves_domain_from_triangles(m.context, points, 4, faces, 4, NULL, &m.domain, NULL), LAVES_OK);
  assert_int_equal(laves_estimate(m.context, m.domain, &m.options, &expected, NULL), LAVES_OK);
  assert_int_equal(expected.creases, 6);
  assert_int_equal(laves_generate(m.context, m.domain, &m.options, &mesh, &report, NULL), LAVES_OK);
  assert_int_equal(expected.creases, report.creases);
  laves_mesh_free(mesh);
  drop(&m);
}

static void growing_inside(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  m.options.size = 0.06;
  m.options.interior_growth = 0.3;
  expect_near(&m, 0.1);
  drop(&m);
}

static void by_expression(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  m.options.size = 0.2;
  assert_int_equal(laves_sizing_add_expression(m.sizing, "0.07 + 0.2*abs(x)", NULL), LAVES_OK);
  expect_near(&m, 0.1);
  drop(&m);
}

static void targets_are_met(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  m.options.tet_target = 30000;
  m.options.interior_growth = 0.3;
  laves_expectation expected;
  assert_int_equal(laves_estimate(m.context, m.domain, &m.options, &expected, NULL), LAVES_OK);
  assert_true(fabs(expected.tets / 30000 - 1) < 0.03);
  drop(&m);
}

/* A count that no size meets is tried for a while, not for ever. */
static void hopeless_counts_come_to_an_end(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  laves_mesh *mesh;
  m.options.tet_target = 30;
  m.options.interior_growth = 0.3;
  assert_int_equal(laves_generate(m.context, m.domain, &m.options, &mesh, NULL, NULL), LAVES_TARGET_MISSED);
  laves_mesh_free(mesh);
  drop(&m);
}

static void sizes_without_measure(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  laves_expectation expected;
  laves_error error;
  m.options.size = 0.1;
  m.options.interior_growth = 0.3;
  m.options.max_size = 1e300;
  assert_int_equal(laves_estimate(m.context, m.domain, &m.options, &expected, NULL), LAVES_OK);
  m.options.min_size = 1e-300;
  m.options.curvature_elements = 1000;
  assert_int_equal(laves_estimate(m.context, m.domain, &m.options, &expected, &error), LAVES_ERROR_OPTION);
  assert_non_null(strstr(error.text, "sizes from 1e-300 on are too small"));
  drop(&m);
}

static void mistakes_are_told(void **state) {
  (void)state;
  made m = of_expression("sphere(1)");
  laves_expectation expected;
  laves_error error;
  m.options.grading = 7;
  assert_int_equal(laves_estimate(m.context, m.domain, &m.options, &expected, &error), LAVES_ERROR_OPTION);
  assert_non_null(strstr(error.text, "grading is 7"));
  m.options.grading = 0.3;
  assert_int_equal(laves_sizing_add_tag(m.sizing, "lid", 0.1, 0, NULL), LAVES_OK);
  assert_int_equal(laves_estimate(m.context, m.domain, &m.options, &expected, &error), LAVES_ERROR_INPUT);
  drop(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(uniform),
      cmocka_unit_test(creases_of_surfaces),
      cmocka_unit_test(growing_inside),
      cmocka_unit_test(by_expression),
      cmocka_unit_test(targets_are_met),
      cmocka_unit_test(mistakes_are_told),
      cmocka_unit_test(hopeless_counts_come_to_an_end),
      cmocka_unit_test(sizes_without_measure),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
