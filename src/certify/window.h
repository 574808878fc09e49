/* A window of dihedral angles and volume-length ratio, and how far tets leave it.
 *
 * How bad a tet is, is the largest share by which it leaves a limit of what there is to leave: 0 at the limit, 1 for an
 * angle of 0 or 180 degrees or a ratio of 0. Tets without measurable angles are the worst. */
#ifndef LAVES_CERTIFY_WINDOW_H
#define LAVES_CERTIFY_WINDOW_H

#include <string.h>

#include "base/base.h"
#include "base/vec3.h"

#define LAVES__UNMEASURABLE 2.0

typedef struct laves__window {
  double min_dihedral, max_dihedral, volume_length;
  double cos_least, cos_most; /* of the window, widened a little: within them no exact angle is needed */
} laves__window;

laves__window laves__window_make(double min_dihedral, double max_dihedral, double volume_length);

/* How bad a tet is, 0 or less when it is within the window; *value: what makes it so. */
double laves__window_badness(const laves__window *w, const laves__vec3 p[4], double *value);

/* A key that sorts the worst first: the bits of positive doubles are in the order of their values. */
static inline uint64_t laves__badness_key(double bad) {
  uint64_t bits;
  memcpy(&bits, &bad, sizeof bits);
  return ~bits;
}

#endif
