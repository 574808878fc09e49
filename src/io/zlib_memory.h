/* zlib's memory out of the context: .zalloc, .zfree and .opaque (the context) of a z_stream. */
#ifndef LAVES_IO_ZLIB_MEMORY_H
#define LAVES_IO_ZLIB_MEMORY_H

void *laves__zlib_allocate(void *context, unsigned count, unsigned size);
void laves__zlib_free(void *context, void *address);

#endif
