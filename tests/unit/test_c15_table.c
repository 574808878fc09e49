/* The tables of the tiling, checked against one another and against what is known of C15, without Qhull. */
#include "background/c15_table.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

#include "mesh/mesh.h"
#include "mesh/quality.h"

/* A site of any cell as one number, for offsets of -4 .. 3 cells. */
static int node(int site, int dx, int dy, int dz) { return site + 32 * (dx + 4 + 8 * (dy + 4) + 64 * (dz + 4)); }

static int corner_node(laves__c15_corner c, int dx, int dy, int dz) {
  return node(c.site, dx + (c.shift & 1), dy + (c.shift >> 1 & 1), dz + (c.shift >> 2));
}

static void cell_offset(int cell, int d[3]) {
  d[0] = cell % 3 - 1;
  d[1] = cell / 3 % 3 - 1;
  d[2] = cell / 9 - 1;
}

static laves__vec3 corner_point(laves__c15_corner c) {
  const int8_t *s = laves__c15_site[c.site];
  return v3(s[0] + 8 * (c.shift & 1), s[1] + 8 * (c.shift >> 1 & 1), s[2] + 8 * (c.shift >> 2));
}

static void corner_points(int tet, laves__vec3 p[4]) {
  for (int i = 0; i < 4; i++) p[i] = corner_point(laves__c15_tet[tet][i]);
}

/* How many corners are midpoints, "m" in the notes. */
static int midpoints(int tet) {
  int count = 0;
  for (int i = 0; i < 4; i++) count += laves__c15_tet[tet][i].site >= 8;
  return count;
}

static int compare_ints(const void *a, const void *b) { return *(const int *)a - *(const int *)b; }

/* ---- sites and tets ---- */

/* Colours by the doubled coordinates; a midpoint is the sum of the doubled coordinates of a 2 and a 3. */
static void sites_follow_the_rule(void **state) {
  (void)state;
  for (int i = 0; i < LAVES__C15_SITES; i++) {
    const int8_t *s = laves__c15_site[i];
    const int sum = s[0] + s[1] + s[2];
    for (int k = 0; k < 3; k++) assert_true(s[k] >= 0 && s[k] < LAVES__C15_PERIOD && (s[k] % 2 != 0) == (i >= 8));
    if (i < 8) assert_int_equal(sum / 2 % 4, i / 4);
    if (i >= 8) assert_int_equal(sum % 4, 1);
    for (int j = 0; j < i; j++)
      assert_true(s[0] != laves__c15_site[j][0] || s[1] != laves__c15_site[j][1] || s[2] != laves__c15_site[j][2]);
  }
}

static void tets_are_positive_and_fill(void **state) {
  (void)state;
  double sum = 0;
  for (int t = 0; t < LAVES__C15_TETS; t++) {
    laves__vec3 p[4];
    corner_points(t, p);
    const double determinant = v3_det(p[0], p[1], p[2], p[3]);
    assert_true(determinant > 0);
    sum += determinant;
  }
  assert_true(sum == 6.0 * LAVES__C15_PERIOD * LAVES__C15_PERIOD * LAVES__C15_PERIOD);
}

/* The owner is the cell with the lowest corners on each axis; corners and tets are in the order of the tool. */
static void tets_have_their_owner(void **state) {
  (void)state;
  for (int t = 0; t < LAVES__C15_TETS; t++) {
    unsigned all = 7;
    for (int i = 0; i < 4; i++) {
      all &= laves__c15_tet[t][i].shift;
      assert_true(laves__c15_tet[t][i].site < LAVES__C15_SITES && laves__c15_tet[t][i].shift < 8);
    }
    assert_int_equal(all, 0);
  }
}

/* Every face of every tet, moved so that its lowest node lies in the first cell, occurs exactly twice. */
static void faces_have_two_tets(void **state) {
  (void)state;
  enum { FACES = 4 * LAVES__C15_TETS };
  static int faces[FACES][3];
  for (int f = 0; f < FACES; f++) {
    laves__c15_corner c[3];
    int low[3] = {1, 1, 1};
    for (int i = 0; i < 3; i++) {
      c[i] = laves__c15_tet[f / 4][laves__tet_face[f % 4][i]];
      for (int k = 0; k < 3; k++) low[k] = (c[i].shift >> k & 1) < low[k] ? 0 : low[k];
    }
    for (int i = 0; i < 3; i++) faces[f][i] = corner_node(c[i], -low[0], -low[1], -low[2]);
    qsort(faces[f], 3, sizeof(int), compare_ints);
  }
  for (int f = 0; f < FACES; f++) {
    int equal = 0;
    for (int g = 0; g < FACES; g++)
      equal += faces[f][0] == faces[g][0] && faces[f][1] == faces[g][1] && faces[f][2] == faces[g][2];
    assert_int_equal(equal, 2);
  }
}

/* The classes of the notes: by midpoints 2, 3, 4 with their dihedral angles, volumes and radius ratios. */
static void classes_of_tets(void **state) {
  (void)state;
  int count[5] = {0};
  const double six_volumes[5] = {0, 0, 6 * 64.0 / 16, 6 * 64.0 * 5 / 96, 6 * 64.0 / 24};
  const double ratio[5] = {0, 0, 0.9794, 0.9724, 1};
  const double smallest[5] = {0, 0, 1.0 / 2, 7.0 / 18, 1.0 / 3}, largest[5] = {0, 0, sqrt(3) / 6, sqrt(6) / 9, 1.0 / 3};
  for (int t = 0; t < LAVES__C15_TETS; t++) {
    laves__vec3 p[4];
    double cosines[6], most = -1, least = 1;
    const int m = midpoints(t);
    corner_points(t, p);
    laves__tet_dihedral_cosines(p, cosines);
    for (int i = 0; i < 6; i++) {
      most = fmax(most, cosines[i]);
      least = fmin(least, cosines[i]);
    }
    count[m]++;
    assert_float_equal(v3_det(p[0], p[1], p[2], p[3]), six_volumes[m], 1e-12);
    assert_float_equal(laves__tet_radius_ratio(p), ratio[m], 5e-5);
    assert_float_equal(most, smallest[m], 1e-12);
    assert_float_equal(least, largest[m], 1e-12);
  }
  assert_int_equal(count[2], 96);
  assert_int_equal(count[3], 32);
  assert_int_equal(count[4], 8);
}

