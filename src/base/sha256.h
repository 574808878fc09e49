/* SHA-256, for hashes that anyone can recompute with the tools at hand. */
#ifndef LAVES_BASE_SHA256_H
#define LAVES_BASE_SHA256_H

#include "base/base.h"

enum { LAVES__SHA256_BYTES = 32 };

typedef struct laves__sha256 {
  uint32_t state[8];
  uint64_t length; /* bytes so far */
  unsigned char block[64];
} laves__sha256;

void laves__sha256_start(laves__sha256 *hash);
void laves__sha256_add(laves__sha256 *hash, const void *bytes, size_t count);
void laves__sha256_finish(laves__sha256 *hash, unsigned char digest[LAVES__SHA256_BYTES]);

/* 64 hexadecimal digits and NUL. */
void laves__sha256_text(const unsigned char digest[LAVES__SHA256_BYTES], char text[65]);
/* The same of a block of bytes, such as a file; false when cancelled. */
bool laves__sha256_of(laves_context *context, const void *bytes, size_t count, char text[65]);

/* One function, two ways: takes in whole blocks of 64 bytes. The fast one does nothing and says so where the processor is not
 * made for it. For sha256.c and its test. */
extern const uint32_t laves__sha256_constants[64];
void laves__sha256_compress_plain(uint32_t state[8], const unsigned char *bytes, size_t blocks);
bool laves__sha256_compress_fast(uint32_t state[8], const unsigned char *bytes, size_t blocks);

#endif
