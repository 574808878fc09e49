/* Two passes over the bricks, count and fill, with prefix sums between them, so that no place is written twice and the
 * order depends on nothing but the lattice.
 *
 * A vertex's number is its cell's first number plus the count of kept sites before it in the cell: one bit mask and a
 * popcount. Cells without a record are whole: all sites, all tets. Vertices that contraction removed are simply not in
 * their cell's mask; further copies of parted vertices come last. */
#include "assemble/assemble.h"

#include <string.h>

enum { ALL_SITES = (1 << LAVES__C15_SITES) - 1 };

/* First numbers of a brick's cells, filled while the brick is stamped from those of the brick. */
typedef struct brick_base {
  int64_t vertex, tet;
} brick_base;

typedef struct assembly {
  const laves__frame *frame;
  laves__lattice *lattice;
  const laves__layer *layer;
  laves_mesh *mesh;
  brick_base *base;      /* [directory_count + 1] */
  uint32_t *mask;        /* [record_count] kept sites */
  int32_t *record_first; /* [record_count] first vertex of the cell */
  int32_t *layer_id;     /* [layer->vertex_count] number in the mesh, -1 for dead ones */
} assembly;

static bool is_alive(const laves__layer *layer, int32_t vertex) {
  return layer->depth[vertex] > LAVES__DEPTH_MOVES || layer->star[vertex].count > 0;
}

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

/* Kept sites: those of the layer that still live, and the IN sites deeper than the layer. */
static void mask_records(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const assembly *a = user;
  for (size_t i = begin; i < end; i++) {
    const laves__record *r = &a->lattice->record[i];
    uint32_t mask = 0;
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      const bool in_layer = r->depth[site] <= LAVES__DEPTH_MAX;
      const bool kept =
          in_layer ? r->vertex[site] < -1 || is_alive(a->layer, r->vertex[site]) : r->label[site] == LAVES__LABEL_IN;
      if (kept) mask |= UINT32_C(1) << site;
    }
    a->mask[i] = mask;
  }
}

/* The first vertex of a parted site follows the same rule; only the layer knows which one it is: copies come right behind. */
static void unmask_dead_parted(assembly *a) {
  const laves__layer *layer = a->layer;
  for (size_t v = 0; v + 1 < layer->vertex_count; v++) {
    const uint32_t id = layer->origin[v];
    if (id == LAVES__NO_ORIGIN || layer->origin[v + 1] != LAVES__NO_ORIGIN || is_alive(layer, (int32_t)v)) continue;
    a->mask[id / LAVES__C15_SITES] &= ~(UINT32_C(1) << id % LAVES__C15_SITES);
  }
}

static void count_bricks(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const assembly *a = user;
  for (size_t slot = begin; slot < end; slot++) {
    brick_base count = {0, 0};
    for (int inside = 0; inside < LAVES__BRICK_CELLS; inside++) {
      const int32_t cell = brick_cell(a->lattice, slot, inside);
      if (cell == LAVES__OUT) continue;
      count.vertex += cell == LAVES__IN ? LAVES__C15_SITES : __builtin_popcount(a->mask[cell]);
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
      if (cell >= 0) a->record_first[cell] = (int32_t)first;
      first += cell == LAVES__IN ? LAVES__C15_SITES : __builtin_popcount(a->mask[cell]);
    }
  }
}

static int32_t record_vertex(const assembly *a, int32_t record, int site) {
  return a->record_first[record] + __builtin_popcount(a->mask[record] & ((UINT32_C(1) << site) - 1));
}

/* Layer vertices at sites take their cell's numbers, copies the numbers from `next` on; returns the total. */
static int64_t number_layer(assembly *a, int64_t next) {
  for (size_t v = 0; v < a->layer->vertex_count; v++) {
    const uint32_t id = a->layer->origin[v];
    if (!is_alive(a->layer, (int32_t)v))
      a->layer_id[v] = -1;
    else if (id != LAVES__NO_ORIGIN)
      a->layer_id[v] = record_vertex(a, (int32_t)(id / LAVES__C15_SITES), (int)(id % LAVES__C15_SITES));
    else
      a->layer_id[v] = (int32_t)next++;
  }
  return next;
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
    first += cell == LAVES__IN ? LAVES__C15_SITES : __builtin_popcount(a->mask[cell]);
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
  return b->first[cell] + __builtin_popcount(a->mask[b->record[cell]] & ((UINT32_C(1) << site) - 1));
}

