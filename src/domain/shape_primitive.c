/* Primitive solids as formulas.  Those marked exact are signed distances.
 *
 * Sources: distance functions after Inigo Quilez, "Distance functions" (web article); level sets of periodic surfaces after
 * von Schnering and Nesper, "Nodal surfaces of Fourier series", 1991. */
#include <math.h>

#include "domain/elementary.h"
#include "domain/expression_short.h"
#include "domain/shape.h"

static const double pi = 3.14159265358979323846;

static laves__shape made(N node, laves__vec3 half, double slope, bool exact) {
  laves__shape r = laves__shape_of_node(node);
  r.box = (laves__box3){v3_scale(half, -1), half};
  r.slope = slope;
  r.exact = exact;
  return r;
}

laves__shape laves__shape_sphere(E *e, double r) {
  laves__shape s = made(plus_(e, norm3_(e, x_(e), y_(e), z_(e)), -r), v3(r, r, r), 1, true);
  s.volume = 4 * pi / 3 * r * r * r;
  s.area = 4 * pi * r * r;
  return s;
}

/* With k0 = |p / a| and k1 = |p / a^2| (by components), k0 (k0 - 1) / k1 is the distance to first order at the surface.
 * A tiny number under both roots keeps the centre inside, where it would be 0 / 0. */
laves__shape laves__shape_ellipsoid(E *e, const double a[3]) {
  const double least = min_of(a[0], min_of(a[1], a[2])), most = max_of(a[0], max_of(a[1], a[2]));
  const N p[3] = {x_(e), y_(e), z_(e)};
  N sum0 = k_(e, 1e-30), sum1 = k_(e, 1e-30 / (least * least));
  for (int i = 0; i < 3; i++) {
    sum0 = add_(e, sum0, square_(e, times_(e, p[i], 1 / a[i])));
    sum1 = add_(e, sum1, square_(e, times_(e, p[i], 1 / (a[i] * a[i]))));
  }
  const N k0 = laves__node_make(e, LAVES__OP_SQRT, sum0, 0, 0), k1 = laves__node_make(e, LAVES__OP_SQRT, sum1, 0, 0);
  laves__shape s = made(mul_(e, plus_(e, k0, -1), div_(e, k0, k1)), v3(a[0], a[1], a[2]), least / most, false);
  s.volume = 4 * pi / 3 * a[0] * a[1] * a[2];
  return s;
}

/* Distance to a corner of directions: outside sqrt(sum max(q, 0)^2), inside the largest q. */
static N corner(E *e, N q0, N q1, N q2) {
  const N zero = k_(e, 0);
  const N outside = norm3_(e, max_(e, q0, zero), max_(e, q1, zero), max_(e, q2, zero));
  return add_(e, outside, min_(e, max_(e, q0, max_(e, q1, q2)), zero));
}

laves__shape laves__shape_box(E *e, const double w[3], double r) {
  const N p[3] = {x_(e), y_(e), z_(e)};
  N q[3];
  for (int i = 0; i < 3; i++) q[i] = plus_(e, abs_(e, p[i]), r - w[i] / 2);
  laves__shape s = made(plus_(e, corner(e, q[0], q[1], q[2]), -r), v3(w[0] / 2, w[1] / 2, w[2] / 2), 1, true);
  const double a = w[0] - 2 * r, b = w[1] - 2 * r, c = w[2] - 2 * r; /* Steiner's formula */
  s.volume = a * b * c + 2 * r * (a * b + b * c + c * a) + pi * r * r * (a + b + c) + 4 * pi / 3 * r * r * r;
  s.area = 2 * (a * b + b * c + c * a) + 2 * pi * r * (a + b + c) + 4 * pi * r * r;
  return s;
}

laves__shape laves__shape_cylinder(E *e, double r, double h) {
  const N side = plus_(e, norm2_(e, x_(e), y_(e)), -r);
  if (isinf(h)) return made(side, v3(r, r, INFINITY), 1, true);
  const N end = plus_(e, abs_(e, z_(e)), -h / 2), zero = k_(e, 0);
  const N outside = norm2_(e, max_(e, side, zero), max_(e, end, zero));
  laves__shape s = made(add_(e, outside, min_(e, max_(e, side, end), zero)), v3(r, r, h / 2), 1, true);
  s.volume = pi * r * r * h;
  s.area = 2 * pi * r * (r + h);
  return s;
}

