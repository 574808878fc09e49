/* Words, numbers and lines of a text file in memory.
 *
 * Decimal numbers.  A number is w * 10^e with w an integer. When w is written with at most 19 digits it fits 64 bits, and
 * 10^e = 5^e 2^e with 5^27 < 2^63, so for |e| <= 27 the product w * 5^e, or the quotient w / 5^-e with enough bits in front
 * of it, fits 128 bits. The quotient keeps at least 62 bits, and its lowest bit is set when the division leaves a remainder
 * ("sticky"), so that the one rounding, from 128 bits to 53, sees on which side of a tie the true value lies. Powers of two
 * are exact. When w and 10^|e| are both exact doubles (w < 2^53, |e| <= 22) one division or product of doubles is rounded
 * correctly already and is faster [Clinger, How to read floating point numbers accurately, PLDI 1990].
 * What is left (more digits, very large or small numbers) goes to strtod() in the "C" locale. */
#include "io/scan.h"

#include <locale.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

__extension__ typedef unsigned __int128 wide;

static bool is_line_end(char c) { return c == '\n' || c == '\r'; }
static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
static bool is_space(char c) { return is_blank(c) || is_line_end(c); }
static bool is_digit(char c) { return c >= '0' && c <= '9'; }
static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c; }

laves__scan laves__scan_begin(const char *name, const void *bytes, size_t length) {
  const char *begin = bytes;
  laves__scan scan = {.begin = begin, .at = begin, .end = begin + length, .name = name};
  if (length >= 3 && memcmp(begin, "\xEF\xBB\xBF", 3) == 0) {
    scan.at += 3;
  }
  return scan;
}

/* ---- between words ---- */

/* One past the line end at `at`, which must be one. */
static const char *behind_line_end(const char *at, const char *end) {
  return at[0] == '\r' && end - at >= 2 && at[1] == '\n' ? at + 2 : at + 1;
}

/* Whether a backslash at `at` joins its line to the next. */
static bool is_joint(const laves__scan *scan, const char *at) {
  return scan->continuation && *at == '\\' && scan->end - at >= 2 && is_line_end(at[1]);
}

bool laves__scan_blanks(laves__scan *scan) {
  const char *at = scan->at, *end = scan->end;
  for (;;) {
    while (at < end && is_blank(*at)) {
      ++at;
    }
    if (at == end || !is_joint(scan, at)) {
      break;
    }
    at = behind_line_end(at + 1, end);
  }
  scan->at = at;
  return at < end && !is_line_end(*at) && (scan->comment == 0 || *at != scan->comment);
}

bool laves__scan_space(laves__scan *scan) {
  while (!laves__scan_blanks(scan)) {
    if (!laves__scan_next_line(scan)) {
      return false;
    }
  }
  return true;
}

bool laves__scan_next_line(laves__scan *scan) {
  const char *at = scan->at, *end = scan->end;
  while (at < end && !is_line_end(*at)) {
    at = is_joint(scan, at) ? behind_line_end(at + 1, end) : at + 1;
  }
  scan->at = at < end ? behind_line_end(at, end) : end;
  return scan->at < end;
}

/* ---- words and numbers ---- */

bool laves__scan_word(laves__scan *scan, laves__word *word) {
  if (!laves__scan_blanks(scan)) {
    return false;
  }
  const char *at = scan->at;
  while (at < scan->end && !is_space(*at) && !is_joint(scan, at)) {
    ++at;
  }
  *word = (laves__word){scan->at, (size_t)(at - scan->at)};
  scan->at = at;
  return true;
}

bool laves__word_is(laves__word word, const char *text) {
  for (size_t i = 0; i < word.length; ++i) {
    if (text[i] == 0 || lower(word.at[i]) != lower(text[i])) {
      return false;
    }
  }
  return text[word.length] == 0;
}

bool laves__scan_keyword(laves__scan *scan, const char *keyword) {
  const char *start = scan->at;
  laves__word word;
  if (laves__scan_word(scan, &word) && laves__word_is(word, keyword)) {
    return true;
  }
  scan->at = start;
  return false;
}

laves__word laves__scan_rest(laves__scan *scan) {
  while (scan->at < scan->end && is_blank(*scan->at)) {
    ++scan->at;
  }
  laves__word word = {scan->at, 0};
  while (scan->at < scan->end && !is_line_end(*scan->at)) {
    ++scan->at;
  }
  word.length = (size_t)(scan->at - word.at);
  while (word.length > 0 && is_blank(word.at[word.length - 1])) {
    --word.length;
  }
  return word;
}

