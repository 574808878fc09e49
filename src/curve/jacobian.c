/* The Jacobian of a ten-node tetrahedron in Bernstein's form.
 *
 * With the control points b_ii = x_i and b_ij = 2 m_ij - (x_i + x_j) / 2 the map is x(λ) = sum λ_i λ_j b_ij, so its derivatives
 * by λ_1, λ_2, λ_3, less that by λ_0, are 2 sum_j λ_j e_kj with e_kj = b_kj - b_0j. Their determinant is
 *
 *     8 sum_pqr λ_p λ_q λ_r det(e_1p, e_2q, e_3r),
 *
 * and the coefficient of a cubic monomial's Bernstein polynomial is the mean over the orders of its p, q, r. A polynomial is
 * nowhere below its least coefficient, which makes the test sufficient. Source: [johnen2013]. */
#include "curve/quadratic.h"

/* Where the sum for p, q, r in ascending order stands. */
static int slot_of(int p, int q, int r) {
  const int pq_low = p < q ? p : q, pq_high = p < q ? q : p;
  const int low = pq_low < r ? pq_low : r, high = pq_high > r ? pq_high : r;
  return 16 * low + 4 * (p + q + r - low - high) + high;
}

static void control_points(const laves__vec3 nodes[LAVES__TET_NODES], laves__vec3 b[4][4]) {
  for (int i = 0; i < 4; i++) b[i][i] = v3_sub(nodes[i], nodes[0]);
  for (int m = 0; m < 6; m++) {
    const int i = laves__mid_corners[m][0], j = laves__mid_corners[m][1];
    const laves__vec3 middle = v3_sub(nodes[4 + m], nodes[0]);
    b[i][j] = b[j][i] = v3_mad(v3_scale(middle, 2), v3_add(b[i][i], b[j][j]), -0.5);
  }
}

double laves__quadratic_least(const laves__vec3 nodes[LAVES__TET_NODES]) {
  const double straight = v3_det(nodes[0], nodes[1], nodes[2], nodes[3]);
  if (!(straight > 0)) return -1;
  laves__vec3 b[4][4], e[3][4];
  control_points(nodes, b);
  for (int k = 0; k < 3; k++)
    for (int j = 0; j < 4; j++) e[k][j] = v3_sub(b[k + 1][j], b[0][j]);
  double sum[64] = {0};
  int terms[64] = {0};
  for (int q = 0; q < 4; q++)
    for (int r = 0; r < 4; r++) {
      const laves__vec3 cross = v3_cross(e[1][q], e[2][r]);
      for (int p = 0; p < 4; p++) {
        const int slot = slot_of(p, q, r);
        sum[slot] += v3_dot(e[0][p], cross);
        terms[slot]++;
      }
    }
  double least = INFINITY;
  for (int i = 0; i < 64; i++)
    if (terms[i] > 0 && sum[i] / terms[i] < least) least = sum[i] / terms[i];
  return 8 * least / straight;
}

laves__vec3 laves__quadratic_point(const laves__vec3 nodes[LAVES__FACE_NODES], double l0, double l1, double l2) {
  const double l[3] = {l0, l1, l2};
  laves__vec3 point = v3(0, 0, 0);
  for (int i = 0; i < 3; i++) {
    const int a = laves__mid_corners[i][0], b = laves__mid_corners[i][1];
    point = v3_mad(point, nodes[i], l[i] * (2 * l[i] - 1));
    point = v3_mad(point, nodes[3 + i], 4 * l[a] * l[b]);
  }
  return point;
}
