/* The edges of a boundary, each once, and the nearest of them to a point. */
#ifndef LAVES_CERTIFY_BOUNDARY_EDGES_H
#define LAVES_CERTIFY_BOUNDARY_EDGES_H

#include "certify/certify.h"
#include "domain/surface.h"

typedef struct laves__boundary_edges {
  laves_context *context;
  size_t count;
  int32_t (*ends)[2];   /* the lower first; ascending by the lower, then by the upper */
  uint32_t (*faces)[2]; /* of the boundary, two of those at the edge; the same twice where there is but one */
  float *turn;          /* degrees between the normals of the two faces; NAN: there are not two, or one has no area */
  double mean;          /* length */
  laves__vec3 *point;   /* [vertex_count] relative to `origin`; only those of edges are set */
  size_t vertex_count;
  laves__bvh tree;     /* over the edges whose ends are finite, as triangles of two equal corners */
  uint32_t *slot_edge; /* [tree.count] */
  size_t slot_count;
} laves__boundary_edges;

/* *edges: free whatever is returned. */
laves_result laves__boundary_edges_find(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                        laves__vec3 origin, laves__boundary_edges *edges, laves_error *error);
void laves__boundary_edges_free(laves__boundary_edges *edges);

/* The nearest edge to a point (relative to `origin`) that is no further than `reach`, and its distance; LAVES__NONE: there is
 * none. wanted: bool[count], which edges count; NULL: all. */
uint32_t laves__boundary_edges_nearest(const laves__boundary_edges *edges, laves__vec3 point, double reach, const bool *wanted,
                                       double *distance);

/* The number of the edge between two vertices, or LAVES__NONE. */
uint32_t laves__boundary_edges_between(const laves__boundary_edges *edges, int32_t a, int32_t b);

#endif
