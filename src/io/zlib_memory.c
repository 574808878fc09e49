/* zlib's memory out of the context. zlib does not say the size when freeing, so it is kept in front. */
#include "io/zlib_memory.h"

#include <string.h>

#include "base/base.h"

enum { FRONT_BYTES = 16 }; /* keeps the alignment */

void *laves__zlib_allocate(void *context, unsigned count, unsigned size) {
  const size_t bytes = (size_t)count * size + FRONT_BYTES;
  char *block = laves__alloc(context, bytes, 1);
  if (!block) return NULL;
  memcpy(block, &bytes, sizeof bytes);
  return block + FRONT_BYTES;
}

void laves__zlib_free(void *context, void *address) {
  char *block = (char *)address - FRONT_BYTES;
  size_t bytes;
  memcpy(&bytes, block, sizeof bytes);
  laves__free(context, block, bytes, 1);
}
