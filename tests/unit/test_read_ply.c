/* PLY: three encodings, all types, lists in any order, labels, strips. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/parse_surface.h"

#define VERTEX "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
#define FACE "element face 2\nproperty list uchar int vertex_indices\n"
#define DATA "0 0 0\n1 0 0\n1 1 0\n0 1 0.1\n3 0 1 2\n4 0 1 2 3\n"
#define ASCII_FILE "ply\nformat ascii 1.0\ncomment x\n" VERTEX FACE "end_header\n" DATA

static void text_is_read(void **state) {
  (void)state;
  assert_surface(TEXT_FILE("x", ASCII_FILE), "PLY (ASCII)", 4, 3);
  assert_triangles(TEXT_FILE("x", ASCII_FILE), (const uint32_t[]){0, 1, 2, 0, 1, 2, 0, 2, 3}, 9);
  laves_context *context = laves_context_create(NULL);
  laves__surface_input input;
  parse_surface(context, TEXT_FILE("x", ASCII_FILE), &input);
  assert_true(input.points[3].z == 0.1);
  laves__surface_input_free(context, &input);
  laves_context_free(context);
}

static void strangers_are_passed_over(void **state) {
  (void)state;
  assert_triangles(TEXT_FILE("x",
                             "ply\r\nformat ascii 1.0\r\nobj_info y\r\nelement empty 99999999999\r\n"
                             "element camera 2\r\nproperty list int double a\r\nproperty float nx\r\n"
                             "element face 1\r\nproperty list uchar float texcoord\r\nproperty list uint8 uint32 vertex_index\r\n"
                             "property double area\r\n"
                             "element vertex 3\r\nproperty float nx\r\nproperty double z\r\nproperty list char int w\r\n"
                             "property double y\r\nproperty double x\r\nend_header\r\n"
                             "2 1 nan 5\r\n0 6\r\n6 0 0 0 0 0 0 3 0 1 2 0.5\r\nnan 1 0 2 3\r\n0 1 1 9 2 3\r\n0 1 2 9 9 2 4\r\n"),
                   (const uint32_t[]){0, 1, 2}, 3);
}

static void labels_become_tags(void **state) {
  (void)state;
  assert_tag_names(TEXT_FILE("x", "ply\nformat ascii 1.0\n" VERTEX "element face 4\nproperty uchar region\n"
                                  "property list uchar int vertex_indices\nproperty int label\nend_header\n"
                                  "0 0 0\n1 0 0\n1 1 0\n0 1 0\n7 3 0 1 2 0\n7 4 0 1 2 3 1\n2 3 1 2 3 2\n7 3 2 3 0 3"),
                   "label 0,label 1,label 1,label 2,label 3");
  assert_tag_names(TEXT_FILE("x", ASCII_FILE), "");
}

#define TWO_FACES(properties, first, second) "ply\n" TWO_FACES_AFTER_PLY(properties, first, second)
#define TWO_FACES_AFTER_PLY(properties, first, second)                                              \
  "format ascii 1.0\n" VERTEX "element face 2\nproperty list uchar int vertex_indices\n" properties \
  "end_header\n"                                                                                    \
  "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 " first "\n3 0 2 3 " second "\n"

/* Whatever it is called, the only integer of a face is its label, but for colours and flags. */
static void any_integer_may_be_the_label(void **state) {
  (void)state;
  assert_tag_names(TEXT_FILE("x", TWO_FACES("property int body\n", "4", "5")), "body 4,body 5");
  assert_tag_names(TEXT_FILE("x", TWO_FACES("property uchar red\nproperty uint flags\nproperty short Zone\n", "9 9 4", "9 9 5")),
                   "Zone 4,Zone 5");
  assert_tag_names(TEXT_FILE("x", TWO_FACES("property uchar red\nproperty uchar green\nproperty uchar blue\n", "1 2 3", "4 5 6")),
                   "");
  assert_tag_names(TEXT_FILE("x", TWO_FACES("property float label\n", "1", "2")), "");
  /* Comments name the values of "label". */
  assert_tag_names(TEXT_FILE("x",
                             "ply\ncomment label 5 the inlet  \ncomment label 4\ncomment label 5 other\n"
                             "comment labels 4 x\n" TWO_FACES_AFTER_PLY("property int label\n", "4", "5")),
                   "label 4,the inlet");
  assert_tag_names(TEXT_FILE("x", "ply\ncomment label 5 inlet\n" TWO_FACES_AFTER_PLY("property int tag\n", "4", "5")),
                   "tag 4,tag 5");
  /* Of two unknown ones neither is meant; of known ones the first of the list counts. */
  assert_tag_names(TEXT_FILE("x", TWO_FACES("property int a1\nproperty int b1\n", "1 2", "3 4")), "");
  assert_tag_names(TEXT_FILE("x", TWO_FACES("property int object\nproperty int material\n", "1 2", "3 4")),
                   "material 2,material 4");
}

