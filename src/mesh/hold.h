/* What a boundary vertex is held to: a patch of the surface, a crease or a corner of the domain's features. */
#ifndef LAVES_MESH_HOLD_H
#define LAVES_MESH_HOLD_H

#include <stdint.h>

/* In the order of freedom: a vertex moves anywhere on the surface, on a patch, along a crease, not at all. */
typedef enum laves__hold_kind { LAVES__HOLD_SURFACE, LAVES__HOLD_PATCH, LAVES__HOLD_CREASE, LAVES__HOLD_CORNER } laves__hold_kind;

typedef struct laves__hold {
  int32_t id; /* of the patch, crease or corner */
  uint8_t kind;
} laves__hold;

#endif
