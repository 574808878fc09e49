/* Meshes of second order: their volume converges two orders faster than that of straight tetrahedra, no Jacobian is ever
 * negative, whatever the solid, and threads change nothing. The integrals and Jacobians here are by the shape functions, at
 * points. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/noise.h"
#include "fixtures/stages.h"
#include "fixtures/stride.h"

static const int ends[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

static double jacobian_at(const laves_mesh *mesh, size_t tet, const double l[4]) {
  const int32_t *nodes = laves_mesh_tet_nodes(mesh) + 10 * tet;
  const laves__vec3 *points = (const laves__vec3 *)(const void *)laves_mesh_node_points(mesh);
  laves__vec3 d[4];
  for (int i = 0; i < 4; i++) d[i] = v3_scale(points[nodes[i]], 4 * l[i] - 1);
  for (int m = 0; m < 6; m++) {
    d[ends[m][0]] = v3_mad(d[ends[m][0]], points[nodes[4 + m]], 4 * l[ends[m][1]]);
    d[ends[m][1]] = v3_mad(d[ends[m][1]], points[nodes[4 + m]], 4 * l[ends[m][0]]);
  }
  return v3_dot(v3_sub(d[1], d[0]), v3_cross(v3_sub(d[2], d[0]), v3_sub(d[3], d[0])));
}

/* A rule of eight points that is exact for cubic polynomials, as the Jacobian is: Keast's, of corners and faces' middles. */
static double curved_volume(const laves_mesh *mesh) {
  double volume = 0;
  for (size_t t = 0; t < laves_mesh_tet_count(mesh); t++)
    for (int i = 0; i < 4; i++) {
      double corner[4] = {0}, face[4];
      corner[i] = 1;
      for (int k = 0; k < 4; k++) face[k] = k == i ? 0 : 1.0 / 3;
      volume += (jacobian_at(mesh, t, corner) / 40 + jacobian_at(mesh, t, face) * 9 / 40) / 6;
    }
  return volume;
}

static double least_jacobian(const laves_mesh *mesh) {
  double least = INFINITY;
  enum { STEPS = 4 };
  for (size_t t = 0; t < laves_mesh_tet_count(mesh); t++)
    for (int i = 0; i <= STEPS; i++)
      for (int j = 0; i + j <= STEPS; j++)
        for (int k = 0; i + j + k <= STEPS; k++) {
          const double l[4] = {(STEPS - i - j - k) / (double)STEPS, i / (double)STEPS, j / (double)STEPS, k / (double)STEPS};
          const laves__vec3 *p = (const laves__vec3 *)(const void *)laves_mesh_points(mesh);
          const int32_t *c = laves_mesh_tets(mesh) + 4 * t;
          least = fmin(least, jacobian_at(mesh, t, l) / v3_det(p[c[0]], p[c[1]], p[c[2]], p[c[3]]));
        }
  return least;
}

typedef struct errors {
  double straight, curved;
} errors;

static errors errors_of(laves_context *context, const char *expression, double volume, double size) {
  laves_domain *domain;
  laves_mesh *mesh;
  laves_check check;
  laves_curve_report report;
  const laves_options options = options_of_size(size);
  assert_int_equal(laves_domain_from_expression(context, expression, &domain, NULL), LAVES_OK);
  assert_int_equal(laves_generate(context, domain, &options, &mesh, NULL, NULL), LAVES_OK);
  assert_int_equal(laves_mesh_curve(context, mesh, domain, NULL, &report, NULL), LAVES_OK);
  assert_int_equal(laves_check_mesh(context, mesh, NULL, &check, NULL), LAVES_OK);
  assert_true(report.has_distance && report.curved_mean < 0.2 * report.straight_mean);
  assert_int_equal(report.on_surface, report.boundary_edges);
  assert_true(report.least_jacobian <= least_jacobian(mesh) + 1e-12);
  const errors found = {fabs(check.volume / volume - 1), fabs(curved_volume(mesh) / volume - 1)};
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  return found;
}

static void converges(const char *expression, double volume, double coarse, double fine) {
  laves_context *context = laves_context_create(NULL);
  const errors a = errors_of(context, expression, volume, coarse), b = errors_of(context, expression, volume, fine);
  const double by = log(coarse / fine), straight = log(a.straight / b.straight) / by, curved = log(a.curved / b.curved) / by;
  print_message("%s, size %g to %g: volume off by %.2g to %.2g, order %.2f; of second order %.2g to %.2g, order %.2f\n",
                expression, coarse, fine, a.straight, b.straight, straight, a.curved, b.curved, curved);
  assert_true(straight > 1.7 && straight < 2.6);
  assert_true(curved > 3.5);
  assert_true(b.curved < b.straight / 100);
  laves_context_free(context);
}

static void the_volume_of_a_sphere(void **state) {
  (void)state;
  converges("sphere(1)", 4 * M_PI / 3, 0.3, 0.1);
}

static void the_volume_of_a_torus(void **state) {
  (void)state;
  converges("torus(1, 0.4)", 2 * M_PI * M_PI * 0.16, 0.2, 0.08);
}

/* Between creases: circles and straight edges, of walls that are bent and flat. */
static void the_volume_of_a_cylinder(void **state) {
  (void)state;
  converges("cylinder{r = 1, h = 2}", 2 * M_PI, 0.3, 0.1);
}

