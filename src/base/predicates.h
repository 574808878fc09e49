/* Exact geometric predicates: floating-point filter, then expansions.  [shewchuk1997] */
#ifndef LAVES_BASE_PREDICATES_H
#define LAVES_BASE_PREDICATES_H

#include "base/vec3.h"

/* The sign (-1, 0, 1) of det[b-a, c-a, d-a], exactly, for finite coordinates whose products neither overflow nor
 * underflow. 1 for a positive tetrahedron. */
int laves__orient3d(laves__vec3 a, laves__vec3 b, laves__vec3 c, laves__vec3 d);

/* A plane through three points, for asking of many points on which side they lie. */
typedef struct laves__plane {
  laves__vec3 a, b, c;
  laves__vec3 normal, permanent; /* of which the determinant and the bound of its error are made */
} laves__plane;

laves__plane laves__plane_of(laves__vec3 a, laves__vec3 b, laves__vec3 c);
/* laves__orient3d(a, b, c, d), mostly in a fifth of the time. */
int laves__plane_side(const laves__plane *plane, laves__vec3 d);

#endif
