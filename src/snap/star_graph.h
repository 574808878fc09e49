/* Which tets of a star share a face at its site, and the pieces into which sets of them fall.
 *
 * Around a site tets form a ball; their outer faces triangulate a sphere, the site's link. Two of them share a face at the site
 * where their triangles share an edge. */
#ifndef LAVES_SNAP_STAR_GRAPH_H
#define LAVES_SNAP_STAR_GRAPH_H

#include "background/site.h"

/* Sets of tets of a star are bits, as laves__star_kept() has them. */
typedef struct laves__star_graph {
  uint64_t across[LAVES__STAR_LIMIT]; /* the neighbours of each */
  uint64_t all;
} laves__star_graph;

/* Of a site whose star is whole. */
void laves__star_graph_make(const laves__lattice *lattice, laves__site s, laves__star_graph *g);

/* The connected piece of a set that holds its lowest bit. */
uint64_t laves__first_piece(const laves__star_graph *g, uint64_t set);

#endif
