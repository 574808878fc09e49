/* laves_generate() as a caller sees it: results, reports, targets, cancelling, short memory. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/hard_solids.h"
#include "fixtures/stages.h"
#include "fixtures/stride.h"

static laves_domain *domain_of(laves_context *context, const char *expression) {
  laves_domain *domain;
  laves_error error;
  if (laves_domain_from_expression(context, expression, &domain, &error) != LAVES_OK) fail_msg("%s", error.text);
  return domain;
}

static void counts_are_met_within_three_percent(void **state) {
  (void)state;
  /* Small counts only of a solid without symmetry: a ball in the middle of a lattice as symmetric as it is has steps. */
  static const struct {
    const char *expression;
    int64_t tets;
    bool vertices;
  } wishes[] = {
      {"smooth_union(sphere(1), sphere(0.6):move(0.9, 0.37, 0.21), 0.3)", 1000, false},
      {"smooth_union(sphere(1), sphere(0.6):move(0.9, 0.37, 0.21), 0.3)", 3000, true},
      {"sphere(1)", 5000, false},
      {"sphere(1)", 500000, false},
      {"torus(1, 0.4)", 20000, true},
      {"torus(1, 0.4)", 50000, false},
      {"torus(1, 0.4)", 500000, true},
      {"gyroid{period=1, thickness=0.35} & sphere(1)", 30000, false},
      {"gyroid{period=1, thickness=0.35} & sphere(1)", 60000, true},
  };
  laves_context *context = laves_context_create(NULL);
  for (size_t i = 0; i < LAVES__COUNT_OF(wishes); i++) {
    laves_options options = laves_options_default();
    options.improve = wishes[i].tets < 40000;
    if (wishes[i].vertices)
      options.vertex_target = wishes[i].tets / 5;
    else
      options.tet_target = wishes[i].tets;
    laves_domain *domain = domain_of(context, wishes[i].expression);
    laves_mesh *mesh;
    assert_true(laves_generate(context, domain, &options, &mesh, NULL, NULL) <= LAVES_TARGET_MISSED);
    const double got = wishes[i].vertices ? 5 * (double)mesh->vertex_count : (double)mesh->tet_count;
    if (fabs(got / (double)wishes[i].tets - 1) > 0.03)
      fail_msg("%s: %.0f for %.0f", wishes[i].expression, got, (double)wishes[i].tets);
    laves_mesh_free(mesh);
    laves_domain_free(domain);
  }
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void missed_counts_are_told(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain = domain_of(context, "sphere(1)");
  laves_options options = options_of_tets(37);
  laves_mesh *mesh = NULL;
  laves_report report;
  laves_error error;
  const laves_result result = laves_generate(context, domain, &options, &mesh, &report, &error);
  if (result == LAVES_TARGET_MISSED) {
    check_valid(context, mesh, "few tets");
    assert_true(report.warning_count > 0);
    assert_non_null(strstr(report.warnings[report.warning_count - 1], "37 tetrahedra"));
  } else {
    assert_int_equal(result, LAVES_OK);
    assert_in_range(mesh->tet_count, 36, 38);
  }
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  laves_context_free(context);
}

static void report_tells_what_was_done(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  const laves_options options = options_of_size(0.1);
  laves_report report;
  laves_mesh *mesh = mesh_of_expression(context, "torus(1, 0.4)", &options, &report);
  static const char *const names[] = {"background", "classify", "snap", "improve", "mesh"};
  assert_int_equal(report.stage_count, LAVES__COUNT_OF(names));
  for (size_t i = 0; i < LAVES__COUNT_OF(names); i++) {
    assert_string_equal(report.stages[i].name, names[i]);
    assert_true(report.stages[i].wall_seconds >= 0 && report.stages[i].cpu_seconds >= 0);
  }
  assert_true(report.size == 0.1);
  assert_true(fabs(report.volume / (2 * M_PI * M_PI * 0.16) - 1) < 0.003);
  assert_true(report.peak_bytes > mesh->tet_count * 16);
  assert_int_equal(report.lattice_tets, mesh->lattice_tet_count);
  assert_true(report.lattice_tets > 0 && report.lattice_tets < mesh->tet_count);
  assert_int_equal(report.pinches + report.off_surface + report.outside_window, 0);
  assert_int_equal(report.warning_count, 0);
  assert_true(report.snapped_vertices > 100);
  assert_string_equal(laves_mesh_group_name(mesh, 3, 1), "solid");
  assert_string_equal(laves_mesh_group_name(mesh, 2, 1), "boundary");
  laves_mesh_free(mesh);
  laves_context_free(context);
}