/* Ends a number that must be a whole word. */
static bool scan_number_end(laves__scan *scan, const char *start, const char *stop) {
  const bool whole = stop != NULL && (stop == scan->end || is_space(*stop) || is_joint(scan, stop) ||
                                      (scan->comment != 0 && *stop == scan->comment));
  scan->at = whole ? stop : start;
  return whole;
}

bool laves__scan_double(laves__scan *scan, double *value) {
  const char *start = scan->at;
  laves__scan_blanks(scan);
  return scan_number_end(scan, start, laves__parse_double(scan->at, scan->end, value));
}

bool laves__scan_int(laves__scan *scan, int64_t *value) {
  const char *start = scan->at;
  laves__scan_blanks(scan);
  return scan_number_end(scan, start, laves__parse_int(scan->at, scan->end, value));
}

bool laves__scan_count(laves__scan *scan, size_t limit, size_t *value) {
  const char *start = scan->at;
  int64_t number;
  if (!laves__scan_int(scan, &number) || number < 0 || (uint64_t)number > limit) {
    scan->at = start;
    return false;
  }
  *value = (size_t)number;
  return true;
}

const char *laves__parse_int(const char *at, const char *end, int64_t *value) {
  const bool negative = at < end && *at == '-';
  if (at < end && (*at == '-' || *at == '+')) {
    ++at;
  }
  if (at == end || !is_digit(*at)) {
    return NULL;
  }
  int64_t number = 0;
  for (; at < end && is_digit(*at); ++at) {
    if (__builtin_mul_overflow(number, 10, &number) || __builtin_add_overflow(number, *at - '0', &number)) {
      return NULL;
    }
  }
  *value = negative ? -number : number;
  return at;
}

/* A decimal number taken apart: (-1)^negative * digits * 10^exponent. */
typedef struct decimal {
  uint64_t digits;    /* modulo 2^64, so true while digit_count is at most MAX_DIGITS */
  size_t digit_count; /* zeros in front included */
  int64_t exponent;
  bool negative;
} decimal;

enum {
  MAX_DIGITS = 19,         /* 10^19 < 2^64 */
  MAX_POWER = 27,          /* 5^27 < 2^63 */
  MAX_EXPONENT = 100000,   /* far beyond any finite double; stops the sum from running over */
  MAX_NUMBER_LENGTH = 1200 /* no double needs more than 770 digits; what is longer is no number that we want */
};

/* Takes digits into the number; returns one past them. */
static const char *take_digits(const char *at, const char *end, decimal *number) {
  const char *start = at;
  uint64_t digits = number->digits;
  for (; at < end && is_digit(*at); ++at) {
    digits = digits * 10 + (uint64_t)(*at - '0');
  }
  number->digits = digits;
  number->digit_count += (size_t)(at - start);
  return at;
}

/* The exponent behind the digits, if there is one: "1e" and "1exit" are the number 1 followed by something else. */
static const char *take_exponent(const char *at, const char *end, decimal *number) {
  if (at == end || lower(*at) != 'e') {
    return at;
  }
  const char *digits = at + 1;
  const bool negative = digits < end && *digits == '-';
  if (digits < end && (*digits == '-' || *digits == '+')) {
    ++digits;
  }
  if (digits == end || !is_digit(*digits)) {
    return at;
  }
  int64_t exponent = 0;
  for (; digits < end && is_digit(*digits); ++digits) {
    exponent = exponent < MAX_EXPONENT ? exponent * 10 + (*digits - '0') : exponent;
  }
  number->exponent += negative ? -exponent : exponent;
  return digits;
}

/* Sign, digits and exponent of the number at `at`; NULL when there is none. */
static const char *take_decimal(const char *at, const char *end, decimal *number) {
  *number = (decimal){0};
  if (at < end && (*at == '-' || *at == '+')) {
    number->negative = *at++ == '-';
  }
  at = take_digits(at, end, number);
  if (at < end && *at == '.') {
    const char *fraction = at + 1;
    at = take_digits(fraction, end, number);
    number->exponent = -(int64_t)(at - fraction);
  }
  return number->digit_count > 0 ? take_exponent(at, end, number) : NULL;
}

static uint64_t power_of_five(int exponent) {
  static const uint64_t POWERS[MAX_POWER + 1] = {1ULL,
                                                 5ULL,
                                                 25ULL,
                                                 125ULL,
                                                 625ULL,
                                                 3125ULL,
                                                 15625ULL,
                                                 78125ULL,
                                                 390625ULL,
                                                 1953125ULL,
                                                 9765625ULL,
                                                 48828125ULL,
                                                 244140625ULL,
                                                 1220703125ULL,
                                                 6103515625ULL,
                                                 30517578125ULL,
                                                 152587890625ULL,
                                                 762939453125ULL,
                                                 3814697265625ULL,
                                                 19073486328125ULL,
                                                 95367431640625ULL,
                                                 476837158203125ULL,
                                                 2384185791015625ULL,
                                                 11920928955078125ULL,
                                                 59604644775390625ULL,
                                                 298023223876953125ULL,
                                                 1490116119384765625ULL,
                                                 7450580596923828125ULL};
  return POWERS[exponent];
}

