/* Combining and changing solids, with what is known about them carried along.
 *
 * The rule behind the boxes (shape.h: value >= slope * distance to the box, in the largest coordinate difference):
 * the maximum of two solids obeys it for the intersection of their boxes, the minimum for the hull, since in that metric
 * the distance to an intersection of boxes is the larger of the two distances. Smooth blends differ from the sharp ones by at
 * most width / 6, so they are an offset of them. */
#include "domain/shape.h"

#include <math.h>

#include "domain/elementary.h"
#include "domain/expression_short.h"
#include "domain/kept.h"

static laves__box3 all_space(void) { return (laves__box3){{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}}; }

bool laves__box3_is_finite(laves__box3 box) { return v3_finite(box.lower) && v3_finite(box.upper); }

laves__shape laves__shape_of_node(laves__node node) {
  return (laves__shape){.node = node, .box = all_space(), .slope = INFINITY, .volume = NAN, .area = NAN};
}

static laves__box3 box_hull(laves__box3 a, laves__box3 b) {
  return (laves__box3){v3_min(a.lower, b.lower), v3_max(a.upper, b.upper)};
}

/* Where the boxes miss one another along an axis, the middle of the gap keeps the rule true. */
static void meet_axis(double *lower, double *upper) {
  if (*lower > *upper) *lower = *upper = 0.5 * *lower + 0.5 * *upper;
}

static laves__box3 box_meet(laves__box3 a, laves__box3 b) {
  laves__box3 r = {v3_max(a.lower, b.lower), v3_min(a.upper, b.upper)};
  meet_axis(&r.lower.x, &r.upper.x);
  meet_axis(&r.lower.y, &r.upper.y);
  meet_axis(&r.lower.z, &r.upper.z);
  return r;
}

static laves__box3 box_grown(laves__box3 a, double by) {
  const laves__vec3 d = v3(by, by, by);
  laves__box3 r = {v3_sub(a.lower, d), v3_add(a.upper, d)};
  return box_meet(r, r); /* shrunk past its middle: a point */
}

laves__shape laves__shape_complement(E *e, const laves__shape *a) {
  laves__shape r = laves__shape_of_node(neg_(e, a->node));
  r.exact = a->exact;
  r.kept = a->kept;
  return r;
}

laves__shape laves__shape_boolean(E *e, laves__boolean kind, const laves__shape *a, const laves__shape *b) {
  if (kind == LAVES__DIFFERENCE) {
    const laves__shape outside = laves__shape_complement(e, b);
    return laves__shape_boolean(e, LAVES__INTERSECTION, a, &outside);
  }
  laves__shape r = laves__shape_of_node(LAVES__NO_NODE);
  r.slope = min_of(a->slope, b->slope);
  if (kind == LAVES__UNION) {
    r.node = min_(e, a->node, b->node);
    r.box = box_hull(a->box, b->box);
  } else {
    r.node = max_(e, a->node, b->node);
    r.box = box_meet(a->box, b->box);
  }
  r.kept = laves__kept_both(e, a->kept, b->kept);
  return r;
}

laves__shape laves__shape_offset(E *e, const laves__shape *a, double distance) {
  laves__shape r = *a;
  r.node = plus_(e, a->node, -distance);
  r.box = box_grown(a->box, distance > 0 ? distance / a->slope : 0);
  r.exact = false;
  r.volume = r.area = NAN;
  r.kept = 0;
  return r;
}

laves__shape laves__shape_blend(E *e, laves__boolean kind, const laves__shape *a, const laves__shape *b, double width) {
  if (kind == LAVES__DIFFERENCE) {
    const laves__shape outside = laves__shape_complement(e, b);
    return laves__shape_blend(e, LAVES__INTERSECTION, a, &outside, width);
  }
  laves__shape r = laves__shape_boolean(e, kind, a, b);
  if (!(width > 0)) return r;
  /* h = max(0, 1 - |a - b| / width); the bulge h^3 width / 6 meets the sharp surfaces with two derivatives. */
  const N h = max_(e, plus_(e, times_(e, abs_(e, sub_(e, a->node, b->node)), -1 / width), 1), k_(e, 0));
  const N bulge = times_(e, mul_(e, h, square_(e, h)), width / 6);
  const laves__shape grown = laves__shape_offset(e, &r, width / 6);
  r.node = kind == LAVES__UNION ? sub_(e, r.node, bulge) : add_(e, r.node, bulge);
  if (kind == LAVES__UNION) r.box = grown.box;
  return r;
}

laves__shape laves__shape_shell(E *e, const laves__shape *a, double thickness) {
  laves__shape r = *a;
  r.node = plus_(e, abs_(e, plus_(e, a->node, thickness / 2)), -thickness / 2);
  r.exact = false;
  r.volume = r.area = NAN;
  return r;
}

laves__shape laves__shape_morph(E *e, const laves__shape *a, const laves__shape *b, double t) {
  laves__shape r = laves__shape_of_node(add_(e, times_(e, a->node, 1 - t), times_(e, b->node, t)));
  r.box = box_hull(a->box, b->box);
  r.slope = min_of(a->slope, b->slope);
  return r;
}

