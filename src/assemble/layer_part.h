/* The boundary layer's part in the mesh, and what numbers its vertices; the same for the tiling and for a graph.
 *
 * A vertex's number is its record's first number plus the count of kept sites before it in the record: one bit mask and a
 * popcount. Vertices that contraction removed are simply not in their record's mask; further copies of parted vertices
 * come last. */
#ifndef LAVES_ASSEMBLE_LAYER_PART_H
#define LAVES_ASSEMBLE_LAYER_PART_H

#include "background/lattice.h"
#include "mesh/layer.h"
#include "mesh/mesh.h"

typedef struct laves__layer_part {
  const laves__frame *frame;
  const laves__lattice *lattice;
  const laves__layer *layer;
  uint32_t *mask;      /* [record_count] kept sites */
  int32_t *first;      /* [record_count] first vertex of the record; left to the caller, but for the room */
  int32_t *id;         /* [layer->vertex_count] number in the mesh, -1 for dead ones */
  laves__vec3 *placed; /* [layer->vertex_count] where the living ones stand, in the input's coordinates */
  uint8_t *faces;      /* [layer->tet_count] bit k: the face opposite corner k is a boundary face */
  size_t record_count; /* when it was made */
  size_t tet_count;    /* that live */
  size_t face_count;
} laves__layer_part;

/* Finds kept sites and boundary faces, and places vertices. In the records parted sites then name the first of their vertices.
 * Free with laves__layer_part_free(), whatever is returned. LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__layer_part_make(const laves__frame *frame, laves__lattice *lattice, const laves__layer *layer,
                                    laves__layer_part *part, laves_error *error);

/* A mesh with room for everything, once `first` is filled: `vertices` at sites, `stamped` tets before those of the layer. Numbers
 * the layer's vertices. `hollow`: without points and tets. LAVES_ERROR_MEMORY, LAVES_ERROR_OPTION when there are more vertices
 * than can be indexed. */
laves_result laves__layer_part_mesh(laves__layer_part *part, int64_t vertices, size_t stamped, bool hollow, laves_mesh **mesh,
                                    laves_error *error);

/* The layer's tets [tet_count], and the points of the further vertices of parted sites, whose numbers come last, in their order.
 */
void laves__layer_part_tets(const laves__layer_part *part, int32_t (*tets)[4]);
void laves__layer_part_copies(const laves__layer_part *part, laves__vec3 *points);

/* Fills the boundary faces with their tags and sources. LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__layer_part_faces(const laves__layer_part *part, laves_mesh *mesh, laves_error *error);

void laves__layer_part_free(laves__layer_part *part);

/* The number of a kept site. */
static inline int32_t laves__kept_vertex(const laves__layer_part *part, int32_t record, int site) {
  return part->first[record] + __builtin_popcount(part->mask[record] & ((UINT32_C(1) << site) - 1));
}

#endif
