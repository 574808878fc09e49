/* Edge removal and its inverse for one face.
 *
 * The tets around an edge ab form a ring v0 .. v(m-1). Without the edge they are replaced by a triangulation of the ring,
 * each triangle joined to a and to b; the best one of all is found by dynamic programming, as for the best triangulation of
 * a polygon. Around a boundary edge the ring is open, and the edge v0 v(m-1) comes to the boundary in its place.
 *
 *        a                 a
 *      / | \             / | \           m - 2 triangles, 2 (m - 2) tets in the place of m (or m - 1)
 *    v0--+--v1   ==>   v0--|--v1         and the other way round for a face: two tets become three around
 *      \ | /  .          \ | /  .        a new edge
 *        b   v2            b   v2
 *
 * Tets of positive volume with the same outer faces fill the same space. But where the solid is so thin or rough that the mesh
 * overlaps itself, an edge or face that is new to them may be there elsewhere; then the flip is left out. Source: [freitag1997],
 * [klingner2007]. */
#include "improve/flip.h"

#include <string.h>

#include "improve/fit.h"
#include "improve/smooth.h"
#include "mesh/mesh.h"

enum { RING_MAX = 12, RING_USUAL = 8, TETS_MAX = 2 * (RING_MAX - 2), OLD_MAX = RING_MAX };
static const double least_gain = 1e-3; /* of quality */

/* A change that is thought of: the tets that go, those that come, and the worst quality then. */
typedef struct change {
  int old_count, fresh_count;
  int32_t old[OLD_MAX], fresh[TETS_MAX][4];
  double quality[TETS_MAX], worst, before;
  /* Where the boundary is given: the patch of the faces that come to it, their edge, and the one that goes from it. */
  int32_t opened, opened_edge[2], gone_edge[2];
} change;

typedef struct flipping {
  const laves__frame *frame;
  const laves__measure *measure;
  const laves__layer *layer;
  const laves__slots *slots;
} flipping;

/* ---- rings ---- */

typedef struct ring {
  int count; /* vertices */
  bool open;
  int32_t vertex[RING_MAX];
} ring;

/* The two other corners of a tet, so that (a, b, p, q) is positive. */
static void other_corners(const int32_t t[4], int32_t a, int32_t b, int32_t *p, int32_t *q) {
  int order[4], n = 2;
  for (int k = 0; k < 4; k++) {
    if (t[k] == a)
      order[0] = k;
    else if (t[k] == b)
      order[1] = k;
    else
      order[n++] = k;
  }
  bool odd = false;
  for (int i = 0; i < 4; i++)
    for (int j = i + 1; j < 4; j++) odd ^= order[i] > order[j];
  *p = t[order[odd ? 3 : 2]];
  *q = t[order[odd ? 2 : 3]];
}

/* The ring around an edge, of whose ends the first moves; false when it is too long or not one chain. */
static bool find_ring(const laves__layer *layer, int32_t a, int32_t b, ring *r, change *c) {
  int32_t from[OLD_MAX], to[OLD_MAX];
  const laves__star *star = &layer->star[a];
  const int most = layer->patch ? RING_MAX : RING_USUAL; /* the lattice has no longer ones that are worth it */
  c->old_count = 0;
  for (int i = 0; i < star->count; i++) {
    const int32_t t = star->tet[i];
    if (laves__layer_corner(layer, t, b) < 0) continue;
    if (c->old_count == most) return false;
    other_corners(layer->tet[t], a, b, &from[c->old_count], &to[c->old_count]);
    c->old[c->old_count++] = t;
  }
  int first = 0; /* the link that no other leads to */
  for (int i = 0; i < c->old_count; i++) {
    bool reached = false;
    for (int j = 0; j < c->old_count; j++) reached |= to[j] == from[i];
    if (!reached) first = i;
  }
  r->count = 0;
  for (int at = first, used = 0; used < c->old_count; used++) {
    if (r->count == most) return false;
    r->vertex[r->count++] = from[at];
    const int32_t next = to[at];
    int onwards = -1;
    for (int j = 0; j < c->old_count; j++)
      if (from[j] == next) onwards = j;
    if (used == c->old_count - 1) {
      r->open = next != from[first];
      if (r->open && r->count == most) return false;
      if (r->open) r->vertex[r->count++] = next;
      break;
    }
    if (onwards < 0) return false;
    at = onwards;
  }
  return r->count >= 3;
}

