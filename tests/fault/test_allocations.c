/* Every allocation fails in turn, in small jobs that go through the whole library: alone, and with all that follow.
 *
 * Each time the job must tell that memory is short, or succeed with the very result that it has when nothing fails. No
 * block may be left, and no file.
 *
 * With many allocations the quick run takes every so many-th only; LAVES_EVERY=1 takes all. LAVES_JOB=NAME runs the jobs
 * whose name holds NAME. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fault/jobs.h"
#include "fault/refuser.h"
#include "fixtures/stride.h"

/* Refusals of each kind in the quick run of a job; the few are for slow tools. */
enum { QUICK_RUNS = 15, FEW_RUNS = 3 };

static job_place place;

static int set_up(void **state) {
  (void)state;
  return job_place_make(&place) ? 0 : -1;
}

static int tear_down(void **state) {
  (void)state;
  job_place_remove(&place);
  return 0;
}

typedef struct run_facts {
  laves_result result;
  job_outcome out;
  size_t asked, blocks, mistakes, bytes;
  int files;
} run_facts;

static run_facts run_job(const job *j, size_t refused, bool for_good) {
  run_facts facts = {.result = LAVES_ERROR_MEMORY, .out.digest = 1};
  refuser r = {.refused = refused, .for_good = for_good};
  laves_context *context = refuser_context(&r);
  if (context) {
    facts.result = j->run(context, &place, j->what, &facts.out);
    facts.bytes = laves_context_bytes(context);
  } else {
    laves_error short_of_memory = {LAVES_ERROR_MEMORY, "no context"};
    facts.out.error = short_of_memory;
  }
  laves_context_free(context);
  facts.asked = r.asked;
  facts.blocks = r.blocks;
  facts.mistakes = r.mistakes;
  facts.files = fixture_folder_count(place.outputs);
  return facts;
}

/* What is wrong with a run in which allocation `n` failed, or NULL. */
static const char *fault_of(const run_facts *facts, const run_facts *whole) {
  if (facts->blocks != 0 || facts->bytes != 0) return "memory is left";
  if (facts->mistakes != 0) return "a block was given back with a wrong size";
  if (facts->files != 0) return "a file is left";
  if (facts->result == whole->result)
    return facts->out.digest == whole->out.digest ? NULL : "the result is another one than with enough memory";
  if (facts->result != LAVES_ERROR_MEMORY) return "another error than short memory";
  if (facts->out.error.result != LAVES_ERROR_MEMORY || !strstr(facts->out.error.text, "memory")) {
    if (strcmp(facts->out.error.text, "no context") != 0) return "no sentence that says so";
  }
  return NULL;
}

/* Returns how many runs went wrong; tells of the first few. */
static int refuse_each(const job *j, const run_facts *whole, bool for_good, size_t stride) {
  int wrong = 0;
  for (size_t n = 1; n <= whole->asked; n += stride) {
    const run_facts facts = run_job(j, n, for_good);
    const char *fault = fault_of(&facts, whole);
    if (fault && ++wrong <= 5)
      print_error("%s: allocation %zu%s fails: %s (%s: %s)\n", j->name, n, for_good ? " and all that follow" : "", fault,
                  laves_result_name(facts.result), facts.out.error.text);
  }
  return wrong;
}

static int examine(const job *j) {
  const run_facts whole = run_job(j, 0, false);
  if (whole.result != LAVES_OK && whole.result != LAVES_TARGET_MISSED) {
    print_error("%s: %s\n", j->name, whole.out.error.text);
    return 1;
  }
  if (fault_of(&whole, &whole)) print_error("%s: %s with enough memory\n", j->name, fault_of(&whole, &whole));
  const size_t runs = test_stride() > 1 ? FEW_RUNS : QUICK_RUNS;
  const size_t stride = getenv("LAVES_EVERY") ? 1 : 1 + whole.asked / runs;
  const int wrong = refuse_each(j, &whole, false, stride) + refuse_each(j, &whole, true, stride);
  print_message("%s: %zu allocations, each %zu%s: %d wrong\n", j->name, whole.asked, stride, stride == 1 ? "" : "-th", wrong);
  return wrong + (fault_of(&whole, &whole) != NULL);
}

static void every_allocation_may_fail(void **state) {
  (void)state;
  const char *only = getenv("LAVES_JOB");
  int wrong = 0;
  for (int i = 0; i < job_count; i++)
    if (!only || strstr(jobs[i].name, only)) wrong += examine(&jobs[i]);
  assert_int_equal(wrong, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_allocation_may_fail)};
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
