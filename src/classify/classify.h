/* Stage "classify": which cells of the lattice the surface may cross, and phi at their sites. */
#ifndef LAVES_CLASSIFY_CLASSIFY_H
#define LAVES_CLASSIFY_CLASSIFY_H

#include "background/lattice.h"

/* Fills an empty lattice: cells are outside, inside, or have records whose phi, sign, label (equal to sign) and hint are
 * set and which are linked.
 * Promise: every edge of the tiling whose ends differ in sign has both ends in records, where phi is known. A site whose
 * phi is infinite is further than the longest edge from the surface.
 * Of a graded background all vertices have records, and the hull is outside whatever the oracle says.
 * Cost: one oracle call for each site near the surface; LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__classify(const laves__frame *frame, laves__lattice *lattice, laves_error *error);

#endif
