/* Creases that come close to one another.
 *
 * In: the triangles of a surface.  Out: samples along creases with the distance to the nearest other crease over the elements
 * wished between them.
 *
 * Edges between faces more than 40 degrees apart are creases. Where two of them meet and go on with a turn of less than that they
 * are one chain; chains end at corners. A crease is not compared with its own chain, nor with one that it meets at a corner
 * closer than twice their distance, since all creases come close where they meet. Samples are parted as patches are in
 * size_samples.c. */
#include "size/size_parts.h"

/* In distances: chains that meet within this way belong together. */
static const double corner_range = 2;

typedef struct segment {
  uint32_t ends[2]; /* points */
  uint32_t chain;
} segment;

typedef struct creases {
  const laves__size *size;
  const laves__surface *s;
  segment *segments;
  size_t count, capacity;
  uint32_t (*at)[2];   /* [points] the segments of each point that has two; NONE: none. */
  uint32_t *degree;    /* [points] */
  uint32_t *chains;    /* [segments] parents, then the chain of each */
  uint32_t (*ends)[2]; /* [segments] of each chain its corners; NONE: it has none */
  laves__bvh bvh;
  uint32_t *order; /* segment at each slot */
} creases;

/* ---- chains ---- */

static bool is_crease(const laves__surface *s, uint32_t h) {
  const uint32_t g = s->across[h];
  if (g == LAVES__NONE || g < h) return false;
  return v3_dot(laves__face_normal(s, h / 3), laves__face_normal(s, g / 3)) < LAVES__CREASE_COSINE;
}

static bool find_segments(creases *c) {
  const laves__surface *s = c->s;
  for (uint32_t h = 0; h < 3 * s->face_count; h++) {
    if (!is_crease(s, h)) continue;
    if (!laves__grow(c->size->context, &c->segments, &c->capacity, c->count + 1, sizeof *c->segments)) return false;
    c->segments[c->count++] = (segment){{s->faces[h / 3][h % 3], s->faces[h / 3][(h % 3 + 1) % 3]}, 0};
  }
  return true;
}

static void list_segments(creases *c) {
  for (size_t p = 0; p < c->s->point_count; p++) c->at[p][0] = c->at[p][1] = LAVES__NONE;
  for (uint32_t i = 0; i < c->count; i++)
    for (int k = 0; k < 2; k++) {
      const uint32_t p = c->segments[i].ends[k];
      if (c->degree[p] < 2) c->at[p][c->degree[p]] = i;
      c->degree[p]++;
    }
}

/* The direction of a segment away from one of its ends. */
static laves__vec3 direction_from(const creases *c, uint32_t segment_index, uint32_t point) {
  const segment *g = &c->segments[segment_index];
  const uint32_t other = g->ends[0] == point ? g->ends[1] : g->ends[0];
  return v3_unit(v3_sub(c->s->points[other], c->s->points[point]));
}

/* Whether a chain goes on through a point. */
static bool goes_on(const creases *c, uint32_t point) {
  if (c->degree[point] != 2) return false;
  const laves__vec3 a = direction_from(c, c->at[point][0], point), b = direction_from(c, c->at[point][1], point);
  return -v3_dot(a, b) >= LAVES__CREASE_COSINE;
}

