/* The reachable set, as docs/proof.md defines it. A corner is IN, ON (it has snapped) or OUT, and at least one is IN.
 *
 *   - An ON corner v, inner or outer before it snapped, stands on one of its 12 or 16 edges v-w, at a share of at most
 *     alpha(v, w). The other end w had the other sign. Where w is a corner of the same tet, that ties it: an IN corner w
 *     means that v was outer, an OUT one that v was inner; if w is ON, it had the other sign, and did not move along the
 *     same edge, as the edge's one crossing violates one end only.
 *   - The edge from an IN to an OUT corner has a cut, at a fraction between alpha_in and 1 - alpha_out.
 *   - Relaxed by r, shares are (1 - r) of that and cuts at (1 - r) t + r middle.
 *
 * All parameters are independent otherwise. Of two ways of having had signs that differ in nothing but that one's ranges
 * contain the other's, only the larger is visited. */
#include "reachable.h"

#include <string.h>

#include "background/c15_table.h"

typedef struct link {
  laves__vec3 vector;
  laves__kind kind;
  int corner; /* of the tet, where the edge ends; -1: elsewhere */
} link;

typedef struct enumeration {
  const laves__guarantee *guarantee;
  visit_configuration visit;
  void *user;
  configuration c;
  laves__kind kind[4];
  int degree[4];
  link links[4][LAVES__C15_MAX_DEGREE];
  const link *chosen[4]; /* of ON corners */
} enumeration;

static range outward(double low, double high) { return (range){floor(low / GRID) * GRID, ceil(high / GRID) * GRID}; }

/* (1 - r) x is exact: multiples of 2^-13 both. */
static range share_range(const laves__guarantee *g, bool outer, laves__kind v, laves__kind w) {
  return outward(0, (1 - g->relaxation) * g->thresholds->alpha[outer][v][w]);
}

static range fraction_range(const laves__guarantee *g, laves__kind in, laves__kind out) {
  const laves__thresholds *t = g->thresholds;
  const double keep = 1 - g->relaxation, pull = g->relaxation * t->middle[in][out];
  return outward(keep * t->alpha[0][in][out] + pull, keep * (1 - t->alpha[1][out][in]) + pull);
}

double largest_alpha(const laves__thresholds *thresholds) {
  double largest = 0;
  for (int i = 0; i < 8; i++) largest = fmax(largest, thresholds->alpha[i / 4][i / 2 % 2][i % 2]);
  return largest;
}

static void load_links(enumeration *e) {
  for (int i = 0; i < 4; i++) {
    const int site = laves__c15_tet[e->c.tet][i].site;
    e->kind[i] = laves__kind_of(site);
    e->degree[i] = laves__c15_degree[site];
    for (int n = 0; n < e->degree[i]; n++) {
      const laves__c15_link to = laves__c15_neighbour[site][n];
      const int8_t *a = laves__c15_site[site], *b = laves__c15_site[to.site];
      link *l = &e->links[i][n];
      l->vector = v3(b[0] - a[0] + LAVES__C15_PERIOD * (to.cell % 3 - 1), b[1] - a[1] + LAVES__C15_PERIOD * (to.cell / 3 % 3 - 1),
                     b[2] - a[2] + LAVES__C15_PERIOD * (to.cell / 9 - 1));
      l->kind = laves__kind_of(to.site);
      l->corner = -1;
      for (int j = 0; j < 4; j++)
        if (v3_distance(v3_add(e->c.site[i], l->vector), e->c.site[j]) == 0) l->corner = j;
    }
  }
}

/* Whether the ON corners can have had these signs (bit: outer). */
static bool signs_fit(const enumeration *e, unsigned outer) {
  for (int v = 0; v < 4; v++) {
    if (e->c.label[v] != LAVES__LABEL_ON) {
      if (outer >> v & 1) return false; /* one name for each way */
      continue;
    }
    const int w = e->chosen[v]->corner;
    if (w < 0) continue;
    const bool other_outer = e->c.label[w] == LAVES__LABEL_ON ? outer >> w & 1 : e->c.label[w] == LAVES__LABEL_OUT;
    if (other_outer == (outer >> v & 1)) return false;
    if (e->c.label[w] == LAVES__LABEL_ON && e->chosen[w]->corner == v) return false;
  }
  return true;
}

