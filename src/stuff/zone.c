/* Zones grow from the tets that break the promise: first some cells around them, in the end the whole component. */
#include "stuff/zone.h"

#include <string.h>

#include "mesh/shape_batch.h"

static const uint32_t all_sites = (UINT32_C(1) << LAVES__C15_SITES) - 1;
static const double radians = 3.14159265358979323846 / 180;

/* Whether a tet is outside the promised window. Improvement holds a window a little inside, so rounding never decides. */
static bool is_broken(const laves__layer *layer, size_t tet, const laves__guarantee *promised) {
  if (layer->tet[tet][0] < 0) return false;
  laves__vec3 p[4];
  laves__layer_points(layer, (int32_t)tet, p);
  return !(laves__guarantee_margin(promised, p) >= 1);
}

/* The guarantee with its promised angles in place of the proved ones. */
static laves__guarantee promised_window(const laves__guarantee *g) {
  laves__guarantee promised = *g;
  promised.cos_min = cos(g->min_dihedral * radians);
  promised.cos_max = cos(g->max_dihedral * radians);
  return promised;
}

/* The same for the tets of a batch: how many are. A quotient of positive numbers is at least 1 when the first is no less than the
 * second, so laves__guarantee_margin() need not divide to be compared with 1. */
static int count_broken_of(laves__shape_batch *batch, int count, const laves__guarantee *promised) {
  double fits[LAVES__SHAPE_BATCH];
  int broken = 0;
  laves__shape_batch_measure(batch);
  laves__shape_batch_fits(batch, 1 - promised->cos_min, 1 + promised->cos_max, fits);
  for (int lane = 0; lane < count; lane++) broken += fits[lane] == 0;
  return broken;
}

typedef struct broken_count {
  laves__guarantee promised;
  const laves__layer *layer;
  const bool *forced;
} broken_count;

static double count_broken(const void *user, size_t begin, size_t end) {
  const broken_count *c = user;
  laves__shape_batch batch = {.determinant = {0}}; /* lanes that stay empty are measured, too */
  double broken = 0;
  int count = 0;
  for (size_t t = begin; t < end; t++) {
    if (c->layer->tet[t][0] < 0 || (c->forced && c->forced[t])) continue;
    laves__vec3 p[4];
    laves__layer_points(c->layer, (int32_t)t, p);
    laves__shape_batch_set(&batch, count++, p);
    if (count < LAVES__SHAPE_BATCH) continue;
    broken += count_broken_of(&batch, count, &c->promised);
    count = 0;
  }
  return broken + count_broken_of(&batch, count, &c->promised);
}

size_t laves__count_broken(const laves__guarantee *guarantee, const laves__layer *layer, const bool *forced) {
  const broken_count c = {promised_window(guarantee), layer, forced};
  return (size_t)laves__parallel_sum(layer->context, "stuff", layer->tet_count, count_broken, &c);
}

bool laves__is_broken(const laves__guarantee *guarantee, const laves__layer *layer) {
  const laves__guarantee promised = promised_window(guarantee);
  if (!layer->fresh) return laves__count_broken(guarantee, layer, NULL) > 0;
  for (size_t t = 0; t < layer->tet_count; t++)
    if (layer->tet[t][0] >= 0 && laves__layer_is_fresh(layer, (int32_t)t) && is_broken(layer, t, &promised)) return true;
  return false;
}

static void zone_cells(laves__lattice *lattice, laves__known_lattice *known, laves__vec3 centre, int reach) {
  const int32_t x = (int32_t)floor(centre.x / LAVES__CELL_SIDE), y = (int32_t)floor(centre.y / LAVES__CELL_SIDE),
                z = (int32_t)floor(centre.z / LAVES__CELL_SIDE);
  for (int dz = -reach; dz <= reach; dz++)
    for (int dy = -reach; dy <= reach; dy++)
      for (int dx = -reach; dx <= reach; dx++) {
        const int32_t cell = laves__lattice_cell(lattice, x + dx, y + dy, z + dz);
        if (cell < 0) continue;
        lattice->record[cell].zone = all_sites;
        laves__known_forget(known, (size_t)cell);
      }
}