/* ---- thinking of changes ---- */

static double quality_of(const flipping *f, const int32_t t[4]) {
  laves__vec3 p[4];
  double scale = 0;
  for (int k = 0; k < 4; k++) {
    p[k] = f->layer->position[t[k]];
    scale += 0.25 * laves__layer_scale(f->layer, t[k]);
  }
  return laves__quality(f->measure, p, scale * scale * scale, 0);
}

static void add_fresh(const flipping *f, change *c, int32_t a, int32_t b, int32_t d, int32_t e, double quality) {
  const int32_t t[4] = {a, b, d, e};
  for (int k = 0; k < 4; k++) c->fresh[c->fresh_count][k] = t[k];
  c->quality[c->fresh_count++] = quality;
  if (laves__is_stranded(f->layer, t, quality)) quality = -HUGE_VAL;
  if (quality < c->worst) c->worst = quality;
}

static void measure_old(const flipping *f, change *c) {
  c->before = HUGE_VAL;
  for (int i = 0; i < c->old_count; i++) c->before = fmin(c->before, f->layer->quality[c->old[i]]);
  c->fresh_count = 0;
  c->worst = HUGE_VAL;
}

/* Whether there are dead tets enough. */
static bool has_room(const flipping *f, const change *c) { return c->fresh_count - c->old_count <= f->slots->count; }

typedef struct triangulation {
  double best[RING_MAX][RING_MAX]; /* least quality from vertex i to j */
  int8_t apex[RING_MAX][RING_MAX];
} triangulation;

static void pair_of_tets(int32_t a, int32_t b, const ring *r, int i, int j, int k, int32_t upper[4], int32_t lower[4]) {
  const int32_t *v = r->vertex;
  upper[0] = a, upper[1] = v[i], upper[2] = v[j], upper[3] = v[k];
  lower[0] = b, lower[1] = v[i], lower[2] = v[k], lower[3] = v[j];
}

static void triangulate(const flipping *f, int32_t a, int32_t b, const ring *r, double needed, triangulation *t) {
  for (int i = 0; i + 1 < r->count; i++) t->best[i][i + 1] = HUGE_VAL;
  for (int span = 2; span < r->count; span++)
    for (int i = 0; i + span < r->count; i++) {
      const int k = i + span;
      t->best[i][k] = -HUGE_VAL;
      t->apex[i][k] = (int8_t)(i + 1);
      for (int j = i + 1; j < k; j++) {
        double least = fmin(t->best[i][j], t->best[j][k]);
        if (least <= needed || least <= t->best[i][k]) continue;
        int32_t upper[4], lower[4];
        pair_of_tets(a, b, r, i, j, k, upper, lower);
        least = fmin(least, quality_of(f, upper));
        if (least > needed && least > t->best[i][k]) least = fmin(least, quality_of(f, lower));
        if (least <= t->best[i][k]) continue;
        t->best[i][k] = least;
        t->apex[i][k] = (int8_t)j;
      }
    }
}

static void list_triangulation(const flipping *f, int32_t a, int32_t b, const ring *r, const triangulation *t, int i, int k,
                               change *c) {
  if (k - i < 2) return;
  const int j = t->apex[i][k];
  int32_t upper[4], lower[4];
  pair_of_tets(a, b, r, i, j, k, upper, lower);
  add_fresh(f, c, upper[0], upper[1], upper[2], upper[3], quality_of(f, upper));
  add_fresh(f, c, lower[0], lower[1], lower[2], lower[3], quality_of(f, lower));
  list_triangulation(f, a, b, r, t, i, j, c);
  list_triangulation(f, a, b, r, t, j, k, c);
}

