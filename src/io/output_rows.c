/* Rows: items of one length. Their places in the file are known, so all threads format and write at once, each its own pieces.
 *
 *       |<------------------------- rows ------------------------->|
 *   ... | head | piece | piece | piece | piece |   ...   |  | tail | ...    the file
 *              ^ ends of sectors                            ^
 *
 * What the system could not hold back for later anyway is written past its cache (O_DIRECT): copying into the cache and searching
 * memory for it cost more than a fast disk does, and then leave nothing of it that anyone reads again. That takes whole sectors
 * only, so pieces are cut between bytes; a row that two pieces share is formatted for both. Head and tail, each less than a
 * sector, go through the cache, as does all where the file system wants it so. */
#define _GNU_SOURCE /* O_DIRECT; NOLINT(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): the C library's name */
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

#include "io/output.h"

enum {
  ROW_BYTES_MAX = 1 << 18,
  PIECE_BYTES = 1 << 20, /* one call of the system */
  SECTOR_BYTES = 4096,   /* of the disk, and a page: larger than all but few have */
  REPORT_PIECES = 16,    /* between two reports of progress */
};

typedef struct rows {
  laves__output *out;
  laves__output_items_fn *fn;
  const void *user;
  size_t row_bytes, piece_bytes;
  uint64_t place;      /* of the first row in the file */
  uint64_t begin, end; /* bytes that are being written, counted from the first row */
  char *slots;         /* one for each worker, each at a multiple of SECTOR_BYTES */
  size_t slot_bytes;
  atomic_int fault;        /* errno of the first write that failed */
  pthread_mutex_t writing; /* the system lets one in at a time, and has the others spin */
} rows;

static uint64_t least(uint64_t a, uint64_t b) { return a < b ? a : b; }
static uint64_t sectors_down(uint64_t bytes) { return bytes - bytes % SECTOR_BYTES; }
static uint64_t sectors_up(uint64_t bytes) { return sectors_down(bytes + SECTOR_BYTES - 1); }

/* Writes all of some bytes at a place of the file; returns 0 or errno. */
static int write_at(int file, const char *bytes, size_t count, uint64_t place) {
  while (count > 0) {
    const ssize_t done = pwrite(file, bytes, count, (off_t)place);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return done == 0 ? ENOSPC : errno;
    bytes += done;
    count -= (size_t)done;
    place += (uint64_t)done;
  }
  return 0;
}

/* Formats the rows that have bytes [from, to), and writes these. */
static int write_piece(rows *r, uint64_t from, uint64_t to, char *slot) {
  const size_t first = (size_t)(from / r->row_bytes), last = (size_t)((to - 1) / r->row_bytes) + 1;
  const size_t skip = (size_t)(from - (uint64_t)first * r->row_bytes), count = (size_t)(to - from);
  const size_t made = r->fn(r->user, first, last, slot);
  LAVES_ASSERT(made == (last - first) * r->row_bytes && made <= r->slot_bytes);
  (void)made;
  if (skip > 0) memmove(slot, slot + skip, count);
  pthread_mutex_lock(&r->writing);
  const int fault = write_at(r->out->file, slot, count, r->place + from);
  pthread_mutex_unlock(&r->writing);
  return fault;
}

static void write_pieces(void *user, size_t begin, size_t end, int worker) {
  rows *r = user;
  for (size_t i = begin; i < end && atomic_load(&r->fault) == 0; i++) {
    const uint64_t from = r->begin + (uint64_t)i * r->piece_bytes, to = least(from + r->piece_bytes, r->end);
    const int fault = write_piece(r, from, to, r->slots + (size_t)worker * r->slot_bytes);
    int none = 0;
    if (fault) atomic_compare_exchange_strong(&r->fault, &none, fault);
  }
}

