/* Closed surfaces of several parts: unions, cavities, parts inside out, faces that cross. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

#include "domain/oracle.h"
#include "fixtures/shapes.h"

static double uniform(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) * 0x1p-53;
}

static laves__vec3 random_point(uint64_t *state, laves__box3 b) {
  const double x = uniform(state), y = uniform(state), z = uniform(state);
  return v3(b.lower.x + x * (b.upper.x - b.lower.x), b.lower.y + y * (b.upper.y - b.lower.y),
            b.lower.z + z * (b.upper.z - b.lower.z));
}

static laves_domain *build(laves_context *context, const shape *s) {
  laves_domain *domain = NULL;
  laves_error error = {0};
  if (laves_domain_from_triangles(context, s->points, s->point_count, s->triangles, s->triangle_count, NULL, &domain, &error))
    fail_msg("%s", error.text);
  return domain;
}

static shape box_at(double x0, double y0, double z0, double x1, double y1, double z1) {
  const double lower[3] = {x0, y0, z0}, upper[3] = {x1, y1, z1};
  return shape_box(lower, upper, 2);
}

static double value_at(const laves_domain *domain, double x, double y, double z) {
  const double p[3] = {x, y, z};
  double phi;
  laves_domain_evaluate(domain, p, 1, &phi);
  return phi;
}

/* Two boxes that overlap in a corner; every sign, and the distance in and out of the concave edges. */
static void overlapping_boxes_are_their_union(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = box_at(0, 0, 0, 2, 2, 2), more = box_at(1.03, 1.07, 1.11, 3, 3, 3);
  shape_append(&s, &more);
  laves_domain *domain = build(context, &s);
  const laves_domain_info *info = &domain->info;
  assert_true(info->closed);
  assert_int_equal(info->component_count, 2);
  assert_true(info->defects[LAVES_DEFECT_CROSSING] > 0);
  const double both = 0.97 * 0.93 * 0.89, volume = 8 + 1.97 * 1.93 * 1.89 - both;
  assert_true(fabs(info->volume / volume - 1) < 0.02);
  uint64_t state = 1;
  for (int i = 0; i < 3000; i++) {
    const laves__vec3 p = random_point(&state, domain->oracle.bounds);
    const bool a = p.x < 2 && p.y < 2 && p.z<2, b = p.x> 1.03 && p.y > 1.07 && p.z > 1.11;
    assert_int_equal(value_at(domain, p.x, p.y, p.z) < 0, a || b);
  }
  /* A hidden corner of either box is inside, and far from the surface. */
  assert_true(value_at(domain, 1.03, 1.07, 1.11) < -0.85);
  assert_true(value_at(domain, 1.99, 1.99, 1.99) < -0.85);
  /* Inside beside the edge where the two meet, which is the nearest of the surface: x = 2, y = 1.07. */
  assert_true(fabs(value_at(domain, 1.9, 1.17, 1.6) + sqrt(0.02)) < 1e-6);
  laves_domain_free(domain);
  shape_free(&s);
  shape_free(&more);
  laves_context_free(context);
}

static void feet_lie_on_the_union(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = box_at(0, 0, 0, 2, 2, 2), more = box_at(1.03, 1.07, 1.11, 3, 3, 3);
  shape_append(&s, &more);
  laves_domain *domain = build(context, &s);
  const laves__oracle *o = &domain->oracle;
  uint64_t state = 2;
  for (int i = 0; i < 1000; i++) {
    const laves__vec3 p = random_point(&state, o->bounds);
    laves__vec3 foot, normal;
    uint32_t hint = (uint32_t)(uniform(&state) * 96);
    double phi;
    assert_true(o->project(o->self, p, INFINITY, &hint, &foot, &normal));
    o->evaluate(o->self, 1, &p, &phi, NULL);
    assert_true(fabs(v3_distance(p, foot) - fabs(phi)) < 1e-12);
    const bool in_a =
        foot.x < 2 - 1e-3 && foot.y < 2 - 1e-3 && foot.z < 2 - 1e-3 && foot.x > 1e-3 && foot.y > 1e-3 && foot.z > 1e-3;
    const bool in_b = foot.x > 1.031 && foot.y > 1.071 && foot.z > 1.111 && foot.x < 2.999 && foot.y < 2.999 && foot.z < 2.999;
    assert_false(in_a || in_b);
  }
  laves_domain_free(domain);
  shape_free(&s);
  shape_free(&more);
  laves_context_free(context);
}

