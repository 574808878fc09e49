/* Statistics of the tets' shapes.
 *
 * Tets are taken in fixed blocks, whose partial sums are added in order, so the digits do not depend on the threads.
 * Tets with bad indices or points that are not finite are left out, and of a flat tet whatever is not finite; the
 * validity part of the check counts both. */
#include "certify/certify.h"
#include "certify/shape_tally.h"

enum { BLOCK_FACES = 4096 };

typedef struct shapes {
  const laves_mesh *mesh;
  laves__shape_tally *partials;
} shapes;

typedef struct areas {
  const laves__vec3 *points;
  const laves__boundary *boundary;
  double *sums;
} areas;

static void measure_blocks(void *user, size_t begin, size_t end, int worker) {
  const shapes *s = user;
  laves__shape_queue queue;
  laves__shape_queue_clear(&queue); /* lanes that stay empty are measured, too */
  (void)worker;
  for (size_t b = begin; b < end; b++) {
    const size_t first = b * LAVES__TALLY_TETS, last = first + LAVES__TALLY_TETS;
    laves__shape_tally_clear(&s->partials[b]);
    for (size_t t = first; t < last && t < s->mesh->tet_count; t++) {
      laves__vec3 p[4];
      if (laves__tet_corners(s->mesh, t, p)) laves__shape_tally_add(&s->partials[b], &queue, p, t);
    }
    laves__shape_tally_flush(&s->partials[b], &queue);
  }
}

static void area_blocks(void *user, size_t begin, size_t end, int worker) {
  const areas *a = user;
  const laves__vec3 *p = a->points;
  (void)worker;
  for (size_t b = begin; b < end; b++) {
    const size_t first = b * BLOCK_FACES, last = first + BLOCK_FACES;
    a->sums[b] = 0;
    for (size_t i = first; i < last && i < a->boundary->count; i++) {
      const int32_t *f = a->boundary->faces[i];
      const double area = v3_norm(v3_cross(v3_sub(p[f[1]], p[f[0]]), v3_sub(p[f[2]], p[f[0]]))) / 2;
      if (isfinite(area)) a->sums[b] += area;
    }
  }
}

laves_result laves__check_area(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                               laves_check *check, laves_error *error) {
  const size_t block_count = (boundary->count + BLOCK_FACES - 1) / BLOCK_FACES;
  laves_result result = LAVES_OK;
  const areas a = {mesh->points, boundary, laves__alloc(context, block_count, sizeof *a.sums)};
  if (!a.sums) return laves__fail_memory(context, error);
  if (!laves__parallel_for(context, "check", block_count, 1, area_blocks, (void *)&a)) result = laves__fail_cancelled(error);
  for (size_t b = 0; b < block_count && result == LAVES_OK; b++) check->area += a.sums[b];
  laves__free(context, a.sums, block_count, sizeof *a.sums);
  return result;
}

static void report(const shapes *s, size_t block_count, laves_check *check) {
  laves__shape_tally all;
  int64_t worst[LAVES__MEASURES];
  laves__shape_tally_clear(&all);
  for (size_t b = 0; b < block_count; b++) laves__shape_tally_merge(&all, &s->partials[b]);
  laves__shape_tally_report(&all, check);
  laves__shape_tally_worst(&all, worst);
  for (int m = 0; m < LAVES__MEASURES; m++) {
    laves__vec3 p[4];
    const bool known = worst[m] >= 0 && laves__tet_corners(s->mesh, (size_t)worst[m], p);
    laves__shape_tally_place(m, known ? worst[m] : -1, known ? p : NULL, check);
  }
}

laves_result laves__check_shapes(laves_context *context, const laves_mesh *mesh, laves_check *check, laves_error *error) {
  const size_t block_count = (mesh->tet_count + LAVES__TALLY_TETS - 1) / LAVES__TALLY_TETS;
  laves_result result = LAVES_OK;
  const shapes s = {mesh, laves__alloc(context, block_count, sizeof *s.partials)};
  if (!s.partials) return laves__fail_memory(context, error);
  if (laves__parallel_for(context, "check", block_count, 1, measure_blocks, (void *)&s))
    report(&s, block_count, check);
  else
    result = laves__fail_cancelled(error);
  laves__free(context, s.partials, block_count, sizeof *s.partials);
  return result;
}
