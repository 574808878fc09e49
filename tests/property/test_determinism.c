/* The same input gives the same bytes: any number of threads, any run. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/hard_solids.h"
#include "fixtures/stages.h"
#include "fixtures/stride.h"

typedef char hash_text[33];

static laves_context *create(int threads) {
  laves_context_options options = laves_context_options_default();
  options.thread_count = threads;
  return laves_context_create(&options);
}

static void hash_of_expression(const char *expression, const laves_options *options, int threads, hash_text hash) {
  laves_context *context = create(threads);
  laves_mesh *mesh = mesh_of_expression(context, expression, options, NULL);
  laves_mesh_hash(mesh, hash);
  laves_mesh_free(mesh);
  laves_context_free(context);
}

static void threads_and_runs_change_nothing(void **state) {
  (void)state;
  static const char *const solids[] = {"torus(1, 0.4) - box(0.5)", "gyroid{period=1, thickness=0.35} & sphere(1)",
                                       "x^4 + y^4 + z^4 - x*x - y*y - z*z + 0.4"};
  static const int threads[] = {1, 2, 3, 5, 1};
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++) {
    const laves_options options = options_of_tets(20000);
    hash_text first, other;
    hash_of_expression(solids[i], &options, 1, first);
    for (size_t t = 1; t<LAVES__COUNT_OF(threads); t += test_stride()> 1 ? 2 : 1) {
      hash_of_expression(solids[i], &options, threads[t], other);
      if (strcmp(first, other) != 0) fail_msg("%s: %d threads give another mesh", solids[i], threads[t]);
    }
  }
}

/* Improvement works hardest, and parts and trims come up, where the input is noise. */
static void noise_is_meshed_the_same(void **state) {
  (void)state;
  for (int i = 0; i<hard_solid_count; i += test_stride()> 1 ? 9 : 3) {
    const laves_function function = hard_function(&hard_solids[i]);
    hash_text hash[2];
    bool any = true;
    for (int run = 0; run < 2 && any; run++) {
      laves_context *context = create(run ? 3 : 1);
      laves_domain *domain;
      laves_mesh *mesh;
      const laves_options options = options_of_size(0.2);
      assert_int_equal(laves_domain_from_function(context, &function, &domain, NULL), LAVES_OK);
      any = laves_generate(context, domain, &options, &mesh, NULL, NULL) == LAVES_OK;
      if (any) laves_mesh_hash(mesh, hash[run]);
      laves_mesh_free(mesh);
      laves_domain_free(domain);
      laves_context_free(context);
    }
    if (any && strcmp(hash[0], hash[1]) != 0) fail_msg("%s: three threads give another mesh", hard_solids[i].name);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(threads_and_runs_change_nothing),
      cmocka_unit_test(noise_is_meshed_the_same),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
