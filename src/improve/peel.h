/* Takes single tets away from the boundary. */
#ifndef LAVES_IMPROVE_PEEL_H
#define LAVES_IMPROVE_PEEL_H

#include "domain/frame.h"
#include "mesh/layer.h"

/* Removes a tet with all corners on the surface, when the boundary stays a manifold and features are kept without it. True when
 * it is gone. */
bool laves__peel_tet(const laves__frame *frame, laves__layer *layer, int32_t tet);

#endif
