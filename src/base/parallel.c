/* The one parallel loop.
 *
 * Blocks are handed out by an atomic counter, so a slow block does not hold the others up; which worker gets which block
 * differs from run to run, which is why bodies may write only to places that depend on the index. Each worker begins with the
 * smallest blocks and makes its next ones larger or smaller by the time that they take: large enough to cost nothing, small
 * enough to hear of a cancel soon. Worker 0 is the calling thread and the only one that reports progress.
 *
 * Worker 0 begins alone, and the others are started once the loop has lasted longer than starting them does, so that a small mesh
 * needs no thread at all. Loops with few and long items, which say so, are the exception: there all begin at once.
 * Threads are POSIX threads that end with the loop. Builds with LAVES_OPENMP take those of OpenMP, which come sooner and then
 * spin between loops: that is processor time for nothing, and on a busy machine wall time, too. */
#ifdef __linux__
#define _GNU_SOURCE /* sched_getaffinity(); NOLINT(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): the C library's \
                       name */
#endif
#include <stdatomic.h>

#include "base/base.h"
#include "base/context.h"

#ifdef LAVES_OPENMP
#include <omp.h>
#else
#include <pthread.h>
#include <unistd.h>
#endif
#ifdef __linux__
#include <sched.h>
#endif

enum { BLOCKS_PER_WORKER = 16, WORKERS_MAX = 256 };

/* Seconds below which the next block is twice as large, and above which it is half as large. */
static const double quick_block = 2e-3, slow_block = 8e-3;

/* Seconds of work that are worth another thread: several times what it takes to start and end one. */
static const double worth_a_thread = 2e-4;

typedef struct loop {
  laves_context *context;
  const char *phase;
  laves__range_fn *fn;
  void *user;
  size_t count, smallest, largest; /* items in all, and of a block */
  atomic_size_t next;
} loop;

/* What a worker knows from one step to the next. */
typedef struct place {
  int worker;
  size_t block; /* how many items to take next */
  double now;
} place;

/* The cores that this process may use. */
static int cores(void) {
#ifdef __linux__
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) == 0) return CPU_COUNT(&set);
#endif
#ifdef LAVES_OPENMP
  return omp_get_num_procs();
#else
  return (int)sysconf(_SC_NPROCESSORS_ONLN);
#endif
}

int laves__threads_available(int thread_count) {
  int available = thread_count > 0 ? thread_count : cores();
  if (available < 1) available = 1;
  return available < WORKERS_MAX ? available : WORKERS_MAX;
}

int laves__workers(const laves_context *context) { return context->worker_count; }

static size_t next_block(const loop *l, size_t block, double seconds) {
  if (seconds < quick_block) return block < l->largest / 2 ? 2 * block : l->largest;
  if (seconds > slow_block) return block / 2 > l->smallest ? block / 2 : l->smallest;
  return block;
}

/* One block; false when there are no more, or on a cancel. */
static bool step(loop *l, place *p) {
  if (laves__is_cancelled(l->context)) return false;
  const size_t begin = atomic_fetch_add(&l->next, p->block);
  if (begin >= l->count) return false;
  const size_t end = p->block < l->count - begin ? begin + p->block : l->count;
  if (p->worker == 0 && laves__cancelled(l->context, l->phase, (double)begin / (double)l->count)) return false;
  l->fn(l->user, begin, end, p->worker);
  const double before = p->now;
  p->now = laves__wall_seconds();
  p->block = next_block(l, p->block, p->now - before);
  return true;
}

static void work(loop *l, int worker) {
  place p = {worker, l->smallest, laves__wall_seconds()};
  while (step(l, &p)) {
  }
}

/* Worker 0 alone, until what is left is worth further workers; returns for how many it is, 0 when nothing is left. */
static int work_alone(loop *l, int workers) {
  place p = {0, l->smallest, laves__wall_seconds()};
  const double start = p.now;
  while (step(l, &p)) {
    const size_t done = atomic_load(&l->next);
    if (done >= l->count) return 0;
    const double lasted = p.now - start, left = lasted * (double)(l->count - done) / (double)done;
    if (workers > 1 && lasted > worth_a_thread && left > worth_a_thread)
      return left < workers * worth_a_thread ? (int)(left / worth_a_thread) + 1 : workers;
  }
  return 0;
}

#ifdef LAVES_OPENMP
static void run(loop *l, int workers) {
#pragma omp parallel num_threads(workers)
  work(l, omp_get_thread_num());
}
#else
typedef struct helper {
  loop *l;
  int worker;
} helper;

static void *helper_main(void *user) {
  const helper *h = user;
  work(h->l, h->worker);
  return NULL;
}

static void run(loop *l, int workers) {
  pthread_t threads[WORKERS_MAX];
  helper helpers[WORKERS_MAX];
  int started = 0;
  for (int i = 1; i < workers; i++) {
    helpers[i] = (helper){l, i};
    if (pthread_create(&threads[i], NULL, helper_main, &helpers[i]) != 0) break; /* those that there are do it all */
    started = i;
  }
  work(l, 0);
  for (int i = 1; i <= started; i++) pthread_join(threads[i], NULL);
}
#endif

bool laves__parallel_for(laves_context *context, const char *phase, size_t count, size_t min_block, laves__range_fn *fn,
                         void *user) {
  if (count == 0) return !laves__is_cancelled(context);
  int workers = context->worker_count;
  const size_t smallest = min_block > 1 ? min_block : 1, share = count / ((size_t)workers * BLOCKS_PER_WORKER);
  const size_t blocks = (count - 1) / smallest + 1;
  if (blocks < (size_t)workers) workers = (int)blocks;
  loop l = {.context = context, .phase = phase, .fn = fn, .user = user, .count = count, .smallest = smallest};
  l.largest = share > smallest ? share : smallest;
  atomic_init(&l.next, 0);
  if (workers == 1 || min_block > 0) workers = work_alone(&l, workers);
  if (workers > 0) run(&l, workers);
  return !laves__is_cancelled(context);
}

/* ---- sums ---- */

enum { PIECES = 1024, PIECE_MIN = 32 };

typedef struct summation {
  laves__sum_fn *fn;
  const void *user;
  size_t count, piece; /* items in all, and of a piece */
  double sum[PIECES];
} summation;

static void sum_pieces(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  summation *s = user;
  for (size_t i = begin; i < end; i++) {
    const size_t first = i * s->piece, rest = s->count - first;
    s->sum[i] = s->fn(s->user, first, first + (rest < s->piece ? rest : s->piece));
  }
}

double laves__parallel_sum(laves_context *context, const char *phase, size_t count, laves__sum_fn *fn, const void *user) {
  summation s; /* a small mesh has no time to clear all sums */
  s.fn = fn;
  s.user = user;
  s.count = count;
  s.piece = (count + PIECES - 1) / PIECES;
  if (s.piece < PIECE_MIN) s.piece = PIECE_MIN;
  const size_t pieces = (count + s.piece - 1) / s.piece;
  double sum = 0;
  if (!laves__parallel_for(context, phase, pieces, 1, sum_pieces, &s)) return 0;
  for (size_t i = 0; i < pieces; i++) sum += s.sum[i];
  return sum;
}
