/* Where a mesh and a domain are further apart than asked.
 *
 * Samples beyond their limit are sorted, furthest first, and taken one by one unless one already taken lies within twice
 * the limit. Those taken are kept in a hash table of cubic cells of that side, so only 27 cells need looking at; each
 * limit has cells of its own. */
#include <string.h>

#include "certify/certify.h"

/* The end of a chain. */
#define NOTHING UINT32_MAX

/* What is too far, by the edges near by; see laves__distant_places(). */
typedef struct limit {
  double distance, base;
} limit;

static int level_of(const limit *l, const laves__sample *s) {
  return l->base > 0 ? laves__edge_level((double)s->edge, l->base) : 0;
}

/* The distance in units in which `distance` is the limit. */
static double excess(const limit *l, const laves__sample *s) { return ldexp(s->distance, -level_of(l, s)); }

typedef struct grid {
  size_t bucket_count; /* a power of two */
  uint32_t *heads;     /* [bucket_count] last place taken, or NOTHING */
  uint32_t *next;      /* [capacity] */
  laves__vec3 *points; /* [capacity] places taken */
  double *cells;       /* [capacity] their cells' sides */
  size_t count, capacity;
} grid;

static size_t bucket_of(const grid *g, double side, double x, double y, double z) {
  const double cells[4] = {x, y, z, side};
  uint64_t hash = 0;
  for (int k = 0; k < 4; k++) {
    uint64_t bits;
    const double cell = cells[k] + 0.0; /* one zero */
    memcpy(&bits, &cell, sizeof bits);
    hash = (hash ^ bits) * 0x9e3779b97f4a7c15;
    hash ^= hash >> 29;
  }
  return hash & (g->bucket_count - 1);
}

static bool is_taken(const grid *g, laves__vec3 p, double side) {
  const laves__vec3 c = v3_scale(p, 1 / side);
  for (int i = 0; i < 27; i++) {
    const size_t b = bucket_of(g, side, floor(c.x) + i % 3 - 1, floor(c.y) + i / 3 % 3 - 1, floor(c.z) + i / 9 - 1);
    for (uint32_t at = g->heads[b]; at != NOTHING; at = g->next[at])
      if (g->cells[at] == side && v3_distance(g->points[at], p) <= side) return true;
  }
  return false;
}

static void take(grid *g, laves__vec3 p, double side) {
  const laves__vec3 c = v3_scale(p, 1 / side);
  const size_t b = bucket_of(g, side, floor(c.x), floor(c.y), floor(c.z));
  g->points[g->count] = p;
  g->cells[g->count] = side;
  g->next[g->count] = g->heads[b];
  g->heads[b] = (uint32_t)g->count++;
}

static size_t count_beyond(const laves__samples *samples, const limit *l) {
  size_t count = 0;
  for (size_t i = 0; i < samples->count; i++) count += excess(l, &samples->items[i]) > l->distance;
  return count;
}

/* The numbers of the samples beyond their limit, furthest first. */
static void sort_beyond(const laves__samples *samples, const limit *l, laves__keyed *order, laves__keyed *scratch) {
  size_t count = 0;
  for (size_t i = 0; i < samples->count; i++) {
    const double distance = excess(l, &samples->items[i]);
    if (!(distance > l->distance)) continue;
    uint64_t bits; /* of positive doubles, in the order of their values */
    memcpy(&bits, &distance, sizeof bits);
    order[count++] = (laves__keyed){~bits, i};
  }
  laves__sort_keyed(NULL, order, scratch, count);
}

/* Chooses the places among the sorted samples; returns how many there are in all, or so far when it is cancelled. */
static size_t choose(laves_context *context, const laves__samples *samples, const laves_domain *domain, const limit *l,
                     const laves__keyed *order, size_t count, grid *g, laves_place *places, double *limits, size_t capacity) {
  for (size_t i = 0; i < count && !laves__cancelled_at(context, "distance", i, count); i++) {
    const laves__sample *s = &samples->items[order[i].value];
    const double here = ldexp(l->distance, level_of(l, s));
    if (is_taken(g, s->point, 2 * here)) continue;
    if (g->count < capacity) {
      laves_place *place = &places[g->count];
      *place = (laves_place){.value = s->distance, .tet = -1};
      memcpy(place->place, &s->point, sizeof s->point);
      place->curvature_radius = laves__curvature_radius(
          domain, s->point, ldexp(samples->spacing, laves__edge_level((double)s->edge, samples->spacing)));
      if (limits) limits[g->count] = here;
    }
    take(g, s->point, 2 * here);
  }
  return g->count;
}

laves_result laves__distant_places(laves_context *context, const laves__samples *samples, const laves_domain *domain,
                                   double distance, double base, laves_place *places, double *limits, size_t capacity,
                                   size_t *count, laves_error *error) {
  const limit l = {distance, base};
  laves_result result = LAVES_OK;
  *count = 0;
  const size_t beyond = count_beyond(samples, &l);
  if (beyond >= NOTHING) return laves__fail(error, LAVES_ERROR_OPTION, "too many places are further apart than %g", distance);
  grid g = {.bucket_count = 1, .capacity = beyond};
  while (g.bucket_count < beyond) g.bucket_count *= 2;
  laves__keyed *order = laves__alloc(context, beyond, sizeof *order), *scratch = laves__alloc(context, beyond, sizeof *scratch);
  g.heads = laves__alloc(context, g.bucket_count, sizeof *g.heads);
  g.next = laves__alloc(context, beyond, sizeof *g.next);
  g.points = laves__alloc(context, beyond, sizeof *g.points);
  g.cells = laves__alloc(context, beyond, sizeof *g.cells);
  if (!order || !scratch || !g.heads || !g.next || !g.points || !g.cells) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  for (size_t i = 0; i < g.bucket_count; i++) g.heads[i] = NOTHING;
  sort_beyond(samples, &l, order, scratch);
  *count = choose(context, samples, domain, &l, order, beyond, &g, places, limits, capacity);
  if (laves__is_cancelled(context)) result = laves__fail_cancelled(error);
clean_up:
  laves__free(context, order, beyond, sizeof *order);
  laves__free(context, scratch, beyond, sizeof *scratch);
  laves__free(context, g.heads, g.bucket_count, sizeof *g.heads);
  laves__free(context, g.next, beyond, sizeof *g.next);
  laves__free(context, g.points, beyond, sizeof *g.points);
  laves__free(context, g.cells, beyond, sizeof *g.cells);
  return result;
}

laves_result laves_check_distance(laves_context *context, const laves_mesh *mesh, const laves_domain *domain, double distance,
                                  laves_place *places, size_t capacity, size_t *count, laves_error *error) {
  const laves_result held = laves__mesh_require_arrays(mesh, "a distance", error);
  if (held != LAVES_OK) return held;
  laves__progress_reset(context);
  *count = 0;
  if (!domain) return laves__fail(error, LAVES_ERROR_OPTION, "distances need a domain to measure against");
  if (!(distance > 0) || !isfinite(distance))
    return laves__fail(error, LAVES_ERROR_OPTION, "the distance %g must be positive and finite", distance);
  laves__boundary boundary;
  laves__samples samples = {0};
  laves_result result = laves__find_boundary(context, mesh, &boundary, error);
  if (result == LAVES_OK) result = laves__measure_distances(context, mesh, &boundary, domain, &samples, error);
  if (result == LAVES_OK)
    result = laves__distant_places(context, &samples, domain, distance, 0, places, NULL, capacity, count, error);
  laves__samples_free(&samples);
  laves__boundary_free(&boundary);
  return result;
}
