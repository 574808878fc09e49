/* Meshes that were written come back the same from every format; damaged files are refused with a sentence. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "fixtures/folders.h"
#include "fixtures/tagged_cube.h"
#include "io/mesh_input.h"

static const struct {
  const char *name;
  laves_format format;
  bool ascii;
  int compression;
  bool names; /* the format keeps the names of groups */
} kinds[] = {
    {"zlib.vtu", LAVES_FORMAT_VTU, false, 6, true},        {"raw.vtu", LAVES_FORMAT_VTU, false, 0, true},
    {"ascii.vtu", LAVES_FORMAT_VTU, true, 0, true},        {"binary22.msh", LAVES_FORMAT_GMSH22, false, 0, true},
    {"ascii22.msh", LAVES_FORMAT_GMSH22, true, 0, true},   {"binary41.msh", LAVES_FORMAT_GMSH41, false, 0, true},
    {"ascii41.msh", LAVES_FORMAT_GMSH41, true, 0, true},   {"text.mesh", LAVES_FORMAT_MEDIT, true, 0, false},
    {"binary.meshb", LAVES_FORMAT_MEDIT, false, 0, false}, {"tetgen.node", LAVES_FORMAT_TETGEN, true, 0, false},
};

typedef struct fixture {
  laves_context *context;
  char folder[FIXTURE_FOLDER_MAX];
  char path[FIXTURE_FOLDER_MAX + 50];
} fixture;

static int set_up(void **state) {
  static fixture f;
  f.context = laves_context_create(NULL);
  *state = &f;
  return f.context && fixture_folder_make(f.folder) ? 0 : -1;
}

static int tear_down(void **state) {
  fixture *f = *state;
  const size_t leaked = laves_context_bytes(f->context);
  fixture_folder_remove(f->folder);
  laves_context_free(f->context);
  return leaked ? -1 : 0;
}

static void set_path(fixture *f, const char *name) { snprintf(f->path, sizeof f->path, "%s/%s", f->folder, name); }

static void write_kind(fixture *f, const laves_mesh *mesh, size_t kind) {
  laves_write_options options = laves_write_options_default();
  options.format = kinds[kind].format;
  options.ascii = kinds[kind].ascii;
  options.compression = kinds[kind].compression;
  set_path(f, kinds[kind].name);
  laves_error error = {0};
  if (laves_mesh_write(f->context, mesh, f->path, &options, &error) != LAVES_OK) fail_msg("%s: %s", f->path, error.text);
}

static laves_mesh *read_back(fixture *f) {
  laves_mesh *mesh;
  laves_error error = {0};
  if (laves_mesh_read(f->context, f->path, &mesh, &error) != LAVES_OK) fail_msg("%s", error.text);
  return mesh;
}

static void test_plain_round_trip(void **state) {
  fixture *f = *state;
  laves_mesh *mesh = fixture_plain_cube(f->context, 3);
  for (size_t k = 0; k < LAVES__COUNT_OF(kinds); k++) {
    write_kind(f, mesh, k);
    laves_mesh *back = read_back(f);
    assert_int_equal(back->vertex_count, mesh->vertex_count);
    assert_int_equal(back->tet_count, mesh->tet_count);
    assert_int_equal(back->face_count, mesh->face_count);
    assert_memory_equal(back->points, mesh->points, mesh->vertex_count * sizeof *mesh->points);
    assert_memory_equal(back->tets, mesh->tets, mesh->tet_count * sizeof *mesh->tets);
    assert_memory_equal(back->faces, mesh->faces, mesh->face_count * sizeof *mesh->faces);
    assert_null(back->regions);
    assert_null(back->face_tags);
    laves_mesh_free(back);
  }
  laves_mesh_free(mesh);
}

/* Gmsh's files want a name for everything; others keep those that there are. */
static void assert_tags(const laves_mesh *mesh, bool names, bool all_names) {
  for (size_t i = 0; i < mesh->tet_count; i++)
    assert_int_equal(mesh->regions[i], fixture_cube_region(fixture_centroid(mesh, mesh->tets[i], 4)));
  for (size_t i = 0; i < mesh->face_count; i++)
    assert_int_equal(mesh->face_tags[i], fixture_cube_tag(fixture_centroid(mesh, mesh->faces[i], 3)));
  if (!names) return;
  assert_string_equal(laves_mesh_group_name(mesh, 3, 3), "lower half");
  if (all_names)
    assert_string_equal(laves_mesh_group_name(mesh, 3, 7), "solid_7");
  else
    assert_null(laves_mesh_group_name(mesh, 3, 7));
  assert_string_equal(laves_mesh_group_name(mesh, 2, 11), "x high");
}

