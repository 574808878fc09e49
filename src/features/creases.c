/* The second cover: ends of edges between patches go on creases.
 *
 * In: boundary vertices held to patches, some to corners.  Out: no edge of the boundary joins two patches, as far as can be.
 *
 * Every illegal edge offers both its ends. A vertex on a patch would go to the nearest crease between its patch and those of the
 * other end, a vertex on a crease to a free corner at the crease's end. The cheapest offer is taken: the way it would move, and
 * more for faces all of whose corners would then be on creases, for they are hard to keep well shaped. Offers are looked at
 * again when they come up, since much may have changed.
 *
 * Afterwards a vertex on a crease that could go back to a patch without harm does so, furthest moved first. */
#include "features/keep.h"

#include <string.h>

#include "base/sort.h"

static const double reach = 2.5;        /* local sizes: how far a vertex may be from what it goes to */
static const double crowded_face = 0.3; /* local sizes: for each face with three corners on creases */
static const double unchanged = 1e-9;   /* local sizes: costs that agree */

typedef struct offer {
  double cost;
  int32_t vertex, other; /* the edge */
} offer;

typedef struct offers {
  laves__keeping *k;
  offer *item; /* a heap, the cheapest first */
  size_t count, capacity;
  bool memory;
} offers;

/* ---- the heap ---- */

static bool is_before(const offer *a, const offer *b) {
  if (a->cost != b->cost) return a->cost < b->cost;
  return a->vertex != b->vertex ? a->vertex < b->vertex : a->other < b->other;
}

static void push(offers *o, offer item) {
  o->memory = o->memory && laves__grow(o->k->context, &o->item, &o->capacity, o->count + 1, sizeof *o->item);
  if (!o->memory) return;
  size_t at = o->count++;
  for (; at > 0 && is_before(&item, &o->item[(at - 1) / 2]); at = (at - 1) / 2) o->item[at] = o->item[(at - 1) / 2];
  o->item[at] = item;
}

static offer pop(offers *o) {
  const offer top = o->item[0], last = o->item[--o->count];
  size_t at = 0;
  for (size_t child; (child = 2 * at + 1) < o->count; at = child) {
    if (child + 1 < o->count && is_before(&o->item[child + 1], &o->item[child])) child++;
    if (!is_before(&o->item[child], &last)) break;
    o->item[at] = o->item[child];
  }
  o->item[at] = last;
  return top;
}

/* ---- offers ---- */

/* The free corner at an end of a crease that has a patch in common with the other vertex, the nearer of two. */
static bool find_corner(const laves__keeping *k, int32_t vertex, int32_t crease, laves__hold other, laves__hold *hold) {
  const laves__features *f = k->features;
  double nearest = HUGE_VAL;
  for (int end = 0; end < 2; end++) {
    const int32_t corner = f->crease[crease].corner[end];
    if (corner == LAVES__NO_FEATURE || k->claimed[corner] != LAVES__NO_FEATURE) continue;
    const laves__hold candidate = {corner, LAVES__HOLD_CORNER};
    const double distance = v3_distance(k->start[vertex], laves__frame_from_local(k->frame, f->corner[corner].position));
    if (distance >= nearest || !laves__holds_meet(f, candidate, other)) continue;
    nearest = distance;
    *hold = candidate;
  }
  return nearest < HUGE_VAL;
}

/* The crease that a vertex on a patch goes to, for the sake of an edge to another. */
static bool find_crease(const laves__keeping *k, int32_t vertex, int32_t other, laves__hold *hold) {
  const laves__features *f = k->features;
  const laves__hold here = k->layer->hold[vertex], there = k->layer->hold[other];
  const laves__vec3 local = laves__frame_to_local(k->frame, k->start[vertex]);
  const double range = reach * laves__layer_scale(k->layer, vertex) * k->frame->size;
  int32_t room[2], crease;
  const int32_t *patches;
  laves__vec3 foot;
  const int count = laves__hold_patches(f, there, room, &patches);
  hold->kind = LAVES__HOLD_CREASE;
  if (laves__holds_meet(f, here, there)) {
    if (!laves__way_crosses_seam(k->frame, k->start[vertex], k->start[other], here.id, k->layer->normal[vertex],
                                 k->layer->normal[other], &crease))
      return false;
  } else {
    crease = laves__crease_between(f, here.id, patches, count, local, range, &foot);
    if (crease == LAVES__NO_FEATURE) crease = laves__crease_between(f, here.id, NULL, 0, local, range, &foot);
  }
  hold->id = crease;
  return crease != LAVES__NO_FEATURE;
}

/* Faces around a vertex that would have three corners on creases if it had. */
static int count_crowded(const laves__keeping *k, int32_t vertex) {
  const laves__rim *rim = &k->rim;
  const laves__hold *hold = k->layer->hold;
  int count = 0;
  for (uint32_t i = rim->first[vertex]; i < rim->first[vertex + 1]; i++)
    count += hold[laves__rim_next(rim, rim->at[i], vertex)].kind >= LAVES__HOLD_CREASE &&
             hold[laves__rim_previous(rim, rim->at[i], vertex)].kind >= LAVES__HOLD_CREASE;
  return count;
}

