/* Corners of cells, and names of groups as field data. */
#include "io/mesh_cells.h"

#include <string.h>

void laves__cell_pack_corners(const laves_mesh *mesh, size_t begin, size_t end, int32_t *out) {
  const size_t tet_corners = laves__cell_tet_corners(mesh), last = end < tet_corners ? end : tet_corners;
  if (begin < last && mesh->quadratic) {
    memcpy(out, *mesh->quadratic->tets + begin, (last - begin) * sizeof *out);
  } else if (begin < last) {
    const bool made = laves__mesh_corners(mesh, begin, last, out);
    LAVES_ASSERT(made);
    (void)made;
  }
  const size_t first = begin > tet_corners ? begin : tet_corners;
  const int32_t *faces = mesh->quadratic ? *mesh->quadratic->faces : *mesh->faces;
  if (first < end) memcpy(out + (first - begin), faces + (first - tet_corners), (end - first) * sizeof *out);
}

enum { NAMES_MAX = 10000 };

static bool is_told(const laves_mesh *mesh, const laves__group *group) {
  return group->name[0] && (group->dimension == 3 ? mesh->regions != NULL : mesh->face_tags != NULL);
}

bool laves__cell_same_name(const laves_mesh *mesh, size_t i, size_t j) {
  const laves__group *a = &mesh->groups[i], *b = &mesh->groups[j];
  return is_told(mesh, a) && is_told(mesh, b) && strcmp(a->name, b->name) == 0;
}

size_t laves__cell_name_pairs(const laves_mesh *mesh, size_t i) {
  for (size_t j = 0; j < i; j++)
    if (laves__cell_same_name(mesh, i, j)) return 0;
  size_t pairs = 0;
  for (size_t j = i; j < mesh->group_count; j++) pairs += laves__cell_same_name(mesh, i, j);
  return pairs;
}

size_t laves__cell_name_count(const laves_mesh *mesh) {
  size_t told = 0, names = 0;
  for (size_t i = 0; i < mesh->group_count; i++) told += is_told(mesh, &mesh->groups[i]);
  if (told > NAMES_MAX) return 0;
  for (size_t i = 0; i < mesh->group_count; i++) names += laves__cell_name_pairs(mesh, i) > 0;
  return names;
}