/* ---- neighbours and stars ---- */

static void neighbours_are_mutual(void **state) {
  (void)state;
  double sum = 0;
  int edges = 0;
  for (int s = 0; s < LAVES__C15_SITES; s++) {
    assert_int_equal(laves__c15_degree[s], s < 8 ? 16 : 12);
    for (int i = 0; i < laves__c15_degree[s]; i++) {
      const laves__c15_link link = laves__c15_neighbour[s][i];
      bool mutual = false;
      for (int j = 0; j < laves__c15_degree[link.site]; j++) {
        const laves__c15_link back = laves__c15_neighbour[link.site][j];
        mutual |= back.site == s && back.cell == 26 - link.cell;
      }
      assert_true(mutual);
      if (i > 0)
        assert_true(laves__c15_neighbour[s][i - 1].cell * 32 + laves__c15_neighbour[s][i - 1].site < link.cell * 32 + link.site);
      int d[3];
      cell_offset(link.cell, d);
      const int8_t *a = laves__c15_site[s], *b = laves__c15_site[link.site];
      sum += v3_norm(v3(b[0] - a[0] + 8 * d[0], b[1] - a[1] + 8 * d[1], b[2] - a[2] + 8 * d[2]));
      edges++;
    }
  }
  assert_int_equal(edges, 2 * 160);
  assert_float_equal(sum / edges, LAVES__C15_MEAN_EDGE, 1e-12);
  assert_float_equal(sqrt(12) / LAVES__C15_MEAN_EDGE, LAVES__C15_LONGEST_EDGE, 1e-12);
}

/* The nodes of a star entry, relative to the cell of the site. */
static void entry_nodes(laves__c15_star_tet e, int nodes[4]) {
  int d[3];
  cell_offset(e.cell, d);
  for (int i = 0; i < 4; i++) nodes[i] = corner_node(laves__c15_tet[e.tet][i], d[0], d[1], d[2]);
}

static int common(const int a[4], const int b[4]) {
  int count = 0;
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++) count += a[i] == b[j];
  return count;
}

/* Every corner of every tet stands in exactly one star, and each entry's corner is the site itself. */
static void stars_hold_all_tets(void **state) {
  (void)state;
  int seen[LAVES__C15_TETS][4] = {{0}};
  for (int s = 0; s < LAVES__C15_SITES; s++) {
    assert_int_equal(laves__c15_star_size[s], s < 8 ? 28 : 20);
    for (int i = 0; i < laves__c15_star_size[s]; i++) {
      const laves__c15_star_tet e = laves__c15_star[s][i];
      int nodes[4];
      entry_nodes(e, nodes);
      assert_int_equal(nodes[e.corner], node(s, 0, 0, 0));
      seen[e.tet][e.corner]++;
    }
  }
  for (int t = 0; t < LAVES__C15_TETS; t++)
    for (int i = 0; i < 4; i++) assert_int_equal(seen[t][i], 1);
}

/* `across` names the three different entries that share three nodes, one of them the site. */
static void stars_know_their_neighbours(void **state) {
  (void)state;
  for (int s = 0; s < LAVES__C15_SITES; s++)
    for (int i = 0; i < laves__c15_star_size[s]; i++) {
      const uint8_t *across = laves__c15_star[s][i].across;
      int nodes[4];
      entry_nodes(laves__c15_star[s][i], nodes);
      assert_true(across[0] < across[1] && across[1] < across[2]);
      for (int k = 0; k < 3; k++) {
        int other[4];
        assert_true(across[k] < laves__c15_star_size[s]);
        entry_nodes(laves__c15_star[s][across[k]], other);
        assert_int_equal(common(nodes, other), 3);
      }
    }
}

/* The nodes of a star are the site and its neighbours. */
static void stars_and_neighbours_agree(void **state) {
  (void)state;
  for (int s = 0; s < LAVES__C15_SITES; s++) {
    bool met[LAVES__C15_MAX_DEGREE] = {false};
    for (int i = 0; i < laves__c15_star_size[s]; i++) {
      int nodes[4];
      entry_nodes(laves__c15_star[s][i], nodes);
      for (int k = 0; k < 4; k++) {
        bool known = nodes[k] == node(s, 0, 0, 0);
        for (int n = 0; n < laves__c15_degree[s]; n++) {
          int d[3];
          cell_offset(laves__c15_neighbour[s][n].cell, d);
          if (nodes[k] != node(laves__c15_neighbour[s][n].site, d[0], d[1], d[2])) continue;
          met[n] = known = true;
        }
        assert_true(known);
      }
    }
    for (int n = 0; n < laves__c15_degree[s]; n++) assert_true(met[n]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sites_follow_the_rule),
      cmocka_unit_test(tets_are_positive_and_fill),
      cmocka_unit_test(tets_have_their_owner),
      cmocka_unit_test(faces_have_two_tets),
      cmocka_unit_test(classes_of_tets),
      cmocka_unit_test(neighbours_are_mutual),
      cmocka_unit_test(stars_hold_all_tets),
      cmocka_unit_test(stars_know_their_neighbours),
      cmocka_unit_test(stars_and_neighbours_agree),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
