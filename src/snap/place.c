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
  for (int site = 0; site < LAVES__C15_SITES; site++)
    if (r->label[site] == LAVES__LABEL_ON) return true;
  return false;
}

/* Records for the inner cells that the layer reaches. */
static bool widen_records(laves__lattice *lattice) {
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

/* Breadth first from the ON sites that bound kept tets, through IN sites. */
static bool measure_depths(laves__lattice *lattice, size_t *vertex_count) {
  laves_context *context = lattice->context;
  uint32_t *queue = NULL;
  size_t capacity = 0, count = 0;
  bool memory = true;
  for (size_t i = 0; memory && i < lattice->record_count; i++) {
    laves__record *r = &lattice->record[i];
    for (int site = 0; memory && site < LAVES__C15_SITES; site++) {
      if (r->label[site] != LAVES__LABEL_ON) continue;
      if (laves__star_kept(lattice, (int32_t)i, site) == 0) continue;
      r->depth[site] = 0;
      memory = laves__grow(context, &queue, &capacity, count + 1, sizeof *queue);
      if (memory) queue[count++] = (uint32_t)i * LAVES__C15_SITES + (uint32_t)site;
    }
  }
  for (size_t head = 0; memory && head < count; head++) {
    const laves__record *r = &lattice->record[queue[head] / LAVES__C15_SITES];
    const int site = (int)(queue[head] % LAVES__C15_SITES);
    if (r->depth[site] == LAVES__DEPTH_MAX) break;
    for (int k = 0; memory && k < laves__c15_degree[site]; k++) {
      const laves__site s = laves__neighbour(r, site, k);
      if (s.cell < 0) continue;
      laves__record *other = &lattice->record[s.cell];
      if (other->label[s.site] != LAVES__LABEL_IN || other->depth[s.site] <= r->depth[site] + 1) continue;
      other->depth[s.site] = (uint8_t)(r->depth[site] + 1);
      memory = laves__grow(context, &queue, &capacity, count + 1, sizeof *queue);
      if (memory) queue[count++] = (uint32_t)s.cell * LAVES__C15_SITES + s.site;
    }
  }
  *vertex_count = count;
  laves__free(context, queue, capacity, sizeof *queue);
  return memory;
}

/* Which tets of each cell are stamped and which belong to the layer. One byte for each site that the cell's tets can use
 * says all that decides: 128 OUT, 64 IN, and the depth (at most 63) in the low bits. */
enum { CODE_OUT = 128, CODE_IN = 64, CODE_DEPTH = 63 };

static void code_cell(const laves__lattice *lattice, int32_t cell, uint8_t code[LAVES__C15_SITES]) {
  if (cell < 0) {
    memset(code, cell == LAVES__OUT ? CODE_OUT : CODE_IN | CODE_DEPTH, LAVES__C15_SITES);
    return;
  }
  const laves__record *r = &lattice->record[cell];
  for (int site = 0; site < LAVES__C15_SITES; site++) {
    const uint8_t depth = r->depth[site] < CODE_DEPTH ? r->depth[site] : CODE_DEPTH;
    code[site] = r->label[site] == LAVES__LABEL_OUT ? CODE_OUT : r->label[site] == LAVES__LABEL_IN ? CODE_IN | depth : depth;
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

static size_t count_bits(const uint64_t set[3]) {
  return (size_t)(__builtin_popcountll(set[0]) + __builtin_popcountll(set[1]) + __builtin_popcountll(set[2]));
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

/* Numbers the layer's vertices by record and site. Sites with several fans get one vertex for each, and a negative mark. */
static void number_vertices(laves__lattice *lattice, laves__parted *parted, laves__layer *layer) {
  size_t next = 0;
  for (size_t i = 0; i < lattice->record_count; i++) {
    laves__record *r = &lattice->record[i];
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      if (r->depth[site] > LAVES__DEPTH_MAX) continue;
      const uint32_t id = (uint32_t)i * LAVES__C15_SITES + (uint32_t)site;
      laves__parted_site *fans = r->depth[site] == 0 && parted->count ? find_parted(parted, id) : NULL;
      r->vertex[site] = fans ? -2 - (int32_t)(fans - parted->item) : (int32_t)next;
      for (int fan = 0; fan < (fans ? fans->fan_count : 1); fan++) {
        layer->depth[next] = r->depth[site];
        layer->hint[next] = r->hint[site];
        layer->origin[next] = fan == 0 ? id : LAVES__NO_ORIGIN;
        layer->position[next] = laves__site_position(r->xyz, site);
        if (fans) fans->vertex[fan] = (int32_t)next;
        next++;
      }
    }
  }
  LAVES_ASSERT(next == layer->vertex_count);
}

/* The vertex of a parted site that a tet uses: that of the fan which holds the tet. */
static int32_t parted_vertex(const laves__parted_site *parted, int tet, int corner_cell) {
  const int site = (int)(parted->site % LAVES__C15_SITES);
  int slot = 0;
  while (laves__c15_star[site][slot].tet != tet || laves__c15_star[site][slot].cell != 26 - corner_cell) slot++;
  int fan = 0;
  while (!(parted->fan[fan] >> slot & 1)) fan++;
  return parted->vertex[fan];
}

static void number_tets(const laves__lattice *lattice, const laves__parted *parted, laves__layer *layer) {
  size_t next = 0;
  for (size_t i = 0; i < lattice->record_count; i++) {
    const laves__record *r = &lattice->record[i];
    for (int word = 0; word < 3; word++)
      for (uint64_t set = r->layer[word]; set; set &= set - 1) {
        const int tet = 64 * word + __builtin_ctzll(set);
        for (int k = 0; k < 4; k++) {
          const laves__c15_corner corner = laves__c15_tet[tet][k];
          const int cell = 13 + (corner.shift & 1) + 3 * ((corner.shift >> 1) & 1) + 9 * (corner.shift >> 2);
          int32_t vertex = lattice->record[r->around[cell]].vertex[corner.site];
          if (vertex < 0) vertex = parted_vertex(&parted->item[-2 - vertex], tet, cell);
          layer->tet[next][k] = vertex;
        }
        next++;
      }
  }
  LAVES_ASSERT(next == layer->tet_count);
}

/* Surface vertices go to their feet; those without one stay. */
static void place_vertices(const laves__feet *feet, laves__layer *layer) {
  for (size_t v = 0; v < layer->vertex_count; v++) {
    if (layer->depth[v] != 0 || layer->origin[v] == LAVES__NO_ORIGIN) continue;
    const uint32_t id = layer->origin[v];
    const laves__foot *foot = laves__feet_get(feet, (int32_t)(id / LAVES__C15_SITES), (int)(id % LAVES__C15_SITES));
    if (!foot) {
      layer->off_surface[v] = true;
      continue;
    }
    layer->position[v] = foot->position;
    layer->normal[v] = v3(foot->normal[0], foot->normal[1], foot->normal[2]);
    layer->hint[v] = foot->hint;
  }
}

/* Further copies of a parted vertex stand where the first stands. */
static void place_copies(laves__layer *layer) {
  for (size_t v = 1; v < layer->vertex_count; v++) {
    if (layer->origin[v] != LAVES__NO_ORIGIN) continue;
    layer->position[v] = layer->position[v - 1];
    layer->normal[v] = layer->normal[v - 1];
    layer->hint[v] = layer->hint[v - 1];
    layer->off_surface[v] = layer->off_surface[v - 1];
  }
}

laves_result laves__layer_build(const laves__feet *feet, laves__lattice *lattice, laves__parted *parted, laves__layer *layer,
                                laves_error *error) {
  laves_context *context = lattice->context;
  size_t vertex_count = 0, tet_count = 0;
  if (!widen_records(lattice) || !measure_depths(lattice, &vertex_count)) return laves__fail_memory(context, error);
  for (size_t i = 0; i < parted->count; i++) vertex_count += (size_t)parted->item[i].fan_count - 1;
  if (!laves__parallel_for(context, "snap", lattice->record_count, 16, sort_tets, lattice)) return laves__fail_cancelled(error);
  for (size_t i = 0; i < lattice->record_count; i++) tet_count += count_bits(lattice->record[i].layer);
  if (tet_count > INT32_MAX)
    return laves__fail(error, LAVES_ERROR_OPTION,
                       "the boundary layer would have %zu tetrahedra, more than can be indexed; choose a larger size", tet_count);
  laves_result result = laves__layer_create(context, vertex_count, tet_count, layer, error);
  if (result != LAVES_OK) return result;
  number_vertices(lattice, parted, layer);
  number_tets(lattice, parted, layer);
  place_vertices(feet, layer);
  place_copies(layer);
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
    for (size_t t = 0; t < layer->tet_count; t++) {
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
