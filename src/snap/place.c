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

/* Records or chunks that a thread takes at least. */
enum { BLOCK = 16 };

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
  return laves__parallel_for(lattice->context, "snap", lattice->record_count, BLOCK, sort_tets, lattice);
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

/* ---- numbering: what each record or chunk holds is counted, summed up, and numbered, by all threads ---- */

typedef struct numbering {
  laves__lattice *lattice;
  const laves__parted *parted;
  laves__layer *layer;
  size_t *vertex; /* [record_count + 1] how many vertices a record has; then its first */
  size_t *tet;    /* [chunk_count + 1] the same of the layer's tets */
} numbering;

static laves__parted_site *fans_of(const numbering *n, laves__site s) {
  const bool on_boundary = n->lattice->record[s.cell].depth[s.site] == 0;
  return on_boundary && n->parted->count ? find_parted(n->parted, laves__site_id(s)) : NULL;
}

static void count_vertices(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const numbering *n = user;
  for (size_t i = begin; i < end; i++) {
    size_t count = 0;
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      if (n->lattice->record[i].depth[site] > LAVES__DEPTH_MAX) continue;
      const laves__parted_site *fans = fans_of(n, (laves__site){(int32_t)i, (uint8_t)site});
      count += fans ? (size_t)fans->fan_count : 1;
    }
    n->vertex[i] = count;
  }
}

static void count_tets(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const numbering *n = user;
  const bool graph = n->lattice->graph != NULL;
  for (size_t chunk = begin; chunk < end; chunk++) {
    size_t count = 0;
    for (int word = 0; !graph && word < 3; word++) count += (size_t)__builtin_popcountll(n->lattice->record[chunk].layer[word]);
    for (int i = 0, size = laves__chunk_size(n->lattice, chunk); graph && i < size; i++)
      count += laves__tet_is(n->lattice, (laves__tet){(int32_t)chunk, (uint8_t)i}, LAVES__TET_LAYER);
    n->tet[chunk] = count;
  }
}

/* Counts become the sums of those before, the last the sum of all. */
static void sum_up(size_t *first, size_t count) {
  size_t sum = 0;
  for (size_t i = 0; i <= count; i++) {
    const size_t own = i < count ? first[i] : 0;
    first[i] = sum;
    sum += own;
  }
}

/* The layer's vertices at sites, by record and site. Sites with several fans get one vertex for each, and a negative mark. */
static void number_vertices(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const numbering *n = user;
  laves__layer *layer = n->layer;
  for (size_t i = begin; i < end; i++) {
    laves__record *r = &n->lattice->record[i];
    size_t next = n->vertex[i];
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      if (r->depth[site] > LAVES__DEPTH_MAX) continue;
      const laves__site s = {(int32_t)i, (uint8_t)site};
      laves__parted_site *fans = fans_of(n, s);
      r->vertex[site] = fans ? -2 - (int32_t)(fans - n->parted->item) : (int32_t)next;
      for (int fan = 0; fan < (fans ? fans->fan_count : 1); fan++) {
        layer->depth[next] = r->depth[site];
        layer->hint[next] = r->hint[site];
        layer->origin[next] = fan == 0 ? laves__site_id(s) : LAVES__NO_ORIGIN;
        layer->position[next] = laves__site_place(n->lattice, s);
        if (layer->scale) layer->scale[next] = (float)laves__site_scale(n->lattice, s);
        if (fans) fans->vertex[fan] = (int32_t)next;
        next++;
      }
    }
  }
}

/* The vertex of a parted site that a tet uses: that of the fan which holds the tet. */
static int32_t parted_vertex(const laves__lattice *lattice, const laves__parted_site *parted, laves__tet tet) {
  const int slot = laves__star_slot(lattice, laves__site_of(parted->site), tet);
  int fan = 0;
  while (!(parted->fan[fan] >> slot & 1)) fan++;
  return parted->vertex[fan];
}

