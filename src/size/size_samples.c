/* What the surface asks for, sampled.
 *
 * In: a bound size field.  Out: points of the surface with the sizes that curvature, thickness, distance and close creases ask
 * for there.
 *
 * The surface starts as large patches. Each is asked at its middle; one that is wide against the size that it got, or against
 * the ceiling, is parted, and its parts are asked again, down to the floor. So samples are dense where sizes are small, and only
 * there. All patches of one round are asked in parallel. In the end one sample is kept, the least, in each cell of a grid as
 * fine as its size. */
#include <stdlib.h>

#include "size/size_parts.h"

/* A triangle of edge h with its corners on a sphere of curvature k lies h^2 k / 6 below it in its middle (on a cylinder at
 * most h^2 k / 8); with k the larger curvature, that is the distance of a boundary face. */
static const double sagitta_factor = 6;
/* Floors down to which a jump of the normal is followed: a bend that asks for the floor is seen from there. */
static const double crease_scale = 3;
static const double two_pi = 6.283185307179586;
enum {
  PATCH_BATCH = 64,
  PATCHES_MAX = 1 << 25, /* of one round: there would be as many boundary faces, and many times as many tets */
};
/* Floors in the diagonal of the domain, at most: the octree has no more levels. */
static const double finest_floor = 1 << 18;

typedef struct sampling {
  const laves__size *size;
  laves__curvature curvature;
  laves__patch *patches; /* of this round */
  size_t count;
  double *sizes;  /* of patches; INFINITY: nothing is asked */
  uint8_t *parts; /* how many parts each is to have, then has */
  laves__patch *next;
  size_t *starts; /* of the parts of each patch in next */
  laves__size_sample *samples;
  size_t sample_count, sample_capacity;
} sampling;

/* ---- one round ---- */

static double size_by_curvature(const laves__size *s, double curvature) {
  double size = INFINITY;
  if (!(curvature > 0)) return size;
  if (s->curvature_elements > 0) size = two_pi / (curvature * s->curvature_elements);
  if (s->max_distance > 0) size = fmin(size, sqrt(sagitta_factor * s->max_distance / curvature));
  return size;
}

static double ask(const sampling *a, const laves__patch *p, bool *unresolved) {
  const laves__size *s = a->size;
  const laves__surface *surface = s->oracle->surface;
  double size = INFINITY;
  *unresolved = false;
  if (surface && surface->needs_winding && !laves__surface_bounds_at(surface, p->face, p->point)) return size;
  if (s->curvature_elements > 0 || s->max_distance > 0)
    size = size_by_curvature(s, laves__curvature_at(&a->curvature, p, unresolved));
  if (s->thickness_elements > 0) {
    const double n = s->thickness_elements;
    size = fmin(size, laves__thickness_at(s, p, n * s->ceiling) / n);
  }
  return fmax(size, s->floor);
}

static void ask_range(void *user, size_t begin, size_t end, int worker) {
  sampling *a = user;
  (void)worker;
  for (size_t i = begin; i < end; i++) {
    const laves__patch *p = &a->patches[i];
    bool unresolved;
    a->sizes[i] = ask(a, p, &unresolved);
    const double wanted = unresolved ? crease_scale * a->size->floor : fmin(a->sizes[i], a->size->base);
    const bool wide = p->width > LAVES__SAMPLE_SPACING * wanted;
    a->parts[i] = (uint8_t)(!wide ? 0 : p->face == LAVES__NONE ? LAVES__PATCH_PARTS : 2);
  }
}

static void part_range(void *user, size_t begin, size_t end, int worker) {
  sampling *a = user;
  (void)worker;
  for (size_t i = begin; i < end; i++) {
    if (a->parts[i] == 0) continue;
    laves__patch parts[LAVES__PATCH_PARTS];
    a->parts[i] = (uint8_t)laves__patch_part(a->size->oracle, &a->patches[i], parts);
    for (size_t k = 0; k < a->parts[i]; k++) a->next[a->starts[i] + k] = parts[k];
  }
}

