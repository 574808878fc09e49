/* The stage as a whole; keep.h tells its steps. */
#include "features/keep.h"

#include <string.h>

static const double place_reach = 4; /* local sizes: beyond, a place is of no use */

/* ---- what the steps share ---- */

bool laves__held_place(const laves__keeping *k, int32_t vertex, laves__hold hold, laves__vec3 *place) {
  laves__vec3 direction;
  uint32_t hint = k->layer->hint[vertex];
  return laves__frame_project_held(k->frame, hold, k->start[vertex], place_reach * laves__layer_scale(k->layer, vertex), &hint,
                                   place, &direction);
}

bool laves__edge_is_legal(const laves__keeping *k, int32_t from, int32_t to) {
  const laves__hold *hold = k->layer->hold;
  const int32_t a = from < to ? from : to, b = from < to ? to : from; /* one answer for both ways */
  int32_t crease;
  if (!laves__holds_meet(k->features, hold[a], hold[b])) return false;
  if (!k->features->has_seams || hold[a].kind != LAVES__HOLD_PATCH || hold[b].kind != LAVES__HOLD_PATCH) return true;
  return !laves__way_crosses_seam(k->frame, k->start[a], k->start[b], hold[a].id, k->layer->normal[a], k->layer->normal[b],
                                  &crease);
}

void laves__face_holds(const laves__keeping *k, uint32_t face, laves__hold hold[3]) {
  for (int j = 0; j < 3; j++) hold[j] = k->layer->hold[k->rim.face[face][j]];
}

int laves__illegal_around(const laves__keeping *k, int32_t vertex) {
  const laves__rim *rim = &k->rim;
  int count = 0;
  for (uint32_t i = rim->first[vertex]; i < rim->first[vertex + 1]; i++) {
    laves__hold hold[3];
    laves__face_holds(k, rim->at[i], hold);
    count += !laves__face_is_legal(k->features, hold);
    count += !laves__edge_is_legal(k, vertex, laves__rim_next(rim, rim->at[i], vertex));
  }
  return count;
}

/* ---- the stage ---- */

/* Every boundary vertex belongs to the patch on which its foot lies. */
static void hold_to_patches(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const laves__keeping *k = user;
  const laves__features *f = k->features;
  for (size_t v = begin; v < end; v++) {
    k->start[v] = k->layer->position[v];
    k->start_patch[v] = LAVES__NO_FEATURE;
    k->layer->hold[v] = (laves__hold){0, LAVES__HOLD_SURFACE};
    if (k->layer->depth[v] != 0 || k->rim.first[v] == k->rim.first[v + 1] || (k->free && k->free[v])) continue;
    const int32_t patch = f->patch_at(f->self, laves__frame_to_local(k->frame, k->start[v]), k->layer->hint[v]);
    if (patch == LAVES__NO_FEATURE) continue;
    k->start_patch[v] = patch;
    k->layer->hold[v] = (laves__hold){patch, LAVES__HOLD_PATCH};
  }
}

static void count_kept(const laves__keeping *k, laves__kept_counts *counts) {
  for (size_t c = 0; c < k->features->corner_count; c++) counts->corners_lost += k->claimed[c] == LAVES__NO_FEATURE;
  for (size_t v = 0; v < k->rim.vertex_count; v++) counts->crease_vertices += k->layer->hold[v].kind == LAVES__HOLD_CREASE;
  for (uint32_t f = 0; f < k->rim.face_count; f++) {
    laves__hold hold[3];
    laves__face_holds(k, f, hold);
    counts->illegal_faces += !laves__face_is_legal(k->features, hold);
  }
}

static laves_result keep(laves__keeping *k, laves__kept_counts *counts, laves_error *error) {
  if (!laves__parallel_for(k->context, "features", k->rim.vertex_count, 256, hold_to_patches, k))
    return laves__fail_cancelled(error);
  if (!laves__claim_corners(k) || !laves__cover_creases(k) || !laves__prune_creases(k))
    return laves__fail_memory(k->context, error);
  laves__mend_faces(k);
  laves__place_held(k, &counts->off_feature);
  count_kept(k, counts);
  return laves__cancelled(k->context, "features", 1) ? laves__fail_cancelled(error) : LAVES_OK;
}

laves_result laves__keep_features(const laves__frame *frame, const bool *free, bool is_last, laves__layer *layer,
                                  laves__kept_counts *counts, laves_error *error) {
  laves_context *context = layer->context;
  const laves__features *f = frame->features;
  const size_t vertices = layer->vertex_count;
  laves__keeping k = {.context = context, .frame = frame, .features = f, .layer = layer, .free = free, .is_last = is_last};
  *counts = (laves__kept_counts){0};
  laves_result result = laves__rim_make(layer, &k.rim, error);
  k.start = laves__alloc(context, vertices, sizeof *k.start);
  k.start_patch = laves__alloc(context, vertices, sizeof *k.start_patch);
  k.claimed = laves__alloc(context, f->corner_count, sizeof *k.claimed);
  layer->hold = laves__alloc(context, vertices, sizeof *layer->hold);
  if (result == LAVES_OK && (!k.start || !k.start_patch || !k.claimed || !layer->hold))
    result = laves__fail_memory(context, error);
  if (result == LAVES_OK) result = keep(&k, counts, error);
  laves__rim_free(&k.rim);
  laves__free(context, k.start, vertices, sizeof *k.start);
  laves__free(context, k.start_patch, vertices, sizeof *k.start_patch);
  laves__free(context, k.claimed, f->corner_count, sizeof *k.claimed);
  return result;
}
