/* Splits one edge. */
#ifndef LAVES_IMPROVE_SPLIT_H
#define LAVES_IMPROVE_SPLIT_H

#include "improve/flip.h"

/* Dead vertices that splits may bring to life. */
typedef struct laves__spare {
  const int32_t *vertex;
  int32_t count;
} laves__spare;

/* Puts a new vertex in the middle of one of the longer edges of a tet, on its crease or patch where it is a boundary edge, and
 * smooths around it. Accepted when the worst of all tets touched is better than the worst around the edge was; otherwise
 * everything is as it was. True when an edge was split. */
bool laves__split_tet(const laves__frame *frame, const laves__measure *measure, double target, laves__layer *layer, int32_t tet,
                      laves__slots *slots, laves__spare *spare, laves__journal *journal);

#endif
