/* Ten-node tetrahedra: where the nodes of a mesh of second order stand, and whether they are right.
 *
 *           3                     node 4 stands on edge 01, 5 on 12, 6 on 02, 7 on 03, 8 on 13, 9 on 23: the order of VTK,
 *          /|\                    Abaqus, Exodus, Nastran and XDMF; Gmsh has 8 and 9 the other way round.
 *         / | \                   A triangle has 3 on 01, 4 on 12, 5 on 02.
 *        7  9  8
 *       /   |   \
 *      /   .2.   \
 *     / .6     5. \
 *    0------4------1
 */
#ifndef LAVES_CURVE_QUADRATIC_H
#define LAVES_CURVE_QUADRATIC_H

#include "mesh/mesh.h"

enum { LAVES__TET_NODES = 10, LAVES__FACE_NODES = 6 };

/* The corners between which nodes 4 .. 9 of a tet stand, and nodes 3 .. 5 of a triangle. */
static const uint8_t laves__mid_corners[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

/* The nodes of all tets and boundary faces with every node at the middle of its edge; nodes are numbered after the vertices, by
 * the lower and then the higher vertex of their edge. NULL with an error when memory is short, the caller cancels, or there are
 * more nodes than 32 bits can number. Free with laves__quadratic_free(). */
laves__quadratic *laves__quadratic_create(laves_context *context, const laves_mesh *mesh, laves_error *error);

/* The least coefficient in Bernstein's form of det(dx/dλ), a cubic polynomial, by the determinant of the tet with the same
 * corners and straight edges: no point of the element has a smaller share of it. 1: the edges are straight, with nodes at their
 * middles. Where the corners have no positive volume the result is negative or 0 and means nothing else. */
double laves__quadratic_least(const laves__vec3 nodes[LAVES__TET_NODES]);
/* A point of a six-node triangle. */
laves__vec3 laves__quadratic_point(const laves__vec3 nodes[LAVES__FACE_NODES], double l0, double l1, double l2);

/* ---- where nodes shall stand ---- */

/* A node on an edge of the boundary. */
typedef struct laves__bent {
  int32_t node;       /* number, as in laves__quadratic.tets */
  int32_t ends[2];    /* vertices, ascending */
  int32_t patch[2];   /* of the features, below the edge's two faces; LAVES__NO_FEATURE: not known */
  laves__vec3 middle; /* of the edge, input coordinates */
  laves__vec3 target; /* on the surface or the crease */
  bool found;         /* there is a target */
  bool on_crease;
  uint8_t halvings; /* how often the way to the target was halved; LAVES__BENT_STRAIGHT: the node stands at the middle */
} laves__bent;

enum { LAVES__BENT_STRAIGHT = 5 };

struct laves__features;

/* The patch of the features below each boundary face of the mesh, by its centroid. False on a cancel. */
bool laves__curve_patches(laves_context *context, const laves_mesh *mesh, const struct laves_domain *domain,
                          const struct laves__features *features, int32_t *patch);
/* Finds the target of each. NULL features: none are known. False when memory is short, or on a cancel. */
bool laves__curve_targets(laves_context *context, const laves_mesh *mesh, const struct laves_domain *domain,
                          const struct laves__features *features, laves__bent *bent, size_t count);

/* How far the boundary is from the surface of the domain, at samples of each face: of the mesh's triangles, and of the curved
 * ones. False when memory is short, or on a cancel. */
bool laves__curve_distances(laves_context *context, const laves_mesh *mesh, const laves__quadratic *quadratic,
                            const struct laves_domain *domain, laves_curve_report *report);

#endif
