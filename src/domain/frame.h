/* The frame in which the lattice lies: centred on the domain, turned as wished, scaled so that the mean edge is 1.
 *
 *     local = centre + size * rotation * lattice        input = local + oracle->origin
 *
 * All work between classify and the final mesh is done in lattice coordinates, so every tolerance is a share of the
 * size, and a part a kilometre from the zero point or a micrometre wide is meshed as well as any other. */
#ifndef LAVES_DOMAIN_FRAME_H
#define LAVES_DOMAIN_FRAME_H

#include "domain/oracle.h"

typedef struct laves__frame {
  const laves__oracle *oracle;
  const struct laves__features *features; /* that are kept; NULL: none */
  laves__vec3 centre;                     /* local coordinates of the lattice's zero point */
  laves__mat3 rotation;
  double size;
  bool face_sources; /* boundary faces of the mesh shall know the nearest face of the input, as laves_options tells */
} laves__frame;

laves__vec3 laves__frame_to_local(const laves__frame *frame, laves__vec3 lattice);
laves__vec3 laves__frame_from_local(const laves__frame *frame, laves__vec3 local);
laves__vec3 laves__frame_to_input(const laves__frame *frame, laves__vec3 lattice);

/* The axis-aligned box in lattice coordinates around the oracle's bounds. */
laves__box3 laves__frame_bounds(const laves__frame *frame);

/* phi of the oracle at lattice points, in units of the size. Any count. See laves__oracle.evaluate. */
void laves__frame_evaluate(const laves__frame *frame, size_t count, const laves__vec3 *points, double *phi, uint32_t *hints);

/* See laves__oracle.project; everything in lattice coordinates. */
bool laves__frame_project(const laves__frame *frame, laves__vec3 point, double reach, uint32_t *hint, laves__vec3 *foot,
                          laves__vec3 *normal);

/* Many at once; see laves__project_many. */
void laves__frame_project_many(const laves__frame *frame, size_t count, const laves__vec3 *points, double reach,
                               laves__projection *answers);

/* See laves__oracle.side: for the lattice box centre +- half in each axis. */
laves__side laves__frame_side(const laves__frame *frame, laves__vec3 centre, double half);

/* The rotation whose columns are the principal axes of the solid, longest first along x; the identity when the solid has
 * no points among the samples. Deterministic: a fixed set of quasi-random samples. */
laves__mat3 laves__principal_axes(const laves__oracle *oracle);

/* The volume of the solid: the oracle's where it knows it, else quasi-Monte Carlo in the cells of an octree that the
 * surface may cross (paper, section 4.2); relative error below about 0.5 % for compact solids.
 * Reports progress; after a cancel the result means nothing. */
double laves__domain_volume(laves_context *context, const laves__oracle *oracle);
/* The area of its surface, if need be from some thousand samples: within a tenth where no part is thinner than a hundredth of the
 * diagonal. After a cancel, or when memory is short, anything. */
double laves__domain_area(laves_context *context, const laves__oracle *oracle);

#endif
