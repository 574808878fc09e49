/* Shapes of many tetrahedra at once.
 *
 * What quality.c does for one tet, step by step and in the same order, so that the digits are the same, in one loop without
 * jumps, which compilers turn into vector code. Steps that several measures share are done once. See quality.c for the formulas.
 */
#include "mesh/shape_batch.h"

#include "base/wide.h"

#define REGULAR_RADIUS_EDGE 0.61237243569579452 /* sqrt(6) / 4 */
#define SQRT_2 1.4142135623730951

static inline double lesser(double a, double b) { return a < b ? a : b; }

static inline laves__vec3 corner(const laves__shape_batch *b, int i, int lane) {
  return v3(b->corner[i][0][lane], b->corner[i][1][lane], b->corner[i][2][lane]);
}

LAVES__WIDE void laves__shape_batch_measure(laves__shape_batch *restrict b) {
  for (int i = 0; i < LAVES__SHAPE_BATCH; i++) {
    const laves__vec3 p0 = corner(b, 0, i), p1 = corner(b, 1, i), p2 = corner(b, 2, i), p3 = corner(b, 3, i);
    /* The outward normals are n0 and the opposites of vw, wu, uv. */
    const laves__vec3 u = v3_sub(p1, p0), v = v3_sub(p2, p0), w = v3_sub(p3, p0);
    const laves__vec3 e12 = v3_sub(p2, p1), e13 = v3_sub(p3, p1), e23 = v3_sub(p3, p2);
    const laves__vec3 n0 = v3_cross(e12, e13), vw = v3_cross(v, w), wu = v3_cross(w, u), uv = v3_cross(u, v);
    const double l0 = v3_norm(n0), l1 = v3_norm(vw), l2 = v3_norm(wu), l3 = v3_norm(uv);
    const double r0 = 1 / l0, r1 = 1 / l1, r2 = 1 / l2, r3 = 1 / l3;
    b->cosine[0][i] = -v3_dot(wu, uv) * r2 * r3;
    b->cosine[1][i] = -v3_dot(vw, uv) * r1 * r3;
    b->cosine[2][i] = -v3_dot(vw, wu) * r1 * r2;
    b->cosine[3][i] = v3_dot(n0, uv) * r0 * r3;
    b->cosine[4][i] = v3_dot(n0, wu) * r0 * r2;
    b->cosine[5][i] = v3_dot(n0, vw) * r0 * r1;

    const double u2 = v3_norm2(u), v2 = v3_norm2(v), w2 = v3_norm2(w);
    const double q12 = v3_norm2(e12), q13 = v3_norm2(e13), q23 = v3_norm2(e23);
    const double determinant = v3_dot(u, vw);
    const double offset = v3_norm(v3_add(v3_scale(vw, u2), v3_add(v3_scale(wu, v2), v3_scale(uv, w2))));
    b->determinant[i] = determinant;

    const double twice_area = l0 + l1 + l2 + l3, by_area = offset * twice_area;
    b->radius_ratio[i] = by_area > 0 ? 6 * determinant * fabs(determinant) / by_area : 0;

    const double shortest = lesser(lesser(lesser(u2, v2), lesser(w2, q12)), lesser(q13, q23));
    const double by_edge = 2 * fabs(determinant) * sqrt(shortest) * REGULAR_RADIUS_EDGE;
    b->radius_edge[i] = by_edge > 0 ? offset / by_edge : INFINITY;

    const double mean_square = (u2 + v2 + w2 + q12 + q13 + q23) / 6;
    const double length = SQRT_2 * determinant / (mean_square * sqrt(mean_square));
    b->volume_length[i] = mean_square > 0 ? length : 0;
  }
}

LAVES__WIDE void laves__shape_batch_fits(const laves__shape_batch *restrict b, double low, double high,
                                         double fits[restrict LAVES__SHAPE_BATCH]) {
  for (int i = 0; i < LAVES__SHAPE_BATCH; i++) {
    double fit = b->determinant[i] > 0 ? 1 : 0;
    for (int e = 0; e < 6; e++) {
      fit = 1 - b->cosine[e][i] >= low ? fit : 0;
      fit = 1 + b->cosine[e][i] >= high ? fit : 0;
    }
    fits[i] = fit;
  }
}
