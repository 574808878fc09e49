/* The boundary as solvers want it: for each face tag its faces, as sides of tetrahedra, and its vertices; and names for all
 * groups that are words. For Abaqus and Exodus. */
#ifndef LAVES_IO_BOUNDARY_SETS_H
#define LAVES_IO_BOUNDARY_SETS_H

#include "io/output.h"
#include "io/tag_order.h"

typedef struct laves__boundary_sets {
  laves__tag_order tags; /* of the faces */
  uint64_t *sides;       /* [face_count] 4 * tet + the corner that is opposite */
  size_t *first;         /* [tags.count + 1] where the vertices of each tag begin */
  int32_t *vertices;     /* of each tag in the order in which its faces use them first */
} laves__boundary_sets;

/* Needs a mesh in memory. On failure, which is recorded in `out`, there is nothing to free.
 * Cost: about 10 ns a tet; memory 12 bytes a vertex, 8 to 20 a face. */
bool laves__boundary_sets_make(laves__output *out, const laves_mesh *mesh, laves__boundary_sets *sets);
void laves__boundary_sets_free(laves_context *context, const laves_mesh *mesh, laves__boundary_sets *sets);

/* Names of the groups of one dimension as labels: letters, digits, '_' and '-', first a letter, all different even where the case
 * does not count. */
enum { LAVES__LABEL_MAX = 64 };
typedef char laves__label[LAVES__LABEL_MAX];
/* An array for all tags of the order, to be freed with laves__free(); NULL when memory is short. */
laves__label *laves__labels_make(laves_context *context, const laves_mesh *mesh, int dimension, const laves__tag_order *order);

#endif
