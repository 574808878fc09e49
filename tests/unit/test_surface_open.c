/* Surfaces that are not closed: holes, cracks, faces turned over, repeats; sheets and soups. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

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

static double value_at(const laves_domain *domain, double x, double y, double z) {
  const double p[3] = {x, y, z};
  double phi;
  laves_domain_evaluate(domain, p, 1, &phi);
  return phi;
}

/* Leaves the triangles all of whose corners have z >= least. */
static void cut_below(shape *s, double least) {
  size_t kept = 0;
  for (size_t t = 0; t < s->triangle_count; t++) {
    const uint32_t *c = s->triangles + 3 * t;
    if (s->points[3 * c[0] + 2] < least || s->points[3 * c[1] + 2] < least || s->points[3 * c[2] + 2] < least) continue;
    memmove(s->triangles + 3 * kept++, c, 3 * sizeof *c);
  }
  s->triangle_count = kept;
}

/* Every triangle gets points of its own. */
static shape torn(const shape *s) {
  shape t = {.points = calloc(9 * s->triangle_count, sizeof(double)),
             .triangles = calloc(3 * s->triangle_count, sizeof(uint32_t)),
             .point_count = 3 * s->triangle_count,
             .triangle_count = s->triangle_count};
  assert_non_null(t.points);
  assert_non_null(t.triangles);
  for (size_t i = 0; i < 3 * s->triangle_count; i++) {
    memcpy(t.points + 3 * i, s->points + 3 * s->triangles[i], 3 * sizeof(double));
    t.triangles[i] = (uint32_t)i;
  }
  return t;
}

/* A ball without its bottom, like a scan that stood on a table. */
static void a_hole_is_closed(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = shape_sphere(1, 10);
  cut_below(&s, -0.8);
  laves_domain *domain = build(context, &s);
  assert_true(domain->info.winding);
  assert_false(domain->info.closed);
  assert_false(domain->oracle.is_distance);
  assert_true(domain->info.defects[LAVES_DEFECT_OPEN_EDGE] > 10);
  assert_true(isnan(domain->info.volume));
  assert_true(value_at(domain, 0, 0, 0) < -0.5);
  assert_true(value_at(domain, 0, 0, 0.97) < 0 && value_at(domain, 0, 0, 1.03) > 0);
  assert_true(value_at(domain, 0, 0, -0.6) < 0 && value_at(domain, 0, 0, -1.1) > 0);
  assert_true(fabs(value_at(domain, 0, 0, 1.5) - 0.5) < 0.01);
  laves_domain_free(domain);
  shape_free(&s);
  laves_context_free(context);
}

/* On triangles and caps alike a foot has the inside behind it and the outside before it. */
static void feet_part_in_from_out(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = shape_sphere(1, 10);
  cut_below(&s, -0.7);
  laves_domain *domain = build(context, &s);
  const laves__oracle *o = &domain->oracle;
  uint64_t state = 1;
  int on_caps = 0;
  for (int i = 0; i < 500; i++) {
    laves__vec3 p = random_point(&state, o->bounds), foot, normal;
    if (i % 2) p = v3(0.6 * p.x, 0.6 * p.y, -0.7 + 0.2 * p.z);
    uint32_t hint = LAVES__NO_HINT;
    if (!o->project(o->self, p, INFINITY, &hint, &foot, &normal)) fail();
    const double radius = v3_norm(foot), rim = hypot(hypot(foot.x, foot.y) - 0.72, foot.z + 0.69);
    if (rim < 0.1) continue; /* where the cap begins at the rim it has no tangent to speak of */
    const laves__vec3 before = v3_mad(foot, normal, 1e-6), behind = v3_mad(foot, normal, -1e-6);
    if (fabs(radius - 1) > 0.02) {
      on_caps++;
      assert_true(fabs(value_at(domain, foot.x, foot.y, foot.z)) < 2e-3);
    }
    assert_true(value_at(domain, before.x, before.y, before.z) > 0);
    assert_true(value_at(domain, behind.x, behind.y, behind.z) < 0);
  }
  assert_true(on_caps > 50);
  laves_domain_free(domain);
  shape_free(&s);
  laves_context_free(context);
}

static void sides_stay_certain(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape s = shape_sphere(1, 10);
  cut_below(&s, -0.5);
  laves_domain *domain = build(context, &s);
  const laves__oracle *o = &domain->oracle;
  uint64_t state = 4;
  int decided = 0;
  for (int i = 0; i < 3000; i++) {
    const laves__vec3 c = v3_scale(random_point(&state, o->bounds), 1.5);
    const double radius = 0.3 * uniform(&state);
    const laves__side side = o->side(o->self, c, radius, v3(radius, radius, radius));
    if (side == LAVES__UNDECIDED) continue;
    decided++;
    for (int k = 0; k < 6; k++) {
      const double d = k % 2 ? radius : -radius;
      const double phi = value_at(domain, c.x + (k / 2 == 0 ? d : 0), c.y + (k / 2 == 1 ? d : 0), c.z + (k / 2 == 2 ? d : 0));
      assert_int_equal(phi < 0, side == LAVES__INSIDE);
    }
  }
  assert_true(decided > 500);
  laves_domain_free(domain);
  shape_free(&s);
  laves_context_free(context);
}

