/* A small JSON writer: commas, indentation and escapes are its business, order and names the caller's.
 *
 * `key` names a member of an object and is NULL inside arrays. Numbers have as many digits as they need to be read back
 * the same; NaN and infinities become null. Text that is not UTF-8 gets the replacement character. */
#ifndef LAVES_CLI_JSON_H
#define LAVES_CLI_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct json {
  FILE *file;
  int depth;
  bool has_items;  /* whether the open object or array already holds something */
  bool in_page;    /* stands in an element of HTML, which no text may end: set by the caller behind json_start() */
  unsigned arrays; /* bit `depth` is set when that level is an array */
} json;

json json_start(FILE *file);
void json_finish(json *out);

void json_open_object(json *out, const char *key);
void json_open_array(json *out, const char *key);
void json_close(json *out);

void json_text(json *out, const char *key, const char *text); /* NULL text: null */
void json_boolean(json *out, const char *key, bool value);
void json_integer(json *out, const char *key, int64_t value);
void json_number(json *out, const char *key, double value);
/* All on one line. */
void json_numbers(json *out, const char *key, const double *values, size_t count);

#endif
