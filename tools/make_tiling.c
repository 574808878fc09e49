/* Makes src/background/c15_table.c: the C15 tiling of space, found by Qhull from the rule that places its vertices.
 *
 *     make_tiling > src/background/c15_table.c
 *
 * Sites come from the BCC lattice of spacing 4 (quarter units): a node's colour is the sum of its coordinates over two,
 * modulo 4. Nodes of colours 0 and 1 are kept; those of colours 2 and 3 are replaced by the midpoints of the
 * shortest segments from a 2 to a 3. The tets are the Delaunay tetrahedralisation of 5 x 5 x 5 periods, of which those
 * are written that the middle period owns; no two of them share a circumsphere, so there is only one.
 * Source: [isotropic-tcp], section 3.2; Qhull: [barber1996]. The format is told in src/background/c15_table.h. */
#include <libqhull_r/libqhull_r.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SITES = 24, TETS = 136, PERIOD = 8, SPAN = 2, PATCH = 2 * SPAN + 1, MAX_DEGREE = 16, MAX_STAR = 28 };

/* A site of some period. */
typedef struct corner {
  int cell[3];
  int site;
} corner;

typedef struct link {
  int cell, site;
} link;

typedef struct star_tet {
  int cell, tet, corner, across[3];
} star_tet;

typedef struct tiling {
  int site[SITES][3];
  int site_count;
  corner tet[TETS][4]; /* corners by cell and site, but for the last two, which are in the order that makes it positive */
  int tet_count;
} tiling;

static void fail(const char *what) {
  fprintf(stderr, "make_tiling: %s\n", what);
  exit(1);
}

/* ---- sites ---- */

static int colour(int x, int y, int z) { return (((x + y + z) / 2) % 4 + 4) % 4; }
static bool is_node(int x, int y, int z) {
  return (x % 4 == 0 && y % 4 == 0 && z % 4 == 0) || (abs(x) % 4 == 2 && abs(y) % 4 == 2 && abs(z) % 4 == 2);
}

static bool is_midpoint(int x, int y, int z) {
  for (int k = 0; k < 4; k++) { /* the four diagonals along which nodes are nearest */
    const int dx = 1, dy = k & 1 ? -1 : 1, dz = k & 2 ? -1 : 1;
    if (!is_node(x + dx, y + dy, z + dz) || !is_node(x - dx, y - dy, z - dz)) continue;
    const int a = colour(x + dx, y + dy, z + dz), b = colour(x - dx, y - dy, z - dz);
    if ((a == 2 && b == 3) || (a == 3 && b == 2)) return true;
  }
  return false;
}

/* Sites of one period: colour 0, colour 1, midpoints, each by coordinates. */
static void place_sites(tiling *t) {
  for (int kind = 0; kind < 3; kind++) {
    for (int i = 0; i < PERIOD * PERIOD * PERIOD; i++) {
      const int x = i / (PERIOD * PERIOD), y = i / PERIOD % PERIOD, z = i % PERIOD;
      if (kind < 2 ? !is_node(x, y, z) || colour(x, y, z) != kind : !is_midpoint(x, y, z)) continue;
      if (t->site_count == SITES) fail("more than 24 sites");
      memcpy(t->site[t->site_count++], (int[3]){x, y, z}, sizeof t->site[0]);
    }
  }
  if (t->site_count != SITES) fail("fewer than 24 sites");
}

/* ---- tets ---- */

static int by_cell_then_site(const void *a, const void *b) {
  const corner *p = a, *q = b;
  for (int i = 2; i >= 0; i--) {
    if (p->cell[i] != q->cell[i]) return p->cell[i] - q->cell[i];
  }
  return p->site - q->site;
}

static int by_corners(const void *a, const void *b) {
  for (int k = 0; k < 4; k++) {
    const int order = by_cell_then_site((const corner *)a + k, (const corner *)b + k);
    if (order) return order;
  }
  return 0;
}

/* Keeps a tet whose lowest corner of the cells of its vertices is the middle period. */
static void keep_if_owned(tiling *t, corner c[4]) {
  for (int i = 0; i < 3; i++) {
    int lowest = c[0].cell[i];
    for (int k = 1; k < 4; k++) lowest = c[k].cell[i] < lowest ? c[k].cell[i] : lowest;
    if (lowest != 0) return;
  }
  if (t->tet_count == TETS) fail("more than 136 tetrahedra in a period");
  qsort(c, 4, sizeof *c, by_cell_then_site);
  memcpy(t->tet[t->tet_count++], c, sizeof t->tet[0]);
}

