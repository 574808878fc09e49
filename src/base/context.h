/* The context's inside: only src/base may look. */
#ifndef LAVES_BASE_CONTEXT_H
#define LAVES_BASE_CONTEXT_H

#include <stdatomic.h>

#include "laves/laves.h"

struct laves_context {
  laves_context_options options;
  int worker_count;
  atomic_size_t bytes, peak;
  atomic_bool cancelled;
  const char *phase; /* of the last call of the progress callback, and when it was; NULL: none since the last reset */
  double told;
};

/* How many workers a wish for `thread_count` gives: itself, or one per core for 0. */
int laves__threads_available(int thread_count);

#endif
