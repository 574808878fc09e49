/* Two passes over the bricks, count and fill, with prefix sums between them, so that no place is written twice and the
 * order depends on nothing but the lattice.
 *
 * Numbers of vertices are as in layer_part.h. Cells without a record are whole: all sites, all tets. */
#include "assemble/assemble.h"

#include "assemble/assemble_graph.h"
#include "assemble/layer_part.h"

enum { ALL_SITES = (1 << LAVES__C15_SITES) - 1 };

/* First numbers of a brick's cells, filled while the brick is stamped from those of the brick. */
typedef struct brick_base {
  int64_t vertex, tet;
} brick_base;

typedef struct assembly {
  const laves__lattice *lattice;
  laves__layer_part part;
  laves_mesh *mesh;
  brick_base *base; /* [directory_count + 1] */
} assembly;

static void brick_coordinates(const laves__lattice *l, size_t slot, int32_t first_cell[3]) {
  size_t rest = slot;
  for (int axis = 0; axis < 3; axis++) {
    first_cell[axis] = l->lower[axis] + (int32_t)(rest % (size_t)l->bricks[axis]) * LAVES__BRICK_SIDE;
    rest /= (size_t)l->bricks[axis];
  }
}

/* The cell `inside` of the brick in a directory slot: LAVES__OUT, LAVES__IN or a record. */
static int32_t brick_cell(const laves__lattice *l, size_t slot, int inside) {
  const int32_t entry = l->directory[slot];
  return entry < 0 ? entry : l->brick[entry].cell[inside];
}

static int stamped_count(const laves__record *r) {
  return __builtin_popcountll(r->stamped[0]) + __builtin_popcountll(r->stamped[1]) + __builtin_popcountll(r->stamped[2]);
}

static void count_bricks(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const assembly *a = user;
  for (size_t slot = begin; slot < end; slot++) {
    brick_base count = {0, 0};
    for (int inside = 0; inside < LAVES__BRICK_CELLS; inside++) {
      const int32_t cell = brick_cell(a->lattice, slot, inside);
      if (cell == LAVES__OUT) continue;
      count.vertex += cell == LAVES__IN ? LAVES__C15_SITES : __builtin_popcount(a->part.mask[cell]);
      count.tet += cell == LAVES__IN ? LAVES__C15_TETS : stamped_count(&a->lattice->record[cell]);
    }
    a->base[slot] = count;
  }
}

static void sum_bricks(assembly *a) {
  brick_base sum = {0, 0};
  for (size_t slot = 0; slot <= a->lattice->directory_count; slot++) {
    const brick_base count = slot < a->lattice->directory_count ? a->base[slot] : sum;
    a->base[slot] = sum;
    sum.vertex += count.vertex;
    sum.tet += count.tet;
  }
}

/* The first vertex of every record, and with it the numbers of the layer's vertices. */
static void number_records(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const assembly *a = user;
  for (size_t slot = begin; slot < end; slot++) {
    if (a->lattice->directory[slot] < 0) continue;
    int64_t first = a->base[slot].vertex;
    for (int inside = 0; inside < LAVES__BRICK_CELLS; inside++) {
      const int32_t cell = brick_cell(a->lattice, slot, inside);
      if (cell == LAVES__OUT) continue;
      if (cell >= 0) a->part.first[cell] = (int32_t)first;
      first += cell == LAVES__IN ? LAVES__C15_SITES : __builtin_popcount(a->part.mask[cell]);
    }
  }
}

/* First vertices of the cells of a 5 x 5 x 5 block: the brick and its forward neighbours. */
enum { BLOCK = LAVES__BRICK_SIDE + 1 };

typedef struct block {
  int32_t first[BLOCK * BLOCK * BLOCK]; /* first vertex; undefined for cells outside */
  int32_t record[BLOCK * BLOCK * BLOCK];
} block;

/* First vertices of the cells of one brick into the part of the block where the brick lies. */
static void load_brick(const assembly *a, const int32_t brick[3], const int offset[3], block *b) {
  const laves__lattice *l = a->lattice;
  for (int axis = 0; axis < 3; axis++)
    if (brick[axis] >= l->bricks[axis]) return; /* beyond the directory all is outside, and no kept tet reaches there */
  const size_t slot = (size_t)brick[0] + (size_t)l->bricks[0] * ((size_t)brick[1] + (size_t)l->bricks[1] * (size_t)brick[2]);
  if (l->directory[slot] == LAVES__OUT) return;
  int64_t first = a->base[slot].vertex;
  for (int inside = 0; inside < LAVES__BRICK_CELLS; inside++) {
    const int32_t cell = brick_cell(l, slot, inside);
    if (cell == LAVES__OUT) continue;
    const int at[3] = {offset[0] + inside % LAVES__BRICK_SIDE, offset[1] + inside / LAVES__BRICK_SIDE % LAVES__BRICK_SIDE,
                       offset[2] + inside / (LAVES__BRICK_SIDE * LAVES__BRICK_SIDE)};
    if (at[0] < BLOCK && at[1] < BLOCK && at[2] < BLOCK) {
      const int index = at[0] + BLOCK * (at[1] + BLOCK * at[2]);
      b->first[index] = (int32_t)first;
      b->record[index] = cell;
    }
    first += cell == LAVES__IN ? LAVES__C15_SITES : __builtin_popcount(a->part.mask[cell]);
  }
}

