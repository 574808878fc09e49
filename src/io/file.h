/* Whole files in and out: reading with a limit, writing that appears whole or not at all. */
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

#endif
