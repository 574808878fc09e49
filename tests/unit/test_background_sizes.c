/* Sizes from files: exact where the format is, held outside, chosen by name, and refused with a sentence when wrong. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/assert_close.h"
#include "fixtures/folders.h"
#include "fixtures/size_files.h"
#include "size/background.h"

typedef struct fixture {
  laves_context *context;
  char folder[FIXTURE_FOLDER_MAX];
  char path[FIXTURE_FOLDER_MAX + 50];
  laves_error error;
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

static void write_file(fixture *f, const char *name, const void *bytes, size_t length) {
  snprintf(f->path, sizeof f->path, "%s/%s", f->folder, name);
  FILE *file = fopen(f->path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, length, file), length);
  fclose(file);
}

static laves__background_sizes *load(fixture *f, const char *array) {
  laves__background_sizes *sizes;
  if (laves__background_load(f->context, f->path, array, &sizes, &f->error) != LAVES_OK) fail_msg("%s", f->error.text);
  return sizes;
}

static laves__background_sizes *load_text(fixture *f, const char *name, const char *text, const char *array) {
  write_file(f, name, text, strlen(text));
  return load(f, array);
}

static void assert_refused(fixture *f, const char *name, const char *text, const char *array, const char *sentence) {
  laves__background_sizes *sizes;
  write_file(f, name, text, strlen(text));
  assert_int_equal(laves__background_load(f->context, f->path, array, &sizes, &f->error), LAVES_ERROR_INPUT);
  assert_null(sizes);
  if (!strstr(f->error.text, sentence)) fail_msg("'%s' is not in '%s'", sentence, f->error.text);
}

static double size_at(const laves__background_sizes *sizes, double x, double y, double z) {
  const laves__vec3 p = v3(x, y, z);
  double size = 0;
  laves__background_evaluate(sizes, 1, &p, &size);
  return size;
}

/* ---- all formats ---- */

static double clamped(double x) { return x < 0 ? 0 : x > 1 ? 1 : x; }

/* A grid of places of the unit cube and beyond: the nearest point of a cube is its place held within. */
static void assert_linear(const laves__background_sizes *sizes, const char *name) {
  for (int i = 0; i < 15 * 15 * 15; i++) {
    const laves__vec3 p = v3(-0.5 + i % 15 / 7.0, -0.5 + i / 15 % 15 / 7.0, -0.5 + (double)(i / 225) / 7.0);
    const double expected = size_of(v3(clamped(p.x), clamped(p.y), clamped(p.z)));
    const double found = size_at(sizes, p.x, p.y, p.z);
    if (!(fabs(found - expected) <= 1e-12)) fail_msg("%s at %g %g %g: %.17g, not %.17g", name, p.x, p.y, p.z, found, expected);
  }
}

static void linear_sizes_are_reproduced(void **state) {
  fixture *f = *state;
  for (int kind = 0; kind < SIZE_FILE_KINDS; kind++)
    for (int cells = 1; cells <= 4; cells += 3) {
      size_file file = fixture_size_file(kind, cells);
      assert_non_null(file.bytes);
      write_file(f, file.name, file.bytes, file.length);
      laves__background_sizes *sizes = load(f, NULL);
      assert_linear(sizes, file.name);
      laves__background_free(sizes);
      free(file.bytes);
    }
}

/* A cut file is refused, or, where only an end was lost that nothing depends on, read as if whole. */
static void cut_files_do_no_harm(void **state) {
  fixture *f = *state;
  for (int kind = 0; kind < SIZE_FILE_KINDS; kind++) {
    size_file file = fixture_size_file(kind, 1);
    for (size_t length = 0; length < file.length; length++) {
      laves__background_sizes *sizes;
      char *cut = malloc(length ? length : 1); /* of just its size, so that sanitizers see a step beyond */
      memcpy(cut, file.bytes, length);
      const laves_result result = laves__background_parse(f->context, file.name, cut, length, NULL, &sizes, &f->error);
      if (result == LAVES_OK && length + 70 < file.length)
        fail_msg("%s: read with %zu of %zu bytes", file.name, length, file.length);
      if (result == LAVES_OK) assert_true(size_at(sizes, 0.5, 0.5, 0.5) > 0);
      if (result != LAVES_OK) assert_int_equal(result, LAVES_ERROR_INPUT);
      laves__background_free(sizes);
      free(cut);
    }
    free(file.bytes);
  }
}

