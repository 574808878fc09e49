/* Edge splits: a vertex more, where creases leave too few.
 *
 *        a                a             each tet around the edge becomes two, one at a and one at b; the new vertex is smoothed,
 *      / | \            / | \           then what is bad around it
 *    c---+---d   ==>  c---m---d
 *      \ | /            \ | /
 *        b                b
 *
 * On a crease the new vertex is held to it, elsewhere on the boundary to the patch of the edge's faces. Source: [klingner2007].
 */
#include "improve/split.h"

#include <string.h>

#include "improve/fit.h"
#include "improve/guard.h"
#include "improve/smooth.h"
#include "mesh/mesh.h"

enum { AROUND_MAX = 12, EDGES = 3 };
static const double shortest = 0.7;  /* local sizes: halves of shorter edges are of no use */
static const double thinnest = 1e-3; /* sine of an angle of a face below which its plane is not told by it */

typedef struct around {
  int32_t tet[AROUND_MAX];
  int count;
  bool on_boundary;
} around;

/* The tets around an edge, of whose ends the first moves; false when they are too many. */
static bool find_around(const laves__layer *layer, int32_t a, int32_t b, around *r) {
  const laves__star *star = &layer->star[a];
  r->count = 0;
  r->on_boundary = false;
  for (int i = 0; i < star->count; i++) {
    const int32_t t = star->tet[i];
    if (laves__layer_corner(layer, t, b) < 0) continue;
    if (r->count == AROUND_MAX) return false;
    r->tet[r->count++] = t;
    for (int k = 0; k < 4; k++)
      if (layer->tet[t][k] != a && layer->tet[t][k] != b && laves__layer_is_boundary_face(layer, t, k)) r->on_boundary = true;
  }
  return r->count > 0;
}

/* What holds the middle of a boundary edge: its crease, or the patch of one of its faces. */
static laves__hold hold_of_edge(const laves__frame *frame, const laves__layer *layer, int32_t a, int32_t b, const around *r) {
  if (!layer->hold) return (laves__hold){0, LAVES__HOLD_SURFACE};
  if (laves__is_crease_edge(frame, layer, a, b))
    return (laves__hold){laves__holds_crease(frame->features, layer->hold[a], layer->hold[b]), LAVES__HOLD_CREASE};
  for (int i = 0; i < r->count; i++)
    for (int k = 0; k < 4; k++) {
      const int32_t *t = layer->tet[r->tet[i]];
      if (t[k] == a || t[k] == b || !laves__layer_is_boundary_face(layer, r->tet[i], k)) continue;
      int32_t face[3];
      for (int j = 0; j < 3; j++) face[j] = t[laves__tet_face[k][j]];
      const int32_t patch = laves__layer_face_patch(frame, layer, face);
      if (patch != LAVES__NO_FEATURE) return (laves__hold){patch, LAVES__HOLD_PATCH};
    }
  return (laves__hold){0, LAVES__HOLD_SURFACE};
}

/* Faces at an edge beyond which there is nothing. */
static int outer_faces(const laves__layer *layer, int32_t a, int32_t b, const around *r) {
  int count = 0;
  for (int i = 0; i < r->count; i++)
    for (int k = 0; k < 4; k++) {
      const int32_t *t = layer->tet[r->tet[i]];
      if (t[k] == a || t[k] == b || layer->patch[r->tet[i]][k] == LAVES__NO_PATCH) continue;
      count += laves__layer_across(layer, r->tet[i], k) < 0;
    }
  return count;
}

/* The same where the boundary is given: in its patch, or on its crease, which is the edge itself. False: its faces are too thin
 * to tell. */
static bool hold_given(laves__layer *layer, int32_t a, int32_t b, const around *r, int32_t m) {
  int32_t patch;
  if (layer->fixed_boundary || outer_faces(layer, a, b, r) > 2) return false; /* where the boundary touches itself it stays */
  laves__given_edge(layer, a, b, &patch);
  const laves__vec3 along = v3_sub(layer->position[b], layer->position[a]);
  if (patch == LAVES__NO_PATCH) {
    layer->hold[m] = (laves__hold){0, LAVES__HOLD_CREASE};
    layer->normal[m] = v3_unit(along);
    return true;
  }
  layer->hold[m] = (laves__hold){0, LAVES__HOLD_PATCH};
  for (int i = 0; i < 2; i++) {
    const int32_t end = i ? b : a;
    if (layer->hold[end].kind != LAVES__HOLD_PATCH) continue;
    layer->normal[m] = layer->normal[end];
    return true;
  }
  for (int i = 0; i < r->count; i++)
    for (int k = 0; k < 4; k++) {
      const int32_t *t = layer->tet[r->tet[i]];
      if (t[k] == a || t[k] == b || layer->patch[r->tet[i]][k] == LAVES__NO_PATCH) continue;
      int32_t third = -1;
      for (int c = 0; c < 4; c++)
        if (c != k && t[c] != a && t[c] != b) third = t[c];
      const laves__vec3 aside = v3_sub(layer->position[third], layer->position[a]), normal = v3_cross(along, aside);
      if (v3_norm(normal) < thinnest * v3_norm(along) * v3_norm(aside)) continue;
      layer->normal[m] = v3_unit(normal);
      return true;
    }
  return false;
}

