/* Flips: other tetrahedra between the same vertices. */
#ifndef LAVES_IMPROVE_FLIP_H
#define LAVES_IMPROVE_FLIP_H

#include "improve/journal.h"
#include "improve/measure.h"

/* Dead tets that a flip may bring to life. */
typedef struct laves__slots {
  const int32_t *tet;
  int32_t count;
} laves__slots;

/* Removes the edge or the face of a bad tet whose removal raises the worst quality of all tets touched the most; boundary
 * edges only where the new faces lie well to the surface. True when something was flipped: the journal then holds what was
 * touched, until it is cleared; `tet` may be dead, or another. */
bool laves__flip_tet(const laves__frame *frame, const laves__measure *measure, laves__layer *layer, int32_t tet,
                     laves__slots *slots, laves__journal *journal);

#endif
