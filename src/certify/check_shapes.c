/* Statistics of the tets' shapes.
 *
 * Tets are taken in fixed blocks, whose partial sums are added in order, so the digits do not depend on the threads.
 * Sums for means and deviations are taken relative to the value that is typical of the tiling, against cancellation.
 * Tets with bad indices or points that are not finite are left out, and of a flat tet whatever is not finite; the
 * validity part of the check counts both. */
#include <string.h>

#include "certify/certify.h"
#include "mesh/shape_batch.h"

enum {
  BLOCK_TETS = 4096,
  BLOCK_FACES = 4096,
  MIN_DIHEDRAL = 0,
  MAX_DIHEDRAL,
  RADIUS_RATIO,
  RADIUS_EDGE,
  VOLUME_LENGTH,
  MEASURES
};

#define DEGREES 57.295779513082323
/* An angle this little below a bin's lower edge belongs there: exact tiles have angles of 60 degrees, give or take a
 * rounding error of about 1e-13. */
#define BIN_SLACK 1e-9

/* What the sums are relative to. */
static const double origin[MEASURES] = {60, 72, 1, 1, 1};

typedef struct tally {
  size_t count;
  double min, max, sum, squares;
  size_t min_tet, max_tet;
} tally;

typedef struct partial {
  tally measures[MEASURES];
  size_t histogram[LAVES_HISTOGRAM_BINS];
  double volume;
} partial;

typedef struct shapes {
  const laves_mesh *mesh;
  const laves__boundary *boundary;
  partial *partials;
  double *areas;
} shapes;

/* ---- one block ---- */

static void tally_clear(tally *t) { *t = (tally){.min = INFINITY, .max = -INFINITY}; }

static void tally_add(tally *t, double value, double relative_to, size_t tet) {
  if (!isfinite(value)) return;
  if (value < t->min) {
    t->min = value;
    t->min_tet = tet;
  }
  if (value > t->max) {
    t->max = value;
    t->max_tet = tet;
  }
  const double shifted = value - relative_to;
  t->count++;
  t->sum += shifted;
  t->squares += shifted * shifted;
}

static void add_angles(partial *part, const laves__shape_batch *batch, int lane, size_t tet) {
  double least = INFINITY, most = -INFINITY;
  for (int i = 0; i < 6; i++)
    if (!isfinite(batch->cosine[i][lane])) return;
  for (int i = 0; i < 6; i++) {
    const double cosine = batch->cosine[i][lane];
    const double angle = acos(cosine > 1 ? 1 : cosine < -1 ? -1 : cosine) * DEGREES;
    const int bin = (int)((angle + BIN_SLACK) / (180.0 / LAVES_HISTOGRAM_BINS));
    part->histogram[bin < LAVES_HISTOGRAM_BINS ? bin : LAVES_HISTOGRAM_BINS - 1]++;
    if (angle < least) least = angle;
    if (angle > most) most = angle;
  }
  tally_add(&part->measures[MIN_DIHEDRAL], least, origin[MIN_DIHEDRAL], tet);
  tally_add(&part->measures[MAX_DIHEDRAL], most, origin[MAX_DIHEDRAL], tet);
}

/* tets[lane]: which tet stands in a lane. */
static void add_batch(partial *part, laves__shape_batch *batch, const size_t *tets, int count) {
  laves__shape_batch_measure(batch);
  for (int lane = 0; lane < count; lane++) {
    add_angles(part, batch, lane, tets[lane]);
    tally_add(&part->measures[RADIUS_RATIO], batch->radius_ratio[lane], origin[RADIUS_RATIO], tets[lane]);
    tally_add(&part->measures[RADIUS_EDGE], batch->radius_edge[lane], origin[RADIUS_EDGE], tets[lane]);
    tally_add(&part->measures[VOLUME_LENGTH], batch->volume_length[lane], origin[VOLUME_LENGTH], tets[lane]);
    part->volume += batch->determinant[lane] / 6;
  }
}

static void measure_block(const shapes *s, partial *part, size_t begin, size_t end) {
  laves__shape_batch batch;
  size_t tets[LAVES__SHAPE_BATCH];
  int count = 0;
  memset(&batch.corner, 0, sizeof batch.corner); /* lanes that stay empty are measured, too */
  memset(part, 0, sizeof *part);
  for (int m = 0; m < MEASURES; m++) tally_clear(&part->measures[m]);
  for (size_t t = begin; t < end; t++) {
    laves__vec3 p[4];
    if (!laves__tet_corners(s->mesh, t, p)) continue;
    laves__shape_batch_set(&batch, count, p);
    tets[count++] = t;
    if (count < LAVES__SHAPE_BATCH) continue;
    add_batch(part, &batch, tets, count);
    count = 0;
  }
  if (count > 0) add_batch(part, &batch, tets, count);
}

static void measure_blocks(void *user, size_t begin, size_t end, int worker) {
  const shapes *s = user;
  (void)worker;
  for (size_t b = begin; b < end; b++) {
    const size_t first = b * BLOCK_TETS, last = first + BLOCK_TETS;
    measure_block(s, &s->partials[b], first, last < s->mesh->tet_count ? last : s->mesh->tet_count);
  }
}