static void nested_parts_and_cavities(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape outer = shape_sphere(2, 6), inner = shape_sphere(1, 4);
  shape twice = shape_sphere(2, 6);
  shape_append(&twice, &inner);
  laves_domain *domain = build(context, &twice); /* a ball in a ball: nothing but the outer one */
  assert_true(fabs(value_at(domain, 0, 0, 0) + 2) < 0.1);
  assert_true(fabs(value_at(domain, 1, 0, 0) + 1) < 0.1);
  assert_int_equal(domain->info.triangle_count, outer.triangle_count);
  laves_domain_free(domain);
  shape_turn_over(&inner);
  shape_append(&outer, &inner);
  domain = build(context, &outer); /* a hollow ball */
  assert_true(fabs(value_at(domain, 0, 0, 0) - 1) < 0.1);
  assert_true(fabs(value_at(domain, 1.5, 0, 0) + 0.5) < 0.1);
  assert_false(domain->info.turned);
  laves_domain_free(domain);
  shape_turn_over(&outer);
  domain = build(context, &outer); /* all of it inside out */
  assert_true(fabs(value_at(domain, 0, 0, 0) - 1) < 0.1);
  assert_true(fabs(value_at(domain, 1.5, 0, 0) + 0.5) < 0.1);
  assert_true(domain->info.turned);
  laves_domain_free(domain);
  shape_free(&outer);
  shape_free(&inner);
  shape_free(&twice);
  laves_context_free(context);
}

/* One of two separate balls inside out: both are solid. */
static void a_part_inside_out_is_turned(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = shape_sphere(2, 5), more = shape_sphere(1, 4);
  shape_move(&more, 5, 0, 0);
  shape_turn_over(&more);
  shape_append(&s, &more);
  laves_domain *domain = build(context, &s);
  assert_true(domain->info.turned);
  assert_true(value_at(domain, 0, 0, 0) < -1.8);
  assert_true(value_at(domain, 5, 0, 0) < -0.9);
  assert_true(value_at(domain, 3, 0, 0) > 0.9);
  assert_true(domain->info.volume > 30);
  laves_domain_free(domain);
  shape_free(&s);
  shape_free(&more);
  laves_context_free(context);
}

/* Two boxes that share an edge only: four faces at it. */
static void boxes_that_share_an_edge(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = box_at(0, 0, 0, 1, 1, 1), more = box_at(1, 1, 0, 2, 2, 1);
  shape_append(&s, &more);
  laves_domain *domain = build(context, &s);
  assert_int_equal(domain->info.defects[LAVES_DEFECT_NONMANIFOLD_EDGE], 2);
  assert_true(domain->info.closed);
  assert_true(fabs(domain->info.volume - 2) < 1e-12);
  assert_true(value_at(domain, 0.98, 0.97, 0.5) < 0 && value_at(domain, 1.02, 1.03, 0.5) < 0);
  assert_true(value_at(domain, 0.98, 1.03, 0.5) > 0 && value_at(domain, 1.03, 0.98, 0.5) > 0);
  laves_domain_free(domain);
  shape_free(&s);
  shape_free(&more);
  laves_context_free(context);
}

static void samples_lie_on_the_surface(void **unused) {
  (void)unused;
  enum { CAPACITY = 4000 };
  laves_context *context = laves_context_create(NULL);
  shape s = box_at(0, 0, 0, 2, 2, 2), more = box_at(1.03, 1.07, 1.11, 3, 3, 3);
  shape_append(&s, &more);
  laves_domain *domain = build(context, &s);
  const laves__oracle *o = &domain->oracle;
  static laves__vec3 points[CAPACITY], again[CAPACITY];
  const size_t count = o->sample(o->self, 0.2, points, CAPACITY);
  assert_true(count > 800 && count < 1300); /* the area is 24 + 22.4 - 5.2 */
  for (size_t i = 0; i < count; i++) assert_true(fabs(value_at(domain, points[i].x, points[i].y, points[i].z)) < 1e-9);
  assert_int_equal(o->sample(o->self, 0.2, again, CAPACITY), count);
  assert_memory_equal(points, again, count * sizeof *points);
  assert_true(o->sample(o->self, 1e-6, points, 100) <= 100);
  laves_domain_free(domain);
  shape_free(&s);
  shape_free(&more);
  laves_context_free(context);
}

