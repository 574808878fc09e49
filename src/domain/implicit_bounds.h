/* The box around the solid of a tape, found and proved by interval arithmetic. */
#ifndef LAVES_DOMAIN_IMPLICIT_BOUNDS_H
#define LAVES_DOMAIN_IMPLICIT_BOUNDS_H

#include "domain/tape.h"

typedef enum laves__bounds_result {
  LAVES__BOUNDS_FOUND,
  LAVES__BOUNDS_EMPTY,
  LAVES__BOUNDS_ENDLESS,
  LAVES__BOUNDS_CANCELLED
} laves__bounds_result;

/* @param box  in: known to contain the solid, sides may be infinite; out: finite and close around it, when found */
laves__bounds_result laves__bounds_find(laves_context *context, const laves__tape *tape, laves__box3 *box);

#endif