static void places_that_are_no_places_have_sizes(void **state) {
  fixture *f = *state;
  static const double odd[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300, 1e-300};
  for (int kind = 0; kind < SIZE_FILE_KINDS; kind++) {
    size_file file = fixture_size_file(kind, 2);
    write_file(f, file.name, file.bytes, file.length);
    laves__background_sizes *sizes = load(f, NULL);
    for (size_t i = 0; i < LAVES__COUNT_OF(odd); i++) {
      const double size = size_at(sizes, odd[i], 0.5, 0.5);
      if (!(size >= 0.39 && size <= 1.51)) fail_msg("%s: %g", file.name, size);
    }
    laves__background_free(sizes);
    free(file.bytes);
  }
}

static void short_memory_is_told(void **state) {
  fixture *f = *state;
  for (int kind = 0; kind < SIZE_FILE_KINDS; kind++) {
    size_file file = fixture_size_file(kind, 2);
    write_file(f, file.name, file.bytes, file.length);
    laves_result result = LAVES_ERROR_MEMORY;
    for (size_t limit = 100; result != LAVES_OK && limit < 1000000; limit += 100 + limit / 10) {
      laves_context_options options = laves_context_options_default();
      options.memory_limit = limit;
      laves_context *context = laves_context_create(&options);
      laves__background_sizes *sizes;
      result = laves__background_load(context, f->path, NULL, &sizes, &f->error);
      if (result != LAVES_OK && result != LAVES_ERROR_MEMORY) fail_msg("%s with %zu bytes: %s", file.name, limit, f->error.text);
      laves__background_free(sizes);
      assert_int_equal(laves_context_bytes(context), 0);
      laves_context_free(context);
    }
    assert_int_equal(result, LAVES_OK);
    free(file.bytes);
  }
}

static bool say_no(void *user, const char *phase, double fraction) {
  assert_string_equal(phase, "read");
  assert_true(fraction >= 0 && fraction <= 1);
  ++*(int *)user;
  return false;
}

static void meshes_can_be_cancelled(void **state) {
  fixture *f = *state;
  int asked = 0;
  laves_context_options options = laves_context_options_default();
  options.progress = say_no;
  options.progress_user = &asked;
  laves_context *context = laves_context_create(&options);
  size_file file = fixture_size_file(SIZE_FILE_KINDS - 1, 2);
  laves__background_sizes *sizes;
  assert_int_equal(laves__background_parse(context, file.name, file.bytes, file.length, NULL, &sizes, &f->error),
                   LAVES_ERROR_CANCELLED);
  assert_null(sizes);
  assert_int_equal(asked, 1);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
  free(file.bytes);
}

/* ---- NRRD ---- */

#define NRRD "NRRD0004\ntype: double\ndimension: 3\nencoding: ascii\n"
#define ROW "sizes: 3 1 1\n"

static void images_stand_where_their_header_says(void **state) {
  fixture *f = *state;
  static const struct {
    const char *header;
    double first, step;
  } rows[] = {
      {"spacings: 2 1 1\n", 0, 2},
      {"spacings: 2 1 1\ncenterings: cell cell cell\n", 1, 2},
      {"spacings: nan 1 1\naxis mins: 10 0 0\naxis maxs: 14 1 1\ncenters: node node node\n", 10, 2},
      {"spacings: nan 1 1\naxismins: 10 0 0\naxismaxs: 16 1 1\ncenterings: cell node none\n", 11, 2},
      {"spacings: 2 1 1\naxis maxs: 14 nan nan\n", 10, 2},
      {"spacings: -2 1 1\n", 0, -2},
      {"space: left-posterior-superior\nspace directions: (2, 0, 0) (0,1,0) (0,0,-1)\nspace origin: (-5,7,8)\n", -5, 2},
      {"space directions: (2,0,0) (0,1,0) (0,0,1)\n", 0, 2},
  };
  for (size_t i = 0; i < LAVES__COUNT_OF(rows); i++) {
    char text[500];
    snprintf(text, sizeof text, NRRD ROW "%s\n1 2 4\n", rows[i].header);
    laves__background_sizes *sizes = load_text(f, "row.nrrd", text, NULL);
    for (int k = 0; k <= 2; k++)
      assert_close(size_at(sizes, rows[i].first + k * rows[i].step, 0.3, 9), k == 2 ? 4 : k + 1, 1e-12);
    assert_close(size_at(sizes, rows[i].first + 1.5 * rows[i].step, 0, 0), 3, 1e-12);
    assert_close(size_at(sizes, rows[i].first - rows[i].step, 0, 0), 1, 0);
    laves__background_free(sizes);
  }
}

