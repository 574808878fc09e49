/* Edge contraction: b is merged into a.
 *
 * Cures what no movement can: a boundary edge with four or five tets, a vertex with too many or too few. Topology is kept
 * by the link condition [dey1999], on the layer with its boundary closed by one far vertex: every vertex that is a
 * neighbour of both a and b must form a triangle with ab, every edge seen by both a tetrahedron, and likewise on the
 * boundary. A surface vertex may only go into another one along a boundary edge. */
#include "improve/contract.h"

#include "improve/fit.h"
#include "improve/guard.h"
#include "improve/smooth.h"

enum {
  NEIGHBOURS_MAX = 96,
  QUICK_EDGES = 3, /* the shortest edges of a tet, tried when one round of smoothing is asked for; of those that helped
                      nine in ten were among them */
};
/* Local sizes: contracting a longer edge hardly ever helps (3 of 178, in 5400 attempts). */
static const double longest = 1.2;
/* A merge that leaves a quality below this share of the old worst is not worth smoothing. */
static const double hopeless = 0.25;
/* Nor one whose own smoothing does not come this near to the old worst. */
static const double promising = 0.8;
typedef struct ring {
  int32_t tet[NEIGHBOURS_MAX]; /* that hold both ends */
  int tet_count;
  int32_t vertex[NEIGHBOURS_MAX]; /* the other vertices of those */
  int vertex_count;
} ring;

static bool holds(const int32_t *list, int count, int32_t value) {
  for (int i = 0; i < count; i++)
    if (list[i] == value) return true;
  return false;
}

static bool find_ring(const laves__layer *layer, int32_t a, int32_t b, ring *r) {
  r->tet_count = r->vertex_count = 0;
  const laves__star *star = &layer->star[b];
  for (int i = 0; i < star->count; i++) {
    const int32_t t = star->tet[i];
    if (laves__layer_corner(layer, t, a) < 0) continue;
    if (r->tet_count == NEIGHBOURS_MAX || r->vertex_count + 2 > NEIGHBOURS_MAX) return false;
    r->tet[r->tet_count++] = t;
    for (int k = 0; k < 4; k++) {
      const int32_t v = layer->tet[t][k];
      if (v != a && v != b && !holds(r->vertex, r->vertex_count, v)) r->vertex[r->vertex_count++] = v;
    }
  }
  return r->tet_count > 0;
}

/* Whether v and w are joined by a boundary edge; v moves. */
static bool is_boundary_edge(const laves__layer *layer, int32_t v, int32_t w) {
  if (layer->depth[v] != 0 || (layer->depth[w] != 0 && !layer->patch)) return false;
  const laves__star *star = &layer->star[v];
  for (int i = 0; i < star->count; i++) {
    const int32_t t = star->tet[i];
    if (laves__layer_corner(layer, t, w) < 0) continue;
    for (int k = 0; k < 4; k++)
      if (layer->tet[t][k] != v && layer->tet[t][k] != w && laves__layer_is_boundary_face(layer, t, k)) return true;
  }
  return false;
}

static bool is_boundary_triangle(const laves__layer *layer, const ring *r, int32_t a, int32_t b, int32_t x) {
  for (int i = 0; i < r->tet_count; i++) {
    if (laves__layer_corner(layer, r->tet[i], x) < 0) continue;
    for (int k = 0; k < 4; k++) {
      const int32_t v = layer->tet[r->tet[i]][k];
      if (v != a && v != b && v != x && laves__layer_is_boundary_face(layer, r->tet[i], k)) return true;
    }
  }
  return false;
}

static int collect_neighbours(const laves__layer *layer, int32_t v, int32_t list[4 * NEIGHBOURS_MAX]) {
  int count = 0;
  const laves__star *star = &layer->star[v];
  for (int i = 0; i < star->count; i++)
    for (int k = 0; k < 4; k++) {
      const int32_t w = layer->tet[star->tet[i]][k];
      if (w == v || holds(list, count, w)) continue;
      if (count == 4 * NEIGHBOURS_MAX) return -1;
      list[count++] = w;
    }
  return count;
}

