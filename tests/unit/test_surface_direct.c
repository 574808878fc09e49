/* How a surface is read as a solid: winding levels, parts within parts, holes that are refused, and places of defects. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "domain/features.h"
#include "domain/oracle.h"
#include "fixtures/folders.h"
#include "fixtures/shapes.h"
#include "io/file.h"
#include "io/read_lines.h"

typedef struct made {
  laves_domain *domain; /* NULL: refused */
  laves_domain_info info;
  laves_result result;
  laves_error error;
} made;

static made make_with(laves_context *context, const shape *s, const laves_surface_options *options) {
  made m = {.error = {.text = ""}};
  m.result = laves_domain_from_triangles_with(context, s->points, s->point_count, s->triangles, s->triangle_count, NULL, options,
                                              &m.domain, &m.error);
  if (m.domain) laves_domain_get_info(m.domain, &m.info);
  return m;
}

static made make(laves_context *context, const shape *s, laves_overlap overlap, double winding) {
  laves_surface_options options = laves_surface_options_default();
  options.overlap = overlap;
  options.winding = winding;
  return make_with(context, s, &options);
}

static double value_at(const laves_domain *domain, double x, double y, double z) {
  const double p[3] = {x, y, z};
  double phi;
  laves_domain_evaluate(domain, p, 1, &phi);
  return phi;
}

static shape box_at(double x0, double y0, double z0, double x1, double y1, double z1) {
  const double lower[3] = {x0, y0, z0}, upper[3] = {x1, y1, z1};
  return shape_box(lower, upper, 2);
}

/* Balls of radius 3, 2 and 1 about the origin; bit k of `turned`: ball k faces inwards. */
static shape onion(int balls, int turned) {
  shape all = {0};
  for (int k = 0; k < balls; k++) {
    shape ball = shape_sphere(3 - k, 5);
    if (turned >> k & 1) shape_turn_over(&ball);
    shape_append(&all, &ball);
    shape_free(&ball);
  }
  return all;
}

/* Inside or not in the middle of each shell, from outside in: a bit each. */
static int shells(const laves_domain *domain, int balls) {
  int inside = 0;
  for (int k = 0; k < balls; k++) inside |= (value_at(domain, 2.5 - k, 0.03, 0.02) < 0) << k;
  return inside;
}

static void parts_within_parts(void **unused) {
  (void)unused;
  static const struct {
    int balls, turned;
    laves_overlap overlap;
    int inside;
    size_t nested, hollow;
  } rows[] = {
      {2, 0, LAVES_OVERLAP_DIRECTION, 3, 1, 0}, {2, 2, LAVES_OVERLAP_DIRECTION, 1, 1, 1}, {2, 0, LAVES_OVERLAP_UNION, 3, 1, 0},
      {2, 2, LAVES_OVERLAP_UNION, 3, 1, 0},     {2, 0, LAVES_OVERLAP_NESTED, 1, 1, 1},    {2, 2, LAVES_OVERLAP_NESTED, 1, 1, 1},
      {3, 2, LAVES_OVERLAP_DIRECTION, 5, 2, 1}, {3, 0, LAVES_OVERLAP_DIRECTION, 7, 2, 0}, {3, 0, LAVES_OVERLAP_NESTED, 5, 2, 1},
      {3, 5, LAVES_OVERLAP_NESTED, 5, 2, 1},    {3, 7, LAVES_OVERLAP_UNION, 7, 2, 0},     {3, 6, LAVES_OVERLAP_UNION, 7, 2, 0},
  };
  laves_context *context = laves_context_create(NULL);
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    shape s = onion(rows[i].balls, rows[i].turned);
    made m = make(context, &s, rows[i].overlap, 0.5);
    assert_int_equal(m.result, LAVES_OK);
    if (shells(m.domain, rows[i].balls) != rows[i].inside)
      fail_msg("row %zu: inside %x", i, (unsigned)shells(m.domain, rows[i].balls));
    assert_int_equal(m.info.nested_parts, rows[i].nested);
    assert_int_equal(m.info.hollow_parts, rows[i].hollow);
    assert_int_equal(m.info.crossing_parts, 0);
    assert_int_equal(m.info.overlap, rows[i].overlap);
    laves_domain_free(m.domain);
    shape_free(&s);
  }
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

