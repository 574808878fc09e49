/* Noise: white, checkerboards and fractal, at the scale of the lattice. Every mesh is valid and inside the promised window, by
 * whatever way it is made. LAVES_SEEDS sets how many solids are tried. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/noise.h"
#include "fixtures/stages.h"
#include "fixtures/stride.h"

enum { SEEDS = 36 };

/* Size, way, promise and improvement change from seed to seed. */
static laves_options options_of_seed(int seed) {
  laves_options options = options_of_size(seed % 2 ? 0.2 : 0.25);
  static const double guarantees[] = {14.4, 14.4, 20, 14.4, 28};
  options.guarantee = guarantees[seed / 2 % 5];
  options.method = seed / 3 % 2 ? LAVES_METHOD_STUFF : LAVES_METHOD_AUTO;
  options.improve = seed / 4 % 3 != 0;
  return options;
}

/* True when there is a mesh; else noise that has no site further inside than the thresholds was refused. */
static bool mesh_noise(laves_context *context, int seed) {
  noise n = {.kind = (noise_kind)(seed % NOISE_BALL), .seed = (uint64_t)seed * 7919, .scale = 1 + seed % 7};
  const laves_function function = noise_function(&n);
  const laves_options options = options_of_seed(seed);
  laves_domain *domain;
  laves_mesh *mesh;
  laves_report report;
  laves_error error = {.text = ""};
  char name[40];
  snprintf(name, sizeof name, "noise %d, kind %d", seed, (int)n.kind);
  assert_int_equal(laves_domain_from_function(context, &function, &domain, NULL), LAVES_OK);
  const laves_result result = laves_generate(context, domain, &options, &mesh, &report, &error);
  if (result == LAVES_ERROR_INPUT && (strstr(error.text, "resolved at size") || strstr(error.text, "times the volume"))) {
    laves_domain_free(domain);
    return false;
  }
  if (result != LAVES_OK) fail_msg("%s: %s: %s", name, laves_result_name(result), error.text);
  const laves_check check = check_valid(context, mesh, name);
  if (check.min_dihedral.min < report.promised_min_dihedral || check.max_dihedral.max > report.promised_max_dihedral)
    fail_msg("%s: %.4f to %.4f, promised %g to %g", name, check.min_dihedral.min, check.max_dihedral.max,
             report.promised_min_dihedral, report.promised_max_dihedral);
  assert_true(report.promised_min_dihedral >= options.guarantee);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  return true;
}

static void every_mesh_is_inside_the_window(void **state) {
  (void)state;
  const char *text = getenv("LAVES_SEEDS");
  const int seeds = text ? atoi(text) : SEEDS / test_stride();
  laves_context *context = laves_context_create(NULL);
  int meshes = 0;
  for (int seed = 0; seed < seeds; seed++) meshes += mesh_noise(context, seed);
  print_message("%d meshes of %d solids, all valid and inside their windows\n", meshes, seeds);
  assert_true(meshes >= seeds - 1 - seeds / 20);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

/* Not improved; fails when there is none. Free with laves_mesh_free(). */
static laves_mesh *mesh_of_noise(laves_context *context, noise n, laves_method method, laves_report *report) {
  const laves_function function = noise_function(&n);
  laves_options options = options_of_size(0.2);
  options.method = method;
  options.improve = false;
  laves_domain *domain;
  laves_mesh *mesh;
  assert_int_equal(laves_domain_from_function(context, &function, &domain, NULL), LAVES_OK);
  assert_int_equal(laves_generate(context, domain, &options, &mesh, report, NULL), LAVES_OK);
  laves_domain_free(domain);
  return mesh;
}

/* Where everything is made again by stuffing, the report does not tell of what snapping had made. */
static void reports_tell_of_the_last_boundary(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  const noise n = {.kind = NOISE_FRACTAL, .seed = 5, .scale = 3};
  laves_report chosen, asked;
  laves_mesh_free(mesh_of_noise(context, n, LAVES_METHOD_AUTO, &chosen));
  laves_mesh_free(mesh_of_noise(context, n, LAVES_METHOD_STUFF, &asked));
  assert_true(asked.stuffed_vertices > 0);
  assert_int_equal(chosen.stuffed_vertices, asked.stuffed_vertices);
  assert_int_equal(chosen.snapped_vertices, 0);
  assert_int_equal(chosen.pinches, asked.pinches);
  laves_context_free(context);
}

/* Of white noise half of the sites are inside, but at the scale of an edge nearly everything is near one: most of the solid is
 * filled, since no inner site vanishes. */
static void noise_keeps_its_volume(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  const noise n = {.kind = NOISE_WHITE, .seed = 5, .scale = 1};
  laves_report report;
  laves_mesh *mesh = mesh_of_noise(context, n, LAVES_METHOD_STUFF, &report);
  const laves_check check = check_valid(context, mesh, "white noise");
  assert_true(check.volume > 0.6 * report.volume);
  laves_mesh_free(mesh);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_mesh_is_inside_the_window),
      cmocka_unit_test(noise_keeps_its_volume),
      cmocka_unit_test(reports_tell_of_the_last_boundary),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
