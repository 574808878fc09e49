/* A file of the program's own, JSON or a picture: it appears whole or not at all. */
#ifndef LAVES_CLI_WHOLE_FILE_H
#define LAVES_CLI_WHOLE_FILE_H

#include <limits.h>
#include <stdbool.h>
#include <stdio.h>

typedef struct whole_file {
  FILE *file;
  char target[PATH_MAX];
  char temporary[PATH_MAX]; /* empty: a device, a pipe or an open descriptor, which is written directly */
} whole_file;

/* Opens a temporary file beside the target, whose permissions it takes. False when it cannot be made; errno tells why. */
bool whole_file_open(whole_file *out, const char *path);

/* Closes it and gives it its name, or removes it where it is not `right` or cannot be written to its end. False then; errno
 * tells why. */
bool whole_file_close(whole_file *out, bool right);

#endif