static void load_block(const assembly *a, size_t slot, block *b) {
  const laves__lattice *l = a->lattice;
  const int32_t at[3] = {(int32_t)(slot % (size_t)l->bricks[0]), (int32_t)(slot / (size_t)l->bricks[0] % (size_t)l->bricks[1]),
                         (int32_t)(slot / (size_t)l->bricks[0] / (size_t)l->bricks[1])};
  for (int forward = 0; forward < 8; forward++) {
    const int f[3] = {forward & 1, forward >> 1 & 1, forward >> 2};
    load_brick(a, (int32_t[3]){at[0] + f[0], at[1] + f[1], at[2] + f[2]},
               (int[3]){f[0] * LAVES__BRICK_SIDE, f[1] * LAVES__BRICK_SIDE, f[2] * LAVES__BRICK_SIDE}, b);
  }
}

static int32_t block_vertex(const assembly *a, const block *b, int cell, int site) {
  if (b->record[cell] < 0) return b->first[cell] + site;
  return b->first[cell] + __builtin_popcount(a->part.mask[b->record[cell]] & ((UINT32_C(1) << site) - 1));
}

static void stamp_points(const assembly *a, const int32_t cell[3], uint32_t mask, const laves__record *r, laves__vec3 *points) {
  for (int site = 0; site < LAVES__C15_SITES; site++) {
    if (!(mask >> site & 1)) continue;
    laves__vec3 p = laves__site_position(cell, site);
    if (r && r->vertex[site] >= 0) p = a->part.layer->position[r->vertex[site]];
    *points++ = laves__frame_to_input(a->part.frame, p);
  }
}

/* The corner `k` of tet `tet` in a block: how far its cell lies behind the owner's, and the site. */
static const int shift_in_block[8] = {
    0, 1, BLOCK, BLOCK + 1, BLOCK *BLOCK, BLOCK *BLOCK + 1, BLOCK *BLOCK + BLOCK, BLOCK *BLOCK + BLOCK + 1};

/* The common case: a cell whose forward neighbours are whole, too, so a vertex is a sum. */
static void stamp_whole(const block *b, int owner, int32_t (*tets)[4]) {
  int32_t first[8];
  for (int shift = 0; shift < 8; shift++) first[shift] = b->first[owner + shift_in_block[shift]];
  for (int tet = 0; tet < LAVES__C15_TETS; tet++)
    for (int k = 0; k < 4; k++) {
      const laves__c15_corner corner = laves__c15_tet[tet][k];
      tets[tet][k] = first[corner.shift] + corner.site;
    }
}

static void stamp_some(const assembly *a, const block *b, int owner, const uint64_t set[3], int32_t (*tets)[4]) {
  for (int word = 0; word < 3; word++)
    for (uint64_t rest = set[word]; rest; rest &= rest - 1) {
      const int tet = 64 * word + __builtin_ctzll(rest);
      for (int k = 0; k < 4; k++) {
        const laves__c15_corner corner = laves__c15_tet[tet][k];
        (*tets)[k] = block_vertex(a, b, owner + shift_in_block[corner.shift], corner.site);
      }
      tets++;
    }
}

static bool is_whole(const block *b, int owner) {
  for (int shift = 0; shift < 8; shift++)
    if (b->record[owner + shift_in_block[shift]] != LAVES__IN) return false;
  return true;
}

