/* Blocks of a given mesh, which are worked on at the same time.
 *
 * Tets of other programs may be of any length, so no distance keeps what is done in one block out of sight of the next. Instead
 * the vertices that have a neighbour in another block stand still, and so all that is read and changed in a block is its own, or
 * still. From one turn to the next the blocks are shifted by a quarter of their side in all axes. A border plane of a block is
 * near a vertex in one of four turns at most, where blocks are more than eight edges wide, and there are three axes: so each
 * vertex moves in one of any four turns. */
#ifndef LAVES_IMPROVE_BLOCKS_H
#define LAVES_IMPROVE_BLOCKS_H

#include "mesh/layer.h"

typedef struct laves__blocks {
  laves_context *context;
  size_t capacity; /* vertices */
  int32_t *block;  /* [capacity] of each vertex, where it moves now */
  uint8_t *depth;  /* [capacity] of vertices while they stand still */
  laves__vec3 lower;
  double side; /* of a block; all is one block where there are no more than `per_axis` 1 */
  int per_axis;
  int pass;
} laves__blocks;

/* For a layer with a given boundary, whose vertices will not be more than they are now; at least `least` vertices go to a block
 * of a mesh that fills its box (0: as many as is usual). False when memory is short. */
bool laves__blocks_begin(laves__layer *layer, size_t least, laves__blocks *blocks);
/* How many turns there are until each vertex has moved: 1 where all is one block. */
int laves__blocks_turns(const laves__blocks *blocks);
/* Makes new blocks: who stands still has depth LAVES__DEPTH_MAX, and no star. LAVES_ERROR_MEMORY. */
laves_result laves__blocks_shift(laves__blocks *blocks, laves__layer *layer, laves_error *error);
/* Gives all vertices their depths and stars back. */
laves_result laves__blocks_end(laves__blocks *blocks, laves__layer *layer, laves_error *error);
/* The block of a tet, or -1 where none of its vertices moves. */
int32_t laves__blocks_of(const laves__blocks *blocks, const laves__layer *layer, int32_t tet);
void laves__blocks_free(laves__blocks *blocks);

#endif