static void test_tagged_round_trip(void **state) {
  fixture *f = *state;
  laves_mesh *mesh = fixture_tagged_cube(f->context, 4);
  for (size_t k = 0; k < LAVES__COUNT_OF(kinds); k++) {
    write_kind(f, mesh, k);
    laves_mesh *back = read_back(f);
    assert_int_equal(back->tet_count, mesh->tet_count);
    assert_int_equal(back->face_count, mesh->face_count);
    assert_non_null(back->regions);
    assert_non_null(back->face_tags);
    assert_tags(back, kinds[k].names, kinds[k].format != LAVES_FORMAT_VTU);
    assert_true(fixture_volume(back) > 1 - 1e-12 && fixture_volume(back) < 1 + 1e-12);
    laves_mesh_free(back);
  }
  laves_mesh_free(mesh);
}

/* ---- other programs' files, by hand ---- */

/* Names that XML would take for markup; one for a region and a tag; and the sources of faces, which make triangles cells. */
static void test_names_and_sources_in_vtu(void **state) {
  fixture *f = *state;
  laves_mesh *mesh = fixture_tagged_cube(f->context, 2);
  assert_true(laves__mesh_add_group(mesh, 3, 7, "<a & \"b\">"));
  assert_true(laves__mesh_add_group(mesh, 2, 12, "<a & \"b\">"));
  assert_true(laves__mesh_add_group(mesh, 2, 13, "\xc3\xa9t\xc3\xa9"));
  mesh->face_sources = laves__alloc(f->context, mesh->face_count, sizeof *mesh->face_sources);
  for (size_t i = 0; i < mesh->face_count; i++) mesh->face_sources[i] = (int32_t)i - 1;
  for (size_t k = 0; kinds[k].format == LAVES_FORMAT_VTU; k++) {
    write_kind(f, mesh, k);
    laves_mesh *back = read_back(f);
    assert_string_equal(laves_mesh_group_name(back, 3, 7), "<a & \"b\">");
    assert_string_equal(laves_mesh_group_name(back, 2, 12), "<a & \"b\">");
    assert_string_equal(laves_mesh_group_name(back, 2, 13), "\xc3\xa9t\xc3\xa9");
    assert_string_equal(laves_mesh_group_name(back, 3, 3), "lower half");
    laves_mesh_free(back);
  }
  laves_mesh_free(mesh);
}

/* Sources are written for triangles, -1 for tets, even where there are no tags. */
static void test_sources_without_tags(void **state) {
  fixture *f = *state;
  laves_mesh *mesh = fixture_plain_cube(f->context, 1);
  mesh->face_sources = laves__alloc(f->context, mesh->face_count, sizeof *mesh->face_sources);
  for (size_t i = 0; i < mesh->face_count; i++) mesh->face_sources[i] = 100 + (int32_t)i;
  write_kind(f, mesh, 2);
  laves_mesh_free(mesh);
  FILE *file = fopen(f->path, "rb");
  char text[20000];
  assert_non_null(file);
  text[fread(text, 1, sizeof text - 1, file)] = 0;
  fclose(file);
  const char *array = strstr(text, "Name=\"source_face\"");
  assert_non_null(array);
  assert_non_null(strstr(array, "-1 -1 -1 -1 -1 -1 100 101 102 103 104 105\n106 107 108 109 110 111 \n"));
  assert_non_null(strstr(text, "NumberOfCells=\"18\""));
}

