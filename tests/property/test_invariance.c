/* Moving, scaling or turning a solid moves, scales or turns its mesh and changes nothing else. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/random_expression.h"
#include "fixtures/shapes.h"
#include "fixtures/stages.h"

/* points = scale * original + shift, to within `tolerance` sizes of the original. */
static void assert_image(const laves_mesh *original, const laves_mesh *image, double scale, laves__vec3 shift, double tolerance,
                         const char *name) {
  if (!same_connectivity(original, image)) fail_msg("%s: the connectivity differs", name);
  double worst = 0;
  for (size_t v = 0; v < original->vertex_count; v++)
    worst = fmax(worst, v3_distance(v3_mad(shift, original->points[v], scale), image->points[v]) / scale);
  if (worst > tolerance) fail_msg("%s: points are off by %g", name, worst);
}

/* Without symmetry and creases, which would leave it to rounding which of two sites is nearer to the surface, or which of two
 * feet to a site. */
static const char *const solids[] = {"smooth_union(sphere(1), sphere(0.6):move(0.9, 0.37, 0.21), 0.3)",
                                     "torus(1, 0.4):rotate(20, 'x'):rotate(33, 'y')",
                                     "x*x + y*y + 2*z*z + 0.3*x*y*z - 0.2*x - 1 & sphere(9)"};
static const double size = 0.15;

static void scaling_by_powers_of_two_changes_no_bit(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++) {
    laves_options options = options_of_size(size);
    laves_mesh *original = mesh_of_expression(context, solids[i], &options, NULL);
    static const int exponents[] = {-40, -3, 1, 20};
    for (size_t e = 0; e < LAVES__COUNT_OF(exponents); e++) {
      char text[200];
      const double scale = ldexp(1, exponents[e]);
      snprintf(text, sizeof text, "scale(%s, %.17g)", solids[i], scale);
      options.size = size * scale;
      laves_mesh *image = mesh_of_expression(context, text, &options, NULL);
      assert_image(original, image, scale, v3(0, 0, 0), 0, text);
      laves_mesh_free(image);
    }
    laves_mesh_free(original);
  }
  laves_context_free(context);
}

static void small_and_large_solids_are_meshed_alike(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++) {
    laves_options options = options_of_size(size);
    options.improve = false; /* what rounding does grows in thousands of steps of improvement */
    laves_mesh *original = mesh_of_expression(context, solids[i], &options, NULL);
    static const double scales[] = {1e-7, 0.3, 1e6};
    for (size_t s = 0; s < LAVES__COUNT_OF(scales); s++) {
      char text[200];
      snprintf(text, sizeof text, "scale(%s, %.17g)", solids[i], scales[s]);
      options.size = size * scales[s];
      laves_mesh *image = mesh_of_expression(context, text, &options, NULL);
      assert_image(original, image, scales[s], v3(0, 0, 0), 1e-9, text);
      laves_mesh_free(image);
    }
    laves_mesh_free(original);
  }
  laves_context_free(context);
}

static void moved_solids_are_meshed_alike(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++) {
    laves_options options = options_of_size(size);
    options.improve = false;
    laves_mesh *original = mesh_of_expression(context, solids[i], &options, NULL);
    static const double shifts[][3] = {{0.123, -0.456, 0.789}, {1000, -2000, 333.3}, {0, 0, 1e6}};
    for (size_t s = 0; s < LAVES__COUNT_OF(shifts); s++) {
      char text[200];
      const double *d = shifts[s];
      snprintf(text, sizeof text, "(%s):move(%.17g, %.17g, %.17g)", solids[i], d[0], d[1], d[2]);
      laves_mesh *image = mesh_of_expression(context, text, &options, NULL);
      assert_image(original, image, 1, v3(d[0], d[1], d[2]), 1e-9 * (1 + fabs(d[0]) + fabs(d[2])), text);
      laves_mesh_free(image);
    }
    laves_mesh_free(original);
  }
  laves_context_free(context);
}

static laves_mesh *mesh_of_shape(laves_context *context, const shape *s, const laves_options *options) {
  laves_domain *domain;
  laves_mesh *mesh = NULL;
  laves_error error;
  if (laves_domain_from_triangles(context, s->points, s->point_count, s->triangles, s->triangle_count, NULL, &domain, &error) !=
          LAVES_OK ||
      laves_generate(context, domain, options, &mesh, NULL, &error) != LAVES_OK)
    fail_msg("%s", error.text);
  laves_domain_free(domain);
  return mesh;
}

