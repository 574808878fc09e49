/* What the files of the surface oracle share: the welded surface, its tree, its topology.
 *
 *   surface.c           the story: weld -> tree -> topology -> direction -> crossings -> oracle
 *   surface_weld.c      equal points become one, degenerate and repeated faces go
 *   surface_topology.c  faces across edges, fans, components, normals
 *   surface_bvh.c       the tree and the nearest triangle
 *   surface_oracle.c    sign, distance, projection
 *
 * Coordinates are local everywhere: input minus origin. */
#ifndef LAVES_DOMAIN_SURFACE_H
#define LAVES_DOMAIN_SURFACE_H

#include "base/base.h"
#include "base/vec3.h"
#include "domain/oracle.h"
#include "domain/surface_input.h"

#define LAVES__NONE UINT32_MAX

/* Faces are counted in 28 bits inside the tree. */
enum { LAVES__FACES_MAX = 1 << 28, LAVES__LEAF_MAX = 4, LAVES__BVH_STACK = 256 };

/* ---- tree ---- */

/* A triangle as queries like it: corners and the dual basis, so that the barycentric coordinates of a point's foot in the
 * plane are dot(p - a, dual_b) and dot(p - a, dual_c). The dual of a triangle without area is NAN. */
typedef struct laves__triangle {
  laves__vec3 a, b, c, dual_b, dual_c;
} laves__triangle;

/* Four boxes, rounded outwards, in the units of the tree (lengths times `scale`, so about 1 wide). A child is the index of
 * a node, or LAVES__LEAF_BIT | (count - 1) << 28 | first slot. Unused boxes are far away and their child is a leaf. */
#define LAVES__LEAF_BIT 0x80000000u
typedef struct laves__bvh_node {
  float lower[3][4], upper[3][4];
  uint32_t child[4];
} laves__bvh_node;

typedef struct laves__bvh {
  laves__bvh_node *nodes;
  size_t node_count, node_capacity;
  laves__triangle *triangles; /* in the order of the leaves */
  size_t count;
  double scale; /* a power of two */
} laves__bvh;

/* Builds the tree over faces; order[slot] receives the face that stands at each slot. False when memory is short. */
bool laves__bvh_build(laves_context *context, const laves__vec3 *points, const uint32_t (*faces)[3], size_t face_count,
                      uint32_t *order, laves__bvh *bvh);
void laves__bvh_free(laves_context *context, laves__bvh *bvh);

/* Where on a triangle the closest point lies: 0 its inside, 1 2 3 the edges ab bc ca, 4 5 6 the corners a b c. */
enum { LAVES__ON_FACE = 0, LAVES__ON_EDGE = 1, LAVES__ON_CORNER = 4 };

typedef struct laves__nearest {
  double distance2; /* squared */
  uint32_t slot;    /* LAVES__NONE: nothing nearer than the start value of distance2 */
} laves__nearest;

double laves__triangle_distance2(const laves__triangle *t, laves__vec3 p);
/* The closest point of the triangle; on receives which part of it that is. */
laves__vec3 laves__triangle_closest(const laves__triangle *t, laves__vec3 p, int *on);

/* Improves `best`: the triangle of least squared distance, of several the one of least slot. Triangles are looked for that
 * are as near as best->distance2 or nearer. What best held before never changes the answer when it was a true
 * distance to its slot. */
void laves__bvh_nearest(const laves__bvh *bvh, laves__vec3 p, laves__nearest *best);

/* ---- surface ---- */

typedef struct laves__surface {
  laves_context *context;
  laves__vec3 *points;
  size_t point_count, point_capacity;
  uint32_t (*faces)[3]; /* in the order of the tree's slots */
  int32_t *tags;        /* [face_capacity], NULL: none */
  size_t face_count, face_capacity;
  uint32_t *across;           /* [3 face_capacity] half-edge (3 face + corner where it starts) on the other side, or NONE */
  laves__vec3 *face_normals;  /* [face_capacity] of length one; zero for faces without area */
  laves__vec3 *point_normals; /* [point_capacity] weighted by angle */
  laves__bvh bvh;
  double diagonal;
} laves__surface;

/* ---- weld ---- */

/* Fills points, faces and tags from input (local coordinates); counts repeated and unused points, degenerate and
 * repeated faces. False when memory is short. */
bool laves__surface_weld(laves__surface *s, const laves__surface_input *input, laves__vec3 origin, laves_domain_info *info);

/* ---- topology ---- */

/* Fills `across` and counts what info holds about edges, fans and components. False when memory is short. */
bool laves__surface_topology(laves__surface *s, laves_domain_info *info);
bool laves__surface_normals(laves__surface *s);
/* Signed volume (meaningful for closed surfaces) and area. */
void laves__surface_measure(const laves__surface *s, double *volume, double *area);

/* atan2(y, x) for any x, y to 2e-8, from arithmetic and square roots alone, so that it is the same on every platform. */
double laves__angle(double y, double x);

/* ---- oracle ---- */

/* The last step: s is ready, its functions go into the oracle. */
void laves__surface_oracle(laves__surface *s, laves__oracle *oracle);
void laves__surface_free(laves_context *context, void *self);

#endif
