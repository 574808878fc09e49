/* From labels to the boundary layer: which tets belong to it, where its vertices stand.
 *
 * A site's depth is the number of edges to the nearest ON site. Kept tets with a vertex of depth LAVES__DEPTH_MOVES or less
 * make the layer; the other kept tets have only IN corners that never move, and are stamped from the table later. */
#include "base/predicates.h"
#include "snap/snap.h"

#include <string.h>

/* Cells whose sites can be LAVES__DEPTH_MAX edges from an ON site, or own a tet of the layer, lie within two cells:
 * three longest edges are 3.27, two cells 5.02. */
enum { ACTIVE_REACH = 2 };

static bool has_surface_site(const laves__record *r) {
  if (r->zone) return true; /* cuts may be here */
  for (int site = 0; site < LAVES__C15_SITES; site++)
    if (r->label[site] == LAVES__LABEL_ON) return true;
  return false;
}

/* Records for the inner cells that the layer reaches. */
static bool widen_records(laves__lattice *lattice) {
  if (lattice->graph) return true; /* it has all records */
  const size_t before = lattice->record_count;
  for (size_t i = 0; i < before; i++) {
    if (!has_surface_site(&lattice->record[i])) continue;
    const int32_t c[3] = {lattice->record[i].xyz[0], lattice->record[i].xyz[1], lattice->record[i].xyz[2]};
    for (int dz = -ACTIVE_REACH; dz <= ACTIVE_REACH; dz++)
      for (int dy = -ACTIVE_REACH; dy <= ACTIVE_REACH; dy++)
        for (int dx = -ACTIVE_REACH; dx <= ACTIVE_REACH; dx++)
          if (laves__lattice_cell(lattice, c[0] + dx, c[1] + dy, c[2] + dz) == LAVES__IN &&
              laves__lattice_add_record(lattice, c[0] + dx, c[1] + dy, c[2] + dz) < 0)
            return false;
  }
  laves__lattice_link(lattice);
  return true;
}

typedef struct site_queue {
  laves_context *context;
  uint32_t *id;
  size_t count, capacity;
} site_queue;

/* Gives a site a depth and a place in the queue; false when memory is short. */
static bool reach(laves__lattice *lattice, site_queue *queue, uint32_t id, int depth) {
  lattice->record[id / LAVES__C15_SITES].depth[id % LAVES__C15_SITES] = (uint8_t)depth;
  if (!laves__grow(queue->context, &queue->id, &queue->capacity, queue->count + 1, sizeof *queue->id)) return false;
  queue->id[queue->count++] = id;
  return true;
}

/* The first sites of the search that have the given depth, 0 or 1. Depth 0: ON sites that bound kept tets or pieces. Depth 1:
 * ON sites whose star is whole, and inner corners of pieces. False when memory is short or it is cancelled. */
static bool reach_first(laves__lattice *lattice, const laves__cuts *cuts, int depth, site_queue *queue) {
  for (size_t i = 0; i < lattice->record_count; i++) {
    if (laves__cancelled_at(lattice->context, "snap", i, lattice->record_count)) return false;
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      if (lattice->record[i].label[site] != LAVES__LABEL_ON) continue;
      const laves__site s = {(int32_t)i, (uint8_t)site};
      const uint64_t kept = laves__star_kept(lattice, (int32_t)i, site);
      const bool whole = kept == laves__whole_star(lattice, s);
      if (kept && whole == (depth == 1) && !reach(lattice, queue, laves__site_id(s), depth)) return false;
    }
  }
  for (size_t t = 0; cuts && t < cuts->tet_count; t++)
    for (int k = 0; k < 4; k++) {
      const uint32_t id = cuts->tet[t][k];
      if (id & LAVES__CUT_VERTEX) continue;
      const laves__record *r = &lattice->record[id / LAVES__C15_SITES];
      const int site = (int)(id % LAVES__C15_SITES);
      if ((r->label[site] == LAVES__LABEL_ON) == (depth == 0) && r->depth[site] > depth && !reach(lattice, queue, id, depth))
        return false;
    }
  return true;
}

