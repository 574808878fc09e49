/* What the user draws, as points and segments: on the surface, split where it meets creases, dropped where it runs along them. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "domain/feature_lines.h"
#include "fixtures/assert_close.h"
#include "fixtures/shapes.h"

typedef struct drawing {
  laves_context *context;
  laves_domain *domain;
  laves_features *drawn;
  laves__features features;
  laves__feature_lines lines;
  laves_error error;
} drawing;

/* Which side of the unit cube. */
static int32_t cube_side(const void *self, laves__vec3 foot, uint32_t hint) {
  const double *x = &foot.x;
  int best = 0;
  (void)hint;
  (void)self;
  for (int i = 1; i < 6; i++)
    if (fabs(x[i / 2] - i % 2) < fabs(x[best / 2] - best % 2)) best = i;
  return best;
}

static int32_t only_patch(const void *self, laves__vec3 foot, uint32_t hint) {
  (void)self;
  (void)foot;
  (void)hint;
  return 0;
}

static drawing begin(laves_context *context, laves_domain *domain, int32_t (*patch_at)(const void *, laves__vec3, uint32_t)) {
  drawing d = {.context = context, .domain = domain, .lines = {.context = context}};
  d.features = (laves__features){.context = context, .oracle = &domain->oracle, .patch_count = 6, .patch_at = patch_at};
  assert_int_equal(laves_features_create(context, &d.drawn, NULL), LAVES_OK);
  return d;
}

static drawing on_cube(void) {
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain;
  shape s = shape_box((const double[3]){0, 0, 0}, (const double[3]){1, 1, 1}, 3);
  assert_int_equal(
      laves_domain_from_triangles(context, s.points, s.point_count, s.triangles, s.triangle_count, NULL, &domain, NULL),
      LAVES_OK);
  shape_free(&s);
  return begin(context, domain, cube_side);
}

static drawing on_sphere(const char *text) {
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain;
  assert_int_equal(laves_domain_from_expression(context, text, &domain, NULL), LAVES_OK);
  return begin(context, domain, only_patch);
}

static laves_result draw(drawing *d) {
  const laves__feature_wish wish = {.drawn = d->drawn};
  const laves_result result = laves__features_drawn(&wish, &d->features, &d->lines, &d->error);
  if (result != LAVES_OK) print_message("%s\n", d->error.text);
  return result;
}

static void end(drawing *d) {
  laves__feature_lines_free(&d->lines);
  laves_features_free(d->drawn);
  laves_domain_free(d->domain);
  assert_int_equal(laves_context_bytes(d->context), 0);
  laves_context_free(d->context);
}

static void add_point(drawing *d, double x, double y, double z) {
  assert_int_equal(laves_features_add_points(d->drawn, (const double[3]){x, y, z}, 1, NULL), LAVES_OK);
}

#define ADD_LINE(d, ...)                                                                                                  \
  do {                                                                                                                    \
    const double numbers[] = {__VA_ARGS__};                                                                               \
    assert_int_equal(laves_features_add_line((d)->drawn, numbers, sizeof numbers / sizeof *numbers / 3, NULL), LAVES_OK); \
  } while (0)

/* The crease of the cube between (0, 0, 1) and (1, 0, 1), in `count` segments. */
static void add_crease(drawing *d, int count) {
  uint32_t from, to;
  const laves__vec3 origin = d->domain->oracle.origin;
  assert_true(laves__feature_lines_add_point(&d->lines, v3_sub(v3(0, 0, 1), origin), &from));
  for (int i = 1; i <= count; i++, from = to) {
    assert_true(laves__feature_lines_add_point(&d->lines, v3_sub(v3((double)i / count, 0, 1), origin), &to));
    const laves__feature_segment s = {{from, to}, {2, 5}, 90, false};
    assert_true(laves__feature_lines_add_segment(&d->lines, &s));
  }
}

/* The point of lines at a place, in input coordinates; UINT32_MAX: none. */
static uint32_t point_at(const drawing *d, double x, double y, double z, double tolerance) {
  const laves__vec3 p = v3_sub(v3(x, y, z), d->domain->oracle.origin);
  for (uint32_t i = 0; i < d->lines.point_count; i++)
    if (v3_distance(d->lines.point[i], p) <= tolerance) return i;
  return UINT32_MAX;
}

static const laves__feature_point *fixed_at(const drawing *d, uint32_t point) {
  for (size_t i = 0; i < d->lines.fixed_count; i++)
    if (d->lines.fixed[i].point == point) return &d->lines.fixed[i];
  return NULL;
}

