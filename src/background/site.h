/* Sites and tetrahedra of the background, whatever it is: the tiling's come from its table, a graded background's from its
 * lists. What snap and its like ask of their surroundings they ask here, so that one code serves both.
 *
 *                   the tiling                      a graph
 *     site          site of a record's cell         vertex v: site v % 24 of record v / 24
 *     tet           tet of a record's cell          tet t: t % 136 of chunk t / 136
 *     neighbours    laves__c15_neighbour            graph->link
 *     star          laves__c15_star                 graph->star
 *     tet's flags   bits of the record              graph->flags
 *
 * Of the tiling, a neighbour or the owner of a tet may be a cell without a record, LAVES__IN or LAVES__OUT; of a graph,
 * never. The last record of a graph is filled up with sites that do not exist: outside, without neighbours, hull. */
#ifndef LAVES_BACKGROUND_SITE_H
#define LAVES_BACKGROUND_SITE_H

#include "background/lattice.h"

/* ---- sites ---- */

/* One number for a site that has a record: record * 24 + site, or the vertex of the graph. */
static inline uint32_t laves__site_id(laves__site s) { return (uint32_t)s.cell * LAVES__C15_SITES + s.site; }
static inline laves__site laves__site_of(uint32_t id) {
  return (laves__site){(int32_t)(id / LAVES__C15_SITES), (uint8_t)(id % LAVES__C15_SITES)};
}

/* Where a site that has a record lies. */
static inline laves__vec3 laves__site_place(const laves__lattice *lattice, laves__site s) {
  if (lattice->graph) return lattice->graph->position[laves__site_id(s)];
  return laves__site_position(lattice->record[s.cell].xyz, s.site);
}

/* The mean edge that is wished around a site, in sizes: thresholds in sizes are multiplied by it. */
static inline double laves__site_scale(const laves__lattice *lattice, laves__site s) {
  return lattice->graph ? (double)lattice->graph->scale[laves__site_id(s)] : 1;
}

/* Whether a site is outside for good: it never goes ON. */
static inline bool laves__is_hull(const laves__lattice *lattice, laves__site s) {
  const laves__graph *g = lattice->graph;
  return g && (laves__site_id(s) >= g->vertex_count || g->hull[laves__site_id(s)]);
}

/* ---- neighbours ---- */

/* The sites one edge away. */
typedef struct laves__ring {
  const int32_t *around;       /* of the tiling: of the record, */
  const laves__c15_link *link; /* and the table's row */
  const int32_t *vertex;       /* of a graph; else NULL */
  int count;
} laves__ring;

static inline laves__ring laves__ring_of(const laves__lattice *lattice, laves__site s) {
  const laves__graph *g = lattice->graph;
  if (!g) return (laves__ring){lattice->record[s.cell].around, laves__c15_neighbour[s.site], NULL, laves__c15_degree[s.site]};
  const size_t v = laves__site_id(s);
  if (v >= g->vertex_count) return (laves__ring){0};
  return (laves__ring){NULL, NULL, g->link + g->link_first[v], (int)(g->link_first[v + 1] - g->link_first[v])};
}
static inline laves__site laves__ring_at(const laves__ring *ring, int k) {
  if (ring->vertex) return laves__site_of((uint32_t)ring->vertex[k]);
  LAVES_ASSERT(ring->around); /* a ring of none is not asked */
  return (laves__site){ring->around[ring->link[k].cell], ring->link[k].site};
}

/* ---- tetrahedra ---- */

typedef struct laves__tet {
  int32_t cell; /* the owner as in laves__brick.cell, or the chunk */
  uint8_t tet;
} laves__tet;

/* All tets, chunk by chunk: those of a record, or LAVES__C15_TETS of the graph in a row. */
static inline size_t laves__chunk_count(const laves__lattice *lattice) {
  const laves__graph *g = lattice->graph;
  return g ? (g->tet_count + LAVES__C15_TETS - 1) / LAVES__C15_TETS : lattice->record_count;
}
static inline int laves__chunk_size(const laves__lattice *lattice, size_t chunk) {
  if (!lattice->graph) return LAVES__C15_TETS;
  const size_t rest = lattice->graph->tet_count - chunk * LAVES__C15_TETS;
  return rest < LAVES__C15_TETS ? (int)rest : LAVES__C15_TETS;
}

