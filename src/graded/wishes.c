/* Wishes between the two coordinates. */
#include "graded/wishes.h"

#include <string.h>

enum { CHUNK = 128 };

laves_result laves__wishes_make(laves_context *context, const laves__size *size, double base, laves__wishes *wishes,
                                laves_error *error) {
  *wishes = (laves__wishes){.context = context, .size = size, .base = base};
  const laves_result result = laves__size_samples(size, &wishes->sample, &wishes->sample_count, error);
  wishes->sample_capacity = wishes->sample_count;
  return result;
}

bool laves__wishes_add(laves__wishes *w, laves__vec3 local, double size) {
  if (!laves__grow(w->context, &w->sample, &w->sample_capacity, w->sample_count + 1, sizeof *w->sample)) return false;
  w->sample[w->sample_count++] = (laves__size_sample){local, size};
  return true;
}

bool laves__wishes_approach(laves__wishes *w, const laves__octree *tree, double distance, const laves_place *places, size_t count,
                            bool *any) {
  static const double least_factor = 0.5;
  const double floor = laves__size_floor(w->size);
  for (size_t i = 0; i < count; i++) {
    const double *p = places[i].place;
    const laves__vec3 local = v3_sub(v3(p[0], p[1], p[2]), w->frame->oracle->origin);
    double halving = 0;
    const double now = laves__octree_size(tree, laves__frame_from_local(w->frame, local), &halving) * w->base;
    if (now <= floor) continue;
    const double factor = fmax(sqrt(distance / places[i].value), least_factor);
    if (!laves__wishes_add(w, local, fmin(now * factor, halving * w->base))) return false;
    *any = true;
  }
  return true;
}

/* In units of the base a wish does not know of the stretching, so all sizes grow with the frame. */
static void evaluate(const void *self, size_t count, const laves__vec3 *points, double *sizes) {
  const laves__wishes *w = self;
  laves__vec3 local[CHUNK];
  for (size_t begin = 0; begin < count; begin += CHUNK) {
    const size_t n = count - begin < CHUNK ? count - begin : CHUNK;
    for (size_t i = 0; i < n; i++) local[i] = laves__frame_to_local(w->frame, points[begin + i]);
    laves__size_evaluate(w->size, n, local, sizes + begin);
    for (size_t i = 0; i < n; i++) sizes[begin + i] /= w->base;
  }
}

static void free_places(laves__wishes *w) {
  laves__free(w->context, w->place, w->place_count, sizeof *w->place);
  laves__free(w->context, w->wish, w->place_count, sizeof *w->wish);
  w->place = NULL;
  w->wish = NULL;
}

bool laves__wishes_demand(laves__wishes *w, const laves__frame *frame, laves__demand *demand) {
  free_places(w);
  w->frame = frame;
  w->place_count = w->sample_count;
  w->place = laves__alloc(w->context, w->place_count, sizeof *w->place);
  w->wish = laves__alloc(w->context, w->place_count, sizeof *w->wish);
  if (!w->place || !w->wish) return false;
  for (size_t i = 0; i < w->place_count; i++) {
    w->place[i] = laves__frame_from_local(frame, w->sample[i].point);
    w->wish[i] = w->sample[i].size / w->base;
  }
  *demand = (laves__demand){.self = w,
                            .evaluate = evaluate,
                            .sample = w->place,
                            .sample_size = w->wish,
                            .sample_count = w->place_count,
                            .grading = laves__size_grading(w->size),
                            .smallest = laves__size_floor(w->size) / w->base,
                            .largest = laves__size_ceiling(w->size) / w->base};
  return true;
}

void laves__wishes_free(laves__wishes *w) {
  if (!w->context) return;
  free_places(w);
  laves__free(w->context, w->sample, w->sample_capacity, sizeof *w->sample);
  memset(w, 0, sizeof *w);
}