static void find_tets(tiling *t) {
  static coordT points[PATCH * PATCH * PATCH * SITES][3];
  static corner name[PATCH * PATCH * PATCH * SITES];
  int count = 0;
  for (int i = 0; i < PATCH * PATCH * PATCH; i++) {
    const int cell[3] = {i % PATCH - SPAN, i / PATCH % PATCH - SPAN, i / (PATCH * PATCH) - SPAN};
    for (int s = 0; s < SITES; s++, count++) {
      name[count] = (corner){{cell[0], cell[1], cell[2]}, s};
      for (int k = 0; k < 3; k++) points[count][k] = t->site[s][k] + PERIOD * cell[k];
    }
  }
  char command[] = "qhull d Qbb Q12";
  qhT qh_memory, *qh = &qh_memory;
  qh_zero(qh, stderr);
  if (qh_new_qhull(qh, 3, count, points[0], False, command, NULL, stderr)) fail("Qhull failed");
  facetT *facet;
  FORALLfacets {
    if (facet->upperdelaunay) continue;
    corner c[4];
    int corners = 0;
    vertexT *vertex, **vertexp;
    FOREACHvertex_(facet->vertices) {
      if (corners < 4) c[corners] = name[qh_pointid(qh, vertex->point)];
      corners++;
    }
    if (corners == 4) keep_if_owned(t, c);
  }
  qh_freeqhull(qh, qh_ALL);
  if (t->tet_count != TETS) fail("fewer than 136 tetrahedra in a period");
}

