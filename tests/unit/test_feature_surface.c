/* Creases and corners of triangle surfaces: how many, where, of which angle, and what is noise. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "domain/features.h"
#include "fixtures/assert_close.h"
#include "fixtures/shapes.h"

static laves_context *context;

static int set_up(void **state) {
  (void)state;
  context = laves_context_create(NULL);
  return context ? 0 : -1;
}

static int tear_down(void **state) {
  (void)state;
  const size_t left = laves_context_bytes(context);
  laves_context_free(context);
  return left == 0 ? 0 : -1;
}

/* A domain and its features. Do not copy: they point into one another. */
typedef struct found {
  laves_domain *domain;
  laves__features features;
} found;

static void find(found *f, shape *s, const int32_t *tags, const laves__feature_wish *wish) {
  laves_error error = {0};
  if (laves_domain_from_triangles(context, s->points, s->point_count, s->triangles, s->triangle_count, tags, &f->domain,
                                  &error) != LAVES_OK)
    fail_msg("%s", error.text);
  assert_int_equal(laves__features_find(context, &f->domain->oracle, wish, &f->features, &error), LAVES_OK);
  shape_free(s);
}

static void let_go(found *f) {
  laves__features_free(&f->features);
  laves_domain_free(f->domain);
}

static const laves__feature_wish usual = {.angle = 40, .size = 0.1};

static void a_cube_has_twelve_creases_and_eight_corners(void **state) {
  (void)state;
  found f;
  shape s = shape_box((const double[]){-1, -1, -1}, (const double[]){1, 1, 1}, 3);
  find(&f, &s, NULL, &usual);
  assert_int_equal(f.features.crease_count, 12);
  assert_int_equal(f.features.corner_count, 8);
  assert_int_equal(f.features.patch_count, 6);
  for (size_t i = 0; i < f.features.crease_count; i++) {
    const laves__crease *c = &f.features.crease[i];
    assert_close(c->length, 2, 1e-12);
    assert_close(c->least_angle, 90, 1e-5);
    assert_close(c->most_angle, 90, 1e-5);
    assert_false(c->closed);
    assert_int_not_equal(c->patch[0], c->patch[1]);
  }
  for (size_t i = 0; i < f.features.corner_count; i++) {
    const laves__corner *c = &f.features.corner[i];
    assert_close(fabs(c->position.x) + fabs(c->position.y) + fabs(c->position.z), 3, 0);
    assert_int_equal(c->crease_count, 3);
    assert_int_equal(c->end_count, 3);
    assert_int_equal(c->patch_count, 3);
  }
  let_go(&f);
}

/* A step of 20 degrees is no crease at 40 degrees, so the rims have no corners. */
static void the_rims_of_a_cylinder_are_closed(void **state) {
  (void)state;
  found f;
  shape s = shape_cylinder(1, 2, 64);
  find(&f, &s, NULL, &usual);
  assert_int_equal(f.features.crease_count, 2);
  assert_int_equal(f.features.corner_count, 0);
  assert_int_equal(f.features.patch_count, 3);
  for (size_t i = 0; i < 2; i++) {
    assert_true(f.features.crease[i].closed);
    assert_int_equal(f.features.crease[i].count, 65);
    assert_int_equal(f.features.crease[i].corner[0], LAVES__NO_FEATURE);
    assert_int_equal(f.features.crease[i].corner[1], LAVES__NO_FEATURE);
  }
  let_go(&f);
}

/* With edges shorter than the strips each of the twelve kinks of a rim is a corner; with longer ones they stand for a circle. */
static void kinks_are_corners_where_the_mesh_can_follow_them(void **state) {
  (void)state;
  const struct {
    double size;
    size_t corners;
  } cases[] = {{0.1, 24}, {0.5, 0}};
  for (size_t i = 0; i < 2; i++) {
    found f;
    shape s = shape_cylinder(1, 2, 12);
    find(&f, &s, NULL, &(laves__feature_wish){.angle = 40, .size = cases[i].size});
    assert_int_equal(f.features.corner_count, cases[i].corners);
    let_go(&f);
  }
}

static void angles_are_those_inside_the_solid(void **state) {
  (void)state;
  found f;
  shape s = shape_ell();
  find(&f, &s, NULL, &usual);
  size_t notches = 0;
  for (size_t i = 0; i < f.features.crease_count; i++) {
    const double angle = f.features.crease[i].least_angle;
    if (angle > 180) {
      assert_close(angle, 270, 1e-5);
      notches++;
    } else {
      assert_close(angle, 90, 1e-5);
    }
  }
  assert_int_equal(notches, 1);
  assert_int_equal(f.features.crease_count, 18);
  let_go(&f);
}

