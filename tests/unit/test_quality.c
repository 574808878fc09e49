/* Measures of one tetrahedron against values known in closed form. */
#include "mesh/quality.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

#include "mesh/mesh.h"
#include "mesh/shape_batch.h"

static const laves__vec3 regular[4] = {{1, 1, 1}, {1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}};
/* The corner of a cube: three right angles at the edges from corner 0. */
static const laves__vec3 corner[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const laves__vec3 flat[4] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

#define assert_near(value, expected) assert_float_equal(value, expected, 1e-12)

static void dihedral_cosines(void **state) {
  (void)state;
  double cosines[6];
  laves__tet_dihedral_cosines(regular, cosines);
  for (int i = 0; i < 6; i++) assert_near(cosines[i], 1.0 / 3);
  laves__tet_dihedral_cosines(corner, cosines);
  for (int i = 0; i < 6; i++) assert_near(cosines[i], laves__tet_edge[i][0] == 0 ? 0 : sqrt(1.0 / 3));
}

/* Only the edge 0-3 of a wedge of 30 degrees has that angle: the order is the one of laves__tet_edge. */
static void dihedral_order(void **state) {
  (void)state;
  const laves__vec3 wedge[4] = {{0, 0, 0}, {1, 0, 0}, {cos(M_PI / 6), 0.5, 0}, {0, 0, 1}};
  double cosines[6];
  laves__tet_dihedral_cosines(wedge, cosines);
  for (int i = 0; i < 6; i++) {
    if (i == 2)
      assert_near(cosines[i], cos(M_PI / 6));
    else
      assert_true(fabs(cosines[i] - cos(M_PI / 6)) > 1e-3);
  }
}

static void regular_gives_one(void **state) {
  (void)state;
  assert_near(laves__tet_volume_length(regular), 1);
  assert_near(laves__tet_radius_ratio(regular), 1);
  assert_near(laves__tet_radius_edge(regular), 1);
}

/* Volume 1/6, edges 1 and sqrt 2, R = sqrt(3)/2, r = 1 / (3 + sqrt 3). */
static void corner_of_a_cube(void **state) {
  (void)state;
  assert_near(laves__tet_volume_length(corner), sqrt(2) / pow(1.5, 1.5));
  assert_near(laves__tet_radius_ratio(corner), 3 / (3 + sqrt(3)) / (sqrt(3) / 2));
  assert_near(laves__tet_radius_edge(corner), sqrt(3) / 2 / (sqrt(6) / 4));
}

static void flat_and_inverted(void **state) {
  (void)state;
  assert_near(laves__tet_volume_length(flat), 0);
  assert_near(laves__tet_radius_ratio(flat), 0);
  assert_true(laves__tet_radius_edge(flat) == INFINITY);
  const laves__vec3 inverted[4] = {regular[1], regular[0], regular[2], regular[3]};
  assert_near(laves__tet_volume_length(inverted), -1);
  const laves__vec3 point[4] = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
  assert_near(laves__tet_volume_length(point), 0);
  assert_near(laves__tet_radius_ratio(point), 0);
  assert_true(laves__tet_radius_edge(point) == INFINITY);
}

static bool same(double a, double b) { return a == b || (isnan(a) && isnan(b)); }

/* Many at once have the digits of each alone: random tets, flat, inverted and wild ones. */
static void batch_has_the_same_digits(void **state) {
  (void)state;
  static laves__shape_batch batch;
  laves__vec3 p[LAVES__SHAPE_BATCH][4];
  uint32_t random = 7;
  int seen[2] = {0, 0};
  for (int round = 0; round < 100; round++) {
    for (int lane = 0; lane < LAVES__SHAPE_BATCH; lane++) {
      const double scale = ldexp(1, round % 10 == 9 ? 600 : round % 10);
      for (int i = 0; i < 4; i++) {
        double x[3];
        for (int k = 0; k < 3; k++) x[k] = ((random = random * 1664525 + 1013904223) >> 16) * scale;
        p[lane][i] = lane % 16 == 5 ? v3(x[0], x[1], 0) : v3(x[0], x[1], x[2]);
      }
      if (lane % 16 == 6) p[lane][3] = p[lane][0];
      if (lane % 16 == 7) p[lane][1] = p[lane][2] = p[lane][3] = p[lane][0];
      laves__shape_batch_set(&batch, lane, p[lane]);
    }
    laves__shape_batch_measure(&batch);
    for (int lane = 0; lane < LAVES__SHAPE_BATCH; lane++) {
      double cosines[6];
      laves__tet_dihedral_cosines(p[lane], cosines);
      for (int i = 0; i < 6; i++) assert_true(same(batch.cosine[i][lane], cosines[i]));
      assert_true(same(batch.radius_ratio[lane], laves__tet_radius_ratio(p[lane])));
      assert_true(same(batch.radius_edge[lane], laves__tet_radius_edge(p[lane])));
      assert_true(same(batch.volume_length[lane], laves__tet_volume_length(p[lane])));
      assert_true(same(batch.determinant[lane], v3_det(p[lane][0], p[lane][1], p[lane][2], p[lane][3])));
    }
    const double low = 0.05, high = 0.2;
    double fits[LAVES__SHAPE_BATCH];
    laves__shape_batch_fits(&batch, low, high, fits);
    for (int lane = 0; lane < LAVES__SHAPE_BATCH; lane++) {
      bool fit = batch.determinant[lane] > 0;
      for (int i = 0; i < 6; i++) fit = fit && 1 - batch.cosine[i][lane] >= low && 1 + batch.cosine[i][lane] >= high;
      assert_true(fits[lane] == (fit ? 1 : 0));
      seen[fit]++;
    }
  }
  assert_true(seen[0] > 100 && seen[1] > 100);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(dihedral_cosines), cmocka_unit_test(dihedral_order),    cmocka_unit_test(regular_gives_one),
      cmocka_unit_test(corner_of_a_cube), cmocka_unit_test(flat_and_inverted), cmocka_unit_test(batch_has_the_same_digits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