/* Parts that were not found leave holes; they are closed in order. */
static size_t close_holes(sampling *a) {
  size_t count = 0;
  for (size_t i = 0; i < a->count; i++)
    for (size_t k = 0; k < a->parts[i]; k++) a->next[count++] = a->next[a->starts[i] + k];
  return count;
}

static laves_result keep_samples(sampling *a, laves_error *error) {
  const laves__size *s = a->size;
  size_t asked = 0;
  for (size_t i = 0; i < a->count; i++) asked += a->sizes[i] < s->ceiling;
  if (!laves__grow(s->context, &a->samples, &a->sample_capacity, a->sample_count + asked, sizeof *a->samples))
    return laves__fail_memory(s->context, error);
  for (size_t i = 0; i < a->count; i++)
    if (a->sizes[i] < s->ceiling) a->samples[a->sample_count++] = (laves__size_sample){a->patches[i].point, a->sizes[i]};
  return LAVES_OK;
}

/* Makes the next round's patches. */
static laves_result part_patches(sampling *a, laves_error *error) {
  laves_context *context = a->size->context;
  size_t total = 0;
  for (size_t i = 0; i < a->count; i++) {
    a->starts[i] = total;
    total += a->parts[i];
  }
  if (total > PATCHES_MAX)
    return laves__fail(error, LAVES_ERROR_OPTION,
                       "the surface asks for sizes at more than %d places; choose a larger smallest size", PATCHES_MAX);
  a->next = laves__alloc(context, total, sizeof *a->next);
  if (!a->next && total > 0) return laves__fail_memory(context, error);
  if (!laves__parallel_for(context, "size", a->count, PATCH_BATCH, part_range, a)) {
    laves__free(context, a->next, total, sizeof *a->next);
    return laves__fail_cancelled(error);
  }
  const size_t kept = close_holes(a);
  laves__free(context, a->patches, a->count, sizeof *a->patches);
  a->patches = NULL;
  a->count = 0;
  laves__patch *fitting = kept == total ? a->next : laves__realloc(context, a->next, total, kept, sizeof *a->next);
  if (kept > 0 && !fitting) {
    laves__free(context, a->next, total, sizeof *a->next);
    return laves__fail_memory(context, error);
  }
  a->patches = fitting;
  a->count = kept;
  return LAVES_OK;
}

static laves_result do_round(sampling *a, laves_error *error) {
  laves_context *context = a->size->context;
  const size_t count = a->count;
  laves_result result = LAVES_OK;
  a->sizes = laves__alloc(context, count, sizeof *a->sizes);
  a->parts = laves__alloc(context, count, sizeof *a->parts);
  a->starts = laves__alloc(context, count, sizeof *a->starts);
  if (!a->sizes || !a->parts || !a->starts) result = laves__fail_memory(context, error);
  if (result == LAVES_OK && !laves__parallel_for(context, "size", count, PATCH_BATCH, ask_range, a))
    result = laves__fail_cancelled(error);
  if (result == LAVES_OK) result = keep_samples(a, error);
  if (result == LAVES_OK) result = part_patches(a, error);
  laves__free(context, a->sizes, count, sizeof *a->sizes);
  laves__free(context, a->parts, count, sizeof *a->parts);
  laves__free(context, a->starts, count, sizeof *a->starts);
  return result;
}

/* ---- thinning ---- */

typedef struct keyed {
  uint64_t cell;
  double size;
  size_t index;
} keyed;

static int compare_keyed(const void *a, const void *b) {
  const keyed *x = a, *y = b;
  if (x->cell != y->cell) return x->cell < y->cell ? -1 : 1;
  if (x->size != y->size) return x->size < y->size ? -1 : 1;
  return x->index < y->index ? -1 : x->index > y->index;
}

static uint64_t mix(uint64_t hash, uint64_t value) {
  hash = (hash ^ value) * 0x9e3779b97f4a7c15u;
  return hash ^ hash >> 29;
}

