/* --job FILE: what a job file says, as words of the command line. */
#ifndef LAVES_CLI_JOB_H
#define LAVES_CLI_JOB_H

#include <stdbool.h>

#include "options.h"

typedef struct job {
  char **words; /* [count], of the job */
  int *lines;   /* where each stands in the file; 0: in no line */
  bool *used;   /* whether it counts: the command line does not say otherwise; set by options_parse() */
  int count, capacity;
} job;

/* Reads a job for a command: a file as job_file.h tells, or a certificate with the command that made its mesh. Relative names of
 * files in a job are taken from the job's folder; those in a certificate stand as they are.
 * @param out  what it says; NULL where it fails, which has been said on stderr
 * @return OPTIONS_RUN, _WRONG, _UNREADABLE, _NO_MEMORY */
options_outcome job_read(const command *about, const char *path, job **out);
/* NULL is fine. */
void job_free(job *said);

#endif
