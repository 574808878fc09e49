/* Words, numbers and lines of text in memory. */
#include <locale.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "io/scan.h"

static laves__scan scan_of(const char *text) { return laves__scan_begin("t", text, strlen(text)); }

static void words_stay_on_their_line(void **state) {
  (void)state;
  laves__scan scan = scan_of("\xEF\xBB\xBF one\ttwo \r\n\n three # four\rfive");
  scan.comment = '#';
  laves__word word;
  assert_true(laves__scan_word(&scan, &word));
  assert_true(laves__word_is(word, "ONE"));
  assert_true(laves__scan_keyword(&scan, "two"));
  assert_false(laves__scan_word(&scan, &word));
  assert_int_equal(laves__scan_line(&scan), 1);
  assert_true(laves__scan_space(&scan));
  assert_int_equal(laves__scan_line(&scan), 3);
  assert_false(laves__scan_keyword(&scan, "thre"));
  assert_false(laves__scan_keyword(&scan, "threes"));
  assert_true(laves__scan_keyword(&scan, "three"));
  assert_false(laves__scan_blanks(&scan));
  assert_true(laves__scan_next_line(&scan));
  assert_int_equal(laves__scan_line(&scan), 4);
  assert_true(laves__scan_keyword(&scan, "five"));
  assert_false(laves__scan_space(&scan));
}

static void backslash_joins_lines_when_asked(void **state) {
  (void)state;
  laves__scan scan = scan_of("1\\\r\n 2\n3");
  int64_t value = 0;
  scan.continuation = true;
  assert_true(laves__scan_int(&scan, &value));
  assert_true(laves__scan_int(&scan, &value));
  assert_int_equal(value, 2);
  assert_false(laves__scan_int(&scan, &value));
  scan = scan_of("1 \\\n 2\n3");
  assert_true(laves__scan_int(&scan, &value));
  assert_false(laves__scan_int(&scan, &value));
}

static void rest_is_trimmed(void **state) {
  (void)state;
  laves__scan scan = scan_of("solid  a part \t\r\nx");
  assert_true(laves__scan_keyword(&scan, "solid"));
  const laves__word rest = laves__scan_rest(&scan);
  assert_int_equal(rest.length, 6);
  assert_memory_equal(rest.at, "a part", 6);
  assert_int_equal(laves__scan_rest(&scan).length, 0);
}

static void integers_have_limits(void **state) {
  (void)state;
  int64_t value = 0;
  size_t count = 0;
  laves__scan scan = scan_of("9223372036854775807 -12 +7 9223372036854775808");
  assert_true(laves__scan_int(&scan, &value));
  assert_true(value == INT64_MAX);
  assert_false(laves__scan_count(&scan, 100, &count));
  assert_true(laves__scan_int(&scan, &value));
  assert_int_equal(value, -12);
  assert_false(laves__scan_count(&scan, 6, &count));
  assert_true(laves__scan_count(&scan, 7, &count));
  assert_int_equal(count, 7);
  assert_false(laves__scan_int(&scan, &value));
  scan = scan_of("12.5");
  assert_false(laves__scan_int(&scan, &value));
}

static void odd_numbers_are_refused(void **state) {
  (void)state;
  static const char *const BAD[] = {"nan", "inf", "1e999", "-1e400", "1x", ".", "-", "+.e1", "1e", "0x10", "1,5", "1.2.3", ""};
  for (size_t i = 0; i < LAVES__COUNT_OF(BAD); ++i) {
    double value;
    laves__scan scan = scan_of(BAD[i]);
    if (laves__scan_double(&scan, &value)) {
      fail_msg("'%s' was taken for %g", BAD[i], value);
    }
    assert_ptr_equal(scan.at, scan.begin);
  }
}

/* The number must have the bits that strtod gives it. */
static void assert_as_strtod(const char *text) {
  double value = 0;
  const double expected = strtod(text, NULL);
  const char *stop = laves__parse_double(text, text + strlen(text), &value);
  if (stop == NULL || *stop != 0 || memcmp(&value, &expected, sizeof value) != 0) {
    fail_msg("'%s' became %.17g instead of %.17g", text, value, expected);
  }
}

