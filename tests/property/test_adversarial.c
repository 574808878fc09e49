/* Whatever a callback answers, the mesh is valid and inside the promised window, or a sentence says why there is none. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/hard_solids.h"
#include "fixtures/stages.h"
#include "fixtures/stride.h"

static void mesh_or_sentence(laves_context *context, const laves_function *function, const laves_options *options,
                             const char *name) {
  laves_domain *domain;
  laves_error error = {.text = ""};
  laves_mesh *mesh;
  laves_report report;
  assert_int_equal(laves_domain_from_function(context, function, &domain, &error), LAVES_OK);
  const double start = laves__cpu_seconds();
  const laves_result result = laves_generate(context, domain, options, &mesh, &report, &error);
  if (getenv("LAVES_VERBOSE"))
    print_message("%-45s %-20s %7zu tets %6.2f s %s\n", name, laves_result_name(result), mesh ? mesh->tet_count : 0,
                  laves__cpu_seconds() - start, error.text);
  if (result == LAVES_OK || result == LAVES_TARGET_MISSED) {
    const laves_check check = check_valid(context, mesh, name);
    if (getenv("LAVES_VERBOSE"))
      print_message("    %.2f to %.2f, %zu stuffed\n", check.min_dihedral.min, check.max_dihedral.max, report.stuffed_vertices);
    assert_true(check.min_dihedral.min >= report.promised_min_dihedral);
    assert_true(check.max_dihedral.max <= report.promised_max_dihedral);
  } else {
    assert_null(mesh);
    if (result != LAVES_ERROR_INPUT && result != LAVES_ERROR_OPTION) fail_msg("%s: %s", name, laves_result_name(result));
    assert_true(error.text[0]);
  }
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  assert_int_equal(laves_context_bytes(context), 0);
}

/* Every `step`-th solid, from the first on; fewer where the stride of tests is more than one. */
static void mesh_all(const laves_options *options, int first, int step) {
  laves_context *context = laves_context_create(NULL);
  for (int i = first; i < hard_solid_count; i += step * test_stride()) {
    const laves_function function = hard_function(&hard_solids[i]);
    mesh_or_sentence(context, &function, options, hard_solids[i].name);
  }
  laves_context_free(context);
}

static void coarse(void **state) {
  (void)state;
  const laves_options options = options_of_size(0.23);
  mesh_all(&options, 0, 1);
}

static void fine(void **state) {
  (void)state;
  laves_options options = options_of_size(0.12);
  options.improve = false;
  mesh_all(&options, 0, 2);
  options.improve = true;
  mesh_all(&options, 1, 4);
}

static void by_stuffing_alone(void **state) {
  (void)state;
  laves_options options = options_of_size(0.17);
  options.method = LAVES_METHOD_STUFF;
  mesh_all(&options, 0, 2);
  options.guarantee = 28;
  options.improve = false;
  mesh_all(&options, 1, 2);
}

static void with_a_wished_count(void **state) {
  (void)state;
  laves_options options = options_of_tets(3000);
  mesh_all(&options, 1, 4);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(coarse),
      cmocka_unit_test(fine),
      cmocka_unit_test(by_stuffing_alone),
      cmocka_unit_test(with_a_wished_count),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
