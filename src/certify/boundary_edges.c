/* The edges of a boundary.
 *
 * All sides of all faces are sorted by their ends, so that those of one edge stand together. A side is stored as its lower end in
 * the upper half of a key and its upper end in the lower half; the order of the edges is that of the keys. */
#include "certify/boundary_edges.h"

#include <string.h>

static const double degrees = 57.29577951308232;

static int32_t end_of(const laves__keyed *side, int which) {
  return (int32_t)(which ? side->key & 0xffffffffu : side->key >> 32);
}

static uint64_t key_of(int32_t a, int32_t b) {
  const uint64_t low = (uint64_t)(uint32_t)(a < b ? a : b), high = (uint64_t)(uint32_t)(a < b ? b : a);
  return low << 32 | high;
}

static laves__vec3 normal_of(const laves_mesh *mesh, const int32_t face[3]) {
  const laves__vec3 a = mesh->points[face[0]], b = mesh->points[face[1]], c = mesh->points[face[2]];
  return v3_unit(v3_cross(v3_sub(b, a), v3_sub(c, a)));
}

/* Of the sides [first, first + count) of one edge. */
static float turn_of(const laves_mesh *mesh, const laves__boundary *boundary, const laves__keyed *first, size_t count) {
  if (count != 2) return NAN;
  const laves__vec3 n = normal_of(mesh, boundary->faces[first[0].value / 3]),
                    m = normal_of(mesh, boundary->faces[first[1].value / 3]);
  if (!(v3_norm2(n) > 0 && v3_norm2(m) > 0)) return NAN;
  return (float)(laves__angle(v3_norm(v3_cross(n, m)), v3_dot(n, m)) * degrees);
}

static size_t same_edge(const laves__keyed *sides, size_t first, size_t count) {
  size_t end = first + 1;
  while (end < count && sides[end].key == sides[first].key) end++;
  return end - first;
}

static size_t count_edges(const laves__keyed *sides, size_t count) {
  size_t edges = 0;
  for (size_t i = 0; i < count; i += same_edge(sides, i, count)) edges++;
  return edges;
}

static void fill_edges(const laves_mesh *mesh, const laves__boundary *boundary, laves__vec3 origin, const laves__keyed *sides,
                       size_t count, laves__boundary_edges *e) {
  double sum = 0;
  size_t next = 0, measured = 0;
  for (size_t i = 0, same; i < count; i += same, next++) {
    same = same_edge(sides, i, count);
    for (int k = 0; k < 2; k++) {
      e->ends[next][k] = end_of(&sides[i], k);
      e->point[e->ends[next][k]] = v3_sub(mesh->points[e->ends[next][k]], origin);
    }
    for (int k = 0; k < 2; k++) e->faces[next][k] = (uint32_t)(sides[same > 1 ? i + (size_t)k : i].value / 3);
    e->turn[next] = turn_of(mesh, boundary, &sides[i], same);
    const double length = v3_distance(e->point[e->ends[next][0]], e->point[e->ends[next][1]]);
    if (!isfinite(length)) continue;
    sum += length;
    measured++;
  }
  e->mean = measured ? sum / (double)measured : 0;
}

/* ---- the tree ---- */

static bool is_finite(const laves__boundary_edges *e, size_t edge) {
  return v3_finite(e->point[e->ends[edge][0]]) && v3_finite(e->point[e->ends[edge][1]]);
}

static bool build_tree(laves__boundary_edges *e) {
  laves_context *context = e->context;
  uint32_t(*faces)[3] = laves__alloc(context, e->count, sizeof *faces);
  uint32_t *edge = laves__alloc(context, e->count, sizeof *edge), *order = laves__alloc(context, e->count, sizeof *order);
  size_t count = 0;
  bool done = faces && edge && order;
  for (size_t i = 0; done && i < e->count; i++) {
    if (!is_finite(e, i)) continue;
    faces[count][0] = (uint32_t)e->ends[i][0];
    faces[count][1] = faces[count][2] = (uint32_t)e->ends[i][1];
    edge[count++] = (uint32_t)i;
  }
  if (done && count > 0) {
    e->slot_count = count;
    e->slot_edge = laves__alloc(context, count, sizeof *e->slot_edge);
    done = e->slot_edge && laves__bvh_build(context, e->point, (const uint32_t(*)[3])faces, count, order, &e->tree);
    for (size_t slot = 0; done && slot < count; slot++) e->slot_edge[slot] = edge[order[slot]];
  }
  laves__free(context, order, e->count, sizeof *order);
  laves__free(context, edge, e->count, sizeof *edge);
  laves__free(context, faces, e->count, sizeof *faces);
  return done;
}

