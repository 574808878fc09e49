/* The generalised winding number: how often a surface, closed or not, winds round a point.
 *
 * In: the tree of the triangles.  Out: a moment for each node and leaf, and the number at any point.
 *
 * The number is the sum of the triangles' signed solid angles over 4 pi. Far from a node or leaf (far_factor times its radius)
 * its triangles are replaced by an expansion to second order about the area-weighted centre: with y = centre - p, r = |y|,
 *
 *   4 pi w = N.y / r^3 + tr(M) / r^3 - 3 y.M y / r^5,   N = sum of a n,  M = sum of (c - centre) (a n)^T
 *
 * [barill2018, sec. 3, eq. 12 to 14]. Nodes come before their children in memory, so moments are summed from the last to
 * the first. Those of a node's four children lie side by side, and are asked two at a time. */
#include <float.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "domain/surface.h"

/* Two lanes, in the vector notation that GCC and Clang share. */
typedef double double2 __attribute__((vector_size(16), aligned(8), may_alias));
typedef int64_t long2 __attribute__((vector_size(16), aligned(8), may_alias));

/* Enough to tell integers apart: errors of 3e-3 in the mean and 2e-2 at most on real models. */
static const double default_far_factor = 2.5;

/* The errors of single triangles do not cancel as those of nodes do, so leaves are taken as near for a while longer. */
static const double leaf_room = 1.25;

/* Gradients need to see further: of an expansion they lose an order more than the number. */
static const double gradient_far = 2;

/* A sum of angles this short is made longer; each angle may halve it. */
static const double short_turn = 0x1p-256;

/* Beyond all surfaces, with a square that can be formed. */
static const double nowhere = 1e100;

static const double four_pi = 12.566370614359172;

/* Twice the area vector of a triangle. */
static laves__vec3 area_vector2(const laves__triangle *t) { return v3_cross(v3_sub(t->b, t->a), v3_sub(t->c, t->a)); }

static laves__vec3 centroid(const laves__triangle *t) { return v3_scale(v3_add(t->a, v3_add(t->b, t->c)), 1.0 / 3); }

/* Adds offset (x) v, keeping the symmetric part, all that y.M y sees. */
static void add_first(double first[6], laves__vec3 offset, laves__vec3 v) {
  first[0] += offset.x * v.x;
  first[1] += offset.y * v.y;
  first[2] += offset.z * v.z;
  first[3] += offset.x * v.y + offset.y * v.x;
  first[4] += offset.y * v.z + offset.z * v.y;
  first[5] += offset.z * v.x + offset.x * v.z;
}

static void reach_to(laves__moment *m, laves__vec3 p, double more) {
  m->radius = fmax(m->radius, v3_distance(p, m->centre) + more);
}

static laves__moment moment_of_leaf(const laves__bvh *bvh, uint32_t child) {
  const uint32_t first = laves__leaf_first(child), last = laves__leaf_last(child);
  laves__moment m = {0};
  laves__vec3 sum = v3(0, 0, 0), plain = v3(0, 0, 0);
  for (uint32_t slot = first; slot <= last; slot++) {
    const laves__triangle *t = &bvh->triangles[slot];
    const laves__vec3 a = v3_scale(area_vector2(t), 0.5);
    m.area += v3_norm(a);
    m.area_vector = v3_add(m.area_vector, a);
    sum = v3_mad(sum, centroid(t), v3_norm(a));
    plain = v3_add(plain, centroid(t));
  }
  m.centre = m.area > 0 ? v3_scale(sum, 1 / m.area) : v3_scale(plain, 1.0 / (last - first + 1));
  for (uint32_t slot = first; slot <= last; slot++) {
    const laves__triangle *t = &bvh->triangles[slot];
    add_first(m.first, v3_sub(centroid(t), m.centre), v3_scale(area_vector2(t), 0.5));
    reach_to(&m, t->a, 0);
    reach_to(&m, t->b, 0);
    reach_to(&m, t->c, 0);
  }
  return m;
}

static laves__moment moment_of_node(const laves__moment below[], int count) {
  laves__moment m = {0};
  laves__vec3 sum = v3(0, 0, 0), plain = v3(0, 0, 0);
  for (int i = 0; i < count; i++) {
    m.area += below[i].area;
    m.area_vector = v3_add(m.area_vector, below[i].area_vector);
    sum = v3_mad(sum, below[i].centre, below[i].area);
    plain = v3_add(plain, below[i].centre);
  }
  m.centre = m.area > 0 ? v3_scale(sum, 1 / m.area) : v3_scale(plain, 1.0 / count);
  for (int i = 0; i < count; i++) {
    for (int k = 0; k < 6; k++) m.first[k] += below[i].first[k];
    add_first(m.first, v3_sub(below[i].centre, m.centre), below[i].area_vector);
    reach_to(&m, below[i].centre, below[i].radius);
  }
  return m;
}