/* Breadth first from the boundary, through IN sites. */
static bool measure_depths(laves__lattice *lattice, const laves__cuts *cuts, size_t *vertex_count) {
  site_queue queue = {.context = lattice->context};
  bool memory = reach_first(lattice, cuts, 0, &queue) && reach_first(lattice, cuts, 1, &queue);
  for (size_t head = 0; memory && head < queue.count; head++) {
    memory = !laves__cancelled_at(lattice->context, "snap", head, queue.count);
    const laves__site at = laves__site_of(queue.id[head]);
    const int depth = lattice->record[at.cell].depth[at.site];
    if (depth == LAVES__DEPTH_MAX) break;
    const laves__ring ring = laves__ring_of(lattice, at);
    for (int k = 0; memory && k < ring.count; k++) {
      const laves__site s = laves__ring_at(&ring, k);
      if (s.cell < 0) continue;
      const laves__record *other = &lattice->record[s.cell];
      if (other->label[s.site] != LAVES__LABEL_IN || other->depth[s.site] <= depth + 1) continue;
      memory = reach(lattice, &queue, laves__site_id(s), depth + 1);
    }
  }
  *vertex_count = queue.count;
  laves__free(queue.context, queue.id, queue.capacity, sizeof *queue.id);
  return memory;
}

/* Which tets of each cell are stamped and which belong to the layer. One byte for each site that the cell's tets can use
 * says all that decides: 128 OUT, 64 IN, and the depth (at most 63) in the low bits. Of a graph, one tet after the other. */
enum { CODE_OUT = 128, CODE_IN = 64, CODE_DEPTH = 63 };

static uint8_t code_of(const laves__record *r, int site) {
  const uint8_t depth = r->depth[site] < CODE_DEPTH ? r->depth[site] : CODE_DEPTH;
  return r->label[site] == LAVES__LABEL_OUT ? CODE_OUT : r->label[site] == LAVES__LABEL_IN ? CODE_IN | depth : depth;
}

static void code_cell(const laves__lattice *lattice, int32_t cell, uint8_t code[LAVES__C15_SITES]) {
  if (cell < 0) {
    memset(code, cell == LAVES__OUT ? CODE_OUT : CODE_IN | CODE_DEPTH, LAVES__C15_SITES);
    return;
  }
  for (int site = 0; site < LAVES__C15_SITES; site++) code[site] = code_of(&lattice->record[cell], site);
}

static void sort_graph_tets(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const laves__lattice *lattice = user;
  const laves__graph *g = lattice->graph;
  for (size_t t = begin; t < end; t++) {
    uint8_t any = 0, least = CODE_DEPTH;
    for (int k = 0; k < 4; k++) {
      const laves__site s = laves__site_of((uint32_t)g->tet[t][k]);
      const uint8_t c = code_of(&lattice->record[s.cell], s.site);
      any |= c;
      if ((c & CODE_DEPTH) < least) least = c & CODE_DEPTH;
    }
    g->flags[t] &= (uint8_t) ~(LAVES__TET_LAYER | LAVES__TET_STAMPED);
    if (any & CODE_OUT || (!(any & CODE_IN) && !(g->flags[t] & LAVES__TET_SOLID))) continue;
    g->flags[t] |= least <= LAVES__DEPTH_MOVES ? LAVES__TET_LAYER : LAVES__TET_STAMPED;
  }
}

static void sort_tets(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  laves__lattice *lattice = user;
  for (size_t i = begin; i < end; i++) {
    laves__record *r = &lattice->record[i];
    uint8_t code[8][LAVES__C15_SITES];
    for (int shift = 0; shift < 8; shift++)
      code_cell(lattice, r->around[13 + (shift & 1) + 3 * ((shift >> 1) & 1) + 9 * (shift >> 2)], code[shift]);
    memset(r->stamped, 0, sizeof r->stamped);
    memset(r->layer, 0, sizeof r->layer);
    for (int tet = 0; tet < LAVES__C15_TETS; tet++) {
      uint8_t any = 0, least = CODE_DEPTH;
      for (int k = 0; k < 4; k++) {
        const uint8_t c = code[laves__c15_tet[tet][k].shift][laves__c15_tet[tet][k].site];
        any |= c;
        if ((c & CODE_DEPTH) < least) least = c & CODE_DEPTH;
      }
      if (any & CODE_OUT || (!(any & CODE_IN) && !laves__bit(r->solid, tet))) continue;
      uint64_t *set = least <= LAVES__DEPTH_MOVES ? r->layer : r->stamped;
      set[tet >> 6] |= UINT64_C(1) << (tet & 63);
    }
  }
}

static bool sort_all_tets(laves__lattice *lattice) {
  if (lattice->graph)
    return laves__parallel_for(lattice->context, "snap", lattice->graph->tet_count, 1024, sort_graph_tets, lattice);
  return laves__parallel_for(lattice->context, "snap", lattice->record_count, 16, sort_tets, lattice);
}

static size_t count_layer_tets(const laves__lattice *lattice) {
  const laves__graph *g = lattice->graph;
  size_t count = 0;
  for (size_t t = 0; g && t < g->tet_count; t++) count += (g->flags[t] & LAVES__TET_LAYER) != 0;
  for (size_t i = 0; !g && i < lattice->record_count; i++)
    for (int word = 0; word < 3; word++) count += (size_t)__builtin_popcountll(lattice->record[i].layer[word]);
  return count;
}

