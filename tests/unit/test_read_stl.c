/* STL in both forms. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/parse_surface.h"

#define FACET "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1.5 0 -2e-3\n  vertex 0 1 0\n endloop\nendfacet\n"

static void solids_become_tags(void **state) {
  (void)state;
  const small_file file = TEXT_FILE("x", "solid upper part\n" FACET FACET "endsolid upper part\n\nsolid\n" FACET
                                         "endsolid\nSOLID upper part\r\n" FACET "ENDSOLID");
  assert_surface(file, "STL (ASCII)", 12, 4);
  assert_tag_names(file, "upper part,upper part,solid,upper part");
}

static void coordinates_are_doubles(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves__surface_input input;
  parse_surface(context, TEXT_FILE("x", "solid a\n" FACET "endsolid a\n"), &input);
  assert_true(input.points[1].x == 1.5 && input.points[1].z == -2e-3);
  laves__surface_input_free(context, &input);
  laves_context_free(context);
}

static void ascii_oddities_are_read(void **state) {
  (void)state;
  assert_surface(TEXT_FILE("x",
                           "  solid x\nfacet normal nan -nan(ind) inf outer loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 0 "
                           "vertex 0 1 0 endloop endfacet endsolid"),
                 "STL (ASCII)", 4, 2);
  assert_surface(
      TEXT_FILE("x", "solid x\rfacet\router loop\rVertex 0 0 0\rvertex 1 0 0\rvertex 1 1 0\rendloop\rendfacet\rendsolid"),
      "STL (ASCII)", 3, 1);
}

static void faults_of_ascii_are_told_with_the_line(void **state) {
  (void)state;
  assert_refused(TEXT_FILE("a.stl", "solid x\n" FACET), "line 9: expected 'endsolid', but the file ends");
  assert_refused(TEXT_FILE("a.stl", "solid x\nendsolid x\n"), "no faces");
  assert_refused(TEXT_FILE("a.stl", "solid x\nfacet\nouter loop\nvertex 1 2 nan\n"),
                 "a.stl, line 4: expected a coordinate (a finite number), found 'nan'");
  assert_refused(TEXT_FILE("a.stl", "solid x\nfacet\nouter loop\nvertex 1 2 3\nvertex 1 2 4\nendloop\nendfacet\nendsolid"),
                 "line 6: expected 'vertex', found 'endloop'");
  assert_refused(TEXT_FILE("a.stl", "solid x\n" FACET "endsolid\nrubbish"), "line 10: expected 'solid', found 'rubbish'");
}

/* A binary STL with `count` facets and this header; the caller frees it. */
static small_file make_binary(const char *header, unsigned count) {
  const size_t length = 84 + 50 * (size_t)count;
  unsigned char *bytes = calloc(1, length);
  assert_non_null(bytes);
  memcpy(bytes, header, strlen(header));
  bytes[80] = (unsigned char)count;
  for (unsigned i = 0; i < count; ++i) {
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, (float)i + 0.25f};
    for (int j = 0; j < 9; ++j) {
      uint32_t bits;
      memcpy(&bits, &corners[j], 4);
      for (int k = 0; k < 4; ++k) {
        bytes[84 + 50 * i + 12 + 4 * (unsigned)j + (unsigned)k] = (unsigned char)(bits >> (8 * k));
      }
    }
    bytes[84 + 50 * i + 49] = 0xA5;  // attributes
  }
  return (small_file){"b.stl", bytes, length};
}

static void binary_is_known_by_its_length(void **state) {
  (void)state;
  static const char *const HEADERS[] = {"", "solid plate\n", "\xEF\xBB\xBFx", "ply but not", "OFF", "v 1 2 3"};
  for (size_t i = 0; i < LAVES__COUNT_OF(HEADERS); ++i) {
    const small_file file = make_binary(HEADERS[i], 3);
    assert_surface(file, "STL (binary)", 9, 3);
    assert_triangles(file, (const uint32_t[]){0, 1, 2, 3, 4, 5, 6, 7, 8}, 9);
    free((void *)file.bytes);
  }
  const small_file file = make_binary("", 2);
  laves_context *context = laves_context_create(NULL);
  laves__surface_input input;
  parse_surface(context, file, &input);
  assert_true(input.points[5].z == 1.25 && input.points[4].x == 1 && input.points[3].x == 0);
  laves__surface_input_free(context, &input);
  laves_context_free(context);
  free((void *)file.bytes);
}

static void faults_of_binary_are_told_with_the_byte(void **state) {
  (void)state;
  small_file file = make_binary("solid x", 3);
  unsigned char *bytes = (unsigned char *)file.bytes;
  bytes[84 + 50 + 12 + 3] = 0x7F;
  bytes[84 + 50 + 12 + 2] = 0x80;
  assert_refused(file, "byte 134: facet 2 has a coordinate that is not a finite number");
  bytes[80] = 200;
  assert_refused(file, "byte 80: the file promises 200 facets, which take 10084 bytes, but it has 234");
  bytes[80] = 3;
  --file.length;
  assert_refused(file, "promises 3 facets");
  file.length = 50;
  assert_refused(file, "neither ASCII STL");
  free(bytes);
  file = make_binary("", 0);
  assert_refused(file, "no faces");
  free((void *)file.bytes);
}

static void damage_is_safe(void **state) {
  (void)state;
  const small_file ascii = TEXT_FILE("a.stl", "solid a\n" FACET FACET "endsolid a\nsolid b\n" FACET "endsolid b\n");
  const small_file binary = make_binary("header", 2);
  assert_damage_is_safe(ascii);
  assert_damage_is_safe(binary);
  assert_short_memory_is_safe(ascii);
  assert_short_memory_is_safe(binary);
  free((void *)binary.bytes);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(solids_become_tags),
      cmocka_unit_test(coordinates_are_doubles),
      cmocka_unit_test(ascii_oddities_are_read),
      cmocka_unit_test(faults_of_ascii_are_told_with_the_line),
      cmocka_unit_test(binary_is_known_by_its_length),
      cmocka_unit_test(faults_of_binary_are_told_with_the_byte),
      cmocka_unit_test(damage_is_safe),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
