/* SHA-256 against the examples of its standard, in one piece and in many. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

#include "base/sha256.h"

/* Adds the text in pieces of the given size. */
static void digest(const char *text, size_t piece, char hex[65]) {
  laves__sha256 hash;
  unsigned char bytes[LAVES__SHA256_BYTES];
  const size_t length = strlen(text);
  laves__sha256_start(&hash);
  for (size_t i = 0; i < length; i += piece) laves__sha256_add(&hash, text + i, length - i < piece ? length - i : piece);
  laves__sha256_finish(&hash, bytes);
  laves__sha256_text(bytes, hex);
}

static void examples_of_the_standard(void **state) {
  static const char *const pairs[][2] = {
      {"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
      {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
      {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
       "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"},
      {"abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmnopqrstnopqrstu",
       "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1"}};
  (void)state;
  for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
    for (size_t piece = 1; piece <= 130; piece++) {
      char hex[65];
      digest(pairs[i][0], piece, hex);
      assert_string_equal(hex, pairs[i][1]);
    }
}

static void a_million_times_a(void **state) {
  static char text[1001];
  laves__sha256 hash;
  unsigned char bytes[LAVES__SHA256_BYTES];
  char hex[65];
  (void)state;
  memset(text, 'a', 1000);
  laves__sha256_start(&hash);
  for (int i = 0; i < 1000; i++) laves__sha256_add(&hash, text, 1000);
  laves__sha256_finish(&hash, bytes);
  laves__sha256_text(bytes, hex);
  assert_string_equal(hex, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

/* Lengths round a block's end, where the padding needs a second block or not. */
static void lengths_near_a_block(void **state) {
  char text[130] = "", first[65], second[65];
  (void)state;
  for (size_t length = 50; length < 129; length++) {
    memset(text, 'x', length);
    digest(text, 1, first);
    digest(text, 64, second);
    assert_string_equal(first, second);
  }
}

/* Where the processor has instructions for it, they do what the plain loop does, from any state. */
static void both_ways_agree(void **state) {
  enum { MOST_BLOCKS = 5 };
  unsigned char bytes[64 * MOST_BLOCKS + 1]; /* blocks may begin anywhere */
  uint32_t plain[8], fast[8], random = 12345;
  (void)state;
  for (int round = 0; round < 1000; round++) {
    for (size_t i = 0; i < sizeof bytes; i++) bytes[i] = (unsigned char)((random = random * 1664525 + 1013904223) >> 24);
    for (int i = 0; i < 8; i++) plain[i] = fast[i] = random = random * 1664525 + 1013904223;
    const size_t blocks = 1 + (size_t)round % MOST_BLOCKS;
    if (!laves__sha256_compress_fast(fast, bytes + round % 2, blocks)) skip();
    laves__sha256_compress_plain(plain, bytes + round % 2, blocks);
    assert_memory_equal(fast, plain, sizeof plain);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(examples_of_the_standard), cmocka_unit_test(a_million_times_a),
                                     cmocka_unit_test(lengths_near_a_block), cmocka_unit_test(both_ways_agree)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
