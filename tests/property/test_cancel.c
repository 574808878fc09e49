/* Calls that are cancelled at one callback or another: each ends with LAVES_ERROR_CANCELLED, keeps no memory, leaves no file, and
 * works when it is called again. How soon it ends is measured by bench/cancel.c. */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "fixtures/shapes.h"
#include "fixtures/size_files.h"
#include "laves/laves.h"

enum { CUTS = 6 };

/* Counts the calls; false from the `last` on. */
typedef struct counter {
  size_t calls, last; /* 0: never */
} counter;

static bool count_call(void *user, const char *phase, double fraction) {
  counter *c = user;
  assert_non_null(phase);
  assert_true(fraction >= 0 && fraction <= 1);
  c->calls++;
  return c->last == 0 || c->calls < c->last;
}

typedef struct bench {
  counter calls;
  laves_context *context;
  laves_domain *domain;
  laves_mesh *mesh;
  char folder[40], path[80]; /* the path is that of the job at hand */
  const char *argument;
} bench;

typedef laves_result job_fn(bench *b, laves_error *error);

static size_t files_in(const char *folder) {
  size_t count = 0;
  DIR *d = opendir(folder);
  assert_non_null(d);
  for (const struct dirent *e; (e = readdir(d));) count += strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0;
  closedir(d);
  return count;
}

/* Cancels the job at the first callbacks, at some between, and at late ones; `writes`: it makes the file b->path. */
static void cancel_everywhere(bench *b, job_fn *job, bool writes) {
  laves_error error;
  b->calls = (counter){0};
  const size_t held = laves_context_bytes(b->context), files = files_in(b->folder);
  if (job(b, &error) != LAVES_OK) fail_msg("%s: %s", b->argument, error.text);
  if (writes) assert_int_equal(unlink(b->path), 0);
  const size_t all = b->calls.calls;
  assert_true(all >= 1);
  for (size_t cut = 0; cut < CUTS; cut++) {
    const size_t last = cut < 3 ? cut + 1 : all * (cut - 2) / (CUTS - 2);
    if (last == 0 || last > all) continue;
    b->calls = (counter){.last = last};
    const laves_result result = job(b, &error);
    /* How often threads ask varies a little, so a late cut may not come. */
    if (b->calls.calls >= last ? result != LAVES_ERROR_CANCELLED : result != LAVES_OK)
      fail_msg("%s: cancelled at %zu of %zu: %s: %s", b->argument, last, all, laves_result_name(result), error.text);
    if (result == LAVES_OK && writes) unlink(b->path);
    assert_int_equal(laves_context_bytes(b->context), held);
    assert_int_equal(files_in(b->folder), files);
  }
  b->calls = (counter){0};
  if (job(b, &error) != LAVES_OK) fail_msg("%s, again: %s", b->argument, error.text);
  if (writes) assert_int_equal(unlink(b->path), 0);
  assert_int_equal(laves_context_bytes(b->context), held);
}

static int set_up(void **state) {
  static bench b;
  b = (bench){.argument = ""};
  laves_context_options options = laves_context_options_default();
  options.thread_count = 1; /* so that how often it asks is always the same */
  options.progress = count_call;
  options.progress_user = &b.calls;
  b.context = laves_context_create(&options);
  strcpy(b.folder, "/tmp/laves-cancel-XXXXXX");
  assert_non_null(mkdtemp(b.folder));
  assert_int_equal(laves_domain_from_expression(b.context, "box(2, 2, 2)", &b.domain, NULL), LAVES_OK);
  laves_options wish = laves_options_default();
  wish.size = 0.2;
  assert_int_equal(laves_generate(b.context, b.domain, &wish, &b.mesh, NULL, NULL), LAVES_OK);
  *state = &b;
  return 0;
}

static int tear_down(void **state) {
  bench *b = *state;
  laves_mesh_free(b->mesh);
  laves_domain_free(b->domain);
  assert_int_equal(laves_context_bytes(b->context), 0);
  laves_context_free(b->context);
  return rmdir(b->folder);
}

/* ---- meshes ---- */

static void use_options(const char *words, laves_options *options) {
  if (strstr(words, "stuff")) options->method = LAVES_METHOD_STUFF;
  if (strstr(words, "curvature")) options->curvature_elements = 20;
  if (strstr(words, "thickness")) options->thickness_elements = 4;
  if (strstr(words, "growth")) options->interior_growth = 0.5;
  if (strstr(words, "picky")) options->max_dihedral = 100;
}

static laves_result generate(bench *b, laves_error *error) {
  laves_options options = laves_options_default();
  laves_mesh *mesh = NULL;
  options.size = 0.3;
  use_options(b->argument, &options);
  const laves_result result = laves_generate(b->context, b->domain, &options, &mesh, NULL, error);
  if (result != LAVES_OK && result != LAVES_TARGET_MISSED) assert_null(mesh);
  laves_mesh_free(mesh);
  return result == LAVES_TARGET_MISSED ? LAVES_OK : result;
}

