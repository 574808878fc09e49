/* Files made to do harm, through the functions that programs call: counts that lie, lines and numbers without end, deep nesting,
 * many small parts, content that expands. Each is read or refused with a sentence, in memory that its length accounts for,
 * in a time that its length accounts for, and nothing stays behind.
 *
 * Small files cut off and altered at every byte are tried by the fuzz targets' replay (tests/fuzz/replay.c --alter). */
#include <limits.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include <zlib.h>

#include "fixtures/stride.h"
#include "laves/laves.h"

static char folder[] = "/tmp/laves-hostile-XXXXXX";

static int make_folder(void **state) {
  (void)state;
  return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state) {
  (void)state;
  return rmdir(folder);
}

/* ---- bytes that grow ---- */

typedef struct content {
  char *bytes;
  size_t length, capacity;
} content;

static void put_bytes(content *c, const void *bytes, size_t length) {
  if (c->length + length > c->capacity) {
    c->capacity = 2 * (c->length + length);
    c->bytes = realloc(c->bytes, c->capacity);
    assert_non_null(c->bytes);
  }
  if (length) memcpy(c->bytes + c->length, bytes, length);
  c->length += length;
}

static void put(content *c, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void put(content *c, const char *format, ...) {
  char text[1000];
  va_list arguments;
  va_start(arguments, format);
  const int length = vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  assert_in_range(length, 0, sizeof text - 1);
  put_bytes(c, text, (size_t)length);
}

static void repeat(content *c, const char *text, size_t count) {
  for (size_t i = 0; i < count; i++) put_bytes(c, text, strlen(text));
}

/* ---- reading one ---- */

typedef enum what { SURFACE, MESH, SIZES, LINES, CERTIFICATE } what;

static laves_result read_as(what kind, laves_context *context, const char *path, laves_error *error) {
  laves_domain *domain = NULL;
  laves_mesh *mesh = NULL;
  laves_sizing *sizing = NULL;
  laves_features *features = NULL;
  laves_certificate certificate;
  laves_result result = LAVES_OK;
  switch (kind) {
    case SURFACE:
      result = laves_domain_from_file(context, path, &domain, error);
      break;
    case MESH:
      result = laves_mesh_read(context, path, &mesh, error);
      break;
    case SIZES:
      assert_int_equal(laves_sizing_create(context, &sizing, error), LAVES_OK);
      result = laves_sizing_add_background(sizing, path, NULL, error);
      break;
    case LINES:
      assert_int_equal(laves_features_create(context, &features, error), LAVES_OK);
      result = laves_features_add_file(features, path, error);
      break;
    case CERTIFICATE:
      result = laves_certificate_read(context, path, &certificate, error);
      break;
  }
  laves_domain_free(domain);
  laves_mesh_free(mesh);
  laves_sizing_free(sizing);
  laves_features_free(features);
  return result;
}

static const size_t memory_base = 1 << 20;
static const size_t memory_per_byte = 250;
/* Processor time that no file here comes near, on a slow machine under a sanitizer. */
static const double seconds_at_most = 60;

/* Writes the content to a file of that name, reads it, and frees it. `ratio`: by how much content may expand. */
static laves_result try_expanding(what kind, const char *name, content *c, size_t ratio) {
  char path[200];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  if (c->length) assert_int_equal(fwrite(c->bytes, 1, c->length, file), c->length);
  fclose(file);
  const size_t limit = memory_base + ratio * memory_per_byte * c->length;
  laves_context_options options = laves_context_options_default();
  options.memory_limit = limit;
  laves_context *context = laves_context_create(&options);
  laves_error error = {0};
  const clock_t start = clock();
  const laves_result result = read_as(kind, context, path, &error);
  const double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
  unlink(path);
  if (result != LAVES_OK && (error.result != result || strlen(error.text) < 10 || result != LAVES_ERROR_INPUT))
    fail_msg("%s (%zu bytes): result %d: %s", name, c->length, result, error.text);
  if (seconds > seconds_at_most) fail_msg("%s (%zu bytes): takes %g seconds", name, c->length, seconds);
  if (laves_context_bytes(context) != 0) fail_msg("%s: %zu bytes stay behind", name, laves_context_bytes(context));
  laves_context_free(context);
  free(c->bytes);
  *c = (content){0};
  return result;
}

static laves_result try_file(what kind, const char *name, content *c) { return try_expanding(kind, name, c, 1); }

static void refuse(what kind, const char *name, content *c) {
  if (try_file(kind, name, c) != LAVES_ERROR_INPUT) fail_msg("%s was read", name);
}

static void refuse_text(what kind, const char *name, const char *text) {
  content c = {0};
  put_bytes(&c, text, strlen(text));
  refuse(kind, name, &c);
}

/* ---- counts that lie ---- */

static const char *const lies[] = {"-1",
                                   "nan",
                                   "inf",
                                   "1e9",
                                   "2147483647",
                                   "2147483648",
                                   "4294967295",
                                   "4294967296",
                                   "9223372036854775807",
                                   "9223372036854775808",
                                   "18446744073709551615",
                                   "99999999999999999999999999"};

/* Every % in the text becomes the lie. */
static void try_lie(what kind, const char *name, const char *text, const char *lie) {
  content c = {0};
  for (; *text; text++) {
    if (*text == '%')
      put_bytes(&c, lie, strlen(lie));
    else
      put_bytes(&c, text, 1);
  }
  refuse(kind, name, &c);
}

static void counts_may_lie(void **state) {
  (void)state;
  static const struct {
    what kind;
    const char *name, *text;
  } files[] = {
      {SURFACE, "a.off", "OFF\n% 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {SURFACE, "a.off", "OFF\n3 % 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {SURFACE, "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n% 0 1 2\n"},
      {SURFACE, "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 %\n"},
      {SURFACE, "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 %\n"},
      {SURFACE, "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -%\n"},
      {SURFACE, "a.ply",
       "ply\nformat ascii 1.0\nelement vertex %\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {SURFACE, "a.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
       "element face %\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {SURFACE, "a.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uint int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n% 0 1 2\n"},
      {SURFACE, "a.ply", "ply\nformat ascii 1.0\nelement nothing %\nelement vertex %\nend_header\n"},
      {SURFACE, "a.msh",
       "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 2 0 1 1 1\n$EndElements\n"},
      {SURFACE, "a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n%\n2 1 \"a\"\n$EndPhysicalNames\n"},
      {SURFACE, "a.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 % 0\n1 0 0 0 1 1 1 % 1 %\n$EndEntities\n"},
      {MESH, "a.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n% % 1 %\n3 1 0 %\n1\n0 0 0\n$EndNodes\n"},
      {MESH, "a.msh",
       "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n%\n1 4 0 1 1 1 1\n$EndElements\n"},
      {MESH, "a.msh",
       "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 4 % 1 1 1 1\n$EndElements\n"},
      {MESH, "a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices %\n0 0 0 0\nEnd\n"},
      {MESH, "a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 1\n0 0 0 0\nTetrahedra %\n1 1 1 1 0\nEnd\n"},
      {MESH, "a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 1\n0 0 0 0\nTetrahedra 1\n1 1 1 % 0\nEnd\n"},
      {MESH, "a.vtu",
       "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"%\" NumberOfCells=\"%\">"
       "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0</DataArray></Points>"
       "</Piece></UnstructuredGrid></VTKFile>"},
      {MESH, "a.vtu",
       "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"1\" NumberOfCells=\"1\">"
       "<Points><DataArray type=\"Float64\" NumberOfComponents=\"%\" format=\"ascii\">0 0 0</DataArray></Points>"
       "</Piece></UnstructuredGrid></VTKFile>"},
      {MESH, "a.vtu",
       "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" header_type=\"UInt64\"><UnstructuredGrid>"
       "<Piece NumberOfPoints=\"1\" NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" "
       "NumberOfComponents=\"3\" format=\"appended\" offset=\"%\"/></Points></Piece></UnstructuredGrid>"
       "<AppendedData encoding=\"raw\">_12345678</AppendedData></VTKFile>"},
      {SIZES, "a.nrrd", "NRRD0004\ntype: float\ndimension: 3\nsizes: % % %\nencoding: raw\nendian: little\n\n1234"},
      {SIZES, "a.nrrd", "NRRD0004\ntype: float\ndimension: %\nsizes: 1 1 1\nencoding: raw\nendian: little\n\n1234"},
      {SIZES, "a.nrrd", "NRRD0004\ntype: block\nblock size: %\ndimension: 3\nsizes: 1 1 1\nencoding: raw\n\n1234"},
      {SIZES, "a.nrrd",
       "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nencoding: raw\nendian: little\nline skip: %\nbyte skip: %\n\n1234"},
      {LINES, "a.vtk", "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS % float\n0 0 0\nLINES 1 2\n1 0\n"},
      {LINES, "a.vtk", "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\nLINES % %\n1 0\n"},
      {LINES, "a.vtk", "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\nLINES 1 2\n% 0\n"},
      {LINES, "a.vtk", "# vtk DataFile Version 3.0\na\nBINARY\nDATASET POLYDATA\nPOINTS % double\n12345678"},
      {LINES, "a.obj", "v 0 0 0\nv 1 0 0\nl 1 -%\n"},
      {CERTIFICATE, "a.json", "{\"certificate\": \"laves\", \"schema\": %}"},
  };
  for (size_t f = 0; f < sizeof files / sizeof files[0]; f++) {
    for (size_t i = 0; i < sizeof lies / sizeof lies[0]; i++) try_lie(files[f].kind, files[f].name, files[f].text, lies[i]);
  }
}

/* ---- lines, numbers and names without end ---- */

enum { MANY = 100000, LONG = 20000000 };

static void lines_may_have_no_end(void **state) {
  (void)state;
  static const struct {
    what kind;
    const char *name, *start;
  } files[] = {
      {SURFACE, "a.obj", "v 0 0 0\n"},
      {SURFACE, "a.obj", "# "},
      {SURFACE, "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ng "},
      {SURFACE, "a.off", "OFF\n"},
      {SURFACE, "a.stl", "solid "},
      {SURFACE, "a.ply", "ply\nformat ascii 1.0\ncomment "},
      {SURFACE, "a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$"},
      {MESH, "a.msh", "$MeshFormat\n"},
      {MESH, "a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices "},
      {MESH, "a.vtu", "<VTKFile "},
      {MESH, "a.vtu", "<VTKFile a=\""},
      {SIZES, "a.nrrd", "NRRD0004\n"},
      {SIZES, "a.nrrd", "NRRD0004\nsizes: "},
      {LINES, "a.txt", "0 0 "},
      {LINES, "a.vtk", "# vtk DataFile Version 3.0\na\nASCII\nDATASET "},
      {LINES, "a.vtp", "<VTKFile type=\""},
  };
  static const char *const fills[] = {"1", " ", "a", "-", ".", "\"", "<"};
  for (size_t f = 0; f < sizeof files / sizeof files[0]; f++) {
    for (size_t i = 0; i < sizeof fills / sizeof fills[0]; i++) {
      content c = {0};
      put(&c, "%s", files[f].start);
      repeat(&c, fills[i], i == 0 && test_stride() == 1 ? LONG : LONG / 10);
      try_file(files[f].kind, files[f].name, &c);
    }
  }
}

static void put_tetrahedron(content *c, const char *number) {
  put(c, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 ");
  put_bytes(c, number, strlen(number));
  put(c, "\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
}

/* Of a thousand digits they are read as what they are; of more, refused. */
static void numbers_may_have_many_digits(void **state) {
  (void)state;
  content number = {0}, c = {0};
  put(&number, "0.");
  repeat(&number, "3", 1000);
  put_bytes(&number, "", 1);
  put_tetrahedron(&c, number.bytes);
  assert_int_equal(try_file(SURFACE, "a.obj", &c), LAVES_OK);
  number.length--;
  repeat(&number, "3", 4000);
  put_bytes(&number, "", 1);
  put_tetrahedron(&c, number.bytes);
  refuse(SURFACE, "a.obj", &c);
  number.length = 0;
  repeat(&number, "0", 1000);
  put(&number, "1e-0000000000000000000000000000000000000000000001");
  put_bytes(&number, "", 1);
  put_tetrahedron(&c, number.bytes);
  assert_int_equal(try_file(SURFACE, "a.obj", &c), LAVES_OK);
  number.length = 0;
  put(&number, "1e");
  repeat(&number, "9", 5000);
  put_bytes(&number, "", 1);
  put_tetrahedron(&c, number.bytes);
  refuse(SURFACE, "a.obj", &c);
  free(number.bytes);
  static const char *const wild[] = {"nan", "inf", "-inf", "1e999", "0x1p5000"};
  for (size_t i = 0; i < sizeof wild / sizeof wild[0]; i++) {
    put_tetrahedron(&c, wild[i]);
    refuse(SURFACE, "a.obj", &c);
  }
}

/* ---- nesting ---- */

static void nesting_may_be_deep(void **state) {
  (void)state;
  content c = {0};
  put(&c, "<VTKFile type=\"UnstructuredGrid\">");
  repeat(&c, "<a>", MANY);
  refuse(MESH, "a.vtu", &c);
  put(&c, "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>");
  repeat(&c, "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\">", MANY);
  refuse(MESH, "a.vtu", &c);
  repeat(&c, "[", MANY);
  refuse(CERTIFICATE, "a.json", &c);
  repeat(&c, "{\"a\":", MANY);
  refuse(CERTIFICATE, "a.json", &c);
  put(&c, "{\"certificate\": ");
  repeat(&c, "9", MANY);
  put(&c, "}");
  refuse(CERTIFICATE, "a.json", &c);
  repeat(&c, "View \"a\" {", MANY);
  refuse(SIZES, "a.pos", &c);
}

/* ---- many small parts ---- */

static void parts_may_be_many(void **state) {
  (void)state;
  content c = {0};
  put_tetrahedron(&c, "1");
  for (int i = 0; i < MANY; i++) put(&c, "g group%d\n", i);
  assert_int_equal(try_file(SURFACE, "a.obj", &c), LAVES_OK);
  put(&c, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf");
  repeat(&c, " 1 2 3", MANY);
  try_file(SURFACE, "a.obj", &c);
  for (int i = 0; i < MANY; i++) put(&c, "solid s%d\nendsolid s%d\n", i, i);
  refuse(SURFACE, "a.stl", &c);
  put(&c, "ply\nformat ascii 1.0\nelement vertex 1\n");
  for (int i = 0; i < MANY; i++) put(&c, "property float p%d\n", i);
  put(&c, "end_header\n");
  refuse(SURFACE, "a.ply", &c);
  put(&c, "ply\nformat ascii 1.0\n");
  for (int i = 0; i < MANY; i++) put(&c, "element e%d 1\n", i);
  put(&c, "end_header\n");
  refuse(SURFACE, "a.ply", &c);
  put(&c, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n");
  repeat(&c, "$Nodes\n0\n$EndNodes\n", MANY);
  refuse(MESH, "a.msh", &c);
  put(&c, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n%d\n", MANY);
  for (int i = 0; i < MANY; i++) put(&c, "2 %d \"n%d\"\n", i + 1, i);
  put(&c, "$EndPhysicalNames\n");
  refuse(SURFACE, "a.msh", &c);
  put(&c, "MeshVersionFormatted 2\nDimension 3\n");
  repeat(&c, "Vertices 0\nTetrahedra 0\n", MANY);
  refuse(MESH, "a.mesh", &c);
  put(&c, "NRRD0004\n");
  for (int i = 0; i < MANY; i++) put(&c, "key%d:=value\n", i);
  refuse(SIZES, "a.nrrd", &c);
  put(&c, "<VTKFile type=\"UnstructuredGrid\"");
  for (int i = 0; i < MANY; i++) put(&c, " a%d=\"\"", i);
  put(&c, ">");
  refuse(MESH, "a.vtu", &c);
  put(&c, "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"><CellData>");
  for (int i = 0; i < MANY; i++) put(&c, "<DataArray type=\"Int32\" Name=\"n%d\" format=\"ascii\"></DataArray>", i);
  put(&c, "</CellData></Piece></UnstructuredGrid></VTKFile>");
  refuse(MESH, "a.vtu", &c);
  repeat(&c, "0 0 0\n\n", MANY); /* points that stand alone, all in one place */
  assert_int_equal(try_file(LINES, "a.txt", &c), LAVES_OK);
  put(&c, "v 0 0 0\nv 1 0 0\n"); /* the same piece again and again */
  repeat(&c, "l 1 2\n", MANY);
  assert_int_equal(try_file(LINES, "a.obj", &c), LAVES_OK);
  put(&c, "v 0 0 0\n"); /* all pieces meet in one point */
  for (int i = 0; i < MANY; i++) put(&c, "v %d 1 0\nl 1 %d\n", i, i + 2);
  assert_int_equal(try_file(LINES, "a.obj", &c), LAVES_OK);
}

/* All triangles have an edge in common, or all points one place. */
static void surfaces_may_be_one_fan(void **state) {
  (void)state;
  enum { FAN = 4000 };
  content c = {0};
  put(&c, "v 0 0 0\nv 0 0 1\n");
  for (int i = 0; i < FAN; i++) put(&c, "v %.9f %.9f 0\nf 1 2 %d\n", cos(i), sin(i), i + 3);
  try_file(SURFACE, "a.obj", &c);
  for (int i = 0; i < FAN; i++) put(&c, "v 0 0 0\nv 0 0 0\nv 0 0 0\nf -1 -2 -3\n");
  refuse(SURFACE, "a.obj", &c);
  put(&c, "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  repeat(&c, "f 1 2 3\n", FAN);
  refuse(SURFACE, "a.obj", &c);
}

/* Large triangles that all cross all others: the pairs are counted, not listed, once they are too many. */
static void faces_may_all_cross(void **state) {
  (void)state;
  enum { FACES = 8000 };
  if (test_stride() > 1) return; /* takes as long as it may */
  content c = {0};
  for (int i = 0; i < FACES; i++) {
    const double u = cos(0.7 * i), v = sin(0.7 * i), w = cos(0.3 * i);
    put(&c, "v %.9f %.9f %.9f\nv %.9f %.9f %.9f\nv %.9f %.9f %.9f\nf -1 -2 -3\n", u, v, w, -v, w, -u, -w, -u, v);
  }
  refuse(SURFACE, "a.obj", &c);
}

/* ---- binary ---- */

static void put_u32(content *c, uint32_t value) { put_bytes(c, &value, sizeof value); }

static void binary_files_may_lie(void **state) {
  (void)state;
  static const uint32_t values[] = {0, 1, 0x7fffffff, 0x80000000, 0xffffffff};
  content c = {0};
  for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
    char zeros[80] = {0};
    put_bytes(&c, zeros, sizeof zeros); /* STL */
    put_u32(&c, values[i]);
    put_bytes(&c, zeros, 50);
    refuse(SURFACE, "a.stl", &c);
    put_u32(&c, 1); /* Medit: a keyword tells where the next one is; here at itself, before it, far behind the end */
    put_u32(&c, 2);
    put_u32(&c, 3);
    put_u32(&c, values[i]);
    put_u32(&c, 3);
    put_u32(&c, 4);
    put_u32(&c, values[i] == 1 ? 8 : values[i]);
    put_u32(&c, values[i]);
    refuse(MESH, "a.meshb", &c);
  }
}

/* ---- what expands ---- */

static void put_zeros_compressed(content *c, size_t length, bool gzip) {
  z_stream stream = {0};
  Bytef piece[65536] = {0}, out[65536];
  assert_int_equal(deflateInit2(&stream, 9, Z_DEFLATED, gzip ? 31 : 15, 9, Z_DEFAULT_STRATEGY), Z_OK);
  for (size_t done = 0; done < length;) {
    const size_t part = length - done < sizeof piece ? length - done : sizeof piece;
    stream.next_in = piece;
    stream.avail_in = (uInt)part;
    done += part;
    do {
      stream.next_out = out;
      stream.avail_out = sizeof out;
      deflate(&stream, done == length ? Z_FINISH : Z_NO_FLUSH);
      put_bytes(c, out, sizeof out - stream.avail_out);
    } while (stream.avail_out == 0);
  }
  deflateEnd(&stream);
}

/* What the header does not ask for is not unpacked: a bomb takes no more than the samples that are promised. */
static void bombs_are_not_unpacked(void **state) {
  (void)state;
  const size_t bomb = (size_t)1 << (test_stride() > 1 ? 26 : 28);
  content c = {0};
  put(&c, "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nencoding: gzip\nendian: little\n\n");
  put_zeros_compressed(&c, bomb, true);
  refuse(SIZES, "a.nrrd", &c);
  put(&c, "NRRD0004\ntype: float\ndimension: 3\nsizes: 1000 1000 1000\nencoding: gzip\nendian: little\n\n");
  put_zeros_compressed(&c, 1000, true);
  refuse(SIZES, "a.nrrd", &c);
  /* One block of zlib that says it is 24 bytes, and is not; then one that says it is 4 GiB. */
  static const uint32_t said[] = {24, 0xffffffff};
  for (int i = 0; i < 2; i++) {
    put(&c,
        "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" compressor=\"vtkZLibDataCompressor\">"
        "<UnstructuredGrid><Piece NumberOfPoints=\"1\" NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" "
        "NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/></Points></Piece></UnstructuredGrid>"
        "<AppendedData encoding=\"raw\">_");
    content packed = {0};
    put_zeros_compressed(&packed, bomb, false);
    put_u32(&c, 1);
    put_u32(&c, said[i]);
    put_u32(&c, 0);
    put_u32(&c, (uint32_t)packed.length);
    put_bytes(&c, packed.bytes, packed.length);
    free(packed.bytes);
    put(&c, "</AppendedData></VTKFile>");
    refuse(MESH, "a.vtu", &c);
  }
}

static void other_things_are_refused(void **state) {
  (void)state;
  static const char *const names[] = {"a.stl", "a.obj", "a.ply", "a.off", "a.msh"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    refuse_text(SURFACE, names[i], "");
    refuse_text(SURFACE, names[i], "\n");
    refuse_text(SURFACE, names[i], "\xff\xfe\xfd");
  }
  refuse_text(MESH, "a.vtu", "");
  refuse_text(SIZES, "a.nrrd", "");
  refuse_text(LINES, "a.txt", "");
  refuse_text(CERTIFICATE, "a.json", "");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(counts_may_lie),
      cmocka_unit_test(lines_may_have_no_end),
      cmocka_unit_test(numbers_may_have_many_digits),
      cmocka_unit_test(nesting_may_be_deep),
      cmocka_unit_test(parts_may_be_many),
      cmocka_unit_test(surfaces_may_be_one_fan),
      cmocka_unit_test(faces_may_all_cross),
      cmocka_unit_test(binary_files_may_lie),
      cmocka_unit_test(bombs_are_not_unpacked),
      cmocka_unit_test(other_things_are_refused),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
