/* Files in: whole with a limit, or by ranges. */
#ifndef LAVES_IO_FILE_H
#define LAVES_IO_FILE_H

#include "base/base.h"

/* Reads a regular file into one block of *length + 1 bytes (a NUL follows the content). Directories, devices, pipes and
 * sockets are refused with a sentence. Free with laves__free(context, *bytes, *length + 1, 1). */
laves_result laves__file_read(laves_context *context, const char *path, char **bytes, size_t *length, laves_error *error);

/* The same of a name that the user gave, which may also be a pipe: it is read to its end, and to LAVES__PIPE_BYTES at most. A
 * pipe to which nothing has written for a second is empty; while it is silent the progress is asked whether to go on. Names that
 * stand in files and scripts never come here. */
laves_result laves__input_read(laves_context *context, const char *path, char **bytes, size_t *length, laves_error *error);

#define LAVES__PIPE_BYTES ((size_t)1 << 30)

/* A regular file of which parts are read. It is never mapped into memory, so that one which becomes shorter meanwhile is an error
 * and not a signal. */
typedef struct laves__ranged_file {
  const char *path; /* the caller's */
  int file;
  uint64_t bytes; /* when it was opened */
} laves__ranged_file;

/* Close with laves__ranged_file_close() after success. */
laves_result laves__ranged_file_open(laves__ranged_file *ranged, const char *path, laves_error *error);
/* Bytes [offset, offset + count), which were in the file when it was opened. Any number of threads at once. */
laves_result laves__ranged_file_read(const laves__ranged_file *ranged, uint64_t offset, void *bytes, size_t count,
                                     laves_error *error);
void laves__ranged_file_close(laves__ranged_file *ranged);

#endif