laves__shape laves__shape_capsule(E *e, double r, double h) {
  const N beyond = max_(e, plus_(e, abs_(e, z_(e)), -h / 2), k_(e, 0));
  laves__shape s = made(plus_(e, norm3_(e, x_(e), y_(e), beyond), -r), v3(r, r, r + h / 2), 1, true);
  s.volume = pi * r * r * (h + 4 * r / 3);
  s.area = 2 * pi * r * (h + 2 * r);
  return s;
}

laves__shape laves__shape_cone(E *e, double r1, double r2, double h) {
  const double growth = (r2 - r1) / h, cosine = 1 / sqrt(1 + growth * growth), widest = max_of(r1, r2);
  const N radius = plus_(e, times_(e, z_(e), growth), 0.5 * (r1 + r2));
  const N side = times_(e, sub_(e, norm2_(e, x_(e), y_(e)), radius), cosine);
  const N end = plus_(e, abs_(e, z_(e)), -h / 2);
  /* Beyond an end and beside the widest circle, the two values grow against one another. */
  laves__shape s = made(max_(e, side, end), v3(widest, widest, h / 2), cosine / (1 + cosine * fabs(growth)), false);
  s.volume = pi * h / 3 * (r1 * r1 + r1 * r2 + r2 * r2);
  s.area = pi * (r1 * r1 + r2 * r2 + (r1 + r2) * hypot(h, r1 - r2));
  return s;
}

laves__shape laves__shape_torus(E *e, double centre_r, double tube_r) {
  const N ring = plus_(e, norm2_(e, x_(e), y_(e)), -centre_r);
  const double reach = centre_r + tube_r;
  laves__shape s = made(plus_(e, norm2_(e, ring, z_(e)), -tube_r), v3(reach, reach, tube_r), 1, true);
  if (tube_r <= centre_r) {
    s.volume = 2 * pi * pi * centre_r * tube_r * tube_r;
    s.area = 4 * pi * pi * centre_r * tube_r;
  } else {
    s.exact = false; /* a spindle: inside, the nearest surface may be across the axis */
  }
  return s;
}

laves__shape laves__shape_halfspace(E *e, laves__vec3 normal, double offset) {
  const laves__vec3 n = v3_unit(normal);
  N sum = times_(e, x_(e), n.x);
  sum = add_(e, sum, times_(e, y_(e), n.y));
  sum = add_(e, sum, times_(e, z_(e), n.z));
  laves__shape s = laves__shape_of_node(plus_(e, sum, -offset));
  s.exact = true;
  for (int i = 0; i < 3; i++) { /* along an axis one side is bounded */
    const double along = v3_at(n, i);
    if (fabs(along) != 1) continue;
    s.slope = 1;
    *(along > 0 ? v3_slot(&s.box.upper, i) : v3_slot(&s.box.lower, i)) = offset * along;
  }
  return s;
}

/* -log(sum exp(-k q)) / k with q = (|p - c| / r)^2 - 1, which is q itself for one ball. n balls at one place are as large as one
 * with q = log(n) / k, which bounds them; scaled by half the mean radius for a slope near one. */
laves__shape laves__shape_metaballs(E *e, const laves__ball *balls, size_t count, double k) {
  const double growth = sqrt(1 + log((double)count) / k);
  N sum = k_(e, 0);
  double mean = 0, slope = INFINITY;
  laves__box3 box = box3_empty();
  for (size_t i = 0; i < count; i++) {
    const laves__ball b = balls[i];
    const N dx = plus_(e, x_(e), -b.centre.x), dy = plus_(e, y_(e), -b.centre.y), dz = plus_(e, z_(e), -b.centre.z);
    const N d2 = add_(e, add_(e, square_(e, dx), square_(e, dy)), square_(e, dz));
    sum = add_(e, sum, exp_(e, plus_(e, times_(e, d2, -k / (b.r * b.r)), k)));
    mean += b.r / (double)count;
    const double reach = b.r * growth;
    slope = min_of(slope, 2 * reach / (b.r * b.r));
    box = box3_add(box3_add(box, v3_sub(b.centre, v3(reach, reach, reach))), v3_add(b.centre, v3(reach, reach, reach)));
  }
  laves__shape s = laves__shape_of_node(times_(e, log_(e, sum), -0.5 * mean / k));
  s.box = box;
  s.slope = slope * 0.5 * mean;
  return s;
}