/* Brings a dead vertex to life in the middle of an edge; false when it finds no place on the surface. */
static bool make_vertex(const laves__frame *frame, laves__layer *layer, int32_t a, int32_t b, const around *r, int32_t m) {
  const double scale = 0.5 * (laves__layer_scale(layer, a) + laves__layer_scale(layer, b));
  layer->position[m] = v3_lerp(layer->position[a], layer->position[b], 0.5);
  layer->hint[m] = layer->hint[a];
  layer->off_surface[m] = false;
  layer->depth[m] = r->on_boundary ? 0 : 1;
  if (layer->scale) layer->scale[m] = (float)scale;
  if (!r->on_boundary) return true;
  if (layer->patch) return hold_given(layer, a, b, r, m);
  const laves__hold hold = hold_of_edge(frame, layer, a, b, r);
  if (layer->hold) layer->hold[m] = hold;
  return laves__frame_project_held(frame, hold, layer->position[m], 0.5 * scale, &layer->hint[m], &layer->position[m],
                                   &layer->normal[m]);
}

/* The face between the halves is inside; the face that was opposite b is the half's at a, and the other way round. */
static void share_patches(laves__layer *layer, int32_t t, int32_t fresh, int at_a, int at_b) {
  memcpy(layer->patch[fresh], layer->patch[t], sizeof *layer->patch);
  layer->patch[fresh][at_a] = LAVES__NO_PATCH;
  layer->patch[t][at_b] = LAVES__NO_PATCH;
  if (layer->region) layer->region[fresh] = layer->region[t];
}

/* Everything changed is in the journal first; false when memory is short. */
static bool split(laves__layer *layer, int32_t a, int32_t b, const around *r, int32_t m, laves__slots *slots, laves__journal *j) {
  if (!laves__journal_star(j, layer, m)) return false;
  for (int i = 0; i < r->count; i++)
    for (int k = 0; k < 4; k++) {
      const int32_t v = layer->tet[r->tet[i]][k];
      bool known = !laves__layer_moves(layer, v);
      for (size_t s = 0; s < j->star_count && !known; s++) known = j->star[s].vertex == v;
      if (!known && !laves__journal_star(j, layer, v)) return false;
    }
  for (int i = 0; i < r->count; i++) {
    const int32_t t = r->tet[i], fresh = slots->tet[slots->count - 1 - i];
    if (!laves__journal_tet(j, layer, t) || !laves__journal_tet(j, layer, fresh)) return false;
    for (int k = 0; k < 4; k++) layer->tet[fresh][k] = layer->tet[t][k] == b ? m : layer->tet[t][k]; /* the half at a */
    if (layer->patch) share_patches(layer, t, fresh, laves__layer_corner(layer, t, a), laves__layer_corner(layer, t, b));
    bool done = true;
    for (int k = 0; k < 4 && done; k++) {
      const int32_t v = layer->tet[fresh][k];
      if (laves__layer_moves(layer, v)) done = laves__journal_star_add(j, layer, v, fresh);
    }
    if (!done) return false;
  }
  return true;
}

/* The old tets become the halves at b: a goes from them. */
static bool finish(laves__layer *layer, int32_t a, const around *r, int32_t m, laves__journal *j) {
  for (int i = 0; i < r->count; i++) {
    const int32_t t = r->tet[i];
    layer->tet[t][laves__layer_corner(layer, t, a)] = m;
    if (laves__layer_moves(layer, a)) laves__star_remove(&layer->star[a], t);
    if (!laves__journal_star_add(j, layer, m, t)) return false;
  }
  return true;
}

static double measure_around(const laves__measure *m, laves__layer *layer, int32_t vertex) {
  const laves__star *star = &layer->star[vertex];
  double worst = HUGE_VAL;
  for (int i = 0; i < star->count; i++) {
    layer->quality[star->tet[i]] = laves__layer_quality(m, layer, star->tet[i]);
    worst = fmin(worst, layer->quality[star->tet[i]]);
  }
  return worst;
}