static bool star_has_triangle(const laves__layer *layer, int32_t v, int32_t x, int32_t y) {
  const laves__star *star = &layer->star[v];
  for (int i = 0; i < star->count; i++)
    if (laves__layer_corner(layer, star->tet[i], x) >= 0 && laves__layer_corner(layer, star->tet[i], y) >= 0) return true;
  return false;
}

static bool ring_has_edge(const laves__layer *layer, const ring *r, int32_t x, int32_t y) {
  for (int i = 0; i < r->tet_count; i++)
    if (laves__layer_corner(layer, r->tet[i], x) >= 0 && laves__layer_corner(layer, r->tet[i], y) >= 0) return true;
  return false;
}

/* The link condition; see the top of the file. */
static bool keeps_topology(const laves__layer *layer, int32_t a, int32_t b, const ring *r) {
  int32_t of_a[4 * NEIGHBOURS_MAX], of_b[4 * NEIGHBOURS_MAX];
  const int a_count = collect_neighbours(layer, a, of_a), b_count = collect_neighbours(layer, b, of_b);
  if (a_count < 0 || b_count < 0) return false;
  int common = 0;
  for (int i = 0; i < b_count; i++) common += holds(of_a, a_count, of_b[i]);
  if (common != r->vertex_count) return false;
  for (int i = 0; i < r->vertex_count; i++)
    for (int j = i + 1; j < r->vertex_count; j++) {
      const int32_t x = r->vertex[i], y = r->vertex[j];
      if (!ring_has_edge(layer, r, x, y) && star_has_triangle(layer, a, x, y) && star_has_triangle(layer, b, x, y)) return false;
    }
  if (layer->depth[b] != 0) return true;
  if (layer->depth[a] != 0 || !is_boundary_edge(layer, b, a)) return false;
  for (int i = 0; i < r->vertex_count; i++) {
    const int32_t x = r->vertex[i];
    if (is_boundary_edge(layer, a, x) && is_boundary_edge(layer, b, x) && !is_boundary_triangle(layer, r, a, b, x)) return false;
  }
  return true;
}

/* Where the boundary is given: the two faces of a ring tet that become one, of which one may be on the boundary; then the tet
 * beyond the other has it. False where both are, or memory is short. */
static bool hand_on_patches(laves__layer *layer, int32_t a, int32_t b, const ring *r, laves__journal *j) {
  for (int i = 0; i < r->tet_count; i++) {
    const int32_t t = r->tet[i];
    const int at_a = laves__layer_corner(layer, t, a), at_b = laves__layer_corner(layer, t, b);
    const int32_t of_a = layer->patch[t][at_b], of_b = layer->patch[t][at_a]; /* of the face that holds it */
    if (of_a == LAVES__NO_PATCH && of_b == LAVES__NO_PATCH) continue;
    if (of_a != LAVES__NO_PATCH && of_b != LAVES__NO_PATCH) return false;
    const int32_t beyond = laves__layer_across(layer, t, of_a != LAVES__NO_PATCH ? at_a : at_b);
    if (beyond < 0 || !laves__journal_tet(j, layer, beyond)) return false;
    for (int k = 0; k < 4; k++)
      if (laves__layer_corner(layer, t, layer->tet[beyond][k]) < 0)
        layer->patch[beyond][k] = of_a != LAVES__NO_PATCH ? of_a : of_b;
  }
  return true;
}