static void walls_and_edges_are_warned_of(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_options options = options_of_size(0.11);
  options.improve = false;
  laves_report report;
  laves_mesh *mesh = mesh_of_expression(context, "sphere(1) - sphere(0.955)", &options, &report);
  assert_true(report.pinches > 0);
  assert_true(report.lost_count > 0 && report.lost[0].kind == LAVES_THIN_WALL && fabs(report.lost[0].thickness - 0.045) < 0.003);
  assert_true(report.warning_count > 0);
  assert_non_null(strstr(report.warnings[0], "thinner than the size"));
  laves_mesh_free(mesh);
  options = options_of_size(0.3);
  options.min_dihedral = 55;
  mesh = mesh_of_expression(context, "box(1)", &options, &report);
  assert_true(report.outside_window > 0);
  assert_non_null(strstr(report.warnings[report.warning_count - 1], "outside the asked window"));
  laves_mesh_free(mesh);
  laves_context_free(context);
}

static void nothing_inside_is_an_error(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain = domain_of(context, "sphere(0.01)");
  const laves_options options = options_of_size(1);
  laves_error error = {.text = ""};
  laves_mesh *mesh = (laves_mesh *)&error;
  const laves_result result = laves_generate(context, domain, &options, &mesh, NULL, &error);
  if (result != LAVES_OK) {
    assert_int_equal(result, LAVES_ERROR_INPUT);
    assert_null(mesh);
    assert_non_null(strstr(error.text, "smaller size"));
  }
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void wrong_options_make_no_mesh(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain = domain_of(context, "sphere(1)");
  laves_options options = laves_options_default();
  options.cookie = 1;
  laves_error error;
  laves_mesh *mesh = (laves_mesh *)&error;
  assert_int_equal(laves_generate(context, domain, &options, &mesh, NULL, &error), LAVES_ERROR_OPTION);
  assert_null(mesh);
  options = options_of_size(1e-9);
  assert_int_equal(laves_generate(context, domain, &options, &mesh, NULL, NULL), LAVES_ERROR_OPTION);
  assert_null(mesh);
  laves_domain_free(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

/* ---- cancelling ---- */

typedef struct listener {
  int calls, allowed;
  bool seen[4];
} listener;

static bool listen(void *user, const char *phase, double fraction) {
  static const char *const phases[] = {"classify", "snap", "improve", "mesh"};
  listener *l = user;
  assert_true(fraction >= 0 && fraction <= 1);
  for (size_t i = 0; i < LAVES__COUNT_OF(phases); i++) l->seen[i] |= strcmp(phase, phases[i]) == 0;
  return ++l->calls <= l->allowed;
}

static laves_result generate_with(listener *l, laves_context *context, const laves_domain *domain) {
  const laves_options options = options_of_size(0.15);
  laves_mesh *mesh;
  laves_error error = {.text = ""};
  l->calls = 0;
  const laves_result result = laves_generate(context, domain, &options, &mesh, NULL, &error);
  assert_true((result == LAVES_OK) == (mesh != NULL));
  assert_true(result == LAVES_OK || error.text[0]);
  laves_mesh_free(mesh);
  return result;
}

static void cancelling_anywhere_leaves_nothing(void **state) {
  (void)state;
  listener l = {.allowed = 1 << 30};
  laves_context_options context_options = laves_context_options_default();
  context_options.progress = listen;
  context_options.progress_user = &l;
  context_options.thread_count = 1; /* worker 0 reports, so that every phase is seen */
  laves_context *context = laves_context_create(&context_options);
  laves_domain *domain = domain_of(context, "torus(1, 0.4) - box(0.5)");
  const size_t own = laves_context_bytes(context);
  assert_int_equal(generate_with(&l, context, domain), LAVES_OK);
  for (int i = 0; i < 4; i++) assert_true(l.seen[i]);
  const int calls = l.calls;
  assert_true(calls > 20);
  for (int at = 0; at < calls; at += 1 + calls / 20) {
    l.allowed = at;
    const laves_result result = generate_with(&l, context, domain);
    assert_int_equal(result, LAVES_ERROR_CANCELLED);
    assert_int_equal(laves_context_bytes(context), own);
  }
  l.allowed = 1 << 30;
  assert_int_equal(generate_with(&l, context, domain), LAVES_OK); /* a cancel is forgotten */
  laves_domain_free(domain);
  laves_context_free(context);
}

/* ---- memory ---- */

static void short_memory_anywhere_leaves_nothing(void **state) {
  (void)state;
  size_t peak = 0;
  for (int step = 0; step <= 20; step += test_stride()) {
    laves_context_options context_options = laves_context_options_default();
    context_options.memory_limit = step ? peak * (size_t)step / 20 - (step == 20) : 0;
    laves_context *context = laves_context_create(&context_options);
    laves_domain *domain = NULL;
    laves_mesh *mesh = NULL;
    laves_error error = {.text = ""};
    const laves_options options = options_of_size(0.15);
    laves_result result = laves_domain_from_expression(context, "torus(1, 0.4) - box(0.5)", &domain, &error);
    if (result == LAVES_OK) result = laves_generate(context, domain, &options, &mesh, NULL, &error);
    if (step == 0) {
      assert_int_equal(result, LAVES_OK);
      peak = laves_context_peak_bytes(context);
    } else {
      assert_true(laves_context_peak_bytes(context) <= context_options.memory_limit);
      assert_int_equal(result, LAVES_ERROR_MEMORY);
      assert_null(mesh);
      assert_true(error.text[0]);
    }
    laves_mesh_free(mesh);
    laves_domain_free(domain);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
  }
}

/* Every single allocation refused in turn. */
typedef struct refuser {
  size_t asked, refused;
} refuser;

static void *refuse(void *user, void *pointer, size_t old_bytes, size_t new_bytes) {
  refuser *r = user;
  (void)old_bytes;
  if (new_bytes == 0) {
    free(pointer);
    return NULL;
  }
  if (++r->asked == r->refused) return NULL;
  return realloc(pointer, new_bytes);
}

static void each_refused_allocation_is_survived(void **state) {
  (void)state;
  bool more = true;
  for (size_t n = 1; more; n += (size_t)test_stride()) {
    refuser r = {0};
    laves_context_options context_options = laves_context_options_default();
    context_options.reallocate = refuse;
    context_options.reallocate_user = &r;
    context_options.thread_count = 1;
    laves_context *context = laves_context_create(&context_options);
    laves_domain *domain = domain_of(context, "sphere(1) - sphere(0.6)");
    r = (refuser){0, n};
    laves_mesh *mesh;
    const laves_options options = options_of_size(0.35);
    const laves_result result = laves_generate(context, domain, &options, &mesh, NULL, NULL);
    more = r.asked >= n;
    r.refused = 0;
    /* The improver does without an operation whose journal finds no room. */
    assert_true(result == LAVES_ERROR_MEMORY || result == LAVES_OK);
    if (mesh) check_valid(context, mesh, "short of memory");
    if (!more) assert_int_equal(result, LAVES_OK);
    laves_mesh_free(mesh);
    laves_domain_free(domain);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
    assert_true(n < 2000);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(counts_are_met_within_three_percent), cmocka_unit_test(missed_counts_are_told),
      cmocka_unit_test(report_tells_what_was_done),          cmocka_unit_test(walls_and_edges_are_warned_of),
      cmocka_unit_test(nothing_inside_is_an_error),          cmocka_unit_test(wrong_options_make_no_mesh),
      cmocka_unit_test(cancelling_anywhere_leaves_nothing),  cmocka_unit_test(short_memory_anywhere_leaves_nothing),
      cmocka_unit_test(each_refused_allocation_is_survived),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
