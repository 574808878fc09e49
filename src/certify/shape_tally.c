/* What the shapes of some tets are together; blocks of tets are tallied one by one and merged in order. */
#include "certify/shape_tally.h"

#include <string.h>

#define DEGREES 57.295779513082323
/* An angle this little below a bin's lower edge belongs there: exact tiles have angles of 60 degrees, give or take a
 * rounding error of about 1e-13. */
#define BIN_SLACK 1e-9

/* What the sums are relative to. */
static const double origin[LAVES__MEASURES] = {60, 72, 1, 1, 1};

static void tally_clear(laves__measure_tally *t) { *t = (laves__measure_tally){.min = INFINITY, .max = -INFINITY}; }

static void tally_add(laves__measure_tally *t, double value, double relative_to, size_t tet) {
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

static void add_value(laves__shape_tally *part, int measure, double value, size_t tet) {
  tally_add(&part->measures[measure], value, origin[measure], tet);
}

static void add_angles(laves__shape_tally *part, const laves__shape_batch *batch, int lane, size_t tet) {
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
  add_value(part, LAVES__MIN_DIHEDRAL, least, tet);
  add_value(part, LAVES__MAX_DIHEDRAL, most, tet);
}

void laves__shape_tally_clear(laves__shape_tally *tally) {
  memset(tally, 0, sizeof *tally);
  for (int m = 0; m < LAVES__MEASURES; m++) tally_clear(&tally->measures[m]);
}

void laves__shape_queue_clear(laves__shape_queue *queue) { memset(queue, 0, sizeof *queue); }

void laves__shape_tally_flush(laves__shape_tally *tally, laves__shape_queue *queue) {
  const laves__shape_batch *batch = &queue->batch;
  if (queue->count > 0) laves__shape_batch_measure(&queue->batch);
  for (int lane = 0; lane < queue->count; lane++) {
    const size_t tet = queue->tet[lane];
    add_angles(tally, batch, lane, tet);
    add_value(tally, LAVES__RADIUS_RATIO, batch->radius_ratio[lane], tet);
    add_value(tally, LAVES__RADIUS_EDGE, batch->radius_edge[lane], tet);
    add_value(tally, LAVES__VOLUME_LENGTH, batch->volume_length[lane], tet);
    tally->volume += batch->determinant[lane] / 6;
  }
  queue->count = 0;
}

void laves__shape_tally_add(laves__shape_tally *tally, laves__shape_queue *queue, const laves__vec3 p[4], size_t tet) {
  laves__shape_batch_set(&queue->batch, queue->count, p);
  queue->tet[queue->count++] = tet;
  if (queue->count == LAVES__SHAPE_BATCH) laves__shape_tally_flush(tally, queue);
}

static void tally_merge(laves__measure_tally *into, const laves__measure_tally *more) {
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

static laves_statistic statistic(const laves__measure_tally *t, double relative_to) {
  if (t->count == 0) return (laves_statistic){0};
  const double count = (double)t->count, mean = t->sum / count;
  const double variance = t->squares / count - mean * mean;
  return (laves_statistic){t->min, t->max, relative_to + mean, sqrt(fmax(0, variance))};
}

void laves__shape_tally_merge(laves__shape_tally *into, const laves__shape_tally *more) {
  for (int m = 0; m < LAVES__MEASURES; m++) tally_merge(&into->measures[m], &more->measures[m]);
  for (int i = 0; i < LAVES_HISTOGRAM_BINS; i++) into->histogram[i] += more->histogram[i];
  into->volume += more->volume;
}

void laves__shape_tally_worst(const laves__shape_tally *tally, int64_t worst[LAVES__MEASURES]) {
  const laves__measure_tally *m = tally->measures;
  worst[LAVES__MIN_DIHEDRAL] = m[LAVES__MIN_DIHEDRAL].count ? (int64_t)m[LAVES__MIN_DIHEDRAL].min_tet : -1;
  worst[LAVES__MAX_DIHEDRAL] = m[LAVES__MAX_DIHEDRAL].count ? (int64_t)m[LAVES__MAX_DIHEDRAL].max_tet : -1;
  worst[LAVES__RADIUS_RATIO] = m[LAVES__RADIUS_RATIO].count ? (int64_t)m[LAVES__RADIUS_RATIO].min_tet : -1;
  worst[LAVES__RADIUS_EDGE] = m[LAVES__RADIUS_EDGE].count ? (int64_t)m[LAVES__RADIUS_EDGE].max_tet : -1;
  worst[LAVES__VOLUME_LENGTH] = m[LAVES__VOLUME_LENGTH].count ? (int64_t)m[LAVES__VOLUME_LENGTH].min_tet : -1;
}

void laves__shape_tally_place(int measure, int64_t tet, const laves__vec3 p[4], laves_check *check) {
  int64_t *const tets[LAVES__MEASURES] = {&check->min_dihedral_tet, &check->max_dihedral_tet, &check->radius_ratio_tet,
                                          &check->radius_edge_tet, &check->volume_length_tet};
  double *const places[LAVES__MEASURES] = {check->min_dihedral_place, check->max_dihedral_place, check->radius_ratio_place,
                                           check->radius_edge_place, check->volume_length_place};
  *tets[measure] = tet;
  if (!p) return;
  const laves__vec3 centroid = v3_scale(v3_add(v3_add(p[0], p[1]), v3_add(p[2], p[3])), 0.25);
  memcpy(places[measure], &centroid, sizeof centroid);
}

void laves__shape_tally_report(const laves__shape_tally *tally, laves_check *check) {
  laves_statistic *const targets[LAVES__MEASURES] = {&check->min_dihedral, &check->max_dihedral, &check->radius_ratio,
                                                     &check->radius_edge, &check->volume_length};
  for (int m = 0; m < LAVES__MEASURES; m++) *targets[m] = statistic(&tally->measures[m], origin[m]);
  memcpy(check->histogram, tally->histogram, sizeof check->histogram);
  check->volume = tally->volume;
}
