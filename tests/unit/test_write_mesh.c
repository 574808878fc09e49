/* Meshes out: failures leave nothing behind, bytes do not depend on threads, and the text is what the formats say. What the
 * files mean is tested by reading them back (test_read_mesh.c) and by other programs (tests/referee). */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "fixtures/folders.h"
#include "fixtures/tagged_cube.h"

static const char *const names[] = {"a.vtu", "a.msh", "a.mesh", "a.meshb", "a.node", "a.vtkhdf", "a.vtk", "a.xdmf",
                                    "a.exo", "a.inp", "a.bdf",  "a.npz",   "a.stl",  "a.obj",    "a.ply", "a.off"};

typedef struct fixture {
  laves_context *context;
  laves_mesh *mesh;
  char folder[FIXTURE_FOLDER_MAX];
} fixture;

static int set_up(void **state) {
  static fixture f;
  f.context = laves_context_create(NULL);
  f.mesh = fixture_tagged_cube(f.context, 2);
  *state = &f;
  return fixture_folder_make(f.folder) ? 0 : -1;
}

static int tear_down(void **state) {
  fixture *f = *state;
  laves_mesh_free(f->mesh);
  const size_t leaked = laves_context_bytes(f->context);
  fixture_folder_remove(f->folder);
  laves_context_free(f->context);
  return leaked ? -1 : 0;
}

static const char *path_in(const fixture *f, const char *name) {
  static char path[FIXTURE_FOLDER_MAX + 100];
  snprintf(path, sizeof path, "%s/%s", f->folder, name);
  return path;
}

static void test_refused(void **state) {
  fixture *f = *state;
  laves_error error = {0};
  laves_write_options options = laves_write_options_default();
  assert_int_equal(laves_mesh_write(f->context, f->mesh, "mesh.xyz", NULL, &error), LAVES_ERROR_OPTION);
  assert_non_null(strstr(error.text, "'mesh.xyz' does not say"));
  options.compression = 10;
  assert_int_equal(laves_mesh_write(f->context, f->mesh, "mesh.vtu", &options, &error), LAVES_ERROR_OPTION);
  options = (laves_write_options){0};
  assert_int_equal(laves_mesh_write(f->context, f->mesh, "mesh.vtu", &options, &error), LAVES_ERROR_OPTION);
  options = laves_write_options_default();
  options.format = LAVES_FORMAT_COUNT;
  assert_int_equal(laves_mesh_write(f->context, f->mesh, path_in(f, "a"), &options, &error), LAVES_ERROR_OPTION);
  assert_int_equal(laves_mesh_write(f->context, f->mesh, path_in(f, "missing/a.node"), NULL, &error), LAVES_ERROR_WRITE);
  assert_int_equal(fixture_folder_count(f->folder), 0);
}

/* With too little memory at whatever point, there is an error and no file. */
static void test_out_of_memory(void **state) {
  fixture *f = *state;
  laves_context_options options = laves_context_options_default();
  options.thread_count = 2;
  for (size_t n = 0; n < LAVES__COUNT_OF(names); n++)
    for (size_t limit = 1000; limit < 1 << 22; limit += limit / 3) {
      options.memory_limit = limit;
      const int files = fixture_folder_count(f->folder); /* of formats that were done */
      laves_context *context = laves_context_create(&options);
      laves_error error = {0};
      const laves_result result = laves_mesh_write(context, f->mesh, path_in(f, names[n]), NULL, &error);
      assert_int_equal(laves_context_bytes(context), 0);
      laves_context_free(context);
      if (result == LAVES_OK) break;
      assert_int_equal(result, LAVES_ERROR_MEMORY);
      assert_int_equal(fixture_folder_count(f->folder), files);
    }
}

static bool never(void *user, const char *phase, double fraction) {
  (void)user;
  (void)phase;
  return fraction < 0;
}

static void test_cancelled(void **state) {
  fixture *f = *state;
  laves_context_options options = laves_context_options_default();
  options.progress = never;
  laves_context *context = laves_context_create(&options);
  for (size_t n = 0; n < LAVES__COUNT_OF(names); n++) {
    const laves_result result = laves_mesh_write(context, f->mesh, path_in(f, names[n]), NULL, NULL);
    assert_int_equal(result, LAVES_ERROR_CANCELLED);
    assert_int_equal(fixture_folder_count(f->folder), 0);
  }
  laves_context_free(context);
}

