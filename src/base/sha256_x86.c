/* SHA-256 by the instructions that x86 processors have for it: ten times as fast as the plain loop.
 *
 * The eight working variables stand in two registers, (a b e f) and (c d g h) from the top down; one instruction does two steps
 * of FIPS 180-4, section 6.2.2, and changes the roles of the registers. The message schedule of section 6.2.2, step 1, is made
 * four words at a time: w holds the last sixteen words in a ring of four registers. Names of the instructions and the order of
 * their operands: Gulley, Gopal, Yap, Feghali, Guilford and Wolrich, "Intel SHA extensions", 2013. */
#include "base/sha256.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <cpuid.h>
#include <immintrin.h>
#include <stdatomic.h>

static bool ask_processor(void) {
  unsigned eax, ebx, ecx, edx;
  const bool shuffles = __get_cpuid(1, &eax, &ebx, &ecx, &edx) && (ecx & bit_SSSE3) && (ecx & bit_SSE4_1);
  return shuffles && __get_cpuid_count(7, 0, &eax, &ebx, &ecx, &edx) && (ebx & bit_SHA);
}

/* Asked once: under a hypervisor the question takes microseconds. All threads find the same answer. */
static bool has_instructions(void) {
  enum { UNKNOWN, NO, YES };
  static atomic_int answer = UNKNOWN;
  int known = atomic_load_explicit(&answer, memory_order_relaxed);
  if (known == UNKNOWN) {
    known = ask_processor() ? YES : NO;
    atomic_store_explicit(&answer, known, memory_order_relaxed);
  }
  return known == YES;
}

__attribute__((target("sha,ssse3,sse4.1"))) static void compress(uint32_t state[8], const unsigned char *bytes, size_t blocks) {
  const __m128i big_endian = _mm_set_epi64x(0x0c0d0e0f08090a0b, 0x0405060700010203);
  const __m128i dcba = _mm_loadu_si128((const __m128i *)state), hgfe = _mm_loadu_si128((const __m128i *)(state + 4));
  const __m128i cdab = _mm_shuffle_epi32(dcba, 0xb1), efgh = _mm_shuffle_epi32(hgfe, 0x1b);
  __m128i abef = _mm_alignr_epi8(cdab, efgh, 8), cdgh = _mm_blend_epi16(efgh, cdab, 0xf0);
  for (; blocks > 0; blocks--, bytes += 64) {
    const __m128i old_abef = abef, old_cdgh = cdgh;
    __m128i w[4];
    for (int i = 0; i < 4; i++) w[i] = _mm_shuffle_epi8(_mm_loadu_si128((const __m128i *)(bytes + 16 * i)), big_endian);
    for (int i = 0; i < 16; i++) { /* four steps each */
      const __m128i now = w[i % 4];
      const __m128i sum = _mm_add_epi32(now, _mm_loadu_si128((const __m128i *)(laves__sha256_constants + 4 * i)));
      cdgh = _mm_sha256rnds2_epu32(cdgh, abef, sum);
      abef = _mm_sha256rnds2_epu32(abef, cdgh, _mm_shuffle_epi32(sum, 0x0e));
      if (i >= 12) continue;
      /* Words 4 i + 16 to 4 i + 19 take the place of those just used. */
      const __m128i middle = _mm_alignr_epi8(w[(i + 3) % 4], w[(i + 2) % 4], 4);
      const __m128i early = _mm_add_epi32(_mm_sha256msg1_epu32(now, w[(i + 1) % 4]), middle);
      w[i % 4] = _mm_sha256msg2_epu32(early, w[(i + 3) % 4]);
    }
    abef = _mm_add_epi32(abef, old_abef);
    cdgh = _mm_add_epi32(cdgh, old_cdgh);
  }
  const __m128i feba = _mm_shuffle_epi32(abef, 0x1b), dchg = _mm_shuffle_epi32(cdgh, 0xb1);
  _mm_storeu_si128((__m128i *)state, _mm_blend_epi16(feba, dchg, 0xf0));
  _mm_storeu_si128((__m128i *)(state + 4), _mm_alignr_epi8(dchg, feba, 8));
}

bool laves__sha256_compress_fast(uint32_t state[8], const unsigned char *bytes, size_t blocks) {
  if (!has_instructions()) return false;
  compress(state, bytes, blocks);
  return true;
}
#else
bool laves__sha256_compress_fast(uint32_t state[8], const unsigned char *bytes, size_t blocks) {
  (void)state;
  (void)bytes;
  (void)blocks;
  return false;
}
#endif