static bool has_edge(const laves__layer *layer, int32_t v, int32_t w) {
  const laves__star *star = &layer->star[v];
  for (int i = 0; i < star->count; i++)
    if (laves__layer_corner(layer, star->tet[i], w) >= 0) return true;
  return false;
}

/* Where the boundary is given: no border between regions passes through the edge, and a boundary edge lies in one patch. */
static bool may_go(const flipping *f, int32_t a, int32_t b, const ring *r, change *c) {
  const int faces = laves__given_edge(f->layer, a, b, &c->opened);
  c->gone_edge[0] = a;
  c->gone_edge[1] = b;
  c->opened_edge[0] = r->vertex[0];
  c->opened_edge[1] = r->vertex[r->count - 1];
  return r->open ? faces == 2 && c->opened != LAVES__NO_PATCH : faces == 0;
}

/* Whether the two faces that come to the boundary may. */
static bool may_open(const flipping *f, int32_t a, int32_t b, const ring *r) {
  const laves__layer *l = f->layer;
  const int32_t v = r->vertex[0], w = r->vertex[r->count - 1];
  if (l->patch) return laves__layer_moves(l, v) ? !has_edge(l, v, w) : laves__layer_moves(l, w) && !has_edge(l, w, v);
  if (l->depth[a] != 0 || l->depth[b] != 0 || l->depth[v] != 0 || l->depth[w] != 0 || has_edge(l, v, w)) return false;
  if (laves__is_crease_edge(f->frame, l, a, b)) return false;
  const int32_t upper[3] = {a, w, v}, lower[3] = {b, v, w};
  laves__fit fit = LAVES__FIT_NONE;
  laves__fit_face(f->frame, l, upper, &fit);
  laves__fit_face(f->frame, l, lower, &fit);
  return laves__fit_within(&fit, &LAVES__FIT_LIMIT);
}

/* Whether the fresh tets lack less than the old; see laves__lacks_less(). */
static bool helps(const flipping *f, const change *c) {
  double before = 0, then = 0;
  if (!laves__weighs_all(f->measure, c->before)) return true;
  for (int i = 0; i < c->old_count; i++) before += laves__shortfall(f->layer->quality[c->old[i]]);
  for (int i = 0; i < c->fresh_count; i++) then += laves__shortfall(c->quality[i]);
  return then < before;
}

/* The best way to do without an edge; false when there is none better than `needed`. */
static bool without_edge(const flipping *f, int32_t a, int32_t b, change *c) {
  ring r;
  triangulation t;
  if (!laves__layer_moves(f->layer, a)) {
    const int32_t swap = a;
    a = b;
    b = swap;
  }
  if (!laves__layer_moves(f->layer, a) || !find_ring(f->layer, a, b, &r, c)) return false;
  if (f->layer->patch && !may_go(f, a, b, &r, c)) return false;
  measure_old(f, c);
  const double needed = fmax(c->before + least_gain, LAVES__FLAT);
  triangulate(f, a, b, &r, needed, &t);
  if (!(t.best[0][r.count - 1] > needed)) return false;
  if (r.open && !may_open(f, a, b, &r)) return false;
  list_triangulation(f, a, b, &r, &t, 0, r.count - 1, c);
  return c->worst > needed && helps(f, c) && has_room(f, c);
}

