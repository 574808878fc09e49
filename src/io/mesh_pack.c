/* Arrays of a mesh as little-endian rows. */
#include "io/mesh_pack.h"

#include <string.h>

#include "io/mesh_cells.h"

size_t laves__pack_points(const void *user, size_t begin, size_t end, char *bytes) {
  laves__mesh_points(user, begin, end, (laves__vec3 *)(void *)bytes);
  return (end - begin) * sizeof(laves__vec3);
}

size_t laves__pack_tets(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  if (mesh->quadratic)
    memcpy(bytes, mesh->quadratic->tets + begin, (end - begin) * sizeof *mesh->quadratic->tets);
  else
    laves__mesh_tets(mesh, begin, end, (int32_t(*)[4])(void *)bytes);
  return (end - begin) * 4 * (size_t)laves__tet_width(mesh);
}

size_t laves__pack_cell_regions(const void *user, size_t begin, size_t end, char *bytes) {
  for (size_t i = begin; i < end; i++) {
    const int32_t region = laves__cell_region(user, i);
    memcpy(bytes + 4 * (i - begin), &region, 4);
  }
  return (end - begin) * 4;
}

size_t laves__pack_cell_classes(const void *user, size_t begin, size_t end, char *bytes) {
  for (size_t i = begin; i < end; i++) *bytes++ = (char)laves__cell_class(user, i);
  return end - begin;
}

size_t laves__pack_cell_sources(const void *user, size_t begin, size_t end, char *bytes) {
  for (size_t i = begin; i < end; i++) {
    const int32_t source = laves__cell_source(user, i);
    memcpy(bytes + 4 * (i - begin), &source, 4);
  }
  return (end - begin) * 4;
}
