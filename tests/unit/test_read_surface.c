/* Which format a surface has, from content and name, and how reading is called off. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/parse_surface.h"

#define OBJ_TEXT "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
#define OFF_TEXT "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
#define STL_TEXT "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"
#define PLY_TEXT                                                                                                    \
  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n" \
  "property list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"

static void content_outweighs_the_name(void **state) {
  (void)state;
  static const char *const NAMES[] = {"a.obj", "a.off", "a.stl", "a.ply", "a", NULL};
  for (size_t i = 0; i < LAVES__COUNT_OF(NAMES); ++i) {
    assert_surface(TEXT_FILE(NAMES[i], OBJ_TEXT), "OBJ", 3, 1);
    assert_surface(TEXT_FILE(NAMES[i], OFF_TEXT), "OFF", 3, 1);
    assert_surface(TEXT_FILE(NAMES[i], STL_TEXT), "STL (ASCII)", 3, 1);
    assert_surface(TEXT_FILE(NAMES[i], PLY_TEXT), "PLY (ASCII)", 3, 1);
  }
}

static void byte_order_mark_does_no_harm(void **state) {
  (void)state;
  assert_surface(TEXT_FILE("a", "\xEF\xBB\xBF" OBJ_TEXT), "OBJ", 3, 1);
  assert_surface(TEXT_FILE("a", "\xEF\xBB\xBF" PLY_TEXT), "PLY (ASCII)", 3, 1);
}

static void name_decides_when_content_does_not(void **state) {
  (void)state;
  assert_refused(TEXT_FILE("a.obj", "hello\n"), "the OBJ file has no faces");
  assert_refused(TEXT_FILE("a.STL", "hello\n"), "neither ASCII STL");
  assert_refused(TEXT_FILE("a.b/off", "hello\n"), "no triangle surface that is known here");
  assert_refused(TEXT_FILE("a.off", "hello\n"), "a.off, line 1: expected the number of vertices, found 'hello'");
  assert_refused(TEXT_FILE(NULL, "hello\n"), "no triangle surface that is known here");
}

static void nothing_is_refused(void **state) {
  (void)state;
  assert_refused(TEXT_FILE("a.stl", ""), "a.stl: the file is empty");
  assert_refused(TEXT_FILE(NULL, "\xEF\xBB\xBF"), "the file is empty");
  assert_refused(TEXT_FILE("a.obj", "\n\n  \n"), "no faces");
}

static bool refuse(void *user, const char *phase, double fraction) {
  (void)user;
  assert_string_equal(phase, "read");
  assert_true(fraction >= 0 && fraction <= 1);
  return false;
}

static void reading_can_be_cancelled(void **state) {
  (void)state;
  enum { COUNT = 40000, LINE = 8 };
  char *text = malloc(COUNT * LINE + 1);
  assert_non_null(text);
  for (size_t i = 0; i < COUNT; ++i) {
    snprintf(text + i * LINE, LINE + 1, "v 0 0 0\n");
  }
  laves_context_options options = laves_context_options_default();
  options.progress = refuse;
  laves_context *context = laves_context_create(&options);
  laves__surface_input input;
  laves_error error = {0};
  assert_int_equal(laves__surface_parse(context, text, COUNT * LINE, "a", &input, &error), LAVES_ERROR_CANCELLED);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
  free(text);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(content_outweighs_the_name),         cmocka_unit_test(byte_order_mark_does_no_harm),
      cmocka_unit_test(name_decides_when_content_does_not), cmocka_unit_test(nothing_is_refused),
      cmocka_unit_test(reading_can_be_cancelled),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
