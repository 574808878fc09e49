/* Joins segments to creases, and finds the corners.
 *
 * In: points, segments between them, points that are corners in any case.  Out: creases, corners, the tree over all segments.
 *
 * A crease goes on through a point where exactly two segments meet, with the same patches on their left and on their right, in
 * about the same direction. How much of a turn a crease may make depends on what a mesh can follow: where both legs of a kink
 * are longer than its edges, the vertex must stand in the kink, or the chord would cut it off; where kinks follow one another
 * within an edge's length they are a polygon that stands for a curve. */
#include <string.h>

#include "domain/features.h"

/* Cosines of the largest turns. */
static const double bend_cosine = 0.6427876096865394;     /* 50 degrees: more is a corner */
static const double kink_cosine = 0.9781476007338057;     /* 12 degrees: more is a corner between long legs: it would cost a tenth
                                                             of an edge */
static const double straight_cosine = 0.9945218953682733; /* 6 degrees: a leg goes on */
static const double long_leg = 1.5;                       /* sizes */

typedef struct chaining {
  const laves__feature_lines *lines;
  const laves__feature_wish *wish;
  laves__features *features;
  uint32_t *first, *at; /* the segments at each point: at[first[p] .. first[p + 1]) */
  uint8_t *is_corner;   /* [points] */
  int32_t *corner_of;   /* [points] number, or LAVES__NO_FEATURE */
  bool *visited;        /* [segments] */
} chaining;

/* ---- what meets at points ---- */

/* Counts, running sums, and a fill from behind. */
static void list_segments(const chaining *c) {
  const laves__feature_lines *l = c->lines;
  uint32_t sum = 0;
  for (size_t i = 0; i < l->segment_count; i++)
    for (int k = 0; k < 2; k++) c->first[l->segment[i].ends[k]]++;
  for (size_t p = 0; p <= l->point_count; p++) {
    sum += c->first[p];
    c->first[p] = sum;
  }
  for (size_t i = l->segment_count; i-- > 0;)
    for (int k = 0; k < 2; k++) c->at[--c->first[l->segment[i].ends[k]]] = (uint32_t)i;
}

static uint32_t degree(const chaining *c, uint32_t p) { return c->first[p + 1] - c->first[p]; }

static uint32_t other_end(const laves__feature_segment *g, uint32_t p) { return g->ends[0] == p ? g->ends[1] : g->ends[0]; }

/* The other one of the two segments at a point. */
static uint32_t next_segment(const chaining *c, uint32_t p, uint32_t segment) {
  return c->at[c->first[p]] == segment ? c->at[c->first[p] + 1] : c->at[c->first[p]];
}

static laves__vec3 direction_from(const chaining *c, uint32_t segment, uint32_t p) {
  const laves__feature_segment *g = &c->lines->segment[segment];
  return v3_unit(v3_sub(c->lines->point[other_end(g, p)], c->lines->point[p]));
}

/* The cosine of the turn at a point with two segments. */
static double turn_cosine(const chaining *c, uint32_t p) {
  return -v3_dot(direction_from(c, c->at[c->first[p]], p), direction_from(c, c->at[c->first[p] + 1], p));
}

/* Whether two segments that meet in a point have the same patches on the same sides. */
static bool same_sides(const chaining *c, uint32_t p) {
  const laves__feature_segment *a = &c->lines->segment[c->at[c->first[p]]], *b = &c->lines->segment[c->at[c->first[p] + 1]];
  if (a->drawn != b->drawn) return false;
  const bool head_to_tail = (a->ends[1] == p) == (b->ends[0] == p);
  return head_to_tail ? a->patch[0] == b->patch[0] && a->patch[1] == b->patch[1]
                      : a->patch[0] == b->patch[1] && a->patch[1] == b->patch[0];
}

/* Whether the line runs straight on from a point, along a segment, for the length of a long leg. */
static bool has_long_leg(const chaining *c, uint32_t p, uint32_t segment) {
  const double wanted = long_leg * c->wish->size;
  const uint32_t start = p;
  for (double length = 0;;) {
    const uint32_t q = other_end(&c->lines->segment[segment], p);
    length += v3_distance(c->lines->point[p], c->lines->point[q]);
    if (length >= wanted) return true;
    if (degree(c, q) != 2 || q == start || turn_cosine(c, q) < straight_cosine) return false;
    segment = next_segment(c, q, segment);
    p = q;
  }
}

static bool ends_creases(const chaining *c, uint32_t p) {
  if (degree(c, p) != 2 || !same_sides(c, p)) return true;
  const double turn = turn_cosine(c, p);
  if (turn < bend_cosine) return true;
  return turn < kink_cosine && has_long_leg(c, p, c->at[c->first[p]]) && has_long_leg(c, p, c->at[c->first[p] + 1]);
}

static void find_corners(const chaining *c) {
  const laves__feature_lines *l = c->lines;
  for (size_t i = 0; i < l->fixed_count; i++) c->is_corner[l->fixed[i].point] = true;
  for (uint32_t p = 0; p < l->point_count; p++)
    if (degree(c, p) > 0 && ends_creases(c, p)) c->is_corner[p] = true;
}