static void stamp_points(const assembly *a, const int32_t cell[3], uint32_t mask, const laves__record *r, laves__vec3 *points) {
  for (int site = 0; site < LAVES__C15_SITES; site++) {
    if (!(mask >> site & 1)) continue;
    laves__vec3 p = laves__site_position(cell, site);
    if (r && r->vertex[site] >= 0) p = a->layer->position[r->vertex[site]];
    *points++ = laves__frame_to_input(a->frame, p);
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
      stamp_points(a, (int32_t[3]){origin[0] + x, origin[1] + y, origin[2] + z}, r ? a->mask[cell] : ALL_SITES, r,
                   a->mesh->points + b.first[owner]);
      if (!r && is_whole(&b, owner))
        stamp_whole(&b, owner, tets);
      else
        stamp_some(a, &b, owner, r ? r->stamped : all_tets, tets);
      tets += r ? stamped_count(r) : LAVES__C15_TETS;
    }
  }
}

static void write_layer(const assembly *a, size_t *next) {
  for (size_t t = 0; t < a->layer->tet_count; t++) {
    const int32_t *tet = a->layer->tet[t];
    if (tet[0] < 0) continue;
    for (int k = 0; k < 4; k++) a->mesh->tets[*next][k] = a->layer_id[tet[k]];
    ++*next;
  }
  for (size_t v = 0; v < a->layer->vertex_count; v++) {
    const uint32_t id = a->layer->origin[v];
    const bool at_site = id != LAVES__NO_ORIGIN && a->lattice->record[id / LAVES__C15_SITES].vertex[id % LAVES__C15_SITES] >= 0;
    if (!at_site && a->layer_id[v] >= 0) a->mesh->points[a->layer_id[v]] = laves__frame_to_input(a->frame, a->layer->position[v]);
  }
}

/* Boundary faces of the layer: the four corners' bits say which faces of each tet are. */
typedef struct face_search {
  const laves__layer *layer;
  uint8_t *faces; /* [tet_count] bit k: the face opposite corner k */
} face_search;

static void find_faces(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const face_search *f = user;
  for (size_t t = begin; t < end; t++) {
    f->faces[t] = 0;
    const int32_t *tet = f->layer->tet[t];
    if (tet[0] < 0) continue;
    int on = 0;
    for (int k = 0; k < 4; k++) on += f->layer->depth[tet[k]] == 0;
    if (on < 3) continue;
    for (int k = 0; k < 4; k++)
      if (laves__layer_is_boundary_face(f->layer, (int32_t)t, k)) f->faces[t] |= (uint8_t)(1 << k);
  }
}

static void write_faces(const assembly *a, const uint8_t *faces) {
  size_t next = 0;
  for (size_t t = 0; t < a->layer->tet_count; t++)
    for (int k = 0; k < 4; k++) {
      if (!(faces[t] >> k & 1)) continue;
      for (int j = 0; j < 3; j++) a->mesh->faces[next][j] = a->layer_id[a->layer->tet[t][laves__tet_face[k][j]]];
      next++;
    }
}

typedef struct tagging {
  const assembly *a;
  const uint8_t *faces;
  uint32_t *owner; /* [face_count] a layer vertex of each face, for the hint */
} tagging;

/* The tag of the surface nearest to the centroid of each boundary face. */
static void tag_faces(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const tagging *g = user;
  const assembly *a = g->a;
  const laves__oracle *oracle = a->frame->oracle;
  for (size_t f = begin; f < end; f++) {
    const int32_t *face = a->mesh->faces[f];
    const laves__vec3 sum = v3_add(v3_add(a->mesh->points[face[0]], a->mesh->points[face[1]]), a->mesh->points[face[2]]);
    uint32_t hint = a->layer->hint[g->owner[f]];
    laves__vec3 foot, normal;
    a->mesh->face_tags[f] = 1;
    if (oracle->project(oracle->self, v3_sub(v3_scale(sum, 1.0 / 3), oracle->origin), 2 * a->frame->size, &hint, &foot, &normal))
      a->mesh->face_tags[f] = 1 + oracle->tag(oracle->self, foot, hint);
  }
}