/* Three tets around a new edge in the place of two at a face. */
static bool without_face(const flipping *f, int32_t tet, int corner, change *c) {
  const laves__layer *layer = f->layer;
  const int32_t *t = layer->tet[tet];
  const uint8_t *face = laves__tet_face[corner];
  bool moves = false;
  for (int k = 0; k < 3; k++) moves |= laves__layer_moves(layer, t[face[k]]);
  if (!moves || (layer->patch && layer->patch[tet][corner] != LAVES__NO_PATCH)) return false;
  c->opened = LAVES__NO_PATCH;
  const int32_t beyond = laves__layer_across(layer, tet, corner);
  if (beyond < 0) return false;
  int32_t b = -1;
  for (int k = 0; k < 4; k++)
    if (laves__layer_corner(layer, tet, layer->tet[beyond][k]) < 0) b = layer->tet[beyond][k];
  c->old_count = 2;
  c->old[0] = tet;
  c->old[1] = beyond;
  measure_old(f, c);
  for (int k = 0; k < 3; k++) {
    const int32_t fresh[4] = {t[corner], b, t[face[k]], t[face[(k + 1) % 3]]};
    add_fresh(f, c, fresh[0], fresh[1], fresh[2], fresh[3], quality_of(f, fresh));
    if (!(c->worst > fmax(c->before + least_gain, LAVES__FLAT))) return false;
  }
  return helps(f, c) && has_room(f, c);
}

/* ---- what is there elsewhere ---- */

static bool is_in(const int32_t t[4], int32_t v) { return t[0] == v || t[1] == v || t[2] == v || t[3] == v; }

static bool has_all(const int32_t t[4], const int32_t *vertices, int count) {
  for (int i = 0; i < count; i++)
    if (!is_in(t, vertices[i])) return false;
  return true;
}

/* Whether the vertices of an edge or face, of which one moves, are those of a tet that stays, and of none that goes. */
static bool is_elsewhere(const flipping *f, const change *c, const int32_t *vertices, int count) {
  const laves__layer *layer = f->layer;
  int lead = 0;
  for (int i = 0; i < c->old_count; i++)
    if (has_all(layer->tet[c->old[i]], vertices, count)) return false;
  while (lead < count && !laves__layer_moves(layer, vertices[lead])) lead++;
  if (lead == count) return layer->patch != NULL; /* deep inside, where nothing overlaps; in a given mesh nobody knows */
  const laves__star *star = &layer->star[vertices[lead]];
  for (int i = 0; i < star->count; i++)
    if (has_all(layer->tet[star->tet[i]], vertices, count)) return true;
  return false;
}

static bool overlaps(const flipping *f, const change *c) {
  for (int i = 0; i < c->fresh_count; i++) {
    const int32_t *t = c->fresh[i];
    for (int e = 0; e < 6; e++)
      if (is_elsewhere(f, c, (const int32_t[]){t[laves__tet_edge[e][0]], t[laves__tet_edge[e][1]]}, 2)) return true;
    for (int k = 0; k < 4; k++) {
      const uint8_t *face = laves__tet_face[k];
      if (is_elsewhere(f, c, (const int32_t[]){t[face[0]], t[face[1]], t[face[2]]}, 3)) return true;
    }
  }
  return false;
}

/* ---- making them ---- */

static bool remember(laves__journal *j, const laves__layer *layer, const int32_t t[4]) {
  for (int k = 0; k < 4; k++) {
    bool known = !laves__layer_moves(layer, t[k]);
    for (size_t i = 0; i < j->star_count && !known; i++) known = j->star[i].vertex == t[k];
    if (!known && !laves__journal_star(j, layer, t[k])) return false;
  }
  return true;
}

static void leave_stars(laves__layer *layer, int32_t tet) {
  for (int k = 0; k < 4; k++)
    if (laves__layer_moves(layer, layer->tet[tet][k])) laves__star_remove(&layer->star[layer->tet[tet][k]], tet);
  layer->tet[tet][0] = -1;
}

static bool join_stars(laves__layer *layer, int32_t tet, laves__journal *j) {
  for (int k = 0; k < 4; k++) {
    const int32_t v = layer->tet[tet][k];
    if (laves__layer_moves(layer, v) && !laves__journal_star_add(j, layer, v, tet)) return false;
  }
  return true;
}