/* A hollow in two boxes that cross, once in one of them and once in both: by depth, the second is within two and so solid. */
static void hollows_of_parts_that_cross(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = box_at(0, 0, 0, 4, 4, 4), second = box_at(2.03, 0.05, 0.07, 7, 3.9, 3.8);
  shape left = box_at(0.5, 1, 1, 1.5, 2, 2), middle = box_at(2.5, 1, 1, 3.5, 2, 2);
  shape_append(&s, &second);
  shape_append(&s, &left);
  shape_append(&s, &middle);
  made m = make(context, &s, LAVES_OVERLAP_NESTED, 0.5);
  assert_int_equal(m.result, LAVES_OK);
  assert_true(value_at(m.domain, 1, 1.5, 1.5) > 0.4);
  assert_true(value_at(m.domain, 3, 1.5, 1.5) < 0);
  assert_true(value_at(m.domain, 6, 1.5, 1.5) < 0);
  assert_int_equal(m.info.crossing_parts, 2);
  assert_int_equal(m.info.nested_parts, 2);
  assert_int_equal(m.info.hollow_parts, 1);
  laves_domain_free(m.domain);
  shape_free(&s);
  shape_free(&second);
  shape_free(&left);
  shape_free(&middle);
  laves_context_free(context);
}

static void where_two_overlap(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = box_at(0, 0, 0, 2, 2, 2), more = box_at(1.03, 1.07, 1.11, 3, 3, 3);
  shape_append(&s, &more);
  made m = make(context, &s, LAVES_OVERLAP_DIRECTION, 1.5);
  assert_int_equal(m.result, LAVES_OK);
  assert_true(fabs(m.info.volume / (0.97 * 0.93 * 0.89) - 1) < 0.1);
  uint32_t state = 1;
  for (int i = 0; i < 3000; i++) {
    double p[3];
    for (int k = 0; k < 3; k++) p[k] = 3 * (double)((state = state * 1664525 + 1013904223) >> 8) / (1 << 24);
    const bool both = p[0] < 2 && p[1] < 2 && p[2] < 2 && p[0] > 1.03 && p[1] > 1.07 && p[2] > 1.11;
    assert_int_equal(value_at(m.domain, p[0], p[1], p[2]) < 0, both);
  }
  assert_true(fabs(value_at(m.domain, 1.5, 1.5, 1.95) + 0.05) < 1e-6);
  laves_domain_free(m.domain);
  m = make(context, &s, LAVES_OVERLAP_DIRECTION, 2.5); /* three never overlap */
  assert_int_equal(m.result, LAVES_ERROR_INPUT);
  assert_null(m.domain);
  assert_non_null(strstr(m.error.text, "2.5 times"));
  shape_free(&s);
  s = box_at(0, 0, 0, 1, 1, 1);
  m = make(context, &s, LAVES_OVERLAP_DIRECTION, 1.5);
  assert_int_equal(m.result, LAVES_ERROR_INPUT);
  assert_non_null(strstr(m.error.text, "1.5 times"));
  shape_free(&s);
  shape_free(&more);
  laves_context_free(context);
}

/* A box without its lid at z = 2 (the last eight of 48 triangles). */
static shape open_box(void) {
  shape s = box_at(0, 0, 0, 2, 2, 2);
  for (size_t f = s.triangle_count; f-- > 0;) {
    bool lid = true;
    for (int k = 0; k < 3; k++) lid = lid && s.points[3 * s.triangles[3 * f + (size_t)k] + 2] == 2;
    if (lid) shape_drop(&s, f, 1);
  }
  return s;
}

static void caps_stand_where_the_level_is(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = open_box();
  assert_int_equal(s.triangle_count, 40);
  double height[3];
  for (int i = 0; i < 3; i++) {
    made m = make(context, &s, LAVES_OVERLAP_DIRECTION, 0.3 + 0.2 * i);
    assert_int_equal(m.result, LAVES_OK);
    assert_int_equal(m.info.open_edges_left, 8);
    double low = 1, high = 3;
    for (int k = 0; k < 40; k++) {
      const double z = (low + high) / 2;
      *(value_at(m.domain, 1, 1, z) < 0 ? &low : &high) = z;
    }
    height[i] = low;
    laves_domain_free(m.domain);
  }
  assert_true(height[0] > height[1] + 0.1 && height[1] > height[2] + 0.1);
  /* The lid, seen from a point on it, fills half the sky: the number there is one half. */
  assert_true(fabs(height[1] - 2) < 0.01);
  shape_free(&s);
  laves_context_free(context);
}

