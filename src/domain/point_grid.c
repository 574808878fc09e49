/* Points in a hashed grid. */
#include "domain/point_grid.h"

#include <string.h>

#include "domain/elementary.h"

void laves__point_grid_init(laves__point_grid *g, laves_context *context, double width) {
  *g = (laves__point_grid){.context = context, .width = width};
}

void laves__point_grid_free(laves__point_grid *g) {
  if (!g->context) return;
  laves__free(g->context, g->at, g->at_capacity, sizeof *g->at);
  laves__free(g->context, g->next, g->next_capacity, sizeof *g->next);
  laves__free(g->context, g->head, g->head_count, sizeof *g->head);
  *g = (laves__point_grid){0};
}

static size_t list_of(const laves__point_grid *g, const int64_t cell[3]) {
  uint64_t h = 0;
  for (int i = 0; i < 3; i++) {
    h = (h ^ (uint64_t)cell[i]) * 0x9e3779b97f4a7c15ULL;
    h ^= h >> 29;
  }
  return h & (g->head_count - 1);
}

/* Cells beyond 2^50 widths share their last coordinate: slow there, never wrong. */
static void cell_of(const laves__point_grid *g, laves__vec3 p, int64_t cell[3]) {
  const double limit = 1125899906842624.0;
  for (int i = 0; i < 3; i++) cell[i] = (int64_t)floor_of(min_of(max_of(v3_at(p, i) / g->width, -limit), limit));
}

static void link(laves__point_grid *g, size_t i) {
  int64_t cell[3];
  cell_of(g, g->at[i], cell);
  uint32_t *head = &g->head[list_of(g, cell)];
  g->next[i] = *head;
  *head = (uint32_t)i + 1;
}

static bool grow_heads(laves__point_grid *g) {
  const size_t size = g->head_count ? 2 * g->head_count : 64;
  uint32_t *head = laves__alloc_zeroed(g->context, size, sizeof *head);
  if (!head) return false;
  laves__free(g->context, g->head, g->head_count, sizeof *head);
  g->head = head;
  g->head_count = size;
  for (size_t i = 0; i < g->count; i++) link(g, i);
  return true;
}

bool laves__point_grid_add(laves__point_grid *g, laves__vec3 p) {
  if (g->count >= g->head_count && !grow_heads(g)) return false;
  if (!laves__grow(g->context, &g->at, &g->at_capacity, g->count + 1, sizeof *g->at)) return false;
  if (!laves__grow(g->context, &g->next, &g->next_capacity, g->count + 1, sizeof *g->next)) return false;
  g->at[g->count] = p;
  link(g, g->count++);
  return true;
}

void laves__point_grid_near(const laves__point_grid *g, laves__vec3 p, laves__near_fn *fn, void *user) {
  if (g->count == 0) return;
  int64_t middle[3];
  cell_of(g, p, middle);
  for (int k = 0; k < 27; k++) {
    const int64_t cell[3] = {middle[0] + k % 3 - 1, middle[1] + k / 3 % 3 - 1, middle[2] + k / 9 - 1};
    for (uint32_t i = g->head[list_of(g, cell)]; i; i = g->next[i - 1]) fn(user, i - 1);
  }
}
