/* The worst that the mesher's own functions make of the reachable set: what is attained, beside what is proved. */
#ifndef LAVES_TESTS_PROOF_SAMPLE_H
#define LAVES_TESTS_PROOF_SAMPLE_H

#include "pieces.h"

typedef struct extreme {
  double value; /* degrees, or the ratio */
  configuration configuration;
  laves__cut_tet tet; /* a point of the box */
  piece_list pieces;
} extreme;

typedef struct sample {
  const laves__guarantee *guarantee;
  extreme least, most; /* of the dihedral angles */
  extreme ratio;       /* the least, whichever diagonals are chosen */
} sample;

sample sample_start(const laves__guarantee *guarantee);
/* A visit_configuration; user is the sample. */
bool visit_sample(const configuration *c, void *user);

#endif