/* Merges b into a; everything changed is in the journal first. */
static bool merge(laves__layer *layer, int32_t a, int32_t b, const ring *r, laves__journal *j) {
  if (!laves__journal_star(j, layer, a) || !laves__journal_star(j, layer, b)) return false;
  for (int i = 0; i < r->vertex_count; i++)
    if (laves__layer_moves(layer, r->vertex[i]) && !laves__journal_star(j, layer, r->vertex[i])) return false;
  if (layer->patch && !hand_on_patches(layer, a, b, r, j)) return false;
  for (int i = 0; i < r->tet_count; i++) {
    const int32_t t = r->tet[i];
    if (!laves__journal_tet(j, layer, t)) return false;
    for (int k = 0; k < 4; k++)
      if (laves__layer_moves(layer, layer->tet[t][k])) laves__star_remove(&layer->star[layer->tet[t][k]], t);
    layer->tet[t][0] = -1;
  }
  laves__star *star = &layer->star[b];
  for (int i = 0; i < star->count; i++) {
    const int32_t t = star->tet[i];
    if (!laves__journal_tet(j, layer, t) || !laves__journal_star_add(j, layer, a, t)) return false;
    layer->tet[t][laves__layer_corner(layer, t, b)] = a;
  }
  star->count = 0;
  return true;
}

/* Qualities around a; false when one is at or below `limit`. */
static bool measure_star(const laves__measure *m, laves__layer *layer, int32_t a, double limit) {
  const laves__star *star = &layer->star[a];
  for (int i = 0; i < star->count; i++) {
    layer->quality[star->tet[i]] = laves__layer_quality(m, layer, star->tet[i]);
    if (!(layer->quality[star->tet[i]] > limit)) return false;
  }
  return true;
}

/* Smooths a, then the other vertices of tets around it that are still bad (each once), then a again. */
static void smooth_around(const laves__frame *frame, const laves__measure *m, double target, laves__layer *layer, int32_t a,
                          laves__journal *j) {
  int32_t done[NEIGHBOURS_MAX];
  int done_count = 0;
  for (int i = 0; i < layer->star[a].count; i++) {
    const int32_t t = layer->star[a].tet[i];
    for (int k = 0; k < 4 && layer->quality[t] < target; k++) {
      const int32_t v = layer->tet[t][k];
      if (v == a || !laves__layer_moves(layer, v) || done_count == NEIGHBOURS_MAX || holds(done, done_count, v)) continue;
      done[done_count++] = v;
      laves__smooth_vertex(frame, m, target, layer, v, j);
    }
  }
  laves__smooth_vertex(frame, m, target, layer, a, j);
}

static double worst_touched(const laves__layer *layer, const laves__journal *j) {
  double worst = HUGE_VAL;
  for (size_t i = 0; i < j->tet_count; i++) {
    const int32_t t = j->tet[i].tet;
    if (layer->tet[t][0] < 0) continue;
    if (laves__is_stranded(layer, layer->tet[t], layer->quality[t]) && layer->quality[t] < j->tet[i].quality) return -HUGE_VAL;
    if (layer->quality[t] < worst) worst = layer->quality[t];
  }
  return worst;
}

typedef struct contraction {
  const laves__frame *frame;
  const laves__measure *measure;
  double target;
  int rounds; /* of smoothing */
} contraction;

/* Merges and smooths; false when the worst did not rise. The caller undoes or keeps. */
static bool try_contraction(const contraction *c, laves__layer *layer, int32_t a, int32_t b, const ring *r, double before,
                            laves__journal *j) {
  laves__journal_clear(j);
  if (!merge(layer, a, b, r, j) || layer->star[a].count == 0) return false;
  if (!measure_star(c->measure, layer, a, fmax(LAVES__FLAT, hopeless * before))) return false;
  laves__smooth_vertex(c->frame, c->measure, c->target, layer, a, j);
  if (!(laves__star_quality(layer, a) > promising * before)) return false;
  for (int round = 0; round < c->rounds; round++) smooth_around(c->frame, c->measure, c->target, layer, a, j);
  return worst_touched(layer, j) > before && (!laves__weighs_all(c->measure, before) || laves__lacks_less(layer, j));
}

/* Whether the boundary around a, just changed, lies well enough to the surface: within the limits or, which is looked at
 * only when it does not, as well as before. For the latter the change is undone, looked at, and made again. */
