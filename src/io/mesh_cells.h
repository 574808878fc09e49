/* The cells of the formats in which tetrahedra and boundary triangles stand in one list (VTU, VTKHDF, legacy VTK, XDMF): the
 * tetrahedra first, then, only when the mesh carries face tags or sources, its boundary triangles with their tag as "region". */
#ifndef LAVES_IO_MESH_CELLS_H
#define LAVES_IO_MESH_CELLS_H

#include "mesh/mesh.h"

/* VTK's numbers of cell types, of first and second order, and what the cell data "class" tells. */
enum { LAVES__CELL_TRIANGLE = 5, LAVES__CELL_TET = 10, LAVES__CELL_TRIANGLE_2 = 22, LAVES__CELL_TET_2 = 24 };
enum { LAVES__CLASS_TILE = 0, LAVES__CLASS_LAYER = 1, LAVES__CLASS_FACE = 2 };

static inline size_t laves__cell_faces(const laves_mesh *mesh) {
  return mesh->face_tags || mesh->face_sources ? mesh->face_count : 0;
}

static inline size_t laves__cell_count(const laves_mesh *mesh) { return mesh->tet_count + laves__cell_faces(mesh); }

/* Numbers of all tets, and of all cells, together: corners, and with them the other nodes of a mesh of second order. */
static inline size_t laves__cell_tet_corners(const laves_mesh *mesh) { return (size_t)laves__tet_width(mesh) * mesh->tet_count; }
static inline size_t laves__cell_corners(const laves_mesh *mesh) {
  return laves__cell_tet_corners(mesh) + (size_t)laves__face_width(mesh) * laves__cell_faces(mesh);
}
/* Numbers [begin, end) of these. */
void laves__cell_pack_corners(const laves_mesh *mesh, size_t begin, size_t end, int32_t *out);

/* Where the corners of cell i start; i may be the number of cells. */
static inline uint64_t laves__cell_offset(const laves_mesh *mesh, size_t i) {
  const size_t tets = mesh->tet_count;
  const uint64_t tet = (uint64_t)laves__tet_width(mesh), face = (uint64_t)laves__face_width(mesh);
  return i <= tets ? tet * i : tet * tets + face * (i - tets);
}

static inline uint8_t laves__cell_type(const laves_mesh *mesh, size_t i) {
  if (mesh->quadratic) return i < mesh->tet_count ? LAVES__CELL_TET_2 : LAVES__CELL_TRIANGLE_2;
  return i < mesh->tet_count ? LAVES__CELL_TET : LAVES__CELL_TRIANGLE;
}

static inline int32_t laves__cell_region(const laves_mesh *mesh, size_t i) {
  const size_t tets = mesh->tet_count;
  if (i >= tets) return mesh->face_tags ? mesh->face_tags[i - tets] : 1;
  return mesh->regions ? mesh->regions[i] : 1;
}

static inline uint8_t laves__cell_class(const laves_mesh *mesh, size_t i) {
  if (i >= mesh->tet_count) return LAVES__CLASS_FACE;
  return i < mesh->lattice_tet_count ? LAVES__CLASS_TILE : LAVES__CLASS_LAYER;
}

/* Of a mesh that has sources. */
static inline int32_t laves__cell_source(const laves_mesh *mesh, size_t i) {
  return i < mesh->tet_count ? -1 : mesh->face_sources[i - mesh->tet_count];
}

/* ---- names ----
 * Such formats have no place for names of cells' numbers. Each name becomes an array of the field data, with the pairs (number,
 * dimension) that have it: 3 for regions, 2 for tags. meshio knows its "field data" in this form from Gmsh's files. */

/* How many different names the file shall tell: those whose numbers it holds; 0 too where they are so many that nobody reads
 * them, since looking for equal ones is quadratic. */
size_t laves__cell_name_count(const laves_mesh *mesh);
/* Whether groups i and j have one name and both are told. */
bool laves__cell_same_name(const laves_mesh *mesh, size_t i, size_t j);
/* The pairs of the array with the name of group i; 0 where it is not told, or an earlier group has the name. */
size_t laves__cell_name_pairs(const laves_mesh *mesh, size_t i);

#endif
