/* Numbers the edges of a mesh, and with them the middle nodes of its ten-node tetrahedra.
 *
 * Each edge hangs at its lower vertex: the higher vertices are counted, listed, sorted and told apart vertex by vertex, so the
 * numbers depend on the mesh alone. */
#include "curve/quadratic.h"

#include <stdlib.h>

static const char phase[] = "curve";
/* Vertices that a thread takes at once. */
enum { BLOCK = 4096 };

typedef struct edge_list {
  laves_context *context;
  const laves_mesh *mesh;
  laves__quadratic *out;
  size_t *start; /* [vertex_count + 1] where the edges of each lower vertex begin in `high` */
  int32_t *high; /* [6 * tet_count] higher vertices; those that differ first */
  size_t *count; /* [vertex_count + 1] how many differ; later the number of the first of them */
} edge_list;

static void lower_first(int32_t a, int32_t b, int32_t *low, int32_t *high) {
  *low = a < b ? a : b;
  *high = a < b ? b : a;
}

static bool list_edges(edge_list *l) {
  const laves_mesh *mesh = l->mesh;
  int32_t low, high;
  for (size_t i = 0; i < mesh->tet_count; i++) {
    if (laves__cancelled_at(l->context, phase, i, 10 * mesh->tet_count)) return false;
    for (int m = 0; m < 6; m++) {
      lower_first(mesh->tets[i][laves__mid_corners[m][0]], mesh->tets[i][laves__mid_corners[m][1]], &low, &high);
      l->start[low]++;
    }
  }
  size_t sum = 0;
  for (size_t v = 0; v <= mesh->vertex_count; v++) { /* each start is where its vertex ends, and is moved down as it is filled */
    sum += l->start[v];
    l->start[v] = sum;
  }
  for (size_t i = 0; i < mesh->tet_count; i++) {
    if (laves__cancelled_at(l->context, phase, mesh->tet_count + i, 10 * mesh->tet_count)) return false;
    for (int m = 0; m < 6; m++) {
      lower_first(mesh->tets[i][laves__mid_corners[m][0]], mesh->tets[i][laves__mid_corners[m][1]], &low, &high);
      l->high[--l->start[low]] = high;
    }
  }
  return true;
}

static int compare(const void *a, const void *b) {
  const int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
  return (x > y) - (x < y);
}

/* Every vertex's part of `high` and its count have one writer. */
static void tell_apart(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  edge_list *l = user;
  for (size_t v = begin; v < end; v++) {
    int32_t *high = l->high + l->start[v];
    const size_t all = l->start[v + 1] - l->start[v];
    qsort(high, all, sizeof *high, compare);
    size_t differ = 0;
    for (size_t i = 0; i < all; i++)
      if (i == 0 || high[i] != high[differ - 1]) high[differ++] = high[i];
    l->count[v] = differ;
  }
}

/* -1: it is no edge of a tet. */
static int32_t node_of(const edge_list *l, int32_t a, int32_t b) {
  int32_t low, high;
  lower_first(a, b, &low, &high);
  const int32_t *list = l->high + l->start[low];
  size_t first = 0, last = l->count[low + 1] - l->count[low];
  if (last == 0) return -1;
  while (last - first > 1) {
    const size_t middle = first + (last - first) / 2;
    if (list[middle] <= high)
      first = middle;
    else
      last = middle;
  }
  return list[first] == high ? (int32_t)(l->mesh->vertex_count + l->count[low] + first) : -1;
}

static void fill_points(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const edge_list *l = user;
  const laves__vec3 *points = l->mesh->points;
  for (size_t v = begin; v < end; v++) {
    l->out->points[v] = points[v];
    for (size_t i = l->count[v]; i < l->count[v + 1]; i++) {
      const int32_t high = l->high[l->start[v] + i - l->count[v]];
      l->out->points[l->mesh->vertex_count + i] = v3_scale(v3_add(points[v], points[high]), 0.5);
    }
  }
}

