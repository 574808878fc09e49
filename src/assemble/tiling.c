/* The plain tiling of a box: the table of one cell stamped over a grid of cells.
 *
 * The tets of a cell have corners in the cell itself and in the next ones along x, y and z, so a grid of n cells a side has
 * vertices in n + 1.  Marks say which sites of which cells are used; their running sum numbers them. */
#include <math.h>

#include "background/c15_table.h"
#include "mesh/mesh.h"

typedef struct grid {
  size_t cells[3];   /* of tets */
  size_t corners[3]; /* of vertices: one more */
  size_t site_count; /* sites in all cells of vertices */
  int32_t *ids;      /* [site_count] mark, then number of each site; -1: not used */
} grid;

static size_t site_index(const grid *g, const size_t cell[3], const laves__c15_corner *corner) {
  size_t at[3];
  for (int j = 0; j < 3; j++) at[j] = cell[j] + (corner->shift >> j & 1u);
  return ((at[2] * g->corners[1] + at[1]) * g->corners[0] + at[0]) * LAVES__C15_SITES + corner->site;
}

static void cell_at(const size_t sides[3], size_t index, size_t cell[3]) {
  cell[0] = index % sides[0];
  cell[1] = index / sides[0] % sides[1];
  cell[2] = index / sides[0] / sides[1];
}

static size_t cell_count(const grid *g) { return g->cells[0] * g->cells[1] * g->cells[2]; }

/* Returns how many sites are used. */
static size_t number_sites(grid *g) {
  for (size_t i = 0; i < g->site_count; i++) g->ids[i] = -1;
  for (size_t c = 0; c < cell_count(g); c++) {
    size_t cell[3];
    cell_at(g->cells, c, cell);
    for (int t = 0; t < LAVES__C15_TETS; t++)
      for (int k = 0; k < 4; k++) g->ids[site_index(g, cell, &laves__c15_tet[t][k])] = 0;
  }
  int32_t next = 0;
  for (size_t i = 0; i < g->site_count; i++)
    if (g->ids[i] == 0) g->ids[i] = next++;
  return (size_t)next;
}

static void place_points(const grid *g, double size, double (*points)[3]) {
  const double unit = size / LAVES__C15_MEAN_EDGE;
  for (size_t i = 0; i < g->site_count; i++) {
    if (g->ids[i] < 0) continue;
    size_t cell[3];
    cell_at(g->corners, i / LAVES__C15_SITES, cell);
    for (int j = 0; j < 3; j++)
      points[g->ids[i]][j] = unit * (double)((int64_t)cell[j] * LAVES__C15_PERIOD + laves__c15_site[i % LAVES__C15_SITES][j]);
  }
}

static void stamp_tets(const grid *g, int32_t (*tets)[4]) {
  for (size_t c = 0; c < cell_count(g); c++) {
    size_t cell[3];
    cell_at(g->cells, c, cell);
    for (int t = 0; t < LAVES__C15_TETS; t++)
      for (int k = 0; k < 4; k++) tets[c * LAVES__C15_TETS + (size_t)t][k] = g->ids[site_index(g, cell, &laves__c15_tet[t][k])];
  }
}

static laves_result make_grid(const int cells[3], double size, grid *g, laves_error *error) {
  if (!(size > 0 && isfinite(size)))
    return laves__fail(error, LAVES_ERROR_OPTION, "the size of the tiling is %g; it must be above 0", size);
  double sites = LAVES__C15_SITES;
  for (int j = 0; j < 3; j++) {
    if (cells[j] < 1)
      return laves__fail(error, LAVES_ERROR_OPTION, "a tiling needs at least one cell along each axis, not %d", cells[j]);
    g->cells[j] = (size_t)cells[j];
    g->corners[j] = g->cells[j] + 1;
    sites *= (double)g->corners[j];
  }
  if (sites > INT32_MAX)
    return laves__fail(error, LAVES_ERROR_OPTION, "%d by %d by %d cells have more vertices than indices can tell apart", cells[0],
                       cells[1], cells[2]);
  g->site_count = (size_t)sites;
  return LAVES_OK;
}

laves_result laves_generate_tiling(laves_context *context, const int cells[3], double size, laves_mesh **mesh,
                                   laves_error *error) {
  *mesh = NULL;
  grid g = {{0}, {0}, 0, NULL};
  laves_result result = make_grid(cells, size, &g, error);
  if (result != LAVES_OK) return result;
  const size_t tet_count = cell_count(&g) * LAVES__C15_TETS;
  size_t vertex_count = 0;
  double(*points)[3] = NULL;
  int32_t(*tets)[4] = laves__alloc(context, tet_count, sizeof *tets);
  g.ids = laves__alloc(context, g.site_count, sizeof *g.ids);
  if (tets && g.ids) {
    vertex_count = number_sites(&g);
    points = laves__alloc(context, vertex_count, sizeof *points);
  }
  if (!points) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  place_points(&g, size, points);
  stamp_tets(&g, tets);
  result = laves_mesh_from_arrays(context, points[0], vertex_count, tets[0], tet_count, NULL, mesh, error);
  if (result == LAVES_OK) (*mesh)->lattice_tet_count = tet_count;
clean_up:
  laves__free(context, points, vertex_count, sizeof *points);
  laves__free(context, g.ids, g.site_count, sizeof *g.ids);
  laves__free(context, tets, tet_count, sizeof *tets);
  return result;
}
