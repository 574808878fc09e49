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
  char certificate[PATH_CAPACITY]; /* where it goes; empty: none is written */
  char report[PATH_CAPACITY];      /* the same of the page of --report */
  double certificate_bytes;        /* 0 before it is written */
  double seconds;                  /* to write them */
} outputs;

/* Decides paths and formats and makes sure, as far as can be known, that the files and --json can be written.
 * @param fallback  path when there is no --output; NULL: then nothing is written. Must outlive `plan`.
 * @param source    the input, which must not be overwritten, or NULL */
laves_result outputs_plan(session *run, const char *fallback, const char *source, outputs *plan);

/* Decides where the certificate goes: to --certificate, else beside the first output; nowhere when that is "none". */
laves_result outputs_plan_certificate(session *run, const char *source, outputs *plan);

/* Makes sure that a file of words (JSON, a certificate) can be written. */
laves_result outputs_check_text(session *run, const char *path, const char *source);

/* The page of a report ends in .html. */
laves_result outputs_check_page(session *run, const char *path);
/* Decides where the page of --report goes, if it is asked for: to a name of its own, while the mesh stays in memory. */
laves_result outputs_plan_report(session *run, const char *source, outputs *plan);

/* Only the check of --json, for commands without other outputs. */
laves_result outputs_check_json(session *run, const char *source);

/* @param certificate  NULL: none; written last, so that one that is there speaks of meshes that are there */
laves_result outputs_write(session *run, const laves_mesh *mesh, const laves_certificate *certificate, outputs *plan);
void outputs_say(const outputs *plan);
/* The member "outputs". */
void outputs_write_json(json *out, const outputs *plan);

#endif
