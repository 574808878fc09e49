/* What every file may use: assertions, the context's memory, threads and progress, errors.  Knows no other folder. */
#ifndef LAVES_BASE_BASE_H
#define LAVES_BASE_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "laves/laves.h"

/* A broken promise inside the library stops debug and validating builds; wrong data from outside never comes here. */
#ifdef LAVES_VALIDATE
#include <stdio.h>
#include <stdlib.h>
#define LAVES_ASSERT(condition)                                                       \
  do {                                                                                \
    if (!(condition)) {                                                               \
      fprintf(stderr, "%s:%d: broken promise: %s\n", __FILE__, __LINE__, #condition); \
      abort();                                                                        \
    }                                                                                 \
  } while (0)
#else
#define LAVES_ASSERT(condition) ((void)sizeof(condition))
#endif

#define LAVES__COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))

/* ---- memory: every block is counted against the context's limit ---- */

/* NULL when memory is short, over the limit, or count * size overflows. Contents undefined, or zero for _zeroed. */
void *laves__alloc(laves_context *context, size_t count, size_t size);
void *laves__alloc_zeroed(laves_context *context, size_t count, size_t size);
/* Old contents kept; on failure the old block stays valid and NULL is returned. old_count must be the true one. */
void *laves__realloc(laves_context *context, void *block, size_t old_count, size_t new_count, size_t size);
/* `count` and `size` must be those of the allocation. NULL is allowed. */
void laves__free(laves_context *context, void *block, size_t count, size_t size);

/* Makes room for `needed` items in a growing array: doubles, false when memory is short.
 * `block` is the address of the item pointer. */
bool laves__grow(laves_context *context, void *block, size_t *capacity, size_t needed, size_t size);

/* Whether so many bytes more can be within the limit: true where there is none. The number is an estimate that may be a quarter
 * too large, so what is refused could not have been. */
bool laves__may_fit(const laves_context *context, double bytes);
/* So many bytes fit beside what is held, even if they are an estimate that is a quarter too small. INFINITY: there is no limit.
 */
double laves__room(const laves_context *context);

/* ---- progress ---- */

/* Reports and asks: true when the caller wants to cancel; once cancelled it stays so until laves__progress_reset().
 * Call only from the thread that entered the library. `phase` is a static string, fraction in 0..1. */
bool laves__cancelled(laves_context *context, const char *phase, double fraction);
/* The same for item `index` of `count` of a loop whose turns take a microsecond at most: asks at some of them only. */
static inline bool laves__cancelled_at(laves_context *context, const char *phase, size_t index, size_t count) {
  enum { TURNS = 1 << 14 };
  return index % TURNS == 0 && laves__cancelled(context, phase, (double)index / (double)count);
}
/* Whether a cancel has been asked for; callable from any thread. */
bool laves__is_cancelled(const laves_context *context);
/* Forget an earlier cancel; at the start of each public call. */
void laves__progress_reset(laves_context *context);

/* ---- errors ---- */

/* Fills error (may be NULL) with result and a printf sentence, and returns result. */
laves_result laves__fail(laves_error *error, laves_result result, const char *format, ...) __attribute__((format(printf, 3, 4)));
void laves__tell_memory(const laves_context *context, laves_error *error);
void laves__tell_cancelled(laves_error *error);
/* These two are inline, so that compilers and analysers see that they never return LAVES_OK. */
static inline laves_result laves__fail_cancelled(laves_error *error) {
  laves__tell_cancelled(error);
  return LAVES_ERROR_CANCELLED;
}
/* The standard sentence for a step that could not be completed, when all that is known is that memory was short or a cancel cut
 * it off: after a cancel the result is that; else it is the memory, and the limit is told where there is one. */
static inline laves_result laves__fail_memory(const laves_context *context, laves_error *error) {
  if (laves__is_cancelled(context)) return laves__fail_cancelled(error);
  laves__tell_memory(context, error);
  return LAVES_ERROR_MEMORY;
}
/* That `bytes` more, an estimate, are beyond the limit: for `what`, a noun, and what would fit, a clause. */
laves_result laves__fail_room(const laves_context *context, double bytes, const char *what, const char *remedy,
                              laves_error *error);

/* ---- threads ---- */

/* Runs fn over [0, count) in blocks of at least min_block, in parallel. Where blocks begin and which worker
 * (0 .. laves__workers()-1) gets which may vary from run to run, so results must be written to places that depend on the index
 * alone. Between blocks the calling thread reports progress under `phase` (NULL: silently); after a cancel the remaining blocks
 * are skipped and the function returns false. Blocks are made to take some milliseconds, so that a cancel is soon heard where
 * min_block items take no longer. min_block 0: as 1, of a loop whose items may each take longer than starting a thread; all
 * workers begin at once, and else only when the loop has lasted a while. */
typedef void laves__range_fn(void *user, size_t begin, size_t end, int worker);
bool laves__parallel_for(laves_context *context, const char *phase, size_t count, size_t min_block, laves__range_fn *fn,
                         void *user);
int laves__workers(const laves_context *context);

/* The sum of what fn returns for pieces of [0, count), in parallel; a count is a sum, too. Pieces are the same and are added in
 * the same order for any number of threads, so the bits are as well. After a cancel, which `phase` is for as above, it is 0. */
typedef double laves__sum_fn(const void *user, size_t begin, size_t end);
double laves__parallel_sum(laves_context *context, const char *phase, size_t count, laves__sum_fn *fn, const void *user);

/* ---- time ---- */

double laves__wall_seconds(void); /* monotonic, from an arbitrary start */
double laves__cpu_seconds(void);  /* of the whole process, all threads */

#endif