/* The patch of a face of a fresh tet: that of the old one with its corners, or of what comes to the boundary. */
static int32_t patch_of(const laves__layer *layer, const change *c, const int32_t face[3]) {
  for (int i = 0; i < c->old_count; i++) {
    const int32_t *t = layer->tet[c->old[i]], *patch = layer->patch[c->old[i]];
    if (!has_all(t, face, 3)) continue;
    for (int k = 0; k < 4; k++)
      if (t[k] != face[0] && t[k] != face[1] && t[k] != face[2] && patch[k] != LAVES__NO_PATCH) return patch[k];
  }
  if (c->opened == LAVES__NO_PATCH) return LAVES__NO_PATCH;
  /* Its corners are the ends of the new boundary edge and one of the edge that goes. */
  int opened = 0, gone = 0;
  for (int k = 0; k < 3; k++) {
    opened += face[k] == c->opened_edge[0] || face[k] == c->opened_edge[1];
    gone += face[k] == c->gone_edge[0] || face[k] == c->gone_edge[1];
  }
  return opened == 2 && gone == 1 ? c->opened : LAVES__NO_PATCH;
}

static void find_patches(const laves__layer *layer, const change *c, int32_t patch[TETS_MAX][4]) {
  for (int i = 0; i < c->fresh_count; i++)
    for (int k = 0; k < 4; k++) {
      const uint8_t *face = laves__tet_face[k];
      patch[i][k] = patch_of(layer, c, (const int32_t[]){c->fresh[i][face[0]], c->fresh[i][face[1]], c->fresh[i][face[2]]});
    }
}

/* False, with all as it was, when memory is short. */
static bool make(laves__layer *layer, const change *c, laves__slots *slots, laves__journal *j) {
  int32_t place[TETS_MAX], patch[TETS_MAX][4];
  int taken = 0;
  if (layer->patch) find_patches(layer, c, patch);
  for (int i = 0; i < c->fresh_count; i++) place[i] = i < c->old_count ? c->old[i] : slots->tet[slots->count - 1 - taken++];
  laves__journal_clear(j);
  for (int i = 0; i < c->old_count; i++)
    if (!laves__journal_tet(j, layer, c->old[i]) || !remember(j, layer, layer->tet[c->old[i]])) return false;
  for (int i = c->old_count; i < c->fresh_count; i++)
    if (!laves__journal_tet(j, layer, place[i])) return false;
  for (int i = 0; i < c->old_count; i++) leave_stars(layer, c->old[i]);
  bool joined = true;
  for (int i = 0; i < c->fresh_count && joined; i++) {
    for (int k = 0; k < 4; k++) layer->tet[place[i]][k] = c->fresh[i][k];
    if (layer->patch) memcpy(layer->patch[place[i]], patch[i], sizeof patch[i]);
    if (layer->region) layer->region[place[i]] = layer->region[c->old[0]];
    layer->quality[place[i]] = c->quality[i];
    joined = join_stars(layer, place[i], j);
  }
  if (joined)
    slots->count -= taken;
  else
    laves__journal_undo(j, layer);
  return joined;
}

bool laves__flip_tet(const laves__frame *frame, const laves__measure *m, laves__layer *layer, int32_t tet, laves__slots *slots,
                     laves__journal *journal) {
  const flipping f = {frame, m, layer, slots};
  change best = {.worst = -HUGE_VAL}, c;
  for (int e = 0; e < 6; e++) {
    const int32_t *t = layer->tet[tet];
    if (without_edge(&f, t[laves__tet_edge[e][0]], t[laves__tet_edge[e][1]], &c) && c.worst - c.before > best.worst - best.before)
      best = c;
  }
  for (int corner = 0; corner < 4; corner++)
    if (without_face(&f, tet, corner, &c) && c.worst - c.before > best.worst - best.before) best = c;
  return best.old_count > 0 && !overlaps(&f, &best) && make(layer, &best, slots, journal);
}
