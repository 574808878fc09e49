/* One run of a command: what all commands do alike at their start and end. */
#include "session.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "interrupt.h"
#include "text.h"

bool session_open(session *run, const settings *given) {
  *run = (session){.given = given, .start = progress_now(), .bar = progress_start(!given->quiet)};
  laves_context_options options = laves_context_options_default();
  options.thread_count = (int)given->threads;
  options.memory_limit = (size_t)given->memory;
  options.progress = progress_report;
  options.progress_user = &run->bar;
  run->context = laves_context_create(&options);
  if (!run->context) text_error("%s", laves_result_text(LAVES_ERROR_MEMORY));
  return run->context != NULL;
}

laves_result session_fail(session *run, laves_result result, const char *format, ...) {
  run->error.result = result;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(run->error.text, sizeof run->error.text, format, arguments);
  va_end(arguments);
  return result;
}

laves_result session_settle(session *run, laves_result result) {
  progress_clear(&run->bar);
  if (!interrupt_asked()) return result;
  return session_fail(run, LAVES_ERROR_CANCELLED, "interrupted; nothing half-written is left");
}

double session_peak_bytes(void) {
  struct rusage usage;
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return 1024.0 * (double)usage.ru_maxrss; /* Linux counts in kB */
}

bool session_speaks(const session *run) { return !run->given->quiet; }

static bool is_failure(laves_result result) { return result != LAVES_OK && result != LAVES_TARGET_MISSED; }

static void write_json(FILE *file, const session *run, laves_result result, session_facts_fn *write_facts, const void *facts) {
  json out = json_start(file);
  json_text(&out, "program", "laves");
  json_text(&out, "version", laves_version());
  json_text(&out, "command", run->given->command);
  json_text(&out, "result", laves_result_name(result));
  json_integer(&out, "exit_code", laves_result_exit_code(result));
  json_text(&out, "error", is_failure(result) ? run->error.text : NULL);
  write_facts(&out, run, facts);
  json_number(&out, "peak_bytes", session_peak_bytes());
  json_number(&out, "library_peak_bytes", (double)laves_context_peak_bytes(run->context));
  json_finish(&out);
}

static laves_result fail_json(session *run) {
  return session_fail(run, LAVES_ERROR_WRITE, "cannot write the JSON file '%s': %s", run->given->json, strerror(errno));
}

/* Opening does not wait for someone to read from a pipe; writing does. */
static FILE *open_special(const char *path) {
  const int file = open(path, O_WRONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (file < 0 || fcntl(file, F_SETFL, fcntl(file, F_GETFL) & ~O_NONBLOCK) < 0) return NULL;
  return fdopen(file, "w");
}

/* A device or a pipe is written to directly; a file is written beside its place and renamed, so that it appears whole. */
static laves_result save_json(session *run, laves_result result, session_facts_fn *write_facts, const void *facts) {
  const char *path = run->given->json;
  if (strcmp(path, "-") == 0) {
    write_json(stdout, run, result, write_facts, facts);
    if (fflush(stdout) == 0) return LAVES_OK;
    return session_fail(run, LAVES_ERROR_WRITE, "cannot write JSON to the standard output: %s", strerror(errno));
  }
  struct stat status;
  const bool special = stat(path, &status) == 0 && !S_ISREG(status.st_mode);
  char temporary[4096];
  const int length = snprintf(temporary, sizeof temporary, special ? "%s" : "%s.tmp%ld", path, (long)getpid());
  if (length < 0 || (size_t)length >= sizeof temporary) {
    errno = ENAMETOOLONG;
    return fail_json(run);
  }
  FILE *file = special ? open_special(path) : fopen(temporary, "w");
  if (!file) return fail_json(run);
  write_json(file, run, result, write_facts, facts);
  bool right = !ferror(file);
  right = fclose(file) == 0 && right;
  if (!special) right = right && rename(temporary, path) == 0;
  if (right) return LAVES_OK;
  const laves_result failed = fail_json(run);
  if (!special) unlink(temporary);
  return failed;
}

void session_write_json(session *run, laves_result *result, session_facts_fn *write_facts, const void *facts) {
  if (!run->given->json || run->json_refused || *result == LAVES_ERROR_CANCELLED) return;
  const laves_error first = run->error;
  const laves_result saved = save_json(run, *result, write_facts, facts);
  if (!is_failure(saved)) return;
  if (!is_failure(*result)) {
    *result = saved;
  } else {
    text_error("%s", run->error.text);
    run->error = first;
  }
}

int session_close(session *run, laves_result result) {
  progress_clear(&run->bar);
  if (is_failure(result)) text_error("%s", run->error.text[0] ? run->error.text : laves_result_text(result));
  laves_context_free(run->context);
  return laves_result_exit_code(result);
}
