/* Results, their names and texts, and sentences for people. */
#include <stdarg.h>
#include <stdio.h>
#include <time.h>

#include "base/base.h"
#include "base/context.h"

const char *laves_version(void) { return LAVES_VERSION; }

static const struct {
  const char *name, *text;
  int exit_code;
} results[] = {
#define LAVES_RESULT_ROW(name, code, text) {"LAVES_" #name, text, code},
    LAVES_RESULT_LIST(LAVES_RESULT_ROW)
#undef LAVES_RESULT_ROW
};

static size_t result_row(laves_result result) {
  return (size_t)result < LAVES__COUNT_OF(results) ? (size_t)result : (size_t)LAVES_ERROR_INTERNAL;
}

const char *laves_result_name(laves_result result) { return results[result_row(result)].name; }
const char *laves_result_text(laves_result result) { return results[result_row(result)].text; }
int laves_result_exit_code(laves_result result) { return results[result_row(result)].exit_code; }

laves_result laves__fail(laves_error *error, laves_result result, const char *format, ...) {
  if (!error) return result;
  error->result = result;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(error->text, sizeof error->text, format, arguments);
  va_end(arguments);
  for (char *c = error->text; *c; c++)
    if (*c == '\n' || *c == '\r') *c = ' ';
  return result;
}

laves_result laves__fail_memory(const laves_context *context, laves_error *error) {
  const double mib = 1048576.0;
  const size_t limit = context->options.memory_limit;
  if (limit)
    return laves__fail(error, LAVES_ERROR_MEMORY,
                       "the memory limit of %.0f MiB does not suffice (%.0f MiB are in use); raise it or choose a larger size",
                       (double)limit / mib, (double)laves_context_bytes(context) / mib);
  return laves__fail(error, LAVES_ERROR_MEMORY, "out of memory with %.0f MiB in use; choose a larger size",
                     (double)laves_context_bytes(context) / mib);
}

laves_result laves__fail_cancelled(laves_error *error) {
  return laves__fail(error, LAVES_ERROR_CANCELLED, "cancelled before the work was done");
}

double laves__wall_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double laves__cpu_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

laves_result laves__fail_short(const laves_context *context, laves_error *error) {
  return laves__is_cancelled(context) ? laves__fail_cancelled(error) : laves__fail_memory(context, error);
}