/* Lanes without a child are nothing, far from everywhere. */
static void pack(const laves__moment below[], int count, laves__moments *m) {
  const laves__moment nothing = {.centre = {nowhere, nowhere, nowhere}};
  for (int i = 0; i < 4; i++) {
    const laves__moment *from = i < count ? &below[i] : &nothing;
    m->centre[0][i] = from->centre.x;
    m->centre[1][i] = from->centre.y;
    m->centre[2][i] = from->centre.z;
    m->area_vector[0][i] = from->area_vector.x;
    m->area_vector[1][i] = from->area_vector.y;
    m->area_vector[2][i] = from->area_vector.z;
    for (int k = 0; k < 6; k++) m->first[k][i] = from->first[k];
    m->radius2[i] = i < count ? from->radius * from->radius : -1;
  }
}

static laves__moment unpack(const laves__moments *m, int i) {
  laves__moment to = {.centre = {m->centre[0][i], m->centre[1][i], m->centre[2][i]},
                      .area_vector = {m->area_vector[0][i], m->area_vector[1][i], m->area_vector[2][i]}};
  for (int k = 0; k < 6; k++) to.first[k] = m->first[k][i];
  return to;
}

bool laves__winding_build(laves_context *context, laves__bvh *bvh, laves__winding *w) {
  w->bvh = bvh;
  w->far_factor = default_far_factor;
  w->node_count = bvh->node_count;
  w->moments = laves__alloc(context, bvh->node_count, sizeof *w->moments);
  laves__moment *whole = laves__alloc(context, bvh->node_count, sizeof *whole);
  for (size_t k = bvh->node_count; w->moments && whole && k-- > 0;) {
    const laves__bvh_node *n = &bvh->nodes[k];
    laves__moment below[4];
    int count = 0;
    for (; count < 4 && laves__bvh_is_used(n, count); count++) {
      const uint32_t child = n->child[count];
      below[count] = child & LAVES__LEAF_BIT ? moment_of_leaf(bvh, child) : whole[child];
    }
    whole[k] = moment_of_node(below, count);
    for (int i = 0; i < count; i++)
      if (n->child[i] & LAVES__LEAF_BIT) below[i].radius *= leaf_room;
    pack(below, count, &w->moments[k]);
  }
  const bool done = w->moments && whole;
  laves__free(context, whole, bvh->node_count, sizeof *whole);
  return done;
}

void laves__winding_free(laves_context *context, laves__winding *w) {
  laves__free(context, w->moments, w->node_count, sizeof *w->moments);
  *w = (laves__winding){0};
}

/* The sum of half the signed solid angles of triangles, as a turn in the plane: the unit of |x| + |y| in its direction, and how
 * often it went round. One arc tangent in the end serves them all. */
typedef struct turn {
  double x, y;
  int rounds;
} turn;

/* Adds the angle of (x, y), of (-pi, pi]. The sum goes round when two angles of one sign, not both acute, end on the other. Each
 * angle is made a unit long before it is added, and the sum only once it has become short: divisions of the sum would wait for
 * one another. */
static void add_angle(turn *sum, double y, double x) {
  const double length = fabs(x) + fabs(y);
  if (!(length >= DBL_MIN)) return; /* the point is a corner, or on an edge: no angle is seen */
  const double scale = 1 / length, old_x = sum->x, old_y = sum->y;
  x *= scale;
  y *= scale;
  const bool obtuse = old_x < 0 || x < 0;
  sum->x = old_x * x - old_y * y;
  sum->y = old_x * y + old_y * x;
  if (obtuse && old_y >= 0 && y >= 0 && sum->y < 0) sum->rounds++;
  if (obtuse && old_y < 0 && y < 0 && sum->y >= 0) sum->rounds--;
  if (fabs(sum->x) + fabs(sum->y) > short_turn) return;
  sum->x /= short_turn;
  sum->y /= short_turn;
}

/* Half the solid angle: van Oosterom and Strackee, "The solid angle of a plane triangle", 1983, eq. 8. */
static void add_triangle(turn *sum, const laves__triangle *t, laves__vec3 p) {
  const laves__vec3 a = v3_sub(t->a, p), b = v3_sub(t->b, p), c = v3_sub(t->c, p);
  const double la = v3_norm(a), lb = v3_norm(b), lc = v3_norm(c);
  add_angle(sum, v3_dot(a, v3_cross(b, c)), la * lb * lc + v3_dot(a, b) * lc + v3_dot(b, c) * la + v3_dot(c, a) * lb);
}

static inline double quadratic_of(const double f[6], laves__vec3 y) {
  return f[0] * y.x * y.x + f[1] * y.y * y.y + f[2] * y.z * y.z + f[3] * y.x * y.y + f[4] * y.y * y.z + f[5] * y.z * y.x;
}

static inline double2 root(double2 x) {
#ifdef __SSE2__
  return (double2)_mm_sqrt_pd((__m128d)x);
#else
  return (double2){sqrt(x[0]), sqrt(x[1])};
#endif
}

