/* The mesh of a graded background: its stamped tets, C15 tiles before the others, then the layer's.
 *
 * Chunks of tets are counted and then filled, with sums between, as bricks are of the tiling. */
#include "assemble/assemble_graph.h"

#include "assemble/layer_part.h"
#include "background/site.h"

/* Where a chunk's tets go: first those that are C15 tiles, then the others. */
enum { KINDS = 2 };
typedef struct chunk_base {
  size_t tet[KINDS];
} chunk_base;

typedef struct assembly {
  const laves__lattice *lattice;
  laves__layer_part part;
  laves_mesh *mesh;
  chunk_base *base; /* [chunk_count] */
} assembly;

/* Whether a tet is stamped, and of which kind. */
static bool is_stamped(const laves__graph *g, size_t tet, int *kind) {
  *kind = g->tile[tet] == LAVES__TILE_C15 ? 0 : 1;
  return g->flags[tet] & LAVES__TET_STAMPED;
}

static void count_chunks(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const assembly *a = user;
  for (size_t chunk = begin; chunk < end; chunk++) {
    const size_t first = chunk * LAVES__C15_TETS, last = first + (size_t)laves__chunk_size(a->lattice, chunk);
    a->base[chunk] = (chunk_base){{0, 0}};
    for (size_t t = first; t < last; t++) {
      int kind;
      if (is_stamped(a->lattice->graph, t, &kind)) a->base[chunk].tet[kind]++;
    }
  }
}

/* Counts to places; returns how many C15 tiles and how many tets there are. */
static void sum_chunks(const assembly *a, size_t chunks, size_t *tiles, size_t *tets) {
  size_t next = 0;
  for (int kind = 0; kind < KINDS; kind++) {
    for (size_t chunk = 0; chunk < chunks; chunk++) {
      const size_t count = a->base[chunk].tet[kind];
      a->base[chunk].tet[kind] = next;
      next += count;
    }
    if (kind == 0) *tiles = next;
  }
  *tets = next;
}

static void stamp_chunks(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const assembly *a = user;
  const laves__graph *g = a->lattice->graph;
  for (size_t chunk = begin; chunk < end; chunk++) {
    chunk_base next = a->base[chunk];
    const size_t first = chunk * LAVES__C15_TETS, last = first + (size_t)laves__chunk_size(a->lattice, chunk);
    for (size_t t = first; t < last; t++) {
      int kind;
      if (!is_stamped(g, t, &kind)) continue;
      int32_t *tet = a->mesh->tets[next.tet[kind]++];
      for (int k = 0; k < 4; k++) {
        const laves__site s = laves__site_of((uint32_t)g->tet[t][k]);
        tet[k] = laves__kept_vertex(&a->part, s.cell, s.site);
      }
    }
  }
}

/* First vertices of the records; returns how many vertices there are. */
static int64_t number_records(const laves__layer_part *part) {
  int64_t next = 0;
  for (size_t i = 0; i < part->record_count; i++) {
    part->first[i] = (int32_t)next;
    next += __builtin_popcount(part->mask[i]);
  }
  return next;
}

static void stamp_points(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const assembly *a = user;
  for (size_t i = begin; i < end; i++) {
    const laves__record *r = &a->lattice->record[i];
    for (uint32_t mask = a->part.mask[i]; mask; mask &= mask - 1) {
      const laves__site s = {(int32_t)i, (uint8_t)__builtin_ctz(mask)};
      a->mesh->points[laves__kept_vertex(&a->part, s.cell, s.site)] =
          r->vertex[s.site] >= 0 ? a->part.placed[r->vertex[s.site]]
                                 : laves__frame_to_input(a->part.frame, laves__site_place(a->lattice, s));
    }
  }
}

void laves__assemble_graph_estimate(const laves__lattice *lattice, const laves__layer *layer, int64_t *vertices, int64_t *tets) {
  *vertices = *tets = 0;
  for (size_t i = 0; i < lattice->record_count; i++) {
    const laves__record *r = &lattice->record[i];
    for (int site = 0; site < LAVES__C15_SITES; site++)
      *vertices += r->depth[site] <= LAVES__DEPTH_MAX || r->label[site] == LAVES__LABEL_IN;
  }
  for (size_t t = 0; t < lattice->graph->tet_count; t++) *tets += (lattice->graph->flags[t] & LAVES__TET_STAMPED) != 0;
  for (size_t t = 0; t < layer->tet_count; t++) *tets += layer->tet[t][0] >= 0;
}

double laves__assemble_graph_volume(const laves__graph *graph) {
  double volume = 0;
  for (size_t t = 0; t < graph->tet_count; t++) {
    if (!(graph->flags[t] & LAVES__TET_STAMPED)) continue;
    const int32_t *v = graph->tet[t];
    volume += v3_det(graph->position[v[0]], graph->position[v[1]], graph->position[v[2]], graph->position[v[3]]) / 6;
  }
  return volume;
}

laves_result laves__assemble_graph(const laves__frame *frame, laves__lattice *lattice, const laves__layer *layer,
                                   laves_mesh **mesh, laves_error *error) {
  laves_context *context = lattice->context;
  const size_t chunks = laves__chunk_count(lattice);
  assembly a = {.lattice = lattice, .base = laves__alloc(context, chunks, sizeof *a.base)};
  size_t tiles = 0, stamped = 0;
  int64_t sites = 0;
  laves_result result =
      a.base ? laves__layer_part_make(frame, lattice, layer, &a.part, error) : laves__fail_memory(context, error);
  if (result == LAVES_OK && !laves__parallel_for(context, "mesh", chunks, 16, count_chunks, &a))
    result = laves__fail_cancelled(error);
  if (result == LAVES_OK) {
    sum_chunks(&a, chunks, &tiles, &stamped);
    sites = number_records(&a.part);
    result = laves__layer_part_mesh(&a.part, sites, stamped, false, &a.mesh, error);
  }
  if (result == LAVES_OK && (!laves__parallel_for(context, "mesh", lattice->record_count, 64, stamp_points, &a) ||
                             !laves__parallel_for(context, "mesh", chunks, 16, stamp_chunks, &a)))
    result = laves__fail_cancelled(error);
  if (result == LAVES_OK) {
    a.mesh->lattice_tet_count = tiles;
    laves__layer_part_tets(&a.part, a.mesh->tets + stamped);
    laves__layer_part_copies(&a.part, a.mesh->points + sites);
    result = laves__layer_part_faces(&a.part, a.mesh, error);
  }
  if (result != LAVES_OK) {
    laves_mesh_free(a.mesh);
    a.mesh = NULL;
  }
  *mesh = a.mesh;
  laves__layer_part_free(&a.part);
  laves__free(context, a.base, chunks, sizeof *a.base);
  return result;
}
