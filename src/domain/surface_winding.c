/* The generalised winding number: how often a surface, closed or not, winds round a point.
 *
 * In: the tree of the triangles.  Out: a moment for each node, and the number at any point.
 *
 * The number is the sum of the triangles' signed solid angles over 4 pi. Far from a node (far_factor times its radius) its
 * triangles are replaced by an expansion to second order about the area-weighted centre: with y = centre - p, r = |y|,
 *
 *   4 pi w = N.y / r^3 + tr(M) / r^3 - 3 y.M y / r^5,   N = sum of a n,  M = sum of (c - centre) (a n)^T
 *
 * [barill2018, sec. 3, eq. 12 to 14]. Nodes come before their children in memory, so moments are summed from the last to
 * the first. */
#include "domain/surface.h"

/* Enough to tell integers apart: errors of 2e-3 in the mean and 2e-2 at most on real models. */
static const double default_far_factor = 2.5;

/* Gradients need to see further: of an expansion they lose an order more than the number. */
static const double gradient_far = 2;

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

static void sum_centre(const laves__winding *w, const laves__bvh_node *n, laves__moment *m) {
  laves__vec3 sum = v3(0, 0, 0), plain = v3(0, 0, 0);
  double plain_count = 0;
  for (int i = 0; i < 4; i++) {
    if (!laves__bvh_is_used(n, i)) continue;
    if (!(n->child[i] & LAVES__LEAF_BIT)) {
      const laves__moment *below = &w->moments[n->child[i]];
      m->area += below->area;
      m->area_vector = v3_add(m->area_vector, below->area_vector);
      sum = v3_mad(sum, below->centre, below->area);
      plain = v3_add(plain, below->centre);
      plain_count++;
      continue;
    }
    for (uint32_t slot = laves__leaf_first(n->child[i]); slot <= laves__leaf_last(n->child[i]); slot++) {
      const laves__triangle *t = &w->bvh->triangles[slot];
      const laves__vec3 a = v3_scale(area_vector2(t), 0.5);
      m->area += v3_norm(a);
      m->area_vector = v3_add(m->area_vector, a);
      sum = v3_mad(sum, centroid(t), v3_norm(a));
      plain = v3_add(plain, centroid(t));
      plain_count++;
    }
  }
  m->centre = m->area > 0 ? v3_scale(sum, 1 / m->area) : v3_scale(plain, 1 / plain_count);
}

static void sum_about_centre(const laves__winding *w, const laves__bvh_node *n, laves__moment *m) {
  for (int i = 0; i < 4; i++) {
    if (!laves__bvh_is_used(n, i)) continue;
    if (!(n->child[i] & LAVES__LEAF_BIT)) {
      const laves__moment *below = &w->moments[n->child[i]];
      const laves__vec3 offset = v3_sub(below->centre, m->centre);
      for (int k = 0; k < 6; k++) m->first[k] += below->first[k];
      add_first(m->first, offset, below->area_vector);
      m->radius = fmax(m->radius, v3_norm(offset) + below->radius);
      continue;
    }
    for (uint32_t slot = laves__leaf_first(n->child[i]); slot <= laves__leaf_last(n->child[i]); slot++) {
      const laves__triangle *t = &w->bvh->triangles[slot];
      add_first(m->first, v3_sub(centroid(t), m->centre), v3_scale(area_vector2(t), 0.5));
      const double reach = fmax(v3_distance(t->a, m->centre), fmax(v3_distance(t->b, m->centre), v3_distance(t->c, m->centre)));
      m->radius = fmax(m->radius, reach);
    }
  }
}

bool laves__winding_build(laves_context *context, laves__bvh *bvh, laves__winding *w) {
  w->bvh = bvh;
  w->far_factor = default_far_factor;
  w->moment_count = bvh->node_count;
  w->moments = laves__alloc_zeroed(context, bvh->node_count, sizeof *w->moments);
  if (!w->moments) return false;
  for (size_t i = bvh->node_count; i-- > 0;) {
    laves__moment *m = &w->moments[i];
    sum_centre(w, &bvh->nodes[i], m);
    sum_about_centre(w, &bvh->nodes[i], m);
    m->radius2 = m->radius * m->radius;
  }
  return true;
}