/* Writes bytes [begin, end) of the rows; returns 0, or errno of a write that failed. A cancel is told to the output. */
static int write_bytes(rows *r, uint64_t begin, uint64_t end) {
  laves__output *out = r->out;
  for (r->begin = begin; r->begin < end; r->begin = r->end) {
    r->end = least(end, r->begin + (uint64_t)REPORT_PIECES * r->piece_bytes);
    laves__output_ask_cancel(out);
    if (out->error.result != LAVES_OK) return 0;
    const size_t pieces = (size_t)((r->end - r->begin - 1) / r->piece_bytes) + 1;
    if (!laves__parallel_for(out->context, NULL, pieces, 1, write_pieces, r)) {
      laves__fail_cancelled(&out->error);
      return 0;
    }
    const int fault = atomic_exchange(&r->fault, 0);
    if (fault) return fault;
    out->written += r->end - r->begin;
  }
  return 0;
}

/* Has the file's writes go past the cache, or through it again; false where that can't be. */
static bool pass_cache(const laves__output *out, bool past) {
#ifdef O_DIRECT
  const int flags = fcntl(out->file, F_GETFL);
  return flags >= 0 && fcntl(out->file, F_SETFL, past ? flags | O_DIRECT : flags & ~O_DIRECT) == 0;
#else
  (void)out;
  return !past;
#endif
}

/* Writes [*begin, *end), the whole sectors of the rows, past the cache; makes it nothing where it is not to be written so. */
static int write_past_cache(rows *r, uint64_t bytes, uint64_t *begin, uint64_t *end) {
  laves__output *out = r->out;
  *begin = sectors_up(r->place) - r->place;
  *end = sectors_down(r->place + bytes) - least(r->place, sectors_down(r->place + bytes));
  const bool wanted = out->expected > out->uncached_from && *begin < *end;
  if (!wanted || !pass_cache(out, true)) {
    *begin = *end = 0;
    return 0;
  }
  r->piece_bytes = PIECE_BYTES;
  int fault = write_bytes(r, *begin, *end);
  if (!pass_cache(out, false) && fault == 0) fault = errno;
  if (fault != EINVAL) return fault;
  /* Sectors of another size, or part of one after a short write: once more through the cache, which knows what is wrong. */
  out->written = r->place;
  *begin = *end = 0;
  return 0;
}

static void write_rows(rows *r, uint64_t bytes) {
  laves__output *out = r->out;
  uint64_t begin = 0, end = 0; /* what is written already */
  int fault = write_past_cache(r, bytes, &begin, &end);
  r->piece_bytes = PIECE_BYTES / r->row_bytes * r->row_bytes;
  if (fault == 0) fault = write_bytes(r, 0, begin);
  if (fault == 0) fault = write_bytes(r, end, bytes);
  errno = fault;
  if (fault) laves__output_fail_system(out, "write", out->target);
  laves__output_seek(out, out->written);
}

void laves__output_rows(laves__output *out, size_t count, size_t row_bytes, laves__output_items_fn *fn, const void *user) {
  LAVES_ASSERT(row_bytes > 0 && row_bytes <= ROW_BYTES_MAX);
  if (out->direct) {
    laves__output_items(out, count, row_bytes, fn, user);
    return;
  }
  laves__output_flush(out);
  if (out->error.result != LAVES_OK || count == 0) return;
  const size_t workers = (size_t)laves__workers(out->context);
  rows r = {.out = out, .fn = fn, .user = user, .row_bytes = row_bytes, .place = out->written};
  r.slot_bytes = (size_t)sectors_up(PIECE_BYTES + 2 * row_bytes);
  atomic_init(&r.fault, 0);
  pthread_mutex_init(&r.writing, NULL);
  char *room = laves__alloc(out->context, workers * r.slot_bytes + SECTOR_BYTES, 1);
  if (room) {
    r.slots = room + (SECTOR_BYTES - (uintptr_t)room % SECTOR_BYTES) % SECTOR_BYTES;
    write_rows(&r, (uint64_t)count * row_bytes);
  } else {
    laves__output_fail_memory(out);
  }
  laves__free(out->context, room, workers * r.slot_bytes + SECTOR_BYTES, 1);
  pthread_mutex_destroy(&r.writing);
}