static laves__parted_site *find_parted(const laves__parted *parted, uint32_t id) {
  size_t low = 0, high = parted->count;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (parted->item[middle].site < id)
      low = middle + 1;
    else
      high = middle;
  }
  return low < parted->count && parted->item[low].site == id ? &parted->item[low] : NULL;
}

static void place_at(const laves__foot *foot, laves__layer *layer, size_t v) {
  layer->position[v] = foot->position;
  layer->normal[v] = v3(foot->normal[0], foot->normal[1], foot->normal[2]);
  layer->hint[v] = foot->hint;
  layer->off_surface[v] = layer->depth[v] == 0 && foot->state == LAVES__FOOT_OFF;
}

/* Numbers the layer's vertices at sites by record and site, and returns how many they are. Sites with several fans get one vertex
 * for each, and a negative mark. */
static size_t number_vertices(laves__lattice *lattice, laves__parted *parted, laves__layer *layer) {
  size_t next = 0;
  for (size_t i = 0; i < lattice->record_count; i++) {
    laves__record *r = &lattice->record[i];
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      if (r->depth[site] > LAVES__DEPTH_MAX) continue;
      const laves__site s = {(int32_t)i, (uint8_t)site};
      const uint32_t id = laves__site_id(s);
      laves__parted_site *fans = r->depth[site] == 0 && parted->count ? find_parted(parted, id) : NULL;
      r->vertex[site] = fans ? -2 - (int32_t)(fans - parted->item) : (int32_t)next;
      for (int fan = 0; fan < (fans ? fans->fan_count : 1); fan++) {
        layer->depth[next] = r->depth[site];
        layer->hint[next] = r->hint[site];
        layer->origin[next] = fan == 0 ? id : LAVES__NO_ORIGIN;
        layer->position[next] = laves__site_place(lattice, s);
        if (layer->scale) layer->scale[next] = (float)laves__site_scale(lattice, s);
        if (fans) fans->vertex[fan] = (int32_t)next;
        next++;
      }
    }
  }
  return next;
}

/* The vertex of a parted site that a tet uses: that of the fan which holds the tet. */
static int32_t parted_vertex(const laves__lattice *lattice, const laves__parted_site *parted, laves__tet tet) {
  const int slot = laves__star_slot(lattice, laves__site_of(parted->site), tet);
  int fan = 0;
  while (!(parted->fan[fan] >> slot & 1)) fan++;
  return parted->vertex[fan];
}

/* The whole tets; returns how many. */
static size_t number_tets(const laves__lattice *lattice, const laves__parted *parted, laves__layer *layer) {
  size_t next = 0;
  const size_t chunks = laves__chunk_count(lattice);
  for (size_t chunk = 0; chunk < chunks; chunk++)
    for (int i = 0, size = laves__chunk_size(lattice, chunk); i < size; i++) {
      const laves__tet tet = {(int32_t)chunk, (uint8_t)i};
      if (!laves__tet_is(lattice, tet, LAVES__TET_LAYER)) continue;
      laves__site corner[4];
      laves__corners_of(lattice, tet, corner);
      for (int k = 0; k < 4; k++) {
        const int32_t vertex = lattice->record[corner[k].cell].vertex[corner[k].site];
        layer->tet[next][k] = vertex >= 0 ? vertex : parted_vertex(lattice, &parted->item[-2 - vertex], tet);
      }
      next++;
    }
  return next;
}

/* Cut vertices come after those at sites, pieces after the whole tets. */
static void add_cuts(const laves__lattice *lattice, const laves__cuts *cuts, size_t first_vertex, size_t first_tet,
                     laves__layer *layer) {
  for (size_t i = 0; i < cuts->vertex_count; i++) {
    const size_t v = first_vertex + i;
    layer->depth[v] = 0;
    layer->origin[v] = LAVES__NO_ORIGIN;
    place_at(&cuts->vertex[i], layer, v);
  }
  for (size_t t = 0; t < cuts->tet_count; t++)
    for (int k = 0; k < 4; k++) {
      const uint32_t id = cuts->tet[t][k];
      layer->tet[first_tet + t][k] = id & LAVES__CUT_VERTEX
                                         ? (int32_t)(first_vertex + (id & ~LAVES__CUT_VERTEX))
                                         : lattice->record[id / LAVES__C15_SITES].vertex[id % LAVES__C15_SITES];
    }
}

