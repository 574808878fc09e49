/* Arrays and stars of the boundary layer. */
#include "mesh/layer.h"

#include <string.h>

/* Room in each star's slice beyond what it starts with: a contraction seldom adds more. */
enum { STAR_SLACK = 4 };

laves_result laves__layer_create(laves_context *context, size_t vertex_count, size_t tet_count, laves__layer *layer,
                                 laves_error *error) {
  memset(layer, 0, sizeof *layer);
  layer->context = context;
  layer->vertex_count = vertex_count;
  layer->tet_count = tet_count;
  layer->position = laves__alloc(context, vertex_count, sizeof *layer->position);
  layer->normal = laves__alloc_zeroed(context, vertex_count, sizeof *layer->normal);
  layer->hint = laves__alloc(context, vertex_count, sizeof *layer->hint);
  layer->depth = laves__alloc(context, vertex_count, sizeof *layer->depth);
  layer->off_surface = laves__alloc_zeroed(context, vertex_count, sizeof *layer->off_surface);
  layer->origin = laves__alloc(context, vertex_count, sizeof *layer->origin);
  layer->star = laves__alloc_zeroed(context, vertex_count, sizeof *layer->star);
  layer->tet = laves__alloc(context, tet_count, sizeof *layer->tet);
  layer->quality = laves__alloc(context, tet_count, sizeof *layer->quality);
  if (layer->position && layer->normal && layer->hint && layer->depth && layer->off_surface && layer->origin && layer->star &&
      layer->tet && layer->quality)
    return LAVES_OK;
  return laves__fail_memory(context, error);
}

static void free_stars(laves__layer *layer) {
  laves_context *context = layer->context;
  for (size_t v = 0; layer->star && v < layer->vertex_count; v++) {
    laves__star *star = &layer->star[v];
    if (star->own_block) laves__free(context, star->tet, (size_t)star->capacity, sizeof *star->tet);
    *star = (laves__star){0};
  }
  laves__free(context, layer->star_block, layer->star_block_count, sizeof *layer->star_block);
  layer->star_block = NULL;
  layer->star_block_count = 0;
}

laves_result laves__layer_link(laves__layer *layer, laves_error *error) {
  free_stars(layer);
  for (size_t t = 0; t < layer->tet_count; t++)
    for (int k = 0; k < 4 && layer->tet[t][0] >= 0; k++) layer->star[layer->tet[t][k]].count++;
  size_t total = 0;
  for (size_t v = 0; v < layer->vertex_count; v++) {
    laves__star *star = &layer->star[v];
    star->capacity = layer->depth[v] <= LAVES__DEPTH_MOVES ? star->count + STAR_SLACK : 0;
    total += (size_t)star->capacity;
  }
  layer->star_block = laves__alloc(layer->context, total, sizeof *layer->star_block);
  if (!layer->star_block) return laves__fail_memory(layer->context, error);
  layer->star_block_count = total;
  size_t place = 0;
  for (size_t v = 0; v < layer->vertex_count; v++) {
    laves__star *star = &layer->star[v];
    star->count = 0;
    star->tet = star->capacity ? layer->star_block + place : NULL;
    place += (size_t)star->capacity;
  }
  for (size_t t = 0; t < layer->tet_count; t++)
    for (int k = 0; k < 4 && layer->tet[t][0] >= 0; k++) {
      laves__star *star = &layer->star[layer->tet[t][k]];
      if (star->capacity) star->tet[star->count++] = (int32_t)t;
    }
  return LAVES_OK;
}

/* An array of the vertices or tets, to be replaced by a longer one. */
typedef struct long_array {
  void *array; /* the address of its pointer, which is NULL where the layer has none */
  size_t size; /* of an item */
  void *longer;
} long_array;

static void *block_of(const long_array *v) {
  void *block;
  memcpy(&block, v->array, sizeof block);
  return block;
}

/* The longer arrays are all made before the first takes its place, for then nothing has to be undone when memory is short. */
static bool lengthen(laves_context *context, long_array *all, size_t array_count, size_t old, size_t extra) {
  bool memory = true;
  for (size_t i = 0; i < array_count; i++)
    if (block_of(&all[i])) memory = (all[i].longer = laves__alloc(context, old + extra, all[i].size)) && memory;
  for (size_t i = 0; i < array_count; i++) {
    void *block = block_of(&all[i]);
    if (memory && block && all[i].longer) memcpy(all[i].longer, block, old * all[i].size);
    laves__free(context, memory ? block : all[i].longer, memory ? old : old + extra, all[i].size);
    if (memory) memcpy(all[i].array, &all[i].longer, sizeof all[i].longer);
  }
  return memory;
}

bool laves__layer_extend(laves__layer *l, size_t extra) {
  const size_t old = l->tet_count;
  long_array all[] = {{&l->tet, sizeof *l->tet, NULL},
                      {&l->quality, sizeof *l->quality, NULL},
                      {&l->patch, sizeof *l->patch, NULL},
                      {&l->region, sizeof *l->region, NULL}};
  if (old + extra > INT32_MAX || !lengthen(l->context, all, LAVES__COUNT_OF(all), old, extra)) return false;
  l->tet_count = old + extra;
  for (size_t t = old; t < l->tet_count; t++) {
    l->tet[t][0] = -1;
    l->quality[t] = 0;
    for (int k = 0; k < 4 && l->patch; k++) l->patch[t][k] = LAVES__NO_PATCH;
    if (l->region) l->region[t] = 0;
  }
  return true;
}

