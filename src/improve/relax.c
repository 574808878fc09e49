/* Laplace sweeps on the surface: each surface vertex goes most of the way to the mean of its surface neighbours, counted
 * once for each tet that they share with it, and back on to the surface. One on a patch counts the neighbours that belong to it,
 * too, one on a crease those along it.  All vertices at once, into a second array, so
 * that the order does not matter; it evens out the surface and spares a quarter of the later work. */
#include "improve/relax.h"

#include "base/predicates.h"
#include "domain/held.h"

static const double share = 0.7;          /* of the way to the mean */
static const double surface_reach = 0.75; /* local sizes */

typedef struct place {
  laves__vec3 position, normal;
  uint32_t hint;
  bool moved;
} place;

typedef struct sweep {
  const laves__frame *frame;
  const laves__measure *measure;
  laves__layer *layer;
  place *other; /* [vertex_count] the new places; after the exchange the old ones */
} sweep;

/* Whether a neighbour draws a vertex. */
static bool draws(const sweep *s, int32_t v, int32_t w) {
  const laves__layer *layer = s->layer;
  const laves__hold hold = laves__layer_hold(layer, v);
  if (hold.kind == LAVES__HOLD_PATCH) return laves__hold_has_patch(s->frame->features, layer->hold[w], hold.id);
  if (hold.kind == LAVES__HOLD_CREASE) return laves__hold_on_crease(s->frame->features, layer->hold[w], hold.id);
  return v3_dot(layer->normal[v], layer->normal[w]) > 0; /* else the other side of a thin wall */
}

/* Where a vertex shall go before it is brought back on to the surface; false: nothing draws it. */
static bool find_aim(const sweep *s, int32_t v, laves__vec3 *aim) {
  const laves__layer *layer = s->layer;
  const laves__star *star = &layer->star[v];
  laves__vec3 sum = {0, 0, 0};
  int count = 0;
  for (int i = 0; i < star->count; i++)
    for (int k = 0; k < 4; k++) {
      const int32_t w = layer->tet[star->tet[i]][k];
      if (w == v || layer->depth[w] != 0 || !draws(s, v, w)) continue;
      sum = v3_add(sum, layer->position[w]);
      count++;
    }
  if (count == 0) return false;
  *aim = v3_lerp(layer->position[v], v3_scale(sum, 1.0 / count), share);
  return true;
}

/* Vertices of one reach whose feet are asked for together, where the oracle likes large calls. */
enum { ASKED_MAX = 256 };

typedef struct question {
  size_t count;
  double reach;
  size_t vertex[ASKED_MAX];
  laves__vec3 aim[ASKED_MAX];
} question;

static void find_asked_places(const sweep *s, question *q) {
  laves__projection answer[ASKED_MAX];
  for (size_t i = 0; i < q->count; i++) answer[i].hint = s->layer->hint[q->vertex[i]];
  laves__frame_project_many(s->frame, q->count, q->aim, q->reach, answer);
  for (size_t i = 0; i < q->count; i++) {
    const laves__projection *a = &answer[i];
    const bool moved = a->found && v3_distance(a->foot, q->aim[i]) <= q->reach;
    s->other[q->vertex[i]] = (place){a->foot, a->normal, a->hint, moved};
  }
  q->count = 0;
}

static void ask(const sweep *s, size_t v, laves__vec3 aim, double reach, question *q) {
  if (q->count == ASKED_MAX || (q->count > 0 && reach != q->reach)) find_asked_places(s, q);
  q->reach = reach;
  q->vertex[q->count] = v;
  q->aim[q->count++] = aim;
}

static void find_places(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const sweep *s = user;
  const laves__layer *layer = s->layer;
  const bool together = s->frame->oracle->batch > 0;
  question q;
  q.count = 0;
  for (size_t v = begin; v < end; v++) {
    place *p = &s->other[v];
    p->moved = false;
    const laves__hold hold = laves__layer_hold(layer, (int32_t)v);
    if (layer->fresh && !layer->fresh[v]) continue;
    laves__vec3 aim;
    if (layer->depth[v] != 0 || layer->off_surface[v] || hold.kind == LAVES__HOLD_CORNER || !find_aim(s, (int32_t)v, &aim))
      continue;
    p->hint = layer->hint[v];
    const double reach = surface_reach * laves__layer_scale(layer, (int32_t)v);
    if (together && hold.kind == LAVES__HOLD_SURFACE)
      ask(s, v, aim, reach, &q);
    else
      p->moved = laves__frame_project_held(s->frame, hold, aim, reach, &p->hint, &p->position, &p->normal) &&
                 v3_distance(p->position, aim) <= reach;
  }
  if (q.count > 0) find_asked_places(s, &q);
}

