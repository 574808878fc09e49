/* Patches that lie on both sides of a crease are split along it.
 *
 *            right of it                      where a crease fades away, or is a slit, the same patch is on its left and
 *      p   . . . . . . . .   p                on its right. The faces beside it become two new patches, left and right; with the
 *         .  =========o   .                   rest of p they go together, as if they were one, but not with each other. So
 *          . . . . . . . .                    vertices of the two sides are kept apart by the crease, and beyond its end by
 *            left of it                       nothing.
 *
 * In: patches and creases.  Out: more patches, and the pairs that go together: those that meet where no crease is, and nowhere at
 * a crease. */
#include "domain/feature_seam.h"

#include <stdlib.h>
#include <string.h>

#include "base/sort.h"

static const double width =
    2.5; /* sizes: how far from the crease the new patches reach: vertices further off have no edge across */

typedef struct splitting {
  const laves__feature_edges *edges;
  const laves__surface *surface;
  laves__features *features;
  int32_t *of_face;
  const int32_t *old; /* [faces] patches before */
  uint32_t *source;   /* [faces] the half-edge of the seam from which a face was reached */
  uint32_t *queue;    /* [faces] */
  size_t queued;
  bool *taken; /* [3 faces] half-edges of seams that have patches */
} splitting;

static bool is_seam(const splitting *w, uint32_t h) {
  return w->edges->is_crease[h] && w->old[h / 3] == w->old[w->surface->across[h] / 3];
}

/* The half-edge of the same crease that goes on where h ends, if one other seam meets there and nothing else. */
static uint32_t next_along(const splitting *w, uint32_t h) {
  const laves__feature_edges *e = w->edges;
  const uint32_t p = laves__half_end(w->surface, h);
  if (e->degree[p] != 2) return LAVES__NONE;
  for (uint32_t k = e->first[p]; k < e->first[p + 1]; k++)
    if (e->is_crease[e->at[k]] && e->at[k] != w->surface->across[h]) return is_seam(w, e->at[k]) ? e->at[k] : LAVES__NONE;
  return LAVES__NONE;
}

static void take_face(splitting *w, uint32_t h, int32_t patch) {
  const uint32_t f = h / 3;
  w->taken[h] = true;
  if (w->of_face[f] != w->old[f]) return; /* beside another stretch of the same, or of another crease */
  w->of_face[f] = patch;
  w->source[f] = h;
  w->queue[w->queued++] = f;
}

/* The faces right beside one crease, from any of its half-edges on, in both directions. */
static void take_crease(splitting *w, uint32_t start) {
  const int32_t left = w->features->patch_count++, right = w->features->patch_count++;
  const uint32_t *across = w->surface->across;
  for (uint32_t h = start; h != LAVES__NONE && !w->taken[h]; h = next_along(w, h)) {
    take_face(w, h, left);
    take_face(w, across[h], right);
  }
  for (uint32_t g = next_along(w, across[start]); g != LAVES__NONE && !w->taken[g]; g = next_along(w, g)) {
    take_face(w, g, right);
    take_face(w, across[g], left);
  }
}

/* Whether a face lies beside the stretch of a crease from which it was reached: near it, and not beyond a loose end. */
static bool lies_beside(const splitting *w, uint32_t f, uint32_t source) {
  const laves__surface *s = w->surface;
  const uint32_t *p = s->faces[f], ends[2] = {laves__half_start(s, source), laves__half_end(s, source)};
  const laves__vec3 c = v3_scale(v3_add(s->points[p[0]], v3_add(s->points[p[1]], s->points[p[2]])), 1.0 / 3);
  const laves__vec3 a = s->points[ends[0]], b = s->points[ends[1]], along = v3_sub(b, a);
  const double length2 = v3_norm2(along), t = length2 > 0 ? v3_dot(v3_sub(c, a), along) / length2 : 0;
  if (t < 0 && w->edges->degree[ends[0]] == 1) return false;
  if (t > 1 && w->edges->degree[ends[1]] == 1) return false;
  return v3_distance(c, v3_mad(a, along, t < 0 ? 0 : t > 1 ? 1 : t)) < width * w->edges->wish->size;
}

