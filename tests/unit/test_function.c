/* Solids given by callbacks. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "domain/oracle.h"

/* A ball round (3, 0, 0); `user` points to its radius. */
static void ball(void *user, const double *points, size_t count, double *values) {
  const double radius = *(const double *)user;
  for (size_t i = 0; i < count; i++)
    values[i] = sqrt((points[3 * i] - 3) * (points[3 * i] - 3) + points[3 * i + 1] * points[3 * i + 1] +
                     points[3 * i + 2] * points[3 * i + 2]) -
                radius;
}

/* The same ball, with values that are no distances and no slope to speak of far away. */
static void steep_ball(void *user, const double *points, size_t count, double *values) {
  ball(user, points, count, values);
  for (size_t i = 0; i < count; i++) values[i] = values[i] > 0.5 ? NAN : tanh(20 * values[i]);
}

static laves_domain *build(laves_context *context, void (*evaluate)(void *, const double *, size_t, double *), double *radius,
                           double lipschitz) {
  const laves_function f = {evaluate, radius, {1.5, -1.5, -1.5}, {4.5, 1.5, 1.5}, lipschitz};
  laves_domain *domain = NULL;
  laves_error error = {0};
  if (laves_domain_from_function(context, &f, &domain, &error)) fail_msg("%s", error.text);
  return domain;
}

static void projects_onto_the_zero_set(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  double radius = 1;
  laves_domain *domains[2] = {build(context, ball, &radius, 1), build(context, steep_ball, &radius, 0)};
  for (int k = 0; k < 2; k++) {
    const laves__oracle *o = &domains[k]->oracle;
    for (int i = 0; i < 200; i++) {
      const double t = 0.7 * i, r = 0.8 + 0.002 * i, z = cos(0.3 * i);
      const laves__vec3 u = v3(sqrt(1 - z * z) * cos(t), sqrt(1 - z * z) * sin(t), z);
      laves__vec3 foot, normal;
      uint32_t hint = LAVES__NO_HINT;
      assert_true(o->project(o->self, v3_scale(u, r), 0.5, &hint, &foot, &normal));
      assert_true(v3_distance(foot, u) < 1e-6);
      assert_true(v3_distance(normal, u) < 1e-4);
    }
  }
  laves_domain_free(domains[0]);
  laves_domain_free(domains[1]);
  laves_context_free(context);
}

/* Counts what it is asked. */
typedef struct counted {
  double radius;
  size_t calls, points;
} counted;

static void counted_ball(void *user, const double *points, size_t count, double *values) {
  counted *c = user;
  steep_ball(&c->radius, points, count, values);
  c->calls++;
  c->points += count;
}

/* Points go their ways in step, and each comes to where it comes alone, to the last bit; the callback is called far more seldom.
 */
static void many_go_as_one_does(void **unused) {
  (void)unused;
  enum { COUNT = 700 };
  laves_context *context = laves_context_create(NULL);
  counted c = {.radius = 1};
  laves_domain *domain = build(context, counted_ball, &c.radius, 0);
  const laves__oracle *o = &domain->oracle;
  static laves__vec3 points[COUNT];
  static laves__projection answers[COUNT];
  for (int i = 0; i < COUNT;
       i++) { /* from within, from without, from the centre, where there is no slope, and from where it is NAN */
    const double t = 0.7 * i, r = i == 0 ? 0 : 0.7 + 0.001 * i, z = cos(0.3 * i);
    points[i] = v3(r * sqrt(1 - z * z) * cos(t), r * sqrt(1 - z * z) * sin(t), r * z);
    answers[i].hint = LAVES__NO_HINT;
  }
  c.calls = c.points = 0;
  laves__project_many(o, COUNT, points, 0.25, answers);
  const size_t calls = c.calls;
  assert_true(c.points / c.calls > 20);
  size_t found = 0;
  for (int i = 0; i < COUNT; i++) {
    laves__vec3 foot, normal;
    uint32_t hint = LAVES__NO_HINT;
    const bool alone = o->project(o->self, points[i], 0.25, &hint, &foot, &normal);
    assert_int_equal(answers[i].found, alone);
    if (!alone) continue;
    assert_memory_equal(&answers[i].foot, &foot, sizeof foot);
    assert_memory_equal(&answers[i].normal, &normal, sizeof normal);
    found++;
  }
  assert_true(found > COUNT / 4 && found < COUNT);
  assert_true(c.calls - calls > 5 * calls);
  laves_domain_free(domain);
  laves_context_free(context);
}

static void reach_is_kept(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  double radius = 1;
  laves_domain *domain = build(context, ball, &radius, 1);
  const laves__oracle *o = &domain->oracle;
  laves__vec3 foot, normal;
  uint32_t hint = LAVES__NO_HINT;
  assert_false(o->project(o->self, v3(0.5, 0, 0), 0.4, &hint, &foot, &normal));
  assert_true(o->project(o->self, v3(0.5, 0, 0), 0.6, &hint, &foot, &normal));
  laves_domain_free(domain);
  laves_context_free(context);
}

static void sides_follow_the_lipschitz_constant(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  double radius = 1;
  laves_domain *known = build(context, ball, &radius, 1), *unknown = build(context, ball, &radius, 0);
  const laves__oracle *k = &known->oracle, *u = &unknown->oracle;
  const laves__vec3 half = {0.2, 0.2, 0.2};
  assert_int_equal(k->side(k->self, v3(0, 0, 0), 0.4, half), LAVES__INSIDE);
  assert_int_equal(k->side(k->self, v3(1.3, 0, 0), 0.4, half), LAVES__UNDECIDED);
  assert_int_equal(k->side(k->self, v3(1.4, 0, 0), 0.35, half), LAVES__OUTSIDE);
  assert_int_equal(u->side(u->self, v3(0, 0, 0), 0.4, half), LAVES__UNDECIDED);
  assert_int_equal(u->side(u->self, v3(2, 0, 0), 0.4, half), LAVES__OUTSIDE); /* beyond the box */
  laves_domain_free(known);
  laves_domain_free(unknown);
  laves_context_free(context);
}

