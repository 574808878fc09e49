/* The numbers of stuffing's rule and the margin of a tet. That the windows hold is proved by tests/proof. */
#include "stuff/rule.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

#include "fixtures/assert_close.h"

#define RADIANS (3.14159265358979323846 / 180)

static void windows_are_in_order(void **state) {
  (void)state;
  for (int i = 0; i < LAVES__GUARANTEES; i++) {
    const laves__guarantee *g = &laves__guarantees[i];
    assert_true(g->proved_min > g->min_dihedral && g->proved_max < g->max_dihedral);
    assert_close(g->cos_min, cos(g->proved_min * RADIANS), 1e-15);
    assert_close(g->cos_max, cos(g->proved_max * RADIANS), 1e-15);
    if (i == 0) assert_true(g->relaxation == 0);
    if (i > 0) {
      assert_true(g->min_dihedral > g[-1].min_dihedral && g->max_dihedral < g[-1].max_dihedral);
      assert_true(g->relaxation > g[-1].relaxation && g->relaxation <= 1);
    }
  }
}

/* The proof calculates with them exactly, and a crossing may violate one end only. */
static void thresholds_are_dyadic_and_small(void **state) {
  (void)state;
  for (int i = 0; i < LAVES__GUARANTEES; i++)
    for (int k = 0; k < 8; k++) {
      const double alpha = laves__guarantees[i].thresholds->alpha[k / 4][k / 2 % 2][k % 2];
      assert_true(alpha > 0 && alpha < 0.5);
      assert_true(alpha * 8192 == floor(alpha * 8192));
    }
}

/* A relaxed cut tends to the middle third of its edge. */
static void middles_are_near_the_middle(void **state) {
  (void)state;
  for (int i = 0; i < LAVES__GUARANTEES; i++)
    for (int k = 0; k < 4; k++) {
      const double middle = laves__guarantees[i].thresholds->middle[k / 2][k % 2];
      assert_true(middle > 1.0 / 3 && middle < 2.0 / 3);
      assert_true(middle * 8192 == floor(middle * 8192));
    }
}

static void finds_the_next_window(void **state) {
  (void)state;
  assert_ptr_equal(laves__guarantee_find(0), &laves__guarantees[0]);
  assert_ptr_equal(laves__guarantee_find(laves__guarantees[0].min_dihedral), &laves__guarantees[0]);
  assert_ptr_equal(laves__guarantee_find(15), &laves__guarantees[1]);
  assert_ptr_equal(laves__guarantee_find(20), &laves__guarantees[1]);
  assert_ptr_equal(laves__guarantee_find(20.5), &laves__guarantees[2]);
  assert_ptr_equal(laves__guarantee_find(60), &laves__guarantees[LAVES__GUARANTEES - 1]);
}

/* A tet whose dihedral angle at the edge from corner 0 to 1 is given; the other five lie between 40 and 110 or so. */
static void tet_with_angle(double angle, laves__vec3 corner[4]) {
  const double half = angle / 2 * RADIANS;
  corner[0] = v3(-0.6, 0, 0);
  corner[1] = v3(0.6, 0, 0);
  corner[2] = v3(0, cos(half), -sin(half));
  corner[3] = v3(0, cos(half), sin(half));
}

static void margin_is_one_at_the_limit(void **state) {
  (void)state;
  for (int i = 0; i < LAVES__GUARANTEES; i++) {
    const laves__guarantee *g = &laves__guarantees[i];
    laves__vec3 corner[4];
    tet_with_angle(g->proved_min, corner);
    assert_close(laves__guarantee_margin(g, corner), 1, 1e-12);
    tet_with_angle(g->proved_min + 1e-6, corner);
    assert_true(laves__guarantee_margin(g, corner) > 1);
    tet_with_angle(g->proved_min - 1e-6, corner);
    assert_true(laves__guarantee_margin(g, corner) < 1);
  }
}

static void margin_of_large_angles(void **state) {
  (void)state;
  const laves__guarantee *g = &laves__guarantees[0];
  /* Above a triangle's centre: flat, with three large angles. */
  for (double height = 0.01; height < 0.5; height += 0.01) {
    const laves__vec3 corner[4] = {v3(1, 0, 0), v3(-0.5, sqrt(0.75), 0), v3(-0.5, -sqrt(0.75), 0), v3(0, 0, height)};
    const double low = atan2(height, 0.5) / RADIANS;
    const laves__vec3 n1 = v3_cross(v3_sub(corner[0], corner[3]), v3_sub(corner[1], corner[3]));
    const laves__vec3 n2 = v3_cross(v3_sub(corner[1], corner[3]), v3_sub(corner[2], corner[3]));
    const double high = 180 - acos(v3_dot(n1, n2) / sqrt(v3_norm2(n1) * v3_norm2(n2))) / RADIANS;
    assert_int_equal(laves__guarantee_margin(g, corner) >= 1, low >= g->proved_min && high <= g->proved_max);
  }
}

static void margin_of_bad_tets(void **state) {
  (void)state;
  const laves__guarantee *g = &laves__guarantees[0];
  const laves__vec3 regular[4] = {v3(1, 1, 1), v3(1, -1, -1), v3(-1, 1, -1), v3(-1, -1, 1)};
  const laves__vec3 inverted[4] = {regular[1], regular[0], regular[2], regular[3]};
  const laves__vec3 flat[4] = {v3(0, 0, 0), v3(1, 0, 0), v3(0, 1, 0), v3(1, 1, 0)};
  const laves__vec3 point[4] = {v3(0, 0, 0)};
  const bool positive = v3_det(regular[0], regular[1], regular[2], regular[3]) > 0;
  assert_true(laves__guarantee_margin(g, positive ? regular : inverted) > 1);
  assert_true(laves__guarantee_margin(g, positive ? inverted : regular) <= 0);
  assert_true(laves__guarantee_margin(g, flat) <= 0);
  assert_true(laves__guarantee_margin(g, point) <= 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(windows_are_in_order),        cmocka_unit_test(thresholds_are_dyadic_and_small),
      cmocka_unit_test(middles_are_near_the_middle), cmocka_unit_test(finds_the_next_window),
      cmocka_unit_test(margin_is_one_at_the_limit),  cmocka_unit_test(margin_of_large_angles),
      cmocka_unit_test(margin_of_bad_tets),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
