/* The surface in pieces, and pieces in smaller ones.
 *
 * In: a domain.  Out: patches: the triangles of a surface, halved across their longest edge as often as is asked for; or, of
 * other domains, feet with their tangent planes, each of which stands for a square there. A square is parted in four whose
 * middles are projected again. Functions have no samples of their own: the cells of a grid whose corners differ in sign give
 * theirs. */
#include "size/size_parts.h"

/* Most samples that are taken of a surface that is not made of triangles; the spacing grows when they do not suffice. */
static const size_t sample_capacity = (size_t)1 << 20;
/* Cells along the longest side of the grid in which the surface of a function is looked for. */
enum { GRID_MAX = 128, PROJECT_BATCH = 256 };
/* Triangles overlap by shape: their middles lie this share of the longest edge apart, about. */
static const double width_of_edge = 0.6;

/* ---- triangles ---- */

static void set_triangle(laves__patch *p) {
  double longest2 = 0;
  for (int i = 0; i < 3; i++) longest2 = fmax(longest2, v3_norm2(v3_sub(p->corners[(i + 1) % 3], p->corners[i])));
  p->width = width_of_edge * sqrt(longest2);
  p->point = v3_scale(v3_add(p->corners[0], v3_add(p->corners[1], p->corners[2])), 1.0 / 3);
}

static laves_result patches_of_triangles(laves_context *context, const laves__surface *s, laves__patch **patches, size_t *count,
                                         laves_error *error) {
  *patches = laves__alloc(context, s->face_count, sizeof **patches);
  if (!*patches) return laves__fail_memory(context, error);
  *count = s->face_count;
  for (uint32_t f = 0; f < s->face_count; f++) {
    laves__patch *p = &(*patches)[f];
    *p = (laves__patch){.normal = laves__face_normal(s, f), .face = f};
    for (int i = 0; i < 3; i++) p->corners[i] = s->points[s->faces[f][i]];
    set_triangle(p);
  }
  return LAVES_OK;
}

/* Two halves on both sides of the middle of the longest edge. */
static int part_triangle(const laves__patch *p, laves__patch parts[LAVES__PATCH_PARTS]) {
  int longest = 0;
  double most = -1;
  for (int i = 0; i < 3; i++) {
    const double length2 = v3_norm2(v3_sub(p->corners[(i + 1) % 3], p->corners[i]));
    if (length2 > most) {
      most = length2;
      longest = i;
    }
  }
  const int next = (longest + 1) % 3;
  const laves__vec3 middle = v3_lerp(p->corners[longest], p->corners[next], 0.5);
  parts[0] = parts[1] = *p;
  parts[0].corners[next] = middle;
  parts[1].corners[longest] = middle;
  set_triangle(&parts[0]);
  set_triangle(&parts[1]);
  return 2;
}

/* ---- squares of tangent planes ---- */

/* Two unit vectors at right angles to a unit normal and to one another. */
static void tangents(laves__vec3 n, laves__vec3 *u, laves__vec3 *v) {
  const laves__vec3 axis = fabs(n.x) < 0.6 ? v3(1, 0, 0) : fabs(n.y) < 0.6 ? v3(0, 1, 0) : v3(0, 0, 1);
  *u = v3_unit(v3_cross(n, axis));
  *v = v3_cross(n, *u);
}

static int part_square(const laves__oracle *oracle, const laves__patch *p, laves__patch parts[LAVES__PATCH_PARTS]) {
  laves__vec3 u, v, points[4];
  laves__projection feet[4];
  int count = 0;
  tangents(p->normal, &u, &v);
  for (int i = 0; i < 4; i++) {
    const double a = i & 1 ? 0.25 : -0.25, b = i & 2 ? 0.25 : -0.25;
    points[i] = v3_mad(v3_mad(p->point, u, a * p->width), v, b * p->width);
    feet[i].hint = LAVES__NO_HINT;
  }
  laves__project_many(oracle, 4, points, p->width, feet);
  for (int i = 0; i < 4; i++) {
    if (!feet[i].found) continue;
    parts[count++] =
        (laves__patch){.point = feet[i].foot, .normal = feet[i].normal, .width = 0.5 * p->width, .face = LAVES__NONE};
  }
  return count;
}

int laves__patch_part(const laves__oracle *oracle, const laves__patch *patch, laves__patch parts[LAVES__PATCH_PARTS]) {
  return patch->face == LAVES__NONE ? part_square(oracle, patch, parts) : part_triangle(patch, parts);
}

/* ---- where to begin on surfaces that are not made of triangles ---- */

typedef struct grid {
  const laves__oracle *oracle;
  laves__vec3 lower;
  double side;
  size_t cells[3];
  laves__vec3 *points;
  size_t count;
} grid;

static void evaluate_layer(const grid *g, size_t k, laves__vec3 *places, double *phi) {
  const size_t nx = g->cells[0] + 1, ny = g->cells[1] + 1;
  for (size_t j = 0; j < ny; j++)
    for (size_t i = 0; i < nx; i++) places[j * nx + i] = v3_mad(g->lower, v3((double)i, (double)j, (double)k), g->side);
  g->oracle->evaluate(g->oracle->self, nx * ny, places, phi, NULL);
}