static void what_is_no_number_is_outside(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  double radius = 0.5;
  laves_domain *domain = build(context, steep_ball, &radius, 0);
  const double points[6] = {3, 0, 0, 4.4, 0, 0};
  double values[2];
  laves_domain_evaluate(domain, points, 2, values);
  assert_true(values[0] < 0 && values[1] > 0);
  assert_int_equal(domain->info.kind, LAVES_DOMAIN_FUNCTION);
  assert_true(isnan(domain->info.volume));
  laves_domain_free(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void bad_descriptions_are_refused(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  double radius = 1;
  laves_domain *domain;
  laves_error error;
  const laves_function none = {NULL, NULL, {0, 0, 0}, {1, 1, 1}, 1}, flat = {ball, &radius, {0, 0, 0}, {1, 0, 1}, 1},
                       negative = {ball, &radius, {0, 0, 0}, {1, 1, 1}, -1};
  assert_int_equal(laves_domain_from_function(context, &none, &domain, &error), LAVES_ERROR_OPTION);
  assert_int_equal(laves_domain_from_function(context, &flat, &domain, &error), LAVES_ERROR_OPTION);
  assert_non_null(strstr(error.text, "box"));
  assert_int_equal(laves_domain_from_function(context, &negative, &domain, &error), LAVES_ERROR_OPTION);
  assert_non_null(strstr(error.text, "Lipschitz"));
  assert_null(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

/* Whether a warning of the report holds the text. */
static bool warns(const laves_report *report, const char *text) {
  for (int i = 0; i < report->warning_count; i++)
    if (strstr(report->warnings[i], text)) return true;
  return false;
}

static laves_result mesh(laves_context *context, const laves_function *function, double growth, laves_report *report,
                         laves_error *error) {
  laves_domain *domain = NULL;
  laves_mesh *made;
  laves_options options = laves_options_default();
  options.size = 0.2;
  options.interior_growth = growth;
  if (laves_domain_from_function(context, function, &domain, error)) fail_msg("%s", error->text);
  const laves_result result = laves_generate(context, domain, &options, &made, report, error);
  laves_mesh_free(made);
  laves_domain_free(domain);
  return result;
}

/* A box that touches the solid is right; one that cuts it is told, whether the solid is followed to its end or not. */
static void solids_beyond_the_box_are_told(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  double radius = 1;
  laves_report report;
  laves_error error;
  laves_function f = {ball, &radius, {2, -1, -1}, {4, 1, 1}, 1};
  assert_int_equal(mesh(context, &f, 0, &report, &error), LAVES_OK);
  assert_int_equal(report.warning_count, 0);
  f.upper[2] = 0.9;
  for (int graded = 0; graded < 2; graded++) {
    assert_int_equal(mesh(context, &f, 0.3 * graded, &report, &error), LAVES_OK);
    assert_true(warns(&report, "the solid reaches beyond its bounds, by 0."));
  }
  f.upper[2] = -0.8;
  assert_int_equal(mesh(context, &f, 0, &report, &error), LAVES_ERROR_INPUT);
  assert_non_null(strstr(error.text, "the solid reaches beyond its bounds"));
  laves_context_free(context);
}

/* No number beyond x = 3.5. */
static void half_known_ball(void *user, const double *points, size_t count, double *values) {
  ball(user, points, count, values);
  for (size_t i = 0; i < count; i++)
    if (points[3 * i] > 3.5) values[i] = NAN;
}

static void unknown(void *user, const double *points, size_t count, double *values) {
  (void)user;
  (void)points;
  for (size_t i = 0; i < count; i++) values[i] = NAN;
}

/* The sentence is the same for any number of threads. */
static void what_is_no_number_is_told(void **unused) {
  (void)unused;
  double radius = 1;
  laves_report report[2];
  laves_error error;
  laves_function f = {half_known_ball, &radius, {1.8, -1.2, -1.2}, {4.2, 1.2, 1.2}, 0};
  for (int i = 0; i < 2; i++) {
    laves_context_options options = laves_context_options_default();
    options.thread_count = 1 + 3 * i;
    laves_context *context = laves_context_create(&options);
    assert_int_equal(mesh(context, &f, 0, &report[i], &error), LAVES_OK);
    assert_true(warns(&report[i], "the function gave no number "));
    laves_context_free(context);
  }
  assert_int_equal(report[0].warning_count, report[1].warning_count);
  assert_memory_equal(report[0].warnings, report[1].warnings, sizeof report[0].warnings);
  laves_context *context = laves_context_create(NULL);
  f.evaluate = unknown;
  assert_int_equal(mesh(context, &f, 0, report, &error), LAVES_ERROR_INPUT);
  assert_non_null(strstr(error.text, "; the function gave no number "));
  f.evaluate = ball;
  assert_int_equal(mesh(context, &f, 0, report, &error), LAVES_OK);
  assert_int_equal(report->warning_count, 0);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(projects_onto_the_zero_set),
      cmocka_unit_test(many_go_as_one_does),
      cmocka_unit_test(reach_is_kept),
      cmocka_unit_test(sides_follow_the_lipschitz_constant),
      cmocka_unit_test(what_is_no_number_is_outside),
      cmocka_unit_test(solids_beyond_the_box_are_told),
      cmocka_unit_test(what_is_no_number_is_told),
      cmocka_unit_test(bad_descriptions_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
