/* A file being written: it appears whole or not at all.
 *
 *   laves__output_open -> laves__output_bytes, _items ... -> laves__output_complete -> laves__output_publish
 *
 * Bytes go to a temporary file in the target's folder, without a name where that can be, which publishing renames to the target.
 * Targets that are not regular files (devices, pipes) and open descriptors (/dev/stdout) are written directly. The first failure
 * sticks: later calls do nothing and the last one returns it, so writers need not look in between. laves__output_discard() ends
 * it at any point. */
#ifndef LAVES_IO_OUTPUT_H
#define LAVES_IO_OUTPUT_H

#include <limits.h>

#include "base/base.h"

typedef struct laves__output {
  laves_context *context;
  laves_error error; /* the first failure; LAVES_OK while there is none */
  int file;          /* -1: none open */
  bool direct;       /* no temporary file */
  char *buffer;
  size_t used;
  uint64_t written;     /* bytes so far, those in the buffer too */
  double expected;      /* about how many bytes there will be, for progress; set by the writer */
  double uncached_from; /* a file of which more is expected goes past the system's cache where it can; set by opening */
  double prepared;      /* the fraction of the work done before the first byte; set by the writer */
  char target[PATH_MAX];
  char temporary[PATH_MAX]; /* empty: no file has a name yet */
  char kept[PATH_MAX];      /* of several files that are published together: the older file's second name; empty: none */
  bool can_undo;            /* their publishing */
} laves__output;

/* Zeroes and opens; on failure the result is in out->error too and the other calls stay harmless. */
laves_result laves__output_open(laves__output *out, laves_context *context, const char *path);
void laves__output_bytes(laves__output *out, const void *bytes, size_t count);
void laves__output_printf(laves__output *out, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Writes the form of items [begin, end) at `bytes` and returns how many bytes that took. Called from many threads. */
typedef size_t laves__output_items_fn(const void *user, size_t begin, size_t end, char *bytes);
/* Formats items 0 .. count-1 in parallel blocks and writes them in order; each takes at most item_bytes. */
void laves__output_items(laves__output *out, size_t count, size_t item_bytes, laves__output_items_fn *fn, const void *user);

/* The same for items of exactly row_bytes each. Places in the file are known then, so regular files are written by all threads at
 * once, each its own part, and large ones past the system's cache. Rows may be formatted more than once. */
void laves__output_rows(laves__output *out, size_t count, size_t row_bytes, laves__output_items_fn *fn, const void *user);

/* Records a failure found by the writer itself; a printf sentence. */
void laves__output_fail(laves__output *out, laves_result result, const char *format, ...) __attribute__((format(printf, 3, 4)));
void laves__output_fail_memory(laves__output *out);
/* The same of what the system refused: "cannot WHAT 'PATH': errno's text". */
void laves__output_fail_system(laves__output *out, const char *what, const char *path);

/* Writes what is in the buffer. */
void laves__output_flush(laves__output *out);
/* Goes on at another place of a file that is not written directly; returns the place before. */
uint64_t laves__output_seek(laves__output *out, uint64_t place);
/* Reports progress; the error is set when that says to cancel. */
void laves__output_ask_cancel(laves__output *out);

/* Flushes, names and closes the temporary file. */
laves_result laves__output_complete(laves__output *out);
/* Renames it to the target. */
laves_result laves__output_publish(laves__output *out);
/* The same for files that are of use together only: when one cannot be renamed, the others' targets are as they were before. */
laves_result laves__output_publish_all(laves__output *outs, int count);
/* Frees everything and removes what is left of an unpublished file; after publishing only frees. */
void laves__output_discard(laves__output *out);

#endif
