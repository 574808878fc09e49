/* An allocator that refuses on demand, and counts what it gave.
 *
 * Each block has its size in front, so that a size which the library remembers wrongly is found. */
#include "fault/refuser.h"

#include <stdlib.h>
#include <string.h>

enum { FRONT_BYTES = 16 }; /* keeps the alignment */

static bool refuses(refuser *r) {
  ++r->asked;
  return r->refused && (r->for_good ? r->asked >= r->refused : r->asked == r->refused);
}

static size_t size_of_block(const char *block) {
  size_t bytes;
  memcpy(&bytes, block, sizeof bytes);
  return bytes;
}

static void *reallocate(void *user, void *pointer, size_t old_bytes, size_t new_bytes) {
  refuser *r = user;
  char *block = pointer ? (char *)pointer - FRONT_BYTES : NULL;
  if (block && size_of_block(block) != old_bytes) ++r->mistakes;
  if (new_bytes == 0) {
    r->blocks -= block != NULL;
    free(block);
    return NULL;
  }
  if (refuses(r)) return NULL;
  char *grown = realloc(block, new_bytes + FRONT_BYTES);
  if (!grown) return NULL;
  memcpy(grown, &new_bytes, sizeof new_bytes);
  r->blocks += block == NULL;
  return grown + FRONT_BYTES;
}

laves_context *refuser_context(refuser *r) {
  laves_context_options options = laves_context_options_default();
  options.thread_count = 1;
  options.reallocate = reallocate;
  options.reallocate_user = r;
  return laves_context_create(&options);
}
