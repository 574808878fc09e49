/* The progress line on a terminal; nothing at all where stderr is a file or a pipe. */
#ifndef LAVES_CLI_PROGRESS_H
#define LAVES_CLI_PROGRESS_H

#include <stdbool.h>

typedef struct progress {
  bool enabled;
  bool shown;        /* a line stands on the terminal now */
  bool utf8, colour; /* how it is drawn */
  const char *phase; /* of the latest report; NULL: none yet */
  double fraction;   /* of it that was done then */
  double phase_start;
  double drawn; /* when, in seconds of progress_now() */
} progress;

progress progress_start(bool wanted);
/* A laves_progress_fn; `user` is a progress. Returns false once Ctrl-C or the like asks to stop. */
bool progress_report(void *user, const char *phase, double fraction);
/* Wipes the line, so that other text can be printed. */
void progress_clear(progress *bar);

/* Seconds from an arbitrary start, on a clock that only goes forward. */
double progress_now(void);

#endif
