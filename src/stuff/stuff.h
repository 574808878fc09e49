/* Stage "stuff": the boundary with a proved window of dihedral angles, whatever the solid.
 *
 * Sites near a crossing of one of their edges snap there; the background tets that the surface still crosses are cut by
 * stencils. Used where snapping leaves the promised window, or for the whole.
 *
 *     rule.c       the thresholds and the windows proved for them        stuffing.h   the steps
 *     zone.c       where this way is taken
 *     stencil.c    how a background tet is cut                           links.c      look-ups
 *
 * Source: [labelle2007] for the idea on BCC; the rule and the windows on C15 are the project's own, docs/proof.md. */
#ifndef LAVES_STUFF_STUFF_H
#define LAVES_STUFF_STUFF_H

#include "snap/snap.h"
#include "stuff/rule.h"

typedef struct laves__stuff_counts {
  size_t vertices;    /* boundary vertices made by stuffing */
  size_t left;        /* sites beyond the zones that are boundary vertices, as snapping made them */
  size_t specks;      /* parts too small to keep, as snap.h tells; none that stuffing made */
  size_t unsnapped;   /* sites that came back because the boundary would have pinched */
  size_t relaxed;     /* boundary vertices moved for the sake of the window */
  double relaxed_max; /* the furthest, in sizes */
} laves__stuff_counts;

/* Makes the boundary at the sites of each record's `zone`, and leaves the labels that snapping gave to the others (zone.h). Zones
 * may grow. The layer is made anew; it must be empty.
 * Promise: the boundary is a closed 2-manifold; every tet all of whose background sites are in the zone is inside the window
 * of the guarantee. LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__stuff(const laves__frame *frame, const laves__guarantee *guarantee, laves__lattice *lattice,
                          laves__layer *layer, laves__stuff_counts *counts, laves_error *error);

#endif
