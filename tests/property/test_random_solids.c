/* Random implicit solids: every mesh is valid and has about the volume of the solid.  Seeds are printed when one fails. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/random_expression.h"
#include "fixtures/stages.h"
#include "fixtures/stride.h"

enum { TEXT_MAX = 4000 };

static double between(uint64_t *seed, double low, double high) { return low + (high - low) * random_unit(seed); }

/* A random primitive, turned and moved. */
static int add_primitive(char *text, size_t room, uint64_t *seed) {
  char solid[200];
  const double a = between(seed, 0.3, 0.9), b = between(seed, 0.3, 0.9), c = between(seed, 0.3, 0.9);
  switch ((int)(random_unit(seed) * 8)) {
    case 0:
      snprintf(solid, sizeof solid, "sphere(%.3f)", a);
      break;
    case 1:
      snprintf(solid, sizeof solid, "box(%.3f, %.3f, %.3f)", 2 * a, 2 * b, 2 * c);
      break;
    case 2:
      snprintf(solid, sizeof solid, "cylinder{r=%.3f, h=%.3f}", a / 2, 2 * b);
      break;
    case 3:
      snprintf(solid, sizeof solid, "torus(%.3f, %.3f)", a, a * (0.2 + b / 2));
      break;
    case 4:
      snprintf(solid, sizeof solid, "ellipsoid(%.3f, %.3f, %.3f)", a, b, c);
      break;
    case 5:
      snprintf(solid, sizeof solid, "capsule{r=%.3f, h=%.3f}", a / 2, 2 * b);
      break;
    case 6:
      snprintf(solid, sizeof solid, "cone{r=%.3f, h=%.3f}", a, 2 * b);
      break;
    default:
      snprintf(solid, sizeof solid, "(gyroid{period=%.3f, thickness=%.3f} & sphere(%.3f))", 0.8 + a, 0.3, a);
      break;
  }
  return snprintf(text, room, "%s:rotate(%.1f, 'x'):rotate(%.1f, 'z'):move(%.3f, %.3f, %.3f)", solid, between(seed, 0, 360),
                  between(seed, 0, 360), between(seed, -0.7, 0.7), between(seed, -0.7, 0.7), between(seed, -0.7, 0.7));
}

static int add_solid(char *text, size_t room, uint64_t *seed, int depth) {
  if (depth == 0 || random_unit(seed) < 0.15) return add_primitive(text, room, seed);
  static const char *const open[] = {"(", "(", "(", "smooth_union(", "smooth_difference("};
  static const char *const middle[] = {" | ", " - ", " & ", ", ", ", "};
  const int kind = (int)(random_unit(seed) * 5);
  int used = snprintf(text, room, "%s", open[kind]);
  used += add_solid(text + used, room - (size_t)used, seed, depth - 1);
  used += snprintf(text + used, room - (size_t)used, "%s", middle[kind]);
  used += add_solid(text + used, room - (size_t)used, seed, depth - 1);
  if (kind >= 3) used += snprintf(text + used, room - (size_t)used, ", %.2f", between(seed, 0.05, 0.4));
  return used + snprintf(text + used, room - (size_t)used, ")");
}

/* Meshes the solid; true when there was one to mesh. */
static bool mesh_solid(laves_context *context, const char *text, uint64_t seed, int64_t tets, double volume_tolerance) {
  char name[TEXT_MAX + 50];
  snprintf(name, sizeof name, "seed %llu: %s", (unsigned long long)seed, text);
  laves_domain *domain;
  laves_error error = {.text = ""};
  laves_result result = laves_domain_from_expression(context, text, &domain, &error);
  if (result == LAVES_ERROR_INPUT) return false; /* nothing inside, or no bounds */
  if (result != LAVES_OK) fail_msg("%s: %s", name, error.text);
  const laves_options options = options_of_tets(tets);
  laves_mesh *mesh;
  laves_report report;
  result = laves_generate(context, domain, &options, &mesh, &report, &error);
  laves_domain_free(domain);
  if (getenv("LAVES_VERBOSE"))
    print_message("%.60s %s %zu tets, %zu pinches, %zu off\n", name, laves_result_name(result), mesh ? mesh->tet_count : 0,
                  report.pinches, report.off_surface);
  if (result == LAVES_ERROR_INPUT) return false;
  if (result != LAVES_OK && result != LAVES_TARGET_MISSED) fail_msg("%s: %s: %s", name, laves_result_name(result), error.text);
  const laves_check check = check_valid(context, mesh, name);
  /* What is thinner than the size is lost, so solids with such places are allowed to lose volume. */
  const double share = check.volume / report.volume;
  if (report.pinches == 0 && fabs(share - 1) > volume_tolerance) fail_msg("%s: %g of the volume", name, share);
  laves_mesh_free(mesh);
  assert_int_equal(laves_context_bytes(context), 0);
  return true;
}

static void combined_primitives(void **state) {
  (void)state;
  enum { RUNS = 14 };
  laves_context *context = laves_context_create(NULL);
  int meshed = 0, tried = 0;
  for (uint64_t run = 1; run <= RUNS; run += (uint64_t)test_stride(), tried++) {
    char text[TEXT_MAX];
    uint64_t seed = run;
    add_solid(text, sizeof text, &seed, 1 + (int)(run % 3));
    meshed += mesh_solid(context, text, run, run % 6 ? 4000 : 20000, 0.12);
  }
  assert_true(2 * meshed > tried || (test_stride() > 1 && meshed > 0));
  laves_context_free(context);
}

/* Random polynomials and waves within a ball: nothing like a distance. */
static void random_formulas(void **state) {
  (void)state;
  enum { RUNS = 12 };
  laves_context *context = laves_context_create(NULL);
  int meshed = 0, tried = 0;
  for (uint64_t run = 101; run <= 100 + RUNS; run += (uint64_t)test_stride(), tried++) {
    char text[TEXT_MAX];
    uint64_t seed = run;
    const double a = between(&seed, -2, 2), b = between(&seed, -2, 2), c = between(&seed, -2, 2), d = between(&seed, 1, 5),
                 e = between(&seed, 1, 5), f = between(&seed, -0.3, 0.3);
    static const char *const forms[] = {
        "(%.3f*x*x + %.3f*y*z + %.3f*z^3 + 0.2*sin(%.3f*x)*cos(%.3f*y) + %.3f) & sphere(1)",
        "(x^4 + y^4 + z^4 + %.3f*x*y*z + %.3f*x*x + %.3f*y + 0*%.3f*%.3f + 4*%.3f - 0.5) & sphere(1.5)",
        "(%.3f*sin(3*x + y) + %.3f*cos(4*y - z) + %.3f*sin(3*z*x) + 0*%.3f*%.3f + %.3f) & box(2, 1.8, 1.6)",
        "(abs(%.3f*x) + %.3f*y*y + %.3f*z + max(x*%.3f, y*z*%.3f) + %.3f) & sphere(1)",
    };
    snprintf(text, sizeof text, forms[run % 4], a, b, c, d, e, f);
    meshed += mesh_solid(context, text, run, 4000, 0.12);
  }
  assert_true(2 * meshed > tried || (test_stride() > 1 && meshed > 0));
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(combined_primitives),
      cmocka_unit_test(random_formulas),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
