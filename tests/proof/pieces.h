/* Which pieces the mesher may make of a box of configurations, from its own table. */
#ifndef LAVES_TESTS_PROOF_PIECES_H
#define LAVES_TESTS_PROOF_PIECES_H

#include "bound.h"

typedef struct piece_list {
  int count;
  uint8_t piece[LAVES__PIECES_MAX][4];
} piece_list;

/* An order of the diagonal keys that is possible in the box, and the sets of pieces that the mesher chooses from then. */
typedef struct outcome {
  int count;
  piece_list choice[2];
} outcome;

enum { OUTCOMES_MAX = 6 };

/* All that are possible; with equal keys both orders are. */
int possible_outcomes(const configuration *c, outcome outcomes[OUTCOMES_MAX]);

/* Where the corner with a code may be. */
segment segment_of(const configuration *c, int code);
void segments_of(const configuration *c, const uint8_t piece[4], segment corner[4]);

/* Halves the widest range of a cut. False when there is none that can be halved. */
bool halve_cuts(const configuration *c, configuration half[2]);

#endif
