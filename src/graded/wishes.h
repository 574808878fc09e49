/* The size field in the coordinates of the lattice: what stands between src/size and the octree. */
#ifndef LAVES_GRADED_WISHES_H
#define LAVES_GRADED_WISHES_H

#include "graded/octree.h"
#include "size/size.h"

typedef struct laves__wishes {
  laves_context *context;
  const laves__size *size;
  laves__size_sample *sample; /* [sample_count] of the surface, and those added since; local coordinates */
  size_t sample_count, sample_capacity;
  /* As the octree wants them; made by laves__wishes_demand(). */
  const laves__frame *frame;
  double base; /* the size that is one in the lattice, before the frame was stretched */
  laves__vec3 *place;
  double *wish;
  size_t place_count;
} laves__wishes;

/* Asks the surface for its samples. LAVES_ERROR_OPTION when they are too many, LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__wishes_make(laves_context *context, const laves__size *size, double base, laves__wishes *wishes,
                                laves_error *error);
/* One more wish; false when memory is short. */
bool laves__wishes_add(laves__wishes *wishes, laves__vec3 local, double size);
/* Smaller wishes at places where mesh and surface are further apart than `distance`: as far as that falls with the square of the
 * size, and so small that the leaf there is halved. None where the size is the least already; *any: there was one. False
 * when memory is short. The frame is that of the last demand. */
bool laves__wishes_approach(laves__wishes *wishes, const laves__octree *tree, double distance, const laves_place *places,
                            size_t count, bool *any);
/* The demand in a frame, whose size may be a multiple of `base`: all wishes are stretched with it. Valid until the next call;
 * false when memory is short. */
bool laves__wishes_demand(laves__wishes *wishes, const laves__frame *frame, laves__demand *demand);
void laves__wishes_free(laves__wishes *wishes);

#endif