static int degree_of(const drawing *d, uint32_t point, bool drawn) {
  int degree = 0;
  for (size_t i = 0; i < d->lines.segment_count; i++)
    for (int k = 0; k < 2; k++) degree += d->lines.segment[i].ends[k] == point && d->lines.segment[i].drawn == drawn;
  return degree;
}

static double length_of(const drawing *d, bool drawn) {
  double length = 0;
  for (size_t i = 0; i < d->lines.segment_count; i++) {
    const laves__feature_segment *s = &d->lines.segment[i];
    assert_true(s->ends[0] < d->lines.point_count && s->ends[1] < d->lines.point_count && s->ends[0] != s->ends[1]);
    if (s->drawn == drawn) length += v3_distance(d->lines.point[s->ends[0]], d->lines.point[s->ends[1]]);
  }
  return length;
}

/* ---- points ---- */

static void points_stay(void **state) {
  (void)state;
  drawing d = on_cube();
  add_point(&d, 0.25, 0.5, 1);
  add_point(&d, 0.75, 0.5, 1.001); /* goes to its foot */
  add_point(&d, 0.25, 0.5, 1);     /* a second time */
  assert_int_equal(draw(&d), LAVES_OK);
  assert_int_equal(d.lines.segment_count, 0);
  assert_int_equal(d.lines.fixed_count, 2);
  const uint32_t a = point_at(&d, 0.25, 0.5, 1, 0), b = point_at(&d, 0.75, 0.5, 1, 1e-12);
  assert_true(a != UINT32_MAX && b != UINT32_MAX);
  assert_int_equal(fixed_at(&d, a)->patch, 5);
  assert_int_equal(fixed_at(&d, b)->patch, 5);
  end(&d);
}

static void points_off_the_surface(void **state) {
  (void)state;
  drawing d = on_cube();
  add_point(&d, 0.25, 0.5, 1);
  add_point(&d, 0.25, 0.5, 1.01);
  assert_int_equal(draw(&d), LAVES_ERROR_INPUT);
  assert_non_null(strstr(d.error.text, "point 2 (counted from 1), at (0.25, 0.5, 1.01), is 0.01 off the surface"));
  end(&d);

  d = on_sphere("sphere(1)");
  ADD_LINE(&d, 1, 0, 0, 0, 1, 0);
  ADD_LINE(&d, 1, 0, 0, 0, 1.1, 0);
  assert_int_equal(draw(&d), LAVES_ERROR_INPUT);
  assert_non_null(strstr(d.error.text, "point 2 of line 2 (counted from 1), at (0, 1.1, 0), is 0.1 off the surface"));
  end(&d);

  d = on_sphere("sphere(1)");
  add_point(&d, 1e300, 0, 0);
  assert_int_equal(draw(&d), LAVES_ERROR_INPUT);
  assert_non_null(strstr(d.error.text, "is far off the surface"));
  end(&d);
}

static void point_on_a_crease(void **state) {
  (void)state;
  drawing d = on_cube();
  add_crease(&d, 3);
  add_point(&d, 0.1, 0, 1);            /* within a segment */
  add_point(&d, 1.0 / 3 + 1e-7, 0, 1); /* at a point of the crease, but for digits */
  add_point(&d, 0.5, 2e-5, 1);         /* near, and so on it, but at its own place */
  assert_int_equal(draw(&d), LAVES_OK);
  assert_int_equal(d.lines.point_count, 4 + 2);
  assert_int_equal(d.lines.segment_count, 3 + 2);
  assert_int_equal(d.lines.fixed_count, 3);
  for (size_t i = 0; i < 3; i++) assert_int_equal(d.lines.fixed[i].patch, LAVES__NO_FEATURE);
  const uint32_t a = point_at(&d, 0.1, 0, 1, 0), b = point_at(&d, 1.0 / 3, 0, 1, 1e-12), c = point_at(&d, 0.5, 2e-5, 1, 0);
  assert_true(fixed_at(&d, a) && fixed_at(&d, b) && fixed_at(&d, c));
  assert_int_equal(degree_of(&d, a, false), 2);
  assert_int_equal(degree_of(&d, b, false), 2);
  assert_int_equal(degree_of(&d, c, false), 2);
  assert_close(length_of(&d, false), 1, 1e-7);
  for (size_t i = 0; i < d.lines.segment_count; i++) {
    assert_int_equal(d.lines.segment[i].patch[0], 2);
    assert_int_equal(d.lines.segment[i].patch[1], 5);
  }
  end(&d);
}

/* ---- lines ---- */

