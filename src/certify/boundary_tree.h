/* Nearest points on triangles: a box tree that only the checks use. */
#ifndef LAVES_CERTIFY_BOUNDARY_TREE_H
#define LAVES_CERTIFY_BOUNDARY_TREE_H

#include "certify/certify.h"

typedef struct laves__boundary_tree laves__boundary_tree;

/* Over the triangles of a boundary, their points taken relative to `origin`. Triangles that are not finite are left out.
 * edges: of laves__local_edges(), whose levels are over `base`; NULL: all are level 0.
 * *tree: free with laves__boundary_tree_free(); both arrays must stay until then. */
laves_result laves__boundary_tree_build(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                        laves__vec3 origin, const float *edges, double base, laves__boundary_tree **tree,
                                        laves_error *error);
void laves__boundary_tree_free(laves__boundary_tree *tree);

/* The distance from a point (relative to `origin`) to the nearest triangle; INFINITY when there is none. The answer must be
 * known not to exceed `bound`, which may be INFINITY. *edge: its local edge; left as it is when the bound itself is the answer.
 * *near: in: LAVES__NO_TRIANGLE, or what an earlier call gave for a point near by, which makes the search quick and does not
 * change its answer; out: which triangle it was, as the next call may be told. */
#define LAVES__NO_TRIANGLE SIZE_MAX
double laves__boundary_tree_distance(const laves__boundary_tree *tree, laves__vec3 point, double bound, float *edge,
                                     size_t *near);

/* The least and the greatest level of all edges. */
void laves__boundary_tree_levels(const laves__boundary_tree *tree, int *least, int *greatest);

/* The least level of the edges in a ball, or a little beyond it; 0 where there are none. */
int laves__boundary_tree_level(const laves__boundary_tree *tree, laves__vec3 point, double radius);

#endif
