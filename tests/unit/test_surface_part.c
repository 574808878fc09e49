/* Parts of a surface: which triangles go together, which points are in which part. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "domain/surface.h"
#include "fixtures/shapes.h"

typedef struct body {
  double lower[3], upper[3];
  bool hollow; /* turned over: bounds a cavity */
  int32_t tag;
} body;

typedef struct made {
  laves_context *context;
  laves_domain *domain;
  laves__parts *parts;
} made;

/* Boxes in one surface; with_tags: each has its body's tag. first_kept: triangles to leave out at the end. */
static made make(const body *bodies, size_t count, bool with_tags, size_t dropped) {
  made m = {.context = laves_context_create(NULL)};
  shape all = shape_box(bodies[0].lower, bodies[0].upper, 2);
  int32_t tags[10000];
  size_t tag_count = 0;
  for (size_t i = 0; i < count; i++) {
    shape next = shape_box(bodies[i].lower, bodies[i].upper, 2);
    if (bodies[i].hollow) shape_turn_over(&next);
    for (size_t t = 0; t < next.triangle_count; t++) tags[tag_count++] = bodies[i].tag;
    if (i > 0) shape_append(&all, &next);
    shape_free(&next);
  }
  laves_error error = {0};
  if (laves_domain_from_triangles(m.context, all.points, all.point_count, all.triangles, all.triangle_count - dropped,
                                  with_tags ? tags : NULL, &m.domain, &error) != LAVES_OK)
    fail_msg("%s", error.text);
  shape_free(&all);
  m.parts = laves__parts_create(m.domain->oracle.surface, false);
  assert_non_null(m.parts);
  return m;
}

static int32_t part_at(const made *m, double x, double y, double z) {
  return laves__parts_at(m->parts, v3_sub(v3(x, y, z), m->domain->oracle.origin));
}

static void drop(made *m) {
  laves__parts_free(m->parts);
  laves_domain_free(m->domain);
  assert_int_equal(laves_context_bytes(m->context), 0);
  laves_context_free(m->context);
}

static const body touching[] = {
    {{0, 0, 0}, {1, 1, 1}, false, 5}, {{1, 0, 0}, {2, 1, 1}, false, 3}, {{1, 1, 0}, {2, 2, 1}, false, 8}};

/* Boxes with a whole face, and with an edge alone, in common: their edges have four faces, or six. */
static void touching_boxes_are_parts(void **state) {
  (void)state;
  for (int tagged = 0; tagged < 2; tagged++) {
    made m = make(touching, 3, tagged, 0);
    assert_int_equal(laves__parts_count(m.parts), 3);
    for (int i = 0; i < 3; i++) assert_int_equal(laves__parts_tag(m.parts, (size_t)i), tagged ? touching[i].tag : -1);
    assert_int_equal(part_at(&m, 0.99, 0.5, 0.5), 0);
    assert_int_equal(part_at(&m, 1.01, 0.5, 0.5), 1);
    assert_int_equal(part_at(&m, 1.5, 1.01, 0.5), 2);
    assert_int_equal(part_at(&m, 0.5, 1.5, 0.5), -1);
    drop(&m);
  }
}

static void the_innermost_of_nested_parts_is_found(void **state) {
  (void)state;
  static const body nested[] = {
      {{0, 0, 0}, {4, 4, 4}, false, 0}, {{2, 2, 2}, {3, 3, 3}, false, 1}, {{1, 1, 1}, {3.5, 3.5, 3.5}, false, 2}};
  made m = make(nested, 3, false, 0);
  assert_int_equal(laves__parts_count(m.parts), 3);
  assert_int_equal(part_at(&m, 0.5, 0.5, 0.5), 0);
  assert_int_equal(part_at(&m, 1.5, 1.5, 1.5), 2);
  assert_int_equal(part_at(&m, 2.5, 2.5, 2.5), 1);
  drop(&m);
}

/* A cavity is no part, and what floats in it is one. */
static void cavities_belong_to_what_is_around_them(void **state) {
  (void)state;
  static const body hollow[] = {
      {{0, 0, 0}, {4, 4, 4}, false, 0}, {{1, 1, 1}, {3, 3, 3}, true, 0}, {{1.5, 1.5, 1.5}, {2.5, 2.5, 2.5}, false, 1}};
  for (int tagged = 0; tagged < 2; tagged++) {
    made m = make(hollow, 3, tagged, 0);
    assert_int_equal(laves__parts_count(m.parts), 2);
    assert_int_equal(part_at(&m, 0.5, 0.5, 0.5), 0);
    assert_int_equal(part_at(&m, 2, 2, 2), 1);
    /* With tags the cavity is of the same part as the box about it, which then ends there. */
    assert_int_equal(part_at(&m, 1.2, 1.2, 1.2), tagged ? -1 : 0);
    drop(&m);
  }
}

/* One tag for two boxes: one part. A tag on half of a box: no part of its own. */
static void tags_that_are_closed_are_parts(void **state) {
  (void)state;
  static const body same[] = {
      {{0, 0, 0}, {1, 1, 1}, false, 7}, {{4, 0, 0}, {5, 1, 1}, false, 7}, {{8, 0, 0}, {9, 1, 1}, false, 9}};
  made m = make(same, 3, true, 0);
  assert_int_equal(laves__parts_count(m.parts), 2);
  assert_int_equal(laves__parts_tag(m.parts, 0), 7);
  assert_int_equal(part_at(&m, 0.5, 0.5, 0.5), 0);
  assert_int_equal(part_at(&m, 4.5, 0.5, 0.5), 0);
  assert_int_equal(part_at(&m, 8.5, 0.5, 0.5), 1);
  drop(&m);
}

static void open_parts_are_left_out(void **state) {
  (void)state;
  static const body two[] = {{{0, 0, 0}, {1, 1, 1}, false, 0}, {{4, 0, 0}, {5, 1, 1}, false, 0}};
  made m = make(two, 2, false, 1);
  assert_int_equal(laves__parts_count(m.parts), 1);
  assert_int_equal(part_at(&m, 0.5, 0.5, 0.5), 0);
  assert_int_equal(part_at(&m, 4.5, 0.5, 0.5), -1);
  drop(&m);
}

static void a_single_part_is_none(void **state) {
  (void)state;
  static const body one[] = {{{0, 0, 0}, {1, 1, 1}, false, 0}};
  made m = make(one, 1, false, 0);
  assert_int_equal(laves__parts_count(m.parts), 0);
  assert_int_equal(part_at(&m, 0.5, 0.5, 0.5), -1);
  drop(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(touching_boxes_are_parts),
      cmocka_unit_test(the_innermost_of_nested_parts_is_found),
      cmocka_unit_test(cavities_belong_to_what_is_around_them),
      cmocka_unit_test(tags_that_are_closed_are_parts),
      cmocka_unit_test(open_parts_are_left_out),
      cmocka_unit_test(a_single_part_is_none),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
