/* Whole files in and out: reading with a limit, writing that appears whole or not at all. */
#ifndef LAVES_IO_FILE_H
#define LAVES_IO_FILE_H

#include "base/base.h"

/* Reads a regular file into one block of *length + 1 bytes (a NUL follows the content). Directories, devices, pipes and
 * sockets are refused with a sentence. Free with laves__free(context, *bytes, *length + 1, 1). */
laves_result laves__file_read(laves_context *context, const char *path, char **bytes, size_t *length, laves_error *error);

#endif
