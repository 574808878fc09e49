/* Bounds on the shape of a tet whose corners move along segments, with outward rounding.
 *
 * All functions but round_upward() and round_to_nearest() want the rounding mode that round_upward() sets. */
#ifndef LAVES_TESTS_PROOF_BOUND_H
#define LAVES_TESTS_PROOF_BOUND_H

#include "reachable.h"

/* A corner that moves: origin + share * along for shares in the range. All multiples of FINE_GRID. */
typedef struct segment {
  laves__vec3 origin, along;
  range share;
} segment;

/* A window of angles as the proof uses it: lower bounds of cot(low) and of -cot(high). */
typedef struct window {
  double cot_low, cot_high;
} window;

typedef struct effort {
  long problems, boxes;
} effort;

/* Directed rounding for what follows. Returns false when the machine does not do it. */
bool round_upward(void);
void round_to_nearest(void);

/* 0 < low < 90 < high < 180, degrees. */
window window_of(double low, double high);
/* Encloses the cosine of an angle between 0 and 180 degrees. */
range cosine_range(double degrees);

/* The middle of a range if it lies on FINE_GRID. */
bool middle_of(range r, double *middle);

/* Whether the tet is positive for all positions of its corners. */
bool is_positive(const segment corner[4]);

/* Whether the tet is proved to be positive, with all dihedral angles in the window, for all positions of its corners. Each
 * range may be halved `depth` times. */
bool angles_inside(const segment corner[4], const window *w, int depth, effort *spent);

/* Whether 3 r / R of the tet is proved to be at least `least`. */
bool ratio_above(const segment corner[4], double least, int depth, effort *spent);

#endif
