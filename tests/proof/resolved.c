/* Surfaces are laid through a cell at random, and the worst of them are made worse by small random changes. All tets of the
 * cell are cut by the rule: sites snap to the nearest violating crossing, then laves__stencil_cut(). Nothing is relaxed and
 * nothing improved. A search finds upper bounds of the smallest angle only; that it finds nothing worse is no proof. */
#include "resolved.h"

#include <stdint.h>
#include <stdio.h>

#include "background/c15_table.h"
#include "mesh/quality.h"
#include "stuff/stencil.h"

enum { TRIES = 150000, CLIMBS = 32, STEPS = 1500 };

/* A ball (side 1) or cavity (side -1) through a point, with the normal there; radius 0: a plane. Quarter units. */
typedef struct surface {
  laves__vec3 point, normal;
  double radius;
  int side;
} surface;

typedef struct worst {
  double least, most; /* degrees */
} worst;

static uint32_t next(uint64_t *random) {
  *random = *random * 6364136223846793005U + 1442695040888963407U;
  return (uint32_t)(*random >> 32);
}
static double uniform(uint64_t *random) { return next(random) * 0x1p-31 - 1; } /* -1 .. 1 */
static laves__vec3 uniform3(uint64_t *random) {
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return v3(x, y, z);
}

static double phi(const surface *s, laves__vec3 x) {
  const laves__vec3 d = v3_sub(x, s->point);
  const double along = v3_dot(d, s->normal);
  if (s->radius == 0) return s->side * along;
  return s->side * (along + v3_norm2(d) / (2 * s->radius)); /* (|x - centre|^2 - radius^2) / 2 radius */
}

/* The fraction at which phi is 0 between a and b, where it has different signs: phi is quadratic on the edge. */
static double crossing(const surface *s, laves__vec3 a, laves__vec3 b) {
  const double at_a = phi(s, a), at_b = phi(s, b);
  const double bend = s->radius == 0 ? 0 : s->side * v3_norm2(v3_sub(b, a)) / (2 * s->radius);
  const double slope = at_b - at_a - bend, root = sqrt(fmax(0, slope * slope - 4 * bend * at_a));
  /* phi = at_a + slope t + bend t^2; the root between 0 and 1, without cancellation. */
  const double q = -0.5 * (slope + (slope < 0 ? -root : root)), first = q / bend, second = at_a / q;
  return bend != 0 && first >= 0 && first <= 1 ? first : second;
}

typedef struct node {
  laves__vec3 site, position;
  int8_t label;
} node;

static laves__vec3 site_position(int site, const int cell[3]) {
  const int8_t *s = laves__c15_site[site];
  return v3(s[0] + LAVES__C15_PERIOD * cell[0], s[1] + LAVES__C15_PERIOD * cell[1], s[2] + LAVES__C15_PERIOD * cell[2]);
}

static node snapped(const laves__guarantee *g, const surface *s, int site, const int cell[3]) {
  const laves__vec3 x = site_position(site, cell);
  const bool outer = phi(s, x) >= 0;
  node result = {x, x, outer ? LAVES__LABEL_OUT : LAVES__LABEL_IN};
  double nearest = HUGE_VAL;
  for (int k = 0; k < laves__c15_degree[site]; k++) {
    const laves__c15_link to = laves__c15_neighbour[site][k];
    const int there[3] = {cell[0] + to.cell % 3 - 1, cell[1] + to.cell / 3 % 3 - 1, cell[2] + to.cell / 9 - 1};
    const laves__vec3 y = site_position(to.site, there);
    if ((phi(s, y) >= 0) == outer) continue;
    const double share = crossing(s, x, y), way = share * v3_distance(x, y);
    if (!(share < g->thresholds->alpha[outer][laves__kind_of(site)][laves__kind_of(to.site)]) || !(way < nearest)) continue;
    nearest = way;
    result.position = v3_lerp(x, y, share);
    result.label = LAVES__LABEL_ON;
  }
  return result;
}

static void add_angles(const laves__guarantee *g, const laves__cut_tet *tet, worst *w) {
  uint8_t pieces[LAVES__PIECES_MAX][4];
  const int count = laves__stencil_cut(g, tet, pieces);
  for (int p = 0; p < count; p++) {
    laves__vec3 x[4];
    double cosine[6];
    for (int k = 0; k < 4; k++) x[k] = laves__code_position(tet, pieces[p][k]);
    laves__tet_dihedral_cosines(x, cosine);
    for (int k = 0; k < 6; k++) {
      const double angle = acos(fmax(-1, fmin(1, cosine[k]))) * (180 / 3.14159265358979323846);
      w->least = fmin(w->least, angle);
      w->most = fmax(w->most, angle);
    }
  }
}