bool laves__layer_extend_vertices(laves__layer *l, size_t extra) {
  const size_t old = l->vertex_count;
  long_array all[] = {{&l->position, sizeof *l->position, NULL}, {&l->normal, sizeof *l->normal, NULL},
                      {&l->hint, sizeof *l->hint, NULL},         {&l->depth, sizeof *l->depth, NULL},
                      {&l->hold, sizeof *l->hold, NULL},         {&l->off_surface, sizeof *l->off_surface, NULL},
                      {&l->scale, sizeof *l->scale, NULL},       {&l->origin, sizeof *l->origin, NULL},
                      {&l->star, sizeof *l->star, NULL},         {&l->fresh, sizeof *l->fresh, NULL}};
  if (old + extra > INT32_MAX || !lengthen(l->context, all, LAVES__COUNT_OF(all), old, extra)) return false;
  l->vertex_count = old + extra;
  for (size_t v = old; v < l->vertex_count; v++) {
    l->position[v] = l->normal[v] = v3(0, 0, 0);
    l->hint[v] = UINT32_MAX;
    l->depth[v] = 1;
    l->off_surface[v] = false;
    l->origin[v] = LAVES__NO_ORIGIN;
    l->star[v] = (laves__star){0};
    if (l->hold) l->hold[v] = (laves__hold){0, LAVES__HOLD_SURFACE};
    if (l->scale) l->scale[v] = 1;
    if (l->fresh) l->fresh[v] = true;
  }
  return true;
}

void laves__layer_free(laves__layer *layer) {
  laves_context *context = layer->context;
  if (!context) return;
  const size_t vertices = layer->vertex_count, tets = layer->tet_count;
  free_stars(layer);
  laves__free(context, layer->position, vertices, sizeof *layer->position);
  laves__free(context, layer->normal, vertices, sizeof *layer->normal);
  laves__free(context, layer->hint, vertices, sizeof *layer->hint);
  laves__free(context, layer->depth, vertices, sizeof *layer->depth);
  laves__free(context, layer->hold, layer->hold ? vertices : 0, sizeof *layer->hold);
  laves__free(context, layer->off_surface, vertices, sizeof *layer->off_surface);
  laves__free(context, layer->scale, layer->scale ? vertices : 0, sizeof *layer->scale);
  laves__free(context, layer->fresh, layer->fresh ? vertices : 0, sizeof *layer->fresh);
  laves__free(context, layer->origin, vertices, sizeof *layer->origin);
  laves__free(context, layer->star, vertices, sizeof *layer->star);
  laves__free(context, layer->tet, tets, sizeof *layer->tet);
  laves__free(context, layer->patch, layer->patch ? tets : 0, sizeof *layer->patch);
  laves__free(context, layer->region, layer->region ? tets : 0, sizeof *layer->region);
  laves__free(context, layer->quality, tets, sizeof *layer->quality);
  memset(layer, 0, sizeof *layer);
}

int32_t laves__layer_across(const laves__layer *layer, int32_t tet, int corner) {
  int32_t face[3];
  for (int k = 0, n = 0; k < 4; k++)
    if (k != corner) face[n++] = layer->tet[tet][k];
  int first = 0;
  while (!laves__layer_moves(layer, face[first])) first++;
  const int32_t b = face[(first + 1) % 3], c = face[(first + 2) % 3];
  const laves__star *star = &layer->star[face[first]];
  for (int i = 0; i < star->count; i++) {
    const int32_t other = star->tet[i];
    if (other != tet && laves__layer_corner(layer, other, b) >= 0 && laves__layer_corner(layer, other, c) >= 0) return other;
  }
  return -1;
}

bool laves__layer_is_boundary_face(const laves__layer *layer, int32_t tet, int corner) {
  if (layer->patch) return layer->patch[tet][corner] != LAVES__NO_PATCH;
  for (int k = 0; k < 4; k++)
    if (k != corner && layer->depth[layer->tet[tet][k]] != 0) return false;
  return laves__layer_across(layer, tet, corner) < 0;
}

bool laves__star_add(laves_context *context, laves__star *star, int32_t tet) {
  if (star->count == star->capacity) {
    const int32_t larger = 2 * star->capacity + STAR_SLACK;
    int32_t *block = laves__alloc(context, (size_t)larger, sizeof *block);
    if (!block) return false;
    if (star->count) memcpy(block, star->tet, (size_t)star->count * sizeof *block);
    if (star->own_block) laves__free(context, star->tet, (size_t)star->capacity, sizeof *star->tet);
    *star = (laves__star){block, star->count, larger, true};
  }
  star->tet[star->count++] = tet;
  return true;
}

void laves__star_remove(laves__star *star, int32_t tet) {
  int32_t i = 0;
  while (star->tet[i] != tet) i++;
  LAVES_ASSERT(i < star->count);
  star->count--;
  for (; i < star->count; i++) star->tet[i] = star->tet[i + 1]; /* the order is kept, so that undoing is exact */
}
