/* Volumes by sampling against exact ones, and principal axes. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#include "domain/frame.h"
#include "fixtures/assert_close.h"
#include "fixtures/hard_solids.h"

static laves_domain *make(laves_context *context, const char *expression) {
  laves_domain *domain;
  laves_error error;
  if (laves_domain_from_expression(context, expression, &domain, &error) != LAVES_OK) fail_msg("%s: %s", expression, error.text);
  return domain;
}

static void sampled_volumes_are_near_exact_ones(void **state) {
  (void)state;
  static const struct {
    const char *expression;
    double volume;
  } solids[] = {
      {"sphere(1)", 4 * M_PI / 3},
      {"torus(1, 0.3)", 2 * M_PI * M_PI * 0.09},
      {"x*x + y*y + z*z - 1", 4 * M_PI / 3},
      {"box(1, 2, 3):rotate{angle=30, axis={1, 1, 1}}", 6},
      {"ellipsoid(3, 1, 1)", 4 * M_PI},
      {"sphere(1) - sphere(0.5)", 4 * M_PI / 3 * 0.875},
      {"sphere(1e-5):move(1000, 0, 0)", 4e-15 * M_PI / 3},
      {"sphere(1) | sphere(1):move(3, 0, 0)", 8 * M_PI / 3},
  };
  laves_context *context = laves_context_create(NULL);
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++) {
    laves_domain *domain = make(context, solids[i].expression);
    laves__oracle oracle = domain->oracle;
    oracle.volume = NAN; /* so that it must be sampled */
    const double relative = laves__domain_volume(context, &oracle) / solids[i].volume - 1;
    if (!(fabs(relative) < 0.003)) fail_msg("%s: volume off by %g", solids[i].expression, relative);
    laves_domain_free(domain);
  }
  laves_context_free(context);
}

static void known_volumes_are_taken(void **state) {
  (void)state;
  const laves__oracle oracle = {.volume = 42};
  assert_close(laves__domain_volume(NULL, &oracle), 42, 0);
}

static void callbacks_without_a_bound_are_sampled_as_well(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  int seen = 0;
  for (int i = 0; i < hard_solid_count; i++) {
    const bool ball = strcmp(hard_solids[i].name, "huge values") == 0, nothing = strcmp(hard_solids[i].name, "all outside") == 0;
    if (!ball && !nothing) continue;
    const laves_function function = hard_function(&hard_solids[i]);
    laves_domain *domain;
    assert_int_equal(laves_domain_from_function(context, &function, &domain, NULL), LAVES_OK);
    const double exact = ball ? 4 * M_PI / 3 * 0.512 : 0;
    assert_close(laves__domain_volume(context, &domain->oracle), exact, 0.003 * exact);
    laves_domain_free(domain);
    seen++;
  }
  assert_int_equal(seen, 2);
  laves_context_free(context);
}

/* Columns of the matrix: the long axis first, to a degree. */
static void axes_of_an_ellipsoid_are_found(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain = make(context, "ellipsoid(3, 2, 1):rotate(30, 'z'):move(100, 0, 0)");
  const laves__mat3 m = laves__principal_axes(&domain->oracle);
  const laves__vec3 x = v3(m.row[0].x, m.row[1].x, m.row[2].x), y = v3(m.row[0].y, m.row[1].y, m.row[2].y),
                    z = v3(m.row[0].z, m.row[1].z, m.row[2].z);
  assert_true(fabs(v3_dot(x, v3(sqrt(0.75), 0.5, 0))) > cos(M_PI / 180));
  assert_true(fabs(v3_dot(y, v3(-0.5, sqrt(0.75), 0))) > cos(M_PI / 180));
  assert_close(v3_dot(x, v3_cross(y, z)), 1, 1e-12);
  for (int i = 0; i < 3; i++) assert_close(v3_norm(m.row[i]), 1, 1e-12);
  laves_domain_free(domain);
  laves_context_free(context);
}

static void nothing_has_no_axes(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain = make(context, "sphere(1) & sphere(1):move(1.9999999, 0, 0)");
  const laves__mat3 m = laves__principal_axes(&domain->oracle);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) assert_true(isfinite(v3_at(m.row[i], j)));
  laves_domain_free(domain);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sampled_volumes_are_near_exact_ones),
      cmocka_unit_test(known_volumes_are_taken),
      cmocka_unit_test(callbacks_without_a_bound_are_sampled_as_well),
      cmocka_unit_test(axes_of_an_ellipsoid_are_found),
      cmocka_unit_test(nothing_has_no_axes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
