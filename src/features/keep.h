/* Stage "features": corners and creases of the domain become vertices and chains of edges.
 *
 * Snapping covered the lattice edges that cross the surface and moved the cover on to it. Here the same is done one dimension
 * down, on the boundary triangles alone: every boundary edge between vertices of two patches gets an end on the crease between
 * them. No vertex is added and no connectivity changes. The steps are separate files:
 *
 *     rim.c       the boundary triangles of the layer, and what meets at its vertices
 *     corners.c   each corner claims the vertex that suits it best
 *     creases.c   the second cover: ends of edges between patches go on creases, nearest first; then some come back
 *     mend.c      faces whose corners still have no patch in common: vertices change what holds them
 *     places.c    where held vertices stand, as near as tetrahedra stay positive
 *
 *         patch 0                          patch 0
 *      o-----o-----o                    o-----o-----o
 *       \   / \   / \    edges from        \   / \   / \
 *     ---\-/---\-/---\--- 0 to 1   ==>   ===O=====O=====O===   the crease is a chain of edges
 *         o-----o-----o  cross it            \   / \   / \
 *         patch 1                             o-----o-----o
 *
 * Why there are no gaps: when every face is legal (domain/held.h), each has a patch, and an edge between faces of different
 * patches has both its ends in both, so both are held to creases or corners. */
#ifndef LAVES_FEATURES_KEEP_H
#define LAVES_FEATURES_KEEP_H

#include "domain/held.h"
#include "features/rim.h"
#include "mesh/layer.h"

typedef struct laves__kept_counts {
  size_t corners_lost; /* that no vertex could be found for */
  size_t crease_vertices;
  size_t illegal_faces; /* that remain: there the crease is rounded */
  size_t off_feature;   /* vertices that could not reach their place yet with positive tets */
} laves__kept_counts;

/* Holds the layer's boundary vertices to the features of the frame, and moves them. `free`: a flag for each vertex that is to be
 * held to nothing; NULL: none. `is_last`: nothing is improved afterwards, so tets also keep some volume, for one that is positive
 * by rounding alone need not be so in the coordinates of the input. Promise: tets stay positive (by an exact test), connectivity
 * is unchanged, what is not near a feature stays where it is. LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__keep_features(const laves__frame *frame, const bool *free, bool is_last, laves__layer *layer,
                                  laves__kept_counts *counts, laves_error *error);

/* ---- what the steps share ---- */

typedef struct laves__keeping {
  laves_context *context;
  const laves__frame *frame;
  const laves__features *features;
  laves__layer *layer;
  const bool *free; /* [vertices] or NULL */
  bool is_last;     /* no improvement follows */
  laves__rim rim;
  laves__vec3 *start;   /* [vertices] positions after snapping */
  int32_t *start_patch; /* [vertices] of the surface there; of boundary vertices */
  int32_t *claimed;     /* [corners] the vertex of each, or LAVES__NO_FEATURE */
} laves__keeping;

bool laves__claim_corners(laves__keeping *k);
bool laves__cover_creases(laves__keeping *k);
bool laves__prune_creases(laves__keeping *k);
void laves__mend_faces(laves__keeping *k);
void laves__place_held(laves__keeping *k, size_t *off_feature);

/* Where a vertex would stand if something held it, as far as features go: the foot on its patch or crease, the corner. False when
 * there is none within reach. */
bool laves__held_place(const laves__keeping *k, int32_t vertex, laves__hold hold, laves__vec3 *place);
/* Whether a boundary edge may stay: its ends have a patch in common and no seam lies between them. */
bool laves__edge_is_legal(const laves__keeping *k, int32_t from, int32_t to);
/* Faces around a vertex that are not legal, and edges. */
int laves__illegal_around(const laves__keeping *k, int32_t vertex);
void laves__face_holds(const laves__keeping *k, uint32_t face, laves__hold hold[3]);

#endif
