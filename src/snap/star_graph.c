/* The tiling's stars come from the table; those of a graph are matched edge by edge of the link. */
#include "snap/star_graph.h"

#include <string.h>

#include "mesh/mesh.h"

/* Of a site of the tiling: from the table. */
static void read_table(int site, laves__star_graph *g) {
  g->all = (UINT64_C(1) << laves__c15_star_size[site]) - 1;
  for (int k = 0; k < laves__c15_star_size[site]; k++) {
    g->across[k] = 0;
    for (int j = 0; j < 3; j++) g->across[k] |= UINT64_C(1) << laves__c15_star[site][k].across[j];
  }
}

/* Which of its neighbours, which are ascending, a vertex of a graph is. */
static int rank_in(const laves__ring *ring, int32_t vertex) {
  int low = 0;
  for (int high = ring->count - 1; low < high;) {
    const int middle = (low + high) / 2;
    if (ring->vertex[middle] < vertex)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Of a vertex of a graph: two tets of the star share a face at it when they have an edge of the link in common. */
static void match_link(const laves__lattice *lattice, laves__site s, laves__star_graph *g) {
  enum { NOBODY = UINT8_MAX };
  const laves__ring ring = laves__ring_of(lattice, s);
  const int size = laves__star_size(lattice, s);
  uint8_t first[LAVES__LINK_LIMIT][LAVES__LINK_LIMIT]; /* the tet that was seen first at an edge of the link */
  LAVES_ASSERT(ring.count <= LAVES__LINK_LIMIT && size <= LAVES__STAR_LIMIT);
  memset(first, NOBODY, (size_t)ring.count * sizeof first[0]);
  memset(g->across, 0, (size_t)size * sizeof g->across[0]);
  g->all = laves__whole_star(lattice, s);
  for (int k = 0; k < size; k++) {
    const laves__star_tet star = laves__star_at(lattice, s, k);
    const int32_t *tet = lattice->graph->tet[laves__graph_tet(star.tet)];
    int rank[3];
    for (int j = 0; j < 3; j++) rank[j] = rank_in(&ring, tet[laves__tet_face[star.corner][j]]);
    for (int j = 0; j < 3; j++) {
      const int a = rank[j], b = rank[(j + 1) % 3];
      uint8_t *other = &first[a < b ? a : b][a < b ? b : a];
      if (*other == NOBODY) {
        *other = (uint8_t)k;
      } else {
        g->across[k] |= UINT64_C(1) << *other;
        g->across[*other] |= UINT64_C(1) << k;
      }
    }
  }
}

void laves__star_graph_make(const laves__lattice *lattice, laves__site s, laves__star_graph *g) {
  if (lattice->graph)
    match_link(lattice, s, g);
  else
    read_table(s.site, g);
}

uint64_t laves__first_piece(const laves__star_graph *g, uint64_t set) {
  uint64_t piece = set & -set, front = piece;
  while (front) {
    uint64_t reached = 0;
    for (; front; front &= front - 1) reached |= g->across[__builtin_ctzll(front)];
    front = reached & set & ~piece;
    piece |= front;
  }
  return piece;
}