/* What the far ones of two children add to 4 pi times the number, and which are far. */
static inline double2 far_field(const laves__moments *m, int pair, laves__vec3 p, double far2, long2 *far) {
#define LANES(a) (*(const double2 *)&(a)[2 * pair])
  const double2 x = LANES(m->centre[0]) - p.x, y = LANES(m->centre[1]) - p.y, z = LANES(m->centre[2]) - p.z;
  const double2 r2 = x * x + y * y + z * z, per_r2 = 1 / r2;
  const double2 xx = LANES(m->first[0]), yy = LANES(m->first[1]), zz = LANES(m->first[2]);
  const double2 first = LANES(m->area_vector[0]) * x + LANES(m->area_vector[1]) * y + LANES(m->area_vector[2]) * z + xx + yy + zz;
  const double2 quadratic =
      xx * x * x + yy * y * y + zz * z * z + LANES(m->first[3]) * x * y + LANES(m->first[4]) * y * z + LANES(m->first[5]) * z * x;
  *far = (long2)(r2 > far2 * LANES(m->radius2));
#undef LANES
  return (double2)((long2)((first - 3 * quadratic * per_r2) * (per_r2 * root(per_r2))) & *far);
}

/* With respect to p = centre - y. */
static laves__vec3 far_gradient(const laves__moment *m, laves__vec3 y, double r2) {
  const double *f = m->first;
  const double r3 = r2 * sqrt(r2), first = v3_dot(m->area_vector, y) + f[0] + f[1] + f[2];
  const laves__vec3 of_quadratic = v3(2 * f[0] * y.x + f[3] * y.y + f[5] * y.z, 2 * f[1] * y.y + f[3] * y.x + f[4] * y.z,
                                      2 * f[2] * y.z + f[4] * y.y + f[5] * y.x);
  const laves__vec3 sum = v3_mad(v3_scale(m->area_vector, -1), of_quadratic, 3 / r2);
  return v3_scale(v3_mad(sum, y, 3 * (first - 5 * quadratic_of(f, y) / r2) / r2), 1 / r3);
}

laves__vec3 laves__edge_winding_gradient(laves__vec3 a, laves__vec3 b, laves__vec3 p) {
  const laves__vec3 u = v3_sub(a, p), v = v3_sub(b, p);
  const double lu = v3_norm(u), lv = v3_norm(v), bottom = lu * lv * (lu * lv + v3_dot(u, v));
  return bottom > 0 ? v3_scale(v3_cross(u, v), (lu + lv) / bottom) : v3(0, 0, 0);
}

static laves__vec3 triangle_gradient(const laves__triangle *t, laves__vec3 p) {
  const laves__vec3 sum = v3_add(laves__edge_winding_gradient(t->a, t->b, p), laves__edge_winding_gradient(t->b, t->c, p));
  return v3_add(sum, laves__edge_winding_gradient(t->c, t->a, p));
}

double laves__winding_number(const laves__winding *w, laves__vec3 p, uint32_t skip_a, uint32_t skip_b) {
  const bool skips = skip_a != LAVES__NONE || skip_b != LAVES__NONE;
  const double far2 = w->far_factor * w->far_factor;
  uint32_t stack[LAVES__BVH_STACK];
  int top = 0;
  double2 sum = {0, 0};
  turn near = {1, 0, 0};
  stack[top++] = 0;
  while (top > 0) {
    const uint32_t index = stack[--top];
    long2 far[2];
    sum += far_field(&w->moments[index], 0, p, far2, &far[0]);
    sum += far_field(&w->moments[index], 1, p, far2, &far[1]);
    for (int i = 0; i < 4; i++) {
      if (far[i / 2][i % 2]) continue;
      const uint32_t child = w->bvh->nodes[index].child[i];
      if (!(child & LAVES__LEAF_BIT)) {
        stack[top++] = child;
        continue;
      }
      for (uint32_t slot = laves__leaf_first(child); slot <= laves__leaf_last(child); slot++)
        if (!skips || (slot != skip_a && slot != skip_b)) add_triangle(&near, &w->bvh->triangles[slot], p);
    }
  }
  return (sum[0] + sum[1] + 2 * laves__angle(near.y, near.x)) / four_pi + near.rounds;
}

laves__vec3 laves__winding_gradient(const laves__winding *w, laves__vec3 p) {
  const double factor = gradient_far * w->far_factor, far2 = factor * factor;
  uint32_t stack[LAVES__BVH_STACK];
  int top = 0;
  laves__vec3 sum = v3(0, 0, 0);
  stack[top++] = 0;
  while (top > 0) {
    const uint32_t index = stack[--top];
    for (int i = 0; i < 4; i++) {
      const uint32_t child = w->bvh->nodes[index].child[i];
      const laves__moment m = unpack(&w->moments[index], i);
      const laves__vec3 y = v3_sub(m.centre, p);
      const double r2 = v3_norm2(y);
      if (r2 > far2 * w->moments[index].radius2[i]) {
        sum = v3_add(sum, far_gradient(&m, y, r2));
      } else if (!(child & LAVES__LEAF_BIT)) {
        stack[top++] = child;
      } else {
        for (uint32_t slot = laves__leaf_first(child); slot <= laves__leaf_last(child); slot++)
          sum = v3_add(sum, triangle_gradient(&w->bvh->triangles[slot], p));
      }
    }
  }
  return v3_scale(sum, 1 / four_pi);
}
