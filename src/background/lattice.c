/* Bricks, cells and records: how sites of the tiling find one another.  See lattice.h for the drawing. */
#include "background/site.h"

#include <string.h>

/* 2^27 bricks are 5 * 10^10 tetrahedra of space around the solid; their directory is half a gibibyte. */
static const double directory_max = 134217728.0;

/* Cells of room on every side: sites within one edge of the surface and their stars must lie in the directory. */
enum { ROOM = 2 };

laves_result laves__lattice_create(laves_context *context, laves__box3 bounds, laves__lattice *lattice, laves_error *error) {
  memset(lattice, 0, sizeof *lattice);
  lattice->context = context;
  const double lower[3] = {bounds.lower.x, bounds.lower.y, bounds.lower.z};
  const double upper[3] = {bounds.upper.x, bounds.upper.y, bounds.upper.z};
  double total = 1;
  for (int axis = 0; axis < 3; axis++) {
    const double brick_side = LAVES__CELL_SIDE * LAVES__BRICK_SIDE, room = ROOM * LAVES__CELL_SIDE;
    const double first = floor((lower[axis] - room) / brick_side), last = floor((upper[axis] + room) / brick_side);
    total *= last - first + 1;
    if (!(total <= directory_max) || !(fabs(first) < 1e8))
      return laves__fail(error, LAVES_ERROR_OPTION,
                         "the size is too small for the box around the solid, which is %.3g sizes long; choose a larger size",
                         fmax(fmax(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]));
    lattice->lower[axis] = (int32_t)first * LAVES__BRICK_SIDE;
    lattice->bricks[axis] = (int32_t)(last - first) + 1;
  }
  lattice->directory_count = (size_t)lattice->bricks[0] * (size_t)lattice->bricks[1] * (size_t)lattice->bricks[2];
  lattice->directory = laves__alloc(context, lattice->directory_count, sizeof *lattice->directory);
  if (!lattice->directory) return laves__fail_memory(context, error);
  for (size_t i = 0; i < lattice->directory_count; i++) lattice->directory[i] = LAVES__OUT;
  return LAVES_OK;
}

void laves__lattice_free(laves__lattice *lattice) {
  laves_context *context = lattice->context;
  if (!context) return;
  laves__free(context, lattice->directory, lattice->directory_count, sizeof *lattice->directory);
  laves__free(context, lattice->brick, lattice->brick_capacity, sizeof *lattice->brick);
  laves__free(context, lattice->record, lattice->record_capacity, sizeof *lattice->record);
  memset(lattice, 0, sizeof *lattice);
}

/* The directory slot of the brick that holds a cell, or -1 beyond the directory; *inside is the cell within the brick. */
static int64_t find_slot(const laves__lattice *lattice, int32_t x, int32_t y, int32_t z, int *inside) {
  /* Without signs: what is below zero becomes very large, and the side of a brick is a power of two. */
  const uint32_t side = LAVES__BRICK_SIDE;
  const uint32_t dx = (uint32_t)(x - lattice->lower[0]), dy = (uint32_t)(y - lattice->lower[1]),
                 dz = (uint32_t)(z - lattice->lower[2]);
  const uint32_t bx = dx / side, by = dy / side, bz = dz / side;
  if (bx >= (uint32_t)lattice->bricks[0] || by >= (uint32_t)lattice->bricks[1] || bz >= (uint32_t)lattice->bricks[2]) return -1;
  *inside = (int)((dx % side) + side * ((dy % side) + side * (dz % side)));
  return bx + (int64_t)lattice->bricks[0] * (by + (int64_t)lattice->bricks[1] * bz);
}

int32_t laves__lattice_cell(const laves__lattice *lattice, int32_t x, int32_t y, int32_t z) {
  int inside = 0;
  const int64_t slot = find_slot(lattice, x, y, z, &inside);
  if (slot < 0) return LAVES__OUT;
  const int32_t entry = lattice->directory[slot];
  return entry < 0 ? entry : lattice->brick[entry].cell[inside];
}

/* A record all of whose sites have one sign. */
static void fill_record(laves__record *record, int8_t sign) {
  memset(record, 0, sizeof *record);
  for (int site = 0; site < LAVES__C15_SITES; site++) {
    record->phi[site] = sign * HUGE_VAL;
    record->hint[site] = LAVES__NO_HINT;
    record->sign[site] = record->label[site] = sign;
    record->vertex[site] = -1;
    record->depth[site] = UINT8_MAX;
  }
}

