/* XDMF, version 3: an XML file that tells what the arrays of an HDF5 file beside it mean. One uniform grid: of tetrahedra or,
 * when the mesh carries face tags or sources, mixed with its boundary triangles, as in VTU. Names are an "Information" in
 * meshio's form. Source: XDMF model and format, https://www.xdmf.org/index.php/XDMF_Model_and_Format */
#include <string.h>

#include "io/hdf5_file.h"
#include "io/mesh_cells.h"
#include "io/mesh_items.h"
#include "io/mesh_pack.h"
#include "io/write_mesh.h"
#include "io/write_text.h"

/* Numbers that a mixed topology has for each cell: what it is, and its corners. */
enum { CODE_TRIANGLE = 4, CODE_TET = 6, CODE_TRIANGLE_2 = 36, CODE_TET_2 = 38 };

static bool is_mixed(const laves_mesh *mesh) { return laves__cell_faces(mesh) > 0; }

static size_t mixed_numbers(const laves_mesh *mesh) { return laves__cell_count(mesh) + laves__cell_corners(mesh); }

/* ---- the arrays ---- */

static int32_t mixed_number(laves__tet_reader *reader, size_t i) {
  const laves_mesh *mesh = reader->mesh;
  const bool second = mesh->quadratic != NULL;
  const size_t tet = 1 + (size_t)laves__tet_width(mesh), face = 1 + (size_t)laves__face_width(mesh);
  const size_t tet_numbers = tet * mesh->tet_count;
  if (i < tet_numbers) return i % tet ? laves__tet_at(reader, i / tet)[i % tet - 1] : second ? CODE_TET_2 : CODE_TET;
  i -= tet_numbers;
  return i % face ? laves__face_nodes(mesh, i / face)[i % face - 1] : second ? CODE_TRIANGLE_2 : CODE_TRIANGLE;
}

static size_t pack_mixed(const void *user, size_t begin, size_t end, char *bytes) {
  laves__tet_reader reader = {.mesh = user};
  for (size_t i = begin; i < end; i++) {
    const int32_t number = mixed_number(&reader, i);
    memcpy(bytes + 4 * (i - begin), &number, 4);
  }
  return (end - begin) * 4;
}

void laves__write_xdmf_data(laves__output *out, const laves_mesh *mesh) {
  const size_t cells = laves__cell_count(mesh), root = LAVES__HDF5_ROOT;
  laves__hdf5_file file;
  laves__hdf5_begin(&file, out);
  laves__hdf5_array(&file, root, "points", LAVES__HDF5_FLOAT64, mesh->vertex_count, 3, laves__pack_points, mesh);
  if (is_mixed(mesh))
    laves__hdf5_array(&file, root, "cells", LAVES__HDF5_INT32, mixed_numbers(mesh), 0, pack_mixed, mesh);
  else
    laves__hdf5_array(&file, root, "cells", LAVES__HDF5_INT32, mesh->tet_count, laves__tet_width(mesh), laves__pack_tets, mesh);
  laves__hdf5_array(&file, root, "region", LAVES__HDF5_INT32, cells, 0, laves__pack_cell_regions, mesh);
  laves__hdf5_array(&file, root, "class", LAVES__HDF5_UINT8, cells, 0, laves__pack_cell_classes, mesh);
  if (mesh->face_sources)
    laves__hdf5_array(&file, root, "source_face", LAVES__HDF5_INT32, cells, 0, laves__pack_cell_sources, mesh);
  laves__hdf5_write(&file);
}

/* ---- the XML ---- */

/* One item; columns 0: one dimension. */
static void write_item(laves__output *out, const char *file, const char *array, const char *type, size_t rows, int columns) {
  laves__output_printf(out, "        <DataItem Format=\"HDF\" %s Dimensions=\"%zu", type, rows);
  if (columns) laves__output_printf(out, " %d", columns);
  laves__output_printf(out, "\">");
  laves__write_escaped(out, file);
  laves__output_printf(out, ":/%s</DataItem>\n", array);
}

static void write_attribute(laves__output *out, const char *file, const char *name, const char *type, size_t cells) {
  laves__output_printf(out, "      <Attribute Name=\"%s\" AttributeType=\"Scalar\" Center=\"Cell\">\n", name);
  write_item(out, file, name, type, cells, 0);
  laves__output_printf(out, "      </Attribute>\n");
}

static void write_names(laves__output *out, const laves_mesh *mesh) {
  if (laves__cell_name_count(mesh) == 0) return;
  laves__output_printf(out, "      <Information Name=\"names\" Value=\"groups\"><![CDATA[<main>");
  for (size_t i = 0; i < mesh->group_count; i++) {
    if (!laves__cell_same_name(mesh, i, i)) continue; /* it is not told */
    laves__output_printf(out, "<map key=\"");
    laves__write_escaped(out, mesh->groups[i].name);
    laves__output_printf(out, "\" dim=\"%d\">%ld</map>", mesh->groups[i].dimension, (long)mesh->groups[i].tag);
  }
  laves__output_printf(out, "</main>]]></Information>\n");
}

void laves__write_xdmf(laves__output *out, const laves_mesh *mesh, const char *name) {
  static const char int32[] = "DataType=\"Int\" Precision=\"4\"";
  const size_t cells = laves__cell_count(mesh);
  const bool mixed = is_mixed(mesh);
  laves__output_printf(
      out,
      "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n    <Grid Name=\"Grid\" GridType=\"Uniform\">\n"
      "      <Geometry GeometryType=\"XYZ\">\n");
  write_item(out, name, "points", "DataType=\"Float\" Precision=\"8\"", mesh->vertex_count, 3);
  laves__output_printf(out, "      </Geometry>\n      <Topology TopologyType=\"%s\" NumberOfElements=\"%zu\">\n",
                       mixed             ? "Mixed"
                       : mesh->quadratic ? "Tetrahedron_10"
                                         : "Tetrahedron",
                       cells);
  write_item(out, name, "cells", int32, mixed ? mixed_numbers(mesh) : cells, mixed ? 0 : laves__tet_width(mesh));
  laves__output_printf(out, "      </Topology>\n");
  write_names(out, mesh);
  write_attribute(out, name, "region", int32, cells);
  write_attribute(out, name, "class", "DataType=\"UChar\" Precision=\"1\"", cells);
  if (mesh->face_sources) write_attribute(out, name, "source_face", int32, cells);
  laves__output_printf(out, "    </Grid>\n  </Domain>\n</Xdmf>\n");
}