laves__shape laves__shape_bounded(E *e, const laves__shape *a, laves__box3 box) {
  const laves__vec3 widths = v3_sub(box.upper, box.lower);
  const laves__shape centred = laves__shape_box(e, (double[]){widths.x, widths.y, widths.z}, 0);
  const laves__shape limit = laves__shape_move(e, &centred, box3_centre(box));
  return laves__shape_boolean(e, LAVES__INTERSECTION, a, &limit);
}

/* ---- moving ---- */

static double times_bound(double factor, double bound) { return factor == 0 ? 0 : factor * bound; }

/* The box around the image of a box; infinite sides stay infinite where they matter. */
static laves__box3 box_image(laves__box3 box, const laves__affine *map) {
  laves__box3 image = {map->t, map->t};
  for (int i = 0; i < 3; i++) {
    double *image_lower = v3_slot(&image.lower, i), *image_upper = v3_slot(&image.upper, i);
    for (int k = 0; k < 3; k++) {
      const double factor = v3_at(map->m.row[i], k), lower = v3_at(box.lower, k), upper = v3_at(box.upper, k);
      *image_lower += times_bound(factor, factor > 0 ? lower : upper);
      *image_upper += times_bound(factor, factor > 0 ? upper : lower);
    }
  }
  return image;
}

static bool keeps_axes(const laves__mat3 *m) {
  int entries = 0;
  for (int i = 0; i < 3; i++) entries += (m->row[i].x != 0) + (m->row[i].y != 0) + (m->row[i].z != 0);
  return entries == 3;
}

/* The image of a solid under `map`, whose inverse is given; its stretches lie between `least` and `most`. */
static laves__shape transformed(E *e, const laves__shape *a, const laves__affine *map, const laves__affine *inverse, double least,
                                double most) {
  laves__shape r = *a;
  r.node = times_(e, laves__node_affine(e, a->node, inverse), least);
  r.box = box_image(a->box, map);
  /* Turning a box makes coordinate differences up to sqrt(3) larger. */
  r.slope = a->slope * least / (most * (keeps_axes(&map->m) ? 1 : 1.7320508075688774));
  r.exact = a->exact && least == most;
  r.kept = laves__kept_moved(e, a->kept, map);
  return r;
}

laves__shape laves__shape_move(E *e, const laves__shape *a, laves__vec3 by) {
  laves__affine map = laves__affine_identity(), inverse = map;
  map.t = by;
  inverse.t = v3_scale(by, -1);
  return transformed(e, a, &map, &inverse, 1, 1);
}

/* Sine and cosine that are exact at quarter turns, so that turned boxes keep their axes. */
static void turn(double angle, double *s, double *c) {
  const double quarters = angle / 1.57079632679489661923, nearest = round_near(quarters);
  *s = sin_of(angle);
  *c = cos_of(angle);
  if (fabs(quarters - nearest) > 1e-14 * (1 + fabs(quarters))) return;
  *s = round_near(*s);
  *c = round_near(*c);
}

/* Rodrigues: R = c I + s [u]x + (1 - c) u u^T */
static laves__mat3 rotation(laves__vec3 u, double angle) {
  double s, c;
  turn(angle, &s, &c);
  const double d = 1 - c;
  return (laves__mat3){{{c + d * u.x * u.x, d * u.x * u.y - s * u.z, d * u.x * u.z + s * u.y},
                        {d * u.y * u.x + s * u.z, c + d * u.y * u.y, d * u.y * u.z - s * u.x},
                        {d * u.z * u.x - s * u.y, d * u.z * u.y + s * u.x, c + d * u.z * u.z}}};
}

laves__shape laves__shape_rotate(E *e, const laves__shape *a, laves__vec3 axis, double angle) {
  laves__affine map = laves__affine_identity(), inverse = map;
  map.m = rotation(v3_unit(axis), angle);
  inverse.m = rotation(v3_unit(axis), -angle);
  return transformed(e, a, &map, &inverse, 1, 1);
}

laves__shape laves__shape_scale(E *e, const laves__shape *a, laves__vec3 factors) {
  laves__affine map = laves__affine_identity(), inverse = map;
  const double x = fabs(factors.x), y = fabs(factors.y), z = fabs(factors.z);
  for (int i = 0; i < 3; i++) {
    *v3_slot(&map.m.row[i], i) = v3_at(factors, i);
    *v3_slot(&inverse.m.row[i], i) = 1 / v3_at(factors, i);
  }
  const double least = min_of(x, min_of(y, z)), most = max_of(x, max_of(y, z));
  laves__shape r = transformed(e, a, &map, &inverse, least, most);
  r.volume = a->volume * x * y * z;
  r.area = least == most ? a->area * x * x : NAN;
  return r;
}

laves__shape laves__shape_mirror(E *e, const laves__shape *a, laves__vec3 normal) {
  const laves__vec3 n = v3_unit(normal);
  laves__affine map = laves__affine_identity();
  for (int i = 0; i < 3; i++) map.m.row[i] = v3_mad(map.m.row[i], n, -2 * v3_at(n, i));
  return transformed(e, a, &map, &map, 1, 1);
}
