/* The dihedral angle at the edge from a to b, between the faces with c and d, with e = b - a, u = c - a, v = d - a,
 * m = e x u, n = e x v and W = e . (u x v), six times the volume:
 *
 *     cot(angle) = m . n / (|e| W)
 *
 * W is affine in each corner's share, so it is positive everywhere if it is at the ends. Then the angle is monotone in the
 * shares of c and of d, so only their ends matter, and two shares, of a and b, are left. Let g be a vector no longer than 1;
 * |e| >= g . e. So the angle is at least L if
 *
 *     m . n - cot(L) (g . e) W <= 0
 *
 * and at most H > 90 if the same holds with -m for m and -cot(H) for cot(L). m, n, g . e and W are affine in each of the
 * two shares, so the left side is of degree 2 in each, and its Bernstein coefficients are, up to positive factors, the sums
 * over pairs p, q of ends with the same p + q of
 *
 *     m(p) . n(q) - cot(L) (g . e(p)) W(q)
 *
 * If none of the nine is positive, the claim holds; if one is, the box is halved.
 *
 * Coordinates are multiples of FINE_GRID, so differences and cross products are exact (reachable.h). Everything else is
 * rounded upward, and lower bounds are the negative of upper bounds of the negative. This file is compiled with
 * -frounding-math. */
#include "bound.h"

#include <fenv.h>

/* ---- rounding ---- */

static double times_below(double a, double b) { return -((-a) * b); }
static double over_below(double a, double b) { return -((-a) / b); }

/* The compiler may not see the numbers, or it would calculate itself. */
bool round_upward(void) {
  if (fesetround(FE_UPWARD) != 0) return false;
  volatile double one = 1, tiny = 0x1p-60, three = 3;
  const double up = one + tiny, down = -(-one + tiny), third = one / three, third_below = over_below(one, three);
  return up > 1 && down < 1 && third > third_below && third * three > 1 && times_below(third_below, three) < 1 && sqrt(up) > 1;
}

void round_to_nearest(void) { fesetround(FE_TONEAREST); }

/* The series of sine (first = 1) and cosine (first = 0) at 0 < x < 2, known as a range. The signs alternate, and from the
 * second term on the terms decrease, so the sums are above and below by turns. */
static range alternating_series(range x, int first) {
  range term = first ? x : (range){1, 1}, sum = term, last = sum;
  for (int k = 1; k <= 16; k++) {
    const double divisor = (2 * k - 1 + first) * (2 * k + first);
    term = (range){over_below(times_below(times_below(term.low, x.low), x.low), divisor), term.high * x.high * x.high / divisor};
    last = sum;
    sum = k % 2 ? (range){-(term.high - sum.low), sum.high - term.low} : (range){-(-sum.low - term.low), sum.high + term.high};
  }
  return (range){fmin(sum.low, last.low), fmax(sum.high, last.high)};
}

static range radians(double degrees) {
  const range pi = {0x1.921fb54442d18p1, 0x1.921fb54442d19p1};
  return (range){over_below(times_below(degrees, pi.low), 180), degrees * pi.high / 180};
}

/* Lower bound of the cotangent, 0 < degrees < 90. */
static double cot_below(double degrees) {
  const range x = radians(degrees);
  return over_below(alternating_series(x, 0).low, alternating_series(x, 1).high);
}

window window_of(double low, double high) { return (window){cot_below(low), cot_below(180 - high)}; }

/* 180 - x is exact for x between 90 and 180. */
range cosine_range(double degrees) {
  if (degrees <= 90) return alternating_series(radians(degrees), 0);
  const range c = alternating_series(radians(180 - degrees), 0);
  return (range){-c.high, -c.low};
}

/* ---- segments ---- */

bool middle_of(range r, double *middle) {
  *middle = (r.low + r.high) / 2;
  const double steps = *middle / FINE_GRID;
  return r.low < r.high && steps == floor(steps);
}

static laves__vec3 point_at(const segment *s, double share) { return v3_mad(s->origin, s->along, share); }

static int ends(const segment *s, laves__vec3 end[2]) {
  end[0] = point_at(s, s->share.low);
  end[1] = point_at(s, s->share.high);
  return s->share.low < s->share.high ? 2 : 1;
}

