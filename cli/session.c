/* One run of a command: what all commands do alike at their start and end. */
#include "session.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

#include "interrupt.h"
#include "machine.h"
#include "text.h"
#include "whole_file.h"

bool session_open(session *run, const settings *given) {
  *run = (session){.given = given, .start = progress_now(), .bar = progress_start(!given->quiet)};
  laves_context_options options = laves_context_options_default();
  options.thread_count = (int)given->threads;
  options.memory_limit = (size_t)(given->memory > 0 ? given->memory : machine_memory());
  options.progress = progress_report;
  options.progress_user = &run->bar;
  run->context = laves_context_create(&options);
  if (!run->context) text_error("%s", laves_result_text(LAVES_ERROR_MEMORY));
  if (given->timeout > 0) interrupt_after(given->timeout);
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

/* Only meshing has a size to choose; the rest has the input that it has. */
static laves_result fail_timeout(session *run) {
  const bool sized = run->given->size > 0 || run->given->relative_size > 0 || run->given->tets > 0 || run->given->vertices > 0;
  char phase[80] = "before the work began";
  if (run->bar.phase)
    snprintf(phase, sizeof phase, "in the phase '%.40s', %.0f %% of it done", run->bar.phase, 100 * run->bar.fraction);
  return session_fail(run, LAVES_ERROR_TIMEOUT,
                      "the %g s of --timeout were over %s; nothing half-written is left; allow more time%s", run->given->timeout,
                      phase, sized ? " or ask for fewer, larger tetrahedra" : "");
}

laves_result session_settle(session *run, laves_result result) {
  progress_clear(&run->bar);
  if (!interrupt_asked()) return result;
  if (interrupt_by_time()) return fail_timeout(run);
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
  if (errno == ENOMEM)
    return session_fail(run, LAVES_ERROR_MEMORY, "no memory to write the JSON file '%.200s'", run->given->json);
  return session_fail(run, LAVES_ERROR_WRITE, "cannot write the JSON file '%.200s': %s", run->given->json, strerror(errno));
}

static laves_result save_json(session *run, laves_result result, session_facts_fn *write_facts, const void *facts) {
  const char *path = run->given->json;
  if (strcmp(path, "-") == 0) {
    write_json(stdout, run, result, write_facts, facts);
    if (text_flush_output()) return LAVES_OK;
    return session_fail(run, LAVES_ERROR_WRITE, "cannot write JSON to the standard output: %s", strerror(errno));
  }
  whole_file out;
  if (!whole_file_open(&out, path)) return fail_json(run);
  write_json(out.file, run, result, write_facts, facts);
  return whole_file_close(&out, true) ? LAVES_OK : fail_json(run);
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
  if (result == LAVES_ERROR_MEMORY && run->given->memory == 0)
    text_say("The limit is the memory of this machine; --memory sets another.");
  laves_context_free(run->context);
  return laves_result_exit_code(result);
}
