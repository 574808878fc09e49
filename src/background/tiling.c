/* The plain tiling of a box of cells as a mesh, with nothing cut or moved.
 *
 * Each cell of the box stamps its 136 tets. Their corners lie in the cell or one cell further along some axes, so the
 * vertices come from a grid of cells that is larger by one on each axis; of those, only the ones that some tet uses get
 * an id, in the order of cells (x fastest) and sites. Since every cell of the box gives each of its tets once, figures
 * per tet over such a mesh are those of one period exactly; only what is counted at its boundary is not. */
#include "background/c15_table.h"
#include "mesh/face_match.h"

enum { CELLS_PER_BLOCK = 64 };

typedef struct tiling {
  int cells[3];
  size_t cell_count;                /* of the box */
  size_t grid[3], grid_count;       /* cells that may hold vertices */
  uint8_t uses[LAVES__C15_SITES];   /* bit s: some tet has this site as a corner with shift s */
  int32_t (*ids)[LAVES__C15_SITES]; /* [grid_count] id of the vertex, or -1 */
  size_t vertex_count;
  double scale; /* of quarter units */
  laves_mesh *mesh;
} tiling;

static void mark_uses(tiling *t) {
  for (int i = 0; i < LAVES__C15_TETS; i++)
    for (int k = 0; k < 4; k++) t->uses[laves__c15_tet[i][k].site] |= (uint8_t)(1u << laves__c15_tet[i][k].shift);
}

static size_t grid_index(const tiling *t, const size_t cell[3]) {
  return cell[0] + t->grid[0] * (cell[1] + t->grid[1] * cell[2]);
}

static void grid_cell(const tiling *t, size_t index, size_t cell[3]) {
  cell[0] = index % t->grid[0];
  cell[1] = index / t->grid[0] % t->grid[1];
  cell[2] = index / t->grid[0] / t->grid[1];
}

/* Bit s: the cell that lies back by shift s is a cell of the box. */
static unsigned owners(const tiling *t, const size_t cell[3]) {
  unsigned mask = 0;
  for (unsigned shift = 0; shift < 8; shift++) {
    bool within = true;
    for (int k = 0; k < 3; k++) {
      const size_t back = shift >> k & 1;
      within = within && cell[k] >= back && cell[k] - back < (size_t)t->cells[k];
    }
    mask |= (unsigned)within << shift;
  }
  return mask;
}

static void number_vertices(tiling *t) {
  for (size_t i = 0; i < t->grid_count; i++) {
    size_t cell[3];
    grid_cell(t, i, cell);
    const unsigned mask = owners(t, cell);
    for (int site = 0; site < LAVES__C15_SITES; site++) t->ids[i][site] = t->uses[site] & mask ? (int32_t)t->vertex_count++ : -1;
  }
}

static void place_vertices(void *user, size_t begin, size_t end, int worker) {
  const tiling *t = user;
  (void)worker;
  for (size_t i = begin; i < end; i++) {
    size_t cell[3];
    grid_cell(t, i, cell);
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      if (t->ids[i][site] < 0) continue;
      const int8_t *s = laves__c15_site[site];
      const laves__vec3 quarters = v3((double)(LAVES__C15_PERIOD * cell[0]) + s[0], (double)(LAVES__C15_PERIOD * cell[1]) + s[1],
                                      (double)(LAVES__C15_PERIOD * cell[2]) + s[2]);
      t->mesh->points[t->ids[i][site]] = v3_scale(quarters, t->scale);
    }
  }
}

static void stamp_cells(void *user, size_t begin, size_t end, int worker) {
  const tiling *t = user;
  (void)worker;
  for (size_t i = begin; i < end; i++) {
    const size_t row = i / (size_t)t->cells[0];
    const size_t cell[3] = {i % (size_t)t->cells[0], row % (size_t)t->cells[1], row / (size_t)t->cells[1]};
    size_t shifted[8];
    for (size_t s = 0; s < 8; s++)
      shifted[s] = grid_index(t, (const size_t[3]){cell[0] + (s & 1), cell[1] + (s >> 1 & 1), cell[2] + (s >> 2)});
    for (int k = 0; k < LAVES__C15_TETS; k++)
      for (int c = 0; c < 4; c++) {
        const laves__c15_corner corner = laves__c15_tet[k][c];
        t->mesh->tets[i * LAVES__C15_TETS + (size_t)k][c] = t->ids[shifted[corner.shift]][corner.site];
      }
  }
}

