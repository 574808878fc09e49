/* OBJ: polygons, indices of all kinds, tags. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

#include "fixtures/parse_surface.h"

#define POINTS "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

static void polygons_become_fans(void **state) {
  (void)state;
  assert_triangles(TEXT_FILE("x", POINTS "v 0 0 1\nf 1 2 3 4 5\n"), (const uint32_t[]){0, 1, 2, 0, 2, 3, 0, 3, 4}, 9);
}

static void all_forms_of_corners_are_read(void **state) {
  (void)state;
  assert_triangles(
      TEXT_FILE("x", "# comment\r\n" POINTS "vt 0 0\nvn 0 0 1\nf 1/1 2/1 3/1 # x\nf 1//1 2//1 3//1\nf 1/1/1 2/1/1 3/1/1\n"
                     "f 1/ 2/ 3/\n\tf\t+1  2 3 \t\n"),
      (const uint32_t[]){0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2}, 15);
}

static void negative_indices_count_back(void **state) {
  (void)state;
  assert_triangles(TEXT_FILE("x", POINTS "f -4 -3 -2\nv 2 2 2\nf -1 -2/-1 -3\n"), (const uint32_t[]){0, 1, 2, 4, 3, 2}, 6);
}

static void faces_may_come_before_points(void **state) {
  (void)state;
  assert_triangles(TEXT_FILE("x", "f 1 2 3\n" POINTS), (const uint32_t[]){0, 1, 2}, 3);
}

static void lines_may_be_joined(void **state) {
  (void)state;
  assert_triangles(TEXT_FILE("x", "v 0 \\\n0 0\n" POINTS "f 1 2\\\r\n 3 \\\n4\n# not a joint \\\nf 1 2 3\n"),
                   (const uint32_t[]){0, 1, 2, 0, 2, 3}, 6);
}

static void other_lines_and_colours_are_passed_over(void **state) {
  (void)state;
  assert_surface(
      TEXT_FILE("x", "mtllib a.mtl\nv 0 0 0 0.5 0.5 nan\nv 1 0 0 1.0\nv 0 1 0\ns off\nl 1 2\np 1\nwhatever 1 2\n\n f 1 2 3"),
      "OBJ", 3, 1);
}

static void groups_become_tags(void **state) {
  (void)state;
  assert_tag_names(
      TEXT_FILE("x", POINTS "f 1 2 3\ng top left \nf 1 2 3\no bottom\nusemtl red\nf 1 2 3 4\ng\nf 1 2 3\ng top left\nf 1 2 3\n"),
      "default,top left,bottom,bottom,default,top left");
  assert_tag_names(TEXT_FILE("x", POINTS "f 1 2 3\n"), "");
}

static void materials_become_tags_where_groups_tell_nothing(void **state) {
  (void)state;
  assert_tag_names(TEXT_FILE("x", POINTS "f 1 2 3\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 2 3\n"), "none,red,blue");
  assert_tag_names(TEXT_FILE("x", POINTS "o all\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 2 3\n"), "red,blue");
  assert_tag_names(TEXT_FILE("x", POINTS "o all\nusemtl red\nf 1 2 3\n"), "all");
}

static void faults_are_told_with_the_line(void **state) {
  (void)state;
  assert_refused(TEXT_FILE("a.obj", POINTS), "no faces");
  assert_refused(TEXT_FILE("a.obj", POINTS "f 1 2 3\nf 1 2 5\nf 1 2 4\n"), "a.obj, line 6: face 2 uses point 5 of 4");
  assert_refused(TEXT_FILE("a.obj", POINTS "f 1 -5 3\n"), "line 5: face 1 uses vertex -5, but only 4 stand before it");
  assert_refused(TEXT_FILE("a.obj", POINTS "f 1 0 3\n"), "line 5: expected the index of a vertex");
  assert_refused(TEXT_FILE("a.obj", POINTS "f 1 2\n"), "line 5: face 1 has 2 corners");
  assert_refused(TEXT_FILE("a.obj", POINTS "f 1 2 3x\n"), "line 5: expected a space or '/'");
  assert_refused(TEXT_FILE("a.obj", POINTS "f 1 2 99999999999999999999\n"), "line 5: expected the index");
  assert_refused(TEXT_FILE("a.obj", POINTS "f 1 2 4294967296\n"), "line 5: face 1 uses point 4294967295");
  assert_refused(TEXT_FILE("a.obj", "v 0 0 0\nv 1 1e999 0\n"), "line 2: expected a coordinate (a finite number), found '1e999'");
  assert_refused(TEXT_FILE("a.obj", "v 0 0 0\nv 1 0\nv 1 1 1\n"),
                 "line 2: expected a coordinate (a finite number), but the line ends");
}

static void damage_is_safe(void **state) {
  (void)state;
  const small_file file = TEXT_FILE("a.obj", "# x\n" POINTS "o a\nf 1/1 2/2 3/3\nusemtl m\nf -1 -2 \\\n -3\ng b\nf 1 2 3 4\n");
  assert_damage_is_safe(file);
  assert_short_memory_is_safe(file);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(polygons_become_fans),
      cmocka_unit_test(all_forms_of_corners_are_read),
      cmocka_unit_test(negative_indices_count_back),
      cmocka_unit_test(faces_may_come_before_points),
      cmocka_unit_test(lines_may_be_joined),
      cmocka_unit_test(other_lines_and_colours_are_passed_over),
      cmocka_unit_test(groups_become_tags),
      cmocka_unit_test(materials_become_tags_where_groups_tell_nothing),
      cmocka_unit_test(faults_are_told_with_the_line),
      cmocka_unit_test(damage_is_safe),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