static void holes_are_refused_on_request(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  laves_surface_options options = laves_surface_options_default();
  options.close_holes = false;
  shape s = open_box();
  made m = make_with(context, &s, &options);
  assert_int_equal(m.result, LAVES_ERROR_INPUT);
  double x, y, z;
  const char *near = strstr(m.error.text, "near (");
  assert_non_null(strstr(m.error.text, "8 edges"));
  assert_non_null(near);
  assert_int_equal(sscanf(near, "near (%lf, %lf, %lf)", &x, &y, &z), 3);
  assert_true(z == 2 && (x == 0 || x == 2 || y == 0 || y == 2));
  shape_free(&s);
  /* A crack that mending closes is no hole: each triangle has corners of its own, moved a little. */
  shape whole = box_at(0, 0, 0, 2, 2, 2), torn = {0};
  for (size_t f = 0; f < whole.triangle_count; f++) {
    double points[9];
    uint32_t corners[3] = {0, 1, 2};
    for (size_t k = 0; k < 9; k++)
      points[k] = whole.points[3 * whole.triangles[3 * f + k / 3] + k % 3] + 1e-6 * (double)((f * 7 + k * 5) % 3);
    const shape one = {points, 3, corners, 1};
    shape_append(&torn, &one);
  }
  m = make_with(context, &torn, &options);
  assert_int_equal(m.result, LAVES_OK);
  assert_true(m.info.defects[LAVES_DEFECT_OPEN_EDGE] > 0);
  assert_int_equal(m.info.open_edges_left, 0);
  laves_domain_free(m.domain);
  shape_free(&whole);
  shape_free(&torn);
  laves_context_free(context);
}

static void options_are_checked(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = box_at(0, 0, 0, 1, 1, 1);
  static const double wrong[] = {0, -0.5, 0.04, 1, 2.01, 0.97, 101, NAN, INFINITY};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    made m = make(context, &s, LAVES_OVERLAP_DIRECTION, wrong[i]);
    assert_int_equal(m.result, LAVES_ERROR_OPTION);
    assert_non_null(strstr(m.error.text, "winding number"));
    assert_null(m.domain);
  }
  laves_surface_options options = {.winding = 0.5};
  assert_int_equal(make_with(context, &s, &options).result, LAVES_ERROR_OPTION);
  options = laves_surface_options_default();
  options.overlap = (laves_overlap)7;
  assert_int_equal(make_with(context, &s, &options).result, LAVES_ERROR_OPTION);
  assert_int_equal(laves_context_bytes(context), 0);
  shape_free(&s);
  laves_context_free(context);
}

/* ---- places of defects ---- */

static size_t places_of(const laves_defects *defects, laves_defect kind, int corners) {
  size_t count = 0;
  for (size_t i = 0; i < laves_defects_count(defects); i++) {
    laves_defect_place place;
    laves_defects_get(defects, i, &place);
    count += place.kind == kind && (corners == 0 || place.corner_count == corners);
  }
  return count;
}

/* A box far from zero without a lid, with a face twice, a point alone, and a second box through its wall. */
static shape broken_boxes(void) {
  shape s = open_box(), more = box_at(1, 0.6, 0.55, 3, 1.4, 1.45);
  const shape twice = {s.points, s.point_count, s.triangles, 1};
  shape_append(&s, &twice);
  shape_append(&s, &more);
  shape_move(&s, 1000, 2000, -500);
  shape_free(&more);
  return s;
}

static void each_defect_has_a_place(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  laves_surface_options options = laves_surface_options_default();
  assert_int_equal(laves_defects_create(context, &options.defects, NULL), LAVES_OK);
  shape s = broken_boxes();
  for (int again = 0; again < 2; again++) { /* the second time does not add to the first */
    made m = make_with(context, &s, &options);
    assert_int_equal(m.result, LAVES_OK);
    const laves_defects *d = options.defects;
    for (int kind = 0; kind < LAVES_DEFECT_COUNT; kind++)
      assert_int_equal(places_of(d, (laves_defect)kind, kind == LAVES_DEFECT_CROSSING ? 2 : 0), m.info.defects[kind]);
    assert_int_equal(places_of(d, LAVES_DEFECT_OPEN_EDGE, 2), 8);
    assert_int_equal(places_of(d, LAVES_DEFECT_DUPLICATE_FACE, 3), 1);
    assert_true(places_of(d, LAVES_DEFECT_CROSSING, 3) > 4);
    for (size_t i = 0; i < laves_defects_count(d); i++) {
      laves_defect_place p;
      laves_defects_get(d, i, &p);
      for (int k = 0; k < p.corner_count; k++) {
        assert_true(p.corners[k][0] > 999 && p.corners[k][0] < 1004 && p.corners[k][2] > -501);
        if (p.kind == LAVES_DEFECT_OPEN_EDGE) assert_true(p.corners[k][2] == -498);
      }
    }
    laves_domain_free(m.domain);
  }
  laves_defects_free(options.defects);
  assert_int_equal(laves_context_bytes(context), 0);
  shape_free(&s);
  laves_context_free(context);
}

