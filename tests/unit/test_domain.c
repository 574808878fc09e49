/* The public handle: makers from files, names of tags, texts, memory limits. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "fixtures/shapes.h"
#include "laves/laves.h"

/* Writes text to a file of this process and ending; the name stays valid until the next call. */
static const char *file_with(const char *ending, const char *text) {
  static char name[64];
  snprintf(name, sizeof name, "/tmp/laves-domain-%ld%s", (long)getpid(), ending);
  FILE *file = fopen(name, "w");
  assert_non_null(file);
  fputs(text, file);
  assert_int_equal(fclose(file), 0);
  return name;
}

static const char tetrahedron[] =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    "g bottom\nf 1 3 2\ng sides\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

static void opens_surfaces(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain;
  laves_error error = {0};
  const char *name = file_with(".obj", tetrahedron);
  const laves_result result = laves_domain_from_file(context, name, &domain, &error);
  remove(name);
  if (result) fail_msg("%s", error.text);
  laves_domain_info info;
  laves_domain_get_info(domain, &info);
  assert_int_equal(info.kind, LAVES_DOMAIN_SURFACE);
  assert_string_equal(info.format, "OBJ");
  assert_true(fabs(info.volume - 1.0 / 6) < 1e-15);
  assert_int_equal(info.tag_count, 2);
  assert_string_equal(laves_domain_tag_name(domain, 0), "bottom");
  assert_string_equal(laves_domain_tag_name(domain, 1), "sides");
  assert_null(laves_domain_tag_name(domain, 2));
  assert_null(laves_domain_tag_name(domain, -1));
  laves_domain_free(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void opens_scripts_and_expressions(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain;
  laves_error error = {0};
  const char *name = file_with(".lua", "return sphere(1)");
  laves_result result = laves_domain_from_file(context, name, &domain, &error);
  remove(name);
  if (result) fail_msg("%s", error.text);
  const double points[6] = {0, 0, 0, 2, 0, 0};
  double values[2];
  laves_domain_evaluate(domain, points, 2, values);
  assert_true(values[0] < 0 && values[1] > 0);
  laves_domain_free(domain);
  result = laves_domain_from_expression(context, "sphere(1)", &domain, &error);
  if (result) fail_msg("%s", error.text);
  laves_domain_info info;
  laves_domain_get_info(domain, &info);
  assert_int_equal(info.kind, LAVES_DOMAIN_IMPLICIT);
  laves_domain_free(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void missing_files_leave_nothing(void **unused) {
  (void)unused;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain;
  laves_error error = {0};
  assert_int_equal(laves_domain_from_file(context, "/nowhere/at/all.stl", &domain, &error), LAVES_ERROR_INPUT);
  assert_null(domain);
  assert_true(strlen(error.text) > 10);
  assert_int_equal(laves_domain_from_file(context, "/nowhere/at/all.lua", &domain, NULL), LAVES_ERROR_INPUT);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_domain_free(NULL);
  laves_context_free(context);
}

static void long_batches_equal_single_points(void **unused) {
  (void)unused;
  enum { COUNT = 700 };
  laves_context *context = laves_context_create(NULL);
  shape s = shape_sphere(1, 6);
  laves_domain *domain;
  assert_int_equal(
      laves_domain_from_triangles(context, s.points, s.point_count, s.triangles, s.triangle_count, NULL, &domain, NULL),
      LAVES_OK);
  static double points[3 * COUNT], together[COUNT];
  for (int i = 0; i < 3 * COUNT; i++) points[i] = sin(0.37 * i);
  laves_domain_evaluate(domain, points, COUNT, together);
  for (int i = 0; i < COUNT; i++) {
    double alone;
    laves_domain_evaluate(domain, points + 3 * i, 1, &alone);
    assert_memory_equal(&alone, &together[i], sizeof alone);
  }
  laves_domain_free(domain);
  shape_free(&s);
  laves_context_free(context);
}

/* Refuses the allocation number `fail_at`. */
typedef struct rationing {
  int fail_at, seen;
} rationing;

static void *ration(void *user, void *pointer, size_t old_bytes, size_t new_bytes) {
  rationing *r = user;
  (void)old_bytes;
  if (new_bytes == 0) {
    free(pointer);
    return NULL;
  }
  if (r->seen++ == r->fail_at) return NULL;
  return realloc(pointer, new_bytes);
}

/* Whichever allocation fails, the answer is a result and nothing leaks. */
static void survives_every_failed_allocation(void **unused) {
  (void)unused;
  shape clean = shape_torus(1, 0.4, 8, 6), crossing = shape_sphere(1, 2), more = shape_sphere(1, 2), open = shape_sphere(1, 4);
  shape_move(&more, 0.9, 0.1, 0.2);
  shape_append(&crossing, &more);
  shape_drop(&open, 0, 20);
  const shape *shapes[3] = {&clean, &crossing, &open};
  for (int k = 0; k < 3; k++) {
    laves_result result = LAVES_ERROR_MEMORY;
    int fail_at = 0;
    for (; result != LAVES_OK; fail_at++) {
      rationing r = {fail_at + 1, 0}; /* the first is the context's */
      laves_context_options options = laves_context_options_default();
      options.thread_count = 1;
      options.reallocate = ration;
      options.reallocate_user = &r;
      laves_context *context = laves_context_create(&options);
      assert_non_null(context);
      laves_domain *domain;
      laves_error error;
      result = laves_domain_from_triangles(context, shapes[k]->points, shapes[k]->point_count, shapes[k]->triangles,
                                           shapes[k]->triangle_count, NULL, &domain, &error);
      assert_true(result == LAVES_OK || result == LAVES_ERROR_MEMORY);
      laves_domain_free(domain);
      assert_int_equal(laves_context_bytes(context), 0);
      laves_context_free(context);
    }
    assert_true(fail_at > 20);
  }
  shape_free(&clean);
  shape_free(&crossing);
  shape_free(&more);
  shape_free(&open);
}

static void defects_have_texts(void **unused) {
  (void)unused;
  for (int d = 0; d < LAVES_DEFECT_COUNT; d++) assert_true(strlen(laves_defect_text((laves_defect)d)) > 5);
  assert_string_equal(laves_defect_text(LAVES_DEFECT_OPEN_EDGE), "open edges");
}

/* Every model builds, or is refused with a sentence. */
static void models_build_or_are_refused(void **unused) {
  (void)unused;
  const char *folder = getenv("LAVES_MODELS");
  static const struct {
    const char *name;
    laves_result result;
    bool closed;
    size_t crossings;
  } models[] = {
      {"cow.obj", LAVES_OK, true, 89},           {"rabbit.obj", LAVES_OK, true, 195},      {"beetle.obj", LAVES_OK, false, 59},
      {"torus_far.ply", LAVES_OK, true, 0},      {"penguin_micro.off", LAVES_OK, true, 0}, {"hour_glass.off", LAVES_OK, true, 0},
      {"soup.stl", LAVES_ERROR_INPUT, false, 0},
  };
  laves_context *context = laves_context_create(NULL);
  int found = 0;
  for (size_t i = 0; i < sizeof models / sizeof models[0]; i++) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder ? folder : ".", models[i].name);
    if (access(path, R_OK) != 0) continue;
    found++;
    laves_domain *domain;
    laves_error error = {0};
    const laves_result result = laves_domain_from_file(context, path, &domain, &error);
    assert_int_equal(result, models[i].result);
    if (result) continue;
    assert_int_equal(domain != NULL, true);
    laves_domain_info info;
    laves_domain_get_info(domain, &info);
    assert_int_equal(info.closed, models[i].closed);
    assert_int_equal(info.defects[LAVES_DEFECT_CROSSING], models[i].crossings);
    laves_domain_free(domain);
  }
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
  if (found == 0) {
    printf("skipped: no models in LAVES_MODELS\n");
    skip();
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(opens_surfaces),
      cmocka_unit_test(opens_scripts_and_expressions),
      cmocka_unit_test(missing_files_leave_nothing),
      cmocka_unit_test(long_batches_equal_single_points),
      cmocka_unit_test(survives_every_failed_allocation),
      cmocka_unit_test(defects_have_texts),
      cmocka_unit_test(models_build_or_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
