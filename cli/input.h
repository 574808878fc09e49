/* INPUT on the command line: a surface file, a Lua script, or an expression. */
#ifndef LAVES_CLI_INPUT_H
#define LAVES_CLI_INPUT_H

#include <stddef.h>

#include "session.h"

typedef struct input {
  const char *text; /* as given */
  laves_domain *domain;
  laves_domain_info info;
  size_t defect_places;   /* written to --defects */
  laves_defects *defects; /* of a surface, where a report wants them; NULL: not asked for */
  double seconds;         /* to read it */
} input;

/* Opens what the words mean. Close `in` whatever the result. */
laves_result input_open(session *run, const char *words, input *in);
/* Frees the domain and the defects. */
void input_close(input *in);

/* Writes the name that a mesh of this input gets by default: base name and extension of the format. */
void input_default_output(const char *words, laves_format format, char *path, size_t size);

/* The length of the diagonal of the input's box. */
double input_diagonal(const laves_domain_info *info);

/* Writes the member "input". */
void input_write_json(json *out, const char *key, const input *in);

#endif
