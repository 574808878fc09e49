/* The oracle of triangle surfaces: sign and distance against brute force, projection, hints, frames. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "domain/oracle.h"
#include "fixtures/shapes.h"

static double uniform(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) * 0x1p-53;
}

static laves__vec3 random_point(uint64_t *state, laves__box3 b, double room) {
  const double r = room * box3_diagonal(b), x = uniform(state), y = uniform(state), z = uniform(state);
  return v3(b.lower.x - r + x * (b.upper.x - b.lower.x + 2 * r), b.lower.y - r + y * (b.upper.y - b.lower.y + 2 * r),
            b.lower.z - r + z * (b.upper.z - b.lower.z + 2 * r));
}

static laves_domain *build(laves_context *context, const shape *s) {
  laves_domain *domain = NULL;
  laves_error error = {0};
  const laves_result result =
      laves_domain_from_triangles(context, s->points, s->point_count, s->triangles, s->triangle_count, NULL, &domain, &error);
  if (result != LAVES_OK) fail_msg("%s", error.text);
  return domain;
}

/* ---- brute force, by other formulas than those under test ---- */

static laves__vec3 corner(const shape *s, size_t triangle, int i) {
  const double *p = s->points + 3 * s->triangles[3 * triangle + (size_t)i];
  return v3(p[0], p[1], p[2]);
}

static double segment_distance(laves__vec3 a, laves__vec3 b, laves__vec3 p) {
  const laves__vec3 ab = v3_sub(b, a);
  if (v3_dot(v3_sub(p, a), ab) <= 0) return v3_distance(p, a);
  if (v3_dot(v3_sub(p, b), ab) >= 0) return v3_distance(p, b);
  return v3_norm(v3_cross(v3_sub(p, a), ab)) / v3_norm(ab);
}

static double plane_distance(laves__vec3 a, laves__vec3 b, laves__vec3 c, laves__vec3 p) {
  const laves__vec3 n = v3_unit(v3_cross(v3_sub(b, a), v3_sub(c, a)));
  const double height = v3_dot(v3_sub(p, a), n);
  const laves__vec3 q = v3_mad(p, n, -height);
  const bool inside = v3_dot(n, v3_cross(v3_sub(b, a), v3_sub(q, a))) >= 0 &&
                      v3_dot(n, v3_cross(v3_sub(c, b), v3_sub(q, b))) >= 0 &&
                      v3_dot(n, v3_cross(v3_sub(a, c), v3_sub(q, c))) >= 0;
  return inside ? fabs(height) : INFINITY;
}

static double brute_distance(const shape *s, laves__vec3 p) {
  double least = INFINITY;
  for (size_t t = 0; t < s->triangle_count; t++) {
    const laves__vec3 a = corner(s, t, 0), b = corner(s, t, 1), c = corner(s, t, 2);
    least = fmin(least, plane_distance(a, b, c, p));
    least = fmin(least, fmin(segment_distance(a, b, p), fmin(segment_distance(b, c, p), segment_distance(c, a, p))));
  }
  return least;
}

static double brute_winding(const shape *s, laves__vec3 p) {
  double sum = 0;
  for (size_t t = 0; t < s->triangle_count; t++) {
    const laves__vec3 a = v3_sub(corner(s, t, 0), p), b = v3_sub(corner(s, t, 1), p), c = v3_sub(corner(s, t, 2), p);
    const double la = v3_norm(a), lb = v3_norm(b), lc = v3_norm(c);
    sum += 2 * atan2(v3_dot(a, v3_cross(b, c)), la * lb * lc + v3_dot(a, b) * lc + v3_dot(b, c) * la + v3_dot(c, a) * lb);
  }
  return sum / (4 * 3.141592653589793);
}

