/* Files in.  The file is opened without waiting (a pipe without a writer would hold us for ever), judged by what was
 * opened rather than by its name, and read in one piece.
 *
 * Pipes come in pieces, of which nobody knows how many: the block grows, up to a bound, and between pieces we wait a tenth of
 * a second at most before the progress is asked again. */
#include "io/file.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
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

static laves_result fail_shorter(const char *path, laves_error *error) {
  return laves__fail(error, LAVES_ERROR_INPUT, "%s: the file became shorter while it was read; try again", path);
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
      return fail_shorter(path, error);
    }
    done += (size_t)got;
  }
  bytes[length] = 0;
  return LAVES_OK;
}

/* ---- regular files ---- */

static laves_result read_regular(laves_context *context, int file, const struct stat *status, const char *path, char **bytes,
                                 size_t *length, laves_error *error) {
  const size_t size = (size_t)status->st_size;
  *bytes = laves__alloc(context, size + 1, 1);
  if (*bytes == NULL) return laves__fail_memory(context, error);
  const laves_result result = read_all(context, file, path, *bytes, size, error);
  if (result == LAVES_OK) {
    *length = size;
    return LAVES_OK;
  }
  laves__free(context, *bytes, size + 1, 1);
  *bytes = NULL;
  return result;
}

/* ---- pipes ---- */

enum { POLL_MILLISECONDS = 100, PATIENCE = 10 };

/* Bytes that grow; one more than `used` always has room. */
typedef struct block {
  char *bytes;
  size_t capacity, used;
  int waits; /* for a first writer */
} block;

/* Waits until the pipe has something or is closed, or a cancel is asked for. */
static laves_result wait_for_pipe(laves_context *context, int file, const char *path, laves_error *error) {
  struct pollfd one = {.fd = file, .events = POLLIN};
  if (laves__cancelled(context, "reading", 0)) return laves__fail_cancelled(error);
  if (poll(&one, 1, POLL_MILLISECONDS) < 0 && errno != EINTR) return fail_errno(error, path, "wait for");
  return LAVES_OK;
}

/* Who writes to a named pipe may come a little later than we do. */
static laves_result wait_for_writer(laves_context *context, laves_error *error) {
  if (laves__cancelled(context, "reading", 0)) return laves__fail_cancelled(error);
  poll(NULL, 0, POLL_MILLISECONDS);
  return LAVES_OK;
}

static laves_result read_piece(laves_context *context, int file, const char *path, block *b, bool *ended, laves_error *error) {
  if (!laves__grow(context, &b->bytes, &b->capacity, b->used + 65536, 1)) return laves__fail_memory(context, error);
  const ssize_t got = read(file, b->bytes + b->used, b->capacity - 1 - b->used);
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return wait_for_pipe(context, file, path, error);
  if (got < 0) return fail_errno(error, path, "read");
  if (got == 0 && b->used == 0 && b->waits++ < PATIENCE) return wait_for_writer(context, error);
  *ended = got == 0;
  b->used += (size_t)got;
  if (b->used > LAVES__PIPE_BYTES)
    return laves__fail(error, LAVES_ERROR_INPUT, "%s: the pipe gives more than %zu bytes; save them as a file and give that",
                       path, LAVES__PIPE_BYTES);
  return LAVES_OK;
}

static laves_result read_pipe(laves_context *context, int file, const char *path, char **bytes, size_t *length,
                              laves_error *error) {
  block b = {0};
  bool ended = false;
  laves_result result = LAVES_OK;
  while (result == LAVES_OK && !ended) result = read_piece(context, file, path, &b, &ended, error);
  if (result == LAVES_OK && b.used == 0)
    result = laves__fail(error, LAVES_ERROR_INPUT, "%s: the pipe is empty; nothing writes to it", path);
  char *fitting = result == LAVES_OK ? laves__realloc(context, b.bytes, b.capacity, b.used + 1, 1) : NULL;
  if (result == LAVES_OK && fitting == NULL) result = laves__fail_memory(context, error);
  if (result != LAVES_OK) {
    laves__free(context, b.bytes, b.capacity, 1);
    return result;
  }
  fitting[b.used] = 0;
  *bytes = fitting;
  *length = b.used;
  return LAVES_OK;
}

/* ---- both ---- */

static laves_result fail_kind(const struct stat *status, const char *path, laves_error *error) {
  return laves__fail(error, LAVES_ERROR_INPUT, "%s is %s; give a regular file", path, kind_of(status->st_mode));
}

/* Opens whatever it is; the caller closes it after success only. */
static laves_result open_path(const char *path, int *file, struct stat *status, laves_error *error) {
  *file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  if (*file < 0 && errno == ENXIO) return laves__fail(error, LAVES_ERROR_INPUT, "%s is a socket; give a regular file", path);
  if (*file < 0) return fail_errno(error, path, "open");
  if (fstat(*file, status) == 0) return LAVES_OK;
  const laves_result result = fail_errno(error, path, "read");
  close(*file);
  return result;
}

static laves_result read_path(laves_context *context, const char *path, bool may_be_pipe, char **bytes, size_t *length,
                              laves_error *error) {
  *bytes = NULL;
  *length = 0;
  int file;
  struct stat status = {0};
  laves_result result = open_path(path, &file, &status, error);
  if (result != LAVES_OK) return result;
  if (S_ISREG(status.st_mode))
    result = read_regular(context, file, &status, path, bytes, length, error);
  else if (S_ISFIFO(status.st_mode) && may_be_pipe)
    result = read_pipe(context, file, path, bytes, length, error);
  else
    result = fail_kind(&status, path, error);
  close(file);
  return result;
}

laves_result laves__file_read(laves_context *context, const char *path, char **bytes, size_t *length, laves_error *error) {
  return read_path(context, path, false, bytes, length, error);
}

laves_result laves__input_read(laves_context *context, const char *path, char **bytes, size_t *length, laves_error *error) {
  return read_path(context, path, true, bytes, length, error);
}

/* ---- ranges ---- */

laves_result laves__ranged_file_open(laves__ranged_file *ranged, const char *path, laves_error *error) {
  struct stat status = {0};
  *ranged = (laves__ranged_file){.path = path, .file = -1};
  laves_result result = open_path(path, &ranged->file, &status, error);
  if (result != LAVES_OK) return result;
  ranged->bytes = (uint64_t)status.st_size;
  if (S_ISREG(status.st_mode)) return LAVES_OK;
  result = fail_kind(&status, path, error);
  laves__ranged_file_close(ranged);
  return result;
}

laves_result laves__ranged_file_read(const laves__ranged_file *ranged, uint64_t offset, void *bytes, size_t count,
                                     laves_error *error) {
  for (size_t done = 0; done < count;) {
    const ssize_t got = pread(ranged->file, (char *)bytes + done, count - done, (off_t)(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail_errno(error, ranged->path, "read");
    if (got == 0) return fail_shorter(ranged->path, error);
    done += (size_t)got;
  }
  return LAVES_OK;
}

void laves__ranged_file_close(laves__ranged_file *ranged) {
  if (ranged->file >= 0) close(ranged->file);
  ranged->file = -1;
}