static void surfaces_are_meshed_alike_anywhere(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  shape torus = shape_torus(1, 0.4, 48, 24);
  laves_options options = options_of_size(size);
  laves_mesh *original = mesh_of_shape(context, &torus, &options);
  shape_scale(&torus, ldexp(1, -30));
  options.size = ldexp(size, -30);
  laves_mesh *image = mesh_of_shape(context, &torus, &options);
  assert_image(original, image, ldexp(1, -30), v3(0, 0, 0), 0, "scaled torus");
  laves_mesh_free(image);
  shape_scale(&torus, ldexp(1, 30));
  shape_move(&torus, 1000, 0, -500);
  options.size = size;
  options.improve = false;
  laves_mesh_free(original);
  image = mesh_of_shape(context, &torus, &options);
  shape_move(&torus, -1000, 0, 500);
  original = mesh_of_shape(context, &torus, &options);
  assert_image(original, image, 1, v3(1000, 0, -500), 1e-9, "moved torus");
  laves_mesh_free(image);
  laves_mesh_free(original);
  shape_free(&torus);
  laves_context_free(context);
}

static const double turn_cos = 0.8, turn_sin = 0.6; /* round z */

static laves__vec3 turned(laves__vec3 p) { return v3(turn_cos * p.x - turn_sin * p.y, turn_sin * p.x + turn_cos * p.y, p.z); }

/* A ball with bumps; `user`: whether it is turned. */
static void bumps(void *user, const double *points, size_t count, double *values) {
  for (size_t i = 0; i < count; i++) {
    laves__vec3 p = v3(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
    if (*(const bool *)user) p = v3(turn_cos * p.x + turn_sin * p.y, -turn_sin * p.x + turn_cos * p.y, p.z);
    values[i] = v3_norm(p) - 1 + 0.1 * sin(3 * p.x + 1) * cos(2 * p.y - 1.3 * p.z);
  }
}

static laves_mesh *mesh_of_bumps(laves_context *context, bool turn, const laves_options *options) {
  const laves_function function = {
      .evaluate = bumps, .user = &turn, .lower = {-1.6, -1.6, -1.6}, .upper = {1.6, 1.6, 1.6}, .lipschitz = 1.5};
  laves_domain *domain;
  laves_mesh *mesh;
  assert_int_equal(laves_domain_from_function(context, &function, &domain, NULL), LAVES_OK);
  assert_int_equal(laves_generate(context, domain, options, &mesh, NULL, NULL), LAVES_OK);
  laves_domain_free(domain);
  return mesh;
}

/* The solid and the lattice turned together give the mesh turned. */
static void turning_solid_and_lattice_turns_the_mesh(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_options options = options_of_size(size);
  options.improve = false;
  laves_mesh *original = mesh_of_bumps(context, false, &options);
  const double rotation[9] = {turn_cos, -turn_sin, 0, turn_sin, turn_cos, 0, 0, 0, 1};
  options.align = LAVES_ALIGN_ROTATION;
  memcpy(options.rotation, rotation, sizeof rotation);
  laves_mesh *image = mesh_of_bumps(context, true, &options);
  assert_int_equal(original->tet_count, image->tet_count);
  assert_int_equal(original->vertex_count, image->vertex_count);
  /* The box that the lattice covers is another, so the order may differ: vertices are matched by their places. */
  double volume[2] = {0, 0}, sum[2] = {0, 0};
  for (int m = 0; m < 2; m++) {
    const laves_mesh *mesh = m ? image : original;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
      const laves__vec3 p = m ? mesh->points[v] : turned(mesh->points[v]);
      sum[m] += p.x * p.x * p.y + p.z * p.y + p.x;
    }
    for (size_t t = 0; t < mesh->tet_count; t++) {
      const int32_t *c = mesh->tets[t];
      volume[m] += v3_det(mesh->points[c[0]], mesh->points[c[1]], mesh->points[c[2]], mesh->points[c[3]]);
    }
  }
  assert_true(fabs(volume[0] - volume[1]) < 1e-7);
  assert_true(fabs(sum[0] - sum[1]) < 1e-6);
  laves_mesh_free(image);
  laves_mesh_free(original);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(scaling_by_powers_of_two_changes_no_bit),
      cmocka_unit_test(small_and_large_solids_are_meshed_alike),
      cmocka_unit_test(moved_solids_are_meshed_alike),
      cmocka_unit_test(surfaces_are_meshed_alike_anywhere),
      cmocka_unit_test(turning_solid_and_lattice_turns_the_mesh),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