static void slanted_images_are_followed(void **state) {
  fixture *f = *state;
  laves__background_sizes *sizes = load_text(
      f, "slant.nrrd",
      NRRD "sizes: 2 2 2\nspace directions: (1,1,0) (-1,1,0) (0,0,2)\nspace origin: (1,2,3)\n\n1 2 3 4 5 6 7 8\n", NULL);
  assert_close(size_at(sizes, 1, 2, 3), 1, 1e-12);
  assert_close(size_at(sizes, 2, 3, 3), 2, 1e-12);
  assert_close(size_at(sizes, 0, 3, 3), 3, 1e-12);
  assert_close(size_at(sizes, 1, 4, 5), 8, 1e-12);
  assert_close(size_at(sizes, 1, 3, 4), 4.5, 1e-12);
  laves__background_free(sizes);
}

/* The numbers 1, 2, 3 in each type, and one that needs the sign or the last byte. */
static void all_types_are_read(void **state) {
  fixture *f = *state;
  static const struct {
    const char *name;
    size_t bytes;
    double largest;
  } types[] = {
      {"signed char", 1, 127},  {"uchar", 1, 255},
      {"short", 2, 32767},      {"uint16", 2, 65535},
      {"int", 4, 2147483647.0}, {"uint32_t", 4, 4294967295.0},
      {"longlong", 8, 0x1p62},  {"unsigned long long int", 8, 0x1p63},
  };
  for (size_t i = 0; i < LAVES__COUNT_OF(types); i++) {
    char bytes[300];
    const int head = snprintf(
        bytes, sizeof bytes, "NRRD0001\ndimension: 3\nsizes: 2 1 1\nspacings: 1 1 1\ntype: %s\nendian: little\nencoding: raw\n\n",
        types[i].name);
    const uint64_t samples[2] = {3, (uint64_t)types[i].largest};
    for (int s = 0; s < 2; s++) memcpy(bytes + head + s * (int)types[i].bytes, &samples[s], types[i].bytes);
    write_file(f, "type.nrrd", bytes, (size_t)head + 2 * types[i].bytes);
    laves__background_sizes *sizes = load(f, NULL);
    assert_close(size_at(sizes, 0, 0, 0), 3, 0);
    assert_close(size_at(sizes, 1, 0, 0), types[i].largest, 0);
    laves__background_free(sizes);
  }
}

static void data_may_be_in_another_file(void **state) {
  fixture *f = *state;
  const float samples[3] = {1, 2, 4};
  char bytes[20] = "junk\njunk";
  memcpy(bytes + 8, samples, sizeof samples);
  write_file(f, "row.raw", bytes, 20);
#define DETACHED "NRRD0004\ntype: float\nendian: little\ndimension: 3\nspacings: 1 1 1\nencoding: raw\n" ROW
  static const char *const headers[] = {DETACHED "byte skip: -1\ndata file: row.raw\n",
                                        DETACHED "line skip: 1\nbyte skip: 3\ndatafile: row.raw\n"};
  for (size_t i = 0; i < LAVES__COUNT_OF(headers); i++) {
    laves__background_sizes *sizes = load_text(f, "row.nhdr", headers[i], NULL);
    assert_close(size_at(sizes, 1.5, 0, 0), 3, 1e-12);
    laves__background_free(sizes);
  }
  assert_refused(f, "row.nhdr", DETACHED "line skip: 1\nbyte skip: 4\ndata file: row.raw\n", NULL, "shorter than announced");
  assert_refused(f, "row.nhdr", DETACHED "data file: none.raw\n", NULL, "cannot open the file");
  assert_refused(f, "row.nhdr", DETACHED "data file: ../row.raw\n", NULL, "in the same folder");
  assert_refused(f, "row.nhdr", DETACHED "data file: LIST\n", NULL, "in one file");
  assert_refused(f, "row.nhdr", DETACHED "data file: row%03d.raw 1 3 1\n", NULL, "in one file");
}

