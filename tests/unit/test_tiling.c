/* The tiling of a box of cells, and that figures over it are those of one period: table 1 of the paper, exactly. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

#include "background/c15_table.h"
#include "mesh/mesh.h"

static int set_up(void **state) {
  *state = laves_context_create(NULL);
  return *state == NULL;
}

static int tear_down(void **state) {
  const size_t left = laves_context_bytes(*state);
  laves_context_free(*state);
  return left != 0;
}

static laves_check check_of(laves_context *context, int x, int y, int z, double size) {
  laves_mesh *mesh;
  laves_check check;
  assert_int_equal(laves_generate_tiling(context, (const int[3]){x, y, z}, size, &mesh, NULL), LAVES_OK);
  assert_int_equal(laves_mesh_lattice_tet_count(mesh), mesh->tet_count);
  assert_int_equal(laves_check_mesh(context, mesh, NULL, &check, NULL), LAVES_OK);
  laves_mesh_free(mesh);
  return check;
}

static void sound_and_complete(void **state) {
  const laves_check c = check_of(*state, 3, 2, 4, 0.5);
  const double side = LAVES__C15_PERIOD / LAVES__C15_MEAN_EDGE * 0.5;
  assert_int_equal(c.tets, 24 * LAVES__C15_TETS);
  assert_int_equal(c.bad_indices + c.inverted_tets + c.nonconforming_faces, 0);
  assert_int_equal(c.unused_vertices, 0);
  assert_int_equal(c.components, 1);
  assert_float_equal(c.volume, 24 * side * side * side, 1e-9);
  assert_float_equal(c.edge_min, 0.5 * sqrt(8) / LAVES__C15_MEAN_EDGE, 1e-12);
  assert_float_equal(c.edge_max, 0.5 * LAVES__C15_LONGEST_EDGE, 1e-12);
  assert_true(fabs(c.edge_mean / 0.5 - 1) < 0.01);
}

/* Mean and deviation from the classes of tets: 96, 32 and 8 of the period. */
static void assert_classes(laves_statistic s, double a, double b, double c) {
  const double mean = (96 * a + 32 * b + 8 * c) / 136;
  const double square = (96 * (a - mean) * (a - mean) + 32 * (b - mean) * (b - mean) + 8 * (c - mean) * (c - mean)) / 136;
  assert_float_equal(s.min, fmin(a, fmin(b, c)), 1e-9);
  assert_float_equal(s.max, fmax(a, fmax(b, c)), 1e-9);
  assert_float_equal(s.mean, mean, 1e-9);
  assert_float_equal(s.deviation, sqrt(square), 1e-7);
}

static double degrees(double cosine) { return acos(cosine) * 180 / M_PI; }

/* Radius ratio 3 r / R of a tet from its volume, area and circumradius, in quarter units. */
static double radius_ratio(double volume, double area, double circumradius) { return 9 * volume / area / circumradius; }

static void figures_of_one_period(void **state) {
  const laves_check one = check_of(*state, 1, 1, 1, 1), more = check_of(*state, 2, 3, 2, 7);
  const laves_check *both[2] = {&one, &more};
  for (int i = 0; i < 2; i++) {
    const laves_check *c = both[i];
    assert_classes(c->min_dihedral, 60, degrees(7.0 / 18), degrees(1.0 / 3));
    assert_classes(c->max_dihedral, degrees(sqrt(3) / 6), degrees(sqrt(6) / 9), degrees(1.0 / 3));
    assert_float_equal(c->radius_ratio.max, 1, 1e-12);
    assert_float_equal(c->radius_ratio.min, 0.9724, 5e-5);
    assert_float_equal(c->radius_ratio.mean, 0.9790, 5e-5);
    assert_float_equal(c->radius_ratio.deviation, 0.0060, 5e-5);
    assert_float_equal(c->radius_edge.min, 1, 1e-12);
    assert_float_equal(c->radius_edge.max, 1.1607, 5e-5);
    assert_float_equal(c->radius_edge.mean, 1.1370, 5e-5);
    assert_float_equal(c->radius_edge.deviation, 0.0427, 5e-5);
  }
  /* (0, m, m, m): an equilateral base of side sqrt 8 and three edges sqrt 11, in quarter units. */
  const double base = 2 * sqrt(3), height = sqrt(11 - 8.0 / 3), wing = sqrt(8) * sqrt(11 - 2.0) / 2;
  assert_float_equal(one.radius_ratio.min, radius_ratio(base * height / 3, base + 3 * wing, 11 / (2 * height)), 1e-9);
}

static void refusals(void **state) {
  laves_mesh *mesh;
  laves_error error;
  assert_int_equal(laves_generate_tiling(*state, (const int[3]){1, 0, 1}, 1, &mesh, &error), LAVES_ERROR_OPTION);
  assert_string_equal(error.text, "1 x 0 x 1 cells are none; each count must be at least 1");
  assert_int_equal(laves_generate_tiling(*state, (const int[3]){1, 1, 1}, 0, &mesh, &error), LAVES_ERROR_OPTION);
  assert_int_equal(laves_generate_tiling(*state, (const int[3]){1, 1, 1}, NAN, &mesh, &error), LAVES_ERROR_OPTION);
  assert_int_equal(laves_generate_tiling(*state, (const int[3]){INT32_MAX, INT32_MAX, INT32_MAX}, 1, &mesh, &error),
                   LAVES_ERROR_OPTION);
  assert_null(mesh);
}

static void threads_agree(void **state) {
  (void)state;
  char hash[3][33];
  for (int i = 0; i < 3; i++) {
    laves_context_options options = laves_context_options_default();
    options.thread_count = i + 1;
    laves_context *context = laves_context_create(&options);
    laves_mesh *mesh;
    assert_int_equal(laves_generate_tiling(context, (const int[3]){8, 9, 7}, 1, &mesh, NULL), LAVES_OK);
    laves_mesh_hash(mesh, hash[i]);
    laves_mesh_free(mesh);
    laves_context_free(context);
  }
  assert_string_equal(hash[0], hash[1]);
  assert_string_equal(hash[0], hash[2]);
}

static void short_of_memory(void **state) {
  (void)state;
  laves_result result;
  size_t limit = 1;
  do {
    laves_context_options options = laves_context_options_default();
    options.memory_limit = limit;
    laves_context *context = laves_context_create(&options);
    laves_mesh *mesh;
    result = laves_generate_tiling(context, (const int[3]){2, 2, 2}, 1, &mesh, NULL);
    assert_true(result == LAVES_OK || result == LAVES_ERROR_MEMORY);
    laves_mesh_free(mesh);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
    limit += limit < 80000 ? 500 : 1000000;
  } while (result != LAVES_OK);
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(sound_and_complete),        TEST(figures_of_one_period),       TEST(refusals),
      cmocka_unit_test(threads_agree), cmocka_unit_test(short_of_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
