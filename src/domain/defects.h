/* Places of the defects of a surface: points, edges and faces, in input coordinates.
 *
 * Filled while the surface is judged, in its own coordinates, and moved to those of the input in the end. */
#ifndef LAVES_DOMAIN_DEFECTS_H
#define LAVES_DOMAIN_DEFECTS_H

#include "base/base.h"
#include "base/vec3.h"

typedef struct laves__defect_item {
  laves__vec3 corners[3];
  int32_t kind, corner_count;
} laves__defect_item;

struct laves_defects {
  laves_context *context;
  laves__defect_item *items;
  size_t count, capacity;
  bool short_of_memory; /* something was not noted */
};

void laves__defects_clear(laves_defects *defects);
void laves__defects_move(laves_defects *defects, laves__vec3 by);

/* Notes a place where `defects` is not NULL. */
void laves__defects_add(laves_defects *defects, laves_defect kind, int corner_count, const laves__vec3 *corners);

/* Counts a defect, keeps the place of the first of its kind (the middle of an edge, else the first corner), and notes it. */
void laves__note_defect(laves_domain_info *info, laves_defects *defects, laves_defect kind, int corner_count,
                        const laves__vec3 *corners);

#endif
