/* The stage as a whole; snap.h tells its steps. */
#include "snap/snap.h"

/* The sites of the layer's vertices, before any was moved. */
static laves__vec3 *start_positions(const laves__lattice *lattice, const laves__layer *layer) {
  laves__vec3 *start = laves__alloc(lattice->context, layer->vertex_count, sizeof *start);
  for (size_t v = 0; start && v < layer->vertex_count; v++) {
    const uint32_t id = layer->origin[v];
    start[v] = id == LAVES__NO_ORIGIN
                   ? start[v - 1]
                   : laves__site_position(lattice->record[id / LAVES__C15_SITES].xyz, (int)(id % LAVES__C15_SITES));
  }
  return start;
}

laves_result laves__snap(const laves__frame *frame, laves__lattice *lattice, laves__layer *layer, laves__snap_counts *counts,
                         laves_error *error) {
  laves_context *context = lattice->context;
  laves__parted parted = {0};
  laves__vec3 *start = NULL;
  laves_result result = laves__cover(frame, lattice, error);
  if (result == LAVES_OK) result = laves__pinch_repair(lattice, &parted, &counts->pinches, error);
  if (result == LAVES_OK) result = laves__layer_build(frame, lattice, &parted, layer, error);
  if (result == LAVES_OK) {
    start = start_positions(lattice, layer);
    if (!start) result = laves__fail_memory(context, error);
  }
  if (result == LAVES_OK) {
    counts->off_surface = laves__layer_untangle(layer, start);
    for (size_t v = 0; v < layer->vertex_count; v++) counts->snapped += layer->depth[v] == 0;
  }
  laves__free(context, start, layer->vertex_count, sizeof *start);
  laves__free(context, parted.item, parted.capacity, sizeof *parted.item);
  return result;
}