static void area_blocks(void *user, size_t begin, size_t end, int worker) {
  const shapes *s = user;
  const laves__vec3 *p = s->mesh->points;
  (void)worker;
  for (size_t b = begin; b < end; b++) {
    const size_t first = b * BLOCK_FACES, last = first + BLOCK_FACES;
    s->areas[b] = 0;
    for (size_t i = first; i < last && i < s->boundary->count; i++) {
      const int32_t *f = s->boundary->faces[i];
      const double area = v3_norm(v3_cross(v3_sub(p[f[1]], p[f[0]]), v3_sub(p[f[2]], p[f[0]]))) / 2;
      if (isfinite(area)) s->areas[b] += area;
    }
  }
}

/* ---- all blocks ---- */

static void tally_merge(tally *into, const tally *more) {
  if (more->min < into->min) {
    into->min = more->min;
    into->min_tet = more->min_tet;
  }
  if (more->max > into->max) {
    into->max = more->max;
    into->max_tet = more->max_tet;
  }
  into->count += more->count;
  into->sum += more->sum;
  into->squares += more->squares;
}

static laves_statistic statistic(const tally *t, double relative_to) {
  if (t->count == 0) return (laves_statistic){0};
  const double count = (double)t->count, mean = t->sum / count;
  const double variance = t->squares / count - mean * mean;
  return (laves_statistic){t->min, t->max, relative_to + mean, sqrt(fmax(0, variance))};
}

/* Names the tet and its centroid; -1 when none could be measured. */
static void set_place(const laves_mesh *mesh, const tally *t, size_t tet, int64_t *index, double place[3]) {
  laves__vec3 p[4];
  *index = -1;
  if (t->count == 0 || !laves__tet_corners(mesh, tet, p)) return;
  const laves__vec3 centroid = v3_scale(v3_add(v3_add(p[0], p[1]), v3_add(p[2], p[3])), 0.25);
  *index = (int64_t)tet;
  memcpy(place, &centroid, sizeof centroid);
}

static void set_places(const laves_mesh *mesh, const tally measures[MEASURES], laves_check *check) {
  const tally *least = &measures[MIN_DIHEDRAL], *most = &measures[MAX_DIHEDRAL], *ratio = &measures[RADIUS_RATIO];
  const tally *edge = &measures[RADIUS_EDGE], *length = &measures[VOLUME_LENGTH];
  set_place(mesh, least, least->min_tet, &check->min_dihedral_tet, check->min_dihedral_place);
  set_place(mesh, most, most->max_tet, &check->max_dihedral_tet, check->max_dihedral_place);
  set_place(mesh, ratio, ratio->min_tet, &check->radius_ratio_tet, check->radius_ratio_place);
  set_place(mesh, edge, edge->max_tet, &check->radius_edge_tet, check->radius_edge_place);
  set_place(mesh, length, length->min_tet, &check->volume_length_tet, check->volume_length_place);
}

static void report(const shapes *s, size_t block_count, laves_check *check) {
  partial all = {0};
  for (int m = 0; m < MEASURES; m++) tally_clear(&all.measures[m]);
  for (size_t b = 0; b < block_count; b++) {
    const partial *part = &s->partials[b];
    for (int m = 0; m < MEASURES; m++) tally_merge(&all.measures[m], &part->measures[m]);
    for (int i = 0; i < LAVES_HISTOGRAM_BINS; i++) check->histogram[i] += part->histogram[i];
    check->volume += part->volume;
  }
  laves_statistic *const targets[MEASURES] = {&check->min_dihedral, &check->max_dihedral, &check->radius_ratio,
                                              &check->radius_edge, &check->volume_length};
  for (int m = 0; m < MEASURES; m++) *targets[m] = statistic(&all.measures[m], origin[m]);
  set_places(s->mesh, all.measures, check);
}

laves_result laves__check_shapes(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                 laves_check *check, laves_error *error) {
  const size_t block_count = (mesh->tet_count + BLOCK_TETS - 1) / BLOCK_TETS;
  const size_t area_count = (boundary->count + BLOCK_FACES - 1) / BLOCK_FACES;
  laves_result result = LAVES_OK;
  shapes s = {.mesh = mesh, .boundary = boundary};
  s.partials = laves__alloc(context, block_count, sizeof *s.partials);
  s.areas = laves__alloc(context, area_count, sizeof *s.areas);
  if (!s.partials || !s.areas) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  if (!laves__parallel_for(context, "check", block_count, 1, measure_blocks, &s) ||
      !laves__parallel_for(context, "check", area_count, 1, area_blocks, &s)) {
    result = laves__fail_cancelled(error);
    goto clean_up;
  }
  report(&s, block_count, check);
  for (size_t b = 0; b < area_count; b++) check->area += s.areas[b];
clean_up:
  laves__free(context, s.partials, block_count, sizeof *s.partials);
  laves__free(context, s.areas, area_count, sizeof *s.areas);
  return result;
}