static void meshes(void **state) {
  static const char *const arguments[] = {"uniform", "stuff", "curvature", "thickness growth", "picky"};
  bench *b = *state;
  for (size_t i = 0; i < sizeof arguments / sizeof *arguments; i++) {
    b->argument = arguments[i];
    cancel_everywhere(b, generate, false);
  }
}

static laves_result estimate(bench *b, laves_error *error) {
  laves_options options = laves_options_default();
  laves_expectation expectation;
  use_options(b->argument, &options);
  return laves_estimate(b->context, b->domain, &options, &expectation, error);
}

static void estimates(void **state) {
  bench *b = *state;
  b->argument = "curvature growth";
  cancel_everywhere(b, estimate, false);
}

/* ---- checks ---- */

static laves_result certify(bench *b, laves_error *error) {
  static laves_certificate certificate;
  laves_certify_options options = laves_certify_options_default();
  options.domain = b->domain;
  options.feature_angle = 40;
  return laves_certify(b->context, b->mesh, &options, &certificate, error);
}

static laves_result find_distant(bench *b, laves_error *error) {
  laves_place places[4];
  size_t count;
  return laves_check_distance(b->context, b->mesh, b->domain, 1e-4, places, 4, &count, error);
}

static laves_result find_outside(bench *b, laves_error *error) {
  laves_place places[4];
  size_t count;
  return laves_check_window(b->context, b->mesh, b->domain, 60, 80, 0.8, places, 4, &count, error);
}

static void checks(void **state) {
  bench *b = *state;
  b->argument = "certify";
  cancel_everywhere(b, certify, false);
  b->argument = "distance";
  cancel_everywhere(b, find_distant, false);
  b->argument = "window";
  cancel_everywhere(b, find_outside, false);
}

/* ---- files ---- */

static laves_result write_mesh(bench *b, laves_error *error) {
  laves_write_options options = laves_write_options_default();
  options.ascii = strstr(b->argument, "text") != NULL;
  return laves_mesh_write(b->context, b->mesh, b->path, &options, error);
}

static laves_result read_mesh(bench *b, laves_error *error) {
  laves_mesh *mesh = NULL;
  const laves_result result = laves_mesh_read(b->context, b->path, &mesh, error);
  if (result != LAVES_OK) assert_null(mesh);
  laves_mesh_free(mesh);
  return result;
}

static laves_result read_surface(bench *b, laves_error *error) {
  laves_domain *domain = NULL;
  const laves_result result = laves_domain_from_file(b->context, b->path, &domain, error);
  if (result != LAVES_OK) assert_null(domain);
  laves_domain_free(domain);
  return result;
}

static void files(void **state) {
  static const char *const names[] = {"a.vtu", "a.vtu text", "a.msh", "a.msh text", "a.mesh text", "a.meshb",
                                      "a.stl", "a.stl text", "a.obj", "a.off",      "a.ply",       "a.ply text"};
  bench *b = *state;
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    b->argument = names[i];
    snprintf(b->path, sizeof b->path, "%s/%.*s", b->folder, (int)strcspn(names[i], " "), names[i]);
    cancel_everywhere(b, write_mesh, true);
    assert_int_equal(write_mesh(b, NULL), LAVES_OK);
    cancel_everywhere(b, i < 6 ? read_mesh : read_surface, false);
    assert_int_equal(unlink(b->path), 0);
  }
}

static laves_result read_background(bench *b, laves_error *error) {
  laves_sizing *sizing = NULL;
  laves_result result = laves_sizing_create(b->context, &sizing, error);
  if (result == LAVES_OK) result = laves_sizing_add_background(sizing, b->path, NULL, error);
  laves_sizing_free(sizing);
  return result;
}

static void backgrounds(void **state) {
  bench *b = *state;
  for (int kind = 0; kind < SIZE_FILE_KINDS; kind++) {
    const size_file file = fixture_size_file(kind, 6);
    assert_non_null(file.bytes);
    b->argument = file.name;
    snprintf(b->path, sizeof b->path, "%s/%s", b->folder, file.name);
    FILE *out = fopen(b->path, "wb");
    assert_non_null(out);
    assert_int_equal(fwrite(file.bytes, 1, file.length, out), file.length);
    assert_int_equal(fclose(out), 0);
    free(file.bytes);
    cancel_everywhere(b, read_background, false);
    assert_int_equal(unlink(b->path), 0);
  }
}

static laves_result run_script(bench *b, laves_error *error) {
  laves_domain *domain = NULL;
  const laves_result result = laves_domain_from_expression(b->context, b->argument, &domain, error);
  laves_domain_free(domain);
  return result;
}

static void scripts(void **state) {
  bench *b = *state;
  b->argument = "(function() local s = 0 for i = 1, 400000 do s = s + i end return sphere(1) end)()";
  cancel_everywhere(b, run_script, false);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(meshes, set_up, tear_down),
      cmocka_unit_test_setup_teardown(estimates, set_up, tear_down),
      cmocka_unit_test_setup_teardown(checks, set_up, tear_down),
      cmocka_unit_test_setup_teardown(files, set_up, tear_down),
      cmocka_unit_test_setup_teardown(backgrounds, set_up, tear_down),
      cmocka_unit_test_setup_teardown(scripts, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
