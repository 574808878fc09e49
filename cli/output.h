/* Where a mesh goes: the files of --output and --boundary, checked before any work is done for them. */
#ifndef LAVES_CLI_OUTPUT_H
#define LAVES_CLI_OUTPUT_H

#include "session.h"

enum { PATH_CAPACITY = 4096 };

typedef struct output {
  const char *path;
  laves_format format;
  double bytes; /* of what was written; 0 before */
} output;

typedef struct outputs {
  output items[OUTPUT_CAPACITY + 1]; /* room for --boundary behind the --output ones */
  int count;
  double seconds; /* to write them */
} outputs;

/* Decides paths and formats and makes sure, as far as can be known, that the files and --json can be written.
 * @param fallback  path when there is no --output; NULL: then nothing is written. Must outlive `plan`.
 * @param source    the input, which must not be overwritten, or NULL */
laves_result outputs_plan(session *run, const char *fallback, const char *source, outputs *plan);

/* Only the check of --json, for commands without other outputs. */
laves_result outputs_check_json(session *run, const char *source);

laves_result outputs_write(session *run, const laves_mesh *mesh, outputs *plan);
void outputs_say(const outputs *plan);
/* The member "outputs". */
void outputs_write_json(json *out, const outputs *plan);

#endif
