/* A file being written: it appears whole or not at all.
 *
 * Where the file system can (Linux's O_TMPFILE) the temporary file has no name until it is complete, so that nothing of it is
 * left when the program is killed. Else, and when it is published, it has a short name of its own (not the target's with
 * something added, which could get too long), which no other file has, so two programs writing to one folder do not meet. A
 * target that is a symbolic link is followed, and an existing target's permissions are kept. Nothing is synced to the disk: a
 * crash of the machine is not what "whole or not at all" is about.
 *
 * Items are formatted by all threads in waves: every block of a wave has a slot of its own in one scratch block, and the
 * slots are written in order when the wave is done, so the bytes do not depend on the number of threads. Rows, all of one length,
 * have a file of their own: output_rows.c. */
#define _GNU_SOURCE /* O_TMPFILE; NOLINT(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): the C library's name */
#include "io/output.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
  BUFFER_BYTES = 1 << 20,
  PIECE_BYTES = 4 << 20,  /* written between two questions whether to cancel */
  SLOT_BYTES = 1 << 18,   /* room for one block's text: big enough to make threads worth while, small enough for caches */
  SLOTS_PER_WORKER = 4,   /* evens out blocks of different cost */
  TEMPORARY_TRIES = 1000, /* names tried before giving up; each is taken only by a file left over or in the making */
};

static const char phase[] = "write";
static const char temporary_ending[] = ".part", kept_ending[] = ".kept"; /* equally long */

void laves__output_fail(laves__output *out, laves_result result, const char *format, ...) {
  if (out->error.result != LAVES_OK) return;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(out->error.text, sizeof out->error.text, format, arguments);
  va_end(arguments);
  out->error.result = result;
}

/* NOLINTNEXTLINE(concurrency-mt-unsafe): threads share at most the text of an unknown number. */
static const char *system_text(void) { return strerror(errno); }

void laves__output_fail_system(laves__output *out, const char *what, const char *path) {
  laves__output_fail(out, LAVES_ERROR_WRITE, "cannot %s '%s': %s", what, path, system_text());
}

void laves__output_fail_memory(laves__output *out) {
  if (out->error.result == LAVES_OK) laves__fail_memory(out->context, &out->error);
}

/* Names of what the caller has open already: replacing what they stand for would not reach it. */
static bool is_descriptor(const char *path) {
  return strncmp(path, "/dev/std", 8) == 0 || strncmp(path, "/dev/fd/", 8) == 0 || strncmp(path, "/proc/", 6) == 0;
}

/* Sets target to the path with symbolic links followed, and says whether to write it directly. */
static void find_target(laves__output *out, const char *path, mode_t *mode) {
  if (strlen(path) >= sizeof out->target) {
    laves__output_fail(out, LAVES_ERROR_WRITE, "cannot write: the file name is longer than %d bytes", PATH_MAX - 1);
    return;
  }
  if (!path[0]) laves__output_fail(out, LAVES_ERROR_WRITE, "cannot write: there is no file name");
  memcpy(out->target, path, strlen(path) + 1);
  struct stat info;
  if (stat(path, &info) != 0) return;
  if (S_ISDIR(info.st_mode)) {
    laves__output_fail(out, LAVES_ERROR_WRITE, "cannot write '%s': it is a folder; give the name of a file", path);
    return;
  }
  out->direct = !S_ISREG(info.st_mode) || is_descriptor(path);
  *mode = info.st_mode & 0777;
  if (out->direct) return;
  if (access(path, W_OK) != 0)
    laves__output_fail_system(out, "replace", path);
  else if (!realpath(path, out->target))
    laves__output_fail_system(out, "find", path);
}

/* Length of the target's path up to and with the last slash. */
static int folder_length(const laves__output *out) {
  const char *slash = strrchr(out->target, '/');
  return slash ? (int)(slash - out->target) + 1 : 0;
}

/* Makes a name for the temporary file, by `make`, which sets errno and returns false where it can't. */
static void name_temporary(laves__output *out, bool (*make)(laves__output *out)) {
  for (int i = 0; i < TEMPORARY_TRIES; i++) {
    const int length = snprintf(out->temporary, sizeof out->temporary, "%.*s.laves-%ld-%d%s", folder_length(out), out->target,
                                (long)getpid(), i, temporary_ending);
    if (length >= (int)sizeof out->temporary) break;
    if (make(out)) return;
    if (errno != EEXIST) break;
  }
  laves__output_fail(out, LAVES_ERROR_WRITE, "cannot write '%s': no file can be made in its folder: %s", out->target,
                     system_text());
  out->temporary[0] = 0;
}