void laves__zone_around(const laves__guarantee *guarantee, const laves__layer *layer, const bool *forced, int reach,
                        laves__lattice *lattice, laves__known_lattice *known) {
  const laves__guarantee promised = promised_window(guarantee);
  for (size_t t = 0; t < layer->tet_count && !laves__cancelled_at(layer->context, "stuff", t, layer->tet_count); t++) {
    if (!is_broken(layer, t, &promised) || (forced && forced[t])) continue;
    laves__vec3 p[4];
    laves__layer_points(layer, (int32_t)t, p);
    zone_cells(lattice, known, v3_scale(v3_add(v3_add(p[0], p[1]), v3_add(p[2], p[3])), 0.25), reach);
  }
}

void laves__find_broken_walls(const laves__guarantee *guarantee, const laves__layer *layer, const bool *forced,
                              const laves__components *walls, bool *broken) {
  const laves__guarantee promised = promised_window(guarantee);
  for (size_t i = 0; i < walls->count; i++) broken[i] = false;
  for (size_t t = 0; t < layer->tet_count; t++) {
    if (!is_broken(layer, t, &promised) || (forced && forced[t])) continue;
    for (int k = 0; k < 4; k++) {
      const size_t v = (size_t)layer->tet[t][k]; /* improvement may have added it */
      if (v < walls->vertex_count && walls->of[v] >= 0) broken[walls->of[v]] = true;
    }
  }
}

void laves__zone_walls(const laves__layer *layer, const laves__components *walls, const bool *broken, laves__lattice *lattice) {
  for (size_t v = 0; v < walls->vertex_count; v++) {
    const uint32_t id = layer->origin[v];
    if (id == LAVES__NO_ORIGIN || walls->of[v] < 0 || !broken[walls->of[v]]) continue;
    const laves__record *r = &lattice->record[id / LAVES__C15_SITES];
    for (int k = 0; k < 27; k++)
      if (r->around[k] >= 0) lattice->record[r->around[k]].zone = all_sites;
  }
}

/* Marks the cells around those that are marked. */
static void widen(const laves__lattice *lattice, const bool *marked, bool *wider) {
  for (size_t i = 0; i < lattice->record_count; i++) {
    wider[i] = marked[i];
    for (int k = 0; k < 27 && !wider[i]; k++)
      wider[i] = lattice->record[i].around[k] >= 0 && marked[lattice->record[i].around[k]];
  }
}

bool laves__zone_vertices(const laves__lattice *lattice, const laves__layer *layer, int rings, bool *in_zone) {
  const size_t records = lattice->record_count;
  bool *near = laves__alloc(lattice->context, records, sizeof *near),
       *wider = laves__alloc(lattice->context, records, sizeof *wider);
  const bool memory = near && wider;
  for (size_t i = 0; memory && i < records; i++) near[i] = lattice->record[i].zone != 0;
  for (int ring = 0; memory && ring < rings; ring++) {
    widen(lattice, near, wider);
    memcpy(near, wider, records * sizeof *near);
  }
  for (size_t v = 0; memory && v < layer->vertex_count; v++) {
    const uint32_t id = layer->origin[v];
    const bool is_cut = id == LAVES__NO_ORIGIN || (lattice->record[id / LAVES__C15_SITES].zone >> id % LAVES__C15_SITES & 1);
    in_zone[v] = layer->depth[v] == 0 && (is_cut || (rings > 0 && near[id / LAVES__C15_SITES]));
  }
  laves__free(lattice->context, near, records, sizeof *near);
  laves__free(lattice->context, wider, records, sizeof *wider);
  return memory;
}

bool laves__zone_components(laves__lattice *lattice) {
  laves_context *context = lattice->context;
  int32_t *list = laves__alloc(context, lattice->record_count, sizeof *list);
  bool *known = laves__alloc_zeroed(context, lattice->record_count, sizeof *known);
  size_t count = 0;
  for (size_t i = 0; list && known && i < lattice->record_count; i++) {
    if (!lattice->record[i].zone) continue;
    known[i] = true;
    list[count++] = (int32_t)i;
  }
  for (size_t head = 0; head < count; head++) {
    const laves__record *r = &lattice->record[list[head]];
    for (int k = 0; k < 27; k++) {
      if (r->around[k] < 0 || known[r->around[k]]) continue;
      known[r->around[k]] = true;
      list[count++] = r->around[k];
    }
  }
  for (size_t i = 0; i < count; i++) lattice->record[list[i]].zone = all_sites;
  const bool memory = list && known;
  laves__free(context, known, lattice->record_count, sizeof *known);
  laves__free(context, list, lattice->record_count, sizeof *list);
  return memory;
}

void laves__zone_everything(laves__lattice *lattice) {
  for (size_t i = 0; i < lattice->record_count; i++) lattice->record[i].zone = all_sites;
}
