/* Which faces of tetrahedra coincide: the one search that boundaries, adjacency and checks are made from. */
#ifndef LAVES_MESH_FACE_MATCH_H
#define LAVES_MESH_FACE_MATCH_H

#include "mesh/mesh.h"

/* A face of a tetrahedron: slot = 4 * tet + the corner it is opposite to. */
typedef struct laves__face_use {
  uint32_t middle, high; /* with the group's `low` the three vertices, ascending */
  uint64_t slot;
} laves__face_use;

/* All uses of the three vertices (low, uses->middle, uses->high), by ascending slot. Called from many threads, once for
 * each different face, in no fixed order. */
typedef void laves__face_group_fn(void *user, uint32_t low, const laves__face_use *uses, size_t count, int worker);

/* Calls fn for every group of equal faces. Tetrahedra with corners out of [0, vertex_count) or repeated are passed over.
 * Cost: about 0.1 microseconds a tet; memory about 16 bytes a tet and 8 a vertex. */
laves_result laves__match_faces(laves_context *context, const char *phase, const int32_t (*tets)[4], size_t tet_count,
                                size_t vertex_count, laves__face_group_fn *fn, void *user, laves_error *error);

/* The slots of all faces that only one tetrahedron has, ascending.
 * *slots: uint64_t[*count], free with laves__free(); NULL on failure. */
laves_result laves__boundary_slots(laves_context *context, const char *phase, const int32_t (*tets)[4], size_t tet_count,
                                   size_t vertex_count, uint64_t **slots, size_t *count, laves_error *error);

/* Whether the corners of a tet are different and in [0, vertex_count). */
static inline bool laves__tet_usable(const int32_t tet[4], size_t vertex_count) {
  for (int i = 0; i < 4; i++)
    if (tet[i] < 0 || (size_t)tet[i] >= vertex_count) return false;
  return tet[0] != tet[1] && tet[0] != tet[2] && tet[0] != tet[3] && tet[1] != tet[2] && tet[1] != tet[3] && tet[2] != tet[3];
}

/* The corners of a face so that it looks away from the fourth corner; `orientation` is the tet's, from laves__orient3d
 * (a flat tet counts as positive). */
void laves__face_outwards(const int32_t tet[4], int face, int orientation, int32_t corners[3]);

#endif