/* Six times the volume with the corners as sorted. */
static int signed_volume(const tiling *t, const corner c[4]) {
  int e[3][3];
  for (int k = 0; k < 3; k++) {
    for (int i = 0; i < 3; i++) {
      e[k][i] = t->site[c[k + 1].site][i] - t->site[c[0].site][i] + PERIOD * (c[k + 1].cell[i] - c[0].cell[i]);
    }
  }
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

static void turn_positive(tiling *t) {
  for (int i = 0; i < TETS; i++) {
    if (signed_volume(t, t->tet[i]) > 0) continue;
    const corner last = t->tet[i][3];
    t->tet[i][3] = t->tet[i][2];
    t->tet[i][2] = last;
  }
}

/* ---- neighbours and stars ---- */

/* The code of the step from one cell to another. */
static int step_code(const int from[3], const int to[3]) {
  return to[0] - from[0] + 1 + 3 * (to[1] - from[1] + 1) + 9 * (to[2] - from[2] + 1);
}

static int by_link(const void *a, const void *b) {
  const link *p = a, *q = b;
  return p->cell != q->cell ? p->cell - q->cell : p->site - q->site;
}

static int by_star(const void *a, const void *b) {
  const star_tet *p = a, *q = b;
  return p->cell != q->cell ? p->cell - q->cell : p->tet - q->tet;
}

static int star_of(const tiling *t, int site, star_tet star[MAX_STAR]) {
  static const int home[3] = {0, 0, 0};
  int count = 0;
  for (int i = 0; i < TETS; i++) {
    for (int k = 0; k < 4; k++) {
      if (t->tet[i][k].site != site) continue;
      if (count == MAX_STAR) fail("a star with more than 28 tetrahedra");
      star[count++] = (star_tet){.cell = step_code(t->tet[i][k].cell, home), .tet = i, .corner = k};
    }
  }
  qsort(star, (size_t)count, sizeof *star, by_star);
  return count;
}

/* A corner of a star's tet as a link from the site in the middle. */
static link link_in_star(const tiling *t, const star_tet *s, int k) {
  const corner *middle = &t->tet[s->tet][s->corner], *other = &t->tet[s->tet][k];
  return (link){step_code(middle->cell, other->cell), other->site};
}

static int common_corners(const tiling *t, const star_tet *a, const star_tet *b) {
  int common = 0;
  for (int i = 0; i < 4; i++) {
    for (int j = 0; j < 4; j++) {
      const link p = link_in_star(t, a, i), q = link_in_star(t, b, j);
      common += by_link(&p, &q) == 0;
    }
  }
  return common;
}

static void join_star(const tiling *t, star_tet *star, int count) {
  for (int i = 0; i < count; i++) {
    int found = 0;
    for (int j = 0; j < count; j++) {
      if (j != i && common_corners(t, &star[i], &star[j]) == 3 && found < 3) star[i].across[found++] = j;
    }
    if (found != 3) fail("a star that is not closed");
  }
}

static int neighbours_of(const tiling *t, int site, link out[MAX_DEGREE]) {
  star_tet star[MAX_STAR];
  const int star_count = star_of(t, site, star);
  int count = 0;
  for (int i = 0; i < 4 * star_count; i++) {
    const link next = link_in_star(t, &star[i / 4], i % 4);
    bool known = i % 4 == star[i / 4].corner;
    for (int j = 0; j < count; j++) known = known || by_link(&next, &out[j]) == 0;
    if (known) continue;
    if (count == MAX_DEGREE) fail("a site with more than 16 neighbours");
    out[count++] = next;
  }
  qsort(out, (size_t)count, sizeof *out, by_link);
  return count;
}

/* ---- output ---- */

static void print_sites(const tiling *t) {
  printf("const int8_t laves__c15_site[LAVES__C15_SITES][3] = {\n");
  for (int s = 0; s < SITES; s++) {
    printf("%s{%d, %d, %d},%s", s % 6 ? " " : "  ", t->site[s][0], t->site[s][1], t->site[s][2], s % 6 == 5 ? "\n" : "");
  }
  printf("};\n\n");
}

static void print_tets(const tiling *t) {
  printf("const laves__c15_corner laves__c15_tet[LAVES__C15_TETS][4] = {\n");
  for (int i = 0; i < TETS; i++) {
    printf(i % 2 ? " {" : "  {");
    for (int k = 0; k < 4; k++) {
      const corner *c = &t->tet[i][k];
      printf("%s{%d, %d}", k ? ", " : "", c->site, c->cell[0] + 2 * c->cell[1] + 4 * c->cell[2]);
    }
    printf(i % 2 ? "},\n" : "},");
  }
  printf("};\n\n");
}

static void print_neighbours(const tiling *t) {
  link links[MAX_DEGREE];
  printf("const uint8_t laves__c15_degree[LAVES__C15_SITES] = {");
  for (int s = 0; s < SITES; s++) printf("%s%d", s ? ", " : "", neighbours_of(t, s, links));
  printf("};\n\nconst laves__c15_link laves__c15_neighbour[LAVES__C15_SITES][LAVES__C15_MAX_DEGREE] = {\n");
  for (int s = 0; s < SITES; s++) {
    const int count = neighbours_of(t, s, links);
    for (int i = 0; i < count; i++) printf("%s{%d, %d}", i ? ", " : "  {", links[i].site, links[i].cell);
    printf("},\n");
  }
  printf("};\n\n");
}

static void print_stars(const tiling *t) {
  star_tet star[MAX_STAR];
  printf("const uint8_t laves__c15_star_size[LAVES__C15_SITES] = {");
  for (int s = 0; s < SITES; s++) printf("%s%d", s ? ", " : "", star_of(t, s, star));
  printf("};\n\nconst laves__c15_star_tet laves__c15_star[LAVES__C15_SITES][LAVES__C15_MAX_STAR] = {\n");
  for (int s = 0; s < SITES; s++) {
    const int count = star_of(t, s, star);
    join_star(t, star, count);
    for (int i = 0; i < count; i++) {
      printf("%s{%d, %d, %d, {%d, %d, %d}}", i ? ", " : "  {", star[i].tet, star[i].cell, star[i].corner, star[i].across[0],
             star[i].across[1], star[i].across[2]);
    }
    printf("},\n");
  }
  printf("};\n\n");
}

/* Bit i for star[i] where the link is a corner of it. */
static unsigned tets_with(const tiling *t, const star_tet *star, int count, const link *with) {
  unsigned tets = 0;
  for (int i = 0; i < 4 * count; i++) {
    const link corner = link_in_star(t, &star[i / 4], i % 4);
    if (by_link(&corner, with) == 0) tets |= 1u << i / 4;
  }
  return tets;
}

static void print_stars_of_neighbours(const tiling *t) {
  star_tet star[MAX_STAR];
  link links[MAX_DEGREE];
  printf("const uint32_t laves__c15_star_with[LAVES__C15_SITES][LAVES__C15_MAX_DEGREE] = {\n");
  for (int s = 0; s < SITES; s++) {
    const int count = star_of(t, s, star), degree = neighbours_of(t, s, links);
    for (int i = 0; i < degree; i++) printf("%s0x%x", i ? ", " : "  {", tets_with(t, star, count, &links[i]));
    printf("},\n");
  }
  printf("};\n");
}

int main(void) {
  static tiling t;
  place_sites(&t);
  find_tets(&t);
  turn_positive(&t);
  qsort(t.tet, TETS, sizeof t.tet[0], by_corners);
  printf(
      "/* Generated by tools/make_tiling: do not edit. The C15 (Laves) tiling, one cubic period of side 8 quarter units. */\n");
  printf("#include \"background/c15_table.h\"\n\n");
  print_sites(&t);
  print_tets(&t);
  print_neighbours(&t);
  print_stars(&t);
  print_stars_of_neighbours(&t);
  return 0;
}