/* What a vertex would be held to for the sake of an edge, and the cost; false when nothing helps. */
static bool make_offer(const laves__keeping *k, int32_t vertex, int32_t other, laves__hold *hold, double *cost) {
  const laves__hold here = k->layer->hold[vertex];
  const double scale = laves__layer_scale(k->layer, vertex);
  laves__vec3 place;
  if (here.kind == LAVES__HOLD_CORNER) return false;
  if (here.kind == LAVES__HOLD_CREASE) {
    if (!find_corner(k, vertex, here.id, k->layer->hold[other], hold)) return false;
  } else if (!find_crease(k, vertex, other, hold)) {
    return false;
  }
  if (!laves__held_place(k, vertex, *hold, &place)) return false;
  *cost = v3_distance(k->start[vertex], place) / scale + crowded_face * count_crowded(k, vertex);
  return *cost <= reach + crowded_face * count_crowded(k, vertex);
}

static void offer_end(offers *o, int32_t vertex, int32_t other) {
  laves__hold hold;
  double cost;
  if (make_offer(o->k, vertex, other, &hold, &cost)) push(o, (offer){cost, vertex, other});
}

/* Both ends of the illegal edges that leave a vertex; `first` only those to later vertices. */
static void offer_edges(offers *o, int32_t vertex, bool first) {
  const laves__rim *rim = &o->k->rim;
  for (uint32_t i = rim->first[vertex]; i < rim->first[vertex + 1]; i++) {
    const int32_t other = laves__rim_next(rim, rim->at[i], vertex);
    if ((first && other < vertex) || laves__edge_is_legal(o->k, vertex, other)) continue;
    offer_end(o, vertex, other);
    offer_end(o, other, vertex);
  }
}

/* Takes the cheapest offer if it still stands. */
static void take(offers *o) {
  laves__keeping *k = o->k;
  const offer top = pop(o);
  laves__hold hold;
  double cost;
  if (laves__edge_is_legal(k, top.vertex, top.other) || !make_offer(k, top.vertex, top.other, &hold, &cost)) return;
  if (cost > top.cost + unchanged) {
    push(o, (offer){cost, top.vertex, top.other});
    return;
  }
  k->layer->hold[top.vertex] = hold;
  if (hold.kind == LAVES__HOLD_CORNER) k->claimed[hold.id] = top.vertex;
  offer_edges(o, top.vertex, false);
}

bool laves__cover_creases(laves__keeping *k) {
  offers o = {.k = k, .memory = true};
  bool cancelled = false;
  for (size_t v = 0; v < k->rim.vertex_count && !cancelled; v++) {
    offer_edges(&o, (int32_t)v, true);
    cancelled = laves__cancelled_at(k->context, "features", v, k->rim.vertex_count);
  }
  for (size_t step = 0; o.count > 0 && o.memory && !cancelled; step++) {
    take(&o);
    cancelled = laves__cancelled_at(k->context, "features", step, step + o.count);
  }
  laves__free(k->context, o.item, o.capacity, sizeof *o.item);
  return o.memory && !cancelled;
}

/* ---- the way back ---- */

/* Gives a vertex back to a patch of its crease, if all around it stays as legal as it was. */
static void give_back(const laves__keeping *k, int32_t vertex) {
  laves__hold *hold = &k->layer->hold[vertex];
  const laves__hold crease = *hold;
  int32_t room[2];
  const int32_t *patches;
  const int count = laves__hold_patches(k->features, crease, room, &patches), illegal = laves__illegal_around(k, vertex);
  for (int pass = 0; pass < 2; pass++) /* the patch that it came from first */
    for (int i = 0; i < count; i++) {
      if ((patches[i] == k->start_patch[vertex]) != (pass == 0)) continue;
      *hold = (laves__hold){patches[i], LAVES__HOLD_PATCH};
      laves__vec3 place;
      if (laves__held_place(k, vertex, *hold, &place) && laves__illegal_around(k, vertex) <= illegal) return;
      *hold = crease;
    }
}

bool laves__prune_creases(laves__keeping *k) {
  size_t count = 0, next = 0;
  for (size_t v = 0; v < k->rim.vertex_count; v++) count += k->layer->hold[v].kind == LAVES__HOLD_CREASE;
  uint64_t *key = laves__alloc(k->context, count, sizeof *key), *scratch = laves__alloc(k->context, count, sizeof *scratch);
  bool done = key && scratch;
  for (size_t v = 0; done && v < k->rim.vertex_count; v++) {
    if (k->layer->hold[v].kind != LAVES__HOLD_CREASE) continue;
    done = !laves__cancelled_at(k->context, "features", next, count);
    laves__vec3 place;
    const bool found = laves__held_place(k, (int32_t)v, k->layer->hold[v], &place);
    const double way = found ? v3_distance(place, k->start[v]) / laves__layer_scale(k->layer, (int32_t)v) : reach;
    key[next++] = laves__sort_key(way, (uint32_t)v);
  }
  if (done) laves__sort_u64(key, scratch, count);
  for (size_t i = count; done && i-- > 0;) {
    give_back(k, (int32_t)(uint32_t)key[i]);
    done = !laves__cancelled_at(k->context, "features", i, count);
  }
  laves__free(k->context, key, count, sizeof *key);
  laves__free(k->context, scratch, count, sizeof *scratch);
  return done;
}