static void test_full_disk(void **state) {
  fixture *f = *state;
  laves_write_options options = laves_write_options_default();
  for (int format = LAVES_FORMAT_VTU; format < LAVES_FORMAT_COUNT; format++) {
    if (format == LAVES_FORMAT_TETGEN || format == LAVES_FORMAT_XDMF) continue; /* several files */
    options.format = (laves_format)format;
    laves_error error = {0};
    assert_int_equal(laves_mesh_write(f->context, f->mesh, "/dev/full", &options, &error), LAVES_ERROR_WRITE);
    assert_non_null(strstr(error.text, "No space left"));
  }
}

/* The middle one of TetGen's files cannot be replaced: none is. */
static void test_tetgen_together(void **state) {
  fixture *f = *state;
  laves_error error = {0};
  char folder[FIXTURE_FOLDER_MAX + 100];
  snprintf(folder, sizeof folder, "%s", path_in(f, "a.ele"));
  assert_int_equal(mkdir(folder, 0777), 0);
  assert_int_equal(laves_mesh_write(f->context, f->mesh, path_in(f, "a.node"), NULL, &error), LAVES_ERROR_WRITE);
  assert_non_null(strstr(error.text, "is a folder"));
  assert_int_equal(fixture_folder_count(f->folder), 1);
  rmdir(folder);
  assert_int_equal(laves_mesh_write(f->context, f->mesh, path_in(f, "a.node"), NULL, &error), LAVES_OK);
  assert_int_equal(fixture_folder_count(f->folder), 3);
}

/* XDMF's XML cannot be replaced: neither are the arrays. */
static void test_xdmf_together(void **state) {
  fixture *f = *state;
  laves_error error = {0};
  char folder[FIXTURE_FOLDER_MAX + 100];
  snprintf(folder, sizeof folder, "%s", path_in(f, "a.xdmf"));
  assert_int_equal(mkdir(folder, 0777), 0);
  assert_int_equal(laves_mesh_write(f->context, f->mesh, path_in(f, "a.xdmf"), NULL, &error), LAVES_ERROR_WRITE);
  assert_non_null(strstr(error.text, "is a folder"));
  assert_int_equal(fixture_folder_count(f->folder), 1);
  rmdir(folder);
  assert_int_equal(laves_mesh_write(f->context, f->mesh, path_in(f, "a.xdmf"), NULL, &error), LAVES_OK);
  assert_int_equal(fixture_folder_count(f->folder), 2);
  assert_int_equal(access(path_in(f, "a.h5"), F_OK), 0);
  laves_write_options options = laves_write_options_default();
  options.format = LAVES_FORMAT_XDMF;
  assert_int_equal(laves_mesh_write(f->context, f->mesh, path_in(f, "b.x"), &options, &error), LAVES_OK);
  assert_int_equal(access(path_in(f, "b.x.h5"), F_OK), 0);
}

static size_t load(const char *path, char *bytes, size_t capacity) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  const size_t length = fread(bytes, 1, capacity, file);
  fclose(file);
  assert_true(length < capacity);
  bytes[length] = 0;
  return length;
}

enum { CAPACITY = 1 << 22 };

static void test_same_bytes_for_any_threads(void **state) {
  fixture *f = *state;
  laves_mesh *mesh = fixture_tagged_cube(f->context, 20);
  char *bytes[2] = {malloc(CAPACITY), malloc(CAPACITY)};
  for (size_t n = 0; n < LAVES__COUNT_OF(names); n++) {
    size_t lengths[2];
    for (int i = 0; i < 2; i++) {
      laves_context_options options = laves_context_options_default();
      options.thread_count = i == 0 ? 1 : 5;
      laves_context *context = laves_context_create(&options);
      assert_int_equal(laves_mesh_write(context, mesh, path_in(f, names[n]), NULL, NULL), LAVES_OK);
      laves_context_free(context);
      lengths[i] = load(path_in(f, names[n]), bytes[i], CAPACITY);
    }
    assert_int_equal(lengths[0], lengths[1]);
    assert_memory_equal(bytes[0], bytes[1], lengths[0]);
  }
  free(bytes[0]);
  free(bytes[1]);
  laves_mesh_free(mesh);
}

