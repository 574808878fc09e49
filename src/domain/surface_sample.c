/* Samples of a surface, the thin places of the solid behind it, and the narrow gaps before it.
 *
 * In: the surface and its tree.  Out: points of it, evenly by area; chords through the solid or through gaps, shortest first.
 *
 * Samples are taken where the area summed over the faces passes multiples of the area per sample; within a face they follow a
 * sequence that covers the unit square evenly (steps of the plastic number), folded into the triangle. The places are the same in
 * every run.
 *
 * A chord is shot from a sample against the normal (for a gap, along it) and ends at the first face that faces away from where it
 * began and lies nearly parallel to it; wedges, which are thin at every edge, do not count. */
#include <stdlib.h>

#include "domain/surface.h"

/* Cosine between the normals of the two ends of a chord, one of them turned over: about 37 degrees. */
static const double parallel_min = 0.8;
/* The steps 1/p and 1/p^2 with p^3 = p + 1. */
static const double step_u = 0.7548776662466927, step_v = 0.5698402909980532;

enum { THIN_SAMPLES = 20000 };

typedef struct sample {
  laves__vec3 at;
  uint32_t slot;
} sample;

static laves__vec3 place_in_triangle(const laves__triangle *t, size_t index) {
  double u = (double)(index + 1) * step_u, v = (double)(index + 1) * step_v;
  u -= floor(u);
  v -= floor(v);
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  return v3_add(t->a, v3_add(v3_scale(v3_sub(t->b, t->a), u), v3_scale(v3_sub(t->c, t->a), v)));
}

static double area_of(const laves__triangle *t) { return 0.5 * v3_norm(v3_cross(v3_sub(t->b, t->a), v3_sub(t->c, t->a))); }

static double total_area(const laves__surface *s) {
  double sum = 0;
  for (size_t f = 0; f < s->face_count; f++) sum += area_of(&s->bvh.triangles[f]);
  return sum;
}

/* Samples of the parts that bound the solid, each for `area_each`. */
static size_t take_samples(const laves__surface *s, double area_each, sample *samples, size_t capacity) {
  size_t count = 0, index = 0;
  double sum = 0.5 * area_each;
  for (uint32_t f = 0; f < s->face_count; f++) {
    const laves__triangle *t = &s->bvh.triangles[f];
    sum += area_of(t);
    for (; sum >= area_each && count < capacity; sum -= area_each) {
      const laves__vec3 at = place_in_triangle(t, index++);
      if (!s->needs_winding || laves__surface_bounds_at(s, f, at)) samples[count++] = (sample){at, f};
    }
  }
  return count;
}

size_t laves__surface_sample(const void *self, double spacing, laves__vec3 *points, size_t capacity) {
  const laves__surface *s = self;
  if (capacity == 0) return 0;
  const double area = total_area(s);
  const double area_each = fmax(spacing * spacing, area / (double)capacity);
  const size_t most = (size_t)(area / area_each) + 2;
  sample *samples = laves__alloc(s->context, most, sizeof *samples);
  if (!samples) return 0;
  const size_t count = take_samples(s, area_each, samples, most < capacity ? most : capacity);
  for (size_t i = 0; i < count; i++) points[i] = samples[i].at;
  laves__free(s->context, samples, most, sizeof *samples);
  return count;
}

/* ---- chords ---- */

/* Length of the chord that begins at the sample and goes inwards (side -1) or outwards (1), or INFINITY. */
static double chord(const laves__surface *s, const sample *from, int side) {
  const laves__vec3 direction = v3_scale(laves__face_normal(s, from->slot), side);
  laves__hit hit = {INFINITY, LAVES__NONE};
  laves__bvh_shoot(&s->bvh, from->at, direction, from->slot, &hit);
  if (hit.slot == LAVES__NONE || -side * v3_dot(laves__face_normal(s, hit.slot), direction) < parallel_min) return INFINITY;
  return hit.distance;
}

static int compare_places(const void *a, const void *b) {
  const laves_thin_place *p = a, *q = b;
  if (p->thickness != q->thickness) return p->thickness < q->thickness ? -1 : 1;
  for (int k = 0; k < 3; k++)
    if (p->place[k] != q->place[k]) return p->place[k] < q->place[k] ? -1 : 1;
  return 0;
}

static double place_distance(const laves_thin_place *p, const laves_thin_place *q) {
  return v3_distance(v3(p->place[0], p->place[1], p->place[2]), v3(q->place[0], q->place[1], q->place[2]));
}

/* The thinnest, each at least twice its thickness from those before it. */
static size_t pick(const laves_thin_place *all, size_t count, laves_thin_place *places, size_t capacity) {
  size_t picked = 0;
  for (size_t i = 0; i < count && picked < capacity; i++) {
    bool apart = true;
    for (size_t j = 0; j < picked && apart; j++) apart = place_distance(&all[i], &places[j]) >= 2 * all[i].thickness;
    if (apart) places[picked++] = all[i];
  }
  return picked;
}

size_t laves__surface_thin_places(const void *self, laves_thin_kind kind, laves_thin_place *places, size_t capacity) {
  const laves__surface *s = self;
  const int side = kind == LAVES_THIN_WALL ? -1 : 1;
  size_t picked = 0, count = 0;
  sample *samples = laves__alloc(s->context, THIN_SAMPLES, sizeof *samples);
  laves_thin_place *all = laves__alloc(s->context, THIN_SAMPLES, sizeof *all);
  if (samples && all) {
    const size_t taken = take_samples(s, total_area(s) / THIN_SAMPLES, samples, THIN_SAMPLES);
    for (size_t i = 0; i < taken; i++) {
      const double length = chord(s, &samples[i], side);
      if (!isfinite(length)) continue;
      const laves__vec3 middle = v3_mad(samples[i].at, laves__face_normal(s, samples[i].slot), 0.5 * side * length);
      all[count++] = (laves_thin_place){{middle.x, middle.y, middle.z}, length, kind};
    }
    qsort(all, count, sizeof *all, compare_places);
    picked = pick(all, count, places, capacity);
  } else if (capacity > 0) {
    places[0].thickness = NAN;
  }
  laves__free(s->context, samples, THIN_SAMPLES, sizeof *samples);
  laves__free(s->context, all, THIN_SAMPLES, sizeof *all);
  return picked;
}

/* ---- volume of a union ---- */

double laves__surface_union_volume(const laves__surface *s) {
  double volume6 = 0;
  for (uint32_t f = 0; f < s->face_count; f++) {
    if (s->face_flags[f] & LAVES__PARTIAL) continue;
    const laves__triangle *t = &s->bvh.triangles[f];
    volume6 += v3_dot(t->a, v3_cross(t->b, t->c));
  }
  for (size_t i = 0; i < s->piece_count; i++) volume6 += v3_dot(s->pieces[i].a, v3_cross(s->pieces[i].b, s->pieces[i].c));
  return volume6 / 6;
}