static void fill_tets(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const edge_list *l = user;
  for (size_t i = begin; i < end; i++) {
    const int32_t *tet = l->mesh->tets[i];
    int32_t *out = l->out->tets[i];
    for (int j = 0; j < 4; j++) out[j] = tet[j];
    for (int m = 0; m < 6; m++) out[4 + m] = node_of(l, tet[laves__mid_corners[m][0]], tet[laves__mid_corners[m][1]]);
  }
}

static void fill_faces(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const edge_list *l = user;
  for (size_t i = begin; i < end; i++) {
    const int32_t *face = l->mesh->faces[i];
    int32_t *out = l->out->faces[i];
    for (int j = 0; j < 3; j++) out[j] = face[j];
    for (int m = 0; m < 3; m++) out[3 + m] = node_of(l, face[laves__mid_corners[m][0]], face[laves__mid_corners[m][1]]);
  }
}

static laves_result number_nodes(edge_list *l, laves_error *error) {
  const laves_mesh *mesh = l->mesh;
  size_t edges = 0;
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    const size_t own = l->count[v];
    l->count[v] = edges;
    edges += own;
  }
  l->count[mesh->vertex_count] = edges;
  if (mesh->vertex_count + edges > INT32_MAX)
    return laves__fail(error, LAVES_ERROR_OPTION, "the mesh would have %zu nodes of second order; at most %d can be numbered",
                       mesh->vertex_count + edges, INT32_MAX);
  l->out->node_count = mesh->vertex_count + edges;
  l->out->points = laves__alloc(l->context, l->out->node_count, sizeof *l->out->points);
  l->out->tets = laves__alloc(l->context, mesh->tet_count, sizeof *l->out->tets);
  l->out->faces = laves__alloc(l->context, mesh->face_count, sizeof *l->out->faces);
  const bool filled = l->out->points && l->out->tets && l->out->faces &&
                      laves__parallel_for(l->context, phase, mesh->vertex_count, BLOCK, fill_points, l) &&
                      laves__parallel_for(l->context, phase, mesh->tet_count, BLOCK, fill_tets, l) &&
                      laves__parallel_for(l->context, phase, mesh->face_count, BLOCK, fill_faces, l);
  if (!filled) return laves__fail_memory(l->context, error);
  for (size_t i = 0; i < mesh->face_count; i++)
    for (int m = 3; m < LAVES__FACE_NODES; m++)
      if (l->out->faces[i][m] < 0)
        return laves__fail(error, LAVES_ERROR_INPUT, "boundary triangle %zu has an edge that no tetrahedron has", i);
  return LAVES_OK;
}

laves__quadratic *laves__quadratic_create(laves_context *context, const laves_mesh *mesh, laves_error *error) {
  const size_t vertices = mesh->vertex_count;
  edge_list l = {.context = context,
                 .mesh = mesh,
                 .out = laves__alloc_zeroed(context, 1, sizeof *l.out),
                 .start = laves__alloc_zeroed(context, vertices + 1, sizeof *l.start),
                 .high = laves__alloc(context, mesh->tet_count, 6 * sizeof *l.high),
                 .count = laves__alloc_zeroed(context, vertices + 1, sizeof *l.count)};
  laves_result result = LAVES_ERROR_MEMORY;
  if (l.out && l.start && l.high && l.count && list_edges(&l) &&
      laves__parallel_for(context, phase, vertices, BLOCK, tell_apart, &l))
    result = number_nodes(&l, error);
  else
    laves__fail_memory(context, error);
  laves__free(context, l.start, vertices + 1, sizeof *l.start);
  laves__free(context, l.high, mesh->tet_count, 6 * sizeof *l.high);
  laves__free(context, l.count, vertices + 1, sizeof *l.count);
  if (result == LAVES_OK) return l.out;
  laves__quadratic_free(context, mesh, l.out);
  return NULL;
}