/* One tet, so that the whole text can be compared. */
static void assert_text(fixture *f, const char *name, laves_format format, const char *expected) {
  const double points[4][3] = {{0, 0, 0}, {0.1, 0, 0}, {0, 1, 0}, {0, 0, 1e-9}};
  const int32_t tet[4] = {0, 1, 2, 3};
  laves_mesh *mesh;
  assert_int_equal(laves_mesh_from_arrays(f->context, points[0], 4, tet, 1, NULL, &mesh, NULL), LAVES_OK);
  laves_write_options options = laves_write_options_default();
  options.ascii = true;
  options.format = format;
  assert_int_equal(laves_mesh_write(f->context, mesh, path_in(f, name), &options, NULL), LAVES_OK);
  laves_mesh_free(mesh);
  char text[4000];
  load(path_in(f, name), text, sizeof text);
  assert_string_equal(text, expected);
}

static void test_texts(void **state) {
  fixture *f = *state;
  assert_text(f, "one.off", LAVES_FORMAT_AUTO,
              "OFF\n4 4 0\n0 0 0\n0.1 0 0\n0 1 0\n0 0 1e-9\n3 1 2 3\n3 0 3 2\n3 0 1 3\n3 0 2 1\n");
  assert_text(f, "one.obj", LAVES_FORMAT_AUTO,
              "v 0 0 0\nv 0.1 0 0\nv 0 1 0\nv 0 0 1e-9\ng boundary\nf 2 3 4\nf 1 4 3\nf 1 2 4\nf 1 3 2\n");
  assert_text(f, "one.mesh", LAVES_FORMAT_AUTO,
              "MeshVersionFormatted 2\nDimension 3\n\nVertices\n4\n0 0 0 0\n0.1 0 0 0\n0 1 0 0\n0 0 1e-9 0\n\nTetrahedra\n1\n"
              "1 2 3 4 1\n\nTriangles\n4\n2 3 4 1\n1 4 3 1\n1 2 4 1\n1 3 2 1\n\nEnd\n");
  assert_text(f, "one.msh", LAVES_FORMAT_GMSH22,
              "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"boundary\"\n3 1 \"solid\"\n$EndPhysicalNames\n"
              "$Nodes\n4\n1 0 0 0\n2 0.1 0 0\n3 0 1 0\n4 0 0 1e-9\n$EndNodes\n$Elements\n5\n1 2 2 1 1 2 3 4\n"
              "2 2 2 1 1 1 4 3\n3 2 2 1 1 1 2 4\n4 2 2 1 1 1 3 2\n5 4 2 1 1 1 2 3 4\n$EndElements\n");
  assert_text(f, "one.vtk", LAVES_FORMAT_AUTO,
              "# vtk DataFile Version 3.0\ntetrahedral mesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0\n0.1 0 0\n"
              "0 1 0\n0 0 1e-9\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nCELL_DATA 1\nFIELD FieldData 2\nregion 1 1 int\n1\n"
              "class 1 1 unsigned_char\n1\n");
  assert_text(
      f, "one.inp", LAVES_FORMAT_AUTO,
      "*HEADING\n4 vertices, 1 tetrahedra\n*NODE, NSET=Nall\n1, 0., 0., 0.\n2, .1, 0., 0.\n3, 0., 1., 0.\n4, 0., 0., 1.E-9\n"
      "*ELEMENT, TYPE=C3D4, ELSET=solid\n1, 1, 2, 3, 4\n*NSET, NSET=boundary\n2, 3, 4, 1\n*ELSET, ELSET=boundary_S1\n1\n"
      "*ELSET, ELSET=boundary_S2\n1\n*ELSET, ELSET=boundary_S3\n1\n*ELSET, ELSET=boundary_S4\n1\n"
      "*SURFACE, NAME=boundary, TYPE=ELEMENT\nboundary_S1, S1\nboundary_S2, S2\nboundary_S3, S3\nboundary_S4, S4\n");
  assert_text(f, "one.bdf", LAVES_FORMAT_AUTO,
              "$ 4 vertices, 1 tetrahedra\n$ CTETRA 1 solid\n$ CTRIA3 11 boundary\nBEGIN BULK\n"
              "GRID*   1                               0.              0.              \n*       0.              \n"
              "GRID*   2                               .1              0.              \n*       0.              \n"
              "GRID*   3                               0.              1.              \n*       0.              \n"
              "GRID*   4                               0.              0.              \n*       1.E-9           \n"
              "CTETRA  1       1       1       2       3       4       \nCTRIA3  2       11      2       3       4       \n"
              "CTRIA3  3       11      1       4       3       \nCTRIA3  4       11      1       2       4       \n"
              "CTRIA3  5       11      1       3       2       \nENDDATA\n");
  assert_text(f, "one.xdmf", LAVES_FORMAT_AUTO,
              "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n    <Grid Name=\"Grid\" GridType=\"Uniform\">\n"
              "      <Geometry GeometryType=\"XYZ\">\n"
              "        <DataItem Format=\"HDF\" DataType=\"Float\" Precision=\"8\" Dimensions=\"4 3\">one.h5:/points</DataItem>\n"
              "      </Geometry>\n      <Topology TopologyType=\"Tetrahedron\" NumberOfElements=\"1\">\n"
              "        <DataItem Format=\"HDF\" DataType=\"Int\" Precision=\"4\" Dimensions=\"1 4\">one.h5:/cells</DataItem>\n"
              "      </Topology>\n      <Attribute Name=\"region\" AttributeType=\"Scalar\" Center=\"Cell\">\n"
              "        <DataItem Format=\"HDF\" DataType=\"Int\" Precision=\"4\" Dimensions=\"1\">one.h5:/region</DataItem>\n"
              "      </Attribute>\n      <Attribute Name=\"class\" AttributeType=\"Scalar\" Center=\"Cell\">\n"
              "        <DataItem Format=\"HDF\" DataType=\"UChar\" Precision=\"1\" Dimensions=\"1\">one.h5:/class</DataItem>\n"
              "      </Attribute>\n    </Grid>\n  </Domain>\n</Xdmf>\n");
}

