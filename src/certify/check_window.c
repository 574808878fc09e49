/* Which tets are outside a window of dihedral angles and volume-length ratio, and how bent the surface is there. */
#include <string.h>

#include "certify/certify.h"
#include "certify/window.h"
#include "mesh/quality.h"

enum { BLOCK_TETS = 4096 };

typedef struct search {
  const laves_mesh *mesh;
  const laves_domain *domain;
  laves__window limits;
  size_t *starts;      /* [blocks + 1] */
  laves__keyed *found; /* key: badness, worst lowest; value: tet */
  laves_place *places;
} search;

static bool measure(const search *w, size_t tet, double *bad, double *value) {
  laves__vec3 p[4];
  if (!laves__tet_corners(w->mesh, tet, p)) {
    *bad = LAVES__UNMEASURABLE;
    *value = 0;
    return true;
  }
  *bad = laves__window_badness(&w->limits, p, value);
  return *bad > 0;
}

static void count_blocks(void *user, size_t begin, size_t end, int worker) {
  search *w = user;
  double bad, value;
  (void)worker;
  for (size_t b = begin; b < end; b++) {
    w->starts[b + 1] = 0;
    for (size_t t = b * BLOCK_TETS; t < (b + 1) * BLOCK_TETS && t < w->mesh->tet_count; t++)
      w->starts[b + 1] += measure(w, t, &bad, &value);
  }
}

static void fill_blocks(void *user, size_t begin, size_t end, int worker) {
  search *w = user;
  double bad, value;
  (void)worker;
  for (size_t b = begin; b < end; b++) {
    size_t next = w->starts[b];
    for (size_t t = b * BLOCK_TETS; t < (b + 1) * BLOCK_TETS && t < w->mesh->tet_count; t++)
      if (measure(w, t, &bad, &value)) w->found[next++] = (laves__keyed){laves__badness_key(bad), t};
  }
}

void laves__place_of_tet(const laves__vec3 p[4], const laves_domain *domain, laves_place *place) {
  const laves__vec3 centroid = v3_scale(v3_add(v3_add(p[0], p[1]), v3_add(p[2], p[3])), 0.25);
  double longest = 0;
  for (int e = 0; e < 6; e++) longest = fmax(longest, v3_distance(p[laves__tet_edge[e][0]], p[laves__tet_edge[e][1]]));
  memcpy(place->place, &centroid, sizeof centroid);
  if (domain) place->curvature_radius = laves__curvature_radius(domain, centroid, longest);
}

static void place_block(void *user, size_t begin, size_t end, int worker) {
  const search *w = user;
  (void)worker;
  for (size_t i = begin; i < end; i++) {
    laves_place *place = &w->places[i];
    const size_t tet = w->found[i].value;
    laves__vec3 p[4];
    double bad;
    *place = (laves_place){.tet = (int64_t)tet, .curvature_radius = NAN};
    measure(w, tet, &bad, &place->value);
    if (!laves__tet_corners(w->mesh, tet, p)) continue;
    laves__place_of_tet(p, w->domain, place);
  }
}

/* Sorts what was found and describes the first `capacity`. */
static laves_result describe(laves_context *context, search *w, size_t count, size_t capacity, laves_error *error) {
  laves__keyed *scratch = laves__alloc(context, count, sizeof *scratch);
  if (!scratch) return laves__fail_memory(context, error);
  laves__sort_keyed(NULL, w->found, scratch, count);
  laves__free(context, scratch, count, sizeof *scratch);
  if (laves__parallel_for(context, "check", count < capacity ? count : capacity, 16, place_block, w)) return LAVES_OK;
  return laves__fail_cancelled(error);
}

laves_result laves_check_window(laves_context *context, const laves_mesh *mesh, const laves_domain *domain, double min_dihedral,
                                double max_dihedral, double volume_length, laves_place *places, size_t capacity, size_t *count,
                                laves_error *error) {
  const laves_result held = laves__mesh_require_arrays(mesh, "a check", error);
  if (held != LAVES_OK) return held;
  laves__progress_reset(context);
  *count = 0;
  search w = {
      .mesh = mesh, .domain = domain, .limits = laves__window_make(min_dihedral, max_dihedral, volume_length), .places = places};
  const size_t blocks = (mesh->tet_count + BLOCK_TETS - 1) / BLOCK_TETS;
  size_t found = 0;
  laves_result result = LAVES_OK;
  w.starts = laves__alloc(context, blocks + 1, sizeof *w.starts);
  if (!w.starts) return laves__fail_memory(context, error);
  if (!laves__parallel_for(context, "check", blocks, 1, count_blocks, &w)) {
    result = laves__fail_cancelled(error);
    goto clean_up;
  }
  w.starts[0] = 0;
  for (size_t b = 0; b < blocks; b++) w.starts[b + 1] += w.starts[b];
  found = w.starts[blocks];
  w.found = laves__alloc(context, found, sizeof *w.found);
  if (!w.found) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  if (laves__parallel_for(context, "check", blocks, 1, fill_blocks, &w))
    result = describe(context, &w, found, capacity, error);
  else
    result = laves__fail_cancelled(error);
  if (result == LAVES_OK) *count = found;
clean_up:
  laves__free(context, w.found, found, sizeof *w.found);
  laves__free(context, w.starts, blocks + 1, sizeof *w.starts);
  return result;
}