/* ---- creases ---- */

static bool add_line_point(laves__features *f, laves__vec3 p) {
  if (!laves__grow(f->context, &f->line, &f->line_capacity, f->line_count + 1, sizeof *f->line)) return false;
  f->line[f->line_count++] = p;
  return true;
}

/* Follows segments from a point until a corner comes, or the start again. */
static bool follow(const chaining *c, uint32_t start, uint32_t segment) {
  laves__features *f = c->features;
  const laves__feature_segment *g = &c->lines->segment[segment];
  const int flipped = g->ends[0] != start;
  laves__crease crease = {.first = (uint32_t)f->line_count,
                          .patch = {g->patch[flipped], g->patch[1 - flipped]},
                          .corner = {c->corner_of[start], LAVES__NO_FEATURE},
                          .least_angle = HUGE_VAL,
                          .most_angle = -HUGE_VAL,
                          .drawn = g->drawn};
  uint32_t p = start;
  if (!add_line_point(f, c->lines->point[p])) return false;
  do {
    g = &c->lines->segment[segment];
    c->visited[segment] = true;
    const uint32_t q = other_end(g, p);
    crease.length += v3_distance(c->lines->point[p], c->lines->point[q]);
    crease.least_angle = fmin(crease.least_angle, g->angle);
    crease.most_angle = fmax(crease.most_angle, g->angle);
    if (!add_line_point(f, c->lines->point[q])) return false;
    p = q;
    if (c->is_corner[p]) break;
    segment = next_segment(c, p, segment);
  } while (p != start);
  crease.count = (uint32_t)f->line_count - crease.first;
  crease.corner[1] = c->corner_of[p];
  crease.closed = !c->is_corner[start];
  if (!laves__grow(f->context, &f->crease, &f->crease_capacity, f->crease_count + 1, sizeof *f->crease)) return false;
  f->crease[f->crease_count++] = crease;
  f->has_seams |= crease.patch[0] == crease.patch[1];
  return true;
}

static bool find_creases(const chaining *c) {
  const laves__feature_lines *l = c->lines;
  for (uint32_t p = 0; p < l->point_count; p++)
    for (uint32_t k = c->first[p]; c->is_corner[p] && k < c->first[p + 1]; k++)
      if (!c->visited[c->at[k]] && !follow(c, p, c->at[k])) return false;
  for (uint32_t i = 0; i < l->segment_count; i++)
    if (!c->visited[i] && !follow(c, l->segment[i].ends[0], i)) return false;
  return true;
}

/* ---- corners ---- */

static bool number_corners(const chaining *c) {
  laves__features *f = c->features;
  for (uint32_t p = 0; p < c->lines->point_count; p++) {
    c->corner_of[p] = LAVES__NO_FEATURE;
    if (!c->is_corner[p]) continue;
    if (!laves__grow(f->context, &f->corner, &f->corner_capacity, f->corner_count + 1, sizeof *f->corner)) return false;
    c->corner_of[p] = (int32_t)f->corner_count;
    f->corner[f->corner_count++] = (laves__corner){.position = c->lines->point[p]};
  }
  return true;
}

/* Puts a number into an ascending list, unless it is there. */
static void insert(int32_t *list, uint32_t *count, int32_t value) {
  uint32_t at = *count;
  if (value == LAVES__NO_FEATURE) return;
  while (at > 0 && list[at - 1] > value) at--;
  if (at > 0 && list[at - 1] == value) return;
  memmove(list + at + 1, list + at, (*count - at) * sizeof *list);
  list[at] = value;
  ++*count;
}

/* The corner at a point; NULL: there is none. */
static laves__corner *corner_at(const chaining *c, uint32_t point) {
  return c->corner_of[point] == LAVES__NO_FEATURE ? NULL : &c->features->corner[c->corner_of[point]];
}

/* The patches around each corner, in a list with room for two of each segment and one of each fixed point. */
static bool list_corner_patches(const chaining *c) {
  laves__features *f = c->features;
  const laves__feature_lines *l = c->lines;
  f->corner_patch_capacity = 4 * l->segment_count + l->fixed_count;
  f->corner_patch = laves__alloc(f->context, f->corner_patch_capacity, sizeof *f->corner_patch);
  if (!f->corner_patch) return false;
  uint32_t room = 0;
  for (size_t i = 0; i < l->fixed_count; i++) {
    laves__corner *corner = corner_at(c, l->fixed[i].point);
    LAVES_ASSERT(corner);
    corner->patch_count++;
  }
  for (uint32_t p = 0; p < l->point_count; p++) {
    laves__corner *corner = corner_at(c, p);
    if (!corner) continue;
    corner->first_patch = room;
    room += corner->patch_count + 2 * degree(c, p);
    corner->patch_count = 0;
    for (uint32_t k = c->first[p]; k < c->first[p + 1]; k++)
      for (int side = 0; side < 2; side++)
        insert(f->corner_patch + corner->first_patch, &corner->patch_count, l->segment[c->at[k]].patch[side]);
  }
  for (size_t i = 0; i < l->fixed_count; i++) {
    laves__corner *corner = corner_at(c, l->fixed[i].point);
    LAVES_ASSERT(corner);
    corner->fixed = true;
    insert(f->corner_patch + corner->first_patch, &corner->patch_count, l->fixed[i].patch);
  }
  return true;
}

