/* Repairs in a layer that is improved: the neighbourhood of what changed in the lattice is taken from a layer made anew, all the
 * rest stays as it is, bit for bit.
 *
 *        improved             made anew             grafted
 *      A A A A A A          . . . . . . .          A A A A A A
 *      A A C C A A    +     . . B B . . .    =     A A B B A A      the faces around C and B are the same
 *      A A A A A A          . . . . . . .          A A A A A A
 *
 * Sites near a record that changed are *near*; C and B are the tets with a near vertex. Where improvement contracted an edge or
 * flipped a face on the border between C and the rest, the faces differ; then their corners become near, too, until the border
 * runs where the connectivity is still that of the lattice. */
#ifndef LAVES_STUFF_GRAFT_H
#define LAVES_STUFF_GRAFT_H

#include "background/lattice.h"
#include "mesh/layer.h"

/* What a record was when a layer was made. */
typedef struct laves__known_record {
  uint64_t solid[3];
  int8_t label[LAVES__C15_SITES];
  uint32_t zone;
} laves__known_record;

/* What the lattice was then. */
typedef struct laves__known_lattice {
  laves_context *context;
  laves__known_record *record; /* [count] */
  size_t count;
} laves__known_lattice;

/* False when memory is short; free it either way. */
bool laves__known_take(const laves__lattice *lattice, laves__known_lattice *known);
void laves__known_free(laves__known_lattice *known);
/* The record counts as changed from now on. A number beyond what is known is allowed. */
void laves__known_forget(laves__known_lattice *known, size_t record);

/* Puts what is near a change in the place of what was there: `improved` becomes the layer of the lattice as it is now, and its
 * mask `fresh` tells which vertices came from `made`, the layer just made of the lattice. known: the lattice when `improved` was
 * made. *done: false: the two do not fit together, and all is as it was; else `made` is freed. Promise: tets stay positive (by an
 * exact test), the boundary stays a manifold, tets without a fresh vertex are those of `improved`, and their vertices stand where
 * they did. LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__graft(const laves__known_lattice *known, laves__lattice *lattice, laves__layer *made, laves__layer *improved,
                          bool *done, laves_error *error);

#endif
