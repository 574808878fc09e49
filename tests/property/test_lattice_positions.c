/* Exactly degenerate input: faces in planes of the lattice, its vertices exactly on the surface. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "background/c15_table.h"
#include "fixtures/shapes.h"
#include "fixtures/stages.h"
#include "fixtures/stride.h"

/* Makes quarter units of the tiling whole numbers of the input. */
static const double whole = LAVES__C15_MEAN_EDGE;

static void mesh_shape(const shape *s, double size, const char *name) {
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain;
  laves_mesh *mesh;
  laves_error error;
  if (laves_domain_from_triangles(context, s->points, s->point_count, s->triangles, s->triangle_count, NULL, &domain, &error) !=
      LAVES_OK)
    fail_msg("%s: %s", name, error.text);
  const laves_options options = options_of_size(size);
  const laves_result result = laves_generate(context, domain, &options, &mesh, NULL, &error);
  if (result != LAVES_OK) fail_msg("%s: %s", name, error.text);
  check_valid(context, mesh, name);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

/* Boxes of 2 n quarter units: their faces hold whole planes of lattice vertices for some n. */
static void boxes_on_lattice_planes(void **state) {
  (void)state;
  for (int n = 5; n <= 24; n += test_stride()) {
    char name[100];
    const double w = n;
    snprintf(name, sizeof name, "box of %d quarter units", 2 * n);
    shape box = shape_box((const double[3]){-w, -w, -w}, (const double[3]){w, w, w}, 1);
    mesh_shape(&box, whole, name);
    shape_free(&box);
    laves_context *context = laves_context_create(NULL);
    char text[100];
    snprintf(text, sizeof text, "box(%d, %d, %d)", 2 * n, 2 * n + 2, 16);
    const laves_options options = options_of_size(whole);
    laves_mesh *mesh = mesh_of_expression(context, text, &options, NULL);
    check_valid(context, mesh, text);
    laves_mesh_free(mesh);
    laves_context_free(context);
  }
}

/* Two boxes on lattice planes whose faces lie upon each other in part or in whole: side by side, through, within, twice the same.
 */
static void boxes_upon_each_other(void **state) {
  (void)state;
  static const double second[][6] = {{8, -8, -8, 24, 8, 8},  {0, -8, -8, 16, 8, 8}, {-4, -4, -8, 4, 4, 8}, {-8, -8, -8, 8, 8, 8},
                                     {8, -4, -4, 16, 4, 4},  {-4, -4, 8, 4, 4, 16}, {8, 8, -8, 24, 24, 8}, {8, 8, 8, 24, 24, 24},
                                     {-8, -8, -2, 8, 8, -2}, {-8, -8, 0, 0, 0, 8}};
  for (size_t i = 0; i<LAVES__COUNT_OF(second); i += test_stride()> 1 ? 2 : 1)
    for (int turned = 0; turned < 2; turned++) {
      char name[100];
      if (turned && memcmp(second[i], (const double[6]){-8, -8, -8, 8, 8, 8}, sizeof second[i]) == 0)
        continue; /* nothing is left */
      snprintf(name, sizeof name, "boxes %zu%s", i, turned ? ", one inside out" : "");
      shape box = shape_box((const double[3]){-8, -8, -8}, (const double[3]){8, 8, 8}, 1);
      shape more = shape_box(second[i], second[i] + 3, 1);
      if (turned) shape_turn_over(&more);
      shape_append(&box, &more);
      mesh_shape(&box, whole, name);
      shape_free(&box);
      shape_free(&more);
    }
}

/* Steps and slits whose planes all pass through lattice vertices; slits of no width. */
static void coplanar_parts(void **state) {
  (void)state;
  static const char *const solids[] = {
      "box(16) - box(8)",
      "box(16) - box(8, 8, 16)",
      "box(16) - box(0.5, 16, 16)",
      "box(16):move(8, 0, 0) | box(16):move(-8, 0, 0)",
      "box(16):move(8, 8, 8) | box(16):move(-8, -8, -8)",
      "box(16):move(8, 8, 0) | box(16):move(-8, -8, 0)",
      "box(16) - halfspace{normal='z'}",
      "abs(x) + abs(y) + abs(z) - 12",
      "max(abs(x), max(abs(y), abs(z))) - 8",
      "box(16, 16, 2)",
      "box(16, 16, 1)",
  };
  laves_context *context = laves_context_create(NULL);
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i += (size_t)test_stride()) {
    laves_domain *domain;
    laves_mesh *mesh;
    laves_error error = {.text = ""};
    const laves_options options = options_of_size(whole);
    if (laves_domain_from_expression(context, solids[i], &domain, &error) != LAVES_OK) fail_msg("%s: %s", solids[i], error.text);
    const laves_result result = laves_generate(context, domain, &options, &mesh, NULL, &error);
    if (result == LAVES_OK)
      check_valid(context, mesh, solids[i]);
    else
      assert_int_equal(result, LAVES_ERROR_INPUT);
    laves_mesh_free(mesh);
    laves_domain_free(domain);
  }
  laves_context_free(context);
}

/* phi exactly zero at many sites. */
static void grid_function(void *user, const double *points, size_t count, double *values) {
  const double step = *(const double *)user;
  for (size_t i = 0; i < count; i++) {
    const double *p = points + 3 * i, r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    values[i] = floor((r - 14) / step) * step;
  }
}

static void plateaus_of_zero(void **state) {
  (void)state;
  static double steps[] = {0.5, 2, 5};
  for (size_t i = 0; i < LAVES__COUNT_OF(steps); i++) {
    const laves_function function = {
        .evaluate = grid_function, .user = &steps[i], .lower = {-20, -20, -20}, .upper = {20, 20, 20}};
    laves_context *context = laves_context_create(NULL);
    laves_domain *domain;
    laves_mesh *mesh;
    const laves_options options = options_of_size(whole);
    assert_int_equal(laves_domain_from_function(context, &function, &domain, NULL), LAVES_OK);
    assert_int_equal(laves_generate(context, domain, &options, &mesh, NULL, NULL), LAVES_OK);
    check_valid(context, mesh, "plateaus");
    laves_mesh_free(mesh);
    laves_domain_free(domain);
    laves_context_free(context);
  }
}

/* Spheres through whole shells of lattice vertices. */
static void spheres_through_vertices(void **state) {
  (void)state;
  for (int square = 100; square <= 160; square += 4 * test_stride()) {
    char text[100];
    laves_context *context = laves_context_create(NULL);
    snprintf(text, sizeof text, "x*x + y*y + z*z - %d", square);
    const laves_options options = options_of_size(whole);
    laves_mesh *mesh = mesh_of_expression(context, text, &options, NULL);
    check_valid(context, mesh, text);
    laves_mesh_free(mesh);
    laves_context_free(context);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes_on_lattice_planes), cmocka_unit_test(boxes_upon_each_other),    cmocka_unit_test(coplanar_parts),
      cmocka_unit_test(plateaus_of_zero),        cmocka_unit_test(spheres_through_vertices),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
