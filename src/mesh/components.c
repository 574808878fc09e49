/* Components by union and find; twins by a hash of all that improvement starts from. */
#include "mesh/components.h"

#include <stdlib.h>
#include <string.h>

/* ---- components ---- */

static int32_t find_root(int32_t *parent, int32_t v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

/* The root of a set is its first vertex; vertices of no tet have -1. */
static void join_corners(const laves__layer *layer, int32_t *parent) {
  for (size_t v = 0; v < layer->vertex_count; v++) parent[v] = -1;
  for (size_t t = 0; t < layer->tet_count; t++)
    for (int k = 0; k < 4 && layer->tet[t][0] >= 0; k++) parent[layer->tet[t][k]] = layer->tet[t][k];
  for (size_t t = 0; t < layer->tet_count; t++)
    for (int k = 1; k < 4 && layer->tet[t][0] >= 0; k++) {
      const int32_t a = find_root(parent, layer->tet[t][0]), b = find_root(parent, layer->tet[t][k]);
      parent[a > b ? a : b] = a > b ? b : a;
    }
}

/* Roots become numbers: each vertex comes after its root. */
static void number_components(laves__components *c) {
  for (size_t v = 0; v < c->vertex_count; v++)
    if (c->of[v] >= 0) c->place[v] = find_root(c->of, (int32_t)v);
  for (size_t v = 0; v < c->vertex_count; v++)
    if (c->of[v] >= 0) c->of[v] = c->place[v] == (int32_t)v ? (int32_t)c->count++ : c->of[c->place[v]];
}

static void list_vertices(laves__components *c) {
  for (size_t v = 0; v < c->vertex_count; v++)
    if (c->of[v] >= 0) c->first[c->of[v] + 1]++;
  for (size_t i = 0; i < c->count; i++) c->first[i + 1] += c->first[i];
  int32_t last = c->first[c->count];
  for (size_t v = 0; v < c->vertex_count; v++) {
    c->place[v] = c->of[v] >= 0 ? c->first[c->of[v]]++ : last++;
    c->vertex[c->place[v]] = (int32_t)v;
  }
  for (size_t i = c->count; i-- > 0;) c->first[i + 1] = c->first[i];
  c->first[0] = 0;
}

static void hash_vertex(const laves__layer *layer, int32_t v, laves__hash128 *hash) {
  const laves__hold hold = laves__layer_hold(layer, v);
  const uint32_t facts[5] = {layer->origin[v], layer->depth[v], layer->off_surface[v], (uint32_t)hold.id, hold.kind};
  *hash = laves__hash_bytes(&layer->position[v], sizeof layer->position[v], sizeof(double), *hash);
  *hash = laves__hash_bytes(facts, sizeof facts, sizeof facts[0], *hash);
}

static void hash_components(const laves__layer *layer, laves__components *c) {
  for (size_t v = 0; v < c->vertex_count; v++)
    if (c->of[v] >= 0) hash_vertex(layer, (int32_t)v, &c->hash[c->of[v]]);
  for (size_t t = 0; t < layer->tet_count; t++) {
    if (layer->tet[t][0] < 0) continue;
    const int32_t component = c->of[layer->tet[t][0]];
    int32_t corner[4];
    for (int k = 0; k < 4; k++) corner[k] = c->place[layer->tet[t][k]] - c->first[component];
    c->hash[component] = laves__hash_bytes(corner, sizeof corner, sizeof corner[0], c->hash[component]);
  }
}

bool laves__components_find(const laves__layer *layer, laves__components *c) {
  laves_context *context = layer->context;
  *c = (laves__components){.context = context, .vertex_count = layer->vertex_count};
  c->of = laves__alloc(context, c->vertex_count, sizeof *c->of);
  c->place = laves__alloc(context, c->vertex_count, sizeof *c->place);
  c->vertex = laves__alloc(context, c->vertex_count, sizeof *c->vertex);
  if (!c->of || !c->place || !c->vertex) return false;
  join_corners(layer, c->of);
  number_components(c);
  c->first = laves__alloc_zeroed(context, c->count + 1, sizeof *c->first);
  c->hash = laves__alloc_zeroed(context, c->count, sizeof *c->hash);
  if (!c->first || !c->hash) return false;
  list_vertices(c);
  hash_components(layer, c);
  return true;
}

void laves__components_free(laves__components *c) {
  if (!c->context) return;
  laves__free(c->context, c->of, c->vertex_count, sizeof *c->of);
  laves__free(c->context, c->place, c->vertex_count, sizeof *c->place);
  laves__free(c->context, c->vertex, c->vertex_count, sizeof *c->vertex);
  laves__free(c->context, c->first, c->count + 1, sizeof *c->first);
  laves__free(c->context, c->hash, c->count, sizeof *c->hash);
  *c = (laves__components){0};
}

/* ---- twins ---- */

typedef struct entry {
  laves__hash128 hash;
  int32_t component;
} entry;

static int by_hash(const void *left, const void *right) {
  const entry *a = left, *b = right;
  if (a->hash.high != b->hash.high) return a->hash.high < b->hash.high ? -1 : 1;
  if (a->hash.low != b->hash.low) return a->hash.low < b->hash.low ? -1 : 1;
  return 0;
}

static size_t size_of(const laves__components *c, int32_t component) {
  return (size_t)(c->first[component + 1] - c->first[component]);
}

static bool match(laves__twins *t) {
  laves_context *context = t->improved->context;
  entry *all = laves__alloc(context, t->now->count, sizeof *all);
  if (!all) return false;
  for (size_t i = 0; i < t->now->count; i++) all[i] = (entry){t->now->hash[i], (int32_t)i};
  if (t->now->count) qsort(all, t->now->count, sizeof *all, by_hash);
  for (size_t i = 0; i < t->before->count; i++) {
    const entry wanted = {t->before->hash[i], 0};
    const entry *found = t->now->count ? bsearch(&wanted, all, t->now->count, sizeof *all, by_hash) : NULL;
    const bool same = found && size_of(t->now, found->component) == size_of(t->before, (int32_t)i);
    t->twin[i] = same ? found->component : -1;
  }
  laves__free(context, all, t->now->count, sizeof *all);
  return true;
}

/* Vertices that improvement added belong to the component of their tets; false when a tet has none but such. */
static bool find_owners(laves__twins *t) {
  const laves__layer *layer = t->improved;
  for (size_t v = 0; v < layer->vertex_count; v++) t->owner[v] = v < t->before->vertex_count ? t->before->of[v] : -1;
  bool all = false;
  for (bool more = true; more && !all;) {
    more = false;
    all = true;
    for (size_t i = 0; i < layer->tet_count; i++) {
      const int32_t *tet = layer->tet[i];
      int32_t owner = -1;
      for (int k = 0; k < 4 && tet[0] >= 0; k++) owner = owner < 0 ? t->owner[tet[k]] : owner;
      all = all && (tet[0] < 0 || owner >= 0);
      for (int k = 0; k < 4 && owner >= 0; k++) {
        more = more || t->owner[tet[k]] < 0;
        t->owner[tet[k]] = owner;
      }
    }
  }
  return all;
}

bool laves__twins_find(const laves__layer *improved, const laves__components *before, const laves__components *now,
                       const bool *again, laves__twins *t) {
  laves_context *context = improved->context;
  *t = (laves__twins){.improved = improved, .before = before, .now = now};
  t->owner = laves__alloc(context, improved->vertex_count, sizeof *t->owner);
  t->twin = laves__alloc(context, before->count, sizeof *t->twin);
  if (!t->owner || !t->twin || !match(t)) return false;
  const bool owned = find_owners(t);
  for (size_t i = 0; i < before->count; i++)
    if (!owned || (again && again[i])) t->twin[i] = -1;
  return true;
}

void laves__twins_free(laves__twins *t) {
  if (!t->improved) return;
  laves__free(t->improved->context, t->owner, t->improved->vertex_count, sizeof *t->owner);
  laves__free(t->improved->context, t->twin, t->before->count, sizeof *t->twin);
  *t = (laves__twins){0};
}

void laves__twins_set_aside(const laves__twins *t, laves__layer *layer) {
  for (size_t i = 0; i < t->before->count; i++) {
    if (t->twin[i] < 0) continue;
    for (int32_t at = t->now->first[t->twin[i]]; at < t->now->first[t->twin[i] + 1]; at++) {
      laves__star *star = &layer->star[t->now->vertex[at]];
      for (int32_t k = 0; k < star->count; k++) layer->tet[star->tet[k]][0] = -1;
      star->count = 0;
    }
  }
}

/* Whether a vertex of the improved layer comes back. */
static bool comes_back(const laves__twins *t, int32_t v) { return t->owner[v] >= 0 && t->twin[t->owner[v]] >= 0; }

/* The number of a vertex that has one already. */
static int32_t number_of(const laves__twins *t, int32_t v) {
  const int32_t component = t->owner[v], rank = t->before->place[v] - t->before->first[component];
  return t->now->vertex[t->now->first[t->twin[component]] + rank];
}

static void copy_vertex(const laves__layer *from, size_t v, laves__layer *to, int32_t w) {
  to->position[w] = from->position[v];
  to->normal[w] = from->normal[v];
  to->hint[w] = from->hint[v];
  to->depth[w] = from->depth[v];
  to->off_surface[w] = from->off_surface[v];
  to->origin[w] = from->origin[v];
  if (to->hold) to->hold[w] = laves__layer_hold(from, (int32_t)v);
  if (to->scale) to->scale[w] = (float)laves__layer_scale(from, (int32_t)v);
}

/* `number`: of each vertex that comes back. */
static bool add_tets(const laves__twins *t, const int32_t *number, laves__layer *layer, size_t at) {
  const laves__layer *from = t->improved;
  for (size_t i = 0; i < from->tet_count; i++) {
    if (from->tet[i][0] < 0 || !comes_back(t, from->tet[i][0])) continue;
    layer->quality[at] = from->quality[i];
    for (int k = 0; k < 4; k++) {
      const int32_t v = number[from->tet[i][k]];
      layer->tet[at][k] = v;
      if (laves__layer_moves(layer, v) && !laves__star_add(layer->context, &layer->star[v], (int32_t)at)) return false;
    }
    at++;
  }
  return true;
}

bool laves__twins_bring_back(const laves__twins *t, laves__layer *layer) {
  const laves__layer *from = t->improved;
  const size_t old_vertices = layer->vertex_count, old_tets = layer->tet_count;
  size_t vertices = 0, tets = 0;
  for (size_t v = t->before->vertex_count; v < from->vertex_count; v++) vertices += comes_back(t, (int32_t)v);
  for (size_t i = 0; i < from->tet_count; i++) tets += from->tet[i][0] >= 0 && comes_back(t, from->tet[i][0]);
  int32_t *number = laves__alloc(layer->context, from->vertex_count, sizeof *number);
  bool memory = number && laves__layer_extend_vertices(layer, vertices) && laves__layer_extend(layer, tets);
  size_t next = old_vertices;
  for (size_t v = 0; memory && v < from->vertex_count; v++) {
    if (!comes_back(t, (int32_t)v)) continue;
    number[v] = v < t->before->vertex_count ? number_of(t, (int32_t)v) : (int32_t)next++;
    copy_vertex(from, v, layer, number[v]);
  }
  memory = memory && add_tets(t, number, layer, old_tets);
  laves__free(layer->context, number, from->vertex_count, sizeof *number);
  return memory;
}
