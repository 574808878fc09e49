/* The measures of quality.h for many tetrahedra at once, bit for bit the same. */
#ifndef LAVES_MESH_SHAPE_BATCH_H
#define LAVES_MESH_SHAPE_BATCH_H

#include "base/vec3.h"

enum { LAVES__SHAPE_BATCH = 64 };

/* One tet in each lane. Lanes that nobody filled are measured, too, and mean nothing. */
typedef struct laves__shape_batch {
  double corner[4][3][LAVES__SHAPE_BATCH]; /* in: x, y, z of each corner */
  double cosine[6][LAVES__SHAPE_BATCH];    /* out: as laves__tet_dihedral_cosines() gives them */
  double radius_ratio[LAVES__SHAPE_BATCH], radius_edge[LAVES__SHAPE_BATCH], volume_length[LAVES__SHAPE_BATCH];
  double determinant[LAVES__SHAPE_BATCH]; /* v3_det() of the corners */
} laves__shape_batch;

static inline void laves__shape_batch_set(laves__shape_batch *b, int lane, const laves__vec3 p[4]) {
  for (int i = 0; i < 4; i++) {
    b->corner[i][0][lane] = p[i].x;
    b->corner[i][1][lane] = p[i].y;
    b->corner[i][2][lane] = p[i].z;
  }
}

/* Fills what is out. */
void laves__shape_batch_measure(laves__shape_batch *batch);
/* Of a measured batch: fits[lane] is 1 where the tet is positive, 1 - cosine >= low and 1 + cosine >= high for all six, else 0.
 */
void laves__shape_batch_fits(const laves__shape_batch *batch, double low, double high, double fits[LAVES__SHAPE_BATCH]);

#endif
