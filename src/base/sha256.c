/* SHA-256 as FIPS 180-4 [fips180-4] defines it; section and function names are those of the standard. The plain loop is here;
 * what processors have for it is in sha256_x86.c. */
#include "base/sha256.h"

#include <string.h>

/* Section 4.2.2: the first 32 bits of the fractional parts of the cube roots of the first 64 primes. */
const uint32_t laves__sha256_constants[64] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5, 0xd807aa98, 0x12835b01,
    0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174, 0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc,
    0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da, 0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147,
    0x06ca6351, 0x14292967, 0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070, 0x19a4c116, 0x1e376c08,
    0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3, 0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208,
    0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

static uint32_t rotr(uint32_t x, int bits) { return x >> bits | x << (32 - bits); }

/* One step of section 6.2.2; the eight working variables change places by name instead of moving. */
#define STEP(a, b, c, d, e, f, g, h, t)                                                                                    \
  do {                                                                                                                     \
    const uint32_t t1 =                                                                                                    \
        (h) + (rotr(e, 6) ^ rotr(e, 11) ^ rotr(e, 25)) + (((e) & (f)) ^ (~(e) & (g))) + laves__sha256_constants[t] + w[t]; \
    (d) += t1;                                                                                                             \
    (h) = t1 + (rotr(a, 2) ^ rotr(a, 13) ^ rotr(a, 22)) + (((a) & (b)) ^ ((a) & (c)) ^ ((b) & (c)));                       \
  } while (0)

static void compress_one(uint32_t state[8], const unsigned char *bytes) {
  uint32_t w[64];
  for (int t = 0; t < 16; t++, bytes += 4)
    w[t] = (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
  for (int t = 16; t < 64; t++) {
    const uint32_t s0 = rotr(w[t - 15], 7) ^ rotr(w[t - 15], 18) ^ w[t - 15] >> 3;
    const uint32_t s1 = rotr(w[t - 2], 17) ^ rotr(w[t - 2], 19) ^ w[t - 2] >> 10;
    w[t] = s1 + w[t - 7] + s0 + w[t - 16];
  }
  uint32_t a = state[0], b = state[1], c = state[2], d = state[3], e = state[4], f = state[5], g = state[6], h = state[7];
  for (int t = 0; t < 64; t += 8) {
    STEP(a, b, c, d, e, f, g, h, t);
    STEP(h, a, b, c, d, e, f, g, t + 1);
    STEP(g, h, a, b, c, d, e, f, t + 2);
    STEP(f, g, h, a, b, c, d, e, t + 3);
    STEP(e, f, g, h, a, b, c, d, t + 4);
    STEP(d, e, f, g, h, a, b, c, t + 5);
    STEP(c, d, e, f, g, h, a, b, t + 6);
    STEP(b, c, d, e, f, g, h, a, t + 7);
  }
  const uint32_t more[8] = {a, b, c, d, e, f, g, h};
  for (int i = 0; i < 8; i++) state[i] += more[i];
}

void laves__sha256_compress_plain(uint32_t state[8], const unsigned char *bytes, size_t blocks) {
  for (size_t i = 0; i < blocks; i++) compress_one(state, bytes + 64 * i);
}

static void compress(uint32_t state[8], const unsigned char *bytes, size_t blocks) {
  if (!laves__sha256_compress_fast(state, bytes, blocks)) laves__sha256_compress_plain(state, bytes, blocks);
}

void laves__sha256_start(laves__sha256 *hash) {
  *hash =
      (laves__sha256){.state = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19}};
}

void laves__sha256_add(laves__sha256 *hash, const void *bytes, size_t count) {
  const unsigned char *next = bytes;
  const size_t used = hash->length % 64;
  hash->length += count;
  if (used > 0) {
    const size_t part = count < 64 - used ? count : 64 - used;
    memcpy(hash->block + used, next, part);
    next += part;
    count -= part;
    if (used + part < 64) return;
    compress(hash->state, hash->block, 1);
  }
  const size_t blocks = count / 64, left = count % 64;
  if (blocks > 0) compress(hash->state, next, blocks);
  if (left > 0) memcpy(hash->block, next + 64 * blocks, left);
}

/* Section 5.1.1: a one bit, zeros, and the length in bits. */
void laves__sha256_finish(laves__sha256 *hash, unsigned char digest[LAVES__SHA256_BYTES]) {
  const uint64_t bits = 8 * hash->length;
  static const unsigned char padding[64] = {0x80};
  unsigned char length[8];
  for (int i = 0; i < 8; i++) length[i] = (unsigned char)(bits >> (56 - 8 * i));
  const size_t used = hash->length % 64;
  laves__sha256_add(hash, padding, used < 56 ? 56 - used : 120 - used);
  laves__sha256_add(hash, length, sizeof length);
  for (int i = 0; i < LAVES__SHA256_BYTES; i++) digest[i] = (unsigned char)(hash->state[i / 4] >> (24 - 8 * (i % 4)));
}

void laves__sha256_text(const unsigned char digest[LAVES__SHA256_BYTES], char text[65]) {
  static const char digits[] = "0123456789abcdef";
  for (int i = 0; i < LAVES__SHA256_BYTES; i++) {
    text[2 * i] = digits[digest[i] >> 4];
    text[2 * i + 1] = digits[digest[i] & 15];
  }
  text[64] = 0;
}

bool laves__sha256_of(laves_context *context, const void *bytes, size_t count, char text[65]) {
  enum { PIECE_BYTES = 1 << 20 }; /* between two questions whether to cancel: some milliseconds */
  laves__sha256 hash;
  unsigned char digest[LAVES__SHA256_BYTES];
  laves__sha256_start(&hash);
  for (size_t done = 0; done < count; done += PIECE_BYTES) {
    if (laves__cancelled(context, "read", 1)) return false;
    laves__sha256_add(&hash, (const unsigned char *)bytes + done, count - done < PIECE_BYTES ? count - done : PIECE_BYTES);
  }
  laves__sha256_finish(&hash, digest);
  laves__sha256_text(digest, text);
  return true;
}
