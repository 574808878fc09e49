/* How boundary faces lie to the surface: what operations that change the boundary are judged by. */
#ifndef LAVES_IMPROVE_FIT_H
#define LAVES_IMPROVE_FIT_H

#include "domain/frame.h"
#include "mesh/layer.h"

typedef struct laves__fit {
  double deviation; /* largest distance of centroids and edge midpoints, local sizes */
  double alignment; /* least cosine between a face's normal and the surface's */
} laves__fit;

/* Of no faces. */
#define LAVES__FIT_NONE ((laves__fit){0, 1})
/* Faces that an operation makes may lie as far from the surface, and this much across it. */
#define LAVES__FIT_LIMIT ((laves__fit){0.10, 0.8})

/* Takes one face of boundary vertices, counter-clockwise from outside, into account. Where features are kept it is compared with
 * the patch that its corners have in common; one that has none does not fit. */
void laves__fit_face(const laves__frame *frame, const laves__layer *layer, const int32_t face[3], laves__fit *fit);
/* All boundary faces around a surface vertex. */
void laves__fit_star(const laves__frame *frame, const laves__layer *layer, int32_t vertex, laves__fit *fit);

static inline bool laves__fit_within(const laves__fit *fit, const laves__fit *limit) {
  return fit->deviation <= limit->deviation && fit->alignment >= limit->alignment;
}

#endif