static void line_on_a_side(void **state) {
  (void)state;
  drawing d = on_cube();
  ADD_LINE(&d, 0.25, 0.25, 1, 0.75, 0.25, 1, 0.75, 0.75, 1);
  assert_int_equal(draw(&d), LAVES_OK);
  assert_int_equal(d.lines.point_count, 3);
  assert_int_equal(d.lines.segment_count, 2);
  assert_int_equal(d.lines.fixed_count, 2);
  assert_true(fixed_at(&d, point_at(&d, 0.25, 0.25, 1, 0)) && fixed_at(&d, point_at(&d, 0.75, 0.75, 1, 0)));
  for (size_t i = 0; i < 2; i++) {
    const laves__feature_segment *s = &d.lines.segment[i];
    assert_true(s->drawn && s->patch[0] == 5 && s->patch[1] == 5 && s->angle == 180);
  }
  end(&d);
}

static void closed_line(void **state) {
  (void)state;
  drawing d = on_cube();
  ADD_LINE(&d, 0.25, 0.25, 1, 0.75, 0.25, 1, 0.5, 0.75, 1, 0.25, 0.25, 1);
  assert_int_equal(draw(&d), LAVES_OK);
  assert_int_equal(d.lines.point_count, 3);
  assert_int_equal(d.lines.segment_count, 3);
  assert_int_equal(d.lines.fixed_count, 0);
  for (uint32_t i = 0; i < 3; i++) assert_int_equal(degree_of(&d, i, true), 2);
  end(&d);
}

static void line_along_a_crease(void **state) {
  (void)state;
  drawing d = on_cube();
  add_crease(&d, 4);
  ADD_LINE(&d, 0.1, 0, 1, 0.9, 0, 1);
  assert_int_equal(draw(&d), LAVES_OK);
  assert_close(length_of(&d, true), 0, 1e-300);
  assert_close(length_of(&d, false), 1, 1e-12);
  assert_int_equal(d.lines.segment_count, 6); /* split at the ends of the line, nowhere else */
  assert_int_equal(d.lines.fixed_count, 2);
  end(&d);
}

static void line_leaves_a_crease(void **state) {
  (void)state;
  drawing d = on_cube();
  add_crease(&d, 4);
  ADD_LINE(&d, 0, 0, 1, 0.4, 0, 1, 0.6, 0.5, 1);
  assert_int_equal(draw(&d), LAVES_OK);
  assert_close(length_of(&d, true), sqrt(0.04 + 0.25), 1e-9);
  const uint32_t fork = point_at(&d, 0.4, 0, 1, 1e-12);
  assert_non_null(fixed_at(&d, fork));
  assert_int_equal(degree_of(&d, fork, false), 2);
  assert_int_equal(degree_of(&d, fork, true), 1);
  assert_int_equal(d.lines.fixed_count, 3);
  end(&d);
}

/* From side to side without a vertex on the crease between: the crossing is found and lies on the crease. */
static void line_over_a_crease(void **state) {
  (void)state;
  for (int count = 1; count <= 2; count++) { /* in the middle of a segment, and at a point of the crease */
    drawing d = on_cube();
    add_crease(&d, count);
    ADD_LINE(&d, 0.5, 0, 0.6, 0.5, 0.4, 1);
    assert_int_equal(draw(&d), LAVES_OK);
    const uint32_t corner = point_at(&d, 0.5, 0, 1, 1e-4);
    assert_true(corner != UINT32_MAX);
    assert_non_null(fixed_at(&d, corner));
    assert_int_equal(d.lines.fixed_count, 3);
    assert_int_equal(degree_of(&d, corner, false), 2);
    assert_int_equal(degree_of(&d, corner, true), 2);
    assert_close(d.lines.point[corner].y + d.domain->oracle.origin.y, 0, 1e-12);
    assert_close(d.lines.point[corner].z + d.domain->oracle.origin.z, 1, 1e-12);
    assert_close(length_of(&d, true), 0.8, 2e-4);
    assert_close(length_of(&d, false), 1, 1e-7);
    int ends = 0;
    for (size_t i = 0; i < d.lines.segment_count; i++) {
      const laves__feature_segment *s = &d.lines.segment[i];
      if (!s->drawn) continue;
      const laves__vec3 p = v3_add(v3_lerp(d.lines.point[s->ends[0]], d.lines.point[s->ends[1]], 0.5), d.domain->oracle.origin);
      if (p.y > 2e-4) assert_int_equal(s->patch[0], 5);
      if (p.z < 1 - 2e-4) assert_int_equal(s->patch[0], 2);
      if (degree_of(&d, s->ends[0], true) == 1) ends++;
      if (degree_of(&d, s->ends[1], true) == 1) ends++;
    }
    assert_int_equal(ends, 2);
    end(&d);
  }
}

