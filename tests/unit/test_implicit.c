/* The oracle of implicit solids: signs, feet, sides, bounds, samples. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "domain/oracle.h"
#include "fixtures/assert_close.h"
#include "fixtures/random_expression.h"

typedef struct made {
  laves_context *context;
  laves_domain *domain;
} made;

static made make(const char *text) {
  made m = {.context = laves_context_create(NULL)};
  laves_error error;
  if (laves_domain_from_expression(m.context, text, &m.domain, &error) != LAVES_OK) fail_msg("%s: %s", text, error.text);
  return m;
}

static void drop(made *m) {
  laves_domain_free(m->domain);
  assert_int_equal(laves_context_bytes(m->context), 0);
  laves_context_free(m->context);
}

static const char *const solids[] = {
    "sphere(1)",
    "torus(1, 0.3)",
    "sphere(1) - cylinder{r=0.4}",
    "x*x + y*y + z*z - 1",
    "x^4 + y^4 + z^4 - x*x - y*y - z*z + 0.4",
    "gyroid{period=1, thickness=0.2} & sphere(1)",
    "box(1, 2, 3):rotate{angle=30, axis={1, 1, 1}}",
    "metaballs{{0, 0, 0, 1}, {1, 0, 0, 0.6}}",
    "ellipsoid(3, 1, 1)",
    "smooth_union(sphere(1), sphere(1):move(1.5, 0, 0), 0.5)",
    "cone{r=1, h=2} | capsule{r=0.3, h=3}",
    "shell(sphere(1), 0.1) & halfspace{normal=\"z\"}",
    "repeat_polar(sphere(0.3):move(1, 0, 0), {count=7}):move(1e6, 0, 0)",
    "scale(torus(1, 0.3), 1e-6)",
    "(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3", /* Taubin's heart */
};

static laves__vec3 point_in(laves__box3 box, uint64_t *seed) {
  laves__vec3 p;
  for (int i = 0; i < 3; i++)
    *v3_slot(&p, i) = v3_at(box.lower, i) + random_unit(seed) * (v3_at(box.upper, i) - v3_at(box.lower, i));
  return p;
}

static double phi_at(const laves__oracle *o, laves__vec3 p) {
  double phi;
  o->evaluate(o->self, 1, &p, &phi, NULL);
  return phi;
}

static void feet_lie_on_the_surface(void **state) {
  (void)state;
  for (size_t k = 0; k < LAVES__COUNT_OF(solids); k++) {
    made m = make(solids[k]);
    const laves__oracle *o = &m.domain->oracle;
    const double diagonal = box3_diagonal(o->bounds), reach = diagonal / 20;
    uint64_t seed = k;
    int found = 0, changes = 0;
    for (int i = 0; i < 2000; i++) {
      const laves__vec3 p = point_in(o->bounds, &seed);
      laves__vec3 foot, normal;
      uint32_t hint = LAVES__NO_HINT;
      if (!o->project(o->self, p, reach, &hint, &foot, &normal)) continue;
      found++;
      assert_true(v3_distance(foot, p) <= reach);
      assert_close(v3_norm(normal), 1, 1e-12);
      /* The sign changes within a billionth of the size, from inside to outside along the normal. */
      const double step = 1e-9 * diagonal;
      if (!(phi_at(o, v3_mad(foot, normal, step)) >= 0))
        fail_msg("%s: no change of sign at (%g, %g, %g)", solids[k], foot.x, foot.y, foot.z);
      changes += phi_at(o, v3_mad(foot, normal, -step)) <= 0; /* at a sharp edge the step may leave by the other side */
    }
    if (found < 100 || changes < 0.98 * found) fail_msg("%s: %d feet, %d with sign change", solids[k], found, changes);
    drop(&m);
  }
}

static void points_near_the_surface_have_feet(void **state) {
  (void)state;
  made m = make("torus(1, 0.3)");
  const laves__oracle *o = &m.domain->oracle;
  uint64_t seed = 3;
  for (int i = 0; i < 5000; i++) {
    const laves__vec3 p = point_in(o->bounds, &seed);
    const double phi = phi_at(o, p);
    laves__vec3 foot, normal;
    uint32_t hint = LAVES__NO_HINT;
    const bool found = o->project(o->self, p, 0.1, &hint, &foot, &normal);
    assert_true(found == (fabs(phi) <= 0.1));
    if (found) assert_close(v3_distance(p, foot), fabs(phi), 1e-12);
  }
  assert_true(o->is_distance);
  drop(&m);
}

static void sides_are_certain(void **state) {
  (void)state;
  for (size_t k = 0; k < LAVES__COUNT_OF(solids); k++) {
    made m = make(solids[k]);
    const laves__oracle *o = &m.domain->oracle;
    const double diagonal = box3_diagonal(o->bounds);
    uint64_t seed = k;
    int decided = 0;
    for (int i = 0; i < 1000; i++) {
      const laves__vec3 c = point_in(o->bounds, &seed);
      const double size = diagonal * exp2(-3 - 6 * random_unit(&seed));
      const laves__vec3 half = v3(size, size / 2, size / 3);
      const laves__side side = o->side(o->self, c, v3_norm(half), half);
      if (side == LAVES__UNDECIDED) continue;
      decided++;
      for (int j = 0; j < 10; j++) {
        const double phi = phi_at(o, point_in((laves__box3){v3_sub(c, half), v3_add(c, half)}, &seed));
        assert_true(side == LAVES__OUTSIDE ? phi > 0 : phi < 0);
      }
    }
    if (decided < 250) fail_msg("%s: only %d of 1000 boxes decided", solids[k], decided);
    drop(&m);
  }
}