static void refused_surfaces_have_places_too(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  laves_surface_options options = laves_surface_options_default();
  assert_int_equal(laves_defects_create(context, &options.defects, NULL), LAVES_OK);
  double points[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  uint32_t corners[3] = {0, 1, 2};
  const shape sheet = {points, 3, corners, 1};
  assert_int_equal(make_with(context, &sheet, &options).result, LAVES_ERROR_INPUT);
  assert_int_equal(places_of(options.defects, LAVES_DEFECT_OPEN_EDGE, 2), 3);
  laves_defects_free(options.defects);
  laves_context_free(context);
}

static size_t occurrences(const char *text, const char *word) {
  size_t count = 0;
  for (; (text = strstr(text, word)) != NULL; text++) count++;
  return count;
}

static void places_are_written(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  laves_surface_options options = laves_surface_options_default();
  assert_int_equal(laves_defects_create(context, &options.defects, NULL), LAVES_OK);
  shape s = broken_boxes();
  made m = make_with(context, &s, &options);
  const size_t all = laves_defects_count(options.defects), edges = m.info.defects[LAVES_DEFECT_CROSSING] + 8;
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 20];
  assert_true(fixture_folder_make(folder));
  static const char *const names[] = {"d.obj", "d.vtp", "d.ply"};
  for (int i = 0; i < 3; i++) {
    snprintf(path, sizeof path, "%s/%s", folder, names[i]);
    assert_int_equal(laves_defects_write(context, options.defects, path, &m.error), LAVES_OK);
    char *bytes;
    size_t length;
    assert_int_equal(laves__file_read(context, path, &bytes, &length, NULL), LAVES_OK);
    if (i == 0) {
      assert_int_equal(occurrences(bytes, "\np ") + occurrences(bytes, "\nl ") + occurrences(bytes, "\nf "), all);
      assert_non_null(strstr(bytes, "g open_edges\n"));
    }
    if (i == 2) {
      char elements[40];
      snprintf(elements, sizeof elements, "element edge %zu\n", edges);
      assert_non_null(strstr(bytes, elements));
      snprintf(elements, sizeof elements, "element face %zu\n",
               all - edges - places_of(options.defects, LAVES_DEFECT_REPEATED_POINT, 1) -
                   places_of(options.defects, LAVES_DEFECT_UNUSED_POINT, 1));
      assert_non_null(strstr(bytes, elements));
    }
    laves__free(context, bytes, length + 1, 1);
  }
  /* What is open and what crosses can be read back as lines. */
  for (int i = 0; i < 2; i++) {
    snprintf(path, sizeof path, "%s/%s", folder, names[i]);
    laves_features *features;
    assert_int_equal(laves_features_create(context, &features, NULL), LAVES_OK);
    if (laves_features_add_file(features, path, &m.error)) fail_msg("%s: %s", names[i], m.error.text);
    assert_int_equal(features->line_count, edges);
    laves_features_free(features);
  }
  snprintf(path, sizeof path, "%s/d.stl", folder);
  assert_int_equal(laves_defects_write(context, options.defects, path, &m.error), LAVES_ERROR_OPTION);
  assert_non_null(strstr(m.error.text, ".ply, .obj or .vtp"));
  assert_int_equal(fixture_folder_count(folder), 3);
  fixture_folder_remove(folder);
  laves_domain_free(m.domain);
  laves_defects_free(options.defects);
  assert_int_equal(laves_context_bytes(context), 0);
  shape_free(&s);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(parts_within_parts),
      cmocka_unit_test(hollows_of_parts_that_cross),
      cmocka_unit_test(where_two_overlap),
      cmocka_unit_test(caps_stand_where_the_level_is),
      cmocka_unit_test(holes_are_refused_on_request),
      cmocka_unit_test(options_are_checked),
      cmocka_unit_test(each_defect_has_a_place),
      cmocka_unit_test(refused_surfaces_have_places_too),
      cmocka_unit_test(places_are_written),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
