// From triangles in memory to arrays in memory, without any file: an octahedron, whose mesh is copied out.
#include <laves/laves.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double points[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
static const uint32_t triangles[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};

// The volume of the tets, from copies as another library would take them.
static double total_volume(const laves_mesh *mesh) {
  const size_t vertex_count = laves_mesh_vertex_count(mesh), tet_count = laves_mesh_tet_count(mesh);
  double(*x)[3] = malloc(vertex_count * sizeof *x);
  int32_t(*tets)[4] = malloc(tet_count * sizeof *tets);
  double sum = 0;
  if (x && tets) {
    memcpy(x, laves_mesh_points(mesh), vertex_count * sizeof *x);
    memcpy(tets, laves_mesh_tets(mesh), tet_count * sizeof *tets);
    for (size_t t = 0; t < tet_count; ++t) {
      double e[3][3];  // edges from the first corner
      for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 3; ++j) e[k][j] = x[tets[t][k + 1]][j] - x[tets[t][0]][j];
      }
      sum += (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
              e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
             6;
    }
  }
  free(x);
  free(tets);
  return sum;
}

int main(void) {
  laves_error error;
  laves_domain *domain = NULL;
  laves_mesh *mesh = NULL;
  laves_context *context = laves_context_create(NULL);
  if (!context) return 4;

  laves_options options = laves_options_default();
  options.size = 0.1;
  laves_result result = laves_domain_from_triangles(context, points[0], 6, triangles[0], 8, NULL, &domain, &error);
  if (result == LAVES_OK) result = laves_generate(context, domain, &options, &mesh, NULL, &error);
  if (result == LAVES_TARGET_MISSED) result = LAVES_OK;  // the edges of the octahedron are sharp
  if (result == LAVES_OK) {
    printf("volume %.4f of the mesh, %.4f of the octahedron\n", total_volume(mesh), 4.0 / 3);
  } else {
    fprintf(stderr, "triangles: %s\n", error.text);
  }
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  laves_context_free(context);
  return laves_result_exit_code(result);
}