static uint32_t find_chain(uint32_t *parent, uint32_t i) {
  while (parent[i] != i) {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

static void find_chains(creases *c) {
  for (uint32_t i = 0; i < c->count; i++) {
    c->chains[i] = i;
    c->ends[i][0] = c->ends[i][1] = LAVES__NONE;
  }
  for (uint32_t p = 0; p < c->s->point_count; p++) {
    if (!goes_on(c, p)) continue;
    const uint32_t a = find_chain(c->chains, c->at[p][0]), b = find_chain(c->chains, c->at[p][1]);
    c->chains[a > b ? a : b] = a > b ? b : a;
  }
  for (uint32_t i = 0; i < c->count; i++) {
    const uint32_t chain = c->segments[i].chain = find_chain(c->chains, i);
    for (int k = 0; k < 2; k++) {
      const uint32_t p = c->segments[i].ends[k];
      if (!goes_on(c, p)) c->ends[chain][c->ends[chain][0] != LAVES__NONE] = p;
    }
  }
}

static laves_result build(creases *c, laves_error *error) {
  laves_context *context = c->size->context;
  const size_t points = c->s->point_count;
  if (!find_segments(c)) return laves__fail_memory(context, error);
  if (c->count == 0) return LAVES_OK;
  c->at = laves__alloc(context, points, sizeof *c->at);
  c->degree = laves__alloc_zeroed(context, points, sizeof *c->degree);
  c->chains = laves__alloc(context, c->count, sizeof *c->chains);
  c->ends = laves__alloc(context, c->count, sizeof *c->ends);
  c->order = laves__alloc(context, c->count, sizeof *c->order);
  uint32_t(*faces)[3] = laves__alloc(context, c->count, sizeof *faces);
  bool done = c->at && c->degree && c->chains && c->ends && c->order && faces;
  if (done) {
    list_segments(c);
    find_chains(c);
    for (size_t i = 0; i < c->count; i++) {
      faces[i][0] = c->segments[i].ends[0];
      faces[i][1] = faces[i][2] = c->segments[i].ends[1];
    }
    done = laves__bvh_build(context, c->s->points, (const uint32_t(*)[3])faces, c->count, c->order, &c->bvh);
  }
  laves__free(context, faces, c->count, sizeof *faces);
  return done ? LAVES_OK : laves__fail_memory(context, error);
}

static void free_creases(creases *c) {
  laves_context *context = c->size->context;
  const size_t points = c->s->point_count;
  laves__free(context, c->at, points, sizeof *c->at);
  laves__free(context, c->degree, points, sizeof *c->degree);
  laves__free(context, c->chains, c->count, sizeof *c->chains);
  laves__free(context, c->ends, c->count, sizeof *c->ends);
  laves__free(context, c->order, c->count, sizeof *c->order);
  laves__free(context, c->segments, c->capacity, sizeof *c->segments);
  laves__bvh_free(context, &c->bvh);
}

/* ---- distances ---- */

typedef struct question {
  const creases *c;
  uint32_t chain;
} question;

/* The squared distance where a segment counts, else INFINITY. */
static double measure(void *user, uint32_t slot, double distance2, laves__vec3 p) {
  const question *q = user;
  const creases *c = q->c;
  const uint32_t other = c->segments[c->order[slot]].chain;
  if (other == q->chain) return INFINITY;
  const double range2 = corner_range * corner_range * distance2;
  for (int i = 0; i < 2; i++) {
    const uint32_t corner = c->ends[q->chain][i];
    if (corner == LAVES__NONE || (c->ends[other][0] != corner && c->ends[other][1] != corner)) continue;
    if (v3_norm2(v3_sub(p, c->s->points[corner])) <= range2) return INFINITY;
  }
  return distance2;
}

static double distance_at(const creases *c, uint32_t chain, laves__vec3 p, double reach) {
  question q = {c, chain};
  laves__nearest nearest = {reach * reach, LAVES__NONE};
  laves__bvh_nearest_part(&c->bvh, p, measure, &q, &nearest);
  return nearest.slot == LAVES__NONE ? INFINITY : sqrt(nearest.distance2);
}

/* ---- samples ---- */

typedef struct list {
  laves__size_sample **samples;
  size_t *count, *capacity;
} list;

/* The stretch from a to b of a chain. */
static bool sample_stretch(const creases *c, uint32_t chain, laves__vec3 a, laves__vec3 b, const list *out) {
  const laves__size *s = c->size;
  const laves__vec3 middle = v3_lerp(a, b, 0.5);
  const double n = s->feature_elements;
  const double size = fmax(s->floor, distance_at(c, chain, middle, n * s->ceiling) / n);
  if (size < s->ceiling) {
    if (!laves__grow(s->context, out->samples, out->capacity, *out->count + 1, sizeof **out->samples)) return false;
    (*out->samples)[(*out->count)++] = (laves__size_sample){middle, size};
  }
  if (v3_distance(a, b) <= LAVES__SAMPLE_SPACING * fmin(size, s->base)) return true;
  return sample_stretch(c, chain, a, middle, out) && sample_stretch(c, chain, middle, b, out);
}

laves_result laves__feature_samples(const laves__size *size, laves__size_sample **samples, size_t *count, size_t *capacity,
                                    laves_error *error) {
  creases c = {.size = size, .s = size->oracle->surface};
  if (!c.s) return LAVES_OK;
  const list out = {samples, count, capacity};
  laves_result result = build(&c, error);
  for (size_t i = 0; result == LAVES_OK && i < c.count; i++) {
    const segment *g = &c.segments[i];
    if (laves__cancelled(size->context, "size", (double)i / (double)c.count))
      result = laves__fail_cancelled(error);
    else if (!sample_stretch(&c, g->chain, c.s->points[g->ends[0]], c.s->points[g->ends[1]], &out))
      result = laves__fail_memory(size->context, error);
  }
  free_creases(&c);
  return result;
}
