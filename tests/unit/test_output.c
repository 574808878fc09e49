/* Files appear whole or not at all. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "fixtures/folders.h"
#include "io/output.h"

typedef struct fixture {
  laves_context *context;
  char folder[FIXTURE_FOLDER_MAX];
} fixture;

static int set_up(void **state) {
  static fixture f;
  f.context = laves_context_create(NULL);
  *state = &f;
  return f.context && fixture_folder_make(f.folder) ? 0 : -1;
}

static int tear_down(void **state) {
  fixture *f = *state;
  const bool leak = laves_context_bytes(f->context) != 0;
  fixture_folder_remove(f->folder);
  laves_context_free(f->context);
  return leak ? -1 : 0;
}

static const char *path_in(const fixture *f, const char *name) {
  static char path[FIXTURE_FOLDER_MAX + 300];
  snprintf(path, sizeof path, "%s/%s", f->folder, name);
  return path;
}

static void assert_content(const char *path, const char *expected) {
  char text[100] = "";
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  text[fread(text, 1, sizeof text - 1, file)] = 0;
  fclose(file);
  assert_string_equal(text, expected);
}

static void write_text(fixture *f, const char *path, const char *text) {
  laves__output out;
  laves__output_open(&out, f->context, path);
  laves__output_printf(&out, "%s", text);
  laves__output_complete(&out);
  laves__output_publish(&out);
  laves__output_discard(&out);
  assert_int_equal(out.error.result, LAVES_OK);
}

static void test_appears_when_published(void **state) {
  fixture *f = *state;
  const char *path = path_in(f, "a.txt");
  laves__output out;
  assert_int_equal(laves__output_open(&out, f->context, path), LAVES_OK);
  laves__output_bytes(&out, "hello", 5);
  assert_int_equal(laves__output_complete(&out), LAVES_OK);
  assert_int_not_equal(access(path, F_OK), 0);
  assert_int_equal(laves__output_publish(&out), LAVES_OK);
  laves__output_discard(&out);
  assert_content(path, "hello");
  assert_int_equal(fixture_folder_count(f->folder), 1);
}

static void test_replaces(void **state) {
  fixture *f = *state;
  const char *path = path_in(f, "a.txt");
  write_text(f, path, "old");
  chmod(path, 0640);
  write_text(f, path, "new");
  assert_content(path, "new");
  struct stat info;
  assert_int_equal(stat(path, &info), 0);
  assert_int_equal(info.st_mode & 0777, 0640);
}

static void test_discard_keeps_the_old(void **state) {
  fixture *f = *state;
  const char *path = path_in(f, "a.txt");
  write_text(f, path, "old");
  laves__output out;
  laves__output_open(&out, f->context, path);
  laves__output_printf(&out, "new");
  laves__output_discard(&out);
  assert_content(path, "old");
  assert_int_equal(fixture_folder_count(f->folder), 1);
}

static void test_follows_a_link(void **state) {
  fixture *f = *state;
  char link[FIXTURE_FOLDER_MAX + 10];
  snprintf(link, sizeof link, "%s/link", f->folder);
  write_text(f, path_in(f, "a.txt"), "old");
  assert_int_equal(symlink("a.txt", link), 0);
  write_text(f, link, "new");
  assert_content(path_in(f, "a.txt"), "new");
  struct stat info;
  assert_int_equal(lstat(link, &info), 0);
  assert_true(S_ISLNK(info.st_mode));
}

static void assert_open_fails(fixture *f, const char *path, const char *sentence_part) {
  laves__output out;
  assert_int_equal(laves__output_open(&out, f->context, path), LAVES_ERROR_WRITE);
  if (!strstr(out.error.text, sentence_part)) fail_msg("'%s' is not in '%s'", sentence_part, out.error.text);
  laves__output_printf(&out, "nothing happens");
  assert_int_equal(laves__output_complete(&out), LAVES_ERROR_WRITE);
  assert_int_equal(laves__output_publish(&out), LAVES_ERROR_WRITE);
  laves__output_discard(&out);
}

static void test_refused_targets(void **state) {
  fixture *f = *state;
  assert_open_fails(f, f->folder, "is a folder");
  assert_open_fails(f, path_in(f, "missing/a.txt"), "no file can be made in its folder: No such file");
  write_text(f, path_in(f, "a.txt"), "a file");
  assert_open_fails(f, path_in(f, "a.txt/b.txt"), "no file can be made in its folder: Not a directory");
  assert_open_fails(f, "", "no file name");
  char long_name[PATH_MAX + 10];
  memset(long_name, 'a', sizeof long_name - 1);
  long_name[sizeof long_name - 1] = 0;
  assert_open_fails(f, long_name, "longer than");
  assert_int_equal(fixture_folder_count(f->folder), 1);
}

static void test_devices(void **state) {
  fixture *f = *state;
  write_text(f, "/dev/null", "gone");
  struct stat info;
  assert_int_equal(stat("/dev/null", &info), 0);
  assert_true(S_ISCHR(info.st_mode));
  laves__output out;
  assert_int_equal(laves__output_open(&out, f->context, "/dev/full"), LAVES_OK);
  laves__output_printf(&out, "no room");
  assert_int_equal(laves__output_complete(&out), LAVES_ERROR_WRITE);
  assert_non_null(strstr(out.error.text, "No space left"));
  laves__output_discard(&out);
}

/* Items are numbers in text, so that their lengths differ. */
static size_t put_numbers(const void *user, size_t begin, size_t end, char *bytes) {
  (void)user;
  size_t length = 0;
  for (size_t i = begin; i < end; i++) length += (size_t)sprintf(bytes + length, "%zu\n", i);
  return length;
}