/* Vertices at ON sites go to their feet; those without one stay. */
static void place_vertices(const laves__lattice *lattice, const laves__feet *feet, size_t count, laves__layer *layer) {
  for (size_t v = 0; v < count; v++) {
    const uint32_t id = layer->origin[v];
    if (layer->depth[v] > 1 || id == LAVES__NO_ORIGIN) continue;
    const int32_t record = (int32_t)(id / LAVES__C15_SITES);
    const int site = (int)(id % LAVES__C15_SITES);
    if (lattice->record[record].label[site] != LAVES__LABEL_ON) continue;
    const laves__foot *foot = laves__feet_get(feet, record, site);
    if (foot) place_at(foot, layer, v);
    if (!foot && layer->depth[v] == 0) layer->off_surface[v] = true;
  }
}

/* Further copies of a parted vertex stand where the first stands. */
static void place_copies(size_t count, laves__layer *layer) {
  for (size_t v = 1; v < count; v++) {
    if (layer->origin[v] != LAVES__NO_ORIGIN) continue;
    layer->position[v] = layer->position[v - 1];
    layer->normal[v] = layer->normal[v - 1];
    layer->hint[v] = layer->hint[v - 1];
    layer->off_surface[v] = layer->off_surface[v - 1];
  }
}

void laves__cuts_free(laves__cuts *cuts) {
  if (!cuts->context) return;
  laves__free(cuts->context, cuts->vertex, cuts->vertex_count, sizeof *cuts->vertex);
  laves__free(cuts->context, cuts->tet, cuts->tet_capacity, sizeof *cuts->tet);
  memset(cuts, 0, sizeof *cuts);
}

laves_result laves__layer_build(const laves__feet *feet, laves__lattice *lattice, laves__parted *parted, const laves__cuts *cuts,
                                laves__layer *layer, laves_error *error) {
  laves_context *context = lattice->context;
  size_t vertex_count = 0;
  if (!widen_records(lattice) || !measure_depths(lattice, cuts, &vertex_count)) return laves__fail_memory(context, error);
  for (size_t i = 0; i < parted->count; i++) vertex_count += (size_t)parted->item[i].fan_count - 1;
  if (!sort_all_tets(lattice)) return laves__fail_cancelled(error);
  const size_t tet_count = count_layer_tets(lattice);
  const size_t cut_vertices = cuts ? cuts->vertex_count : 0, pieces = cuts ? cuts->tet_count : 0;
  if (tet_count + pieces > INT32_MAX)
    return laves__fail(error, LAVES_ERROR_OPTION,
                       "the boundary layer would have %zu tetrahedra, more than can be indexed; choose a larger size",
                       tet_count + pieces);
  laves_result result = laves__layer_create(context, vertex_count + cut_vertices, tet_count + pieces, layer, error);
  if (result != LAVES_OK) return result;
  if (lattice->graph && !(layer->scale = laves__alloc(context, layer->vertex_count, sizeof *layer->scale)))
    return laves__fail_memory(context, error);
  const size_t at_sites = number_vertices(lattice, parted, layer), whole = number_tets(lattice, parted, layer);
  LAVES_ASSERT(at_sites == vertex_count && whole == tet_count);
  place_vertices(lattice, feet, at_sites, layer);
  place_copies(at_sites, layer);
  if (cuts) add_cuts(lattice, cuts, at_sites, whole, layer);
  return laves__layer_link(layer, error);
}

static bool is_positive(const laves__layer *layer, int32_t tet) {
  laves__vec3 p[4];
  laves__layer_points(layer, tet, p);
  return laves__orient3d(p[0], p[1], p[2], p[3]) > 0;
}

size_t laves__layer_untangle(laves__layer *layer, const laves__vec3 *start) {
  /* Each round halves the way of every surface vertex of a bad tet; after the last they stand at their sites, where all
   * tets are positive. */
  enum { HALVINGS = 6 };
  for (int round = 0;; round++) {
    bool bad = false;
    for (size_t t = 0; t < layer->tet_count && !laves__cancelled_at(layer->context, "snap", t, layer->tet_count); t++) {
      if (layer->tet[t][0] < 0 || is_positive(layer, (int32_t)t)) continue;
      bad = true;
      for (int k = 0; k < 4; k++) {
        const int32_t v = layer->tet[t][k];
        if (layer->depth[v] != 0) continue;
        layer->position[v] = round < HALVINGS ? v3_lerp(start[v], layer->position[v], 0.5) : start[v];
        layer->off_surface[v] = true;
      }
    }
    if (!bad) break;
  }
  size_t count = 0;
  for (size_t v = 0; v < layer->vertex_count; v++) count += layer->off_surface[v];
  return count;
}
