/* laves.h alone, before any other header, as strict C11: the macros and the list of results agree with the functions. */
#include <laves/laves.h>

/* cmocka needs these first */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void test_version(void **state) {
  (void)state;
  char text[40];
  snprintf(text, sizeof text, "%d.%d.%d", LAVES_VERSION_MAJOR, LAVES_VERSION_MINOR, LAVES_VERSION_PATCH);
  assert_string_equal(text, LAVES_VERSION);
  assert_string_equal(laves_version(), LAVES_VERSION);
}

static void test_results(void **state) {
  (void)state;
#define CHECK_RESULT(name, code, text)                                  \
  assert_string_equal(laves_result_name(LAVES_##name), "LAVES_" #name); \
  assert_int_equal(laves_result_exit_code(LAVES_##name), code);         \
  assert_string_equal(laves_result_text(LAVES_##name), text);
  LAVES_RESULT_LIST(CHECK_RESULT)
#undef CHECK_RESULT
  assert_string_equal(laves_result_name((laves_result)999), "LAVES_ERROR_INTERNAL");
}

static void test_defaults_are_accepted(void **state) {
  (void)state;
  laves_context_options options = laves_context_options_default();
  laves_context *context = laves_context_create(&options);
  assert_non_null(context);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
  options.cookie += 1;
  assert_null(laves_context_create(&options));
}

static void test_free_accepts_null(void **state) {
  (void)state;
  laves_context_free(NULL);
  laves_domain_free(NULL);
  laves_mesh_free(NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_version),
      cmocka_unit_test(test_results),
      cmocka_unit_test(test_defaults_are_accepted),
      cmocka_unit_test(test_free_accepts_null),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