static void strips_become_triangles(void **state) {
  (void)state;
  assert_triangles(
      TEXT_FILE("x", "ply\nformat ascii 1.0\n" VERTEX "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                     "0 0 0\n1 0 0\n1 1 0\n0 1 0\n8 0 1 2 3 -1 3 2 1\n"),
      (const uint32_t[]){0, 1, 2, 2, 1, 3, 3, 2, 1}, 9);
}

/* Appends `size` bytes of a number, little or big end first. */
static size_t put(unsigned char *bytes, size_t at, uint64_t bits, size_t size, bool big) {
  for (size_t i = 0; i < size; ++i) {
    bytes[at + i] = (unsigned char)(bits >> 8 * (big ? size - 1 - i : i));
  }
  return at + size;
}

static size_t put_float(unsigned char *bytes, size_t at, float value, bool big) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return put(bytes, at, bits, 4, big);
}

static size_t put_double(unsigned char *bytes, size_t at, double value, bool big) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return put(bytes, at, bits, 8, big);
}

/* Four vertices (float x, double y, short z, and a list), two faces with ushort corners and a signed label. */
static small_file make_binary(unsigned char bytes[1000], bool big, const char *line_end) {
  static const char *const LINES[] = {"ply",
                                      NULL,
                                      "element vertex 4",
                                      "property float x",
                                      "property double y",
                                      "property short z",
                                      "property list ushort char w",
                                      "element face 2",
                                      "property char label",
                                      "property list uint ushort vertex_indices",
                                      "end_header"};
  size_t at = 0;
  for (size_t i = 0; i < LAVES__COUNT_OF(LINES); ++i) {
    const char *line = LINES[i] ? LINES[i] : big ? "format binary_big_endian 1.0" : "format binary_little_endian 1.0";
    at += (size_t)snprintf((char *)bytes + at, 1000 - at, "%s%s", line, line_end);
  }
  for (unsigned i = 0; i < 4; ++i) {
    at = put_float(bytes, at, (float)i + 0.5f, big);
    at = put_double(bytes, at, 0.1, big);
    at = put(bytes, at, (uint16_t) - (int)(i * i), 2, big);
    at = put(bytes, at, i, 2, big);
    at = put(bytes, at, 0x0A0A0A, i, big);
  }
  for (unsigned face = 0; face < 2; ++face) {
    at = put(bytes, at, face ? 0xFF : 10, 1, big);
    at = put(bytes, at, 3 + face, 4, big);
    for (unsigned i = 0; i < 3 + face; ++i) {
      at = put(bytes, at, i, 2, big);
    }
  }
  return (small_file){"b.ply", bytes, at};
}

static void binaries_are_read(void **state) {
  (void)state;
  static const char *const LINE_ENDS[] = {"\n", "\r\n", "\r"};
  for (int i = 0; i < 6; ++i) {
    unsigned char bytes[1000];
    const small_file file = make_binary(bytes, i % 2 == 1, LINE_ENDS[i / 2]);
    assert_surface(file, i % 2 ? "PLY (binary, big endian)" : "PLY (binary, little endian)", 4, 3);
    assert_triangles(file, (const uint32_t[]){0, 1, 2, 0, 1, 2, 0, 2, 3}, 9);
    assert_tag_names(file, "label 10,label -1,label -1");
    laves_context *context = laves_context_create(NULL);
    laves__surface_input input;
    parse_surface(context, file, &input);
    assert_true(input.points[3].x == 3.5 && input.points[3].y == 0.1 && input.points[3].z == -9);
    laves__surface_input_free(context, &input);
    laves_context_free(context);
  }
}