static void set_shares(enumeration *e, unsigned outer) {
  for (int v = 0; v < 4; v++) {
    if (e->c.label[v] != LAVES__LABEL_ON) continue;
    e->c.was_outer[v] = outer >> v & 1;
    e->c.along[v] = e->chosen[v]->vector;
    e->c.share[v] = share_range(e->guarantee, outer >> v & 1, e->kind[v], e->chosen[v]->kind);
  }
}

/* Whether the ranges of a contain those of b. */
static bool contains(const configuration *a, const configuration *b) {
  for (int v = 0; v < 4; v++)
    if (a->share[v].high < b->share[v].high) return false;
  return true;
}

static bool visit_signs(enumeration *e) {
  configuration way[16];
  int count = 0;
  for (unsigned outer = 0; outer < 16; outer++) {
    if (!signs_fit(e, outer)) continue;
    set_shares(e, outer);
    way[count++] = e->c;
  }
  for (int i = 0; i < count; i++) {
    bool needless = false;
    for (int j = 0; j < count; j++) needless |= j != i && contains(&way[j], &way[i]) && (j < i || !contains(&way[i], &way[j]));
    if (!needless && !e->visit(&way[i], e->user)) return false;
  }
  return true;
}

static bool visit_links(enumeration *e, int v) {
  while (v < 4 && e->c.label[v] != LAVES__LABEL_ON) v++;
  if (v == 4) return visit_signs(e);
  for (int n = 0; n < e->degree[v]; n++) {
    e->chosen[v] = &e->links[v][n];
    if (!visit_links(e, v + 1)) return false;
  }
  return true;
}

static bool visit_labels(const laves__guarantee *guarantee, int tet, bool dropped_too, visit_configuration visit, void *user) {
  enumeration e = {.guarantee = guarantee, .visit = visit, .user = user, .c = {.tet = tet}};
  for (int i = 0; i < 4; i++) {
    const laves__c15_corner corner = laves__c15_tet[tet][i];
    const int8_t *s = laves__c15_site[corner.site];
    e.c.site[i] = v3(s[0] + LAVES__C15_PERIOD * (corner.shift & 1), s[1] + LAVES__C15_PERIOD * (corner.shift >> 1 & 1),
                     s[2] + LAVES__C15_PERIOD * (corner.shift >> 2));
  }
  load_links(&e);
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++) {
      e.c.length2[i][j] = v3_norm2(v3_sub(e.c.site[j], e.c.site[i]));
      e.c.fraction[i][j] = fraction_range(guarantee, e.kind[i], e.kind[j]);
    }
  for (int labels = 0; labels < 81; labels++) {
    int inner = 0;
    for (int i = 0, rest = labels; i < 4; i++, rest /= 3) {
      e.c.label[i] = (int8_t)(rest % 3 - 1);
      e.c.share[i] = (range){0, 0};
      inner += e.c.label[i] == LAVES__LABEL_IN;
    }
    if (!dropped_too && (inner == 0 || inner == 4)) continue;
    if (!visit_links(&e, 0)) return false;
  }
  return true;
}

bool visit_reachable(const laves__guarantee *guarantee, int tet, visit_configuration visit, void *user) {
  return visit_labels(guarantee, tet, false, visit, user);
}

bool visit_all(const laves__guarantee *guarantee, int tet, visit_configuration visit, void *user) {
  return visit_labels(guarantee, tet, true, visit, user);
}

int range_count(const configuration *c) {
  int inner = 0, on = 0;
  for (int i = 0; i < 4; i++) {
    inner += c->label[i] == LAVES__LABEL_IN;
    on += c->label[i] == LAVES__LABEL_ON;
  }
  return on + inner * (4 - inner - on);
}

static double end_of(range r, unsigned *corner) {
  const double end = *corner & 1 ? r.high : r.low;
  *corner >>= 1;
  return end;
}

laves__cut_tet cut_tet_at(const configuration *c, unsigned corner) {
  laves__cut_tet t = {.id = {0, 1, 2, 3}};
  memcpy(t.label, c->label, sizeof t.label);
  memcpy(t.length2, c->length2, sizeof t.length2);
  for (int i = 0; i < 4; i++) {
    t.position[i] = c->site[i];
    if (c->label[i] == LAVES__LABEL_ON) t.position[i] = v3_mad(c->site[i], c->along[i], end_of(c->share[i], &corner));
    for (int o = 0; o < 4; o++)
      if (c->label[i] == LAVES__LABEL_IN && c->label[o] == LAVES__LABEL_OUT)
        t.fraction[i][o] = end_of(c->fraction[i][o], &corner);
  }
  return t;
}
