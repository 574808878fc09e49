/* The C15 (MgCu2 Laves) tiling as tables: one cubic period with its 24 sites and 136 tetrahedra.
 *
 * Coordinates are integers in quarter units: the period has side 8, the BCC lattice of the paper's section 3.2 has
 * spacing 4. Sites 0..3 are the paper's colour 0, sites 4..7 its colour 1 (together a diamond lattice, 16 neighbours
 * each), sites 8..23 the bond midpoints "m" (12 neighbours each). The mean of all edges is LAVES__C15_MEAN_EDGE.
 *
 *     edge    m-m      m-0, m-1    0-1
 *     length  sqrt 8   sqrt 11     sqrt 12     (quarter units)
 *     count   48       96          16          (per period)
 *
 * A tetrahedron belongs to the cell that holds the lowest corner of the cells of its vertices, so each of its corners
 * lies in the owner or one cell further along x, y or z. Neighbours and stars may lie one cell away in any direction.
 *
 * The table is made by tools/make_tiling with Qhull and rebuilt and compared by a test.
 * Source: [isotropic-tcp], section 3.2; docs/references.bib. */
#ifndef LAVES_BACKGROUND_C15_TABLE_H
#define LAVES_BACKGROUND_C15_TABLE_H

#include <stdint.h>

enum {
  LAVES__C15_SITES = 24,
  LAVES__C15_TETS = 136,
  LAVES__C15_PERIOD = 8,
  LAVES__C15_MAX_DEGREE = 16,
  LAVES__C15_MAX_STAR = 28,
};

/* (48 sqrt 8 + 96 sqrt 11 + 16 sqrt 12) / 160, the mean edge in quarter units. */
#define LAVES__C15_MEAN_EDGE 3.184913173150872
/* The longest edge, sqrt 12, over the mean edge. */
#define LAVES__C15_LONGEST_EDGE 1.087659671334361

/* Shift of a corner: bit 0 for x, bit 1 for y, bit 2 for z. */
typedef struct laves__c15_corner {
  uint8_t site;
  uint8_t shift;
} laves__c15_corner;

/* A site one step away: `cell` is (dx+1) + 3 (dy+1) + 9 (dz+1), so 13 is the same cell. */
typedef struct laves__c15_link {
  uint8_t site;
  uint8_t cell;
} laves__c15_link;

/* One tetrahedron of a site's star: its index in laves__c15_tet, the cell that owns it, which corner the site is,
 * and the three star entries that share a face with it that contains the site (the dual graph of the site's link). */
typedef struct laves__c15_star_tet {
  uint8_t tet;
  uint8_t cell;
  uint8_t corner;
  uint8_t across[3];
} laves__c15_star_tet;

extern const int8_t laves__c15_site[LAVES__C15_SITES][3];
extern const laves__c15_corner laves__c15_tet[LAVES__C15_TETS][4];
extern const uint8_t laves__c15_degree[LAVES__C15_SITES];
extern const laves__c15_link laves__c15_neighbour[LAVES__C15_SITES][LAVES__C15_MAX_DEGREE];
extern const uint8_t laves__c15_star_size[LAVES__C15_SITES];
extern const laves__c15_star_tet laves__c15_star[LAVES__C15_SITES][LAVES__C15_MAX_STAR];
/* Of a site and its k-th neighbour: bit i for each tet laves__c15_star[site][i] that has the edge between the two. */
extern const uint32_t laves__c15_star_with[LAVES__C15_SITES][LAVES__C15_MAX_DEGREE];

#endif
