/* Whole files in.  The file is opened without waiting (a pipe without a writer would hold us for ever), judged by what was
 * opened rather than by its name, and is read into one block. */
#include "io/file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PIECE_BYTES = 4 << 20 };

/* What a path that is not a regular file is called. */
static const char *kind_of(mode_t mode) {
  return S_ISDIR(mode) ? "a directory" : S_ISFIFO(mode) ? "a pipe" : S_ISSOCK(mode) ? "a socket" : "a device";
}

static laves_result fail_errno(laves_error *error, const char *path, const char *what) {
  char reason[120] = "unknown reason";
  strerror_r(errno, reason, sizeof reason);
  return laves__fail(error, LAVES_ERROR_INPUT, "%s: cannot %s the file: %s", path, what, reason);
}

/* Fills `bytes` from the file, which must hold `length` of them still, piece by piece: a disk may be slow. */
static laves_result read_all(laves_context *context, int file, const char *path, char *bytes, size_t length, laves_error *error) {
  for (size_t done = 0; done < length;) {
    if (laves__cancelled(context, "read", 0)) return laves__fail_cancelled(error);
    const ssize_t got = read(file, bytes + done, length - done < PIECE_BYTES ? length - done : PIECE_BYTES);
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got < 0) {
      return fail_errno(error, path, "read");
    }
    if (got == 0) {
      return laves__fail(error, LAVES_ERROR_INPUT, "%s: the file became shorter while it was read; try again", path);
    }
    done += (size_t)got;
  }
  bytes[length] = 0;
  return LAVES_OK;
}

laves_result laves__file_read(laves_context *context, const char *path, char **bytes, size_t *length, laves_error *error) {
  laves_result result = LAVES_OK;
  *bytes = NULL;
  *length = 0;
  const int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  if (file < 0) {
    return fail_errno(error, path, "open");
  }
  struct stat status;
  if (fstat(file, &status) != 0) {
    result = fail_errno(error, path, "read");
    goto done;
  }
  if (!S_ISREG(status.st_mode)) {
    result = laves__fail(error, LAVES_ERROR_INPUT, "%s is %s; give a regular file", path, kind_of(status.st_mode));
    goto done;
  }
  *length = (size_t)status.st_size;
  *bytes = laves__alloc(context, *length + 1, 1);
  result = *bytes == NULL ? laves__fail_memory(context, error) : read_all(context, file, path, *bytes, *length, error);
  if (result != LAVES_OK) {
    laves__free(context, *bytes, *length + 1, 1);
    *bytes = NULL;
    *length = 0;
  }
done:
  close(file);
  return result;
}