static void check_against_brute_force(const shape *s, int count) {
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain = build(context, s);
  const laves__oracle *o = &domain->oracle;
  uint64_t state = 7;
  for (int i = 0; i < count; i++) {
    const laves__vec3 p = random_point(&state, o->bounds, 0.1);
    const laves__vec3 q = v3_add(p, o->origin);
    double phi;
    o->evaluate(o->self, 1, &p, &phi, NULL);
    const double distance = brute_distance(s, q);
    assert_true(fabs(fabs(phi) - distance) <= 1e-8 * box3_diagonal(o->bounds));
    if (distance > 1e-9) assert_int_equal(phi<0, brute_winding(s, q)> 0.5);
  }
  laves_domain_free(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void matches_brute_force(void **unused) {
  (void)unused;
  const double lower[3] = {-1, -0.5, -0.25}, upper[3] = {1, 0.5, 0.25};
  shape shapes[] = {shape_sphere(1, 4), shape_torus(1, 0.4, 20, 12), shape_box(lower, upper, 1), shape_box(lower, upper, 4),
                    shape_ell()};
  for (size_t i = 0; i < LAVES__COUNT_OF(shapes); i++) {
    check_against_brute_force(&shapes[i], 200);
    shape_free(&shapes[i]);
  }
}

/* Points whose nearest feature is an edge or a corner, convex and concave, where a single face's normal would err. */
static void sign_at_edges_and_corners(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = shape_ell();
  laves_domain *domain = build(context, &s);
  static const struct {
    double p[3], phi;
  } cases[] = {
      {{-0.3, -0.4, 0.5}, 0.5},  /* convex edge */
      {{-0.1, -0.2, -0.2}, 0.3}, /* convex corner */
      {{0.7, 0.6, 0.5}, -0.5},   /* inside, nearest to the concave edge, which equals cap and base here */
      {{1.1, 1.2, 0.5}, 0.1},    /* in the notch */
      {{0.97, 0.96, 0.5}, -0.05}, {{0.97, 0.96, 1.3}, 0.3}, /* above the concave corner */
      {{2.3, -0.4, 0.25}, 0.5},   {{1.5, 2.5, 0.5}, 0.70710678118654757},
  };
  for (size_t i = 0; i < LAVES__COUNT_OF(cases); i++) {
    double phi;
    laves_domain_evaluate(domain, cases[i].p, 1, &phi);
    if (fabs(phi - cases[i].phi) > 1e-12) fail_msg("case %zu: %.17g instead of %.17g", i, phi, cases[i].phi);
  }
  laves_domain_free(domain);
  shape_free(&s);
  laves_context_free(context);
}

/* A hint, good or bad, and the points evaluated before change no bit of any answer. */
static void hints_never_change_answers(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = shape_torus(1, 0.4, 40, 24);
  laves_domain *domain = build(context, &s);
  const laves__oracle *o = &domain->oracle;
  enum { COUNT = 500 };
  laves__vec3 points[COUNT];
  double together[COUNT];
  uint32_t hints[COUNT] = {LAVES__NO_HINT}; /* the first is where to begin */
  uint64_t state = 3;
  for (int i = 0; i < COUNT; i++) points[i] = random_point(&state, o->bounds, 0.2);
  /* Points on the grid of the surface itself, where many triangles are equally near. */
  for (int i = 0; i < COUNT; i += 5) points[i] = v3(s.points[3 * i], s.points[3 * i + 1], s.points[3 * i + 2]);
  for (int i = 1; i < COUNT; i += 5) points[i] = v3(0, 0, 0.01 * i);
  o->evaluate(o->self, COUNT, points, together, hints);
  for (int i = 0; i < COUNT; i++) {
    double alone;
    uint32_t cold = LAVES__NO_HINT, bad = (uint32_t)(uniform(&state) * (double)s.triangle_count), own = hints[i];
    o->evaluate(o->self, 1, &points[i], &alone, NULL);
    assert_memory_equal(&alone, &together[i], sizeof alone);
    laves__vec3 feet[3], normals[3];
    assert_true(o->project(o->self, points[i], INFINITY, &cold, &feet[0], &normals[0]));
    assert_true(o->project(o->self, points[i], INFINITY, &bad, &feet[1], &normals[1]));
    assert_true(o->project(o->self, points[i], INFINITY, &own, &feet[2], &normals[2]));
    assert_int_equal(cold, bad);
    assert_int_equal(cold, own);
    assert_int_equal(cold, hints[i]);
    for (int k = 1; k < 3; k++) {
      assert_memory_equal(&feet[0], &feet[k], sizeof feet[0]);
      assert_memory_equal(&normals[0], &normals[k], sizeof normals[0]);
    }
    assert_true(fabs(v3_distance(points[i], feet[0]) - fabs(alone)) <= 1e-14);
    assert_true(fabs(v3_norm(normals[0]) - 1) < 1e-12);
  }
  laves_domain_free(domain);
  shape_free(&s);
  laves_context_free(context);
}

static void projects_within_reach_only(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = shape_sphere(1, 8);
  laves_domain *domain = build(context, &s);
  const laves__oracle *o = &domain->oracle;
  laves__vec3 foot, normal;
  uint32_t hint = LAVES__NO_HINT;
  assert_false(o->project(o->self, v3(2, 0, 0), 0.9, &hint, &foot, &normal));
  hint = LAVES__NO_HINT;
  assert_true(o->project(o->self, v3(2, 0, 0), 1.1, &hint, &foot, &normal));
  assert_true(fabs(foot.x - 1) < 0.02 && normal.x > 0.97);
  hint = LAVES__NO_HINT;
  assert_true(o->project(o->self, v3(0.5, 0, 0), 1.1, &hint, &foot, &normal));
  assert_true(normal.x > 0.97); /* outwards from inside, too */
  laves_domain_free(domain);
  shape_free(&s);
  laves_context_free(context);
}

static void sides_are_certain(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = shape_torus(1, 0.4, 40, 24);
  laves_domain *domain = build(context, &s);
  const laves__oracle *o = &domain->oracle;
  uint64_t state = 11;
  int decided = 0;
  for (int i = 0; i < 2000; i++) {
    const laves__vec3 c = random_point(&state, o->bounds, 0.3);
    const double radius = 0.3 * uniform(&state), h = radius / sqrt(3);
    const laves__side side = o->side(o->self, c, radius, v3(h, h, h));
    if (side == LAVES__UNDECIDED) continue;
    decided++;
    for (int k = 0; k < 8; k++) {
      const laves__vec3 p = v3_add(c, v3(k & 1 ? h : -h, k & 2 ? h : -h, k & 4 ? h : -h));
      double phi;
      o->evaluate(o->self, 1, &p, &phi, NULL);
      assert_int_equal(phi < 0, side == LAVES__INSIDE);
    }
  }
  assert_true(decided > 500);
  laves_domain_free(domain);
  shape_free(&s);
  laves_context_free(context);
}

/* Moved a million away, or scaled to a millionth of a millionth: the same values. */
static void frames_do_not_matter(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  static const struct {
    double move[3], scale;
  } frames[] = {{{1e6, -2e6, 3e6}, 1}, {{0, 0, 0}, 1e-12}, {{0, 0, 0}, 1e12}, {{7, 0, 0}, 1}};
  for (size_t k = 0; k < LAVES__COUNT_OF(frames); k++) {
    shape plain = shape_torus(1, 0.4, 32, 16);
    /* On a grid that a move by millions keeps exactly. */
    for (size_t i = 0; i < 3 * plain.point_count; i++) plain.points[i] = round(plain.points[i] * 0x1p20) * 0x1p-20;
    shape moved = {0};
    shape_append(&moved, &plain);
    shape_scale(&moved, frames[k].scale);
    shape_move(&moved, frames[k].move[0], frames[k].move[1], frames[k].move[2]);
    laves_domain *a = build(context, &plain), *b = build(context, &moved);
    assert_true(fabs(b->info.volume / (a->info.volume * pow(frames[k].scale, 3)) - 1) < 1e-12);
    uint64_t state = 5;
    for (int i = 0; i < 300; i++) {
      laves__vec3 p = random_point(&state, a->oracle.bounds, 0.2);
      p = v3(round(p.x * 0x1p20) * 0x1p-20, round(p.y * 0x1p20) * 0x1p-20, round(p.z * 0x1p20) * 0x1p-20);
      const laves__vec3 q = v3_add(v3_scale(p, frames[k].scale), v3(frames[k].move[0], frames[k].move[1], frames[k].move[2]));
      double phi_a, phi_b;
      laves_domain_evaluate(a, &p.x, 1, &phi_a);
      laves_domain_evaluate(b, &q.x, 1, &phi_b);
      assert_true(fabs(phi_b / frames[k].scale - phi_a) <= 1e-12);
    }
    laves_domain_free(a);
    laves_domain_free(b);
    shape_free(&plain);
    shape_free(&moved);
  }
  laves_context_free(context);
}

/* So far away that squares of distances overflow there is still an outside. */
static void far_points_are_outside(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = shape_sphere(1, 3);
  laves_domain *domain = build(context, &s);
  const double points[9] = {1e30, 0, 0, 0, -1e100, 0, 1e200, 1e200, 1e200};
  double phi[3];
  laves_domain_evaluate(domain, points, 3, phi);
  assert_true(fabs(phi[0] / 1e30 - 1) < 1e-9 && fabs(phi[1] / 1e100 - 1) < 1e-9 && phi[2] > 1e150);
  laves_domain_free(domain);
  shape_free(&s);
  laves_context_free(context);
}

static void inside_out_is_turned(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = shape_sphere(1, 6);
  laves_domain *domain = build(context, &s);
  assert_false(domain->info.turned);
  laves_domain_free(domain);
  shape_turn_over(&s);
  domain = build(context, &s);
  assert_true(domain->info.turned);
  assert_true(domain->info.closed);
  assert_true(domain->info.volume > 4);
  const double points[6] = {0, 0, 0, 2, 0, 0};
  double phi[2];
  laves_domain_evaluate(domain, points, 2, phi);
  assert_true(phi[0] < -0.9 && phi[1] > 0.9);
  laves_domain_free(domain);
  shape_free(&s);
  laves_context_free(context);
}

static void counts_facts(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  const double lower[3] = {0, 0, 0}, upper[3] = {1, 2, 3};
  shape s = shape_box(lower, upper, 2);
  laves_domain *domain = build(context, &s);
  laves_domain_info info;
  laves_domain_get_info(domain, &info);
  assert_int_equal(info.kind, LAVES_DOMAIN_SURFACE);
  assert_true(fabs(info.volume - 6) < 1e-14 && fabs(info.area - 22) < 1e-13);
  assert_int_equal(info.point_count, 26);
  assert_int_equal(info.triangle_count, 48);
  assert_int_equal(info.component_count, 1);
  assert_true(info.closed && !info.turned && !info.winding);
  for (int d = 0; d < LAVES_DEFECT_COUNT; d++) assert_int_equal(info.defects[d], 0);
  assert_true(info.lower[2] == 0 && info.upper[2] == 3);
  laves_domain_free(domain);
  shape_free(&s);
  laves_context_free(context);
}

static void refuses_what_is_no_surface(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain;
  laves_error error;
  const double points[9] = {0, 0, 0, 1, 0, 0, 0, NAN, 0};
  const uint32_t face[3] = {0, 1, 2}, beyond[3] = {0, 1, 7}, flat[3] = {0, 1, 0};
  assert_int_equal(laves_domain_from_triangles(context, points, 3, face, 1, NULL, &domain, &error), LAVES_ERROR_INPUT);
  assert_string_equal(error.text, "point 2 is not finite");
  assert_int_equal(laves_domain_from_triangles(context, points, 2, beyond, 1, NULL, &domain, &error), LAVES_ERROR_INPUT);
  assert_string_equal(error.text, "face 0 uses vertex 7 of 2");
  assert_int_equal(laves_domain_from_triangles(context, points, 2, flat, 1, NULL, &domain, &error), LAVES_ERROR_INPUT);
  assert_int_equal(laves_domain_from_triangles(context, points, 0, face, 0, NULL, &domain, &error), LAVES_ERROR_INPUT);
  assert_null(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(matches_brute_force),        cmocka_unit_test(sign_at_edges_and_corners),
      cmocka_unit_test(hints_never_change_answers), cmocka_unit_test(projects_within_reach_only),
      cmocka_unit_test(sides_are_certain),          cmocka_unit_test(frames_do_not_matter),
      cmocka_unit_test(inside_out_is_turned),       cmocka_unit_test(counts_facts),
      cmocka_unit_test(far_points_are_outside),     cmocka_unit_test(refuses_what_is_no_surface),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
