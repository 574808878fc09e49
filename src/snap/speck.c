/* Specks: where a spike is thinner than the lattice resolves, a few tets beyond the gap would float by themselves. */
#include "snap/snap.h"

enum { SPECK_MAX = 8 }; /* tets */

static bool has_inner_vertex(const laves__layer *layer, int32_t tet) {
  for (int k = 0; k < 4; k++)
    if (layer->depth[layer->tet[tet][k]] != 0) return true;
  return false;
}

/* Collects the part that holds `first`, through faces; 0 when it has an inner vertex or more than SPECK_MAX tets. */
static int collect_speck(const laves__layer *layer, int32_t first, int32_t part[SPECK_MAX]) {
  int count = 1;
  part[0] = first;
  for (int head = 0; head < count; head++) {
    if (has_inner_vertex(layer, part[head])) return 0;
    for (int k = 0; k < 4; k++) {
      const int32_t next = laves__layer_across(layer, part[head], k);
      bool known = next < 0;
      for (int i = 0; i < count && !known; i++) known = part[i] == next;
      if (known) continue;
      if (count == SPECK_MAX) return 0;
      part[count++] = next;
    }
  }
  return count;
}

size_t laves__layer_drop_specks(laves__layer *layer) {
  size_t alive = 0, specks = 0;
  for (size_t t = 0; t < layer->tet_count; t++) alive += layer->tet[t][0] >= 0;
  for (size_t t = 0; t < layer->tet_count; t++) {
    int32_t part[SPECK_MAX];
    if (layer->tet[t][0] < 0 || has_inner_vertex(layer, (int32_t)t)) continue;
    const int count = collect_speck(layer, (int32_t)t, part);
    if (count == 0 || (size_t)count == alive) continue;
    for (int i = 0; i < count; i++) {
      for (int k = 0; k < 4; k++) laves__star_remove(&layer->star[layer->tet[part[i]][k]], part[i]);
      layer->tet[part[i]][0] = -1;
    }
    alive -= (size_t)count;
    specks++;
  }
  return specks;
}
