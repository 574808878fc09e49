/* Whole files in: what is read, and what is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "io/file.h"

static char folder[] = "/tmp/laves-test-XXXXXX";
static char path[64];

static int make_folder(void **state) {
  *state = laves_context_create(NULL);
  if (mkdtemp(folder) == NULL) {
    return -1;
  }
  snprintf(path, sizeof path, "%s/file", folder);
  return 0;
}

static int remove_folder(void **state) {
  assert_int_equal(laves_context_bytes(*state), 0);
  laves_context_free(*state);
  return rmdir(folder);
}

static void content_comes_whole_with_a_nul(void **state) {
  static const char CONTENT[] = "a\0b\r\nc";
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  fwrite(CONTENT, 1, sizeof CONTENT, file);
  fclose(file);
  char *bytes;
  size_t length;
  assert_int_equal(laves__file_read(*state, path, &bytes, &length, NULL), LAVES_OK);
  assert_int_equal(length, sizeof CONTENT);
  assert_memory_equal(bytes, CONTENT, length);
  assert_int_equal(bytes[length], 0);
  laves__free(*state, bytes, length + 1, 1);
  unlink(path);
}

/* Asserts that reading fails with a sentence that holds `phrase`. */
static void assert_refused(laves_context *context, const char *name, const char *phrase) {
  laves_error error = {0};
  char *bytes;
  size_t length;
  assert_int_equal(laves__file_read(context, name, &bytes, &length, &error), LAVES_ERROR_INPUT);
  assert_null(bytes);
  if (strstr(error.text, phrase) == NULL) {
    fail_msg("'%s' does not say '%s'", error.text, phrase);
  }
}

static void other_things_are_refused(void **state) {
  assert_refused(*state, path, "cannot open");
  assert_refused(*state, folder, "is a directory");
  assert_refused(*state, "/dev/zero", "is a device");
  assert_int_equal(mkfifo(path, 0600), 0);
  assert_refused(*state, path, "is a pipe");
  unlink(path);
}

static void memory_limit_is_kept(void **state) {
  (void)state;
  laves_context_options options = laves_context_options_default();
  options.memory_limit = 10000;
  laves_context *context = laves_context_create(&options);
  laves_error error = {0};
  char *bytes;
  size_t length;
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  for (int i = 0; i < 20000; ++i) {
    fputc('x', file);
  }
  fclose(file);
  assert_int_equal(laves__file_read(context, path, &bytes, &length, &error), LAVES_ERROR_MEMORY);
  assert_null(bytes);
  unlink(path);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(content_comes_whole_with_a_nul),
      cmocka_unit_test(other_things_are_refused),
      cmocka_unit_test(memory_limit_is_kept),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
