/* Reads a mesh that another program wrote and prints what it found: count_mesh FILE...
 * One line for each file: tets, boundary faces, volume, number of regions and of face tags, how many tets are negative. */
#include <stdio.h>
#include <stdlib.h>

#include "fixtures/tagged_cube.h"
#include "io/tag_order.h"

static size_t count_tags(laves_context *context, const int32_t *tags, size_t count) {
  laves__tag_order order;
  if (!laves__tag_order_make(context, tags, count, &order)) return 0;
  const size_t different = order.count;
  laves__tag_order_free(context, &order);
  return different;
}

static size_t count_negative(const laves_mesh *mesh) {
  size_t count = 0;
  for (size_t i = 0; i < mesh->tet_count; i++) {
    const int32_t *t = mesh->tets[i];
    count += v3_det(mesh->points[t[0]], mesh->points[t[1]], mesh->points[t[2]], mesh->points[t[3]]) <= 0;
  }
  return count;
}

int main(int argc, char **argv) {
  laves_context *context = laves_context_create(NULL);
  int failed = argc < 2;
  for (int i = 1; i < argc; i++) {
    laves_mesh *mesh;
    laves_error error;
    if (laves_mesh_read(context, argv[i], &mesh, &error) != LAVES_OK) {
      printf("%s\n", error.text);
      failed = 1;
      continue;
    }
    printf("%zu %zu %.12g %zu %zu %zu\n", mesh->tet_count, mesh->face_count, fixture_volume(mesh),
           count_tags(context, mesh->regions, mesh->tet_count), count_tags(context, mesh->face_tags, mesh->face_count),
           count_negative(mesh));
    laves_mesh_free(mesh);
  }
  laves_context_free(context);
  return failed;
}