static void stamp_bricks(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const assembly *a = user;
  static const uint64_t all_tets[3] = {UINT64_MAX, UINT64_MAX, (UINT64_C(1) << (LAVES__C15_TETS - 128)) - 1};
  for (size_t slot = begin; slot < end; slot++) {
    if (a->base[slot + 1].vertex == a->base[slot].vertex) continue;
    block b;
    load_block(a, slot, &b);
    int32_t origin[3];
    brick_coordinates(a->lattice, slot, origin);
    int32_t(*tets)[4] = a->mesh->tets + a->base[slot].tet;
    for (int inside = 0; inside < LAVES__BRICK_CELLS; inside++) {
      const int32_t cell = brick_cell(a->lattice, slot, inside);
      if (cell == LAVES__OUT) continue;
      const int x = inside % LAVES__BRICK_SIDE, y = inside / LAVES__BRICK_SIDE % LAVES__BRICK_SIDE,
                z = inside / (LAVES__BRICK_SIDE * LAVES__BRICK_SIDE);
      const int owner = x + BLOCK * (y + BLOCK * z);
      const laves__record *r = cell < 0 ? NULL : &a->lattice->record[cell];
      stamp_points(a, (int32_t[3]){origin[0] + x, origin[1] + y, origin[2] + z}, r ? a->part.mask[cell] : ALL_SITES, r,
                   a->mesh->points + b.first[owner]);
      if (!r && is_whole(&b, owner))
        stamp_whole(&b, owner, tets);
      else
        stamp_some(a, &b, owner, r ? r->stamped : all_tets, tets);
      tets += r ? stamped_count(r) : LAVES__C15_TETS;
    }
  }
}

void laves__assemble_estimate(const laves__lattice *lattice, const laves__layer *layer, int64_t *vertices, int64_t *tets) {
  if (lattice->graph) {
    laves__assemble_graph_estimate(lattice, layer, vertices, tets);
    return;
  }
  *vertices = *tets = 0;
  for (size_t slot = 0; slot < lattice->directory_count; slot++)
    for (int inside = 0; inside < LAVES__BRICK_CELLS; inside++) {
      const int32_t cell = brick_cell(lattice, slot, inside);
      if (cell == LAVES__OUT) continue;
      if (cell == LAVES__IN) {
        *vertices += LAVES__C15_SITES;
        *tets += LAVES__C15_TETS;
        continue;
      }
      const laves__record *r = &lattice->record[cell];
      for (int site = 0; site < LAVES__C15_SITES; site++)
        *vertices += r->depth[site] <= LAVES__DEPTH_MAX || r->label[site] == LAVES__LABEL_IN;
      *tets += stamped_count(r);
    }
  for (size_t t = 0; t < layer->tet_count; t++) *tets += layer->tet[t][0] >= 0;
}

static double volume_of(const laves__vec3 p[4]) { return v3_det(p[0], p[1], p[2], p[3]) / 6; }

double laves__assemble_volume(const laves__lattice *lattice, const laves__layer *layer) {
  static const double tile = LAVES__CELL_SIDE * LAVES__CELL_SIDE * LAVES__CELL_SIDE / LAVES__C15_TETS; /* mean volume */
  double volume = 0;
  int64_t vertices, tiles;
  laves__assemble_estimate(lattice, layer, &vertices, &tiles);
  for (size_t t = 0; t < layer->tet_count; t++) {
    if (layer->tet[t][0] < 0) continue;
    laves__vec3 p[4];
    laves__layer_points(layer, (int32_t)t, p);
    volume += volume_of(p);
    tiles--;
  }
  return (lattice->graph ? laves__assemble_graph_volume(lattice->graph) : (double)tiles * tile) + volume;
}

laves_result laves__assemble(const laves__frame *frame, laves__lattice *lattice, const laves__layer *layer, laves_mesh **mesh,
                             laves_error *error) {
  if (lattice->graph) return laves__assemble_graph(frame, lattice, layer, mesh, error);
  laves_context *context = lattice->context;
  const size_t slots = lattice->directory_count;
  assembly a = {.lattice = lattice, .base = laves__alloc(context, slots + 1, sizeof *a.base)};
  laves_result result =
      a.base ? laves__layer_part_make(frame, lattice, layer, &a.part, error) : laves__fail_memory(context, error);
  if (result == LAVES_OK && !laves__parallel_for(context, "mesh", slots, 16, count_bricks, &a))
    result = laves__fail_cancelled(error);
  if (result == LAVES_OK) {
    sum_bricks(&a);
    if (!laves__parallel_for(context, "mesh", slots, 16, number_records, &a)) result = laves__fail_cancelled(error);
  }
  if (result == LAVES_OK)
    result = laves__layer_part_mesh(&a.part, a.base[slots].vertex, (size_t)a.base[slots].tet, &a.mesh, error);
  if (result == LAVES_OK && !laves__parallel_for(context, "mesh", slots, 1, stamp_bricks, &a))
    result = laves__fail_cancelled(error);
  if (result == LAVES_OK) {
    a.mesh->lattice_tet_count = (size_t)a.base[slots].tet;
    result = laves__layer_part_write(&a.part, a.mesh->lattice_tet_count, a.mesh, error);
  }
  if (result != LAVES_OK) {
    laves_mesh_free(a.mesh);
    a.mesh = NULL;
  }
  *mesh = a.mesh;
  laves__layer_part_free(&a.part);
  laves__free(context, a.base, slots + 1, sizeof *a.base);
  return result;
}