static void faults_of_images_are_told(void **state) {
  fixture *f = *state;
  const char *n = "x.nrrd";
  assert_refused(f, n, "NRRD0004\ntype: double\nencoding: ascii\ndimension: 4\n\n", NULL, "line 4: the image has 4 axes");
  assert_refused(f, n, "NRRD0004\ntype: block\n\n", NULL, "the type 'block' is not read");
  assert_refused(f, n, "NRRD0004\nencoding: bzip2\n\n", NULL, "the encoding 'bzip2' is not read; save it as raw, gzip or ascii");
  assert_refused(f, n, "NRRD0004\ndimension: 3\nsizes: 1 0 1\n\n", NULL, "line 3: expected the number of samples");
  assert_refused(f, n, "NRRD0004\ndimension: 3\n\n", NULL, "lacks one of the fields type, sizes and encoding");
  assert_refused(f, n, "NRRD0004\ntype: float\nencoding: raw\n" ROW "\n", NULL, "lacks the field endian");
  assert_refused(f, n, "NRRD0004\nendian: middle\n\n", NULL, "must be big or little");
  assert_refused(f, n, "NRRD0004\nwhatever\n\n", NULL, "line 2: expected a field");
  assert_refused(f, n, NRRD ROW "\n1 2 3\n", NULL, "give 'spacings' or 'space directions'");
  assert_refused(f, n, NRRD ROW "spacings: 0 1 1\n\n1 2 3\n", NULL, "how far its samples are apart");
  assert_refused(f, n, NRRD ROW "spacings: 1 1\n\n1 2 3\n", NULL, "line 6: expected a number for each of three axes");
  assert_refused(f, n, NRRD ROW "space directions: (1,0,0) none (0,0,1)\n\n1 2 3\n", NULL, "line 6: expected a vector");
  assert_refused(f, n, NRRD ROW "space directions: (1,0,0) (2,0,0) (0,0,1)\n\n1 2 3\n", NULL, "nor lie in one plane");
  assert_refused(f, n, NRRD ROW "spacings: 1 1 1\n\n1 2 x\n", NULL, "line 8: expected a sample, found 'x'");
  assert_refused(f, n, NRRD ROW "spacings: 1 1 1\n\n1 2 nan\n", NULL, "expected a sample, found 'nan'");
  assert_refused(f, n, NRRD ROW "spacings: 1 1 1\n\n1\n2\n", NULL, "the data are shorter than announced");
  assert_refused(f, n, NRRD ROW "spacings: 1 1 1\n\n1 2 0\n", NULL, "sample (2, 0, 0), counted from 0, has the size 0");
  assert_refused(f, n, NRRD ROW "spacings: 1 1 1\n\n1 -2 3\n", NULL, "sample (1, 0, 0), counted from 0, has the size -2");
  assert_refused(f, n, NRRD "sizes: 99999999999 99999999999 9\nspacings: 1 1 1\n\n1 2 3\n", NULL, "do not fit in 6 bytes");
  assert_refused(f, n, "NRRD0004\ntype: uchar\nencoding: gzip\ndimension: 3\n" ROW "spacings: 1 1 1\n\nno gzip at all", NULL,
                 "shorter than announced or damaged");
  assert_refused(f, n, NRRD ROW "spacings: 1 1 1\n\n1 2 3\n", "size", "an image has one array without a name");
}

/* ---- VTU ---- */

#define VTU_HEAD "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>"
#define PIECE(data)                                                                                                              \
  "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">"                \
  "0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\">0 1 2 3</DataArray>"       \
  "<DataArray type=\"Int32\" Name=\"offsets\">4</DataArray><DataArray type=\"UInt8\" Name=\"types\">10</DataArray></Cells>" data \
  "</Piece>"
#define ARRAY(name, numbers) "<DataArray type=\"Float64\" Name=\"" name "\">" numbers "</DataArray>"
#define VTU_TAIL "</UnstructuredGrid></VTKFile>\n"
#define VTU(data) VTU_HEAD PIECE(data) VTU_TAIL
#define VTU_BOTH \
  VTU("<PointData>" ARRAY("a", "1 2 3 4") ARRAY("b", "5 5 5 5") "</PointData><CellData>" ARRAY("c", "7") "</CellData>")

