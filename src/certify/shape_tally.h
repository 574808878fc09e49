/* Statistics of the shapes of tets, added up. */
#ifndef LAVES_CERTIFY_SHAPE_TALLY_H
#define LAVES_CERTIFY_SHAPE_TALLY_H

#include "base/base.h"
#include "base/vec3.h"
#include "mesh/shape_batch.h"

enum { LAVES__MIN_DIHEDRAL, LAVES__MAX_DIHEDRAL, LAVES__RADIUS_RATIO, LAVES__RADIUS_EDGE, LAVES__VOLUME_LENGTH, LAVES__MEASURES };

/* Tets are tallied in blocks of so many, whose sums are added in order, so that the digits do not depend on the threads. */
enum { LAVES__TALLY_TETS = 4096 };

typedef struct laves__measure_tally {
  size_t count;
  double min, max, sum, squares; /* sums relative to what is typical of the tiling, against cancellation */
  size_t min_tet, max_tet;
} laves__measure_tally;

typedef struct laves__shape_tally {
  laves__measure_tally measures[LAVES__MEASURES];
  size_t histogram[LAVES_HISTOGRAM_BINS];
  double volume;
} laves__shape_tally;

/* Tets that wait to be measured together. */
typedef struct laves__shape_queue {
  laves__shape_batch batch;
  size_t tet[LAVES__SHAPE_BATCH];
  int count;
} laves__shape_queue;

void laves__shape_tally_clear(laves__shape_tally *tally);
void laves__shape_queue_clear(laves__shape_queue *queue);
/* Finite corners of a tet and its number; whatever is not finite of a flat tet is left out. It counts at the latest when the
 * queue is flushed. */
void laves__shape_tally_add(laves__shape_tally *tally, laves__shape_queue *queue, const laves__vec3 p[4], size_t tet);
void laves__shape_tally_flush(laves__shape_tally *tally, laves__shape_queue *queue);
/* `more` is of tets behind those of `into`. */
void laves__shape_tally_merge(laves__shape_tally *into, const laves__shape_tally *more);
/* Which tet is the worst by each measure; -1: none could be measured. */
void laves__shape_tally_worst(const laves__shape_tally *tally, int64_t worst[LAVES__MEASURES]);
/* Names the worst tet of a measure and its centroid in the check; p: its corners, or NULL when it is -1. */
void laves__shape_tally_place(int measure, int64_t tet, const laves__vec3 p[4], laves_check *check);
/* Statistics, histogram and volume of a check. */
void laves__shape_tally_report(const laves__shape_tally *tally, laves_check *check);

#endif
