/* Noise: white, checkerboards and fractal, at the scale of the lattice. Every mesh is valid and inside the promised window, by
 * whatever way it is made. LAVES_SEEDS sets how many solids are tried. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/stages.h"

enum { SEEDS = 36 };

typedef enum noise_kind { WHITE, CHECKERBOARD, FRACTAL, NOISE_KINDS } noise_kind;

typedef struct noise {
  noise_kind kind;
  uint64_t seed;
  double scale; /* of checkerboards and of the first octave */
} noise;

static uint64_t mix(uint64_t x) {
  x ^= x >> 33;
  x *= 0xff51afd7ed558ccd;
  x ^= x >> 33;
  x *= 0xc4ceb9fe1a85ec53;
  return x ^ x >> 33;
}

static double unit_of(uint64_t x) { return (double)(mix(x) >> 11) / 4503599627370496.0 - 1; }

static double white(const noise *n, const double p[3]) {
  uint64_t bits[3];
  memcpy(bits, p, sizeof bits);
  return unit_of(n->seed + mix(bits[0] + mix(bits[1] + mix(bits[2]))));
}

static double at_corner(const noise *n, int64_t i, int64_t j, int64_t k) {
  return unit_of(n->seed + mix((uint64_t)i + mix((uint64_t)j + mix((uint64_t)k))));
}

static double octave(const noise *n, const double p[3], double scale) {
  double base[3], t[3], sum = 0;
  for (int a = 0; a < 3; a++) {
    base[a] = floor(p[a] * scale);
    t[a] = p[a] * scale - base[a];
  }
  for (int c = 0; c < 8; c++) {
    const double weight = (c & 1 ? t[0] : 1 - t[0]) * (c & 2 ? t[1] : 1 - t[1]) * (c & 4 ? t[2] : 1 - t[2]);
    sum += weight * at_corner(n, (int64_t)base[0] + (c & 1), (int64_t)base[1] + (c >> 1 & 1), (int64_t)base[2] + (c >> 2));
  }
  return sum;
}

static double fractal(const noise *n, const double p[3]) {
  double sum = 0, weight = 1, scale = n->scale;
  for (int o = 0; o < 4; o++, weight *= 0.6, scale *= 2) sum += weight * octave(n, p, scale);
  return sum;
}

static double checkerboard(const noise *n, const double p[3]) {
  const double shift = unit_of(n->seed);
  double sum = 0;
  for (int a = 0; a < 3; a++) sum += floor(p[a] * n->scale + shift * (a + 1));
  return fmod(fabs(sum), 2) > 0.5 ? 0.1 : -0.1;
}

static void evaluate(void *user, const double *points, size_t count, double *values) {
  const noise *n = user;
  for (size_t i = 0; i < count; i++) {
    const double *p = points + 3 * i;
    const bool outside = fmax(fabs(p[0]), fmax(fabs(p[1]), fabs(p[2]))) > 0.9;
    values[i] = outside ? 1 : n->kind == WHITE ? white(n, p) : n->kind == CHECKERBOARD ? checkerboard(n, p) : fractal(n, p);
  }
}

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
  noise n = {.kind = (noise_kind)(seed % NOISE_KINDS), .seed = (uint64_t)seed * 7919, .scale = 1 + seed % 7};
  const laves_function function = {.evaluate = evaluate, .user = &n, .lower = {-1, -1, -1}, .upper = {1, 1, 1}};
  const laves_options options = options_of_seed(seed);
  laves_domain *domain;
  laves_mesh *mesh;
  laves_report report;
  laves_error error = {.text = ""};
  char name[40];
  snprintf(name, sizeof name, "noise %d, kind %d", seed, (int)n.kind);
  assert_int_equal(laves_domain_from_function(context, &function, &domain, NULL), LAVES_OK);
  const laves_result result = laves_generate(context, domain, &options, &mesh, &report, &error);
  if (result == LAVES_ERROR_INPUT && strstr(error.text, "nothing of the solid is resolved")) {
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
  const int seeds = text ? atoi(text) : SEEDS;
  laves_context *context = laves_context_create(NULL);
  int meshes = 0;
  for (int seed = 0; seed < seeds; seed++) meshes += mesh_noise(context, seed);
  print_message("%d meshes of %d solids, all valid and inside their windows\n", meshes, seeds);
  assert_true(meshes >= seeds - 1 - seeds / 50);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_mesh_is_inside_the_window)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