static void write_text(fixture *f, const char *name, const char *text) {
  set_path(f, name);
  FILE *file = fopen(f->path, "wb");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

static void test_ten_node_tet_and_sparse_numbers(void **state) {
  fixture *f = *state;
  write_text(f, "quadratic.msh",
             "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comments\nsomething else $ here\n$EndComments\n$Nodes\n10\n"
             "100 0 0 0\n7 1 0 0\n8 0 1 0\n9 0 0 1\n20 .5 0 0\n21 .5 .5 0\n22 0 .5 0\n23 0 0 .5\n24 0 .5 .5\n25 .5 0 .5\n"
             "$EndNodes\n$Elements\n3\n1 15 2 0 1 100\n2 9 2 5 1 100 8 7 22 21 20\n3 11 2 0 4 100 7 8 9 20 21 22 23 24 25\n"
             "$EndElements\n");
  laves_mesh *mesh = read_back(f);
  assert_int_equal(mesh->vertex_count, 4);
  assert_int_equal(mesh->tet_count, 1);
  assert_int_equal(mesh->regions[0], 4);
  assert_true(fixture_volume(mesh) > 0.16 && fixture_volume(mesh) < 0.17);
  int tagged = 0;
  for (size_t i = 0; i < 4; i++) tagged += mesh->face_tags[i] == 5;
  assert_int_equal(tagged, 1);
  laves_mesh_free(mesh);
}

static void test_base64_vtu(void **state) {
  fixture *f = *state;
  /* Inline base64 with 32-bit headers: offsets as Int8, header and data in one stream; types with the header on its own. */
  write_text(f, "inline.vtu",
             "<?xml version='1.0'?><!-- > -->\n<VTKFile type='UnstructuredGrid' byte_order='LittleEndian'><UnstructuredGrid>"
             "<Piece NumberOfPoints='4' NumberOfCells='1'><Points><DataArray type='Float32' NumberOfComponents='3' "
             "format='ascii'>0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells><DataArray type='UInt8' Name='connectivity' "
             "format='binary'>BAAAAAABAgM=</DataArray><DataArray type='Int8' Name='offsets' format='binary'>AQAAAAQ="
             "</DataArray><DataArray type='UInt8' Name='types' format='binary'>AQAAAA==Cg==</DataArray></Cells>"
             "<CellData><DataArray type='Float64' Name='MaterialIds' format='ascii'>12</DataArray></CellData>"
             "</Piece></UnstructuredGrid></VTKFile>");
  laves_mesh *mesh = read_back(f);
  assert_int_equal(mesh->tet_count, 1);
  assert_int_equal(mesh->tets[0][3], 3);
  assert_int_equal(mesh->regions[0], 12);
  laves_mesh_free(mesh);
}

static void test_tetgen_from_one(void **state) {
  fixture *f = *state;
  write_text(f, "one.node", "# points\n4 3 1 1\n1 0 0 0 0.5 1\n2 1 0 0 0.5 1\n3 0 1 0 0.5 1\n4 0 0 1 0.5 1\n");
  write_text(f, "one.ele", "1 4 1\n1 1 3 2 4 8\n");
  laves_mesh *mesh = read_back(f);
  assert_int_equal(mesh->tet_count, 1);
  assert_int_equal(mesh->regions[0], 8);
  assert_null(mesh->face_tags);
  assert_true(fixture_volume(mesh) > 0); /* the only tet was negative, so it was turned */
  laves_mesh_free(mesh);
}

/* Two tets and a triangle; regions and tags are cell data. */
static void test_legacy_vtk(void **state) {
  fixture *f = *state;
  static const char *const cells[] = {
      "CELLS 3 14\n4 0 1 2 3\n4 1 2 3 4\n3 0 2 1\n",
      "CELLS 4 11\nOFFSETS vtktypeint64\n0 4 8 11\nCONNECTIVITY vtktypeint64\n0 1 2 3 1 2 3 4 0 2 1\n"};
  static const char *const data[] = {
      "POINT_DATA 5\nSCALARS heat double\nLOOKUP_TABLE default\n1 2 3 4 5\nCELL_DATA 3\nSCALARS material int 1\nLOOKUP_TABLE "
      "default\n4 9 6\n",
      "CELL_DATA 3\nFIELD FieldData 2\nquality 1 3 double\n0.5 0.5 0.5\nregion 1 3 int\n4 9 6\n"};
  for (int form = 0; form < 2; form++) {
    char text[1200];
    snprintf(text, sizeof text,
             "# vtk DataFile Version %s\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\n"
             "%sCELL_TYPES 3\n10 10 5\n%s",
             form ? "5.1" : "3.0", cells[form], data[form]);
    write_text(f, "two.vtk", text);
    laves_mesh *mesh = read_back(f);
    assert_int_equal(mesh->tet_count, 2);
    assert_int_equal(mesh->vertex_count, 5);
    assert_non_null(mesh->regions);
    assert_int_equal(mesh->regions[0], 4);
    assert_int_equal(mesh->regions[1], 9);
    size_t tagged = 0;
    assert_non_null(mesh->face_tags);
    for (size_t i = 0; i < mesh->face_count; i++) tagged += mesh->face_tags[i] == 6;
    assert_int_equal(tagged, 1);
    laves_mesh_free(mesh);
  }
}

static char *put_big(char *at, uint64_t bits, int bytes) {
  for (int i = bytes - 1; i >= 0; i--) *at++ = (char)(bits >> 8 * i);
  return at;
}

static void test_binary_legacy_vtk(void **state) {
  fixture *f = *state;
  static const float points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  char text[400], *at = text;
  at += sprintf(at, "# vtk DataFile Version 3.0\none\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n");
  for (int i = 0; i < 12; i++) {
    uint32_t bits;
    memcpy(&bits, &points[i], sizeof bits);
    at = put_big(at, bits, 4);
  }
  at += sprintf(at, "\nCELLS 1 5\n");
  for (int i = 0; i < 5; i++) at = put_big(at, i == 0 ? 4 : (uint64_t)i - 1, 4);
  at += sprintf(at, "\nCELL_TYPES 1\n");
  at = put_big(at, 10, 4);
  at += sprintf(at, "\nCELL_DATA 1\nSCALARS region short\nLOOKUP_TABLE default\n");
  at = put_big(at, 7, 2);
  set_path(f, "binary.vtk");
  FILE *file = fopen(f->path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(text, 1, (size_t)(at - text), file), at - text);
  assert_int_equal(fclose(file), 0);
  laves_mesh *mesh = read_back(f);
  assert_int_equal(mesh->tet_count, 1);
  assert_float_equal(mesh->points[3].z, 1, 0);
  assert_int_equal(mesh->regions[0], 7);
  laves_mesh_free(mesh);
}

/* Numbers with gaps, an element over two lines, sets by card, list and range, and surfaces by set and by element. */
static void test_abaqus(void **state) {
  fixture *f = *state;
  write_text(f, "two.inp",
             "*Heading\n** a comment, with *NODE in it\n two tets\n*NODE, NSET=all\n1, 0, 0, 0\n2, 1., 0, 0\n3, 0, 1d0, 0\n"
             "4, 0, 0, 1\n10, 1,1,1\n*Element, type=C3D4H, elset=Core\n1, 1, 2, 3, 4\n*ELEMENT,TYPE=C3D4\n7, 2, 3,\n4, 10\n"
             "*Element, type=B31\n8, 1, 2\n*Elset, elset=shell, generate\n5, 9, 2\n*ELSET, ELSET=EVERYTHING\ncore, SHELL,\n"
             "*Surface, name=inlet, type=ELEMENT\nCORE, S1\n*Surface, name=outlet\n7, S3\n*Material, name=steel\n*Elastic\n"
             "210000., 0.3\n");
  laves_mesh *mesh = read_back(f);
  assert_int_equal(mesh->tet_count, 2);
  assert_int_equal(mesh->vertex_count, 5);
  assert_int_equal(mesh->regions[0], 1);
  assert_int_equal(mesh->regions[1], 2);
  assert_string_equal(laves_mesh_group_name(mesh, 3, 1), "Core");
  assert_string_equal(laves_mesh_group_name(mesh, 3, 2), "shell");
  assert_string_equal(laves_mesh_group_name(mesh, 2, 1), "inlet");
  assert_string_equal(laves_mesh_group_name(mesh, 2, 2), "outlet");
  for (size_t i = 0; i < mesh->face_count; i++) {
    const int32_t *c = mesh->faces[i];
    const int inlet = c[0] + c[1] + c[2] == 0 + 1 + 2, outlet = c[0] + c[1] + c[2] == 2 + 3 + 4 && c[0] && c[1] && c[2];
    const bool has_1 = c[0] == 1 || c[1] == 1 || c[2] == 1;
    assert_int_equal(mesh->face_tags[i], inlet ? 1 : outlet && !has_1 ? 2 : 0);
  }
  laves_mesh_free(mesh);
  write_text(f, "ten.inp",
             "*node\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,.5,0,0\n6,.5,.5,0\n7,0,.5,0\n8,0,0,.5\n9,.5,0,.5\n10,0,.5,.5\n"
             "*element,type=c3d10\n1,1,2,3,4,5,6,7,\n8,9,10\n*element, type=CPS6, elset=wall\n2, 1, 2, 4, 5, 9, 8\n");
  mesh = read_back(f);
  assert_int_equal(mesh->vertex_count, 4);
  assert_null(mesh->regions);
  assert_string_equal(laves_mesh_group_name(mesh, 2, 1), "wall");
  laves_mesh_free(mesh);
}

static void assert_refused(fixture *f, const char *name, const char *text, const char *sentence_part) {
  write_text(f, name, text);
  laves_mesh *mesh;
  laves_error error = {0};
  assert_int_equal(laves_mesh_read(f->context, f->path, &mesh, &error), LAVES_ERROR_INPUT);
  assert_null(mesh);
  if (!strstr(error.text, sentence_part)) fail_msg("'%s' is not in '%s'", sentence_part, error.text);
}

static void test_refused(void **state) {
  fixture *f = *state;
  assert_refused(f, "empty", "", "not a tetrahedral mesh of a format that is known");
  assert_refused(f, "a.vtkhdf", "\211HDF\r\n", "HDF5, as VTKHDF and XDMF are");
  assert_refused(f, "a.exo", "CDF\005", "NetCDF, as Exodus is");
  assert_refused(f, "a.npz", "PK\003\004", "a zip archive, as NPZ is");
  assert_refused(f, "a.stl", "solid a\n", "a surface by its name");
  assert_refused(f, "a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n1\n0 0 0 0\nEnd\n", "no tetrahedra");
  assert_refused(f, "a.mesh", "MeshVersionFormatted 2\nDimension 2\n", "line 2: the dimension is 2");
  assert_refused(f, "a.mesh", "MeshVersionFormatted 2\nVertices\n99999\n0 0 0 0\n", "count that the file has room for");
  assert_refused(f, "a.mesh", "MeshVersionFormatted 2\nVertices 1 0 0 0 0 Tetrahedra 1 1 1 1 7 0\n",
                 "tetrahedron 1 uses vertex 7, but there are 1");
  assert_refused(f, "a.msh", "$MeshFormat\n4 0 8\n$EndMeshFormat\n", "version 4 of the Gmsh format is not known");
  assert_refused(f, "a.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 1 1 1\n", "expected a block of nodes");
  assert_refused(f, "a.vtu", "<VTKFile type='PolyData'>", "not of an unstructured grid");
  assert_refused(f, "a.vtu", "<VTKFile type='UnstructuredGrid' compressor='vtkLZ4DataCompressor'>", "vtkLZ4DataCompressor");
  assert_refused(f, "a.vtu",
                 "<VTKFile type='UnstructuredGrid'><Piece NumberOfPoints='1000000' NumberOfCells='0'><Points>"
                 "<DataArray type='Float64' format='ascii'>0</DataArray></Points>",
                 "shorter than announced");
  assert_refused(f, "a.node", "2 3 0 0\n5 0 0 0\n", "points must be numbered");
  assert_refused(f, "a.vtk", "# vtk DataFile Version 3.0\n\nASCII\nDATASET STRUCTURED_POINTS\n", "STRUCTURED_POINTS");
  assert_refused(f, "a.vtk", "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 double\n0 0\n",
                 "a coordinate");
  assert_refused(f, "a.vtk",
                 "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 double\n0 0 0\nCELLS 1 5\n4 0 0 0 7\n"
                 "CELL_TYPES 1\n10\n",
                 "tetrahedron 1 uses vertex 8, but there are 1");
  assert_refused(f, "a.vtk",
                 "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 0 double\nCELLS 0 0\nCELL_TYPES 1\n10\n",
                 "there are 1 types, but 0 cells");
  assert_refused(f, "a.inp", "*NODE\n1, 0, zero, 0\n", "line 2: expected a coordinate, not 'zero'");
  assert_refused(f, "a.inp", "*NODE\n1, 0, 0, 0\n1, 1, 0, 0\n", "node 1 is given twice");
  assert_refused(f, "a.inp", "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n",
                 "element 1 uses node 2, which there is not");
  assert_refused(f, "a.inp", "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 2,", "the file ends within an element");
  assert_refused(f, "a.inp", "*NODE\n1,0,0,0\n*INCLUDE, INPUT=b.inp\n", "files that include others are not read");
  assert_refused(f, "b.ele", "0 4 0\n", "b.node");
}

/* ---- damaged files ---- */

typedef laves_result read_fn(laves__mesh_input *input, laves_error *error);

static laves_result parse(laves_context *context, read_fn *read, const char *bytes, size_t length) {
  laves__mesh_input input = {.context = context, .name = "damaged", .begin = bytes, .end = bytes + length};
  laves_mesh *mesh = NULL;
  laves_error error = {0};
  laves_result result = read(&input, &error);
  if (result == LAVES_OK) result = laves__mesh_input_finish(&input, &mesh, &error);
  if (result != LAVES_OK) assert_true(error.text[0] != 0 && error.result == result);
  laves_mesh_free(mesh);
  laves__mesh_input_free(&input);
  return result;
}

static read_fn *reader_of(laves_format format, const char *name) {
  switch (format) {
    case LAVES_FORMAT_VTU:
      return laves__read_vtu;
    case LAVES_FORMAT_MEDIT:
      return strstr(name, ".meshb") ? laves__read_medit_binary : laves__read_medit_text;
    default:
      return laves__read_gmsh;
  }
}

static char *load(const char *path, size_t *length) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  char *bytes = malloc(1 << 20);
  *length = fread(bytes, 1, 1 << 20, file);
  fclose(file);
  return realloc(bytes, *length); /* exact, so that the sanitizer sees the end */
}