static void numbers_are_rounded_correctly(void **state) {
  (void)state;
  static const char *const TEXTS[] = {"0",
                                      "-0",
                                      "1.",
                                      ".5",
                                      "+2.5E+3",
                                      "0.1",
                                      "1e22",
                                      "1e23",
                                      "9007199254740993",
                                      "9007199254740993.0000000001",
                                      "9007199254740992.9",
                                      "1.7976931348623157e308",
                                      "5e-324",
                                      "2.2250738585072011e-308",
                                      "0.000000000000000000000000000000000000000000001",
                                      "123456789012345678901234567890",
                                      "8.5e-27",
                                      "1844674407370955161.5e27",
                                      "18446744073709551615",
                                      "18446744073709551616",
                                      "0000000000000000000000000.1250000000000000000000000000000",
                                      "1e-400",
                                      "0e999999999999999999999",
                                      "1e-999999999999999999999"};
  for (size_t i = 0; i < LAVES__COUNT_OF(TEXTS); ++i) {
    assert_as_strtod(TEXTS[i]);
  }
}

static uint64_t next_random(uint64_t *seed) {
  *seed ^= *seed << 13;
  *seed ^= *seed >> 7;
  *seed ^= *seed << 17;
  return *seed;
}

/* Random doubles with 1 to 21 digits, of ordinary size and of any; seed below. */
static void random_numbers_are_rounded_correctly(void **state) {
  (void)state;
  uint64_t seed = 20240607;
  for (int i = 0; i < 200000; ++i) {
    char text[80];
    const int digits = 1 + (int)(next_random(&seed) % 21);
    const int exponent = (int)(next_random(&seed) % 60) - 40;
    const double fraction = (double)next_random(&seed) * 0x1p-64;
    if (i % 2 == 0) {
      snprintf(text, sizeof text, "%s%.*f", i % 4 ? "-" : "", digits, fraction * 1000);
    } else {
      snprintf(text, sizeof text, "%.*fe%d", digits, fraction, exponent);
    }
    assert_as_strtod(text);
  }
}

/* Ties of 64-bit integers and quotients that lie next to ties. */
static void ties_are_rounded_correctly(void **state) {
  (void)state;
  uint64_t seed = 77;
  for (int i = 0; i < 50000; ++i) {
    char text[80];
    const uint64_t tie = ((next_random(&seed) >> 11) << 11 | 1ULL << 10) + next_random(&seed) % 3 - 1;
    snprintf(text, sizeof text, "%llu", (unsigned long long)tie);
    assert_as_strtod(text);
    snprintf(text, sizeof text, "%llue-%d", (unsigned long long)(tie % 10000000000000000000ULL), (int)(next_random(&seed) % 28));
    assert_as_strtod(text);
  }
}

static void numbers_ignore_the_locale(void **state) {
  (void)state;
  if (setlocale(LC_NUMERIC, "de_DE.UTF-8") == NULL) {
    print_message("skipped: the locale de_DE.UTF-8 is not installed\n");
    skip();
  }
  double value = 0;
  const char text[] = "1.25e-200";
  assert_non_null(laves__parse_double(text, text + strlen(text), &value));
  setlocale(LC_NUMERIC, "C");
  assert_true(value == 1.25e-200);
}

static void very_long_numbers_are_refused(void **state) {
  (void)state;
  static char text[5000];
  double value;
  memset(text, '7', sizeof text);
  assert_null(laves__parse_double(text, text + sizeof text, &value));
  assert_non_null(laves__parse_double(text, text + 300, &value));
}

static void messages_name_file_line_and_word(void **state) {
  (void)state;
  laves_error error = {0};
  laves__scan scan = scan_of("1\r\n2\r\n x\x01y");
  laves__scan_next_line(&scan);
  assert_int_equal(laves__scan_fail_expected(&scan, &error, "a word"), LAVES_ERROR_INPUT);
  assert_string_equal(error.text, "t, line 2: expected a word, found '2'");
  laves__scan_next_line(&scan);
  laves__scan_fail_expected(&scan, &error, "a number");
  assert_string_equal(error.text, "t, line 3: expected a number, found 'x?y'");
  laves__scan_rest(&scan);
  laves__scan_fail_expected(&scan, &error, "a number");
  assert_string_equal(error.text, "t, line 3: expected a number, but the file ends");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(words_stay_on_their_line),
      cmocka_unit_test(backslash_joins_lines_when_asked),
      cmocka_unit_test(rest_is_trimmed),
      cmocka_unit_test(integers_have_limits),
      cmocka_unit_test(odd_numbers_are_refused),
      cmocka_unit_test(numbers_are_rounded_correctly),
      cmocka_unit_test(random_numbers_are_rounded_correctly),
      cmocka_unit_test(ties_are_rounded_correctly),
      cmocka_unit_test(numbers_ignore_the_locale),
      cmocka_unit_test(very_long_numbers_are_refused),
      cmocka_unit_test(messages_name_file_line_and_word),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