static double dot_above(laves__vec3 a, laves__vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static laves__vec3 negative(laves__vec3 a) { return v3(-a.x, -a.y, -a.z); }
static double dot_below(laves__vec3 a, laves__vec3 b) { return -dot_above(negative(a), b); }

/* About the unit vector of e, and certainly no longer than 1. */
static laves__vec3 short_unit(laves__vec3 e) {
  const laves__vec3 g = v3_scale(e, (1 - 0x1p-48) / sqrt(dot_above(e, e)));
  return dot_above(g, g) <= 1 ? g : v3(0, 0, 0);
}

/* ---- angles ---- */

/* What the nine coefficients are made of, at one end of a and b. */
typedef struct edge_end {
  int index[2]; /* of the end */
  laves__vec3 m, n;
  double along;     /* g . e, lower bound */
  double low, high; /* upper bounds of -cot W for the two sides of the window */
} edge_end;

/* Fills the ends; returns how many, or 0 if the volume or g . e is not certainly positive. */
static int load_ends(const segment *a, const segment *b, laves__vec3 c, laves__vec3 d, const window *w, edge_end end[4]) {
  laves__vec3 from[2], to[2];
  const int na = ends(a, from), nb = ends(b, to);
  const laves__vec3 g = short_unit(v3_sub(v3_add(to[0], to[nb - 1]), v3_add(from[0], from[na - 1])));
  int count = 0;
  for (int i = 0; i < na; i++)
    for (int j = 0; j < nb; j++) {
      const laves__vec3 e = v3_sub(to[j], from[i]), u = v3_sub(c, from[i]), v = v3_sub(d, from[i]);
      const double minus_volume = dot_above(negative(e), v3_cross(u, v));
      edge_end *p = &end[count++];
      p->index[0] = i;
      p->index[1] = j;
      p->m = v3_cross(e, u);
      p->n = v3_cross(e, v);
      p->along = dot_below(g, e);
      p->low = w->cot_low * minus_volume;
      p->high = w->cot_high * minus_volume;
      if (!(minus_volume < 0) || !(p->along > 0)) return 0;
    }
  return count;
}

/* Whether the Bernstein coefficients of both claims are not positive. */
static bool coefficients_fit(const edge_end end[4], int count) {
  double low[3][3] = {{0}}, high[3][3] = {{0}};
  for (int p = 0; p < count; p++)
    for (int q = 0; q < count; q++) {
      const int i = end[p].index[0] + end[q].index[0], j = end[p].index[1] + end[q].index[1];
      low[i][j] += dot_above(end[p].m, end[q].n) + end[p].along * end[q].low;
      high[i][j] += dot_above(negative(end[p].m), end[q].n) + end[p].along * end[q].high;
    }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      if (!(low[i][j] <= 0) || !(high[i][j] <= 0)) return false;
  return true;
}

static bool edge_inside(const segment *a, const segment *b, laves__vec3 c, laves__vec3 d, const window *w, int depth,
                        effort *spent) {
  edge_end end[4];
  const int count = load_ends(a, b, c, d, w, end);
  spent->boxes++;
  if (count > 0 && coefficients_fit(end, count)) return true;
  if (depth == 0) return false;
  const bool halve_a = a->share.high - a->share.low >= b->share.high - b->share.low;
  segment first = halve_a ? *a : *b, second = first;
  double middle;
  if (!middle_of(first.share, &middle)) return false;
  first.share.high = second.share.low = middle;
  if (halve_a) return edge_inside(&first, b, c, d, w, depth - 1, spent) && edge_inside(&second, b, c, d, w, depth - 1, spent);
  return edge_inside(a, &first, c, d, w, depth - 1, spent) && edge_inside(a, &second, c, d, w, depth - 1, spent);
}

bool angles_inside(const segment corner[4], const window *w, int depth, effort *spent) {
  /* Even permutations, so that each edge sees a positive tet. */
  static const uint8_t edge[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}};
  for (int k = 0; k < 6; k++) {
    laves__vec3 c[2], d[2];
    const int nc = ends(&corner[edge[k][2]], c), nd = ends(&corner[edge[k][3]], d);
    for (int i = 0; i < nc; i++)
      for (int j = 0; j < nd; j++) {
        spent->problems++;
        if (!edge_inside(&corner[edge[k][0]], &corner[edge[k][1]], c[i], d[j], w, 2 * depth, spent)) return false;
      }
  }
  return true;
}

/* ---- radius ratio ---- */

/* Ranges of the squared distance of two corners: convex, so largest at the ends; and at least the square of the least of
 * g . (b - a). */
