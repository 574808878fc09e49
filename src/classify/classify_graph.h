/* Classification of a graded background. */
#ifndef LAVES_CLASSIFY_CLASSIFY_GRAPH_H
#define LAVES_CLASSIFY_CLASSIFY_GRAPH_H

#include "background/lattice.h"

/* What laves__classify() does for the tiling: phi, sign, label (equal to sign) and hint of all vertices of lattice->graph.
 * A vertex whose phi is infinite is further than its longest edge from the surface. The hull is outside, whatever the oracle
 * says. LAVES_ERROR_CANCELLED. */
laves_result laves__classify_graph(const laves__frame *frame, laves__lattice *lattice, laves_error *error);

#endif