static void arrays_are_chosen_by_name(void **state) {
  fixture *f = *state;
  static const struct {
    const char *text, *array;
    double at_first_corner;
  } cases[] = {
      {VTU("<PointData>" ARRAY("anything", "1 2 3 4") "</PointData>"), NULL, 1},
      {VTU("<PointData>" ARRAY("other", "1 2 3 4") ARRAY("size", "5 5 5 5") "</PointData>"), NULL, 5},
      {VTU("<CellData>" ARRAY("anything", "7") "</CellData>"), NULL, 7},
      {VTU("<PointData>" ARRAY("a", "1 2 3 4") "</PointData><CellData>" ARRAY("size", "7") "</CellData>"), NULL, 1},
      {VTU("<CellData>" ARRAY("region", "2") ARRAY("size", "7") "</CellData>"), NULL, 7},
      {VTU_BOTH, "a", 1},
      {VTU_BOTH, "b", 5},
      {VTU_BOTH, "c", 7},
  };
  for (size_t i = 0; i < LAVES__COUNT_OF(cases); i++) {
    laves__background_sizes *sizes = load_text(f, "x.vtu", cases[i].text, cases[i].array);
    assert_close(size_at(sizes, 0, 0, 0), cases[i].at_first_corner, 0);
    laves__background_free(sizes);
  }
  assert_refused(f, "x.vtu", VTU_BOTH, NULL, "it has several arrays; name one of 'a', 'b'");
  assert_refused(f, "x.vtu", VTU_BOTH, "d", "it has no array 'd'; its arrays are 'a', 'b', 'c'");
}

static void faults_of_vtu_are_told(void **state) {
  fixture *f = *state;
  const char *n = "x.vtu";
  assert_refused(f, n, VTU(""), NULL, "there is no array in it with one number for each point or tet");
  assert_refused(f, n,
                 VTU("<PointData><DataArray type=\"Float64\" Name=\"v\" NumberOfComponents=\"3\">1</DataArray></PointData>"),
                 NULL, "there is no array");
  assert_refused(f, n, VTU("<PointData>" ARRAY("a", "1 2 3") "</PointData>"), NULL, "expected the values");
  assert_refused(f, n, VTU("<PointData>" ARRAY("a", "1 2 nan 4") "</PointData>"), NULL, "expected the values, found 'nan");
  assert_refused(f, n, VTU("<PointData>" ARRAY("a", "1 2 0 4") "</PointData>"), NULL, "vertex 3 (counted from 1) has the size 0");
  assert_refused(f, n, VTU("<CellData>" ARRAY("a", "-1") "</CellData>"), NULL, "tetrahedron 1 (counted from 1) has the size -1");
  assert_refused(f, n, VTU_HEAD PIECE("<PointData>" ARRAY("a", "1 2 3 4") "</PointData>") PIECE("") VTU_TAIL, NULL,
                 "a piece lacks the values");
  assert_refused(f, n, VTU_HEAD VTU_TAIL, NULL, "there is no array");
}

/* ---- Gmsh ---- */

#define MSH                                                                                                                     \
  "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n9 9 9 9\n$EndNodes\n$Elements\n1\n1 4 " \
  "0 1 2 3 4\n$EndElements\n"
#define VIEW(name, components, values) "$NodeData\n1\n\"" name "\"\n1\n0\n3\n0\n" components "\n4\n" values "$EndNodeData\n"