/* Cells of the power of two of the floor that is next below the sample's spacing. */
static uint64_t cell_of(const laves__size *s, const laves__size_sample *sample) {
  double side = LAVES__SAMPLE_SPACING * s->floor;
  uint64_t hash = 1;
  for (; 2 * side <= LAVES__SAMPLE_SPACING * sample->size; side *= 2) hash++;
  const laves__vec3 p = v3_sub(sample->point, s->oracle->bounds.lower);
  hash = mix(mix(hash, (uint64_t)(int64_t)floor(p.x / side)), (uint64_t)(int64_t)floor(p.y / side));
  return mix(hash, (uint64_t)(int64_t)floor(p.z / side));
}

/* samples: in and out, in a block of *capacity. */
static laves_result thin(const laves__size *s, laves__size_sample **samples, size_t *count, size_t *capacity,
                         laves_error *error) {
  laves_context *context = s->context;
  laves_result result = LAVES_OK;
  size_t kept = 0;
  laves__size_sample *left = NULL;
  keyed *keys = laves__alloc(context, *count, sizeof *keys);
  if (!keys) return laves__fail_memory(context, error);
  for (size_t i = 0; i < *count; i++) keys[i] = (keyed){cell_of(s, &(*samples)[i]), (*samples)[i].size, i};
  qsort(keys, *count, sizeof *keys, compare_keyed);
  for (size_t i = 0; i < *count; i++)
    if (i == 0 || keys[i].cell != keys[i - 1].cell) keys[kept++] = keys[i];
  left = laves__alloc(context, kept, sizeof *left);
  if (!left) result = laves__fail_memory(context, error);
  for (size_t i = 0; left && i < kept; i++) left[i] = (*samples)[keys[i].index];
  laves__free(context, keys, *count, sizeof *keys);
  laves__free(context, *samples, *capacity, sizeof **samples);
  *samples = left;
  *count = *capacity = left ? kept : 0;
  return result;
}

/* ---- the whole ---- */

static laves_result sample_patches(sampling *a, laves_error *error) {
  const laves__size *s = a->size;
  laves_result result =
      laves__patches_of_domain(s->context, s->domain, LAVES__SAMPLE_SPACING * s->base, &a->patches, &a->count, error);
  if (result == LAVES_OK && (s->curvature_elements > 0 || s->max_distance > 0))
    result = laves__curvature_build(s, &a->curvature, error);
  while (result == LAVES_OK && a->count > 0) result = do_round(a, error);
  laves__free(s->context, a->patches, a->count, sizeof *a->patches);
  laves__curvature_free(&a->curvature);
  return result;
}

laves_result laves__size_samples(const laves__size *size, laves__size_sample **samples, size_t *count, laves_error *error) {
  sampling a = {.size = size};
  laves_result result = LAVES_OK;
  const double diagonal = box3_diagonal(size->oracle->bounds);
  *samples = NULL;
  *count = 0;
  if (diagonal > finest_floor * size->floor)
    return laves__fail(error, LAVES_ERROR_OPTION,
                       "sizes from %g on are too small for a solid that is %g wide; choose a larger smallest size", size->floor,
                       diagonal);
  if (size->curvature_elements > 0 || size->max_distance > 0 || size->thickness_elements > 0) result = sample_patches(&a, error);
  if (result == LAVES_OK && size->feature_elements > 0)
    result = laves__feature_samples(size, &a.samples, &a.sample_count, &a.sample_capacity, error);
  if (result == LAVES_OK && a.sample_count > 0) {
    result = thin(size, &a.samples, &a.sample_count, &a.sample_capacity, error);
  }
  if (result != LAVES_OK || a.sample_count == 0) {
    laves__free(size->context, a.samples, a.sample_capacity, sizeof *a.samples);
    return result;
  }
  *samples = a.samples;
  *count = a.sample_count;
  return LAVES_OK;
}
