/* Solids as expressions that know more than their value: where they are, how fast they grow, whether they are distances.
 *
 * Every maker takes a store of expressions and returns a shape; a failure is a shape whose node is LAVES__NO_NODE, with
 * the reason in the store. Lengths are in the units of the input, angles in radians. Primitives are centred at the origin. */
#ifndef LAVES_DOMAIN_SHAPE_H
#define LAVES_DOMAIN_SHAPE_H

#include "domain/expression.h"

typedef struct laves__shape {
  laves__node node; /* negative inside */
  /* Outside of the box, node >= slope * (distance to the box, largest coordinate difference), so an offset knows how
   * far the solid may grow. Sides may be infinite; the box of all space has slope INFINITY. */
  laves__box3 box;
  double slope;
  bool exact;          /* node is the signed distance to the surface */
  double volume, area; /* exact, or NAN */
  uint32_t kept;       /* points and lines of its surface that go with it; see kept.h; 0: none */
} laves__shape;

/* A solid about which nothing is known but its value. */
laves__shape laves__shape_of_node(laves__node node);

/* ---- primitives (shape_primitive.c) ---- */

laves__shape laves__shape_sphere(laves__expression *e, double r);
laves__shape laves__shape_ellipsoid(laves__expression *e, const double half_axes[3]);
/* By full widths; the edges are rounded by r, which the widths include. */
laves__shape laves__shape_box(laves__expression *e, const double widths[3], double r);
/* Along z; h INFINITY: endless. */
laves__shape laves__shape_cylinder(laves__expression *e, double r, double h);
/* Along z: all points within r of a segment of length h. */
laves__shape laves__shape_capsule(laves__expression *e, double r, double h);
/* Along z: radius r1 at -h/2, r2 at h/2. */
laves__shape laves__shape_cone(laves__expression *e, double r1, double r2, double h);
/* Around z: radius of the centre line, radius of the tube. */
laves__shape laves__shape_torus(laves__expression *e, double centre_r, double tube_r);
/* The points with normal . p <= offset; the normal need not have unit length, but must not be zero. */
laves__shape laves__shape_halfspace(laves__expression *e, laves__vec3 normal, double offset);

typedef struct laves__ball {
  laves__vec3 centre;
  double r;
} laves__ball;
/* Balls that flow together: each alone is a ball of its radius. `sharpness` > 0: larger, less flow. */
laves__shape laves__shape_metaballs(laves__expression *e, const laves__ball *balls, size_t count, double sharpness);

/* Triply periodic minimal surfaces, by level sets: X(name). */
#define LAVES__TPMS_LIST(X) X(gyroid) X(schwarz_p) X(schwarz_d) X(neovius) X(iwp) X(frd) X(lidinoid) X(fischer_koch_s)
typedef enum laves__tpms {
#define LAVES__TPMS_ENUM(name) LAVES__TPMS_##name,
  LAVES__TPMS_LIST(LAVES__TPMS_ENUM)
#undef LAVES__TPMS_ENUM
      LAVES__TPMS_COUNT
} laves__tpms;
/* The side where the level set function is below `level`; scaled so that the mean slope on the surface is about one.
 * thickness > 0: the sheet of about that thickness around the surface instead. */
laves__shape laves__shape_tpms(laves__expression *e, laves__tpms kind, double period, double thickness, double level);

/* ---- combining and changing (shape.c) ---- */

typedef enum laves__boolean { LAVES__UNION, LAVES__INTERSECTION, LAVES__DIFFERENCE } laves__boolean;
laves__shape laves__shape_boolean(laves__expression *e, laves__boolean kind, const laves__shape *a, const laves__shape *b);
/* Rounded where the two surfaces are within `width` of one another; twice differentiable. Width 0: sharp. */
laves__shape laves__shape_blend(laves__expression *e, laves__boolean kind, const laves__shape *a, const laves__shape *b,
                                double width);
laves__shape laves__shape_complement(laves__expression *e, const laves__shape *a);
/* Grown by `distance` (shrunk if negative), as far as the value is a distance. */
laves__shape laves__shape_offset(laves__expression *e, const laves__shape *a, double distance);
/* The wall of that thickness inside the surface. */
laves__shape laves__shape_shell(laves__expression *e, const laves__shape *a, double thickness);
/* (1 - t) a + t b */
laves__shape laves__shape_morph(laves__expression *e, const laves__shape *a, const laves__shape *b, double t);
/* Cut to a box, which is then its bounds. */
laves__shape laves__shape_bounded(laves__expression *e, const laves__shape *a, laves__box3 box);

laves__shape laves__shape_move(laves__expression *e, const laves__shape *a, laves__vec3 by);
laves__shape laves__shape_rotate(laves__expression *e, const laves__shape *a, laves__vec3 axis, double angle);
/* Factors other than zero; unequal ones scale the value by the least, so that it stays a bound of the distance. */
laves__shape laves__shape_scale(laves__expression *e, const laves__shape *a, laves__vec3 factors);
/* In the plane through the origin with this normal. */
laves__shape laves__shape_mirror(laves__expression *e, const laves__shape *a, laves__vec3 normal);

bool laves__box3_is_finite(laves__box3 box);

#endif
