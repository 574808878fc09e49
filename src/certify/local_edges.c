/* How long the edges of a boundary are, place by place.
 *
 * Each triangle says the mean of its edges, each vertex the mean of its triangles; then each triangle the mean of its
 * vertices, and so on: after SMOOTHINGS rounds single edges no longer show, and sizes that change over some edges do.
 *
 * Nothing goes by these lengths as they are, but by the powers of two nearest to them, in units of a mean edge: as the sizes of
 * graded meshes go. So what is said of a mesh of one size does not depend on how its edges happen to lie. */
#include <string.h>

#include "certify/certify.h"

enum { SMOOTHINGS = 3, LEVEL_MOST = 30 };

static double face_edge(const laves__vec3 *points, const int32_t face[3]) {
  const laves__vec3 a = points[face[0]], b = points[face[1]], c = points[face[2]];
  return (v3_distance(a, b) + v3_distance(b, c) + v3_distance(c, a)) / 3;
}

double laves__local_edge(const float *edges, const int32_t face[3]) {
  return ((double)edges[face[0]] + (double)edges[face[1]] + (double)edges[face[2]]) / 3;
}

/* One round: from the triangles to the vertices. */
static void spread(const laves_mesh *mesh, const laves__boundary *boundary, bool first, float *edges, float *sum, float *count) {
  memset(sum, 0, mesh->vertex_count * sizeof *sum);
  memset(count, 0, mesh->vertex_count * sizeof *count);
  for (size_t i = 0; i < boundary->count; i++) {
    const int32_t *face = boundary->faces[i];
    const double edge = first ? face_edge(mesh->points, face) : laves__local_edge(edges, face);
    if (!isfinite(edge)) continue;
    for (int k = 0; k < 3; k++) {
      sum[face[k]] += (float)edge;
      count[face[k]]++;
    }
  }
  for (size_t v = 0; v < mesh->vertex_count; v++) edges[v] = count[v] > 0 ? sum[v] / count[v] : 0;
}

float *laves__local_edges(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary) {
  const size_t n = mesh->vertex_count;
  float *edges = laves__alloc_zeroed(context, n, sizeof *edges);
  float *sum = laves__alloc(context, n, sizeof *sum), *count = laves__alloc(context, n, sizeof *count);
  if (edges && sum && count) {
    for (int round = 0; round <= SMOOTHINGS; round++) spread(mesh, boundary, round == 0, edges, sum, count);
  } else {
    laves__free(context, edges, n, sizeof *edges);
    edges = NULL;
  }
  laves__free(context, sum, n, sizeof *sum);
  laves__free(context, count, n, sizeof *count);
  return edges;
}

int laves__edge_level(double edge, double base) {
  const double ratio = edge / base;
  if (!(ratio > 0) || !isfinite(ratio)) return 0;
  int exponent;
  frexp(ratio * 1.4142135623730951, &exponent); /* in [2^(e-1), 2^e) */
  const int level = exponent - 1;
  return level > LEVEL_MOST ? LEVEL_MOST : level < -LEVEL_MOST ? -LEVEL_MOST : level;
}
