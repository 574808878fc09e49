/* Blocks are cubes; how many depends on the number of vertices alone. */
#include "improve/blocks.h"

#include <string.h>

/* Vertices in a block of a mesh that fills its box: fewer would leave too many standing still, more too little to share. */
static const double usual_vertices = 6000;
enum { PER_AXIS_MAX = 500, STANDS = LAVES__DEPTH_MAX, TURNS = 4 };

static double cube(int n) { return (double)n * n * n; }

bool laves__blocks_begin(laves__layer *layer, size_t least, laves__blocks *b) {
  const double block_vertices = least > 0 ? (double)least : usual_vertices;
  laves__box3 box = box3_empty();
  size_t count = 0;
  *b = (laves__blocks){.context = layer->context, .capacity = layer->vertex_count};
  for (size_t v = 0; v < layer->vertex_count; v++) {
    if (layer->star[v].count == 0) continue;
    box = box3_add(box, layer->position[v]);
    count++;
  }
  b->block = laves__alloc_zeroed(b->context, b->capacity, sizeof *b->block);
  b->depth = laves__alloc(b->context, b->capacity, sizeof *b->depth);
  const laves__vec3 extent = v3_sub(box.upper, box.lower);
  const double longest = fmax(extent.x, fmax(extent.y, extent.z));
  b->per_axis = 1;
  while (b->per_axis < PER_AXIS_MAX && cube(b->per_axis + 1) * block_vertices <= (double)count) b->per_axis++;
  b->lower = box.lower;
  b->side = longest / b->per_axis;
  return b->block && b->depth;
}

static int32_t along(double x, double lower, double side, double shift) { return (int32_t)floor((x - lower) / side + shift); }

static void find_blocks(laves__blocks *b, const laves__layer *layer) {
  static const double shifts[TURNS] = {0, 0.5, 0.25, 0.75}; /* of a side, in all axes */
  const double shift = shifts[b->pass % TURNS];
  const int32_t stride = b->per_axis + 2;
  for (size_t v = 0; v < layer->vertex_count; v++) {
    const laves__vec3 p = layer->position[v];
    b->block[v] = 0;
    if (b->per_axis == 1 || layer->star[v].count == 0) continue;
    const int32_t x = along(p.x, b->lower.x, b->side, shift), y = along(p.y, b->lower.y, b->side, shift),
                  z = along(p.z, b->lower.z, b->side, shift);
    b->block[v] = x + stride * (y + stride * z);
  }
}

/* Vertices of tets that are in several blocks. */
static void stand(const laves__blocks *b, laves__layer *layer) {
  for (size_t t = 0; t < layer->tet_count; t++) {
    const int32_t *v = layer->tet[t];
    if (v[0] < 0) continue;
    const int32_t block = b->block[v[0]];
    if (b->block[v[1]] == block && b->block[v[2]] == block && b->block[v[3]] == block) continue;
    for (int k = 0; k < 4; k++) layer->depth[v[k]] = STANDS;
  }
}

int laves__blocks_turns(const laves__blocks *b) { return b->per_axis > 1 ? TURNS : 1; }

laves_result laves__blocks_end(laves__blocks *b, laves__layer *layer, laves_error *error) {
  if (b->pass == 0 || b->per_axis == 1) return LAVES_OK;
  for (size_t v = 0; v < layer->vertex_count; v++)
    if (layer->depth[v] == STANDS) layer->depth[v] = b->depth[v];
  return laves__layer_link(layer, error);
}

laves_result laves__blocks_shift(laves__blocks *b, laves__layer *layer, laves_error *error) {
  const laves_result result = laves__blocks_end(b, layer, error);
  b->pass++;
  if (result != LAVES_OK || b->per_axis == 1) return result;
  memcpy(b->depth, layer->depth, layer->vertex_count * sizeof *b->depth);
  find_blocks(b, layer);
  stand(b, layer);
  return laves__layer_link(layer, error);
}

int32_t laves__blocks_of(const laves__blocks *b, const laves__layer *layer, int32_t tet) {
  for (int k = 0; k < 4; k++)
    if (laves__layer_moves(layer, layer->tet[tet][k])) return b->block[layer->tet[tet][k]];
  return -1;
}

void laves__blocks_free(laves__blocks *b) {
  if (!b->context) return;
  laves__free(b->context, b->block, b->capacity, sizeof *b->block);
  laves__free(b->context, b->depth, b->capacity, sizeof *b->depth);
  memset(b, 0, sizeof *b);
}