/* The number in the graph. */
static inline size_t laves__graph_tet(laves__tet t) { return (size_t)t.cell * LAVES__C15_TETS + t.tet; }

/* The corners of a tet that has an owner. */
static inline void laves__corners_of(const laves__lattice *lattice, laves__tet t, laves__site corners[4]) {
  if (lattice->graph) {
    const int32_t *tet = lattice->graph->tet[laves__graph_tet(t)];
    for (int k = 0; k < 4; k++) corners[k] = laves__site_of((uint32_t)tet[k]);
  } else {
    laves__tet_sites(&lattice->record[t.cell], t.tet, corners);
  }
}

/* The flags of a tet that has an owner. */
static inline uint64_t *laves__tet_bits(laves__record *r, laves__tet_flag flag) {
  return flag == LAVES__TET_SOLID      ? r->solid
         : flag == LAVES__TET_ELIGIBLE ? r->eligible
         : flag == LAVES__TET_STAMPED  ? r->stamped
                                       : r->layer;
}
static inline bool laves__tet_is(const laves__lattice *lattice, laves__tet t, laves__tet_flag flag) {
  if (lattice->graph) return lattice->graph->flags[laves__graph_tet(t)] & flag;
  return laves__bit(laves__tet_bits(&lattice->record[t.cell], flag), t.tet);
}
static inline void laves__toggle_tet(const laves__lattice *lattice, laves__tet t, laves__tet_flag flag) {
  if (lattice->graph)
    lattice->graph->flags[laves__graph_tet(t)] ^= (uint8_t)flag;
  else
    laves__flip_bit(laves__tet_bits(&lattice->record[t.cell], flag), t.tet);
}

/* ---- stars ---- */

/* A tet around a site, and which of its corners the site is. */
typedef struct laves__star_tet {
  laves__tet tet;
  int corner;
} laves__star_tet;

static inline int laves__star_size(const laves__lattice *lattice, laves__site s) {
  const laves__graph *g = lattice->graph;
  if (!g) return laves__c15_star_size[s.site];
  const size_t v = laves__site_id(s);
  return v < g->vertex_count ? (int)(g->star_first[v + 1] - g->star_first[v]) : 0;
}
static inline laves__star_tet laves__star_at(const laves__lattice *lattice, laves__site s, int k) {
  const laves__graph *g = lattice->graph;
  if (!g) {
    const laves__c15_star_tet *star = &laves__c15_star[s.site][k];
    return (laves__star_tet){{lattice->record[s.cell].around[star->cell], star->tet}, star->corner};
  }
  const int32_t v = (int32_t)laves__site_id(s), t = g->star[g->star_first[v] + (uint32_t)k], *tet = g->tet[t];
  return (laves__star_tet){{t / LAVES__C15_TETS, (uint8_t)(t % LAVES__C15_TETS)},
                           tet[0] == v   ? 0
                           : tet[1] == v ? 1
                           : tet[2] == v ? 2
                                         : 3};
}
/* Which of the star's tets a tet that has an owner is. */
static inline int laves__star_slot(const laves__lattice *lattice, laves__site s, laves__tet t) {
  for (int k = 0;; k++) {
    LAVES_ASSERT(k < laves__star_size(lattice, s));
    const laves__tet at = laves__star_at(lattice, s, k).tet;
    if (at.cell == t.cell && at.tet == t.tet) return k;
  }
}
/* The bits of a whole star, one for each tet; at most LAVES__STAR_LIMIT. */
static inline uint64_t laves__whole_star(const laves__lattice *lattice, laves__site s) {
  return (UINT64_C(1) << laves__star_size(lattice, s)) - 1;
}

#endif