/* None are told apart from those that could not be looked for: see laves.h. */
static void no_thin_places(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain = NULL;
  laves_thin_place place = {.thickness = 3};
  assert_int_equal(laves_domain_from_expression(context, "sphere(1)", &domain, NULL), LAVES_OK);
  assert_int_equal(laves_domain_thin_places(domain, &place, 1), 0);
  assert_true(isinf(place.thickness));
  assert_int_equal(laves_domain_gap_places(domain, NULL, 0), 0);
  laves_domain_free(domain);
  laves_context_free(context);
}

static void thin_places_of_a_plate(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = box_at(0, 0, 0, 10, 8, 0.25);
  laves_domain *domain = build(context, &s);
  laves_thin_place places[20];
  const size_t count = laves_domain_thin_places(domain, places, 20);
  assert_int_equal(count, 20);
  for (size_t i = 0; i < count; i++) {
    assert_true(fabs(places[i].thickness - 0.25) < 1e-12);
    assert_true(fabs(places[i].place[2] - 0.125) < 1e-12);
    for (size_t j = 0; j < i; j++)
      assert_true(hypot(places[i].place[0] - places[j].place[0], places[i].place[1] - places[j].place[1]) >= 0.5 - 1e-9);
  }
  laves_domain_free(domain);
  shape_free(&s);
  laves_context_free(context);
}

/* Boxes with faces in common planes, some of them the same faces: the union's volume to rounding, and each sign off the planes.
 */
static void boxes_in_common_planes(void **unused) {
  (void)unused;
  static const struct {
    double lower[3], upper[3], volume;
  } rows[] = {
      {{1, 0, 0}, {3, 2, 2}, 12},           /* half over, four faces in common planes */
      {{0.5, 0, 0}, {1.5, 2, 2}, 8},        /* within, as far as its ends */
      {{0.5, 0.5, 0.5}, {1.5, 1.5, 2}, 8},  /* within, and a face upon a face */
      {{0.5, 0.5, 1}, {1.5, 1.5, 3}, 9},    /* through a face */
      {{2, 0, 0}, {4, 2, 2}, 16},           /* side by side */
      {{2, 0.5, 0.5}, {4, 1.5, 1.5}, 10},   /* side by side, a small face on a large one */
      {{0.25, 0, 0}, {2, 2, 1.75}, 8},      /* a corner in common */
      {{-0.5, -0.5, 0}, {2.5, 2.5, 2}, 18}, /* around, as high */
  };
  laves_context *context = laves_context_create(NULL);
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    shape s = box_at(0, 0, 0, 2, 2, 2), more = shape_box(rows[i].lower, rows[i].upper, 3);
    shape_append(&s, &more);
    laves_domain *domain = build(context, &s);
    if (!(fabs(domain->info.volume / rows[i].volume - 1) < 1e-6)) fail_msg("row %zu: volume %.9g", i, domain->info.volume);
    uint64_t state = 5 + i;
    for (int k = 0; k < 2000; k++) {
      const laves__vec3 p = random_point(&state, (laves__box3){v3(-1, -1, -1), v3(5, 4, 4)});
      const double at[3] = {p.x, p.y, p.z};
      bool in_first = true, in_second = true;
      for (int axis = 0; axis < 3; axis++) {
        in_first = in_first && at[axis] > 0 && at[axis] < 2;
        in_second = in_second && at[axis] > rows[i].lower[axis] && at[axis] < rows[i].upper[axis];
      }
      const double value = value_at(domain, p.x, p.y, p.z);
      if ((value < 0) != (in_first || in_second)) fail_msg("row %zu: %.9g at %g %g %g", i, value, p.x, p.y, p.z);
    }
    laves_domain_free(domain);
    shape_free(&s);
    shape_free(&more);
  }
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(overlapping_boxes_are_their_union),
      cmocka_unit_test(boxes_in_common_planes),
      cmocka_unit_test(feet_lie_on_the_union),
      cmocka_unit_test(nested_parts_and_cavities),
      cmocka_unit_test(a_part_inside_out_is_turned),
      cmocka_unit_test(boxes_that_share_an_edge),
      cmocka_unit_test(samples_lie_on_the_surface),
      cmocka_unit_test(no_thin_places),
      cmocka_unit_test(thin_places_of_a_plate),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
