/* Finding features, and the questions that stages ask of them. */
#include "domain/features.h"

#include <string.h>

/* ---- lines ---- */

bool laves__feature_lines_add_point(laves__feature_lines *l, laves__vec3 point, uint32_t *index) {
  if (!laves__grow(l->context, &l->point, &l->point_capacity, l->point_count + 1, sizeof *l->point)) return false;
  *index = (uint32_t)l->point_count;
  l->point[l->point_count++] = point;
  return true;
}

bool laves__feature_lines_add_segment(laves__feature_lines *l, const laves__feature_segment *segment) {
  if (!laves__grow(l->context, &l->segment, &l->segment_capacity, l->segment_count + 1, sizeof *l->segment)) return false;
  l->segment[l->segment_count++] = *segment;
  return true;
}

bool laves__feature_lines_fix(laves__feature_lines *l, uint32_t point, int32_t patch) {
  if (!laves__grow(l->context, &l->fixed, &l->fixed_capacity, l->fixed_count + 1, sizeof *l->fixed)) return false;
  l->fixed[l->fixed_count++] = (laves__feature_point){point, patch};
  return true;
}

void laves__feature_lines_free(laves__feature_lines *l) {
  if (!l->context) return;
  laves__free(l->context, l->point, l->point_capacity, sizeof *l->point);
  laves__free(l->context, l->segment, l->segment_capacity, sizeof *l->segment);
  laves__free(l->context, l->fixed, l->fixed_capacity, sizeof *l->fixed);
  memset(l, 0, sizeof *l);
}

/* ---- patches of a surface that is one ---- */

static int32_t only_patch(const void *self, laves__vec3 foot, uint32_t hint) {
  (void)self;
  (void)foot;
  (void)hint;
  return 0;
}

static bool project_anywhere(const void *self, int32_t patch, laves__vec3 point, double reach, uint32_t *hint, laves__vec3 *foot,
                             laves__vec3 *normal) {
  (void)patch;
  const laves__oracle *oracle = self;
  return oracle->project(oracle->self, point, reach, hint, foot, normal);
}

static void one_patch(laves__features *f) {
  f->patch_count = 1;
  f->self = (void *)f->oracle;
  f->patch_at = only_patch;
  f->project_patch = project_anywhere;
  f->free_self = NULL;
}

/* ---- all ---- */

laves_result laves__features_find(laves_context *context, const laves__oracle *oracle, const laves__feature_wish *wish,
                                  laves__features *features, laves_error *error) {
  laves__feature_lines lines = {.context = context};
  *features = (laves__features){.context = context, .oracle = oracle};
  laves_result result = LAVES_OK;
  one_patch(features);
  if (oracle->find_features && (wish->angle > 0 || wish->tags)) result = oracle->find_features(wish, features, &lines, error);
  const laves__feature_wish own = {wish->angle, wish->tags, oracle->drawn, wish->size};
  if (result == LAVES_OK && own.drawn) result = laves__features_drawn(&own, features, &lines, error);
  if (result == LAVES_OK && wish->drawn) result = laves__features_drawn(wish, features, &lines, error);
  if (result == LAVES_OK) result = laves__features_chain(&lines, wish, features, error);
  laves__feature_lines_free(&lines);
  return result;
}

void laves__features_free(laves__features *f) {
  laves_context *context = f->context;
  if (!context) return;
  if (f->free_self) f->free_self(context, f->self);
  laves__free(context, f->crease, f->crease_capacity, sizeof *f->crease);
  laves__free(context, f->corner, f->corner_capacity, sizeof *f->corner);
  laves__free(context, f->line, f->line_capacity, sizeof *f->line);
  laves__free(context, f->joined, f->joined_capacity, sizeof *f->joined);
  laves__free(context, f->corner_crease, f->corner_crease_capacity, sizeof *f->corner_crease);
  laves__free(context, f->corner_patch, f->corner_patch_capacity, sizeof *f->corner_patch);
  laves__free(context, f->slot_crease, f->slot_count, sizeof *f->slot_crease);
  laves__free(context, f->slot_segment, f->slot_count, sizeof *f->slot_segment);
  laves__bvh_free(context, &f->tree);
  memset(f, 0, sizeof *f);
}

/* ---- questions ---- */

bool laves__patches_join(const laves__features *f, int32_t a, int32_t b) {
  if (a == b) return true;
  if (f->joined_pairs == 0) return false;
  const uint64_t pair = a < b ? (uint64_t)a << 32 | (uint32_t)b : (uint64_t)b << 32 | (uint32_t)a;
  size_t low = 0, high = f->joined_pairs;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (f->joined[middle] < pair)
      low = middle + 1;
    else
      high = middle;
  }
  return low < f->joined_pairs && f->joined[low] == pair;
}

