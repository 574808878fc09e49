/* The shape of one tetrahedron, for pictures and plots, from the corners of a mesh. */
#ifndef LAVES_CLI_TET_SHAPE_H
#define LAVES_CLI_TET_SHAPE_H

#include <laves/laves.h>

/* Faces of a positive tetrahedron, outwards; face i is opposite corner i. */
extern const int tet_face[4][3];

void tet_corners(const laves_mesh *mesh, int64_t tet, double p[4][3]);

/* The six dihedral angles, degrees. */
void tet_dihedral_angles(double p[4][3], double angles[6]);
/* How near they are to the tiling's: 1 when all lie in [60, 75] degrees, 0 when the tetrahedron is flat. */
double tet_dihedral_score(double p[4][3]);
/* sqrt of the mean squared edge. */
double tet_edge_length(double p[4][3]);
/* sqrt(2) 6V / rms(edge)^3: 1 for the regular tetrahedron, at least 0. */
double tet_volume_length(double p[4][3]);
/* 3 r / R, inradius over circumradius: 1 for the regular tetrahedron, 0 for a flat one. */
double tet_radius_ratio(double p[4][3]);
/* R / shortest edge, over the regular tetrahedron's: 1 and up; INFINITY for a flat one. */
double tet_radius_edge(double p[4][3]);

#endif