/* The whole tets. */
static void number_tets(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const numbering *n = user;
  for (size_t chunk = begin; chunk < end; chunk++) {
    size_t next = n->tet[chunk];
    for (int i = 0, size = laves__chunk_size(n->lattice, chunk); i < size; i++) {
      const laves__tet tet = {(int32_t)chunk, (uint8_t)i};
      if (!laves__tet_is(n->lattice, tet, LAVES__TET_LAYER)) continue;
      laves__site corner[4];
      laves__corners_of(n->lattice, tet, corner);
      for (int k = 0; k < 4; k++) {
        const int32_t vertex = n->lattice->record[corner[k].cell].vertex[corner[k].site];
        n->layer->tet[next][k] = vertex >= 0 ? vertex : parted_vertex(n->lattice, &n->parted->item[-2 - vertex], tet);
      }
      next++;
    }
  }
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
typedef struct placing {
  const laves__lattice *lattice;
  const laves__feet *feet;
  laves__layer *layer;
} placing;

static void place_vertices(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const placing *p = user;
  for (size_t v = begin; v < end; v++) {
    const uint32_t id = p->layer->origin[v];
    if (p->layer->depth[v] > 1 || id == LAVES__NO_ORIGIN) continue;
    const int32_t record = (int32_t)(id / LAVES__C15_SITES);
    const int site = (int)(id % LAVES__C15_SITES);
    if (p->lattice->record[record].label[site] != LAVES__LABEL_ON) continue;
    const laves__foot *foot = laves__feet_get(p->feet, record, site);
    if (foot) place_at(foot, p->layer, v);
    if (!foot && p->layer->depth[v] == 0) p->layer->off_surface[v] = true;
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

/* Makes the layer, with room for what is cut, and numbers what is whole. */
static laves_result number_all(numbering *n, const laves__cuts *cuts, laves_error *error) {
  laves__lattice *lattice = n->lattice;
  laves_context *context = lattice->context;
  const size_t records = lattice->record_count, chunks = laves__chunk_count(lattice);
  if (!laves__parallel_for(context, NULL, records, BLOCK, count_vertices, n) ||
      !laves__parallel_for(context, NULL, chunks, BLOCK, count_tets, n))
    return laves__fail_cancelled(error);
  sum_up(n->vertex, records);
  sum_up(n->tet, chunks);
  const size_t vertices = n->vertex[records] + (cuts ? cuts->vertex_count : 0);
  const size_t tets = n->tet[chunks] + (cuts ? cuts->tet_count : 0);
  if (tets > INT32_MAX)
    return laves__fail(error, LAVES_ERROR_OPTION,
                       "the boundary layer would have %zu tetrahedra, more than can be indexed; choose a larger size", tets);
  const laves_result result = laves__layer_create(context, vertices, tets, n->layer, error);
  if (result != LAVES_OK) return result;
  if (lattice->graph && !(n->layer->scale = laves__alloc(context, vertices, sizeof *n->layer->scale)))
    return laves__fail_memory(context, error);
  return laves__parallel_for(context, NULL, records, BLOCK, number_vertices, n) &&
                 laves__parallel_for(context, NULL, chunks, BLOCK, number_tets, n)
             ? LAVES_OK
             : laves__fail_cancelled(error);
}

laves_result laves__layer_build(const laves__feet *feet, laves__lattice *lattice, laves__parted *parted, const laves__cuts *cuts,
                                laves__layer *layer, laves_error *error) {
  laves_context *context = lattice->context;
  if (!widen_records(lattice)) return laves__fail_memory(context, error);
  if (!laves__measure_depths(lattice, cuts) || !sort_all_tets(lattice)) return laves__fail_cancelled(error);
  const size_t records = lattice->record_count, chunks = laves__chunk_count(lattice);
  numbering n = {.lattice = lattice, .parted = parted, .layer = layer};
  n.vertex = laves__alloc(context, records + 1, sizeof *n.vertex);
  n.tet = laves__alloc(context, chunks + 1, sizeof *n.tet);
  laves_result result = n.vertex && n.tet ? number_all(&n, cuts, error) : laves__fail_memory(context, error);
  if (result == LAVES_OK) {
    const size_t at_sites = n.vertex[records], whole = n.tet[chunks];
    placing p = {lattice, feet, layer};
    if (!laves__parallel_for(context, NULL, at_sites, 1024, place_vertices, &p)) result = laves__fail_cancelled(error);
    place_copies(at_sites, layer);
    if (cuts) add_cuts(lattice, cuts, at_sites, whole, layer);
  }
  laves__free(context, n.vertex, records + 1, sizeof *n.vertex);
  laves__free(context, n.tet, chunks + 1, sizeof *n.tet);
  return result == LAVES_OK ? laves__layer_link(layer, error) : result;
}

static bool is_positive(const laves__layer *layer, int32_t tet) {
  laves__vec3 p[4];
  laves__layer_points(layer, tet, p);
  return laves__orient3d(p[0], p[1], p[2], p[3]) > 0;
}

static double count_tangled(const void *user, size_t begin, size_t end) {
  const laves__layer *layer = user;
  double count = 0;
  for (size_t t = begin; t < end; t++) count += layer->tet[t][0] >= 0 && !is_positive(layer, (int32_t)t);
  return count;
}

/* Halves the way of every surface vertex of a bad tet, or sends it back to its site. */
static void draw_back(laves__layer *layer, const laves__vec3 *start, bool whole_way) {
  for (size_t t = 0; t < layer->tet_count; t++) {
    if (layer->tet[t][0] < 0 || is_positive(layer, (int32_t)t)) continue;
    for (int k = 0; k < 4; k++) {
      const int32_t v = layer->tet[t][k];
      if (layer->depth[v] != 0) continue;
      layer->position[v] = whole_way ? start[v] : v3_lerp(start[v], layer->position[v], 0.5);
      layer->off_surface[v] = true;
    }
  }
}

size_t laves__layer_untangle(laves__layer *layer, const laves__vec3 *start) {
  /* After the last round they stand at their sites, where all tets are positive. */
  enum { HALVINGS = 6 };
  for (int round = 0; laves__parallel_sum(layer->context, "snap", layer->tet_count, count_tangled, layer) > 0; round++) {
    if (laves__is_cancelled(layer->context)) break;
    draw_back(layer, start, round >= HALVINGS);
  }
  size_t count = 0;
  for (size_t v = 0; v < layer->vertex_count; v++) count += layer->off_surface[v];
  return count;
}