static range squared_distance(const segment *a, const segment *b) {
  laves__vec3 from[2], to[2];
  const int na = ends(a, from), nb = ends(b, to);
  const laves__vec3 g = short_unit(v3_sub(v3_add(to[0], to[nb - 1]), v3_add(from[0], from[na - 1])));
  range r = {INFINITY, 0};
  for (int i = 0; i < na; i++)
    for (int j = 0; j < nb; j++) {
      const laves__vec3 e = v3_sub(to[j], from[i]);
      r.high = fmax(r.high, dot_above(e, e));
      r.low = fmin(r.low, fmax(0, dot_below(g, e)));
    }
  r.low = times_below(r.low, r.low);
  return r;
}

/* Lower bound of six times the volume, at the ends of all corners. */
static double least_volume(laves__vec3 end[4][2], const int count[4]) {
  double least = INFINITY;
  for (int k = 0; k < 16; k++) {
    const int i[4] = {k & 1, k >> 1 & 1, k >> 2 & 1, k >> 3};
    if (i[0] >= count[0] || i[1] >= count[1] || i[2] >= count[2] || i[3] >= count[3]) continue;
    const laves__vec3 a = end[0][i[0]];
    const laves__vec3 e = v3_sub(end[1][i[1]], a), u = v3_sub(end[2][i[2]], a), v = v3_sub(end[3][i[3]], a);
    least = fmin(least, dot_below(e, v3_cross(u, v)));
  }
  return least;
}

bool is_positive(const segment corner[4]) {
  laves__vec3 end[4][2];
  int count[4];
  for (int i = 0; i < 4; i++) count[i] = ends(&corner[i], end[i]);
  return least_volume(end, count) > 0;
}

/* Upper bound of twice the area of the triangle without corner `apex`: convex in each share, so largest at the ends. */
static double largest_face(laves__vec3 end[4][2], const int count[4], int apex) {
  const int a = apex == 0, b = apex <= 1 ? 2 : 1, c = apex <= 2 ? 3 : 2;
  double largest = 0;
  for (int i = 0; i < count[a]; i++)
    for (int j = 0; j < count[b]; j++)
      for (int k = 0; k < count[c]; k++) {
        const laves__vec3 n = v3_cross(v3_sub(end[b][j], end[a][i]), v3_sub(end[c][k], end[a][i]));
        largest = fmax(largest, dot_above(n, n));
      }
  return sqrt(largest);
}

/* Upper bound of 16 times the square of the area of a triangle from the ranges of its squared sides x, y, z:
 * 4 x y - (x + y - z)^2. */
static double heron_above(range x, range y, range z) {
  const double least = fmax(0, fmax(-(-x.low - y.low + z.high), -(x.high + y.high - z.low)));
  return 4 * x.high * y.high - times_below(least, least);
}

/* With W six times the volume, S twice the area and T the area of the triangle whose sides are the products of opposite
 * edges: r = W / S, R = T / W. */
static bool ratio_fits(const segment corner[4], double least) {
  laves__vec3 end[4][2];
  int count[4];
  for (int i = 0; i < 4; i++) count[i] = ends(&corner[i], end[i]);
  const double volume = least_volume(end, count);
  if (!(volume > 0)) return false;
  double area = 0;
  for (int i = 0; i < 4; i++) area += largest_face(end, count, i);
  range side[3];
  for (int i = 0; i < 3; i++) {
    const range p = squared_distance(&corner[0], &corner[i + 1]);
    const range q = squared_distance(&corner[1 + (i + 1) % 3], &corner[1 + (i + 2) % 3]);
    side[i] = (range){times_below(p.low, q.low), p.high * q.high};
  }
  double heron = INFINITY;
  for (int i = 0; i < 3; i++) heron = fmin(heron, heron_above(side[i], side[(i + 1) % 3], side[(i + 2) % 3]));
  return least * area * sqrt(heron) / 4 <= times_below(times_below(3, volume), volume);
}

bool ratio_above(const segment corner[4], double least, int depth, effort *spent) {
  spent->boxes++;
  if (ratio_fits(corner, least)) return true;
  if (depth == 0) return false;
  int widest = 0;
  for (int i = 1; i < 4; i++)
    if (corner[i].share.high - corner[i].share.low > corner[widest].share.high - corner[widest].share.low) widest = i;
  double middle;
  if (!middle_of(corner[widest].share, &middle)) return false;
  segment half[4] = {corner[0], corner[1], corner[2], corner[3]};
  half[widest].share.high = middle;
  if (!ratio_above(half, least, depth - 1, spent)) return false;
  half[widest].share = (range){middle, corner[widest].share.high};
  return ratio_above(half, least, depth - 1, spent);
}
