/* Each corner claims the vertex that suits it best.
 *
 * In: boundary vertices held to patches.  Out: one of them for each corner, held to it.
 *
 * The best is the nearest, with a little more for each patch of the corner that neither the vertex nor its neighbours know: a
 * vertex on the other side of a thin wall, or beyond a crease, suits less. All pairs of a corner and a vertex within reach are
 * sorted, and taken when both are still free. */
#include "features/keep.h"

#include <string.h>

#include "base/sort.h"

static const double reach = 2.5;          /* local sizes: sharp wedges are far from the last lattice vertices inside */
static const double missing_patch = 0.25; /* local sizes for each patch that is not around */

typedef struct claim {
  double cost;
  int32_t corner, vertex;
} claim;

typedef struct claims {
  laves__keeping *k;
  laves__bvh tree; /* over the boundary vertices */
  uint32_t *order; /* boundary vertex at each slot */
  int32_t *vertex; /* [count] those with faces */
  size_t count;
  claim *item;
  size_t item_count, item_capacity;
  int32_t corner; /* under way */
  bool memory;
} claims;

static bool is_around(const laves__keeping *k, int32_t vertex, int32_t patch) {
  const laves__rim *rim = &k->rim;
  if (k->start_patch[vertex] == patch) return true;
  for (uint32_t i = rim->first[vertex]; i < rim->first[vertex + 1]; i++)
    if (k->start_patch[laves__rim_next(rim, rim->at[i], vertex)] == patch) return true;
  return false;
}

static void consider(void *user, uint32_t slot) {
  claims *c = user;
  const laves__keeping *k = c->k;
  const laves__corner *corner = &k->features->corner[c->corner];
  const int32_t vertex = c->vertex[c->order[slot]];
  const double scale = laves__layer_scale(k->layer, vertex);
  const laves__vec3 place = laves__frame_from_local(k->frame, corner->position);
  double cost = v3_distance(k->start[vertex], place) / scale;
  if (cost > reach || !c->memory) return;
  for (uint32_t i = 0; i < corner->patch_count; i++)
    if (!is_around(k, vertex, k->features->corner_patch[corner->first_patch + i])) cost += missing_patch;
  c->memory = laves__grow(k->context, &c->item, &c->item_capacity, c->item_count + 1, sizeof *c->item);
  if (c->memory) c->item[c->item_count++] = (claim){cost, c->corner, vertex};
}

static bool build_tree(claims *c) {
  const laves__keeping *k = c->k;
  const laves__rim *rim = &k->rim;
  for (size_t v = 0; v < rim->vertex_count; v++)
    if (rim->first[v + 1] > rim->first[v] && !(k->free && k->free[v])) c->vertex[c->count++] = (int32_t)v;
  uint32_t(*faces)[3] = laves__alloc(k->context, c->count, sizeof *faces);
  if (!faces) return false;
  for (size_t i = 0; i < c->count; i++) faces[i][0] = faces[i][1] = faces[i][2] = (uint32_t)c->vertex[i];
  const bool done = laves__bvh_build(k->context, k->start, (const uint32_t(*)[3])faces, c->count, c->order, &c->tree);
  laves__free(k->context, faces, c->count, sizeof *faces);
  return done;
}

/* The largest local size: how far to look. */
static double largest_scale(const claims *c) {
  double largest = 0;
  for (size_t i = 0; i < c->count; i++) largest = fmax(largest, laves__layer_scale(c->k->layer, c->vertex[i]));
  return largest;
}

static bool collect(claims *c) {
  const laves__keeping *k = c->k;
  const double far = reach * largest_scale(c);
  for (size_t i = 0; i < k->features->corner_count && c->memory; i++) {
    const laves__vec3 p = laves__frame_from_local(k->frame, k->features->corner[i].position);
    c->corner = (int32_t)i;
    laves__bvh_overlaps(&c->tree, (laves__box3){v3_sub(p, v3(far, far, far)), v3_add(p, v3(far, far, far))}, consider, c);
  }
  return c->memory;
}

/* Takes claims in the order of their cost, then of corners and vertices as they were collected. */
static bool settle(claims *c) {
  laves__keeping *k = c->k;
  uint64_t *key = laves__alloc(k->context, c->item_count, sizeof *key);
  uint64_t *scratch = laves__alloc(k->context, c->item_count, sizeof *scratch);
  const bool done = key && scratch;
  if (done) {
    for (size_t i = 0; i < c->item_count; i++) key[i] = laves__sort_key(c->item[i].cost, (uint32_t)i);
    laves__sort_u64(key, scratch, c->item_count);
    for (size_t i = 0; i < c->item_count; i++) {
      const claim *item = &c->item[(uint32_t)key[i]];
      laves__hold *hold = &k->layer->hold[item->vertex];
      if (k->claimed[item->corner] != LAVES__NO_FEATURE || hold->kind == LAVES__HOLD_CORNER) continue;
      k->claimed[item->corner] = item->vertex;
      *hold = (laves__hold){item->corner, LAVES__HOLD_CORNER};
    }
  }
  laves__free(k->context, key, c->item_count, sizeof *key);
  laves__free(k->context, scratch, c->item_count, sizeof *scratch);
  return done;
}

bool laves__claim_corners(laves__keeping *k) {
  const size_t vertices = k->rim.vertex_count;
  claims c = {.k = k,
              .vertex = laves__alloc(k->context, vertices, sizeof *c.vertex),
              .order = laves__alloc(k->context, vertices, sizeof *c.order),
              .memory = true};
  for (size_t i = 0; i < k->features->corner_count; i++) k->claimed[i] = LAVES__NO_FEATURE;
  bool done = c.vertex && c.order;
  if (done && k->features->corner_count > 0 && k->rim.face_count > 0) done = build_tree(&c) && collect(&c) && settle(&c);
  laves__bvh_free(k->context, &c.tree);
  laves__free(k->context, c.item, c.item_capacity, sizeof *c.item);
  laves__free(k->context, c.vertex, vertices, sizeof *c.vertex);
  laves__free(k->context, c.order, vertices, sizeof *c.order);
  return done;
}
