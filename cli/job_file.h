/* The text of a job file: settings for a command, in a small part of TOML or in JSON.
 *
 *     # part.toml                      {
 *     input = "part.stl"                 "input": "part.stl",
 *     tets = "500k"                      "tets": "500k",
 *     [mesh]                             "mesh": {
 *     window = [35, 130]                   "window": [35, 130],
 *     output = ["a.vtu", "a.msh"]          "output": ["a.vtu", "a.msh"]
 *                                        }
 *                                      }
 *
 * Known are keys, one level of tables, and for values: strings of one line, numbers, true and false, and arrays of strings or
 * numbers. All else that TOML or JSON has (tables in tables, dates, null, ...) is refused, with its line. What keys mean is the
 * reader's affair (job.c). */
#ifndef LAVES_CLI_JOB_FILE_H
#define LAVES_CLI_JOB_FILE_H

#include <stdbool.h>
#include <stddef.h>

enum { JOB_BYTES_MAX = 1 << 20, JOB_ITEMS_MAX = 64 /* of an array */ };

typedef enum job_kind { JOB_TEXT, JOB_NUMBER, JOB_TRUE, JOB_FALSE, JOB_ARRAY } job_kind;

/* One line of a job. The texts are UTF-8 without control characters, numbers as they were written but for underscores; they hold
 * during the call only. */
typedef struct job_entry {
  const char *table; /* "": none */
  const char *key;
  int line; /* from 1 */
  job_kind kind;
  const char *items[JOB_ITEMS_MAX]; /* the text or number; or those of the array */
  bool is_text[JOB_ITEMS_MAX];
  int count; /* 0 for TRUE and FALSE */
} job_entry;

/* What is wrong, and where; line 0: nowhere. */
typedef struct job_error {
  int line;
  char text[200];
} job_error;

/* Takes an entry; false: the error has been filled, but for its line, and reading ends. */
typedef bool job_take_fn(void *user, const job_entry *entry, job_error *error);

/* Reads a job, JSON where it begins with a brace, and hands over its entries in order. Time and memory grow with the length.
 * @param bytes  [length], any
 * @return false: the error says why; without memory its text is empty */
bool job_file_parse(const char *bytes, size_t length, job_take_fn *take, void *user, job_error *error);

#endif