static bool make_file(laves__output *out) {
  out->file = open(out->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  return out->file >= 0;
}

#ifdef O_TMPFILE
static void path_of_descriptor(const laves__output *out, char path[40]) { snprintf(path, 40, "/proc/self/fd/%d", out->file); }

static bool link_file(laves__output *out) {
  char path[40];
  path_of_descriptor(out, path);
  return linkat(AT_FDCWD, path, AT_FDCWD, out->temporary, AT_SYMLINK_FOLLOW) == 0;
}

/* Opens a file without a name; only where it can be given one later, for which /proc is needed. */
static void open_nameless(laves__output *out) {
  char path[PATH_MAX];
  const int length = folder_length(out);
  snprintf(path, sizeof path, "%.*s", length ? length : 1, length ? out->target : ".");
  out->file = open(path, O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  if (out->file < 0) return;
  path_of_descriptor(out, path);
  if (access(path, F_OK) == 0) return;
  close(out->file);
  out->file = -1;
}
#else
static bool link_file(laves__output *out) { return out->file < 0; } /* never asked: all files have names */
static void open_nameless(laves__output *out) { out->file = -1; }
#endif

static void open_temporary(laves__output *out, mode_t mode) {
  open_nameless(out);
  if (out->file < 0) name_temporary(out, make_file);
  if (out->file >= 0 && mode) (void)fchmod(out->file, mode);
}

/* A pipe that nothing reads from would hold us for ever, so opening does not wait; writing does. */
static void open_direct(laves__output *out) {
  out->file = open(out->target, O_WRONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (out->file < 0 || fcntl(out->file, F_SETFL, fcntl(out->file, F_GETFL) & ~O_NONBLOCK) < 0)
    laves__output_fail_system(out, "write", out->target);
}

/* What the system would hold back of a file: Linux lets a fifth of the memory wait for the disk (vm.dirty_ratio). */
static double held_back(void) {
  const double pages = (double)sysconf(_SC_PHYS_PAGES), page_bytes = (double)sysconf(_SC_PAGESIZE);
  return pages > 0 && page_bytes > 0 ? pages * page_bytes / 5 : HUGE_VAL;
}

laves_result laves__output_open(laves__output *out, laves_context *context, const char *path) {
  memset(out, 0, sizeof *out);
  out->context = context;
  out->uncached_from = held_back();
  out->file = -1;
  mode_t mode = 0;
  find_target(out, path, &mode);
  if (out->error.result != LAVES_OK) return out->error.result;
  out->buffer = laves__alloc(context, BUFFER_BYTES, 1);
  if (!out->buffer) {
    laves__output_fail_memory(out);
  } else if (out->direct) {
    open_direct(out);
  } else {
    open_temporary(out, mode);
  }
  return out->error.result;
}

void laves__output_ask_cancel(laves__output *out) {
  const double done_part = out->expected > (double)out->written ? (double)out->written / out->expected : 1;
  if (laves__cancelled(out->context, phase, out->prepared + (1 - out->prepared) * done_part)) laves__fail_cancelled(&out->error);
}

static void write_through(laves__output *out, const char *bytes, size_t count) {
  while (count > 0 && out->error.result == LAVES_OK) {
    laves__output_ask_cancel(out);
    if (out->error.result != LAVES_OK) return;
    const ssize_t done = write(out->file, bytes, count < PIECE_BYTES ? count : PIECE_BYTES);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) {
      if (done == 0) errno = ENOSPC; /* a device that takes nothing more */
      laves__output_fail_system(out, "write", out->target);
      return;
    }
    bytes += done;
    count -= (size_t)done;
    out->written += (uint64_t)done;
  }
}

void laves__output_flush(laves__output *out) {
  out->written -= out->used; /* write_through counts them again */
  write_through(out, out->buffer, out->used);
  out->used = 0;
}

uint64_t laves__output_seek(laves__output *out, uint64_t place) {
  LAVES_ASSERT(!out->direct);
  laves__output_flush(out);
  const uint64_t before = out->written;
  if (out->error.result != LAVES_OK) return before;
  if (lseek(out->file, (off_t)place, SEEK_SET) < 0) laves__output_fail_system(out, "write", out->target);
  out->written = place;
  return before;
}

void laves__output_bytes(laves__output *out, const void *bytes, size_t count) {
  if (out->error.result != LAVES_OK || count == 0) return;
  if (count > BUFFER_BYTES - out->used) laves__output_flush(out);
  if (out->error.result != LAVES_OK) return;
  if (count >= BUFFER_BYTES) {
    write_through(out, bytes, count);
    return;
  }
  memcpy(out->buffer + out->used, bytes, count);
  out->used += count;
  out->written += count;
}

void laves__output_printf(laves__output *out, const char *format, ...) {
  char text[1000];
  va_list arguments;
  va_start(arguments, format);
  const int length = vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  LAVES_ASSERT(length >= 0 && (size_t)length < sizeof text);
  laves__output_bytes(out, text, (size_t)length);
}

typedef struct wave {
  laves__output_items_fn *fn;
  const void *user;
  size_t first, count, per_slot; /* the items of this wave */
  char *slots;
  size_t *lengths;
} wave;

/* Each slot and its length is written by one thread only: the one that got the slot's index. */
static void format_slots(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const wave *w = user;
  for (size_t slot = begin; slot < end; slot++) {
    const size_t first = slot * w->per_slot;
    const size_t last = first + w->per_slot < w->count ? first + w->per_slot : w->count;
    w->lengths[slot] = w->fn(w->user, w->first + first, w->first + last, w->slots + slot * SLOT_BYTES);
    LAVES_ASSERT(w->lengths[slot] <= SLOT_BYTES);
  }
}

void laves__output_items(laves__output *out, size_t count, size_t item_bytes, laves__output_items_fn *fn, const void *user) {
  LAVES_ASSERT(item_bytes > 0 && item_bytes <= SLOT_BYTES);
  if (out->error.result != LAVES_OK || count == 0) return;
  wave w = {.fn = fn, .user = user, .per_slot = SLOT_BYTES / item_bytes};
  const size_t slots_needed = (count + w.per_slot - 1) / w.per_slot;
  size_t slots = (size_t)laves__workers(out->context) * SLOTS_PER_WORKER;
  if (slots > slots_needed) slots = slots_needed;
  w.slots = laves__alloc(out->context, slots, SLOT_BYTES);
  w.lengths = laves__alloc(out->context, slots, sizeof *w.lengths);
  if (!w.slots || !w.lengths) laves__output_fail_memory(out);
  for (; w.first < count && out->error.result == LAVES_OK; w.first += w.count) {
    w.count = count - w.first < slots * w.per_slot ? count - w.first : slots * w.per_slot;
    const size_t used = (w.count + w.per_slot - 1) / w.per_slot;
    if (!laves__parallel_for(out->context, NULL, used, 1, format_slots, &w)) laves__fail_cancelled(&out->error);
    for (size_t i = 0; i < used && out->error.result == LAVES_OK; i++)
      laves__output_bytes(out, w.slots + i * SLOT_BYTES, w.lengths[i]);
  }
  laves__free(out->context, w.slots, slots, SLOT_BYTES);
  laves__free(out->context, w.lengths, slots, sizeof *w.lengths);
}

laves_result laves__output_complete(laves__output *out) {
  if (out->error.result == LAVES_OK) laves__output_flush(out);
  if (out->error.result == LAVES_OK && !out->direct && !out->temporary[0]) name_temporary(out, link_file);
  if (out->file >= 0 && close(out->file) != 0) laves__output_fail_system(out, "write", out->target);
  out->file = -1;
  return out->error.result;
}

laves_result laves__output_publish(laves__output *out) {
  if (out->error.result != LAVES_OK || out->direct) return out->error.result;
  if (rename(out->temporary, out->target) != 0)
    laves__output_fail_system(out, "write", out->target);
  else
    out->temporary[0] = 0;
  return out->error.result;
}

/* ---- several files that are one ---- */

/* Gives the file at the target a second name, to be brought back from. */
static void keep_old(laves__output *out) {
  if (out->direct) return;
  const size_t length = strlen(out->temporary) - strlen(temporary_ending);
  memcpy(out->kept, out->temporary, length);
  memcpy(out->kept + length, kept_ending, sizeof kept_ending);
  const bool kept = link(out->target, out->kept) == 0;
  out->can_undo = kept || errno == ENOENT;
  if (!kept) out->kept[0] = 0;
}

static void bring_back(laves__output *out) {
  if (!out->can_undo) return;
  if (out->kept[0])
    rename(out->kept, out->target);
  else
    unlink(out->target);
}

laves_result laves__output_publish_all(laves__output *outs, int count) {
  laves_result result = LAVES_OK;
  int published = 0;
  for (int i = 0; i < count; i++) keep_old(&outs[i]);
  while (published < count && result == LAVES_OK) {
    result = laves__output_publish(&outs[published]);
    if (result == LAVES_OK) published++;
  }
  for (int i = 0; i < published && result != LAVES_OK; i++) bring_back(&outs[i]);
  for (int i = 0; i < count; i++)
    if (outs[i].kept[0]) unlink(outs[i].kept); /* gone already where it was brought back */
  return result;
}

void laves__output_discard(laves__output *out) {
  if (out->file >= 0) close(out->file);
  out->file = -1;
  if (out->temporary[0]) unlink(out->temporary);
  out->temporary[0] = 0;
  laves__free(out->context, out->buffer, BUFFER_BYTES, 1);
  out->buffer = NULL;
}
