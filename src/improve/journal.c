/* Remembering and undoing changes of the layer. */
#include "improve/journal.h"

#include "improve/measure.h"

#include <string.h>

void laves__journal_free(laves__journal *j) {
  if (!j->context) return;
  laves__free(j->context, j->vertex, j->vertex_capacity, sizeof *j->vertex);
  laves__free(j->context, j->tet, j->tet_capacity, sizeof *j->tet);
  laves__free(j->context, j->star, j->star_capacity, sizeof *j->star);
  laves__free(j->context, j->pool, j->pool_capacity, sizeof *j->pool);
  memset(j, 0, sizeof *j);
}

void laves__journal_clear(laves__journal *j) { j->vertex_count = j->tet_count = j->star_count = j->pool_count = 0; }

/* Once memory was short nothing is begun any more: what could be made of the rest would depend on when that was. */
static bool grow(laves__journal *j, void *block, size_t *capacity, size_t needed, size_t size) {
  if (!j->short_of_memory && laves__grow(j->context, block, capacity, needed, size)) return true;
  j->short_of_memory = true;
  return false;
}

bool laves__journal_vertex(laves__journal *j, const laves__layer *layer, int32_t v) {
  if (!j) return true;
  if (!grow(j, &j->vertex, &j->vertex_capacity, j->vertex_count + 1, sizeof *j->vertex)) return false;
  j->vertex[j->vertex_count++] =
      (laves__vertex_entry){v, layer->hint[v], layer->position[v], layer->normal[v], layer->off_surface[v]};
  return true;
}

bool laves__journal_tet(laves__journal *j, const laves__layer *layer, int32_t t) {
  if (!j) return true;
  if (!grow(j, &j->tet, &j->tet_capacity, j->tet_count + 1, sizeof *j->tet)) return false;
  laves__tet_entry *entry = &j->tet[j->tet_count++];
  entry->tet = t;
  entry->quality = layer->quality[t];
  memcpy(entry->corner, layer->tet[t], sizeof entry->corner);
  if (layer->patch) memcpy(entry->patch, layer->patch[t], sizeof entry->patch);
  return true;
}

bool laves__journal_star(laves__journal *j, const laves__layer *layer, int32_t v) {
  if (!j) return true;
  const laves__star *star = &layer->star[v];
  if (!grow(j, &j->star, &j->star_capacity, j->star_count + 1, sizeof *j->star) ||
      !grow(j, &j->pool, &j->pool_capacity, j->pool_count + (size_t)star->count, sizeof *j->pool))
    return false;
  j->star[j->star_count++] = (laves__star_entry){v, star->count, j->pool_count};
  if (star->count) memcpy(j->pool + j->pool_count, star->tet, (size_t)star->count * sizeof *star->tet);
  j->pool_count += (size_t)star->count;
  return true;
}

bool laves__journal_star_add(laves__journal *j, laves__layer *layer, int32_t v, int32_t t) {
  if (laves__star_add(layer->context, &layer->star[v], t)) return true;
  j->short_of_memory = true;
  return false;
}

bool laves__lacks_less(const laves__layer *layer, const laves__journal *j) {
  double before = 0, now = 0;
  for (size_t i = 0; i < j->tet_count; i++) {
    const laves__tet_entry *was = &j->tet[i];
    if (was->corner[0] >= 0) before += laves__shortfall(was->quality);
    if (layer->tet[was->tet][0] >= 0) now += laves__shortfall(layer->quality[was->tet]);
  }
  return now < before;
}

void laves__journal_undo(laves__journal *j, laves__layer *layer) {
  for (size_t i = j->vertex_count; i-- > 0;) {
    const laves__vertex_entry *e = &j->vertex[i];
    layer->position[e->vertex] = e->position;
    layer->normal[e->vertex] = e->normal;
    layer->hint[e->vertex] = e->hint;
    layer->off_surface[e->vertex] = e->off_surface;
  }
  for (size_t i = j->tet_count; i-- > 0;) {
    const laves__tet_entry *e = &j->tet[i];
    memcpy(layer->tet[e->tet], e->corner, sizeof e->corner);
    if (layer->patch) memcpy(layer->patch[e->tet], e->patch, sizeof e->patch);
    layer->quality[e->tet] = e->quality;
  }
  for (size_t i = j->star_count; i-- > 0;) {
    const laves__star_entry *e = &j->star[i];
    laves__star *star = &layer->star[e->vertex];
    LAVES_ASSERT(e->count <= star->capacity);
    star->count = e->count;
    if (e->count) memcpy(star->tet, j->pool + e->first, (size_t)e->count * sizeof *star->tet);
  }
  laves__journal_clear(j);
}
