/* Solids that no mesh of the size resolves, with sizes that vary: whatever the oracle says, what comes out is valid, or
 * nothing does. LAVES_SEEDS sets how many are tried. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/noise.h"
#include "fixtures/stages.h"
#include "fixtures/stride.h"

enum { SEEDS = 10 };

/* Fields as steep, as rough and as narrow as may be. */
static const char *const fields[] = {
    "0.08 + 0.3*abs(x)",       "0.1 + 0.08*sin(40*x)*sin(40*y)", "0.07 + 0.5*d", "0.3*max(0.3, 1 - 10*abs(x + y + z))",
    "0.1 + 0.2*abs(sin(9*x))",
};

static void ask(const laves_options *base, int seed, laves_sizing *sizing, laves_options *options) {
  *options = *base;
  options->grading = (double[]){0.1, 0.3, 1}[seed % 3];
  options->improve = seed % 4 != 0;
  options->sizing = sizing;
  assert_int_equal(laves_sizing_add_expression(sizing, fields[seed % (int)LAVES__COUNT_OF(fields)], NULL), LAVES_OK);
  if (seed % 5 == 1) options->curvature_elements = 12;
  if (seed % 5 == 2) options->thickness_elements = 2;
  if (seed % 5 == 3) options->interior_growth = 0.5;
  options->min_size = options->size / 4;
}

/* True when there is a mesh; else there was a reason. */
static bool mesh_noise(laves_context *context, int seed) {
  noise n = {.kind = (noise_kind)(seed % NOISE_BALL), .seed = (uint64_t)seed * 104729, .scale = 1 + seed % 7};
  const laves_function function = noise_function(&n);
  const laves_options base = options_of_size(0.3);
  laves_options options;
  laves_domain *domain;
  laves_sizing *sizing;
  laves_mesh *mesh;
  laves_error error = {.text = ""};
  char name[40];
  snprintf(name, sizeof name, "noise %d, kind %d", seed, (int)n.kind);
  assert_int_equal(laves_domain_from_function(context, &function, &domain, NULL), LAVES_OK);
  assert_int_equal(laves_sizing_create(context, &sizing, NULL), LAVES_OK);
  ask(&base, seed, sizing, &options);
  const laves_result result = laves_generate(context, domain, &options, &mesh, NULL, &error);
  const bool made = result == LAVES_OK || result == LAVES_TARGET_MISSED;
  if (!made && result != LAVES_ERROR_INPUT) fail_msg("%s: %s: %s", name, laves_result_name(result), error.text);
  if (made) check_valid(context, mesh, name);
  if (!made) assert_true(strlen(error.text) > 0);
  laves_mesh_free(mesh);
  laves_sizing_free(sizing);
  laves_domain_free(domain);
  return made;
}

static void every_mesh_is_valid(void **state) {
  (void)state;
  const char *text = getenv("LAVES_SEEDS");
  const int seeds = text ? atoi(text) : 1 + (SEEDS - 1) / test_stride();
  laves_context *context = laves_context_create(NULL);
  int meshes = 0;
  for (int seed = 0; seed < seeds; seed++) meshes += mesh_noise(context, seed);
  assert_true(2 * meshes > seeds);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_mesh_is_valid)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