static void lines_that_cross(void **state) {
  (void)state;
  drawing d = on_cube();
  ADD_LINE(&d, 0.1, 0.5, 1, 0.9, 0.5, 1);
  ADD_LINE(&d, 0.5, 0.1, 1, 0.5, 0.9, 1);
  ADD_LINE(&d, 0.3, 0.5, 1, 0.3, 0.2, 1); /* ends on the first */
  add_point(&d, 0.7, 0.5, 1);             /* on the first */
  assert_int_equal(draw(&d), LAVES_OK);
  const uint32_t cross = point_at(&d, 0.5, 0.5, 1, 1e-12), tee = point_at(&d, 0.3, 0.5, 1, 0), on = point_at(&d, 0.7, 0.5, 1, 0);
  assert_true(fixed_at(&d, cross) && fixed_at(&d, tee) && fixed_at(&d, on));
  assert_int_equal(degree_of(&d, cross, true), 4);
  assert_int_equal(degree_of(&d, tee, true), 3);
  assert_int_equal(degree_of(&d, on, true), 2);
  assert_int_equal(fixed_at(&d, on)->patch, LAVES__NO_FEATURE);
  assert_int_equal(d.lines.fixed_count, 4 + 1 + 2 + 1);
  assert_close(length_of(&d, true), 1.9, 1e-12);
  end(&d);
}

/* The same line twice, and backwards in other pieces: once is enough. */
static void lines_that_repeat(void **state) {
  (void)state;
  drawing d = on_cube();
  ADD_LINE(&d, 0.1, 0.5, 1, 0.9, 0.5, 1);
  ADD_LINE(&d, 0.9, 0.5, 1, 0.4, 0.5, 1, 0.1, 0.5, 1);
  assert_int_equal(draw(&d), LAVES_OK);
  assert_close(length_of(&d, true), 0.8, 1e-12);
  assert_int_equal(d.lines.fixed_count, 2);
  end(&d);
}

static void line_that_crosses_itself(void **state) {
  (void)state;
  drawing d = on_cube();
  ADD_LINE(&d, 0.2, 0.2, 1, 0.8, 0.8, 1, 0.8, 0.2, 1, 0.2, 0.8, 1);
  assert_int_equal(draw(&d), LAVES_OK);
  const uint32_t cross = point_at(&d, 0.5, 0.5, 1, 1e-12);
  assert_non_null(fixed_at(&d, cross));
  assert_int_equal(degree_of(&d, cross, true), 4);
  assert_int_equal(d.lines.fixed_count, 3);
  end(&d);
}

/* ---- curved ---- */

/* Far from the zero point too, where coordinates are local. */
static void line_on_a_sphere(void **state) {
  static const struct {
    const char *text;
    double x;
  } solids[] = {{"sphere(1)", 0}, {"sphere(1):move(100, 0, 0)", 100}};
  (void)state;
  for (int i = 0; i < 2; i++) {
    const double x = solids[i].x;
    drawing d = on_sphere(solids[i].text);
    ADD_LINE(&d, x + 1, 0, 0, x, 1, 0, x - 1, 0, 0);
    ADD_LINE(&d, x, sqrt(0.5), -sqrt(0.5), x, sqrt(0.5), sqrt(0.5));
    assert_int_equal(draw(&d), LAVES_OK);
    assert_close(length_of(&d, true), 3.14159265 + 1.57079633, 2e-4);
    for (size_t k = 0; k < d.lines.segment_count; k++) {
      const laves__feature_segment *s = &d.lines.segment[k];
      const laves__vec3 a = v3_sub(v3_add(d.lines.point[s->ends[0]], d.domain->oracle.origin), v3(x, 0, 0));
      const laves__vec3 b = v3_sub(v3_add(d.lines.point[s->ends[1]], d.domain->oracle.origin), v3(x, 0, 0));
      assert_close(v3_norm(a), 1, 1e-9);
      assert_true(v3_norm(v3_lerp(a, b, 0.5)) >= 1 - LAVES__DRAWN_FOLLOW * 2 * sqrt(3));
    }
    assert_true(d.lines.segment_count < 1000);
    const uint32_t cross = point_at(&d, x, 1, 0, 1e-4);
    assert_int_equal(degree_of(&d, cross, true), 4);
    assert_int_equal(d.lines.fixed_count, 5);
    end(&d);
  }
}

