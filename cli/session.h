/* One run of a command: settings, context, progress, clocks and the error, from session_open() to session_close(). */
#ifndef LAVES_CLI_SESSION_H
#define LAVES_CLI_SESSION_H

#include <stdbool.h>

#include "json.h"
#include "laves/laves.h"
#include "options.h"
#include "progress.h"

typedef struct session {
  const settings *given;
  laves_context *context;
  progress bar;
  laves_error error;
  double start;      /* progress_now() at the start */
  bool json_refused; /* --json names a file that must not or cannot be written */
} session;

/* False when there is no memory for even a context; that has been said. */
bool session_open(session *run, const settings *given);

/* Fills the session's error and returns result. */
laves_result session_fail(session *run, laves_result result, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Wipes the progress line and, where the user asked to stop meanwhile or the time is over, turns the result into that. After each
 * call into the library that may take long. */
laves_result session_settle(session *run, laves_result result);

/* Writes the members of a command's JSON object; `facts` is the command's. */
typedef void session_facts_fn(json *out, const session *run, const void *facts);

/* Writes --json where it was asked for; a failure to do so becomes the result of a run that went well. */
void session_write_json(session *run, laves_result *result, session_facts_fn *write_facts, const void *facts);

/* Says the error if there is one and frees the context, whose objects must be gone.
 * @return the exit code */
int session_close(session *run, laves_result result);

/* Most memory that the process held at once, bytes. */
double session_peak_bytes(void);

/* True when human text is wanted. */
bool session_speaks(const session *run);

#endif
