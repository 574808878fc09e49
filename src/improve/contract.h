/* Removes one edge. */
#ifndef LAVES_IMPROVE_CONTRACT_H
#define LAVES_IMPROVE_CONTRACT_H

#include "improve/journal.h"
#include "improve/measure.h"

/* Contracts an edge of `tet`, the shortest that helps: one end goes, its tets are joined to the other, the neighbourhood is
 * smoothed. Accepted when the worst of all tets touched is better than the worst around the edge was, the boundary keeps
 * its topology and stays as near to the surface; otherwise everything is as it was.

 * `rounds`: how often the neighbourhood is smoothed before it is judged.
 * True when an edge was contracted; `tet` may be gone then. */
bool laves__contract_tet(const laves__frame *frame, const laves__measure *measure, double target, laves__layer *layer,
                         int32_t tet, int rounds, laves__journal *journal);

#endif
