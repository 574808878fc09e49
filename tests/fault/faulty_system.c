/* System calls of the library that fail on demand.  The linker sends calls of write() to __wrap_write(), and those of
 * __real_write() to write(); it sees to the library, which is linked statically, and to nothing within the C library.
 *
 * Only files opened for writing are counted, so that reading goes on as ever. */
#define _GNU_SOURCE /* O_DIRECT; NOLINT(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): the C library's name */
#include "fault/faulty_system.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdint.h>
#include <sys/types.h>
#include <unistd.h>

faulty_system faulty = {.room = SIZE_MAX};
bool faulty_tiny_machine;
const char *const faulty_call_names[FAULTY_CALL_COUNT] = {"open", "write", "close", "rename", "link"};

int __real_open(const char *path, int flags, ...);
ssize_t __real_write(int file, const void *bytes, size_t count);
ssize_t __real_pwrite(int file, const void *bytes, size_t count, off_t place);
int __real_close(int file);
int __real_rename(const char *from, const char *to);
int __real_link(const char *from, const char *to);
long __real_sysconf(int name);
int __wrap_open(const char *path, int flags, ...);
ssize_t __wrap_write(int file, const void *bytes, size_t count);
ssize_t __wrap_pwrite(int file, const void *bytes, size_t count, off_t place);
int __wrap_close(int file);
int __wrap_rename(const char *from, const char *to);
int __wrap_link(const char *from, const char *to);
long __wrap_sysconf(int name);

void faulty_reset(void) { faulty = (faulty_system){.room = SIZE_MAX}; }

static bool fails(faulty_call call) {
  const bool now = ++faulty.calls[call] == faulty.fails_at && call == faulty.call;
  if (now) errno = faulty.reason;
  return now;
}

int __wrap_open(const char *path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = flags & O_CREAT ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  if (flags & O_CREAT && fails(FAULTY_OPEN)) return -1;
  return __real_open(path, flags, mode);
}

/* How many of `count` bytes a write may take: -1: it fails. */
static ssize_t room_for_write(size_t count) {
  enum { DRIBBLE = 5 };
  if (fails(FAULTY_WRITE)) return -1;
  if (faulty.dribbles && faulty.calls[FAULTY_WRITE] % 2) {
    errno = EINTR;
    return -1;
  }
  if (faulty.dribbles && count > DRIBBLE) count = DRIBBLE;
  if (faulty.room == 0 && count > 0) {
    errno = ENOSPC;
    return -1;
  }
  return (ssize_t)(count < faulty.room ? count : faulty.room);
}

static ssize_t fill_room(ssize_t done) {
  if (faulty.room != SIZE_MAX && done > 0) faulty.room -= (size_t)done;
  return done;
}

ssize_t __wrap_write(int file, const void *bytes, size_t count) {
  const ssize_t part = room_for_write(count);
  return part < 0 ? -1 : fill_room(__real_write(file, bytes, (size_t)part));
}

ssize_t __wrap_pwrite(int file, const void *bytes, size_t count, off_t place) {
  if (fcntl(file, F_GETFL) & O_DIRECT) faulty.uncached++;
  const ssize_t part = room_for_write(count);
  return part < 0 ? -1 : fill_room(__real_pwrite(file, bytes, (size_t)part, place));
}

/* A close that fails has closed the file all the same, as Linux does. */
int __wrap_close(int file) {
  const int result = __real_close(file);
  return fails(FAULTY_CLOSE) ? -1 : result;
}

int __wrap_rename(const char *from, const char *to) { return fails(FAULTY_RENAME) ? -1 : __real_rename(from, to); }

int __wrap_link(const char *from, const char *to) { return fails(FAULTY_LINK) ? -1 : __real_link(from, to); }

long __wrap_sysconf(int name) { return faulty_tiny_machine && name == _SC_PHYS_PAGES ? 1 : __real_sysconf(name); }