static laves_result set_size(tiling *t, const int cells[3], double size, laves_error *error) {
  if (!(size > 0) || !isfinite(size)) return laves__fail(error, LAVES_ERROR_OPTION, "the size %g must be positive", size);
  if (cells[0] < 1 || cells[1] < 1 || cells[2] < 1)
    return laves__fail(error, LAVES_ERROR_OPTION, "%d x %d x %d cells are none; each count must be at least 1", cells[0],
                       cells[1], cells[2]);
  double vertices = LAVES__C15_SITES;
  t->cell_count = t->grid_count = 1;
  for (int k = 0; k < 3; k++) {
    t->cells[k] = cells[k];
    t->grid[k] = (size_t)cells[k] + 1;
    vertices *= (double)t->grid[k];
  }
  if (vertices > INT32_MAX)
    return laves__fail(error, LAVES_ERROR_OPTION,
                       "%d x %d x %d cells have more vertices than the %ld that indices can tell apart", cells[0], cells[1],
                       cells[2], (long)INT32_MAX);
  for (int k = 0; k < 3; k++) {
    t->cell_count *= (size_t)cells[k];
    t->grid_count *= t->grid[k];
  }
  t->scale = size / LAVES__C15_MEAN_EDGE;
  return LAVES_OK;
}

/* Points and tets into a mesh that has no faces yet. */
static laves_result stamp(laves_context *context, tiling *t, laves_error *error) {
  t->ids = laves__alloc(context, t->grid_count, sizeof *t->ids);
  if (!t->ids) return laves__fail_memory(context, error);
  laves_result result = LAVES_OK;
  mark_uses(t);
  number_vertices(t);
  t->mesh = laves__mesh_create(context, t->vertex_count, t->cell_count * LAVES__C15_TETS, 0, false, false);
  if (!t->mesh)
    result = laves__fail_memory(context, error);
  else if (!laves__parallel_for(context, "tiling", t->grid_count, CELLS_PER_BLOCK, place_vertices, t) ||
           !laves__parallel_for(context, "tiling", t->cell_count, CELLS_PER_BLOCK, stamp_cells, t))
    result = laves__fail_cancelled(error);
  laves__free(context, t->ids, t->grid_count, sizeof *t->ids);
  return result;
}

/* Replaces the empty array of faces by the boundary; tiles are positive. */
static laves_result add_faces(laves_context *context, laves_mesh *mesh, laves_error *error) {
  uint64_t *slots;
  size_t count;
  LAVES_ASSERT(mesh);
  laves_result result = laves__boundary_slots(context, "boundary", (const int32_t(*)[4])mesh->tets, mesh->tet_count,
                                              mesh->vertex_count, &slots, &count, error);
  if (result != LAVES_OK) return result;
  int32_t(*faces)[3] = laves__alloc(context, count, sizeof *faces);
  if (faces) {
    for (size_t i = 0; i < count; i++) laves__face_outwards(mesh->tets[slots[i] / 4], (int)(slots[i] % 4), 1, faces[i]);
    laves__free(context, mesh->faces, mesh->face_count, sizeof *mesh->faces);
    mesh->faces = faces;
    mesh->face_count = count;
  } else {
    result = laves__fail_memory(context, error);
  }
  laves__free(context, slots, count, sizeof *slots);
  return result;
}

laves_result laves_generate_tiling(laves_context *context, const int cells[3], double size, laves_mesh **mesh,
                                   laves_error *error) {
  laves__progress_reset(context);
  *mesh = NULL;
  tiling t = {.mesh = NULL};
  laves_result result = set_size(&t, cells, size, error);
  if (result == LAVES_OK) result = stamp(context, &t, error);
  if (result == LAVES_OK) result = add_faces(context, t.mesh, error);
  if (result != LAVES_OK) {
    laves_mesh_free(t.mesh);
    return result;
  }
  t.mesh->lattice_tet_count = t.mesh->tet_count;
  *mesh = t.mesh;
  return LAVES_OK;
}