int32_t laves__lattice_add_record(laves__lattice *lattice, int32_t x, int32_t y, int32_t z) {
  int inside = 0;
  const int64_t slot = find_slot(lattice, x, y, z, &inside);
  LAVES_ASSERT(slot >= 0);
  int32_t entry = lattice->directory[slot];
  if (entry < 0) {
    if (!laves__grow(lattice->context, &lattice->brick, &lattice->brick_capacity, lattice->brick_count + 1,
                     sizeof *lattice->brick))
      return -1;
    for (int i = 0; i < LAVES__BRICK_CELLS; i++) lattice->brick[lattice->brick_count].cell[i] = entry;
    entry = lattice->directory[slot] = (int32_t)lattice->brick_count++;
  }
  const int32_t known = lattice->brick[entry].cell[inside];
  if (known >= 0) return known;
  if (lattice->record_count >= INT32_MAX / LAVES__C15_SITES) return -1;
  if (!laves__grow(lattice->context, &lattice->record, &lattice->record_capacity, lattice->record_count + 1,
                   sizeof *lattice->record))
    return -1;
  laves__record *record = &lattice->record[lattice->record_count];
  fill_record(record, known == LAVES__OUT ? 1 : -1);
  record->xyz[0] = x;
  record->xyz[1] = y;
  record->xyz[2] = z;
  return lattice->brick[entry].cell[inside] = (int32_t)lattice->record_count++;
}

laves_result laves__lattice_of_graph(laves_context *context, laves__graph *graph, laves__lattice *lattice, laves_error *error) {
  memset(lattice, 0, sizeof *lattice);
  const size_t records = (graph->vertex_count + LAVES__C15_SITES - 1) / LAVES__C15_SITES;
  if (records > INT32_MAX / LAVES__C15_SITES || graph->tet_count > INT32_MAX / 2)
    return laves__fail(error, LAVES_ERROR_OPTION,
                       "the graded background would have %zu tetrahedra, more than can be indexed; choose a larger size",
                       graph->tet_count);
  const laves_result result = graph->star_first ? LAVES_OK : laves__graph_link(graph, error);
  if (result != LAVES_OK) return result;
  lattice->context = context;
  lattice->graph = graph;
  lattice->record = laves__alloc(context, records, sizeof *lattice->record);
  if (!lattice->record) return laves__fail_memory(context, error);
  lattice->record_count = lattice->record_capacity = records;
  for (size_t i = 0; i < records; i++) fill_record(&lattice->record[i], 1);
  return LAVES_OK;
}

void laves__lattice_link(laves__lattice *lattice) {
  for (size_t i = 0; i < lattice->record_count; i++) {
    laves__record *r = &lattice->record[i];
    int k = 0;
    for (int dz = -1; dz <= 1; dz++)
      for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++)
          r->around[k++] = laves__lattice_cell(lattice, r->xyz[0] + dx, r->xyz[1] + dy, r->xyz[2] + dz);
  }
}

bool laves__tet_kept(const laves__lattice *lattice, const laves__site corners[4]) {
  bool any_in = false;
  for (int k = 0; k < 4; k++) {
    const laves__label label = laves__site_label(lattice, corners[k]);
    if (label == LAVES__LABEL_OUT) return false;
    any_in |= label == LAVES__LABEL_IN;
  }
  return any_in;
}

/* laves__star_kept() of a vertex of a graph that is not OUT. */
static uint64_t graph_star_kept(const laves__lattice *lattice, laves__site s) {
  const int size = laves__star_size(lattice, s);
  uint64_t kept = 0;
  for (int k = 0; k < size; k++) {
    const laves__tet tet = laves__star_at(lattice, s, k).tet;
    laves__site corner[4];
    laves__corners_of(lattice, tet, corner);
    bool any_in = laves__tet_is(lattice, tet, LAVES__TET_SOLID), any_out = false;
    for (int j = 0; j < 4; j++) {
      const laves__label label = laves__site_label(lattice, corner[j]);
      any_in |= label == LAVES__LABEL_IN;
      any_out |= label == LAVES__LABEL_OUT;
    }
    if (any_in && !any_out) kept |= UINT64_C(1) << k;
  }
  return kept;
}

/* Of the tets of a star given as bits those that are kept though no corner is IN. */
static uint64_t solid_of_star(const laves__lattice *lattice, const laves__record *r, int site, uint64_t tets) {
  uint64_t solid = 0;
  for (int k = 0; tets >> k; k++) {
    const laves__c15_star_tet star = laves__c15_star[site][k];
    const int32_t owner = r->around[star.cell];
    if (tets >> k & 1 && owner >= 0 && laves__bit(lattice->record[owner].solid, star.tet)) solid |= UINT64_C(1) << k;
  }
  return solid;
}

/* Every corner of the star's tets but the site is a neighbour of it: each neighbour decides for the tets that it is in. */
uint64_t laves__star_kept(const laves__lattice *lattice, int32_t record, int site) {
  const laves__record *r = &lattice->record[record];
  const laves__label own = (laves__label)r->label[site];
  if (own == LAVES__LABEL_OUT) return 0;
  if (lattice->graph) return graph_star_kept(lattice, (laves__site){record, (uint8_t)site});
  uint64_t out = 0, in = 0;
  for (int k = 0; k < laves__c15_degree[site]; k++) {
    const laves__label label = laves__site_label(lattice, laves__neighbour(r, site, k));
    if (label == LAVES__LABEL_OUT) out |= laves__c15_star_with[site][k];
    if (label == LAVES__LABEL_IN) in |= laves__c15_star_with[site][k];
  }
  const uint64_t whole = (UINT64_C(1) << laves__c15_star_size[site]) - 1, left = whole & ~out;
  if (own == LAVES__LABEL_IN) return left;
  return (left & in) | solid_of_star(lattice, r, site, left & ~in);
}
