/* Whole files in, and pipes: what is read, and what is refused. */
#include <fcntl.h>
#include <poll.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
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

/* Writes `length` bytes to the named pipe, in a process of its own. */
static pid_t start_writer(size_t length) {
  const pid_t writer = fork();
  if (writer != 0) return writer;
  const int file = open(path, O_WRONLY);
  char piece[1000];
  memset(piece, 'x', sizeof piece);
  for (size_t done = 0; done < length; done += sizeof piece) {
    if (write(file, piece, sizeof piece) < 0) break;
  }
  _exit(0);
}

static void pipes_that_the_user_names_are_read_to_their_end(void **state) {
  enum { LENGTH = 300000 };
  char *bytes;
  size_t length;
  assert_int_equal(mkfifo(path, 0600), 0);
  const int held = open(path, O_RDWR); /* so that the pipe has a writer before the other process has opened it */
  const pid_t writer = start_writer(LENGTH);
  assert_true(writer > 0);
  const int reader = open(path, O_RDONLY | O_NONBLOCK);
  struct pollfd one = {.fd = reader, .events = POLLIN};
  assert_int_equal(poll(&one, 1, 60000), 1);
  close(held);
  close(reader);
  laves_error error = {0};
  if (laves__input_read(*state, path, &bytes, &length, &error) != LAVES_OK) fail_msg("%s", error.text);
  assert_int_equal(length, LENGTH);
  for (size_t i = 0; i < length; ++i) assert_int_equal(bytes[i], 'x');
  assert_int_equal(bytes[length], 0);
  laves__free(*state, bytes, length + 1, 1);
  waitpid(writer, NULL, 0);
  unlink(path);
}

static void a_pipe_without_a_writer_is_empty(void **state) {
  laves_error error = {0};
  char *bytes;
  size_t length;
  assert_int_equal(mkfifo(path, 0600), 0);
  assert_int_equal(laves__input_read(*state, path, &bytes, &length, &error), LAVES_ERROR_INPUT);
  assert_non_null(strstr(error.text, "nothing writes to it"));
  assert_null(bytes);
  unlink(path);
}

/* Goes on three times. */
static bool stop_soon(void *user, const char *phase, double fraction) {
  int *left = user;
  (void)phase;
  (void)fraction;
  return --*left > 0;
}

static void waiting_for_a_silent_pipe_can_be_cancelled(void **state) {
  (void)state;
  int left = 3;
  laves_context_options options = laves_context_options_default();
  options.progress = stop_soon;
  options.progress_user = &left;
  laves_context *context = laves_context_create(&options);
  char *bytes;
  size_t length;
  assert_int_equal(mkfifo(path, 0600), 0);
  const int writer = open(path, O_RDWR);
  assert_int_equal(write(writer, "solid", 5), 5);
  assert_int_equal(laves__input_read(context, path, &bytes, &length, NULL), LAVES_ERROR_CANCELLED);
  assert_int_equal(left, 0);
  assert_null(bytes);
  assert_int_equal(laves_context_bytes(context), 0);
  close(writer);
  unlink(path);
  laves_context_free(context);
}

static void an_endless_pipe_ends_at_the_memory_limit(void **state) {
  (void)state;
  laves_context_options options = laves_context_options_default();
  options.memory_limit = 300000;
  laves_context *context = laves_context_create(&options);
  char *bytes;
  size_t length;
  assert_int_equal(mkfifo(path, 0600), 0);
  const int held = open(path, O_RDWR);
  const pid_t writer = start_writer(SIZE_MAX);
  assert_true(writer > 0);
  assert_int_equal(laves__input_read(context, path, &bytes, &length, NULL), LAVES_ERROR_MEMORY);
  assert_int_equal(laves_context_bytes(context), 0);
  kill(writer, SIGKILL);
  waitpid(writer, NULL, 0);
  close(held);
  unlink(path);
  laves_context_free(context);
}

/* The socket's file, and nothing that listens. */
static void sockets_are_refused(void **state) {
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
  const int end = socket(AF_UNIX, SOCK_STREAM, 0);
  assert_int_equal(bind(end, (const struct sockaddr *)&address, sizeof address), 0);
  assert_refused(*state, path, "is a socket");
  close(end);
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
      cmocka_unit_test(sockets_are_refused),
      cmocka_unit_test(pipes_that_the_user_names_are_read_to_their_end),
      cmocka_unit_test(a_pipe_without_a_writer_is_empty),
      cmocka_unit_test(waiting_for_a_silent_pipe_can_be_cancelled),
      cmocka_unit_test(an_endless_pipe_ends_at_the_memory_limit),
      cmocka_unit_test(memory_limit_is_kept),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