/* All sides grow at the same time, face by face. */
static void spread(splitting *w) {
  const laves__surface *s = w->surface;
  for (size_t head = 0; head < w->queued; head++) {
    const uint32_t f = w->queue[head];
    for (uint32_t h = 3 * f; h < 3 * f + 3; h++) {
      const uint32_t g = s->across[h] / 3;
      if (s->across[h] == LAVES__NONE || w->edges->is_crease[h] || w->of_face[g] != w->old[g]) continue;
      if (!lies_beside(w, g, w->source[f])) continue;
      w->of_face[g] = w->of_face[f];
      w->source[g] = w->source[f];
      w->queue[w->queued++] = g;
    }
  }
}

/* ---- pairs ---- */

static uint64_t pair_of(int32_t a, int32_t b) {
  return a < b ? (uint64_t)a << 32 | (uint32_t)b : (uint64_t)b << 32 | (uint32_t)a;
}

/* Pairs of patches that meet at edges that are creases, or are not; sorted, each once. */
static bool list_pairs(const splitting *w, bool at_creases, uint64_t **pairs, size_t *count) {
  const laves__surface *s = w->surface;
  size_t capacity = 0, kept = 0;
  *pairs = NULL;
  *count = 0;
  for (uint32_t h = 0; h < 3 * s->face_count; h++) {
    const uint32_t g = s->across[h];
    if (g == LAVES__NONE || g < h || w->edges->is_crease[h] != at_creases || w->of_face[h / 3] == w->of_face[g / 3]) continue;
    if (!laves__grow(w->edges->context, pairs, &capacity, *count + 1, sizeof **pairs)) return false;
    (*pairs)[(*count)++] = pair_of(w->of_face[h / 3], w->of_face[g / 3]);
  }
  uint64_t *scratch = laves__alloc(w->edges->context, *count, sizeof *scratch);
  const bool done = scratch != NULL;
  if (done) laves__sort_u64(*pairs, scratch, *count);
  laves__free(w->edges->context, scratch, *count, sizeof *scratch);
  for (size_t i = 0; done && i < *count; i++)
    if (i == 0 || (*pairs)[i] != (*pairs)[i - 1]) (*pairs)[kept++] = (*pairs)[i];
  uint64_t *exact = done ? laves__realloc(w->edges->context, *pairs, capacity, kept, sizeof **pairs) : NULL;
  if (!exact) {
    laves__free(w->edges->context, *pairs, capacity, sizeof **pairs);
    *pairs = NULL;
    *count = 0;
    return done && kept == 0;
  }
  *pairs = exact;
  *count = kept;
  return true;
}

/* Those that meet without a crease, less those that meet at one as well. */
static bool find_joined(const splitting *w) {
  laves__features *f = w->features;
  uint64_t *sharp;
  size_t sharp_count, kept = 0;
  if (!list_pairs(w, false, &f->joined, &f->joined_capacity) || !list_pairs(w, true, &sharp, &sharp_count)) return false;
  for (size_t i = 0, k = 0; i < f->joined_capacity; i++) {
    while (k < sharp_count && sharp[k] < f->joined[i]) k++;
    if (k == sharp_count || sharp[k] != f->joined[i]) f->joined[kept++] = f->joined[i];
  }
  f->joined_pairs = kept;
  laves__free(f->context, sharp, sharp_count, sizeof *sharp);
  return true;
}

/* ---- all ---- */

static void split(splitting *w) {
  for (uint32_t h = 0; h < 3 * w->surface->face_count; h++)
    if (is_seam(w, h) && !w->taken[h]) take_crease(w, h);
  spread(w);
}

bool laves__split_seams(const laves__feature_edges *e, int32_t *of_face, laves__features *features) {
  const size_t faces = e->surface->face_count;
  laves_context *context = e->context;
  int32_t *old = laves__alloc(context, faces, sizeof *old);
  splitting w = {.edges = e, .surface = e->surface, .features = features, .of_face = of_face, .old = old};
  w.source = laves__alloc(context, faces, sizeof *w.source);
  w.queue = laves__alloc(context, faces, sizeof *w.queue);
  w.taken = laves__alloc_zeroed(context, 3 * faces, sizeof *w.taken);
  bool done = old && w.source && w.queue && w.taken;
  if (done) {
    const int32_t before = features->patch_count;
    memcpy(old, of_face, faces * sizeof *old);
    split(&w);
    if (features->patch_count > before) done = find_joined(&w);
  }
  laves__free(context, old, faces, sizeof *old);
  laves__free(context, w.source, faces, sizeof *w.source);
  laves__free(context, w.queue, faces, sizeof *w.queue);
  laves__free(context, w.taken, 3 * faces, sizeof *w.taken);
  return done;
}