static void exchange(laves__layer *layer, place *p, size_t v) {
  const place old = {layer->position[v], layer->normal[v], layer->hint[v], p->moved};
  layer->position[v] = p->position;
  layer->normal[v] = p->normal;
  layer->hint[v] = p->hint;
  *p = old;
}

static void measure_tets(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const sweep *s = user;
  laves__layer *layer = s->layer;
  /* Those that nothing touched keep theirs, to the last digit. */
  if (!layer->fresh) laves__measure_tets(s->measure, layer, begin, end, layer->quality + begin);
  for (size_t t = begin; layer->fresh && t < end; t++)
    if (layer->tet[t][0] >= 0 && laves__layer_is_fresh(layer, (int32_t)t))
      layer->quality[t] = laves__layer_quality(s->measure, layer, (int32_t)t);
}

static bool is_worse(const laves__layer *layer, int32_t t, double worst) {
  if (layer->quality[t] < worst) return true;
  if (layer->quality[t] > LAVES__FLAT) return false;
  laves__vec3 p[4];
  laves__layer_points(layer, t, p);
  return laves__orient3d(p[0], p[1], p[2], p[3]) <= 0;
}

typedef struct worse {
  const laves__layer *layer;
  double worst;
} worse;

static double count_worse(const void *user, size_t begin, size_t end) {
  const worse *w = user;
  double count = 0;
  for (size_t t = begin; t < end; t++) count += w->layer->tet[t][0] >= 0 && is_worse(w->layer, (int32_t)t, w->worst);
  return count;
}

/* Sends the vertices of tets that became worse than `worst` back, until none is; each goes back at most once. */
static void take_back(sweep *s, double worst) {
  laves__layer *layer = s->layer;
  const worse of = {layer, worst};
  for (bool again = laves__parallel_sum(layer->context, NULL, layer->tet_count, count_worse, &of) > 0; again;) {
    again = false;
    for (size_t t = 0; t < layer->tet_count; t++) {
      if (layer->tet[t][0] < 0 || !is_worse(layer, (int32_t)t, worst)) continue;
      for (int k = 0; k < 4; k++) {
        const int32_t v = layer->tet[t][k];
        if (!s->other[v].moved) continue;
        exchange(layer, &s->other[v], (size_t)v);
        s->other[v].moved = false;
        again = true;
        for (int i = 0; i < layer->star[v].count; i++) {
          const int32_t around = layer->star[v].tet[i];
          layer->quality[around] = laves__layer_quality(s->measure, layer, around);
        }
      }
    }
  }
}

laves_result laves__relax_surface(const laves__frame *frame, const laves__measure *measure, int sweeps, laves__layer *layer,
                                  laves_error *error) {
  laves_context *context = layer->context;
  sweep s = {frame, measure, layer, laves__alloc(context, layer->vertex_count, sizeof *s.other)};
  if (!s.other) return laves__fail_memory(context, error);
  double worst = HUGE_VAL;
  for (size_t t = 0; t < layer->tet_count; t++)
    if (layer->tet[t][0] >= 0 && layer->quality[t] < worst) worst = layer->quality[t];
  bool done = true;
  for (int i = 0; done && i < sweeps; i++) {
    done =
        !laves__cancelled(context, "improve", 0) && laves__parallel_for(context, NULL, layer->vertex_count, 256, find_places, &s);
    if (!done) break;
    for (size_t v = 0; v < layer->vertex_count; v++)
      if (s.other[v].moved) exchange(layer, &s.other[v], v);
    done = laves__parallel_for(context, NULL, layer->tet_count, 256, measure_tets, &s);
    if (done) take_back(&s, worst);
  }
  laves__free(context, s.other, layer->vertex_count, sizeof *s.other);
  return done ? LAVES_OK : laves__fail_cancelled(error);
}
