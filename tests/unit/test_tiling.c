/* The tiling of a box: whole cells, exact shapes, sizes that are refused. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#include "background/c15_table.h"
#include "laves/laves.h"

static void assert_near(double value, double expected, double slack) {
  if (!(fabs(value - expected) <= slack)) fail_msg("%.17g is not %.17g within %g", value, expected, slack);
}

static int make_context(void **state) {
  *state = laves_context_create(NULL);
  return *state ? 0 : -1;
}

static int free_context(void **state) {
  const size_t held = laves_context_bytes(*state);
  laves_context_free(*state);
  return held == 0 ? 0 : -1;
}

static void test_counts_and_shapes(void **state) {
  const int cells[3] = {3, 2, 1};
  laves_mesh *mesh;
  laves_check check;
  assert_int_equal(laves_generate_tiling(*state, cells, 0.5, &mesh, NULL), LAVES_OK);
  assert_int_equal(laves_mesh_tet_count(mesh), 6 * LAVES__C15_TETS);
  assert_int_equal(laves_mesh_lattice_tet_count(mesh), 6 * LAVES__C15_TETS);
  assert_int_equal(laves_check_mesh(*state, mesh, NULL, &check, NULL), LAVES_OK);
  assert_int_equal(check.inverted_tets, 0);
  assert_int_equal(check.nonconforming_faces, 0);
  assert_int_equal(check.unused_vertices, 0);
  assert_int_equal(check.components, 1);
  const double side = 0.5 * LAVES__C15_PERIOD / LAVES__C15_MEAN_EDGE;
  assert_near(check.volume, 6 * pow(side, 3), 1e-12);
  assert_near(check.min_dihedral.min, 60, 1e-9);
  assert_near(check.max_dihedral.max, 74.2068, 1e-4);
  assert_near(check.radius_ratio.mean, 0.9790, 5e-5);
  assert_near(check.edge_max, 0.5 * LAVES__C15_LONGEST_EDGE, 1e-12);
  laves_mesh_free(mesh);
}

/* The statistics are those of the infinite tiling, however many cells there are. */
static void test_statistics_do_not_depend_on_cells(void **state) {
  const int one[3] = {1, 1, 1}, many[3] = {4, 3, 5};
  laves_mesh *mesh;
  laves_check small, large;
  assert_int_equal(laves_generate_tiling(*state, one, 1, &mesh, NULL), LAVES_OK);
  assert_int_equal(laves_check_mesh(*state, mesh, NULL, &small, NULL), LAVES_OK);
  laves_mesh_free(mesh);
  assert_int_equal(laves_generate_tiling(*state, many, 1, &mesh, NULL), LAVES_OK);
  assert_int_equal(laves_check_mesh(*state, mesh, NULL, &large, NULL), LAVES_OK);
  laves_mesh_free(mesh);
  assert_near(small.min_dihedral.mean, large.min_dihedral.mean, 1e-9);
  assert_near(small.max_dihedral.deviation, large.max_dihedral.deviation, 1e-9);
  assert_near(small.radius_edge.mean, large.radius_edge.mean, 1e-9);
}

static void refuse(laves_context *context, const int cells[3], double size) {
  laves_mesh *mesh = (laves_mesh *)&size; /* must be overwritten */
  laves_error error = {LAVES_OK, ""};
  assert_int_equal(laves_generate_tiling(context, cells, size, &mesh, &error), LAVES_ERROR_OPTION);
  assert_null(mesh);
  assert_true(strlen(error.text) > 0);
}

static void test_refusals(void **state) {
  refuse(*state, (const int[3]){0, 1, 1}, 1);
  refuse(*state, (const int[3]){1, 1, -5}, 1);
  refuse(*state, (const int[3]){1, 1, 1}, 0);
  refuse(*state, (const int[3]){1, 1, 1}, NAN);
  refuse(*state, (const int[3]){1, 1, 1}, INFINITY);
  refuse(*state, (const int[3]){2000, 2000, 2000}, 1);
}

static void test_memory_limit(void **state) {
  (void)state;
  laves_context_options options = laves_context_options_default();
  options.memory_limit = 20000;
  laves_context *context = laves_context_create(&options);
  const int cells[3] = {3, 3, 3};
  laves_mesh *mesh;
  laves_error error;
  assert_int_equal(laves_generate_tiling(context, cells, 1, &mesh, &error), LAVES_ERROR_MEMORY);
  assert_null(mesh);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_counts_and_shapes),
      cmocka_unit_test(test_statistics_do_not_depend_on_cells),
      cmocka_unit_test(test_refusals),
      cmocka_unit_test(test_memory_limit),
  };
  return cmocka_run_group_tests(tests, make_context, free_context);
}
