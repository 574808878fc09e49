/* Fills the look-ups of links.h from the tiling's table. */
#include "stuff/links.h"

enum { SAME_CELL = 13 };

static int cell_of_shift(int shift) { return (shift & 1) + 3 * (shift >> 1 & 1) + 9 * (shift >> 2); }

/* The neighbour of a site that lies `cell` cells on, as a difference of two positions in 3 x 3 x 3. */
static uint8_t find_neighbour(int site, int other, int cell) {
  int k = 0;
  while (laves__c15_neighbour[site][k].site != other || laves__c15_neighbour[site][k].cell != cell) k++;
  LAVES_ASSERT(k < laves__c15_degree[site]);
  return (uint8_t)k;
}

static void fill_tet(laves__links *links, int tet) {
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++) {
      if (i == j) continue;
      const laves__c15_corner a = laves__c15_tet[tet][i], b = laves__c15_tet[tet][j];
      const int cell = SAME_CELL + cell_of_shift(b.shift) - cell_of_shift(a.shift);
      links->slot[tet][i][j] = find_neighbour(a.site, b.site, cell);
    }
}

static void fill_neighbours(laves__links *links, int site) {
  const int32_t here[3] = {0, 0, 0};
  for (int k = 0; k < laves__c15_degree[site]; k++) {
    const laves__c15_link n = laves__c15_neighbour[site][k];
    links->back[site][k] = find_neighbour(n.site, site, 2 * SAME_CELL - n.cell);
    const int32_t there[3] = {n.cell % 3 - 1, n.cell / 3 % 3 - 1, n.cell / 9 - 1};
    links->length2[site][k] = v3_norm2(v3_sub(laves__site_position(there, n.site), laves__site_position(here, site)));
  }
}

static bool has_link_vertex(const laves__links *links, int site, int slot, int neighbour) {
  const uint8_t *l = links->link[site][slot];
  return l[0] == neighbour || l[1] == neighbour || l[2] == neighbour;
}

static void fill_star(laves__links *links, int site) {
  const int size = laves__c15_star_size[site];
  for (int k = 0; k < size; k++) {
    const laves__c15_star_tet star = laves__c15_star[site][k];
    for (int corner = 0, n = 0; corner < 4; corner++)
      if (corner != star.corner) links->link[site][k][n++] = links->slot[star.tet][star.corner][corner];
  }
  for (int k = 0; k < size; k++)
    for (int j = 0; j < 3; j++) {
      const uint8_t a = links->link[site][k][(j + 1) % 3], b = links->link[site][k][(j + 2) % 3];
      int other = 0;
      while (other == k || !has_link_vertex(links, site, other, a) || !has_link_vertex(links, site, other, b)) other++;
      LAVES_ASSERT(other < size);
      links->across[site][k][j] = (uint8_t)other;
    }
}

void laves__links_fill(laves__links *links) {
  for (int tet = 0; tet < LAVES__C15_TETS; tet++) fill_tet(links, tet);
  for (int site = 0; site < LAVES__C15_SITES; site++) fill_neighbours(links, site);
  for (int site = 0; site < LAVES__C15_SITES; site++) fill_star(links, site);
}