/* Torn into triangles whose corners moved a little, some turned over, some twice: closed again after mending. */
static void cracks_and_directions_are_mended(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  shape whole = shape_torus(1, 0.4, 30, 16), s = torn(&whole);
  uint64_t state = 6;
  for (size_t i = 0; i < 3 * s.point_count; i++) s.points[i] += 2e-6 * (uniform(&state) - 0.5);
  for (size_t t = 0; t < s.triangle_count; t++) {
    if (t % 3) continue;
    uint32_t *c = s.triangles + 3 * t;
    const uint32_t swap = c[0];
    c[0] = c[1];
    c[1] = swap;
  }
  shape more = torn(&whole);
  shape_drop(&more, 20, more.triangle_count - 20);
  shape_append(&s, &more);
  laves_domain *domain = build(context, &s);
  assert_false(domain->info.winding);
  assert_int_equal(domain->info.triangle_count, whole.triangle_count);
  assert_true(domain->info.defects[LAVES_DEFECT_OPEN_EDGE] > 2000); /* of what was given */
  laves_domain *clean = build(context, &whole);
  assert_true(fabs(domain->info.volume / clean->info.volume - 1) < 1e-4);
  for (int i = 0; i < 300; i++) {
    const laves__vec3 p = random_point(&state, clean->oracle.bounds);
    assert_true(fabs(value_at(domain, p.x, p.y, p.z) - value_at(clean, p.x, p.y, p.z)) < 1e-5);
  }
  laves_domain_free(domain);
  laves_domain_free(clean);
  shape_free(&whole);
  shape_free(&more);
  shape_free(&s);
  laves_context_free(context);
}

static void what_encloses_nothing_is_refused(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain;
  laves_error error;
  double points[300 * 3];
  uint32_t triangles[300];
  uint64_t state = 8;
  for (size_t i = 0; i < LAVES__COUNT_OF(points); i++) points[i] = uniform(&state);
  for (uint32_t i = 0; i < 300; i++) triangles[i] = i;
  assert_int_equal(laves_domain_from_triangles(context, points, 300, triangles, 100, NULL, &domain, &error), LAVES_ERROR_INPUT);
  assert_non_null(strstr(error.text, "encloses no volume"));
  assert_non_null(strstr(error.text, "300 open edges"));
  const double square[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const uint32_t sheet[6] = {0, 1, 2, 0, 2, 3};
  assert_int_equal(laves_domain_from_triangles(context, square, 4, sheet, 2, NULL, &domain, &error), LAVES_ERROR_INPUT);
  assert_non_null(strstr(error.text, "encloses no volume"));
  /* Closed, but a sheet with a front and a back. */
  const uint32_t twofold[12] = {0, 1, 2, 0, 2, 3, 0, 2, 1, 0, 3, 2};
  assert_int_equal(laves_domain_from_triangles(context, square, 4, twofold, 4, NULL, &domain, &error), LAVES_ERROR_INPUT);
  assert_non_null(strstr(error.text, "encloses no volume"));
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

/* A box of which one side is finer than the others, so that points stand on edges; moved a little, in one case. */
static void t_junctions_are_stitched(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  for (int k = 0; k < 3; k++) {
    const double off = k == 1 ? 1e-6 : 0;
    shape coarse = shape_box((const double[3]){0, 0, 0}, (const double[3]){2, 2, 2}, 1);
    shape fine = shape_box((const double[3]){0, 0, 0}, (const double[3]){2, 2, 2}, k == 2 ? 7 : 4);
    for (size_t f = coarse.triangle_count; f-- > 0;) { /* the coarse one loses its side x = 2, the fine one all others */
      bool side = true;
      for (int c = 0; c < 3; c++) side = side && coarse.points[3 * coarse.triangles[3 * f + (size_t)c]] == 2;
      if (side) shape_drop(&coarse, f, 1);
    }
    for (size_t f = fine.triangle_count; f-- > 0;) {
      bool side = true;
      for (int c = 0; c < 3; c++) side = side && fine.points[3 * fine.triangles[3 * f + (size_t)c]] == 2;
      if (!side) shape_drop(&fine, f, 1);
    }
    for (size_t i = 0; i < fine.point_count; i++) fine.points[3 * i] -= off * (double)(i % 3);
    shape_append(&coarse, &fine);
    laves_domain *domain = NULL;
    laves_error error = {.text = ""};
    if (laves_domain_from_triangles(context, coarse.points, coarse.point_count, coarse.triangles, coarse.triangle_count, NULL,
                                    &domain, &error))
      fail_msg("%s", error.text);
    assert_true(domain->info.defects[LAVES_DEFECT_OPEN_EDGE] > 8);
    assert_int_equal(domain->info.open_edges_left, 0);
    assert_false(domain->info.winding);
    assert_true(fabs(domain->info.volume - 8) < 1e-4);
    laves_domain_free(domain);
    shape_free(&coarse);
    shape_free(&fine);
  }
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(t_junctions_are_stitched),
      cmocka_unit_test(a_hole_is_closed),
      cmocka_unit_test(feet_part_in_from_out),
      cmocka_unit_test(sides_stay_certain),
      cmocka_unit_test(cracks_and_directions_are_mended),
      cmocka_unit_test(what_encloses_nothing_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
