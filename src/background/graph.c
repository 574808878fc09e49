/* Stars and links of an explicit background. */
#include "background/graph.h"

#include <string.h>

enum { VERTICES_PER_BLOCK = 256 };

static size_t star_total(const laves__graph *g) { return 4 * g->tet_count; }

/* Counts to first places: first[v + 1] holds the count of v before, and the end of v after. */
static void sum_up(uint32_t *first, size_t count) {
  first[0] = 0;
  for (size_t v = 0; v < count; v++) first[v + 1] += first[v];
}

static void fill_stars(laves__graph *g) {
  for (size_t t = 0; t < g->tet_count; t++) {
    if (laves__cancelled_at(g->context, "background", t, g->tet_count)) return;
    for (int k = 0; k < 4; k++) g->star_first[g->tet[t][k] + 1]++;
  }
  sum_up(g->star_first, g->vertex_count);
  for (size_t t = 0; t < g->tet_count; t++) {
    if (laves__cancelled_at(g->context, "background", t, g->tet_count)) return;
    for (int k = 0; k < 4; k++) g->star[g->star_first[g->tet[t][k]]++] = (int32_t)t;
  }
  for (size_t v = g->vertex_count; v > 0; v--) g->star_first[v] = g->star_first[v - 1];
  g->star_first[0] = 0;
}

/* The vertices around v in order; at most LAVES__STAR_LIMIT tets give at most 4 times as many candidates. */
static uint32_t gather_link(const laves__graph *g, size_t v, int32_t *link) {
  uint32_t count = 0;
  for (uint32_t i = g->star_first[v]; i < g->star_first[v + 1]; i++)
    for (int k = 0; k < 4; k++) {
      const int32_t w = g->tet[g->star[i]][k];
      if (w == (int32_t)v) continue;
      uint32_t at = count;
      while (at > 0 && link[at - 1] > w) at--;
      if (at > 0 && link[at - 1] == w) continue;
      memmove(link + at + 1, link + at, (count - at) * sizeof *link);
      link[at] = w;
      count++;
    }
  return count;
}

/* In the place of a count: more than the masks and lists of stars hold. */
static const uint32_t too_large = UINT32_MAX;

static void count_links(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const laves__graph *g = user;
  int32_t around[3 * LAVES__STAR_LIMIT + 1];
  for (size_t v = begin; v < end; v++) {
    const bool fits = g->star_first[v + 1] - g->star_first[v] <= LAVES__STAR_LIMIT;
    const uint32_t count = fits ? gather_link(g, v, around) : too_large;
    g->link_first[v + 1] = count <= LAVES__LINK_LIMIT ? count : too_large;
  }
}

static void fill_links(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const laves__graph *g = user;
  int32_t around[3 * LAVES__STAR_LIMIT + 1];
  for (size_t v = begin; v < end; v++) {
    const uint32_t count = gather_link(g, v, around);
    memcpy(g->link + g->link_first[v], around, count * sizeof *around);
  }
}

/* Stars are masks of 64 bits; the octree's have at most 48 tets, so this is a broken promise and not the user's fault. */
static laves_result star_too_large(uint32_t tets, laves_error *error) {
  return laves__fail(
      error, LAVES_ERROR_OPTION,
      "a vertex of the background has %u tetrahedra, more than can be told apart, which should not happen; please report it",
      tets);
}

laves_result laves__graph_link(laves__graph *g, laves_error *error) {
  laves_context *context = g->context;
  g->star_first = laves__alloc_zeroed(context, g->vertex_count + 1, sizeof *g->star_first);
  g->link_first = laves__alloc_zeroed(context, g->vertex_count + 1, sizeof *g->link_first);
  g->star = laves__alloc(context, star_total(g), sizeof *g->star);
  g->flags = laves__alloc_zeroed(context, g->tet_count, 1);
  if (!g->star_first || !g->link_first || !g->star || !g->flags) return laves__fail_memory(context, error);
  fill_stars(g);
  if (laves__is_cancelled(context) ||
      !laves__parallel_for(context, "background", g->vertex_count, VERTICES_PER_BLOCK, count_links, g))
    return laves__fail_cancelled(error);
  for (size_t v = 0; v < g->vertex_count; v++) {
    if (g->link_first[v + 1] == too_large) return star_too_large(g->star_first[v + 1] - g->star_first[v], error);
    g->link_first[v + 1] += g->link_first[v];
  }
  g->link = laves__alloc(context, g->link_first[g->vertex_count], sizeof *g->link);
  if (!g->link) return laves__fail_memory(context, error);
  if (!laves__parallel_for(context, "background", g->vertex_count, VERTICES_PER_BLOCK, fill_links, g))
    return laves__fail_cancelled(error);
  return LAVES_OK;
}

void laves__graph_free(laves__graph *g) {
  laves_context *context = g->context;
  if (!context) return;
  const size_t vertices = g->vertex_count, tets = g->tet_count;
  laves__free(context, g->position, vertices, sizeof *g->position);
  laves__free(context, g->scale, vertices, sizeof *g->scale);
  laves__free(context, g->hull, vertices, sizeof *g->hull);
  laves__free(context, g->tet, tets, sizeof *g->tet);
  laves__free(context, g->tile, tets, sizeof *g->tile);
  if (g->link) laves__free(context, g->link, g->link_first[vertices], sizeof *g->link);
  laves__free(context, g->star_first, vertices + 1, sizeof *g->star_first);
  laves__free(context, g->link_first, vertices + 1, sizeof *g->link_first);
  laves__free(context, g->star, star_total(g), sizeof *g->star);
  laves__free(context, g->flags, tets, sizeof *g->flags);
  memset(g, 0, sizeof *g);
}