static void views_are_chosen_by_name(void **state) {
  fixture *f = *state;
  const char *n = "x.msh";
  const char *two = MSH VIEW("a b", "1", "1 1\n2 2\n3 3\n4 4\n") VIEW("size", "1", "4 8\n3 7\n2 6\n1 5\n");
  laves__background_sizes *sizes = load_text(f, n, two, NULL);
  assert_close(size_at(sizes, 0, 0, 0), 5, 0);
  laves__background_free(sizes);
  sizes = load_text(f, n, two, "a b");
  assert_close(size_at(sizes, 1, 0, 0), 2, 0);
  laves__background_free(sizes);
  sizes = load_text(f, n, MSH VIEW("h", "1", "1 1\n2 2\n3 3\n4 4\n") VIEW("h", "1", "4 8\n3 7\n2 6\n1 5\n"), NULL);
  assert_close(size_at(sizes, 1, 0, 0), 2, 0); /* the first of two time steps */
  laves__background_free(sizes);
  assert_refused(f, n, MSH, NULL, "it has no view ($NodeData)");
  assert_refused(f, n, MSH VIEW("v", "3", "1 1 1 1\n"), NULL, "it has no view ($NodeData) with one number");
  assert_refused(f, n, two, "size of", "it has no array 'size of'; its arrays are 'a b', 'size'");
  assert_refused(f, n, MSH VIEW("a", "1", "1 1\n2 2\n3 3\n5 4\n"), NULL, "a value is for node 5");
  assert_refused(f, n, MSH VIEW("a", "1", "1 1\n2 2\n3 3\n9 4\n"), NULL, "vertex 4 (counted from 1) has no size");
  assert_refused(f, n, MSH VIEW("a", "1", "1 1\n2 2\n3 3\n4 0\n"), NULL, "vertex 4 (counted from 1) has the size 0");
  assert_refused(f, n, MSH VIEW("a", "1", "1 1\n2 2\n3 3\n"), NULL, "expected a node's number and value, found '$EndNodeData'");
}

static void views_of_elements_are_read(void **state) {
  fixture *f = *state;
  const char *n = "x.msh";
#define ELEMENTS(section, values) MSH "$" section "\n1\n\"h\"\n1\n0\n3\n0\n1\n2\n" values "$End" section "\n"
  laves__background_sizes *sizes = load_text(f, n, ELEMENTS("ElementData", "7 5\n1 3\n"), NULL);
  assert_close(size_at(sizes, 0.1, 0.2, 0.3), 3, 0);
  laves__background_free(sizes);
  sizes = load_text(f, n, ELEMENTS("ElementNodeData", "7 2 5 6\n1 4 1 2 3 4\n"), "h");
  assert_close(size_at(sizes, 0.1, 0.2, 0.3), 2.4, 1e-12);
  laves__background_free(sizes);
  assert_refused(f, n, ELEMENTS("ElementData", "7 5\n8 3\n"), NULL, "tetrahedron 1 (counted from 1) has no size");
  assert_refused(f, n, ELEMENTS("ElementNodeData", "7 2 5 6\n1 3 1 2 3\n"), NULL, "vertex 4 (counted from 1) has no size");
  assert_refused(f, n, ELEMENTS("ElementNodeData", "7 2 5 6\n1 4 1 2 3\n"), NULL, "expected a value of an element, found '$End");
}

static void loose_points_have_sizes_around_them(void **state) {
  fixture *f = *state;
  laves__background_sizes *sizes = load_text(f, "x.pos", "View \"a\" { SP(0,0,0){1}; SP(10,0,0){2, 7}; SP(0,10,0){3}; };", NULL);
  assert_close(size_at(sizes, 4, 0, 0), 1, 0);
  assert_close(size_at(sizes, 6, 0, 0), 2, 0);
  assert_close(size_at(sizes, -5, 70, 0), 3, 0);
  laves__background_free(sizes);
}

static void pos_views_are_chosen_by_name(void **state) {
  fixture *f = *state;
  const char *two = "View 'a' { SP(0,0,0){1}; }; View \"b\" { SP(0,0,0){2}; };";
  const char *n = "x.pos";
  laves__background_sizes *sizes = load_text(f, n, two, "b");
  assert_close(size_at(sizes, 4, 0, 0), 2, 0);
  laves__background_free(sizes);
  assert_refused(f, n, two, NULL, "it has several arrays; name one of 'a', 'b'");
  assert_refused(f, n, "View \"a\" { ST(0,0,0,1,0,0,0,1,0){1,1,1}; };", NULL,
                 "no scalar tetrahedra (SS) and no scalar points (SP)");
  assert_refused(f, n, "View \"a\" { SP(0,0){1}; };", NULL, "line 1: an element SP has 2 coordinates and 1 values");
  assert_refused(f, n, "View \"a\" {\nSP(0,0,0){-1};\n};", NULL, "point 1 (counted from 1) has the size -1");
  assert_refused(f, n, "View \"a\" {\nSP(0,0,inf){1};\n};", NULL, "line 2: expected a number, found 'inf");
  assert_refused(f, n, "View \"a\" {\nSP(0,0,1e99){1};\n};", NULL, "beyond 1e90");
  assert_refused(f, n, "View \"a\" {\nSP(0,0,0){1};\n", NULL, "expected an element such as SS, or '}', but the file ends");
  assert_refused(f, n, "View[0].x = 1;", NULL, "there is no array");
  assert_refused(f, n, "$PostFormat\n1.4 0 8\nView", NULL, "no format of size files that is known");
  assert_refused(f, n, "hello", NULL, "no format of size files that is known");
  assert_refused(f, n, "", NULL, "no format of size files that is known");
}

