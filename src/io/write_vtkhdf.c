/* VTKHDF, version 1.0: VTK's HDF5 file for unstructured grids. Points Float64, connectivity and offsets Int32, or Int64 from 2^31
 * corners on, cell data and names as in VTU (write_vtu.c). Nothing is compressed.
 * Source: VTK file formats, "VTKHDF File Format", https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/index.html
 */
#include <string.h>

#include "io/hdf5_file.h"
#include "io/mesh_cells.h"
#include "io/mesh_pack.h"
#include "io/write_mesh.h"

static size_t pack_corners(const void *user, size_t begin, size_t end, char *bytes) {
  laves__cell_pack_corners(user, begin, end, (int32_t *)(void *)bytes);
  return (end - begin) * sizeof(int32_t);
}

/* Numbers of 32 bits spread to 64, in place and from the end on. */
static size_t pack_wide_corners(const void *user, size_t begin, size_t end, char *bytes) {
  const size_t count = end - begin;
  pack_corners(user, begin, end, bytes);
  for (size_t i = count; i-- > 0;) {
    int32_t narrow;
    memcpy(&narrow, bytes + 4 * i, 4);
    const int64_t wide = narrow;
    memcpy(bytes + 8 * i, &wide, 8);
  }
  return count * 8;
}

static size_t pack_offsets(const void *user, size_t begin, size_t end, char *bytes) {
  for (size_t i = begin; i < end; i++) {
    const int32_t offset = (int32_t)laves__cell_offset(user, i);
    memcpy(bytes + 4 * (i - begin), &offset, 4);
  }
  return (end - begin) * 4;
}

static size_t pack_wide_offsets(const void *user, size_t begin, size_t end, char *bytes) {
  for (size_t i = begin; i < end; i++) {
    const uint64_t offset = laves__cell_offset(user, i);
    memcpy(bytes + 8 * (i - begin), &offset, 8);
  }
  return (end - begin) * 8;
}

static size_t pack_types(const void *user, size_t begin, size_t end, char *bytes) {
  for (size_t i = begin; i < end; i++) *bytes++ = (char)laves__cell_type(user, i);
  return end - begin;
}

static size_t pack_count(const void *user, size_t begin, size_t end, char *bytes) {
  if (end > begin) memcpy(bytes, user, 8);
  return (end - begin) * 8;
}

/* The pairs of one name. */
typedef struct name_pairs {
  const laves_mesh *mesh;
  size_t group;
} name_pairs;

static size_t pack_pairs(const void *user, size_t begin, size_t end, char *bytes) {
  const name_pairs *p = user;
  for (size_t j = p->group, pair = 0; j < p->mesh->group_count && pair < end; j++) {
    if (!laves__cell_same_name(p->mesh, p->group, j)) continue;
    const int32_t row[2] = {p->mesh->groups[j].tag, p->mesh->groups[j].dimension};
    if (pair >= begin) memcpy(bytes + 8 * (pair - begin), row, sizeof row);
    pair++;
  }
  return (end - begin) * 8;
}

/* One array for each name; `pairs` are as many as the mesh has groups. */
static void add_names(laves__hdf5_file *file, const laves_mesh *mesh, size_t root, name_pairs *pairs) {
  const size_t fields = laves__hdf5_group(file, root, "FieldData");
  for (size_t i = 0; i < mesh->group_count; i++) {
    const size_t count = laves__cell_name_pairs(mesh, i);
    pairs[i] = (name_pairs){mesh, i};
    if (count > 0) laves__hdf5_array(file, fields, mesh->groups[i].name, LAVES__HDF5_INT32, count, 2, pack_pairs, &pairs[i]);
  }
}

static void add_cells(laves__hdf5_file *file, const laves_mesh *mesh, size_t root) {
  const size_t cells = laves__cell_count(mesh), corners = laves__cell_corners(mesh);
  const bool wide = corners > INT32_MAX;
  const laves__hdf5_type index = wide ? LAVES__HDF5_INT64 : LAVES__HDF5_INT32;
  laves__hdf5_array(file, root, "Connectivity", index, corners, 0, wide ? pack_wide_corners : pack_corners, mesh);
  laves__hdf5_array(file, root, "Offsets", index, cells + 1, 0, wide ? pack_wide_offsets : pack_offsets, mesh);
  laves__hdf5_array(file, root, "Types", LAVES__HDF5_UINT8, cells, 0, pack_types, mesh);
  const size_t data = laves__hdf5_group(file, root, "CellData");
  laves__hdf5_array(file, data, "region", LAVES__HDF5_INT32, cells, 0, laves__pack_cell_regions, mesh);
  laves__hdf5_array(file, data, "class", LAVES__HDF5_UINT8, cells, 0, laves__pack_cell_classes, mesh);
  if (mesh->face_sources)
    laves__hdf5_array(file, data, "source_face", LAVES__HDF5_INT32, cells, 0, laves__pack_cell_sources, mesh);
}

void laves__write_vtkhdf(laves__output *out, const laves_mesh *mesh) {
  static const int64_t version[2] = {1, 0};
  const int64_t counts[3] = {(int64_t)mesh->vertex_count, (int64_t)laves__cell_count(mesh), (int64_t)laves__cell_corners(mesh)};
  static const char *const count_names[] = {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"};
  laves__hdf5_file file;
  laves__hdf5_begin(&file, out);
  const size_t root = laves__hdf5_group(&file, LAVES__HDF5_ROOT, "VTKHDF");
  laves__hdf5_integers(&file, root, "Version", version, 2);
  laves__hdf5_text(&file, root, "Type", "UnstructuredGrid");
  for (int i = 0; i < 3; i++) laves__hdf5_array(&file, root, count_names[i], LAVES__HDF5_INT64, 1, 0, pack_count, &counts[i]);
  laves__hdf5_array(&file, root, "Points", LAVES__HDF5_FLOAT64, mesh->vertex_count, 3, laves__pack_points, mesh);
  add_cells(&file, mesh, root);
  name_pairs *pairs = NULL;
  const bool named = laves__cell_name_count(mesh) > 0;
  if (named) {
    pairs = laves__alloc(out->context, mesh->group_count, sizeof *pairs);
    if (pairs)
      add_names(&file, mesh, root, pairs);
    else
      laves__output_fail_memory(out);
  }
  laves__hdf5_write(&file);
  if (named) laves__free(out->context, pairs, mesh->group_count, sizeof *pairs);
}
