/* An isometry that keeps the cubic period is x -> M x + t with a signed permutation matrix M, and t such that site 0 goes to
 * one of the sites of its kind: 48 * 8 candidates. Each is tried on all sites, edges and tets, in integers; those that pass
 * are symmetries. Nothing about the group is taken for granted. */
#include "symmetry.h"

#include <stdbool.h>
#include <string.h>

#include "stuff/rule.h"

enum { PERIOD = LAVES__C15_PERIOD };

typedef struct isometry {
  int axis[3], sign[3], shift[3]; /* image[k] = sign[k] x[axis[k]] + shift[k] */
} isometry;

static void apply(const isometry *m, const int x[3], int image[3]) {
  for (int k = 0; k < 3; k++) image[k] = m->sign[k] * x[m->axis[k]] + m->shift[k];
}

static int modulo(int x) { return (x % PERIOD + PERIOD) % PERIOD; }

static int site_at(const int x[3]) {
  for (int s = 0; s < LAVES__C15_SITES; s++) {
    bool same = true;
    for (int k = 0; k < 3; k++) same &= modulo(x[k]) == laves__c15_site[s][k];
    if (same) return s;
  }
  return -1;
}

static void corner_at(laves__c15_corner c, int x[3]) {
  for (int k = 0; k < 3; k++) x[k] = laves__c15_site[c.site][k] + PERIOD * (c.shift >> k & 1);
}

/* The tet with these corners, up to a period; -1: none. */
static int tet_at(int x[4][3]) {
  for (int t = 0; t < LAVES__C15_TETS; t++) {
    const laves__c15_corner *corner = laves__c15_tet[t];
    const int first = site_at(x[0]);
    int shift[3] = {0}, found = 0;
    for (int i = 0; i < 4; i++) {
      if (corner[i].site != first) continue;
      int y[3];
      corner_at(corner[i], y);
      for (int k = 0; k < 3; k++) shift[k] = x[0][k] - y[k];
      found = 1;
    }
    for (int i = 0; i < 4 && found; i++) {
      int y[3], hits = 0;
      corner_at(corner[i], y);
      for (int j = 0; j < 4; j++) hits += x[j][0] == y[0] + shift[0] && x[j][1] == y[1] + shift[1] && x[j][2] == y[2] + shift[2];
      found = hits == 1;
    }
    if (found) return t;
  }
  return -1;
}

static bool has_edge(int site, const int vector[3]) {
  int end[3];
  for (int k = 0; k < 3; k++) end[k] = laves__c15_site[site][k] + vector[k];
  for (int n = 0; n < laves__c15_degree[site]; n++) {
    const laves__c15_link link = laves__c15_neighbour[site][n];
    const int step[3] = {link.cell % 3 - 1, link.cell / 3 % 3 - 1, link.cell / 9 - 1};
    bool same = true;
    for (int k = 0; k < 3; k++) same &= laves__c15_site[link.site][k] + PERIOD * step[k] == end[k];
    if (same) return true;
  }
  return false;
}

static bool keeps_sites_and_edges(const isometry *m) {
  for (int s = 0; s < LAVES__C15_SITES; s++) {
    int x[3], y[3];
    for (int k = 0; k < 3; k++) x[k] = laves__c15_site[s][k];
    apply(m, x, y);
    const int image = site_at(y);
    if (image < 0 || laves__kind_of(image) != laves__kind_of(s) || laves__c15_degree[image] != laves__c15_degree[s]) return false;
    for (int n = 0; n < laves__c15_degree[s]; n++) {
      const laves__c15_link link = laves__c15_neighbour[s][n];
      const int step[3] = {link.cell % 3 - 1, link.cell / 3 % 3 - 1, link.cell / 9 - 1};
      int end[3], vector[3];
      for (int k = 0; k < 3; k++) x[k] = laves__c15_site[link.site][k] + PERIOD * step[k];
      apply(m, x, end);
      for (int k = 0; k < 3; k++) vector[k] = end[k] - y[k];
      if (!has_edge(image, vector) || laves__kind_of(site_at(end)) != laves__kind_of(link.site)) return false;
    }
  }
  return true;
}

static bool keeps_tets(const isometry *m, int image[LAVES__C15_TETS]) {
  bool met[LAVES__C15_TETS] = {false};
  for (int t = 0; t < LAVES__C15_TETS; t++) {
    int y[4][3];
    for (int i = 0; i < 4; i++) {
      int x[3];
      corner_at(laves__c15_tet[t][i], x);
      apply(m, x, y[i]);
    }
    image[t] = tet_at(y);
    if (image[t] < 0 || met[image[t]]) return false;
    met[image[t]] = true;
  }
  return true;
}

/* The n-th candidate. */
static isometry candidate(int n) {
  static const int permutation[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  isometry m;
  memcpy(m.axis, permutation[n / 64], sizeof m.axis);
  for (int k = 0; k < 3; k++) m.sign[k] = n >> k & 1 ? -1 : 1;
  const int8_t *from = laves__c15_site[0], *to = laves__c15_site[n / 8 % 8];
  for (int k = 0; k < 3; k++) m.shift[k] = to[k] - m.sign[k] * from[m.axis[k]];
  return m;
}

int find_representatives(int representative[LAVES__C15_TETS], int orbit[LAVES__C15_TETS], int *isometries) {
  enum { CANDIDATES = 6 * 64 };
  static int image[CANDIDATES][LAVES__C15_TETS];
  int count = 0;
  for (int n = 0; n < CANDIDATES; n++) {
    const isometry m = candidate(n);
    count += keeps_sites_and_edges(&m) && keeps_tets(&m, image[count]);
  }
  *isometries = count;
  bool covered[LAVES__C15_TETS] = {false};
  int found = 0;
  for (int t = 0; t < LAVES__C15_TETS; t++) {
    if (covered[t]) continue;
    representative[found] = t;
    orbit[found] = 0;
    for (int i = 0; i < count; i++) {
      orbit[found] += !covered[image[i][t]];
      covered[image[i][t]] = true;
    }
    found++;
  }
  return found;
}