static void wedges_have_their_angle(void **state) {
  (void)state;
  const double profile[3][2] = {{0, 0}, {2, 0}, {2, 2 * 0.57735026918962584}}; /* 30, 90 and 60 degrees */
  found f;
  shape s = shape_prism(profile, 3, 0, 1);
  find(&f, &s, NULL, &usual);
  double least = 360;
  for (size_t i = 0; i < f.features.crease_count; i++) least = fmin(least, f.features.crease[i].least_angle);
  assert_int_equal(f.features.crease_count, 9);
  assert_close(least, 30, 1e-4);
  let_go(&f);
}

static void the_angle_decides(void **state) {
  (void)state;
  const struct {
    double angle;
    size_t creases;
  } cases[] = {{40, 2}, {29, 14}, {91, 0}, {0, 0}};
  for (size_t i = 0; i < 4; i++) { /* strips of 30 degrees */
    found f;
    shape s = shape_cylinder(1, 2, 12);
    find(&f, &s, NULL, &(laves__feature_wish){.angle = cases[i].angle, .size = 0.5});
    size_t upright = 0, round = 0;
    for (size_t k = 0; k < f.features.crease_count; k++) *(f.features.crease[k].least_angle > 100 ? &upright : &round) += 1;
    assert_int_equal(cases[i].creases == 14 ? upright : f.features.crease_count, cases[i].creases == 14 ? 12 : cases[i].creases);
    let_go(&f);
  }
}

static void a_sphere_has_none(void **state) {
  (void)state;
  found f;
  shape s = shape_sphere(1, 6);
  find(&f, &s, NULL, &usual);
  assert_int_equal(f.features.crease_count, 0);
  assert_int_equal(f.features.corner_count, 0);
  let_go(&f);
}

/* A coarse ball: its edges turn by more than 40 degrees, but so do all beside them. Where faces are far larger than the size,
 * they are facets. */
static void coarse_triangles_of_a_curved_surface_are_a_bend(void **state) {
  (void)state;
  found f;
  shape s = shape_sphere(1, 1);
  find(&f, &s, NULL, &(laves__feature_wish){.angle = 40, .size = 0.8});
  assert_int_equal(f.features.crease_count, 0);
  let_go(&f);
  s = shape_sphere(1, 1);
  find(&f, &s, NULL, &(laves__feature_wish){.angle = 40, .size = 0.05});
  assert_int_equal(f.features.crease_count, 30);
  assert_int_equal(f.features.corner_count, 12);
  let_go(&f);
}

/* A cube with a dent of a tenth of the size in the middle of one side. */
static void what_is_smaller_than_the_size_is_dropped(void **state) {
  (void)state;
  found f;
  shape s = shape_box((const double[]){0, 0, 0}, (const double[]){1, 1, 1}, 40);
  for (size_t i = 0; i < s.point_count; i++) {
    double *p = s.points + 3 * i;
    if (p[2] == 1 && fabs(p[0] - 0.5) < 0.01 && fabs(p[1] - 0.5) < 0.01) p[2] = 0.97;
  }
  find(&f, &s, NULL, &(laves__feature_wish){.angle = 40, .size = 0.3});
  assert_int_equal(f.features.crease_count, 12);
  assert_true(f.features.dropped_count > 0 || f.features.corner_count == 8);
  assert_int_equal(f.features.corner_count, 8);
  let_go(&f);
}

static void tags_part_flat_faces_when_asked(void **state) {
  (void)state;
  for (int tags = 0; tags < 2; tags++) {
    found f;
    shape s = shape_box((const double[]){-1, -1, -1}, (const double[]){1, 1, 1}, 2);
    int32_t *tag = calloc(s.triangle_count, sizeof *tag);
    for (size_t t = 0; t < s.triangle_count; t++) { /* half of the top */
      double x = 0, z = 0;
      for (int k = 0; k < 3; k++) {
        x += s.points[3 * s.triangles[3 * t + (size_t)k]] / 3;
        z += s.points[3 * s.triangles[3 * t + (size_t)k] + 2] / 3;
      }
      tag[t] = z > 0.99 && x > 0;
    }
    find(&f, &s, tag, &(laves__feature_wish){.angle = 40, .tags = tags, .size = 0.1});
    free(tag);
    assert_int_equal(f.features.patch_count, tags ? 7 : 6);
    /* The line across the top, and the edges that its ends part. */
    assert_int_equal(f.features.crease_count, tags ? 15 : 12);
    size_t flat = 0;
    for (size_t i = 0; i < f.features.crease_count; i++) flat += f.features.crease[i].least_angle > 179;
    assert_int_equal(flat, tags ? 1 : 0);
    let_go(&f);
  }
}

