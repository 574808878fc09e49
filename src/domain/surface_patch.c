/* Which triangles of a surface that crosses or encloses itself bound the union of what it encloses.
 *
 * In: a closed surface, its crossings, its winding number.  Out: for each triangle whether it stays, and whether only a part
 * of it may count.
 *
 * The solid is where the winding number exceeds the surface's level, one half unless told otherwise. Triangles that meet others
 * are kept and marked partial. The rest falls into patches, joined over edges of two faces; no patch is crossed, so it bounds the
 * solid everywhere or nowhere, and one question in the middle of its largest triangle decides: with this triangle left out, the
 * number there is the mean of the numbers before and behind it, so less than 1/2 from the level says outside before and inside
 * behind. Otherwise the patch is a wall inside the solid, and is left out of the distance, though not of the winding number. */
#include <string.h>

#include "domain/surface.h"

static double area2(const laves__triangle *t) { return v3_norm(v3_cross(v3_sub(t->b, t->a), v3_sub(t->c, t->a))); }

static laves__vec3 centroid(const laves__triangle *t) { return v3_scale(v3_add(t->a, v3_add(t->b, t->c)), 1.0 / 3); }

/* Gives every face without PARTIAL that can be reached from `first` the label; returns the largest. */
static uint32_t flood(const laves__surface *s, uint32_t first, uint32_t label, uint32_t *labels, uint32_t *stack) {
  size_t top = 0;
  uint32_t largest = first;
  labels[first] = label;
  stack[top++] = first;
  while (top > 0) {
    const uint32_t f = stack[--top];
    if (area2(&s->bvh.triangles[f]) > area2(&s->bvh.triangles[largest])) largest = f;
    for (int i = 0; i < 3; i++) {
      const uint32_t half = s->across[3 * (size_t)f + (size_t)i];
      if (half == LAVES__NONE || labels[half / 3] != LAVES__NONE || (s->face_flags[half / 3] & LAVES__PARTIAL)) continue;
      labels[half / 3] = label;
      stack[top++] = half / 3;
    }
  }
  return largest;
}

double laves__surface_mean_winding(const laves__surface *s, uint32_t slot) {
  return laves__winding_number(&s->winding, centroid(&s->bvh.triangles[slot]), slot, LAVES__NONE);
}

bool laves__surface_find_walls(const laves__surface *s, bool *keep, bool *inverted) {
  const size_t count = s->face_count;
  uint32_t *labels = laves__alloc(s->context, count, sizeof *labels);
  uint32_t *stack = laves__alloc(s->context, count, sizeof *stack);
  const bool done = labels && stack;
  if (done) {
    memset(labels, 0xff, count * sizeof *labels);
    for (uint32_t f = 0; f < count; f++) {
      inverted[f] = false;
      keep[f] = (s->face_flags[f] & LAVES__PARTIAL) != 0;
      if (keep[f]) continue;
      if (labels[f] != LAVES__NONE) {
        keep[f] = keep[labels[f]];
        inverted[f] = inverted[labels[f]];
        continue;
      }
      const double mean = laves__surface_mean_winding(s, flood(s, f, f, labels, stack));
      keep[f] = fabs(mean - s->level) < 0.5;
      inverted[f] = fabs(mean + s->level) < 0.5;
    }
  }
  laves__free(s->context, labels, count, sizeof *labels);
  laves__free(s->context, stack, count, sizeof *stack);
  return done;
}