/* Names that are no labels, or one label: all groups stay apart. The tag 0 has formats number from 1. */
static void test_labels(void **state) {
  fixture *f = *state;
  laves_mesh *mesh = fixture_tagged_cube(f->context, 2);
  for (size_t i = 0; i < mesh->face_count; i++) mesh->face_tags[i] -= 10;
  for (size_t i = 0; i < mesh->group_count; i++)
    if (mesh->groups[i].dimension == 2) mesh->groups[i].tag -= 10;
  static const char *const more[] = {"X.LOW", "7th, odd", "x_low_2"};
  for (int i = 0; i < 3; i++) assert_true(laves__mesh_add_group(mesh, 2, 2 + i, more[i]));
  assert_int_equal(laves_mesh_write(f->context, mesh, path_in(f, "a.inp"), NULL, NULL), LAVES_OK);
  assert_int_equal(laves_mesh_write(f->context, mesh, path_in(f, "a.bdf"), NULL, NULL), LAVES_OK);
  char *text = malloc(1 << 20);
  load(path_in(f, "a.inp"), text, 1 << 20);
  static const char *const labels[] = {"x_low", "x_high", "X_LOW_3", "boundary_7th__odd", "x_low_2", "boundary_5"};
  for (size_t i = 0; i < LAVES__COUNT_OF(labels); i++) {
    char line[200];
    snprintf(line, sizeof line, "*SURFACE, NAME=%s, TYPE=ELEMENT\n", labels[i]);
    if (!strstr(text, line)) fail_msg("there is no surface '%s'", labels[i]);
  }
  assert_non_null(strstr(text, "*ELEMENT, TYPE=C3D4, ELSET=lower_half\n"));
  load(path_in(f, "a.bdf"), text, 1 << 20);
  assert_non_null(strstr(text, "$ CTETRA 7 solid_7\n")); /* tags are 1 .. 6, regions 3 and 7 */
  assert_non_null(strstr(text, "$ CTRIA3 11 x low\n"));
  free(text);
  laves_mesh_free(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_refused, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_out_of_memory, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_cancelled, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_full_disk, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_tetgen_together, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_same_bytes_for_any_threads, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_texts, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_xdmf_together, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_labels, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
