/* What the steps of stuffing share: the lattice with its labels, where its edges are crossed, and how its sites snap.
 *
 *     crossing.c   where each edge from an inner to an outer site crosses the surface
 *     warp.c       which sites snap, and which of them come back because the boundary would pinch
 *     closure.c    boundary vertices relaxed until every piece is inside a higher window
 *     pieces.c     the pieces of cut tetrahedra and their vertices, for the layer */
#ifndef LAVES_STUFF_STUFFING_H
#define LAVES_STUFF_STUFFING_H

#include "snap/snap.h"
#include "stuff/links.h"
#include "stuff/stencil.h"

/* An inner site's edges to outer sites. */
typedef struct laves__crossings {
  double fraction[LAVES__C15_MAX_DEGREE]; /* of the edge to neighbour k, where `set` has bit k */
  uint16_t set, relaxed;                  /* bits of neighbours */
} laves__crossings;

/* How a site snaps. */
typedef struct laves__snapped {
  double share;  /* of the edge to neighbour `along`, as far as the site moves */
  uint8_t along; /* UINT8_MAX: it does not snap */
  bool relaxed;
} laves__snapped;

typedef struct laves__stuffing {
  const laves__frame *frame;
  const laves__guarantee *guarantee;
  laves__lattice *lattice;
  laves__links links;
  size_t site_count; /* sites of the records that there were at the start */
  int32_t *crossed;  /* [site_count] index in `crossings`, or -1 */
  laves__crossings *crossings;
  size_t crossing_count;
  laves__snapped *snapped; /* [site_count] */
  size_t relaxed_count;
  double relaxed_max; /* the furthest that a vertex was moved off the surface by relaxation, in sizes */
} laves__stuffing;

/* Frees what the steps made; the rest stays for another start. */
void laves__free_stuffing(laves__stuffing *s);

/* Sets `crossed` and `crossings` for all edges with one end IN and one OUT. */
laves_result laves__find_crossings(laves__stuffing *s, laves_error *error);

/* The crossing on the edge from a site to its neighbour k, seen from the inner end: its list and *k there. NULL: none. */
laves__crossings *laves__crossing_at(const laves__stuffing *s, laves__site site, int k, int *slot);

/* Snaps the sites of the zone (record.zone) that are violated: label ON. */
laves_result laves__warp(laves__stuffing *s, laves_error *error);
/* Takes snaps of inner sites back where nothing would be kept around them; *unsnapped counts them. */
laves_result laves__keep_inner(laves__stuffing *s, size_t *unsnapped, laves_error *error);
/* Takes snaps back until the boundary is a manifold; *unsnapped counts them. Sites outside the zone that pinch are listed in
 * `parted` where cuts are far; where they are near, they join the zone with their neighbours, and *grown is set: everything
 * must be done again then. */
laves_result laves__unpinch(laves__stuffing *s, laves__parted *parted, size_t *unsnapped, bool *grown, laves_error *error);

/* Relaxes vertices until every piece is inside the guarantee's window. */
laves_result laves__close(laves__stuffing *s, laves_error *error);

/* Where a site of the zone stands. */
laves__vec3 laves__stuffed_position(const laves__stuffing *s, laves__site site);

/* The background tet `tet` of a record as it is now; false when it has no corner IN and is dropped. */
bool laves__stuffed_tet(const laves__stuffing *s, int32_t record, int tet, laves__cut_tet *out);

/* The feet of the ON sites of the zone, and the cuts. `feet` may hold others already. */
laves_result laves__make_pieces(laves__stuffing *s, laves__feet *feet, laves__cuts *cuts, laves_error *error);

#endif
