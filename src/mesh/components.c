/* Components by union and find. */
#include "mesh/components.h"

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

/* Roots become numbers: each vertex comes after its root, whose number it takes over. */
static void number_components(laves__components *c) {
  for (size_t v = 0; v < c->vertex_count; v++)
    if (c->of[v] >= 0) c->of[v] = find_root(c->of, (int32_t)v);
  for (size_t v = 0; v < c->vertex_count; v++)
    if (c->of[v] >= 0) c->of[v] = c->of[v] == (int32_t)v ? (int32_t)c->count++ : c->of[c->of[v]];
}

bool laves__components_find(const laves__layer *layer, laves__components *c) {
  *c = (laves__components){.context = layer->context, .vertex_count = layer->vertex_count};
  c->of = laves__alloc(c->context, c->vertex_count, sizeof *c->of);
  if (!c->of) return false;
  join_corners(layer, c->of);
  number_components(c);
  return true;
}

void laves__components_free(laves__components *c) {
  if (!c->context) return;
  laves__free(c->context, c->of, c->vertex_count, sizeof *c->of);
  *c = (laves__components){0};
}