/* A box stays exactly as it is. */
static void flat_walls_stay_flat(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  const char *expression = "box(1, 1.2, 1.4)";
  const laves_options options = options_of_size(0.3);
  laves_domain *domain;
  laves_mesh *mesh = mesh_of_expression(context, expression, &options, NULL);
  laves_curve_report report;
  assert_int_equal(laves_domain_from_expression(context, expression, &domain, NULL), LAVES_OK);
  assert_int_equal(laves_mesh_curve(context, mesh, domain, NULL, &report, NULL), LAVES_OK);
  assert_true(report.least_jacobian > 1 - 1e-6 && report.on_crease > 20);
  assert_true(fabs(curved_volume(mesh) - 1.68) < 1e-9);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  laves_context_free(context);
}

/* ---- noise ---- */

static laves_mesh *curved_noise(laves_context *context, noise *n, laves_curve_report *report) {
  const laves_function function = noise_function(n);
  const laves_options options = options_of_size(0.2);
  laves_domain *domain;
  laves_mesh *mesh = NULL;
  assert_int_equal(laves_domain_from_function(context, &function, &domain, NULL), LAVES_OK);
  const laves_result made = laves_generate(context, domain, &options, &mesh, NULL, NULL);
  if (made == LAVES_OK || made == LAVES_TARGET_MISSED)
    assert_int_equal(laves_mesh_curve(context, mesh, domain, NULL, report, NULL), LAVES_OK);
  laves_domain_free(domain);
  return mesh;
}

static laves_context *with_threads(int threads) {
  laves_context_options options = laves_context_options_default();
  options.thread_count = threads;
  return laves_context_create(&options);
}

static void no_jacobian_is_negative_and_threads_change_nothing(void **state) {
  (void)state;
  int meshes = 0;
  size_t back = 0;
  for (int seed = 0; seed < 6; seed += test_stride()) {
    laves_context *contexts[2] = {with_threads(1), with_threads(3)};
    laves_mesh *found[2];
    laves_curve_report reports[2] = {{0}};
    for (int i = 0; i < 2; i++) {
      noise n = {.kind = (noise_kind)(seed % NOISE_KINDS), .seed = (uint64_t)seed * 7919, .scale = 1 + seed % 3};
      found[i] = curved_noise(contexts[i], &n, &reports[i]);
    }
    assert_int_equal(found[0] != NULL, found[1] != NULL);
    if (found[0]) {
      assert_true(reports[0].least_jacobian >= 0.2 && least_jacobian(found[0]) >= 0.2);
      assert_int_equal(reports[0].on_surface + reports[0].moved_back + reports[0].straightened + reports[0].unreached,
                       reports[0].boundary_edges);
      assert_int_equal(reports[0].moved_back, reports[1].moved_back);
      assert_int_equal(reports[0].straightened, reports[1].straightened);
      assert_int_equal(reports[0].least_tet, reports[1].least_tet);
      assert_true(reports[0].least_jacobian == reports[1].least_jacobian && reports[0].curved_mean == reports[1].curved_mean &&
                  reports[0].straight_max == reports[1].straight_max);
      assert_int_equal(laves_mesh_node_count(found[0]), laves_mesh_node_count(found[1]));
      assert_memory_equal(laves_mesh_node_points(found[0]), laves_mesh_node_points(found[1]),
                          laves_mesh_node_count(found[0]) * 3 * sizeof(double));
      back += reports[0].moved_back + reports[0].straightened;
      meshes++;
    }
    for (int i = 0; i < 2; i++) {
      laves_mesh_free(found[i]);
      assert_int_equal(laves_context_bytes(contexts[i]), 0);
      laves_context_free(contexts[i]);
    }
  }
  print_message("%d meshes, %zu nodes moved back\n", meshes, back);
  assert_true(meshes > 0 && (back > 0 || test_stride() > 1));
}

static bool never(void *user, const char *phase, double fraction) {
  (void)user;
  (void)fraction;
  return strcmp(phase, "curve") != 0;
}

static void a_cancel_leaves_the_mesh_as_it_was(void **state) {
  (void)state;
  laves_context_options about = laves_context_options_default();
  about.progress = never;
  laves_context *context = laves_context_create(&about);
  const laves_options options = options_of_size(0.1);
  laves_mesh *mesh = mesh_of_expression(context, "sphere(1)", &options, NULL);
  const size_t bytes = laves_context_bytes(context);
  laves_error error;
  assert_int_equal(laves_mesh_curve(context, mesh, NULL, NULL, NULL, &error), LAVES_ERROR_CANCELLED);
  assert_int_equal(error.result, LAVES_ERROR_CANCELLED);
  assert_int_equal(laves_mesh_order(mesh), 1);
  assert_int_equal(laves_context_bytes(context), bytes);
  laves_mesh_free(mesh);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_volume_of_a_sphere),
      cmocka_unit_test(the_volume_of_a_torus),
      cmocka_unit_test(the_volume_of_a_cylinder),
      cmocka_unit_test(flat_walls_stay_flat),
      cmocka_unit_test(no_jacobian_is_negative_and_threads_change_nothing),
      cmocka_unit_test(a_cancel_leaves_the_mesh_as_it_was),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
