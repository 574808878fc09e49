/* The one parallel loop.
 *
 * Blocks are handed out by an atomic counter, so a slow block does not hold the others up; which worker gets which block
 * differs from run to run, which is why bodies may write only to places that depend on the index. Each worker begins with the
 * smallest blocks and makes its next ones larger or smaller by the time that they take: large enough to cost nothing, small
 * enough to hear of a cancel soon. Worker 0 is the calling thread and the only one that reports progress. OpenMP supplies the
 * threads; builds with LAVES_PTHREADS start POSIX threads instead, for tools that cannot see into an OpenMP run time. */
#include <stdatomic.h>

#include "base/base.h"
#include "base/context.h"

#ifdef LAVES_PTHREADS
#include <pthread.h>
#include <unistd.h>
#else
#include <omp.h>
#endif

enum { BLOCKS_PER_WORKER = 16, WORKERS_MAX = 256 };

/* Seconds below which the next block is twice as large, and above which it is half as large. */
static const double quick_block = 2e-3, slow_block = 8e-3;

typedef struct loop {
  laves_context *context;
  const char *phase;
  laves__range_fn *fn;
  void *user;
  size_t count, smallest, largest; /* items in all, and of a block */
  atomic_size_t next;
} loop;

int laves__threads_available(int thread_count) {
#ifdef LAVES_PTHREADS
  int available = (int)sysconf(_SC_NPROCESSORS_ONLN);
#else
  int available = omp_get_num_procs();
#endif
  if (thread_count > 0) available = thread_count;
  if (available < 1) available = 1;
  return available < WORKERS_MAX ? available : WORKERS_MAX;
}

int laves__workers(const laves_context *context) { return context->worker_count; }

static size_t next_block(const loop *l, size_t block, double seconds) {
  if (seconds < quick_block) return block < l->largest / 2 ? 2 * block : l->largest;
  if (seconds > slow_block) return block / 2 > l->smallest ? block / 2 : l->smallest;
  return block;
}

static void work(loop *l, int worker) {
  size_t block = l->smallest;
  for (double now = laves__wall_seconds();;) {
    if (laves__is_cancelled(l->context)) return;
    const size_t begin = atomic_fetch_add(&l->next, block);
    if (begin >= l->count) return;
    const size_t end = block < l->count - begin ? begin + block : l->count;
    if (worker == 0 && laves__cancelled(l->context, l->phase, (double)begin / (double)l->count)) return;
    l->fn(l->user, begin, end, worker);
    const double start = now;
    now = laves__wall_seconds();
    block = next_block(l, block, now - start);
  }
}

#ifdef LAVES_PTHREADS
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
    if (pthread_create(&threads[i], NULL, helper_main, &helpers[i]) != 0) break;
    started = i;
  }
  work(l, 0);
  for (int i = 1; i <= started; i++) pthread_join(threads[i], NULL);
}
#else
static void run(loop *l, int workers) {
#pragma omp parallel num_threads(workers)
  work(l, omp_get_thread_num());
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
  if (workers == 1)
    work(&l, 0);
  else
    run(&l, workers);
  return !laves__is_cancelled(context);
}
