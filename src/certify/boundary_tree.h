/* Nearest points on triangles: a box tree that only the checks use. */
#ifndef LAVES_CERTIFY_BOUNDARY_TREE_H
#define LAVES_CERTIFY_BOUNDARY_TREE_H

#include "certify/certify.h"

typedef struct laves__boundary_tree laves__boundary_tree;

/* Over the triangles of a boundary, their points taken relative to `origin`. Triangles that are not finite are left out.
 * *tree: free with laves__boundary_tree_free(); both arrays must stay until then. */
laves_result laves__boundary_tree_build(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                        laves__vec3 origin, laves__boundary_tree **tree, laves_error *error);
void laves__boundary_tree_free(laves__boundary_tree *tree);

/* The distance from a point (relative to `origin`) to the nearest triangle; INFINITY when there is none. The answer must be
 * known not to exceed `bound`, which may be INFINITY. */
double laves__boundary_tree_distance(const laves__boundary_tree *tree, laves__vec3 point, double bound);

#endif