void laves__winding_free(laves_context *context, laves__winding *w) {
  laves__free(context, w->moments, w->moment_count, sizeof *w->moments);
  *w = (laves__winding){0};
}

/* The sum of half the signed solid angles of triangles, as a turn in the plane: the unit of |x| + |y| in its direction, and how
 * often it went round. One arc tangent in the end serves them all. */
typedef struct turn {
  double x, y;
  int rounds;
} turn;

/* Adds the angle of (x, y), of (-pi, pi]. The sum goes round when two angles of one sign, not both acute, end on the other. */
static void add_angle(turn *sum, double y, double x) {
  const turn old = *sum;
  const bool obtuse = old.x < 0 || x < 0;
  sum->x = old.x * x - old.y * y;
  sum->y = old.x * y + old.y * x;
  if (obtuse && old.y >= 0 && y >= 0 && sum->y < 0) sum->rounds++;
  if (obtuse && old.y < 0 && y < 0 && sum->y >= 0) sum->rounds--;
  const double length = fabs(sum->x) + fabs(sum->y);
  if (length > 0) {
    sum->x /= length;
    sum->y /= length;
  } else {
    *sum = old; /* the point is a corner, or on an edge: no angle is seen */
  }
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

static double far_field(const laves__moment *m, laves__vec3 y, double r2) {
  const double r = sqrt(r2), r3 = r * r2;
  const double *f = m->first;
  return (v3_dot(m->area_vector, y) + f[0] + f[1] + f[2] - 3 * quadratic_of(f, y) / r2) / r3;
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
  double sum = 0;
  turn near = {1, 0, 0};
  stack[top++] = 0;
  while (top > 0) {
    const uint32_t index = stack[--top];
    const laves__moment *m = &w->moments[index];
    const laves__vec3 y = v3_sub(m->centre, p);
    const double r2 = v3_norm2(y);
    if (r2 > far2 * m->radius2) {
      sum += far_field(m, y, r2);
      continue;
    }
    const laves__bvh_node *n = &w->bvh->nodes[index];
    for (int i = 0; i < 4; i++) {
      if (!laves__bvh_is_used(n, i)) continue;
      if (!(n->child[i] & LAVES__LEAF_BIT)) {
        stack[top++] = n->child[i];
        continue;
      }
      for (uint32_t slot = laves__leaf_first(n->child[i]); slot <= laves__leaf_last(n->child[i]); slot++)
        if (!skips || (slot != skip_a && slot != skip_b)) add_triangle(&near, &w->bvh->triangles[slot], p);
    }
  }
  return (sum + 2 * laves__angle(near.y, near.x)) / four_pi + near.rounds;
}

laves__vec3 laves__winding_gradient(const laves__winding *w, laves__vec3 p) {
  const double factor = gradient_far * w->far_factor, far2 = factor * factor;
  uint32_t stack[LAVES__BVH_STACK];
  int top = 0;
  laves__vec3 sum = v3(0, 0, 0);
  stack[top++] = 0;
  while (top > 0) {
    const uint32_t index = stack[--top];
    const laves__moment *m = &w->moments[index];
    const laves__vec3 y = v3_sub(m->centre, p);
    const double r2 = v3_norm2(y);
    if (r2 > far2 * m->radius2) {
      sum = v3_add(sum, far_gradient(m, y, r2));
      continue;
    }
    const laves__bvh_node *n = &w->bvh->nodes[index];
    for (int i = 0; i < 4; i++) {
      if (!laves__bvh_is_used(n, i)) continue;
      if (!(n->child[i] & LAVES__LEAF_BIT)) {
        stack[top++] = n->child[i];
        continue;
      }
      for (uint32_t slot = laves__leaf_first(n->child[i]); slot <= laves__leaf_last(n->child[i]); slot++)
        sum = v3_add(sum, triangle_gradient(&w->bvh->triangles[slot], p));
    }
  }
  return v3_scale(sum, 1 / four_pi);
}
