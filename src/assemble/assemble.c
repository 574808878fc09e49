/* Counts, then a mesh: filled brick by brick, or hollow, with all that its points and tets are made from. */
#include "assemble/assemble.h"

#include "assemble/assemble_graph.h"
#include "assemble/layer_part.h"
#include "assemble/stamp.h"
#include "assemble/streamed.h"

/* ---- counts and volume, brick by brick and tet by tet ---- */

static double count_vertices(const void *user, size_t begin, size_t end) {
  const laves__lattice *lattice = user;
  double count = 0;
  for (size_t slot = begin; slot < end; slot++)
    for (int inside = 0; lattice->directory[slot] != LAVES__OUT && inside < LAVES__BRICK_CELLS; inside++) {
      const int32_t cell = laves__brick_cell(lattice, slot, inside);
      if (cell == LAVES__IN) count += LAVES__C15_SITES;
      for (int site = 0; cell >= 0 && site < LAVES__C15_SITES; site++) {
        const laves__record *r = &lattice->record[cell];
        count += r->depth[site] <= LAVES__DEPTH_MAX || r->label[site] == LAVES__LABEL_IN;
      }
    }
  return count;
}

static double count_tiles(const void *user, size_t begin, size_t end) {
  const laves__lattice *lattice = user;
  double count = 0;
  for (size_t slot = begin; slot < end; slot++)
    for (int inside = 0; lattice->directory[slot] != LAVES__OUT && inside < LAVES__BRICK_CELLS; inside++) {
      const int32_t cell = laves__brick_cell(lattice, slot, inside);
      if (cell == LAVES__IN) count += LAVES__C15_TETS;
      if (cell >= 0) count += laves__stamped_count(&lattice->record[cell]);
    }
  return count;
}

static double count_living(const void *user, size_t begin, size_t end) {
  const laves__layer *layer = user;
  double count = 0;
  for (size_t t = begin; t < end; t++) count += layer->tet[t][0] >= 0;
  return count;
}

static double sum_volumes(const void *user, size_t begin, size_t end) {
  const laves__layer *layer = user;
  double volume = 0;
  for (size_t t = begin; t < end; t++) {
    if (layer->tet[t][0] < 0) continue;
    laves__vec3 p[4];
    laves__layer_points(layer, (int32_t)t, p);
    volume += v3_det(p[0], p[1], p[2], p[3]) / 6;
  }
  return volume;
}

void laves__assemble_estimate(const laves__lattice *lattice, const laves__layer *layer, int64_t *vertices, int64_t *tets) {
  laves_context *context = lattice->context;
  if (lattice->graph) {
    laves__assemble_graph_estimate(lattice, layer, vertices, tets);
    return;
  }
  *vertices = (int64_t)laves__parallel_sum(context, NULL, lattice->directory_count, count_vertices, lattice);
  *tets = (int64_t)laves__parallel_sum(context, NULL, lattice->directory_count, count_tiles, lattice) +
          (int64_t)laves__parallel_sum(context, NULL, layer->tet_count, count_living, layer);
}

double laves__assemble_volume(const laves__lattice *lattice, const laves__layer *layer) {
  static const double tile = LAVES__CELL_SIDE * LAVES__CELL_SIDE * LAVES__CELL_SIDE / LAVES__C15_TETS; /* mean volume */
  laves_context *context = lattice->context;
  const double whole = lattice->graph ? laves__assemble_graph_volume(lattice->graph)
                                      : tile * laves__parallel_sum(context, NULL, lattice->directory_count, count_tiles, lattice);
  return whole + laves__parallel_sum(context, NULL, layer->tet_count, sum_volumes, layer);
}

/* ---- the mesh in memory ---- */

typedef struct filling {
  const laves__stamps *stamps;
  laves_mesh *mesh;
} filling;

static void fill_bricks(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const filling *f = user;
  for (size_t brick = begin; brick < end; brick++) {
    const laves__brick_base *base = &f->stamps->base[brick];
    laves__stamp_points(f->stamps, brick, (size_t)base[0].vertex, (size_t)base[1].vertex, f->mesh->points + base[0].vertex);
    laves__stamp_tets(f->stamps, brick, (size_t)base[0].tet, (size_t)base[1].tet, f->mesh->tets + base[0].tet);
  }
}

static laves_result fill(const laves__stamps *s, const laves__layer_part *part, laves_mesh *mesh, laves_error *error) {
  const size_t bricks = s->lattice->directory_count;
  filling f = {s, mesh};
  if (!laves__parallel_for(s->lattice->context, "mesh", bricks, 1, fill_bricks, &f)) return laves__fail_cancelled(error);
  laves__layer_part_tets(part, mesh->tets + s->base[bricks].tet);
  laves__layer_part_copies(part, mesh->points + s->base[bricks].vertex);
  return LAVES_OK;
}

laves_result laves__assemble(const laves__frame *frame, laves__lattice *lattice, const laves__layer *layer, bool streamed,
                             laves_mesh **mesh, laves_error *error) {
  if (lattice->graph) return laves__assemble_graph(frame, lattice, layer, mesh, error);
  laves_context *context = lattice->context;
  const size_t bricks = lattice->directory_count;
  laves__layer_part part = {0};
  laves__stamps stamps = {.lattice = lattice, .frame = *frame, .base = laves__alloc(context, bricks + 1, sizeof *stamps.base)};
  laves_result result =
      stamps.base ? laves__layer_part_make(frame, lattice, layer, &part, error) : laves__fail_memory(context, error);
  stamps.mask = part.mask;
  stamps.first = part.first;
  stamps.placed = part.placed;
  *mesh = NULL;
  if (result == LAVES_OK) result = laves__stamps_count(&stamps, error);
  if (result == LAVES_OK)
    result = laves__layer_part_mesh(&part, stamps.base[bricks].vertex, (size_t)stamps.base[bricks].tet, streamed, mesh, error);
  if (result == LAVES_OK) {
    (*mesh)->lattice_tet_count = (size_t)stamps.base[bricks].tet;
    result = laves__layer_part_faces(&part, *mesh, error);
  }
  if (result == LAVES_OK && !streamed) result = fill(&stamps, &part, *mesh, error);
  if (result == LAVES_OK && streamed) result = laves__streamed_make(&stamps, &part, lattice, *mesh, error);
  if (result != LAVES_OK) {
    laves_mesh_free(*mesh);
    *mesh = NULL;
  }
  const bool handed_over = result == LAVES_OK && streamed;
  laves__layer_part_free(&part);
  if (!handed_over) laves__free(context, stamps.base, bricks + 1, sizeof *stamps.base);
  return result;
}