/* Cut at every byte: never crashes, leaks or hangs, and fails unless only the end marks are missing. */
static void test_truncated(void **state) {
  fixture *f = *state;
  laves_mesh *mesh = fixture_tagged_cube(f->context, 2);
  for (size_t k = 0; k < LAVES__COUNT_OF(kinds); k++) {
    if (kinds[k].format == LAVES_FORMAT_TETGEN) continue;
    write_kind(f, mesh, k);
    size_t length;
    char *bytes = load(f->path, &length);
    read_fn *read = reader_of(kinds[k].format, kinds[k].name);
    assert_int_equal(parse(f->context, read, bytes, length), LAVES_OK);
    for (size_t cut = 0; cut < length; cut += 1 + cut / 500) {
      char *part = malloc(cut ? cut : 1);
      memcpy(part, bytes, cut);
      const laves_result result = parse(f->context, read, part, cut);
      if (result == LAVES_OK && cut < length / 2) fail_msg("%s cut to %zu bytes was read", kinds[k].name, cut);
      free(part);
    }
    free(bytes);
  }
  laves_mesh_free(mesh);
}

/* Single bytes changed: whatever comes out, nothing breaks. */
static void test_changed_bytes(void **state) {
  fixture *f = *state;
  laves_mesh *mesh = fixture_tagged_cube(f->context, 2);
  uint32_t random = 12345;
  for (size_t k = 0; k < LAVES__COUNT_OF(kinds); k++) {
    if (kinds[k].format == LAVES_FORMAT_TETGEN) continue;
    write_kind(f, mesh, k);
    size_t length;
    char *bytes = load(f->path, &length);
    for (int i = 0; i < 300; i++) {
      random = random * 1664525 + 1013904223;
      const size_t at = (random >> 8) % length;
      const char kept = bytes[at];
      bytes[at] = (char)(random >> 24);
      parse(f->context, reader_of(kinds[k].format, kinds[k].name), bytes, length);
      bytes[at] = kept;
    }
    free(bytes);
  }
  laves_mesh_free(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_plain_round_trip, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_tagged_round_trip, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_ten_node_tet_and_sparse_numbers, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_names_and_sources_in_vtu, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_sources_without_tags, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_base64_vtu, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_legacy_vtk, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_binary_legacy_vtk, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_abaqus, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_tetgen_from_one, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_refused, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_truncated, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_changed_bytes, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
