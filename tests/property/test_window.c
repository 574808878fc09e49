/* The window of the study on smooth solids: every dihedral angle in [40, 125] degrees, volume-length at least 0.6. */
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/stages.h"

static void smooth_solids_are_inside_the_window(void **state) {
  (void)state;
  static const struct {
    const char *expression;
    int64_t tets;
  } solids[] = {
      {"sphere(1)", 100000},
      {"torus(1, 0.4)", 60000},
      {"ellipsoid(3, 1, 1)", 60000},
      {"metaballs{{0, 0, 0, 1}, {1, 0, 0, 0.6}, {0, 0.9, 0.4, 0.7}}", 60000},
      {"sphere(1):rotate(33, 'x')", 30000},
  };
  laves_context *context = laves_context_create(NULL);
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++) {
    const laves_options options = options_of_tets(solids[i].tets);
    laves_report report;
    laves_mesh *mesh = mesh_of_expression(context, solids[i].expression, &options, &report);
    const laves_check check = check_valid(context, mesh, solids[i].expression);
    const worst_shapes worst = worst_of(&check);
    print_message("%-60s %6zu tets: %.2f to %.2f degrees, volume-length %.3f\n", solids[i].expression, mesh->tet_count,
                  worst.min_dihedral, worst.max_dihedral, worst.volume_length);
    assert_true(worst.min_dihedral >= 40 && worst.max_dihedral <= 125 && worst.volume_length >= 0.6);
    assert_int_equal(report.outside_window, 0);
    laves_mesh_free(mesh);
  }
  laves_context_free(context);
}

/* A gyroid cut off by a ball has a crease; the window holds away from it. */
static void gyroid_is_inside_the_window_off_its_rim(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  const char *expression = "gyroid{period=1, thickness=0.4} & sphere(1)";
  const laves_options options = options_of_tets(60000);
  laves_report report;
  laves_mesh *mesh = mesh_of_expression(context, expression, &options, &report);
  check_valid(context, mesh, expression);
  static laves_place places[5000];
  size_t count;
  assert_int_equal(laves_check_window(context, mesh, NULL, 40, 125, 0.6, places, LAVES__COUNT_OF(places), &count, NULL),
                   LAVES_OK);
  assert_true(count <= LAVES__COUNT_OF(places));
  size_t off_rim = 0;
  for (size_t i = 0; i < count; i++) {
    const double *p = places[i].place;
    off_rim += v3_norm(v3(p[0], p[1], p[2])) < 1 - 2 * report.size;
  }
  print_message("gyroid: %zu tets, %zu outside the window, %zu of them off the rim\n", mesh->tet_count, count, off_rim);
  assert_int_equal(off_rim, 0);
  laves_mesh_free(mesh);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(smooth_solids_are_inside_the_window),
      cmocka_unit_test(gyroid_is_inside_the_window_off_its_rim),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