/* Which creases are meant. */
typedef struct question {
  const laves__features *features;
  int32_t crease;        /* this one alone; LAVES__NO_FEATURE: those below */
  int32_t patch;         /* on one side; LAVES__NO_FEATURE: any */
  const int32_t *others; /* patches of which one is on the other side; NULL: any */
  int other_count;
} question;

static bool is_meant(const question *q, int32_t crease) {
  const int32_t *patch = q->features->crease[crease].patch;
  if (q->crease != LAVES__NO_FEATURE) return crease == q->crease;
  if (q->patch == LAVES__NO_FEATURE) return true;
  for (int side = 0; side < 2; side++) {
    if (!laves__patches_join(q->features, patch[side], q->patch)) continue;
    if (!q->others) return true;
    for (int i = 0; i < q->other_count; i++)
      if (laves__patches_join(q->features, patch[1 - side], q->others[i])) return true;
  }
  return false;
}

static double measure(void *user, uint32_t slot, double distance2, laves__vec3 p) {
  const question *q = user;
  (void)p;
  return is_meant(q, (int32_t)q->features->slot_crease[slot]) ? distance2 : INFINITY;
}

/* The point of a segment nearest to p, and its direction. */
static laves__vec3 on_segment(const laves__features *f, uint32_t slot, laves__vec3 p, laves__vec3 *tangent) {
  const laves__vec3 a = f->line[f->slot_segment[slot]], b = f->line[f->slot_segment[slot] + 1];
  const laves__vec3 along = v3_sub(b, a);
  const double length2 = v3_norm2(along), t = length2 > 0 ? v3_dot(v3_sub(p, a), along) / length2 : 0;
  *tangent = v3_unit(along);
  return t <= 0 ? a : t >= 1 ? b : v3_mad(a, along, t);
}

static int32_t ask(question *q, laves__vec3 point, double reach, laves__vec3 *foot, laves__vec3 *tangent) {
  const laves__features *f = q->features;
  laves__nearest nearest = {reach * reach, LAVES__NONE};
  if (f->crease_count == 0) return LAVES__NO_FEATURE;
  laves__bvh_nearest_part(&f->tree, point, measure, q, &nearest);
  if (nearest.slot == LAVES__NONE) return LAVES__NO_FEATURE;
  const int32_t crease = (int32_t)f->slot_crease[nearest.slot];
  *foot = on_segment(f, nearest.slot, point, tangent);
  if (f->refine) f->refine(f->self, crease, foot, tangent);
  return crease;
}

bool laves__crease_project(const laves__features *f, int32_t crease, laves__vec3 point, double reach, laves__vec3 *foot,
                           laves__vec3 *tangent) {
  question q = {f, crease, LAVES__NO_FEATURE, NULL, 0};
  return ask(&q, point, reach, foot, tangent) != LAVES__NO_FEATURE;
}

int32_t laves__crease_near(const laves__features *f, laves__vec3 point, double reach, laves__vec3 *foot, laves__vec3 *tangent) {
  question q = {f, LAVES__NO_FEATURE, LAVES__NO_FEATURE, NULL, 0};
  return ask(&q, point, reach, foot, tangent);
}

int32_t laves__seam_near(const laves__features *f, int32_t patch, laves__vec3 point, double reach, laves__vec3 *foot,
                         laves__vec3 *tangent) {
  question q = {f, LAVES__NO_FEATURE, patch, &patch, 1};
  return f->has_seams ? ask(&q, point, reach, foot, tangent) : LAVES__NO_FEATURE;
}

int32_t laves__crease_between(const laves__features *f, int32_t patch, const int32_t *others, int other_count, laves__vec3 point,
                              double reach, laves__vec3 *foot) {
  question q = {f, LAVES__NO_FEATURE, patch, others, other_count};
  laves__vec3 tangent;
  return ask(&q, point, reach, foot, &tangent);
}

laves__vec3 laves__crease_point_at(const laves__features *f, int32_t crease, int end, double way) {
  const laves__crease *c = &f->crease[crease];
  const laves__vec3 *line = f->line + c->first;
  for (uint32_t i = 0; i + 1 < c->count; i++) {
    const laves__vec3 a = line[end ? c->count - 1 - i : i], b = line[end ? c->count - 2 - i : i + 1];
    const double length = v3_distance(a, b);
    if (way <= length && length > 0) {
      laves__vec3 foot = v3_lerp(a, b, way / length), tangent = v3_sub(b, a);
      if (f->refine) f->refine(f->self, crease, &foot, &tangent);
      return foot;
    }
    way -= length;
  }
  return line[end ? 0 : c->count - 1];
}
