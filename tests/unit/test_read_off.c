/* OFF and its relatives. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

#include "fixtures/parse_surface.h"

#define BODY "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n"

static void plain_files_are_read(void **state) {
  (void)state;
  static const uint32_t CORNERS[] = {0, 1, 2, 0, 1, 2, 0, 2, 3};
  assert_triangles(TEXT_FILE("x", "OFF\n4 2 0\n" BODY), CORNERS, 9);
  assert_triangles(TEXT_FILE("x", "OFF 4 2\n" BODY), CORNERS, 9);
  assert_triangles(TEXT_FILE("x", "# by hand\nOFF # x\n\n# y\n4 2 0 # z\n\n" BODY), CORNERS, 9);
  assert_triangles(TEXT_FILE("x.off", "4 2 0\n" BODY), CORNERS, 9);
  assert_surface(TEXT_FILE("x", "OFF\r\n4 2 0\r\n" BODY), "OFF", 4, 3);
}

static void colours_and_normals_are_passed_over(void **state) {
  (void)state;
  static const uint32_t CORNERS[] = {0, 1, 2};
  assert_triangles(TEXT_FILE("x", "COFF\n3 1 0\n0 0 0 255 0 0 1\n1 0 0 255 0 0 1\n0 1 0 0 0 0 1\n3 0 1 2 0.5 0.5 0.5\n"), CORNERS,
                   3);
  assert_triangles(TEXT_FILE("x", "NOFF 3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 nan\n0 1 0 0 0 1\n3 0 1 2 # red\n"), CORNERS, 3);
  assert_triangles(TEXT_FILE("x", "STCNOFF 3 1 0\n0 0 0 0 0 1 0 0\n1 0 0 0 0 1 0 0\n0 1 0 0 0 1 0 0\n3 0 1 2 7\n"), CORNERS, 3);
}

static void faults_are_told_with_the_line(void **state) {
  (void)state;
  assert_refused(TEXT_FILE("a.off", "OFF\n4 0 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"), "no faces");
  assert_refused(TEXT_FILE("a.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 inf 0\n"),
                 "a.off, line 5: expected a coordinate (a finite number) of vertex 3 of 4, found 'inf'");
  assert_refused(TEXT_FILE("a.off", "OFF\n4 3 0\n" BODY),
                 "line 9: expected the number of corners of face 3 of 3, but the file ends");
  assert_refused(TEXT_FILE("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 3\n"), "line 6: face 1 uses point 4 of 3");
  assert_refused(TEXT_FILE("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 -1\n"), "line 6: face 1 uses point -1");
  assert_refused(TEXT_FILE("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n2 0 1\n"), "line 6: face 1 has 2 corners");
  assert_refused(TEXT_FILE("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n99999999999 0 1 2\n"),
                 "line 7: expected corner 4 of 99999999999");
  assert_refused(TEXT_FILE("a.off", "OFF\n99999999999 1 0\n"), "line 2: expected the number of vertices");
  assert_refused(TEXT_FILE("a.off", "OFF\n4000000000 1000000000000 0\n0 0 0\n"), "vertex 2 of 4000000000");
  assert_refused(TEXT_FILE("a.off", "OFF BINARY\n"), "only OFF files in text");
  assert_refused(TEXT_FILE("a.off", "4OFF\n3 1 0\n"), "only OFF files in text");
}

static void damage_is_safe(void **state) {
  (void)state;
  const small_file file = TEXT_FILE("a.off", "OFF # x\n4 2 0\n" BODY);
  assert_damage_is_safe(file);
  assert_short_memory_is_safe(file);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(plain_files_are_read),
      cmocka_unit_test(colours_and_normals_are_passed_over),
      cmocka_unit_test(faults_are_told_with_the_line),
      cmocka_unit_test(damage_is_safe),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
