/* Feet: where sites near the surface would stand on it.  Found once for each site, when first needed. */
#ifndef LAVES_SNAP_FEET_H
#define LAVES_SNAP_FEET_H

#include "background/site.h"

typedef struct laves__foot {
  laves__vec3 position;
  float normal[3]; /* of the surface, outwards */
  uint32_t hint;
  uint8_t state; /* LAVES__FOOT_... */
} laves__foot;

/* OFF: the position is where the vertex shall stand, though not on the surface. */
enum { LAVES__FOOT_UNKNOWN, LAVES__FOOT_FOUND, LAVES__FOOT_NONE, LAVES__FOOT_OFF };

/* Blocks of one foot for each site, for the records that need any. */
typedef struct laves__feet {
  laves_context *context;
  int32_t *block_of; /* [record_count] block of a record, or -1 */
  size_t record_count;
  laves__foot (*block)[LAVES__C15_SITES];
  size_t block_count, block_capacity;
} laves__feet;

/* Finds the feet of the sites in `wanted` (a bit for each site, [lattice->record_count]) that are not known yet, in
 * parallel. Records may have been added since the last call. LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__feet_find(const laves__frame *frame, const laves__lattice *lattice, const uint32_t *wanted, laves__feet *feet,
                              laves_error *error);
/* Room for the feet of the sites in `wanted`, for whoever finds them otherwise; false when memory is short. */
bool laves__feet_make(const laves__lattice *lattice, const uint32_t *wanted, laves__feet *feet);
/* A foot for which there is room. */
static inline laves__foot *laves__feet_at(const laves__feet *feet, size_t record, int site) {
  return &feet->block[feet->block_of[record]][site];
}
/* A foot that was found (or OFF), else NULL. */
const laves__foot *laves__feet_get(const laves__feet *feet, int32_t record, int site);
void laves__feet_free(laves__feet *feet);

/* Whether a point lies inside, at least `depth` sizes from the surface. */
bool laves__lies_inside(const laves__frame *frame, laves__vec3 point, double depth);
/* The same outside. */
bool laves__lies_outside(const laves__frame *frame, laves__vec3 point, double depth);
/* Whether any of at most LAVES__POINTS_MAX does; quicker than one by one where they are near one another. */
enum { LAVES__POINTS_MAX = 32 };
bool laves__any_lies_outside(const laves__frame *frame, int count, const laves__vec3 *points, double depth);

#endif
