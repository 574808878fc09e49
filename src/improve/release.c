/* Where creases come closer to one another than the size allows, no arrangement of their vertices has good angles. There some go:
 * the surface is rounded at that place, and the report says so. */
#include "improve/release.h"

#include "improve/measure.h"

static laves__measure measure_for(const laves__frame *frame, const laves__window *window, const laves__layer *layer) {
  laves__measure m = laves__measure_of(window);
  m.sharper_than = window->min_dihedral;
  if (layer->hold) m.sharp = frame->features;
  return m;
}

static bool is_outside(const laves__measure *m, const laves__layer *layer, size_t t) {
  return layer->tet[t][0] >= 0 && laves__layer_is_fresh(layer, (int32_t)t) && laves__layer_quality(m, layer, (int32_t)t) < 1;
}

size_t laves__mark_forced(const laves__frame *frame, double sharper_than, const laves__layer *layer, bool *forced) {
  size_t count = 0;
  for (size_t t = 0; t < layer->tet_count && !laves__cancelled_at(layer->context, "improve", t, layer->tet_count); t++) {
    forced[t] = layer->hold && layer->tet[t][0] >= 0 && laves__fixed_edges(frame->features, sharper_than, layer, (int32_t)t);
    count += forced[t];
  }
  return count;
}

static bool shall_go(const laves__layer *layer, int32_t v, laves__release what) {
  if (layer->depth[v] != 0 || (layer->fresh && !layer->fresh[v])) return false;
  const uint8_t kind = layer->hold[v].kind;
  if (kind < LAVES__HOLD_CREASE) return false;
  if (what == LAVES__RELEASE_OFF) return layer->off_surface[v];
  return kind == LAVES__HOLD_CREASE || what >= LAVES__RELEASE_CORNERS;
}

static size_t release_tet(laves__layer *layer, size_t t, laves__release what) {
  size_t count = 0;
  for (int k = 0; k < 4; k++) {
    const int32_t v = layer->tet[t][k];
    if (!shall_go(layer, v, what)) continue;
    layer->hold[v] = (laves__hold){0, LAVES__HOLD_SURFACE};
    layer->off_surface[v] = true; /* its normal is that of no surface: it is settled on to it */
    count++;
  }
  return count;
}

static size_t release_at(laves__layer *layer, size_t t, laves__release what) {
  size_t count = release_tet(layer, t, what);
  for (int k = 0; k < 4 && what == LAVES__RELEASE_AROUND; k++) {
    const laves__star *star = &layer->star[layer->tet[t][k]];
    for (int i = 0; i < star->count; i++) count += release_tet(layer, (size_t)star->tet[i], what);
  }
  return count;
}

/* One after the other, as what is let go of changes which angles are fixed. Few are outside: many are measured at once as if none
 * was fixed, which makes none look better, and only those that are outside then are measured again. */
size_t laves__release_features(const laves__frame *frame, const laves__window *window, laves__release what, laves__layer *layer) {
  enum { PART = 256 };
  const laves__measure m = measure_for(frame, window, layer), plain = laves__measure_of(window);
  size_t count = 0;
  for (size_t first = 0; first < layer->tet_count; first += PART) {
    double quality[PART];
    const size_t last = layer->tet_count - first < PART ? layer->tet_count : first + PART;
    if (laves__cancelled(layer->context, "improve", (double)first / (double)layer->tet_count)) break;
    laves__measure_tets(&plain, layer, first, last, quality);
    for (size_t t = first; t < last; t++)
      if (layer->tet[t][0] >= 0 && quality[t - first] < 1 && is_outside(&m, layer, t)) count += release_at(layer, t, what);
  }
  return count;
}