static void bounds_hold_the_solid_closely(void **state) {
  (void)state;
  for (size_t k = 0; k < LAVES__COUNT_OF(solids); k++) {
    made m = make(solids[k]);
    const laves__oracle *o = &m.domain->oracle;
    const laves__vec3 widths = v3_sub(o->bounds.upper, o->bounds.lower), c = box3_centre(o->bounds);
    const laves__box3 larger = {v3_sub(c, widths), v3_add(c, widths)};
    uint64_t seed = k;
    laves__box3 found = box3_empty();
    enum { CAPACITY = 60000 };
    laves__vec3 *points = malloc(CAPACITY * sizeof *points);
    const size_t count = o->sample(o->self, box3_diagonal(o->bounds) / 60, points, CAPACITY);
    assert_in_range(count, 500, CAPACITY - 1);
    for (size_t i = 0; i < count; i++) {
      assert_true(fabs(phi_at(o, points[i])) < 1e-8 * box3_diagonal(o->bounds));
      found = box3_add(found, points[i]);
    }
    free(points);
    for (int i = 0; i < 3; i++) {
      const double slack = 1e-9 * v3_at(widths, i);
      assert_true(v3_at(found.lower, i) >= v3_at(o->bounds.lower, i) - slack);
      assert_true(v3_at(found.upper, i) <= v3_at(o->bounds.upper, i) + slack);
      if (v3_at(found.upper, i) - v3_at(found.lower, i) < 0.85 * v3_at(widths, i))
        fail_msg("%s: loose along axis %d", solids[k], i);
    }
    for (int i = 0; i < 3000; i++) {
      const laves__vec3 p = point_in(larger, &seed);
      const bool within = p.x >= o->bounds.lower.x && p.y >= o->bounds.lower.y && p.z >= o->bounds.lower.z &&
                          p.x <= o->bounds.upper.x && p.y <= o->bounds.upper.y && p.z <= o->bounds.upper.z;
      assert_true(within || phi_at(o, p) > 0);
    }
    drop(&m);
  }
}

/* Samples beyond the capacity are thinned out over the whole surface, not cut off. */
static void few_samples_still_cover_the_surface(void **state) {
  (void)state;
  made m = make("sphere(1)");
  laves__vec3 points[400];
  const size_t count = m.domain->oracle.sample(m.domain->oracle.self, 0.001, points, 400);
  assert_in_range(count, 60, 399);
  laves__vec3 sum = v3(0, 0, 0);
  for (size_t i = 0; i < count; i++) sum = v3_add(sum, points[i]);
  assert_true(v3_norm(sum) < 0.1 * (double)count);
  drop(&m);
}

static void facts_are_told(void **state) {
  (void)state;
  made m = make("sphere(2):move(1, 0, 0)");
  laves_domain_info info;
  laves_domain_get_info(m.domain, &info);
  assert_int_equal(info.kind, LAVES_DOMAIN_IMPLICIT);
  assert_string_equal(info.format, "Lua expression");
  assert_close(info.volume, 32 * M_PI / 3, 1e-12);
  assert_close(info.area, 16 * M_PI, 1e-12);
  assert_close(info.lower[0], -1, 1e-12);
  assert_close(info.upper[0], 3, 1e-12);
  drop(&m);
  m = make("sphere(1) | box(1)");
  assert_true(isnan(m.domain->oracle.volume) && !m.domain->oracle.is_distance);
  drop(&m);
}

/* A part a kilometre away, a micrometre wide: the same values as at home. */
static void far_solids_lose_no_digits(void **state) {
  (void)state;
  made home = make("torus(1e-6, 3e-7):rotate(40, \"x\")"),
       away = make("torus(1e-6, 3e-7):rotate(40, \"x\"):move(1e3, -2e3, 5e2)");
  const laves__oracle *a = &home.domain->oracle, *b = &away.domain->oracle;
  assert_true(v3_distance(b->origin, v3(1e3, -2e3, 5e2)) < 1e-6);
  uint64_t seed = 1;
  const laves__vec3 shift = v3_sub(b->origin, v3(1e3, -2e3, 5e2)); /* the middle is found to 1e-13 */
  for (int i = 0; i < 1000; i++) {
    const laves__vec3 p = point_in(a->bounds, &seed);
    assert_close(phi_at(b, v3_sub(p, shift)), phi_at(a, p), 1e-18);
  }
  drop(&home);
  drop(&away);
}

static void surfaces_are_leaves(void **state) {
  (void)state;
  const char *folder = getenv("LAVES_MODELS");
  char text[600];
  snprintf(text, sizeof text, "surface('%s/spot.obj'):move(5, 0, 0) - box(0.5):move(5, 0, 0)", folder ? folder : ".");
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain;
  laves_error error;
  if (laves_domain_from_expression(context, text, &domain, &error) != LAVES_OK) {
    print_message("skipped: %s\n", error.text);
    laves_context_free(context);
    skip();
    return;
  }
  const laves__oracle *o = &domain->oracle;
  assert_true(o->bounds.upper.x - o->bounds.lower.x < 1.2);
  laves__vec3 points[3000];
  const size_t count = o->sample(o->self, box3_diagonal(o->bounds) / 40, points, 3000);
  assert_true(count > 500);
  for (size_t i = 0; i < count; i++) assert_true(fabs(phi_at(o, points[i])) < 1e-9);
  laves_domain_free(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(feet_lie_on_the_surface),
      cmocka_unit_test(points_near_the_surface_have_feet),
      cmocka_unit_test(sides_are_certain),
      cmocka_unit_test(bounds_hold_the_solid_closely),
      cmocka_unit_test(facts_are_told),
      cmocka_unit_test(few_samples_still_cover_the_surface),
      cmocka_unit_test(far_solids_lose_no_digits),
      cmocka_unit_test(surfaces_are_leaves),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