/* digits * 10^exponent for |exponent| <= MAX_POWER, by integers; see the top of the file. */
static double decimal_by_integers(uint64_t digits, int exponent) {
  if (exponent >= 0) {
    return ldexp((double)((wide)digits * power_of_five(exponent)), exponent);
  }
  const int shift = __builtin_clzll(digits) + 63;
  const wide numerator = (wide)digits << shift;
  const uint64_t divisor = power_of_five(-exponent);
  wide quotient = numerator / divisor;
  quotient |= quotient * divisor != numerator;
  return ldexp((double)quotient, exponent - shift);
}

/* The text from `at` to `stop` by the C library. */
static bool decimal_by_library(const char *at, const char *stop, double *value) {
  char text[MAX_NUMBER_LENGTH + 1];
  const size_t length = (size_t)(stop - at);
  if (length > MAX_NUMBER_LENGTH) {
    return false;
  }
  memcpy(text, at, length);
  text[length] = 0;
  // The "C" locale is a constant of the C library, so this neither allocates nor takes long; uselocale() is for this
  // thread only.
  const locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  if (plain == (locale_t)0) {
    return false;
  }
  const locale_t previous = uselocale(plain);
  *value = strtod(text, NULL);
  uselocale(previous);
  freelocale(plain);
  return isfinite(*value);
}

const char *laves__parse_double(const char *at, const char *end, double *value) {
  static const double TENS[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  decimal number;
  const char *stop = take_decimal(at, end, &number);
  if (stop == NULL) {
    return NULL;
  }
  double magnitude;
  if (number.digit_count <= MAX_DIGITS && number.digits == 0) {
    magnitude = 0;
  } else if (number.digit_count > MAX_DIGITS || number.exponent < -MAX_POWER || number.exponent > MAX_POWER) {
    return decimal_by_library(at, stop, value) ? stop : NULL;
  } else if (number.digits <= (1ULL << 53) && number.exponent >= -22 && number.exponent <= 0) {
    magnitude = (double)number.digits / TENS[-number.exponent];
  } else if (number.digits <= (1ULL << 53) && number.exponent > 0 && number.exponent <= 22) {
    magnitude = (double)number.digits * TENS[number.exponent];
  } else {
    magnitude = decimal_by_integers(number.digits, (int)number.exponent);
  }
  *value = number.negative ? -magnitude : magnitude;
  return stop;
}

/* ---- messages ---- */

size_t laves__scan_line(const laves__scan *scan) {
  size_t line = 1;
  for (const char *at = scan->begin; at < scan->at;) {
    if (is_line_end(*at)) {
      at = behind_line_end(at, scan->end);
      line += at <= scan->at;
    } else {
      ++at;
    }
  }
  return line;
}

laves_result laves__scan_fail(const laves__scan *scan, laves_error *error, const char *format, ...) {
  char sentence[400];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(sentence, sizeof sentence, format, arguments);
  va_end(arguments);
  return laves__fail(error, LAVES_ERROR_INPUT, "%s%sline %zu: %s", scan->name ? scan->name : "", scan->name ? ", " : "",
                     laves__scan_line(scan), sentence);
}

laves_result laves__scan_fail_expected(const laves__scan *scan, laves_error *error, const char *what) {
  laves__scan ahead = *scan;
  laves__word word;
  if (laves__scan_word(&ahead, &word)) {
    char text[LAVES__QUOTE_SIZE];
    return laves__scan_fail(scan, error, "expected %s, found '%s'", what, laves__quote(word, text));
  }
  return laves__scan_fail(scan, error, "expected %s, but the %s ends", what, laves__scan_space(&ahead) ? "line" : "file");
}

const char *laves__quote(laves__word word, char text[LAVES__QUOTE_SIZE]) {
  const size_t room = LAVES__QUOTE_SIZE - 1;
  const size_t length = word.length < room ? word.length : room;
  for (size_t i = 0; i < length; ++i) {
    text[i] = word.at[i] >= ' ' && word.at[i] <= '~' ? word.at[i] : '?';
  }
  if (word.length > room) {
    memcpy(text + room - 3, "...", 3);
  }
  text[length] = 0;
  return text;
}