/* ---- periodic surfaces ---- */

typedef struct waves {
  N s[3], c[3];   /* sine and cosine of the three coordinates */
  N s2[3], c2[3]; /* of twice the coordinates */
} waves;

/* a0 b1 + a1 b2 + a2 b0 and the like: the sum over cyclic shifts of a[0] b[1] (c[2]). */
static N cyclic2(E *e, const N a[3], const N b[3]) {
  return add_(e, add_(e, mul_(e, a[0], b[1]), mul_(e, a[1], b[2])), mul_(e, a[2], b[0]));
}
static N cyclic3(E *e, const N a[3], const N b[3], const N c[3]) {
  const N p = mul_(e, mul_(e, a[0], b[1]), c[2]), q = mul_(e, mul_(e, a[1], b[2]), c[0]), r = mul_(e, mul_(e, a[2], b[0]), c[1]);
  return add_(e, add_(e, p, q), r);
}
static N sum3(E *e, const N a[3]) { return add_(e, add_(e, a[0], a[1]), a[2]); }
static N product3(E *e, const N a[3]) { return mul_(e, mul_(e, a[0], a[1]), a[2]); }

static N tpms_value(E *e, laves__tpms kind, const waves *w) {
  switch (kind) {
    case LAVES__TPMS_gyroid:
      return cyclic2(e, w->s, w->c);
    case LAVES__TPMS_schwarz_p:
      return sum3(e, w->c);
    case LAVES__TPMS_schwarz_d:
      return sub_(e, product3(e, w->c), product3(e, w->s));
    case LAVES__TPMS_neovius:
      return add_(e, times_(e, sum3(e, w->c), 3), times_(e, product3(e, w->c), 4));
    case LAVES__TPMS_iwp:
      return sub_(e, times_(e, cyclic2(e, w->c, w->c), 2), sum3(e, w->c2));
    case LAVES__TPMS_frd:
      return sub_(e, times_(e, product3(e, w->c), 4), cyclic2(e, w->c2, w->c2));
    case LAVES__TPMS_lidinoid:
      return plus_(e, times_(e, sub_(e, cyclic3(e, w->s2, w->c, w->s), cyclic2(e, w->c2, w->c2)), 0.5), 0.15);
    default:
      return cyclic3(e, w->c2, w->s, w->c); /* fischer_koch_s */
  }
}

/* Mean length of the gradient over the surface of level 0, for period 2 pi; measured by tests/unit/test_shape.c. */
static const double tpms_slope[LAVES__TPMS_COUNT] = {1.531, 1.337, 1.059, 2.915, 4.339, 3.769, 1.539, 1.798};

laves__shape laves__shape_tpms(E *e, laves__tpms kind, double period, double thickness, double level) {
  const N p[3] = {x_(e), y_(e), z_(e)};
  waves w;
  for (int i = 0; i < 3; i++) {
    const N a = times_(e, p[i], 2 * pi / period);
    w.s[i] = sin_(e, a);
    w.c[i] = cos_(e, a);
    w.s2[i] = times_(e, mul_(e, w.s[i], w.c[i]), 2);
    w.c2[i] = plus_(e, times_(e, square_(e, w.c[i]), 2), -1);
  }
  const double scale = period / (2 * pi * tpms_slope[kind]);
  const N value = times_(e, plus_(e, tpms_value(e, kind, &w), -level), scale);
  return laves__shape_of_node(thickness > 0 ? plus_(e, abs_(e, value), -thickness / 2) : value);
}