/* A roof whose ridge fades away: along x from a sharp end to flat. The two sides are one face, split along the ridge. */
static void a_fading_crease_splits_its_patch(void **state) {
  (void)state;
  found f;
  shape s = shape_box((const double[]){0, -1, 0}, (const double[]){8, 1, 1}, 16);
  for (size_t i = 0; i < s.point_count; i++) {
    double *p = s.points + 3 * i;
    if (p[2] == 1) p[2] += (1 - fabs(p[1])) * fmax(0, 1.4 - 0.35 * p[0]);
  }
  find(&f, &s, NULL, &(laves__feature_wish){.angle = 40, .size = 0.2});
  const laves__crease *ridge = NULL;
  for (size_t i = 0; i < f.features.crease_count; i++) {
    const laves__vec3 middle = laves__crease_point_at(&f.features, (int32_t)i, 0, 0.5 * f.features.crease[i].length);
    if (fabs(middle.y) < 1e-9 && middle.z > 1.1) ridge = &f.features.crease[i];
  }
  assert_non_null(ridge);
  assert_true(ridge->length > 1.5 && ridge->length < 5);
  assert_true(ridge->patch[0] != ridge->patch[1]);
  assert_false(laves__patches_join(&f.features, ridge->patch[0], ridge->patch[1]));
  /* Both sides go with what lies beyond the end. */
  uint32_t hint = LAVES__NO_HINT;
  laves__vec3 foot, normal;
  assert_true(f.domain->oracle.project(f.domain->oracle.self, v3(7, 0.3, 1), 1, &hint, &foot, &normal));
  const int32_t beyond = f.features.patch_at(f.features.self, foot, hint);
  assert_true(laves__patches_join(&f.features, ridge->patch[0], beyond));
  assert_true(laves__patches_join(&f.features, ridge->patch[1], beyond));
  let_go(&f);
}

static void projections_stay_on_their_patch(void **state) {
  (void)state;
  found f;
  shape s = shape_box((const double[]){-1, -1, -1}, (const double[]){1, 1, 1}, 3);
  find(&f, &s, NULL, &usual);
  uint32_t hint = LAVES__NO_HINT;
  laves__vec3 foot, normal;
  assert_true(f.domain->oracle.project(f.domain->oracle.self, v3(0.2, 0.3, 1.1), 1, &hint, &foot, &normal));
  const int32_t top = f.features.patch_at(f.features.self, foot, hint);
  hint = LAVES__NO_HINT;
  /* Nearest is the side x = 1; on the top it is the edge. */
  assert_true(f.features.project_patch(f.features.self, top, v3(1.1, 0.3, 0.5), 1, &hint, &foot, &normal));
  assert_close(v3_distance(foot, v3(1, 0.3, 1)), 0, 1e-12);
  assert_close(normal.z, 1, 1e-12);
  hint = LAVES__NO_HINT;
  assert_false(f.features.project_patch(f.features.self, top, v3(0, 0, -1), 1, &hint, &foot, &normal));
  let_go(&f);
}

static void creases_answer_for_the_nearest_point(void **state) {
  (void)state;
  found f;
  shape s = shape_box((const double[]){-1, -1, -1}, (const double[]){1, 1, 1}, 3);
  find(&f, &s, NULL, &usual);
  laves__vec3 foot, tangent;
  const int32_t crease = laves__crease_near(&f.features, v3(1.2, 0.25, 1.1), 1, &foot, &tangent);
  assert_int_not_equal(crease, LAVES__NO_FEATURE);
  assert_close(v3_distance(foot, v3(1, 0.25, 1)), 0, 1e-12);
  assert_close(fabs(tangent.y), 1, 1e-12);
  assert_int_equal(laves__crease_near(&f.features, v3(0, 0, 0), 1, &foot, &tangent), LAVES__NO_FEATURE);
  const laves__vec3 half = laves__crease_point_at(&f.features, crease, 0, 1),
                    far = laves__crease_point_at(&f.features, crease, 1, 9);
  assert_close(v3_distance(half, v3(1, 0, 1)), 0, 1e-12);
  assert_true(v3_distance(far, f.features.line[f.features.crease[crease].first]) == 0);
  let_go(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_cube_has_twelve_creases_and_eight_corners),
      cmocka_unit_test(the_rims_of_a_cylinder_are_closed),
      cmocka_unit_test(kinks_are_corners_where_the_mesh_can_follow_them),
      cmocka_unit_test(angles_are_those_inside_the_solid),
      cmocka_unit_test(wedges_have_their_angle),
      cmocka_unit_test(the_angle_decides),
      cmocka_unit_test(a_sphere_has_none),
      cmocka_unit_test(coarse_triangles_of_a_curved_surface_are_a_bend),
      cmocka_unit_test(what_is_smaller_than_the_size_is_dropped),
      cmocka_unit_test(tags_part_flat_faces_when_asked),
      cmocka_unit_test(a_fading_crease_splits_its_patch),
      cmocka_unit_test(projections_stay_on_their_patch),
      cmocka_unit_test(creases_answer_for_the_nearest_point),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
