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

/* "1.5 GiB"; what is beyond all machines is only told to be that. */
static void write_bytes(double bytes, char text[32]) {
  static const char *const units[] = {"KiB", "MiB", "GiB", "TiB"};
  int unit = 0;
  for (bytes /= 1024; bytes >= 1000 && unit < 3; bytes /= 1024) unit++;
  if (bytes < 1e6)
    snprintf(text, 32, "%.3g %s", bytes, units[unit]);
  else
    snprintf(text, 32, "more than a million TiB");
}

void laves__tell_memory(const laves_context *context, laves_error *error) {
  char limit[32], held[32];
  write_bytes((double)context->options.memory_limit, limit);
  write_bytes((double)laves_context_bytes(context), held);
  if (context->options.memory_limit)
    laves__fail(error, LAVES_ERROR_MEMORY,
                "the memory limit of %s does not suffice (%s are in use); raise it or choose a larger size", limit, held);
  else
    laves__fail(error, LAVES_ERROR_MEMORY, "out of memory with %s in use; choose a larger size", held);
}

laves_result laves__fail_room(const laves_context *context, double bytes, const char *what, const char *remedy,
                              laves_error *error) {
  char needed[32], given[32];
  write_bytes((double)laves_context_bytes(context) + bytes, needed);
  write_bytes((double)context->options.memory_limit, given);
  return laves__fail(error, LAVES_ERROR_MEMORY, "%s would need %s of memory, but the limit is %s; %s", what, needed, given,
                     remedy);
}

void laves__tell_cancelled(laves_error *error) {
  laves__fail(error, LAVES_ERROR_CANCELLED, "cancelled before the work was done");
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