/* All tets of the cell. */
static worst measure(const laves__guarantee *g, const surface *s) {
  node block[8][LAVES__C15_SITES];
  worst w = {180, 0};
  for (int shift = 0; shift < 8; shift++)
    for (int site = 0; site < LAVES__C15_SITES; site++)
      block[shift][site] = snapped(g, s, site, (const int[3]){shift & 1, shift >> 1 & 1, shift >> 2});
  for (int t = 0; t < LAVES__C15_TETS; t++) {
    laves__cut_tet tet = {.id = {0}};
    const node *corner[4];
    int inner = 0;
    for (int k = 0; k < 4; k++) {
      const laves__c15_corner c = laves__c15_tet[t][k];
      corner[k] = &block[c.shift][c.site];
      tet.label[k] = corner[k]->label;
      tet.id[k] = c.shift * 32U + c.site;
      tet.position[k] = corner[k]->position;
      inner += tet.label[k] == LAVES__LABEL_IN;
    }
    for (int i = 0; i < 4; i++)
      for (int o = 0; o < 4; o++) {
        tet.length2[i][o] = v3_norm2(v3_sub(corner[o]->site, corner[i]->site));
        if (tet.label[i] < 0 && tet.label[o] > 0) tet.fraction[i][o] = crossing(s, corner[i]->site, corner[o]->site);
      }
    if (inner > 0 && inner < 4) add_angles(g, &tet, &w);
  }
  return w;
}

static surface random_surface(uint64_t *random, double radius) {
  surface s = {.radius = radius, .side = next(random) >> 31 ? 1 : -1};
  s.point = v3_scale(v3_add(uniform3(random), v3(1, 1, 1)), LAVES__C15_PERIOD * 0.75);
  do s.normal = uniform3(random);
  while (!(v3_norm2(s.normal) < 1));
  s.normal = v3_unit(s.normal);
  return s;
}

/* How bad, for the smallest or the largest angle; more is worse. */
static double badness(worst w, bool largest) { return largest ? w.most : -w.least; }

typedef struct found {
  surface surface;
  double badness;
} found;

/* Keeps the CLIMBS worst, the worst first. */
static void keep(found best[CLIMBS], const surface *s, double bad) {
  if (!(bad > best[CLIMBS - 1].badness)) return;
  int at = CLIMBS - 1;
  for (; at > 0 && bad > best[at - 1].badness; at--) best[at] = best[at - 1];
  best[at] = (found){*s, bad};
}

static double climb(const laves__guarantee *g, found f, bool largest, uint64_t *random) {
  double step = 0.1;
  for (int i = 0; i < STEPS; i++) {
    surface s = f.surface;
    s.point = v3_mad(s.point, uniform3(random), step * 4);
    s.normal = v3_unit(v3_mad(s.normal, uniform3(random), step));
    const double bad = badness(measure(g, &s), largest);
    step *= bad > f.badness ? 1.2 : 0.985;
    if (bad > f.badness) f = (found){s, bad};
  }
  return f.badness;
}

static void print_radius(const laves__guarantee *g, double sizes) {
  found best[2][CLIMBS];
  double result[2] = {-HUGE_VAL, -HUGE_VAL};
  uint64_t random = 1;
  for (int i = 0; i < CLIMBS; i++) best[0][i] = best[1][i] = (found){.badness = -HUGE_VAL};
  for (int i = 0; i < TRIES; i++) {
    const surface s = random_surface(&random, sizes * LAVES__C15_MEAN_EDGE);
    const worst w = measure(g, &s);
    for (int largest = 0; largest < 2; largest++) keep(best[largest], &s, badness(w, largest));
  }
  for (int largest = 0; largest < 2; largest++)
    for (int i = 0; i < CLIMBS; i++) result[largest] = fmax(result[largest], climb(g, best[largest][i], largest, &random));
  if (sizes == 0) printf("planes:");
  if (sizes > 0) printf("radius %g sizes:", sizes);
  printf(" %.1f to %.1f degrees\n", -result[0], result[1]);
  fflush(stdout);
}

void print_resolved(const laves__guarantee *guarantee) {
  static const double radius[] = {0, 40, 20, 10, 5, 3, 2, 1};
  for (size_t i = 0; i < sizeof radius / sizeof *radius; i++) print_radius(guarantee, radius[i]);
}