static bool keeps_surface(const contraction *c, laves__layer *layer, int32_t a, int32_t b, const ring *r, double before,
                          laves__journal *j) {
  const laves__fit limit = LAVES__FIT_LIMIT;
  laves__fit now = LAVES__FIT_NONE, earlier = limit;
  laves__fit_star(c->frame, layer, a, &now);
  if (laves__fit_within(&now, &limit)) return true;
  laves__journal_undo(j, layer);
  laves__fit_star(c->frame, layer, a, &earlier);
  if (layer->depth[b] == 0) laves__fit_star(c->frame, layer, b, &earlier);
  return laves__fit_within(&now, &earlier) && try_contraction(c, layer, a, b, r, before, j);
}

/* Faults of features about a merge: of both ends, or of the one that is left, and of the creases and corners around the edge. */
static int faults_around(const contraction *c, const laves__layer *layer, int32_t a, int32_t b, const ring *r) {
  int faults = laves__feature_faults(c->frame, layer, a);
  if (layer->star[b].count > 0) faults += laves__feature_faults(c->frame, layer, b);
  for (int i = 0; i < r->vertex_count; i++)
    if (layer->depth[r->vertex[i]] == 0 && layer->hold[r->vertex[i]].kind >= LAVES__HOLD_CREASE)
      faults += laves__feature_faults(c->frame, layer, r->vertex[i]);
  return faults;
}

static bool contract(const contraction *c, laves__layer *layer, int32_t a, int32_t b, laves__journal *j) {
  if (!laves__layer_moves(layer, a) || !laves__layer_moves(layer, b)) return false;
  if (layer->depth[b] == 0 && layer->depth[a] != 0) return false;
  const bool held = layer->hold && layer->depth[b] == 0;
  if (held && !laves__may_merge(c->frame, layer, b, a)) return false;
  ring r;
  if (!find_ring(layer, a, b, &r) || !keeps_topology(layer, a, b, &r)) return false;
  const double before = fmin(laves__star_quality(layer, a), laves__star_quality(layer, b));
  const int faults = held ? faults_around(c, layer, a, b, &r) : 0;
  const bool on_crease = held && layer->hold[b].kind == LAVES__HOLD_CREASE;
  const double sag = on_crease ? fmax(laves__crease_sag(c->frame, layer, a), laves__crease_sag(c->frame, layer, b)) : 0;
  const bool good = try_contraction(c, layer, a, b, &r, before, j) &&
                    (layer->depth[a] != 0 || keeps_surface(c, layer, a, b, &r, before, j)) &&
                    (!held || faults_around(c, layer, a, b, &r) <= faults) &&
                    (!on_crease || laves__crease_sag(c->frame, layer, a) <= fmax(sag, LAVES__SAG_LIMIT));
  if (!good) laves__journal_undo(j, layer);
  laves__journal_clear(j);
  return good;
}

bool laves__contract_tet(const laves__frame *frame, const laves__measure *m, double target, laves__layer *layer, int32_t tet,
                         int rounds, laves__journal *journal) {
  const contraction c = {frame, m, target, rounds};
  int order[6];
  double length[6]; /* squared, in local sizes */
  for (int e = 0; e < 6; e++) {
    const int32_t *corner = layer->tet[tet];
    const int32_t v = corner[laves__tet_edge[e][0]], w = corner[laves__tet_edge[e][1]];
    const double scale = 0.5 * (laves__layer_scale(layer, v) + laves__layer_scale(layer, w));
    length[e] = v3_norm2(v3_sub(layer->position[v], layer->position[w])) / (scale * scale);
    int at = e;
    for (; at > 0 && length[order[at - 1]] > length[e]; at--) order[at] = order[at - 1];
    order[at] = e;
  }
  const int tried = rounds > 1 ? 6 : QUICK_EDGES;
  for (int e = 0; e < tried && length[order[e]] < longest * longest; e++)
    for (int direction = 0; direction < 2; direction++) {
      const int32_t a = layer->tet[tet][laves__tet_edge[order[e]][direction]];
      const int32_t b = layer->tet[tet][laves__tet_edge[order[e]][1 - direction]];
      if (contract(&c, layer, a, b, journal)) return true;
    }
  return false;
}
