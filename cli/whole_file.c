/* A file of the program's own, JSON or a picture: it appears whole or not at all.
 *
 * As the library does with meshes: the temporary file has a short name of its own and is made only where no file of that name
 * is, a link is followed to what it stands for, and what the caller has open already is written directly, for nothing that
 * takes its place would reach him. */
#include "whole_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { NAMES_TRIED = 1000 }; /* each is taken only by a file left over or in the making */

static bool is_descriptor(const char *path) {
  return strncmp(path, "/dev/std", 8) == 0 || strncmp(path, "/dev/fd/", 8) == 0 || strncmp(path, "/proc/", 6) == 0;
}

/* *mode: the permissions of a file that is there, or 0; *direct: there is something that must not be replaced. */
static bool find_target(whole_file *out, const char *path, mode_t *mode, bool *direct) {
  struct stat status;
  *mode = 0;
  *direct = false;
  if (strlen(path) >= sizeof out->target) {
    errno = ENAMETOOLONG;
    return false;
  }
  memcpy(out->target, path, strlen(path) + 1);
  if (stat(path, &status) != 0) return true;
  *direct = !S_ISREG(status.st_mode) || is_descriptor(path);
  *mode = status.st_mode & 0777;
  return *direct || (access(path, W_OK) == 0 && realpath(path, out->target));
}

static int open_temporary(whole_file *out, mode_t mode) {
  const char *slash = strrchr(out->target, '/');
  const int folder = slash ? (int)(slash - out->target) + 1 : 0;
  for (int i = 0; i < NAMES_TRIED; ++i) {
    const int length =
        snprintf(out->temporary, sizeof out->temporary, "%.*s.laves-%ld-%d.tmp", folder, out->target, (long)getpid(), i);
    if (length < 0 || (size_t)length >= sizeof out->temporary) {
      errno = ENAMETOOLONG;
      return -1;
    }
    const int descriptor = open(out->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0 && mode) (void)fchmod(descriptor, mode);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
  return -1;
}

/* Opening does not wait for someone to read from a pipe; writing does. */
static int open_direct(const char *path) {
  const int descriptor = open(path, O_WRONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0 || fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) & ~O_NONBLOCK) >= 0) return descriptor;
  const int reason = errno;
  close(descriptor);
  errno = reason;
  return -1;
}

bool whole_file_open(whole_file *out, const char *path) {
  mode_t mode;
  bool direct;
  *out = (whole_file){0};
  if (!find_target(out, path, &mode, &direct)) return false;
  const int descriptor = direct ? open_direct(path) : open_temporary(out, mode);
  out->file = descriptor >= 0 ? fdopen(descriptor, "wb") : NULL;
  if (out->file) return true;
  const int reason = errno;
  if (descriptor >= 0) {
    close(descriptor);
    if (!direct) unlink(out->temporary);
  }
  errno = reason;
  return false;
}

bool whole_file_close(whole_file *out, bool right) {
  right = right && !ferror(out->file);
  int reason = errno;
  if (fclose(out->file) != 0 && right) {
    reason = errno;
    right = false;
  }
  if (right && out->temporary[0] && rename(out->temporary, out->target) != 0) {
    reason = errno;
    right = false;
  }
  if (!right && out->temporary[0]) unlink(out->temporary);
  errno = reason;
  return right;
}