/* ---- searching ---- */

/* Flat and overlapping tets are no trouble; distances are told against trying all points. */
static void many_loose_points_are_searched_rightly(void **state) {
  fixture *f = *state;
  enum { COUNT = 500, QUERIES = 2000 };
  laves__vec3 points[COUNT];
  char *text;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  uint64_t random = 12345;
  fprintf(out, "View \"a\" {");
  for (int i = 0; i < COUNT; i++) {
    double c[3];
    for (int k = 0; k < 3; k++) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      c[k] = ldexp((double)(random >> 40), -24 - (i % 5) * 4); /* crowded towards the origin */
    }
    points[i] = v3(c[0], c[1], c[2]);
    fprintf(out, "SP(%.17g,%.17g,%.17g){%d};\n", c[0], c[1], c[2], i + 1);
  }
  fprintf(out, "};");
  fclose(out);
  write_file(f, "x.pos", text, length);
  free(text);
  laves__background_sizes *sizes = load(f, NULL);
  for (int q = 0; q < QUERIES; q++) {
    random = random * 6364136223846793005u + 1442695040888963407u;
    const laves__vec3 p =
        v3((double)(random >> 44 & 1023) / 700, (double)(random >> 34 & 1023) / 3000, (double)(random >> 54) / 900);
    double nearest = INFINITY;
    for (int i = 0; i < COUNT; i++) nearest = fmin(nearest, v3_distance(points[i], p));
    const int found = (int)size_at(sizes, p.x, p.y, p.z) - 1;
    assert_close(v3_distance(points[found], p), nearest, 1e-15);
  }
  laves__background_free(sizes);
}

static void flat_tets_are_surfaces(void **state) {
  fixture *f = *state;
  laves__background_sizes *sizes = load_text(
      f, "x.pos", "View \"a\" { SS(0,0,0, 4,0,0, 0,4,0, 4,4,0){1,5,5,9}; SS(9,9,9,9,9,9,9,9,9,9,9,9){20,20,20,20}; };", NULL);
  assert_close(size_at(sizes, 1, 1, 1), 3, 1e-12);
  assert_close(size_at(sizes, 3, 2, -1), 6, 1e-12);
  assert_close(size_at(sizes, -3, 2, 0), 3, 1e-12);
  assert_close(size_at(sizes, 10, 9, 12), 20, 1e-12);
  laves__background_free(sizes);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(linear_sizes_are_reproduced),
      cmocka_unit_test(cut_files_do_no_harm),
      cmocka_unit_test(places_that_are_no_places_have_sizes),
      cmocka_unit_test(short_memory_is_told),
      cmocka_unit_test(meshes_can_be_cancelled),
      cmocka_unit_test(images_stand_where_their_header_says),
      cmocka_unit_test(slanted_images_are_followed),
      cmocka_unit_test(all_types_are_read),
      cmocka_unit_test(data_may_be_in_another_file),
      cmocka_unit_test(faults_of_images_are_told),
      cmocka_unit_test(arrays_are_chosen_by_name),
      cmocka_unit_test(faults_of_vtu_are_told),
      cmocka_unit_test(views_are_chosen_by_name),
      cmocka_unit_test(views_of_elements_are_read),
      cmocka_unit_test(loose_points_have_sizes_around_them),
      cmocka_unit_test(pos_views_are_chosen_by_name),
      cmocka_unit_test(many_loose_points_are_searched_rightly),
      cmocka_unit_test(flat_tets_are_surfaces),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
