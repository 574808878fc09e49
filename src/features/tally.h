/* What of the features is in a layer, in the end. */
#ifndef LAVES_FEATURES_TALLY_H
#define LAVES_FEATURES_TALLY_H

#include "domain/held.h"
#include "mesh/layer.h"

typedef struct laves__feature_tally {
  double length, kept_length; /* of creases, and of boundary edges along them; sizes */
  size_t corners, kept_corners;
  bool has_lost;
  laves__vec3 lost; /* a corner, or the middle of a crease, of which something is missing: the first */
} laves__feature_tally;

/* LAVES_ERROR_MEMORY */
laves_result laves__tally_features(const laves__frame *frame, const laves__layer *layer, laves__feature_tally *tally,
                                   laves_error *error);

#endif