static void test_items_in_order(void **state) {
  fixture *f = *state;
  enum { COUNT = 300000 };
  const char *path = path_in(f, "numbers");
  laves__output out;
  laves__output_open(&out, f->context, path);
  laves__output_items(&out, COUNT, 21, put_numbers, NULL);
  laves__output_complete(&out);
  laves__output_publish(&out);
  laves__output_discard(&out);
  FILE *file = fopen(path, "r");
  char line[30];
  size_t expected = 0;
  while (fgets(line, sizeof line, file)) assert_int_equal(strtoull(line, NULL, 10), expected++);
  fclose(file);
  assert_int_equal(expected, COUNT);
  assert_int_equal(out.written, 10 + 90 * 2 + 900 * 3 + 9000 * 4 + 90000 * 5 + 200000 * 6 + COUNT);
}

/* ---- rows ---- */

enum { ROW_MAX = 6000 };

/* Byte i of all rows. */
static char byte_of_rows(uint64_t i) { return (char)(i * 0x9e3779b97f4a7c15u >> 56); }

static size_t put_rows(const void *user, size_t begin, size_t end, char *bytes) {
  const size_t row_bytes = *(const size_t *)user;
  for (size_t i = begin * row_bytes; i < end * row_bytes; i++) *bytes++ = byte_of_rows(i);
  return (end - begin) * row_bytes;
}

/* Writes `before` bytes, rows, and once more so many bytes and as many rows, as formats do; holds the file against that. */
static void assert_rows(fixture *f, size_t before, size_t count, size_t row_bytes, bool past_cache) {
  static const char rest[2 * 4096 + 1]; /* zeros */
  const char *path = path_in(f, "rows");
  laves__output out;
  assert_int_equal(laves__output_open(&out, f->context, path), LAVES_OK);
  out.expected = 1;
  out.uncached_from = past_cache ? 0 : 2;
  for (int turn = 0; turn < 2; turn++) {
    laves__output_bytes(&out, rest, before);
    laves__output_rows(&out, count, row_bytes, put_rows, &row_bytes);
  }
  laves__output_complete(&out);
  laves__output_publish(&out);
  laves__output_discard(&out);
  if (out.error.result != LAVES_OK) fail_msg("%zu bytes, %zu rows of %zu: %s", before, count, row_bytes, out.error.text);
  const size_t bytes = count * row_bytes, half = before + bytes;
  char *wanted = calloc(half + 1, 1), *is = malloc(half + 1);
  assert_true(wanted && is);
  put_rows(&row_bytes, 0, count, wanted + before);
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  for (int turn = 0; turn < 2; turn++) {
    const bool same = fread(is, 1, half, file) == half && memcmp(is, wanted, half) == 0;
    if (!same) fail_msg("%zu bytes, %zu rows of %zu: half %d is not what was written", before, count, row_bytes, turn);
  }
  assert_int_equal(getc(file), EOF);
  fclose(file);
  free(is);
  free(wanted);
}

/* Places and lengths about sectors of 4096 bytes and pieces of 2^20; rows that sectors and pieces cut. */
static void test_rows_at_any_place(void **state) {
  fixture *f = *state;
  static const size_t befores[] = {0, 1, 8, 4088, 4095, 4096, 4097, 8192};
  static const size_t rows[][2] = {{0, 8},    {1, 1},     {511, 8},  {512, 8},   {513, 8},    {1025, 8},
                                   {4096, 1}, {12289, 1}, {341, 24}, {1365, 24}, {3, ROW_MAX}};
  static const size_t large[][2] = {{131072, 8}, {100000, 24}, {350, ROW_MAX}};
  for (int past_cache = 0; past_cache < 2; past_cache++) {
    for (size_t b = 0; b < sizeof befores / sizeof *befores; b++)
      for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) assert_rows(f, befores[b], rows[r][0], rows[r][1], past_cache);
    for (size_t r = 0; r < sizeof large / sizeof *large; r++) assert_rows(f, 1001, large[r][0], large[r][1], past_cache);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_appears_when_published, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_replaces, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_discard_keeps_the_old, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_follows_a_link, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_refused_targets, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_devices, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_items_in_order, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_rows_at_any_place, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
