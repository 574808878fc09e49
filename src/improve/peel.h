/* Takes single tets away from the boundary. */
#ifndef LAVES_IMPROVE_PEEL_H
#define LAVES_IMPROVE_PEEL_H

#include "mesh/layer.h"

/* Removes a tet with all corners on the surface, when the boundary stays a manifold without it. True when it is gone. */
bool laves__peel_tet(laves__layer *layer, int32_t tet);

#endif