/* After the only line end of the header, a lone CR, the data may begin with an LF. */
static void lone_cr_before_lf_is_no_pair(void **state) {
  (void)state;
  static const char FILE_BYTES[] =
      "ply\rformat binary_little_endian 1.0\relement face 1\rproperty uchar flag\r"
      "property list uchar uchar vertex_index\relement vertex 3\rproperty char x\rproperty char y\r"
      "property char z\rend_header\r\n\3\0\1\2aaaaabaac";
  assert_surface(TEXT_FILE("x", FILE_BYTES), "PLY (binary, little endian)", 3, 1);
}

static void faults_are_told_with_the_place(void **state) {
  (void)state;
  assert_refused(TEXT_FILE("a.ply", "ply\nformat ascii 1.0\n" VERTEX), "the file ends inside the header");
  assert_refused(TEXT_FILE("a.ply", "ply\n" VERTEX FACE "end_header\n" DATA), "no line 'format'");
  assert_refused(TEXT_FILE("a.ply", "ply\nformat ebcdic 1.0\n"), "line 2: expected ascii, ");
  assert_refused(TEXT_FILE("a.ply", "ply\nformat ascii 1.0\nproperty float x\n"), "line 3: a property stands before");
  assert_refused(TEXT_FILE("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty quad x\n"), "line 4: expected a type");
  assert_refused(TEXT_FILE("a.ply", "ply\nformat ascii 1.0\nelement vertex -3\n"), "line 3: expected how many");
  assert_refused(TEXT_FILE("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n0 0 0\n"),
                 "no properties x, y and z");
  assert_refused(TEXT_FILE("a.ply",
                           "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                           "end_header\n0 0 0\n"),
                 "no faces");
  assert_refused(
      TEXT_FILE("a.ply", "ply\nformat ascii 1.0\n" VERTEX FACE "end_header\n0 0 0\n1 0 0\n1 nan 0\n0 0 0\n3 0 1 2\n3 0 1 2\n"),
      "a.ply, line 12: vertex 3 of 4, y: there is no finite number");
  assert_refused(
      TEXT_FILE("a.ply", "ply\nformat ascii 1.0\n" VERTEX FACE "end_header\n0 0 0\n1 0 0\n1 0 0\n0 0 0\n3 0 1 2\n3 0 1 4\n"),
      "line 15: face 2 uses point 5 of 4");
  assert_refused(
      TEXT_FILE("a.ply", "ply\nformat ascii 1.0\n" VERTEX FACE "end_header\n0 0 0\n1 0 0\n1 0 0\n0 0 0\n3 0 1 2\n3 0 1.5 2\n"),
      "line 15: face 2 of 2, vertex_indices: this is not the index");
  assert_refused(TEXT_FILE("a.ply", "ply\nformat ascii 1.0\n" VERTEX FACE "end_header\n0 0 0\n1 0 0\n1 0 0\n0 0 0\n200 0 1 2\n"),
                 "line 14: face 1 of 2, vertex_indices: the length of the list");
  assert_refused(TEXT_FILE("a.ply",
                           "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\n"
                           "property float y\nproperty float z\nend_header\nabcdefghijklmnopqrstuvwxyz"),
                 "byte 124: 4000000000 of element vertex are promised");
}

static void damage_is_safe(void **state) {
  (void)state;
  unsigned char bytes[1000];
  const small_file text = TEXT_FILE("a.ply", ASCII_FILE);
  const small_file little = make_binary(bytes, false, "\n");
  assert_damage_is_safe(text);
  assert_short_memory_is_safe(text);
  assert_damage_is_safe(little);
  assert_short_memory_is_safe(little);
  assert_damage_is_safe(make_binary(bytes, true, "\r"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(text_is_read),
      cmocka_unit_test(strangers_are_passed_over),
      cmocka_unit_test(labels_become_tags),
      cmocka_unit_test(any_integer_may_be_the_label),
      cmocka_unit_test(strips_become_triangles),
      cmocka_unit_test(binaries_are_read),
      cmocka_unit_test(lone_cr_before_lf_is_no_pair),
      cmocka_unit_test(faults_are_told_with_the_place),
      cmocka_unit_test(damage_is_safe),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