static double worst_touched(const laves__layer *layer, const laves__journal *j) {
  double worst = HUGE_VAL;
  for (size_t i = 0; i < j->tet_count; i++)
    if (layer->tet[j->tet[i].tet][0] >= 0) worst = fmin(worst, layer->quality[j->tet[i].tet]);
  return worst;
}

/* The new vertex, then the corners of what is still bad around it, each once, then the new vertex again. */
static void smooth_around(const laves__frame *frame, const laves__measure *measure, double target, laves__layer *layer, int32_t m,
                          laves__journal *j) {
  enum { DONE_MAX = 32 };
  int32_t done[DONE_MAX];
  int count = 0;
  laves__smooth_vertex(frame, measure, target, layer, m, j);
  for (int i = 0; i < layer->star[m].count; i++) {
    const int32_t t = layer->star[m].tet[i];
    for (int k = 0; k < 4 && layer->quality[t] < target; k++) {
      const int32_t v = layer->tet[t][k];
      bool known = v == m || !laves__layer_moves(layer, v) || count == DONE_MAX;
      for (int d = 0; d < count && !known; d++) known = done[d] == v;
      if (known) continue;
      done[count++] = v;
      laves__smooth_vertex(frame, measure, target, layer, v, j);
    }
  }
  laves__smooth_vertex(frame, measure, target, layer, m, j);
}

static bool split_edge(const laves__frame *frame, const laves__measure *measure, double target, laves__layer *layer, int32_t a,
                       int32_t b, laves__slots *slots, laves__spare *spare, laves__journal *j) {
  enum { ROUNDS = 2 };
  around r;
  if (!laves__layer_moves(layer, a) || !laves__layer_moves(layer, b)) return false;
  if (!find_around(layer, a, b, &r) || r.count > slots->count) return false;
  const int32_t m = spare->vertex[spare->count - 1];
  if (!make_vertex(frame, layer, a, b, &r, m)) return false;
  double before = HUGE_VAL;
  for (int i = 0; i < r.count; i++) before = fmin(before, layer->quality[r.tet[i]]);
  laves__journal_clear(j);
  bool good = split(layer, a, b, &r, m, slots, j) && finish(layer, a, &r, m, j) &&
              (measure_around(measure, layer, m) > LAVES__FLAT || layer->patch);
  for (int round = 0; good && round < ROUNDS; round++) smooth_around(frame, measure, target, layer, m, j);
  good = good && worst_touched(layer, j) > fmax(before, LAVES__FLAT) &&
         (!laves__weighs_all(measure, before) || laves__lacks_less(layer, j)) && laves__feature_faults(frame, layer, m) == 0;
  if (good && r.on_boundary) {
    laves__fit fit = LAVES__FIT_NONE;
    laves__fit_star(frame, layer, m, &fit);
    good = laves__fit_within(&fit, &LAVES__FIT_LIMIT);
  }
  if (good) {
    slots->count -= r.count;
    spare->count--;
  } else {
    laves__journal_undo(j, layer);
    layer->depth[m] = 1;
  }
  return good;
}

bool laves__split_tet(const laves__frame *frame, const laves__measure *measure, double target, laves__layer *layer, int32_t tet,
                      laves__slots *slots, laves__spare *spare, laves__journal *journal) {
  int order[6];
  double length[6]; /* squared, in local sizes */
  for (int e = 0; e < 6; e++) {
    const int32_t v = layer->tet[tet][laves__tet_edge[e][0]], w = layer->tet[tet][laves__tet_edge[e][1]];
    const double scale = 0.5 * (laves__layer_scale(layer, v) + laves__layer_scale(layer, w));
    length[e] = v3_norm2(v3_sub(layer->position[v], layer->position[w])) / (scale * scale);
    int at = e;
    for (; at > 0 && length[order[at - 1]] < length[e]; at--) order[at] = order[at - 1];
    order[at] = e;
  }
  const int edges = layer->patch ? 6 : EDGES;
  const double least = layer->patch ? 0.3 : shortest;
  for (int e = 0; e < edges && spare->count > 0 && length[order[e]] > least * least; e++) {
    const int32_t a = layer->tet[tet][laves__tet_edge[order[e]][0]], b = layer->tet[tet][laves__tet_edge[order[e]][1]];
    if (split_edge(frame, measure, target, layer, a, b, slots, spare, journal)) return true;
  }
  return false;
}
