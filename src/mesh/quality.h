/* Shape of one tetrahedron, the measures used all over. Pure functions. */
#ifndef LAVES_MESH_QUALITY_H
#define LAVES_MESH_QUALITY_H

#include "base/vec3.h"

/* Cosines of the six dihedral angles, in the order of laves__tet_edge (01 02 03 12 13 23). Undefined (maybe NaN) when a
 * face has no area. */
void laves__tet_dihedral_cosines(const laves__vec3 p[4], double cosines[6]);
/* sqrt(2) 6V / (root mean square of the edges)^3: 1 regular, 0 flat, negative inverted. [parthasarathy1994] */
double laves__tet_volume_length(const laves__vec3 p[4]);
/* 3 r / R: inradius over circumradius, 1 regular, 0 flat. */
double laves__tet_radius_ratio(const laves__vec3 p[4]);
/* R / shortest edge, divided by the regular tetrahedron's sqrt(6)/4: 1 regular and up. */
double laves__tet_radius_edge(const laves__vec3 p[4]);

#endif