static void line_over_a_gap(void **state) {
  (void)state;
  drawing d = on_sphere("box(1) + box(1):move(1.1, 0, 0)");
  ADD_LINE(&d, 0.2, 0, 0.5, 0.9, 0, 0.5);
  assert_int_equal(draw(&d), LAVES_ERROR_INPUT);
  assert_non_null(strstr(d.error.text, "line 1 (counted from 1) leaves the surface near (0.5"));
  assert_non_null(strstr(d.error.text, "between its points 1 and 2"));
  end(&d);
}

/* Lines that are drawn in more or less detail mean the same; thousands of pieces take no time. */
static void many_lines(void **state) {
  enum { COUNT = 300, STEPS = 50 };
  (void)state;
  drawing d = on_sphere("sphere(1)");
  double points[STEPS + 1][3];
  for (int i = 0; i < COUNT; i++) { /* meridians between two circles of latitude, and those circles */
    const double east = 6.283185307179586 * i / COUNT;
    for (int k = 0; k <= STEPS; k++) {
      const double north = -0.5 + 1.0 * k / STEPS;
      points[k][0] = cos(north) * cos(east);
      points[k][1] = cos(north) * sin(east);
      points[k][2] = sin(north);
    }
    assert_int_equal(laves_features_add_line(d.drawn, points[0], STEPS + 1, NULL), LAVES_OK);
  }
  for (int side = -1; side <= 1; side++) {
    double circle[1001][3]; /* chords are no circles of latitude */
    for (int k = 0; k <= 1000; k++) {
      const double east = 6.283185307179586 * k / 1000 + 0.001;
      circle[k][0] = cos(0.5 * side) * cos(east);
      circle[k][1] = cos(0.5 * side) * sin(east);
      circle[k][2] = sin(0.5 * side);
    }
    assert_int_equal(laves_features_add_line(d.drawn, circle[0], 1001, NULL), LAVES_OK);
  }
  assert_int_equal(draw(&d), LAVES_OK);
  size_t tees = 0, crosses = 0;
  for (size_t i = 0; i < d.lines.fixed_count; i++) {
    const int degree = degree_of(&d, d.lines.fixed[i].point, true);
    tees += degree == 3;
    crosses += degree == 4;
  }
  assert_int_equal(tees, 2 * COUNT);
  assert_int_equal(crosses, COUNT);
  assert_int_equal(d.lines.fixed_count, 3 * COUNT);
  end(&d);
}

/* ---- lists ---- */

static void lists_are_checked(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_features *f;
  laves_error error;
  const double bad[] = {0, 0, 0, 0, NAN, 0}, good[] = {0, 0, 0, 1, 1, 1};
  assert_int_equal(laves_features_create(context, &f, &error), LAVES_OK);
  assert_int_equal(laves_features_add_points(f, bad, 2, &error), LAVES_ERROR_OPTION);
  assert_non_null(strstr(error.text, "point 1 of the points to keep is not finite"));
  assert_int_equal(laves_features_add_line(f, bad, 2, &error), LAVES_ERROR_OPTION);
  assert_int_equal(laves_features_add_line(f, good, 1, &error), LAVES_ERROR_OPTION);
  assert_int_equal(laves_features_add_points(f, good, SIZE_MAX / 64, &error), LAVES_ERROR_OPTION);
  assert_int_equal(f->point_count + f->vertex_count + f->line_count, 0);
  assert_int_equal(laves_features_add_points(f, good, 2, &error), LAVES_OK);
  assert_int_equal(laves_features_add_line(f, good, 2, &error), LAVES_OK);
  assert_int_equal(laves_features_add_line(f, good, 2, &error), LAVES_OK);
  assert_int_equal(f->point_count, 2);
  assert_int_equal(f->line_count, 2);
  assert_int_equal(f->line_end[1], 4);
  laves_features_free(f);
  laves_features_free(NULL);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(points_stay),
      cmocka_unit_test(points_off_the_surface),
      cmocka_unit_test(point_on_a_crease),
      cmocka_unit_test(line_on_a_side),
      cmocka_unit_test(closed_line),
      cmocka_unit_test(line_along_a_crease),
      cmocka_unit_test(line_leaves_a_crease),
      cmocka_unit_test(line_over_a_crease),
      cmocka_unit_test(lines_that_cross),
      cmocka_unit_test(lines_that_repeat),
      cmocka_unit_test(line_that_crosses_itself),
      cmocka_unit_test(line_on_a_sphere),
      cmocka_unit_test(line_over_a_gap),
      cmocka_unit_test(many_lines),
      cmocka_unit_test(lists_are_checked),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
