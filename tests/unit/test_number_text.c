/* Numbers as text: known forms, and every double reads back as itself. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "io/number_text.h"

static const char *text_of(double value) {
  static char text[64];
  *laves__put_double(text, value) = 0;
  return text;
}

static const char *text_of_integer(int64_t value) {
  static char text[64];
  *laves__put_integer(text, value) = 0;
  return text;
}

static void test_integers(void **state) {
  (void)state;
  assert_string_equal(text_of_integer(0), "0");
  assert_string_equal(text_of_integer(7), "7");
  assert_string_equal(text_of_integer(10), "10");
  assert_string_equal(text_of_integer(-12345), "-12345");
  assert_string_equal(text_of_integer(INT64_MAX), "9223372036854775807");
  assert_string_equal(text_of_integer(INT64_MIN), "-9223372036854775808");
}

static void test_known_doubles(void **state) {
  (void)state;
  assert_string_equal(text_of(0), "0");
  assert_string_equal(text_of(-0.0), "-0");
  assert_string_equal(text_of(1), "1");
  assert_string_equal(text_of(-250), "-250");
  assert_string_equal(text_of(0.1), "0.1");
  assert_string_equal(text_of(0.001), "0.001");
  assert_string_equal(text_of(0.00012345), "0.00012345");
  assert_string_equal(text_of(1e-5), "1e-5");
  assert_string_equal(text_of(1e22), "1e22");
  assert_string_equal(text_of(1.0 / 3), "0.3333333333333333");
  assert_string_equal(text_of(123456.789), "123456.789");
  assert_string_equal(text_of(5e-324), "5e-324");
  assert_string_equal(text_of(1.7976931348623157e308), "1.7976931348623157e308");
  assert_string_equal(text_of(NAN), "nan");
  assert_string_equal(text_of(-INFINITY), "-inf");
}

static void assert_reads_back(double value) {
  const char *text = text_of(value);
  if (strtod(text, NULL) != value) fail_msg("%.17g was written as %s", value, text);
  if (strlen(text) > LAVES__DOUBLE_TEXT_MAX) fail_msg("%s is too long", text);
}

static void test_round_trip(void **state) {
  (void)state;
  uint64_t bits = UINT64_C(88172645463325252); /* xorshift64 */
  for (int i = 0; i < 200000; i++) {
    bits ^= bits << 13;
    bits ^= bits >> 7;
    bits ^= bits << 17;
    double value;
    memcpy(&value, &bits, sizeof value);
    if (isfinite(value)) assert_reads_back(value);
    assert_reads_back((double)(int64_t)bits * 1e-18);
  }
}

static void test_powers_of_two(void **state) {
  (void)state;
  for (int e = -1074; e < 1024; e++) assert_reads_back(ldexp(1, e));
}

static const char *field_of(double value, int width) {
  static char text[64];
  *laves__put_double_field(text, value, width) = 0;
  return text;
}

static void test_known_fields(void **state) {
  (void)state;
  assert_string_equal(field_of(0, 16), "0.");
  assert_string_equal(field_of(-0.0, 16), "0.");
  assert_string_equal(field_of(1, 16), "1.");
  assert_string_equal(field_of(-250, 16), "-250.");
  assert_string_equal(field_of(0.5, 16), ".5");
  assert_string_equal(field_of(1e-9, 16), "1.E-9");
  assert_string_equal(field_of(1.0 / 3, 16), ".333333333333333");
  assert_string_equal(field_of(-2.0 / 3, 16), "-.66666666666667");
  assert_string_equal(field_of(-2.0 / 3, 20), "-.6666666666666666");
  assert_string_equal(field_of(0.99999999999999989, 16), "1.");
  assert_string_equal(field_of(-1.2345678901234567e-100, 16), "-1.23456789E-100");
  assert_string_equal(field_of(-1.2345678901234567e-100, 20), "-1.234567890123E-100");
}

/* Within the width, and as near as the digits allow: nine are there at the least. */
static void test_fields(void **state) {
  (void)state;
  uint64_t bits = UINT64_C(88172645463325252);
  for (int i = 0; i < 200000; i++) {
    bits ^= bits << 13;
    bits ^= bits >> 7;
    bits ^= bits << 17;
    double value;
    memcpy(&value, &bits, sizeof value);
    if (!isfinite(value) || fabs(value) < 1e-300) continue;
    for (int width = 16; width <= 20; width += 4) {
      const char *text = field_of(value, width);
      if (strlen(text) > (size_t)width) fail_msg("%.17g was written as %s", value, text);
      if (!strchr(text, '.')) fail_msg("%.17g was written without a point", value);
      if (fabs(strtod(text, NULL) / value - 1) > (width == 16 ? 1e-8 : 1e-12)) fail_msg("%.17g was written as %s", value, text);
    }
  }
}

/* No shorter text reads back as the same double. */
static void test_shortest(void **state) {
  (void)state;
  for (int i = 1; i < 2000; i++) {
    const double value = sqrt(i) * 0.37;
    char shorter[64];
    int digits = 1;
    for (; digits < 17; digits++) {
      snprintf(shorter, sizeof shorter, "%.*g", digits, value);
      if (strtod(shorter, NULL) == value) break;
    }
    int written = 0;
    for (const char *c = text_of(value); *c; c++) written += *c >= '0' && *c <= '9';
    if (value < 1) written--; /* the zero before the point */
    assert_int_equal(written, digits);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_integers),      cmocka_unit_test(test_known_doubles), cmocka_unit_test(test_round_trip),
      cmocka_unit_test(test_powers_of_two), cmocka_unit_test(test_shortest),      cmocka_unit_test(test_known_fields),
      cmocka_unit_test(test_fields),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
