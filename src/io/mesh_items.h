/* Points and tets one by one, from memory or, a piece at a time, from a streamed mesh. */
#ifndef LAVES_IO_MESH_ITEMS_H
#define LAVES_IO_MESH_ITEMS_H

#include "mesh/mesh.h"

/* Items are had in pieces of so many. */
enum { LAVES__PIECE = 512 };

/* For items in ascending order; zeroed but for the mesh. Of a mesh of second order tets have ten numbers. */
typedef struct laves__point_reader {
  const laves_mesh *mesh;
  size_t first, end; /* the points in `piece` */
  laves__vec3 piece[LAVES__PIECE];
} laves__point_reader;

typedef struct laves__tet_reader {
  const laves_mesh *mesh;
  size_t first, end;
  int32_t piece[LAVES__PIECE][4];
} laves__tet_reader;

static inline size_t laves__piece_end(size_t first, size_t count) {
  return count - first < LAVES__PIECE ? count : first + LAVES__PIECE;
}

static inline laves__vec3 laves__point_at(laves__point_reader *r, size_t i) {
  if (r->mesh->points) return r->mesh->points[i];
  if (i < r->first || i >= r->end) {
    r->first = i;
    r->end = laves__piece_end(i, r->mesh->vertex_count);
    laves__mesh_points(r->mesh, r->first, r->end, r->piece);
  }
  return r->piece[i - r->first];
}

static inline const int32_t *laves__tet_at(laves__tet_reader *r, size_t i) {
  if (r->mesh->tets) return laves__tet_nodes(r->mesh, i);
  if (i < r->first || i >= r->end) {
    r->first = i;
    r->end = laves__piece_end(i, r->mesh->tet_count);
    laves__mesh_tets(r->mesh, r->first, r->end, r->piece);
  }
  return r->piece[i - r->first];
}

#endif
