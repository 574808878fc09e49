/* The context: one place that counts memory, holds threads and progress.  Everything else is made from one.
 *
 * Bytes are counted with atomics, so any thread may allocate; the limit is checked before the block is asked for, so a
 * refusal leaves the count as it was. */
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/base.h"
#include "base/context.h"

static const uint32_t context_cookie = 0x6c617665;

static void *default_reallocate(void *user, void *pointer, size_t old_bytes, size_t new_bytes) {
  (void)user;
  (void)old_bytes;
  if (new_bytes == 0) {
    free(pointer);
    return NULL;
  }
  return realloc(pointer, new_bytes);
}

laves_context_options laves_context_options_default(void) { return (laves_context_options){.cookie = context_cookie}; }

laves_context *laves_context_create(const laves_context_options *options) {
  const laves_context_options given = options ? *options : laves_context_options_default();
  if (given.cookie != context_cookie) return NULL;
  laves_reallocate_fn *reallocate = given.reallocate ? given.reallocate : default_reallocate;
  laves_context *context = reallocate(given.reallocate_user, NULL, 0, sizeof *context);
  if (!context) return NULL;
  memset(context, 0, sizeof *context);
  context->options = given;
  context->options.reallocate = reallocate;
  context->worker_count = laves__threads_available(given.thread_count);
  return context;
}

void laves_context_free(laves_context *context) {
  if (!context) return;
  context->options.reallocate(context->options.reallocate_user, context, sizeof *context, 0);
}

size_t laves_context_bytes(const laves_context *context) { return atomic_load(&context->bytes); }

size_t laves_context_peak_bytes(const laves_context *context) { return atomic_load(&context->peak); }

/* Counts `more` bytes in; false when that would pass the limit. */
static bool count_in(laves_context *context, size_t more) {
  const size_t now = atomic_fetch_add(&context->bytes, more) + more;
  if (now < more || (context->options.memory_limit && now > context->options.memory_limit)) {
    atomic_fetch_sub(&context->bytes, more);
    return false;
  }
  size_t peak = atomic_load(&context->peak);
  while (now > peak && !atomic_compare_exchange_weak(&context->peak, &peak, now)) {
  }
  return true;
}

static const double estimate_slack = 1.25;

bool laves__may_fit(const laves_context *context, double bytes) {
  const double held = (double)laves_context_bytes(context), limit = (double)context->options.memory_limit;
  return limit == 0 || held + bytes / estimate_slack <= limit;
}

double laves__room(const laves_context *context) {
  const double held = (double)laves_context_bytes(context), limit = (double)context->options.memory_limit;
  if (limit == 0) return INFINITY;
  return limit > held ? (limit - held) / estimate_slack : 0;
}

void *laves__realloc(laves_context *context, void *block, size_t old_count, size_t new_count, size_t size) {
  if (size && new_count > SIZE_MAX / 2 / size) return NULL;
  const size_t old_bytes = old_count * size;
  const size_t new_bytes = new_count != 0 && size != 0 ? new_count * size : 1;
  const size_t held = block ? (old_bytes ? old_bytes : 1) : 0;
  if (new_bytes > held && !count_in(context, new_bytes - held)) return NULL;
  void *result = context->options.reallocate(context->options.reallocate_user, block, held, new_bytes);
  if (!result) {
    if (new_bytes > held) atomic_fetch_sub(&context->bytes, new_bytes - held);
    return NULL;
  }
  if (new_bytes < held) atomic_fetch_sub(&context->bytes, held - new_bytes);
  return result;
}

void *laves__alloc(laves_context *context, size_t count, size_t size) { return laves__realloc(context, NULL, 0, count, size); }

void *laves__alloc_zeroed(laves_context *context, size_t count, size_t size) {
  void *block = laves__alloc(context, count, size);
  if (block) memset(block, 0, count * size);
  return block;
}

void laves__free(laves_context *context, void *block, size_t count, size_t size) {
  if (!block) return;
  const size_t bytes = count != 0 && size != 0 ? count * size : 1;
  context->options.reallocate(context->options.reallocate_user, block, bytes, 0);
  atomic_fetch_sub(&context->bytes, bytes);
}

bool laves__grow(laves_context *context, void *block, size_t *capacity, size_t needed, size_t size) {
  if (needed <= *capacity) return true;
  size_t larger = *capacity ? *capacity : 16;
  while (larger < needed) {
    if (larger > SIZE_MAX / 4) return false;
    larger *= 2;
  }
  void *old;
  memcpy(&old, block, sizeof old);
  void *grown = laves__realloc(context, old, *capacity, larger, size);
  if (!grown) return false;
  memcpy(block, &grown, sizeof grown);
  *capacity = larger;
  return true;
}

/* Whether the callback was called for this phase less than the wished time ago. */
static bool is_too_soon(laves_context *context, const char *phase) {
  if (!(context->options.progress_interval > 0)) return false;
  const double now = laves__wall_seconds();
  if (phase == context->phase && now - context->told < context->options.progress_interval) return true;
  context->phase = phase;
  context->told = now;
  return false;
}

bool laves__cancelled(laves_context *context, const char *phase, double fraction) {
  if (atomic_load(&context->cancelled)) return true;
  if (!context->options.progress || !phase || is_too_soon(context, phase)) return false;
  if (context->options.progress(context->options.progress_user, phase, fraction)) return false;
  atomic_store(&context->cancelled, true);
  return true;
}

bool laves__is_cancelled(const laves_context *context) { return atomic_load(&context->cancelled); }

void laves__progress_reset(laves_context *context) {
  atomic_store(&context->cancelled, false);
  context->phase = NULL;
}
