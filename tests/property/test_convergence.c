/* On smooth solids volume and distance errors fall with the square of the size.  The rates are printed. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/stages.h"

typedef struct errors {
  double volume, to_surface, from_surface;
} errors;

static errors errors_of(laves_context *context, const char *expression, double volume, double size) {
  laves_domain *domain;
  laves_mesh *mesh;
  laves_error error;
  laves_check check;
  const laves_options options = options_of_size(size);
  assert_int_equal(laves_domain_from_expression(context, expression, &domain, &error), LAVES_OK);
  assert_int_equal(laves_generate(context, domain, &options, &mesh, NULL, &error), LAVES_OK);
  assert_int_equal(laves_check_mesh(context, mesh, domain, &check, &error), LAVES_OK);
  assert_true(check.valid && check.has_distance);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  return (errors){fabs(check.volume / volume - 1), check.to_surface_mean, check.from_surface_mean};
}

static double rate(double coarse, double fine, double ratio) { return log(coarse / fine) / log(ratio); }

static void converges(const char *expression, double volume, double coarse, double fine) {
  laves_context *context = laves_context_create(NULL);
  const errors a = errors_of(context, expression, volume, coarse), b = errors_of(context, expression, volume, fine);
  const double by = coarse / fine;
  const double rates[3] = {rate(a.volume, b.volume, by), rate(a.to_surface, b.to_surface, by),
                           rate(a.from_surface, b.from_surface, by)};
  print_message("%s, size %g to %g: orders: volume %.2f, to the surface %.2f, from the surface %.2f\n", expression, coarse, fine,
                rates[0], rates[1], rates[2]);
  for (int i = 0; i < 3; i++) assert_true(rates[i] > 1.7 && rates[i] < 2.6);
  laves_context_free(context);
}

static void sphere(void **state) {
  (void)state;
  converges("sphere(1)", 4 * M_PI / 3, 0.2, 0.05);
}

static void torus(void **state) {
  (void)state;
  converges("torus(1, 0.4)", 2 * M_PI * M_PI * 0.16, 0.14, 0.035);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sphere),
      cmocka_unit_test(torus),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