/* Middles of the cells of a layer that the surface crosses. */
static void add_crossed(grid *g, size_t k, const double *below, const double *above) {
  const size_t nx = g->cells[0] + 1;
  for (size_t j = 0; j < g->cells[1]; j++)
    for (size_t i = 0; i < g->cells[0]; i++) {
      int inside = 0;
      for (size_t c = 0; c < 8; c++) inside += (c & 4 ? above : below)[(j + (c >> 1 & 1)) * nx + i + (c & 1)] < 0;
      if (inside == 0 || inside == 8 || g->count == sample_capacity) continue;
      g->points[g->count++] = v3_mad(g->lower, v3((double)i + 0.5, (double)j + 0.5, (double)k + 0.5), g->side);
    }
}

static laves_result scan_grid(laves_context *context, grid *g, laves_error *error) {
  const size_t layer = (g->cells[0] + 1) * (g->cells[1] + 1);
  laves_result result = LAVES_OK;
  laves__vec3 *places = laves__alloc(context, layer, sizeof *places);
  double *below = laves__alloc(context, layer, sizeof *below), *above = laves__alloc(context, layer, sizeof *above);
  if (!places || !below || !above) result = laves__fail_memory(context, error);
  if (result == LAVES_OK) evaluate_layer(g, 0, places, below);
  for (size_t k = 0; result == LAVES_OK && k < g->cells[2]; k++) {
    evaluate_layer(g, k + 1, places, above);
    add_crossed(g, k, below, above);
    double *swap = below;
    below = above;
    above = swap;
    if (laves__cancelled(context, "size", 0)) result = laves__fail_cancelled(error);
  }
  laves__free(context, places, layer, sizeof *places);
  laves__free(context, below, layer, sizeof *below);
  laves__free(context, above, layer, sizeof *above);
  return result;
}

/* Middles of cells about `spacing` wide; returns their width. */
static laves_result find_places(laves_context *context, const laves__oracle *oracle, double *spacing, laves__vec3 *points,
                                size_t *count, laves_error *error) {
  if (oracle->sample) {
    *count = oracle->sample(oracle->self, *spacing, points, sample_capacity);
    return laves__is_cancelled(context) ? laves__fail_cancelled(error) : LAVES_OK;
  }
  const laves__vec3 widths = v3_sub(oracle->bounds.upper, oracle->bounds.lower);
  const double longest = fmax(widths.x, fmax(widths.y, widths.z));
  grid g = {.oracle = oracle, .lower = oracle->bounds.lower, .points = points};
  g.side = fmax(*spacing, longest / GRID_MAX);
  for (int i = 0; i < 3; i++) g.cells[i] = (size_t)fmin(GRID_MAX, ceil(v3_at(widths, i) / g.side) + 1);
  const laves_result result = scan_grid(context, &g, error);
  *spacing = g.side;
  *count = g.count;
  return result;
}

typedef struct projecting {
  const laves__oracle *oracle;
  const laves__vec3 *points;
  laves__patch *patches; /* of width 0 where there is no foot */
  double spacing;
} projecting;

static void project_range(void *user, size_t begin, size_t end, int worker) {
  const projecting *job = user;
  laves__projection feet[PROJECT_BATCH];
  (void)worker;
  for (size_t first = begin; first < end; first += PROJECT_BATCH) {
    const size_t count = end - first < PROJECT_BATCH ? end - first : PROJECT_BATCH;
    for (size_t i = 0; i < count; i++) feet[i].hint = LAVES__NO_HINT;
    laves__project_many(job->oracle, count, job->points + first, job->spacing, feet);
    for (size_t i = 0; i < count; i++) {
      laves__patch *p = &job->patches[first + i];
      *p = (laves__patch){.face = LAVES__NONE};
      if (!feet[i].found) continue;
      p->point = feet[i].foot;
      p->normal = feet[i].normal;
      p->width = job->spacing;
    }
  }
}

static laves_result patches_of_feet(laves_context *context, const laves__oracle *oracle, double spacing, laves__patch **patches,
                                    size_t *count, laves_error *error) {
  size_t found = 0, kept = 0;
  laves__patch *all = NULL;
  laves__vec3 *points = laves__alloc(context, sample_capacity, sizeof *points);
  if (!points) return laves__fail_memory(context, error);
  laves_result result = find_places(context, oracle, &spacing, points, &found, error);
  if (result == LAVES_OK) {
    all = laves__alloc(context, found, sizeof *all);
    if (!all) result = laves__fail_memory(context, error);
  }
  projecting job = {oracle, points, all, spacing};
  if (result == LAVES_OK && !laves__parallel_for(context, "size", found, PROJECT_BATCH, project_range, &job))
    result = laves__fail_cancelled(error);
  for (size_t i = 0; result == LAVES_OK && i < found; i++)
    if (all[i].width > 0) all[kept++] = all[i];
  laves__free(context, points, sample_capacity, sizeof *points);
  if (result == LAVES_OK && kept > 0) {
    laves__patch *fitting = laves__realloc(context, all, found, kept, sizeof *all);
    if (!fitting) result = laves__fail_memory(context, error);
    if (fitting) {
      *patches = fitting;
      *count = kept;
      return LAVES_OK;
    }
  }
  laves__free(context, all, found, sizeof *all);
  *patches = NULL;
  *count = 0;
  return result;
}

laves_result laves__patches_of_domain(laves_context *context, const laves_domain *domain, double spacing, laves__patch **patches,
                                      size_t *count, laves_error *error) {
  const laves__oracle *oracle = &domain->oracle;
  if (oracle->surface) return patches_of_triangles(context, oracle->surface, patches, count, error);
  return patches_of_feet(context, oracle, spacing, patches, count, error);
}
