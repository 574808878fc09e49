/* Where a mesh and a domain are further apart than asked.
 *
 * Samples beyond the distance are sorted, furthest first, and taken one by one unless one already taken lies within twice
 * the distance. Those taken are kept in a hash table of cubic cells of that side, so only 27 cells need looking at. */
#include <string.h>

#include "certify/certify.h"

/* The end of a chain. */
#define NOTHING UINT32_MAX

typedef struct grid {
  double cell;
  size_t bucket_count; /* a power of two */
  uint32_t *heads;     /* [bucket_count] last place taken, or NOTHING */
  uint32_t *next;      /* [capacity] */
  laves__vec3 *points; /* [capacity] places taken */
  size_t count, capacity;
} grid;

static size_t bucket_of(const grid *g, double x, double y, double z) {
  const double cells[3] = {x, y, z};
  uint64_t hash = 0;
  for (int k = 0; k < 3; k++) {
    uint64_t bits;
    const double cell = cells[k] + 0.0; /* one zero */
    memcpy(&bits, &cell, sizeof bits);
    hash = (hash ^ bits) * 0x9e3779b97f4a7c15;
    hash ^= hash >> 29;
  }
  return hash & (g->bucket_count - 1);
}

static bool is_taken(const grid *g, laves__vec3 p) {
  const laves__vec3 c = v3_scale(p, 1 / g->cell);
  for (int i = 0; i < 27; i++) {
    const size_t b = bucket_of(g, floor(c.x) + i % 3 - 1, floor(c.y) + i / 3 % 3 - 1, floor(c.z) + i / 9 - 1);
    for (uint32_t at = g->heads[b]; at != NOTHING; at = g->next[at])
      if (v3_distance(g->points[at], p) <= g->cell) return true;
  }
  return false;
}

static void take(grid *g, laves__vec3 p) {
  const laves__vec3 c = v3_scale(p, 1 / g->cell);
  const size_t b = bucket_of(g, floor(c.x), floor(c.y), floor(c.z));
  g->points[g->count] = p;
  g->next[g->count] = g->heads[b];
  g->heads[b] = (uint32_t)g->count++;
}

static size_t count_beyond(const laves__samples *samples, double distance) {
  size_t count = 0;
  for (size_t i = 0; i < samples->count; i++) count += samples->items[i].distance > distance;
  return count;
}

/* The numbers of the samples beyond the distance, furthest first. */
static void sort_beyond(const laves__samples *samples, double distance, laves__keyed *order, laves__keyed *scratch) {
  size_t count = 0;
  for (size_t i = 0; i < samples->count; i++) {
    if (!(samples->items[i].distance > distance)) continue;
    uint64_t bits; /* of positive doubles, in the order of their values */
    memcpy(&bits, &samples->items[i].distance, sizeof bits);
    order[count++] = (laves__keyed){~bits, i};
  }
  laves__sort_keyed(order, scratch, count);
}

/* Chooses the places among the sorted samples; returns how many there are in all. */
static size_t choose(const laves__samples *samples, const laves_domain *domain, const laves__keyed *order, size_t count, grid *g,
                     laves_place *places, size_t capacity) {
  for (size_t i = 0; i < count; i++) {
    const laves__sample *s = &samples->items[order[i].value];
    if (is_taken(g, s->point)) continue;
    if (g->count < capacity) {
      laves_place *place = &places[g->count];
      *place = (laves_place){.value = s->distance, .tet = -1};
      memcpy(place->place, &s->point, sizeof s->point);
      place->curvature_radius = laves__curvature_radius(domain, s->point, samples->spacing);
    }
    take(g, s->point);
  }
  return g->count;
}

laves_result laves__distant_places(laves_context *context, const laves__samples *samples, const laves_domain *domain,
                                   double distance, laves_place *places, size_t capacity, size_t *count, laves_error *error) {
  laves_result result = LAVES_OK;
  *count = 0;
  const size_t beyond = count_beyond(samples, distance);
  if (beyond >= NOTHING) return laves__fail(error, LAVES_ERROR_OPTION, "too many places are further apart than %g", distance);
  grid g = {.cell = 2 * distance, .bucket_count = 1, .capacity = beyond};
  while (g.bucket_count < beyond) g.bucket_count *= 2;
  laves__keyed *order = laves__alloc(context, beyond, sizeof *order), *scratch = laves__alloc(context, beyond, sizeof *scratch);
  g.heads = laves__alloc(context, g.bucket_count, sizeof *g.heads);
  g.next = laves__alloc(context, beyond, sizeof *g.next);
  g.points = laves__alloc(context, beyond, sizeof *g.points);
  if (!order || !scratch || !g.heads || !g.next || !g.points) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  for (size_t i = 0; i < g.bucket_count; i++) g.heads[i] = NOTHING;
  sort_beyond(samples, distance, order, scratch);
  *count = choose(samples, domain, order, beyond, &g, places, capacity);
clean_up:
  laves__free(context, order, beyond, sizeof *order);
  laves__free(context, scratch, beyond, sizeof *scratch);
  laves__free(context, g.heads, g.bucket_count, sizeof *g.heads);
  laves__free(context, g.next, beyond, sizeof *g.next);
  laves__free(context, g.points, beyond, sizeof *g.points);
  return result;
}

laves_result laves_check_distance(laves_context *context, const laves_mesh *mesh, const laves_domain *domain, double distance,
                                  laves_place *places, size_t capacity, size_t *count, laves_error *error) {
  laves__progress_reset(context);
  *count = 0;
  if (!domain) return laves__fail(error, LAVES_ERROR_OPTION, "distances need a domain to measure against");
  if (!(distance > 0) || !isfinite(distance))
    return laves__fail(error, LAVES_ERROR_OPTION, "the distance %g must be positive and finite", distance);
  laves__boundary boundary;
  laves__samples samples = {0};
  laves_result result = laves__find_boundary(context, mesh, &boundary, error);
  if (result == LAVES_OK) result = laves__measure_distances(context, mesh, &boundary, domain, &samples, error);
  if (result == LAVES_OK) result = laves__distant_places(context, &samples, domain, distance, places, capacity, count, error);
  laves__samples_free(&samples);
  laves__boundary_free(&boundary);
  return result;
}
