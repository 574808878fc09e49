/* laves__orient3d against exact integers: coordinates are whole multiples of a power of two, so that the determinant is
 * a whole number of 128 bits. */
#include "base/predicates.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

__extension__ typedef __int128 int128;

static uint64_t next_random(uint64_t *state) {
  uint64_t z = (*state += 0x9e3779b97f4a7c15);
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
  z = (z ^ z >> 27) * 0x94d049bb133111eb;
  return z ^ z >> 31;
}

static int64_t random_within(uint64_t *state, int64_t limit) {
  return (int64_t)(next_random(state) % (uint64_t)(2 * limit + 1)) - limit;
}

static int exact_sign(int64_t p[4][3]) {
  int128 m[3][3];
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) m[i][k] = (int128)p[i + 1][k] - p[0][k];
  const int128 determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) +
                             m[0][1] * (m[1][2] * m[2][0] - m[1][0] * m[2][2]) +
                             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return (determinant > 0) - (determinant < 0);
}

static int sign_scaled(int64_t p[4][3], double scale) {
  laves__vec3 q[4];
  for (int i = 0; i < 4; i++) q[i] = v3((double)p[i][0] * scale, (double)p[i][1] * scale, (double)p[i][2] * scale);
  return laves__orient3d(q[0], q[1], q[2], q[3]);
}

/* All rotations of the corners agree with the exact sign, at several scales. */
static void compare(int64_t p[4][3]) {
  static const double scales[] = {1, 0x1p-40, 0x1p60};
  for (int s = 0; s < 3; s++)
    for (int first = 0; first < 4; first++) {
      int64_t q[4][3];
      for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) q[i][k] = p[(i + first) % 4][k];
      assert_int_equal(sign_scaled(q, scales[s]), exact_sign(q));
    }
}

static void knows_positive(void **state) {
  (void)state;
  assert_int_equal(laves__orient3d(v3(0, 0, 0), v3(1, 0, 0), v3(0, 1, 0), v3(0, 0, 1)), 1);
  assert_int_equal(laves__orient3d(v3(0, 0, 0), v3(0, 1, 0), v3(1, 0, 0), v3(0, 0, 1)), -1);
  assert_int_equal(laves__orient3d(v3(0, 0, 0), v3(0, 1, 0), v3(1, 0, 0), v3(1, 1, 0)), 0);
}

static void random_points(void **state) {
  (void)state;
  uint64_t seed = 1;
  for (int n = 0; n < 20000; n++) {
    const int64_t limit = n % 2 ? (int64_t)1 << 39 : 3;
    int64_t p[4][3];
    for (int i = 0; i < 4; i++)
      for (int k = 0; k < 3; k++) p[i][k] = random_within(&seed, limit);
    compare(p);
  }
}

/* d = a + s (b - a) + t (c - a) with whole s, t is coplanar; one unit beside it hardly ever is. */
static void coplanar_and_nearly(void **state) {
  (void)state;
  uint64_t seed = 2;
  int zeros = 0;
  for (int n = 0; n < 20000; n++) {
    int64_t p[4][3];
    const int64_t s = random_within(&seed, 1 << 10), t = random_within(&seed, 1 << 10);
    for (int k = 0; k < 3; k++) {
      for (int i = 0; i < 3; i++) p[i][k] = random_within(&seed, (int64_t)1 << 27);
      p[3][k] = p[0][k] + s * (p[1][k] - p[0][k]) + t * (p[2][k] - p[0][k]);
    }
    if (n % 2) p[3][n % 3] += n % 4 == 1 ? 1 : -1;
    zeros += exact_sign(p) == 0;
    compare(p);
  }
  assert_int_equal(zeros, 10000);
}

/* Far from the origin, where nearly everything cancels. */
static void far_away(void **state) {
  (void)state;
  uint64_t seed = 3;
  for (int n = 0; n < 20000; n++) {
    int64_t p[4][3];
    for (int i = 0; i < 4; i++)
      for (int k = 0; k < 3; k++) p[i][k] = ((int64_t)1 << 38) * (n % 2 || i % 2) + random_within(&seed, 2);
    compare(p);
  }
}

/* Differences of coordinates that one double cannot hold: the sign hangs on their second term alone. */
static void long_differences(void **state) {
  (void)state;
  const laves__vec3 b = v3(1, 1, 0), c = v3(1, 1, 1), d = v3(2, 2, 0);
  assert_int_equal(laves__orient3d(v3(0x1p-80, 0, 0), b, c, d), 1);
  assert_int_equal(laves__orient3d(v3(-0x1p-80, 0, 0), b, c, d), -1);
  assert_int_equal(laves__orient3d(v3(0, 0, 0), b, c, d), 0);
  assert_int_equal(laves__orient3d(v3(0x1p-80, 0x1p-80, 0), b, c, d), 0);
}

/* A plane that is asked of many points answers as the predicate does: random points, points of the plane, those next to it. */
static void planes_agree(void **state) {
  (void)state;
  uint64_t seed = 5;
  int zeros = 0;
  for (int n = 0; n < 2000; n++) {
    int64_t x[4][3];
    laves__vec3 p[4];
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++) x[i][k] = random_within(&seed, (int64_t)1 << 20);
    for (int i = 0; i < 3; i++) p[i] = v3((double)x[i][0], (double)x[i][1], (double)x[i][2]);
    const laves__plane plane = laves__plane_of(p[0], p[1], p[2]);
    for (int m = 0; m < 20; m++) {
      const int64_t s = random_within(&seed, 50), t = random_within(&seed, 50), off = m % 4 == 3 ? m / 4 - 2 : 0;
      for (int k = 0; k < 3; k++)
        x[3][k] = m % 4 == 0 ? random_within(&seed, (int64_t)1 << 20)
                             : x[0][k] + s * (x[1][k] - x[0][k]) + t * (x[2][k] - x[0][k]) + (k == n % 3 ? off : 0);
      p[3] = v3((double)x[3][0], (double)x[3][1], (double)x[3][2]);
      const int side = laves__plane_side(&plane, p[3]);
      assert_int_equal(side, laves__orient3d(p[0], p[1], p[2], p[3]));
      zeros += side == 0;
    }
  }
  assert_true(zeros > 10000);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(knows_positive), cmocka_unit_test(random_points),    cmocka_unit_test(coplanar_and_nearly),
      cmocka_unit_test(far_away),       cmocka_unit_test(long_differences), cmocka_unit_test(planes_agree),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