/* The creases at each corner. */
static bool list_corner_creases(laves__features *f) {
  f->corner_crease_capacity = 2 * f->crease_count;
  f->corner_crease = laves__alloc(f->context, f->corner_crease_capacity, sizeof *f->corner_crease);
  if (!f->corner_crease) return false;
  uint32_t room = 0;
  for (size_t i = 0; i < f->crease_count; i++)
    for (int end = 0; end < 2; end++)
      if (f->crease[i].corner[end] != LAVES__NO_FEATURE) f->corner[f->crease[i].corner[end]].end_count++;
  for (size_t k = 0; k < f->corner_count; k++) {
    f->corner[k].first_crease = room;
    room += f->corner[k].end_count;
  }
  for (size_t i = 0; i < f->crease_count; i++)
    for (int end = 0; end < 2; end++) {
      if (f->crease[i].corner[end] == LAVES__NO_FEATURE) continue;
      laves__corner *corner = &f->corner[f->crease[i].corner[end]];
      insert(f->corner_crease + corner->first_crease, &corner->crease_count, (int32_t)i);
    }
  return true;
}

/* ---- the tree ---- */

static bool build_tree(laves__features *f) {
  laves_context *context = f->context;
  size_t count = 0, next = 0;
  for (size_t i = 0; i < f->crease_count; i++) count += f->crease[i].count - 1;
  if (count == 0) return true;
  uint32_t(*faces)[3] = laves__alloc(context, count, sizeof *faces);
  uint32_t *crease = laves__alloc(context, count, sizeof *crease), *order = laves__alloc(context, count, sizeof *order);
  f->slot_count = count;
  f->slot_crease = laves__alloc(context, count, sizeof *f->slot_crease);
  f->slot_segment = laves__alloc(context, count, sizeof *f->slot_segment);
  bool done = faces && crease && order && f->slot_crease && f->slot_segment;
  for (size_t i = 0; done && i < f->crease_count; i++)
    for (uint32_t k = f->crease[i].first; k + 1 < f->crease[i].first + f->crease[i].count; k++) {
      faces[next][0] = k;
      faces[next][1] = faces[next][2] = k + 1;
      crease[next++] = (uint32_t)i;
    }
  done = done && laves__bvh_build(context, f->line, (const uint32_t(*)[3])faces, count, order, &f->tree);
  for (size_t slot = 0; done && slot < count; slot++) {
    f->slot_crease[slot] = crease[order[slot]];
    f->slot_segment[slot] = faces[order[slot]][0];
  }
  laves__free(context, order, count, sizeof *order);
  laves__free(context, crease, count, sizeof *crease);
  laves__free(context, faces, count, sizeof *faces);
  return done;
}

/* ---- all ---- */

static bool chain(const chaining *c) {
  list_segments(c);
  find_corners(c);
  return number_corners(c) && find_creases(c) && list_corner_patches(c) && list_corner_creases(c->features) &&
         build_tree(c->features);
}

laves_result laves__features_chain(const laves__feature_lines *l, const laves__feature_wish *wish, laves__features *features,
                                   laves_error *error) {
  laves_context *context = features->context;
  if (l->segment_count == 0 && l->fixed_count == 0) return LAVES_OK;
  if (l->segment_count > UINT32_MAX / 8)
    return laves__fail(error, LAVES_ERROR_INPUT, "the creases have %zu segments; at most %lu can be handled", l->segment_count,
                       (unsigned long)(UINT32_MAX / 8));
  const size_t points = l->point_count;
  chaining c = {.lines = l,
                .wish = wish,
                .features = features,
                .first = laves__alloc_zeroed(context, points + 1, sizeof *c.first),
                .at = laves__alloc(context, 2 * l->segment_count, sizeof *c.at),
                .is_corner = laves__alloc_zeroed(context, points, sizeof *c.is_corner),
                .corner_of = laves__alloc(context, points, sizeof *c.corner_of),
                .visited = laves__alloc_zeroed(context, l->segment_count, sizeof *c.visited)};
  const bool done = c.first && c.at && c.is_corner && c.corner_of && c.visited && chain(&c);
  laves__free(context, c.first, points + 1, sizeof *c.first);
  laves__free(context, c.at, 2 * l->segment_count, sizeof *c.at);
  laves__free(context, c.is_corner, points, sizeof *c.is_corner);
  laves__free(context, c.corner_of, points, sizeof *c.corner_of);
  laves__free(context, c.visited, l->segment_count, sizeof *c.visited);
  return done ? LAVES_OK : laves__fail_memory(context, error);
}