static laves_result write_tags(const assembly *a, const uint8_t *faces, laves_error *error) {
  laves_context *context = a->lattice->context;
  tagging g = {a, faces, laves__alloc(context, a->mesh->face_count, sizeof *g.owner)};
  if (!g.owner) return laves__fail_memory(context, error);
  size_t next = 0;
  for (size_t t = 0; t < a->layer->tet_count; t++)
    for (int k = 0; k < 4; k++)
      if (faces[t] >> k & 1) g.owner[next++] = (uint32_t)a->layer->tet[t][laves__tet_face[k][0]];
  const bool done = laves__parallel_for(context, "mesh", a->mesh->face_count, 64, tag_faces, &g);
  laves__free(context, g.owner, a->mesh->face_count, sizeof *g.owner);
  return done ? LAVES_OK : laves__fail_cancelled(error);
}

void laves__assemble_estimate(const laves__lattice *lattice, const laves__layer *layer, int64_t *vertices, int64_t *tets) {
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

laves_result laves__assemble(const laves__frame *frame, laves__lattice *lattice, const laves__layer *layer, laves_mesh **mesh,
                             laves_error *error) {
  laves_context *context = lattice->context;
  const size_t records = lattice->record_count, slots = lattice->directory_count;
  assembly a = {.frame = frame, .lattice = lattice, .layer = layer};
  face_search search = {layer, NULL};
  laves_result result = LAVES_OK;
  size_t next, layer_tets = 0, faces = 0;
  *mesh = NULL;
  a.base = laves__alloc(context, slots + 1, sizeof *a.base);
  a.mask = laves__alloc(context, records, sizeof *a.mask);
  a.record_first = laves__alloc(context, records, sizeof *a.record_first);
  a.layer_id = laves__alloc(context, layer->vertex_count, sizeof *a.layer_id);
  search.faces = laves__alloc(context, layer->tet_count, 1);
  if (!a.base || !a.mask || !a.record_first || !a.layer_id || !search.faces) goto memory;

  if (!laves__parallel_for(context, "mesh", records, 64, mask_records, &a)) goto cancelled;
  unmask_dead_parted(&a);
  if (!laves__parallel_for(context, "mesh", slots, 16, count_bricks, &a)) goto cancelled;
  sum_bricks(&a);
  if (a.base[slots].vertex + (int64_t)layer->vertex_count > INT32_MAX) {
    result = laves__fail(error, LAVES_ERROR_OPTION, "the mesh would have %lld vertices, more than 2^31; choose a larger size",
                         (long long)a.base[slots].vertex);
    goto cleanup;
  }
  if (!laves__parallel_for(context, "mesh", slots, 16, number_records, &a) ||
      !laves__parallel_for(context, "mesh", layer->tet_count, 256, find_faces, &search))
    goto cancelled;
  for (size_t t = 0; t < layer->tet_count; t++) {
    layer_tets += layer->tet[t][0] >= 0;
    faces += (size_t)__builtin_popcount(search.faces[t]);
  }
  const int64_t vertices = number_layer(&a, a.base[slots].vertex);
  a.mesh = laves__mesh_create(context, (size_t)vertices, (size_t)a.base[slots].tet + layer_tets, faces, false,
                              frame->oracle->tag != NULL);
  if (!a.mesh) goto memory;
  a.mesh->lattice_tet_count = next = (size_t)a.base[slots].tet;
  if (!laves__parallel_for(context, "mesh", slots, 1, stamp_bricks, &a)) goto cancelled;
  write_layer(&a, &next);
  write_faces(&a, search.faces);
  if (a.mesh->face_tags) result = write_tags(&a, search.faces, error);
  goto cleanup;
memory:
  result = laves__fail_memory(context, error);
  goto cleanup;
cancelled:
  result = laves__fail_cancelled(error);
cleanup:
  if (result != LAVES_OK) {
    laves_mesh_free(a.mesh);
    a.mesh = NULL;
  }
  *mesh = a.mesh;
  laves__free(context, search.faces, layer->tet_count, 1);
  laves__free(context, a.layer_id, layer->vertex_count, sizeof *a.layer_id);
  laves__free(context, a.record_first, records, sizeof *a.record_first);
  laves__free(context, a.mask, records, sizeof *a.mask);
  laves__free(context, a.base, slots + 1, sizeof *a.base);
  return result;
}
