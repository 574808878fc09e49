/* Which tets are outside a window of dihedral angles and volume-length ratio, and how bent the surface is there.
 *
 * How bad a tet is, is the largest share by which it leaves a limit of what there is to leave: 0 at the limit, 1 for an
 * angle of 0 or 180 degrees or a ratio of 0. Tets without measurable angles are the worst. */
#include <string.h>

#include "certify/certify.h"
#include "mesh/quality.h"

enum { BLOCK_TETS = 4096 };

#define DEGREES 57.295779513082323
#define UNMEASURABLE 2.0

typedef struct window {
  const laves_mesh *mesh;
  const laves_domain *domain;
  double min_dihedral, max_dihedral, volume_length;
  double cos_least, cos_most; /* of the window, widened a little: within them no exact angle is needed */
  size_t *starts;             /* [blocks + 1] */
  laves__keyed *found;        /* key: badness, worst lowest; value: tet */
  laves_place *places;
} window;

/* The part of the way from limit to end that value has gone; not positive within the limit. */
static double share(double value, double limit, double end) { return limit == end ? 0 : (value - limit) / (end - limit); }

/* How bad a tet is, 0 or less when it is within the window; *value: what makes it so. */
static double badness(const window *w, const laves__vec3 p[4], double *value) {
  double cosines[6], most = -INFINITY, least = INFINITY;
  laves__tet_dihedral_cosines(p, cosines);
  *value = 0;
  for (int i = 0; i < 6; i++) {
    if (!isfinite(cosines[i])) return UNMEASURABLE;
    most = fmax(most, cosines[i]);
    least = fmin(least, cosines[i]);
  }
  const double ratio = laves__tet_volume_length(p);
  if (most < w->cos_least && least > w->cos_most && ratio >= w->volume_length) return 0;
  const double small = acos(fmin(1, most)) * DEGREES, large = acos(fmax(-1, least)) * DEGREES;
  const double below = share(small, w->min_dihedral, 0), above = share(large, w->max_dihedral, 180);
  const double thin = share(ratio, w->volume_length, 0);
  *value = above > 0 && above >= below ? large : below > 0 ? small : ratio;
  return fmax(fmax(below, above), thin);
}

static bool measure(const window *w, size_t tet, double *bad, double *value) {
  laves__vec3 p[4];
  if (!laves__tet_corners(w->mesh, tet, p)) {
    *bad = UNMEASURABLE;
    *value = 0;
    return true;
  }
  *bad = badness(w, p, value);
  return *bad > 0;
}

static void count_blocks(void *user, size_t begin, size_t end, int worker) {
  window *w = user;
  double bad, value;
  (void)worker;
  for (size_t b = begin; b < end; b++) {
    w->starts[b + 1] = 0;
    for (size_t t = b * BLOCK_TETS; t < (b + 1) * BLOCK_TETS && t < w->mesh->tet_count; t++)
      w->starts[b + 1] += measure(w, t, &bad, &value);
  }
}

/* Keys fall as badness grows: the bits of positive doubles are in the order of their values. */
static uint64_t key_of(double bad) {
  uint64_t bits;
  memcpy(&bits, &bad, sizeof bits);
  return ~bits;
}

static void fill_blocks(void *user, size_t begin, size_t end, int worker) {
  window *w = user;
  double bad, value;
  (void)worker;
  for (size_t b = begin; b < end; b++) {
    size_t next = w->starts[b];
    for (size_t t = b * BLOCK_TETS; t < (b + 1) * BLOCK_TETS && t < w->mesh->tet_count; t++)
      if (measure(w, t, &bad, &value)) w->found[next++] = (laves__keyed){key_of(bad), t};
  }
}

static void place_block(void *user, size_t begin, size_t end, int worker) {
  const window *w = user;
  (void)worker;
  for (size_t i = begin; i < end; i++) {
    laves_place *place = &w->places[i];
    const size_t tet = w->found[i].value;
    laves__vec3 p[4];
    double bad, longest = 0;
    *place = (laves_place){.tet = (int64_t)tet, .curvature_radius = NAN};
    measure(w, tet, &bad, &place->value);
    if (!laves__tet_corners(w->mesh, tet, p)) continue;
    const laves__vec3 centroid = v3_scale(v3_add(v3_add(p[0], p[1]), v3_add(p[2], p[3])), 0.25);
    for (int e = 0; e < 6; e++) longest = fmax(longest, v3_distance(p[laves__tet_edge[e][0]], p[laves__tet_edge[e][1]]));
    memcpy(place->place, &centroid, sizeof centroid);
    if (w->domain) place->curvature_radius = laves__curvature_radius(w->domain, centroid, longest);
  }
}

/* Sorts what was found and describes the first `capacity`. */
static laves_result describe(laves_context *context, window *w, size_t count, size_t capacity, laves_error *error) {
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
  const double slack = 1e-9; /* of a cosine, far above its rounding and far below anything that matters */
  window w = {.mesh = mesh,
              .domain = domain,
              .min_dihedral = min_dihedral,
              .max_dihedral = max_dihedral,
              .volume_length = volume_length,
              .places = places};
  w.cos_least = cos(min_dihedral / DEGREES) - slack;
  w.cos_most = cos(max_dihedral / DEGREES) + slack;
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
