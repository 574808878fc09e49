/* The stage as a whole; stuff.h tells its steps. */
#include "stuff/stuff.h"

#include <string.h>

#include "stuff/stuffing.h"

/* Sites of the zone have the label of their sign; tets with a corner in the zone and all ON are out; nothing is numbered. */
static void reset_labels(laves__lattice *lattice) {
  for (size_t i = 0; i < lattice->record_count; i++) {
    laves__record *r = &lattice->record[i];
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      if (r->zone >> site & 1) r->label[site] = r->sign[site];
      r->depth[site] = UINT8_MAX;
      r->vertex[site] = -1;
    }
  }
  for (size_t i = 0; i < lattice->record_count; i++) {
    laves__record *r = &lattice->record[i];
    for (int tet = 0; tet < LAVES__C15_TETS; tet++) {
      if (!laves__bit(r->solid, tet)) continue;
      laves__site corner[4];
      bool zoned = false;
      laves__tet_sites(r, tet, corner);
      for (int k = 0; k < 4; k++) zoned |= corner[k].cell >= 0 && lattice->record[corner[k].cell].zone >> corner[k].site & 1;
      if (zoned) laves__flip_bit(r->solid, tet);
    }
  }
}

static size_t count_vertices(const laves__stuffing *s, const laves__cuts *cuts) {
  size_t count = cuts->vertex_count;
  for (size_t id = 0; id < s->site_count; id++) count += s->snapped[id].along != UINT8_MAX;
  return count;
}

static size_t count_left(const laves__lattice *lattice, const laves__layer *layer) {
  size_t count = 0;
  for (size_t v = 0; v < layer->vertex_count; v++) {
    const uint32_t id = layer->origin[v];
    if (layer->depth[v] != 0 || id == LAVES__NO_ORIGIN || layer->star[v].count == 0) continue;
    count += !(lattice->record[id / LAVES__C15_SITES].zone >> id % LAVES__C15_SITES & 1);
  }
  return count;
}

static laves_result stuff_once(laves__stuffing *s, laves__parted *parted, bool *grown, laves__stuff_counts *counts,
                               laves_error *error) {
  counts->unsnapped = 0;
  reset_labels(s->lattice);
  laves_result result = laves__find_crossings(s, error);
  if (result == LAVES_OK) result = laves__warp(s, error);
  if (result == LAVES_OK) result = laves__keep_inner(s, &counts->unsnapped, error);
  if (result == LAVES_OK) result = laves__unpinch(s, parted, &counts->unsnapped, grown, error);
  return result;
}

laves_result laves__stuff(const laves__frame *frame, const laves__guarantee *guarantee, laves__lattice *lattice,
                          laves__layer *layer, laves__stuff_counts *counts, laves_error *error) {
  laves__stuffing s = {
      .frame = frame, .guarantee = guarantee, .lattice = lattice, .site_count = lattice->record_count * LAVES__C15_SITES};
  laves__feet feet = {0};
  laves__cuts cuts = {0};
  laves__parted parted = {0};
  laves_result result = LAVES_OK;
  LAVES_ASSERT(!lattice->graph);
  memset(counts, 0, sizeof *counts);
  laves__links_fill(&s.links);
  for (bool grown = true; grown && result == LAVES_OK;) {
    laves__free_stuffing(&s);
    result = stuff_once(&s, &parted, &grown, counts, error);
  }
  if (result == LAVES_OK && guarantee->relaxation > 0) result = laves__close(&s, error);
  if (result == LAVES_OK) result = laves__make_pieces(&s, &feet, &cuts, error);
  if (result == LAVES_OK) result = laves__find_surface_feet(frame, lattice, &feet, error); /* those beyond the zone */
  if (result == LAVES_OK) {
    counts->vertices = count_vertices(&s, &cuts);
    counts->relaxed = s.relaxed_count;
    counts->relaxed_max = s.relaxed_max;
  }
  if (result == LAVES_OK) result = laves__layer_build(&feet, lattice, &parted, &cuts, layer, error);
  if (result == LAVES_OK) {
    counts->specks = laves__layer_drop_specks(layer);
    counts->left = count_left(lattice, layer);
  }
  laves__free_stuffing(&s);
  laves__feet_free(&feet);
  laves__cuts_free(&cuts);
  laves__parted_free(lattice->context, &parted);
  return result;
}
