/* The one function of a fuzz target, called by libFuzzer and by replay.c, and what all targets share. */
#ifndef LAVES_FUZZ_TARGET_H
#define LAVES_FUZZ_TARGET_H

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

/* Stops the program, so that the fuzzer keeps the input, when a promise does not hold. */
#define FUZZ_REQUIRE(condition) \
  do {                          \
    if (!(condition)) abort();  \
  } while (0)

/* Bytes that are eaten from the front; behind their end come zeros. */
typedef struct fuzz_bytes {
  const uint8_t *at, *end;
} fuzz_bytes;

static inline uint8_t fuzz_byte(fuzz_bytes *b) { return b->at < b->end ? *b->at++ : 0; }
/* In [0, count), count at most 256. */
static inline int fuzz_below(fuzz_bytes *b, int count) { return fuzz_byte(b) % count; }
/* In [0, 1]. */
static inline double fuzz_share(fuzz_bytes *b) { return fuzz_byte(b) / 255.0; }

#endif
