/* The stage as a whole; snap.h tells its steps. */
#include "snap/snap.h"

/* The sites of the layer's vertices, before any was moved. */
static laves__vec3 *start_positions(const laves__lattice *lattice, const laves__layer *layer) {
  laves__vec3 *start = laves__alloc(lattice->context, layer->vertex_count, sizeof *start);
  for (size_t v = 0; start && v < layer->vertex_count; v++) {
    const uint32_t id = layer->origin[v];
    start[v] = id == LAVES__NO_ORIGIN ? start[v - 1] : laves__site_place(lattice, laves__site_of(id));
  }
  return start;
}

laves_result laves__find_surface_feet(const laves__frame *frame, const laves__lattice *lattice, laves__feet *feet,
                                      laves_error *error) {
  laves_context *context = lattice->context;
  const size_t records = lattice->record_count;
  uint32_t *wanted = laves__alloc_zeroed(context, records, sizeof *wanted);
  if (!wanted) return laves__fail_memory(context, error);
  for (size_t i = 0; i < records; i++)
    for (int site = 0; site < LAVES__C15_SITES; site++)
      if (lattice->record[i].label[site] == LAVES__LABEL_ON) wanted[i] |= UINT32_C(1) << site;
  const laves_result result = laves__feet_find(frame, lattice, wanted, feet, error);
  laves__free(context, wanted, records, sizeof *wanted);
  return result;
}

laves_result laves__snap(const laves__frame *frame, bool keep_thin, laves__lattice *lattice, laves__layer *layer,
                         laves__snap_counts *counts, laves_error *error) {
  laves_context *context = lattice->context;
  laves__parted parted = {0};
  laves__feet feet = {0};
  laves__vec3 *start = NULL;
  laves_result result = laves__cover(frame, lattice, &feet, error);
  if (result == LAVES_OK && keep_thin) result = laves__thin_cover(frame, lattice, &feet, error);
  if (result == LAVES_OK) result = laves__find_surface_feet(frame, lattice, &feet, error);
  if (result == LAVES_OK && keep_thin) result = laves__tip_cover(frame, lattice, &feet, error);
  if (result == LAVES_OK) result = laves__find_solid(frame, lattice, &feet, error);
  if (result == LAVES_OK) result = laves__pinch_repair(lattice, &parted, &counts->pinches, error);
  if (result == LAVES_OK) result = laves__find_surface_feet(frame, lattice, &feet, error); /* of sites that went ON since */
  if (result == LAVES_OK) result = laves__layer_build(&feet, lattice, &parted, NULL, layer, error);
  laves__feet_free(&feet);
  if (result == LAVES_OK) {
    start = start_positions(lattice, layer);
    if (!start) result = laves__fail_memory(context, error);
  }
  if (result == LAVES_OK) {
    laves__list_lost(frame, lattice, &parted, counts);
    counts->specks = laves__layer_drop_specks(layer);
    counts->off_surface = laves__layer_untangle(layer, start);
    for (size_t v = 0; v < layer->vertex_count; v++) counts->snapped += layer->depth[v] == 0;
    if (laves__is_cancelled(context)) result = laves__fail_cancelled(error);
  }
  laves__free(context, start, layer->vertex_count, sizeof *start);
  laves__parted_free(context, &parted);
  return result;
}
