/* The boundary layer: the part of the mesh that the surface disturbs, as a small mesh that can be changed.
 *
 * It holds every tetrahedron with a vertex within LAVES__DEPTH_MOVES edges of the surface, and their vertices. Vertices up
 * to that depth may move and have a star (the list of their tetrahedra); the deeper ones stand where the tiling puts them
 * and join the layer to the untouched interior. Coordinates are those of the lattice: the mean edge is 1.
 *
 * Stars are lists of tets in slices of one block; a star that outgrows its slice gets a block of its own, so parts of the
 * layer that are far from one another can be changed from several threads at once.
 *
 * The whole of a mesh of another program can be a layer, too (improve/given.h). Its boundary is given: there is no oracle, and
 * each face of a tet knows the flat patch of the boundary, or of the border between two regions, that it is a part of. Then every
 * vertex has a star, and what a vertex of depth 0 may do is told by its hold's kind alone and by `normal`: to move in the plane
 * of its patch, along its straight crease, or not at all. */
#ifndef LAVES_MESH_LAYER_H
#define LAVES_MESH_LAYER_H

#include "base/base.h"
#include "base/vec3.h"
#include "mesh/hold.h"

enum {
  LAVES__DEPTH_MOVES = 2, /* vertices this many edges from the surface may still move */
  LAVES__DEPTH_MAX = 3,   /* the deepest vertices of the layer */
};

typedef struct laves__star {
  int32_t *tet;
  int32_t count, capacity;
  bool own_block; /* `tet` was allocated for this star alone */
} laves__star;

typedef struct laves__layer {
  laves_context *context;
  size_t vertex_count;
  laves__vec3 *position;
  laves__vec3 *normal; /* for depth 0: of the surface, outwards, or the tangent of the crease that holds it */
  uint32_t *hint;      /* for the oracle; for depth 0 */
  uint8_t *depth;      /* 0: on the surface */
  laves__hold *hold;   /* for depth 0: what holds it; NULL: nothing but the surface holds any */
  bool *off_surface;   /* depth 0, but not on the surface: it could not be reached with positive tets */
  float *scale;        /* the local size, in sizes, on a graded background; NULL: 1 everywhere */
  uint32_t *origin;    /* record * 24 + site, or LAVES__NO_ORIGIN for the further copies of a parted vertex */
  bool *fresh;         /* what is to be improved: tets with such a vertex; NULL: all */
  laves__star *star;   /* of depth 0 .. LAVES__DEPTH_MOVES; NULL tet: dead vertex */
  size_t tet_count;
  int32_t (*tet)[4]; /* tet[t][0] < 0: dead */
  int32_t (
      *patch)[4]; /* of the face opposite each corner, or LAVES__NO_PATCH for faces inside; NULL: the boundary is not given */
  bool fixed_boundary; /* of a given boundary: its vertices and faces stay as they are */
  int32_t *region;     /* [tet_count] of a given mesh; NULL: all are one */
  double *quality;     /* [tet_count], kept by the improver */
  int32_t *star_block; /* slices for the stars */
  size_t star_block_count;
} laves__layer;

#define LAVES__NO_ORIGIN UINT32_MAX
#define LAVES__NO_PATCH (-1)

/* Arrays for the given counts, contents undefined but for stars (empty). */
laves_result laves__layer_create(laves_context *context, size_t vertex_count, size_t tet_count, laves__layer *layer,
                                 laves_error *error);
/* Makes the stars from tets and depths; again, when they are there. */
laves_result laves__layer_link(laves__layer *layer, laves_error *error);
/* Adds dead tets, for operations that need more than they free; false when memory is short. */
bool laves__layer_extend(laves__layer *layer, size_t extra);
/* Adds dead vertices, without a site; false when memory is short. */
bool laves__layer_extend_vertices(laves__layer *layer, size_t extra);
void laves__layer_free(laves__layer *layer);

/* What holds a vertex of depth 0. */
static inline laves__hold laves__layer_hold(const laves__layer *layer, int32_t vertex) {
  return layer->hold ? layer->hold[vertex] : (laves__hold){0, LAVES__HOLD_SURFACE};
}
static inline void laves__layer_points(const laves__layer *layer, int32_t tet, laves__vec3 p[4]) {
  for (int k = 0; k < 4; k++) p[k] = layer->position[layer->tet[tet][k]];
}
/* The corner of `tet` at which a vertex stands, or -1. */
static inline int laves__layer_corner(const laves__layer *layer, int32_t tet, int32_t vertex) {
  const int32_t *t = layer->tet[tet];
  return t[0] == vertex ? 0 : t[1] == vertex ? 1 : t[2] == vertex ? 2 : t[3] == vertex ? 3 : -1;
}
/* The local size at a vertex, in sizes. */
static inline double laves__layer_scale(const laves__layer *layer, int32_t vertex) {
  return layer->scale ? (double)layer->scale[vertex] : 1;
}
/* The cube of the local size around a tet: what its volume is measured by. */
static inline double laves__layer_cube(const laves__layer *layer, int32_t tet) {
  if (!layer->scale) return 1;
  const int32_t *t = layer->tet[tet];
  const double mean = 0.25 * ((double)layer->scale[t[0]] + layer->scale[t[1]] + layer->scale[t[2]] + layer->scale[t[3]]);
  return mean * mean * mean;
}
static inline bool laves__layer_moves(const laves__layer *layer, int32_t vertex) {
  return layer->depth[vertex] <= LAVES__DEPTH_MOVES;
}

/* Whether a tet that lives is to be improved. */
static inline bool laves__layer_is_fresh(const laves__layer *layer, int32_t tet) {
  const bool *fresh = layer->fresh;
  const int32_t *t = layer->tet[tet];
  return !fresh || fresh[t[0]] || fresh[t[1]] || fresh[t[2]] || fresh[t[3]];
}

/* The other tet of the layer at the face of `tet` opposite `corner`, or -1. At least one vertex of the face must move. */
int32_t laves__layer_across(const laves__layer *layer, int32_t tet, int corner);
/* Whether the face opposite `corner` lies on the boundary of the mesh. */
bool laves__layer_is_boundary_face(const laves__layer *layer, int32_t tet, int corner);

/* Changes to stars; false when memory is short (the star is unchanged then). */
bool laves__star_add(laves_context *context, laves__star *star, int32_t tet);
void laves__star_remove(laves__star *star, int32_t tet);

#endif