laves_result laves__boundary_edges_find(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                        laves__vec3 origin, laves__boundary_edges *edges, laves_error *error) {
  const size_t sides = 3 * boundary->count;
  *edges = (laves__boundary_edges){.context = context, .vertex_count = mesh->vertex_count};
  laves__keyed *side = laves__alloc(context, sides, sizeof *side), *scratch = laves__alloc(context, sides, sizeof *scratch);
  laves_result result = LAVES_OK;
  bool done = side && scratch;
  for (size_t i = 0; done && i < sides; i++)
    side[i] = (laves__keyed){key_of(boundary->faces[i / 3][i % 3], boundary->faces[i / 3][(i % 3 + 1) % 3]), i};
  if (done) {
    laves__sort_keyed(NULL, side, scratch, sides);
    edges->count = count_edges(side, sides);
  }
  if (edges->count > LAVES__FACES_MAX) {
    edges->count = 0;
    result = laves__fail(error, LAVES_ERROR_INPUT, "the boundary has more than %d edges, so features cannot be measured",
                         LAVES__FACES_MAX);
    goto clean_up;
  }
  edges->ends = laves__alloc(context, edges->count, sizeof *edges->ends);
  edges->faces = laves__alloc(context, edges->count, sizeof *edges->faces);
  edges->turn = laves__alloc(context, edges->count, sizeof *edges->turn);
  edges->point = laves__alloc(context, mesh->vertex_count, sizeof *edges->point);
  done = done && edges->ends && edges->faces && edges->turn && edges->point;
  if (done) fill_edges(mesh, boundary, origin, side, sides, edges);
  if (!done || !build_tree(edges)) result = laves__fail_memory(context, error);
clean_up:
  laves__free(context, scratch, sides, sizeof *scratch);
  laves__free(context, side, sides, sizeof *side);
  return result;
}

void laves__boundary_edges_free(laves__boundary_edges *e) {
  if (!e->context) return;
  laves__free(e->context, e->ends, e->count, sizeof *e->ends);
  laves__free(e->context, e->faces, e->count, sizeof *e->faces);
  laves__free(e->context, e->turn, e->count, sizeof *e->turn);
  laves__free(e->context, e->point, e->vertex_count, sizeof *e->point);
  laves__free(e->context, e->slot_edge, e->slot_count, sizeof *e->slot_edge);
  laves__bvh_free(e->context, &e->tree);
  memset(e, 0, sizeof *e);
}

/* ---- questions ---- */

typedef struct wish {
  const laves__boundary_edges *edges;
  const bool *wanted;
} wish;

static double measure(void *user, uint32_t slot, double distance2, laves__vec3 p) {
  const wish *w = user;
  (void)p;
  return w->wanted[w->edges->slot_edge[slot]] ? distance2 : INFINITY;
}

uint32_t laves__boundary_edges_nearest(const laves__boundary_edges *e, laves__vec3 point, double reach, const bool *wanted,
                                       double *distance) {
  laves__nearest nearest = {reach * reach, LAVES__NONE};
  wish w = {e, wanted};
  if (e->tree.count == 0) return LAVES__NONE;
  if (wanted)
    laves__bvh_nearest_part(&e->tree, point, measure, &w, &nearest);
  else
    laves__bvh_nearest(&e->tree, point, &nearest);
  if (nearest.slot == LAVES__NONE) return LAVES__NONE;
  *distance = sqrt(nearest.distance2);
  return e->slot_edge[nearest.slot];
}

uint32_t laves__boundary_edges_between(const laves__boundary_edges *e, int32_t a, int32_t b) {
  const uint64_t key = key_of(a, b);
  size_t low = 0, high = e->count;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (key_of(e->ends[middle][0], e->ends[middle][1]) < key)
      low = middle + 1;
    else
      high = middle;
  }
  return low < e->count && key_of(e->ends[low][0], e->ends[low][1]) == key ? (uint32_t)low : LAVES__NONE;
}
