/* Numbers as text.
 *
 * Doubles use Schubfach: [giulietti2020] Raffaello Giulietti, "The Schubfach way to render doubles", 2020. A double
 * v = c 2^q has a rounding interval of width about 2^q. With 10^k the largest power of ten not above that width, the
 * interval holds one or more multiples of 10^k, at most one multiple of 10^(k+1), and the shortest decimal is among them.
 * All comparisons are made on v 10^-k and the interval's ends, scaled by four and rounded to odd, which one 64 by 128-bit
 * product each yields exactly enough.
 *
 * Then the digits are laid out: plainly where the decimal point falls within or near them, else with an exponent. */
#include "io/number_text.h"

#include <stdbool.h>
#include <string.h>

__extension__ typedef unsigned __int128 u128;

static const char digit_pairs[] =
    "00010203040506070809101112131415161718192021222324252627282930313233343536373839404142434445464748495051525354555657585960"
    "616263646566676869707172737475767778798081828384858687888990919293949596979899";

static int digit_count(uint64_t value) {
  int count = 1;
  for (; value >= 10000; value /= 10000) count += 4;
  return count + (value >= 10) + (value >= 100) + (value >= 1000);
}

/* Writes exactly `count` digits of value. */
static char *put_digits(char *text, uint64_t value, int count) {
  char *at = text + count;
  for (; value >= 100; value /= 100) memcpy(at -= 2, &digit_pairs[value % 100 * 2], 2);
  if (value >= 10)
    memcpy(at - 2, &digit_pairs[value * 2], 2);
  else
    at[-1] = (char)('0' + value);
  return text + count;
}

char *laves__put_integer(char *text, int64_t value) {
  uint64_t magnitude = (uint64_t)value;
  if (value < 0) {
    *text++ = '-';
    magnitude = 0 - magnitude;
  }
  return put_digits(text, magnitude, digit_count(magnitude));
}

typedef struct decimal {
  uint64_t digits;
  int exponent;
} decimal;

/* The product shifted right by 128 bits, with its lowest bit set when anything was lost (but for the table's own error). */
static uint64_t round_to_odd(const uint64_t power[2], uint64_t c) {
  const u128 low = (u128)power[1] * c;
  const u128 high = (u128)power[0] * c + (uint64_t)(low >> 64);
  return (uint64_t)(high >> 64) | ((uint64_t)high > 1);
}

/* [giulietti2020]: floor of log10(2^q), of log10(3/4 2^q), and of log2(10^e), exact for all doubles. */
static int floor_log10_pow2(int q) { return (q * 1262611) >> 22; }
static int floor_log10_three_quarters_pow2(int q) { return (q * 1262611 - 524031) >> 22; }
static int floor_log2_pow10(int e) { return (e * 1741647) >> 19; }

/* The shortest decimal in the rounding interval of c 2^q, the nearest of those; c > 0. `closer` says that the double below
 * is only half as far away as the one above. */
static decimal shortest(uint64_t c, int q, bool closer) {
  const uint64_t odd = c & 1;
  const int k = closer ? floor_log10_three_quarters_pow2(q) : floor_log10_pow2(q);
  const int shift = q + floor_log2_pow10(-k) + 1;
  const uint64_t *power = laves__pow10_table[-k - LAVES__POW10_FIRST];
  const uint64_t lower = round_to_odd(power, (4 * c - 2 + closer) << shift) + odd;
  const uint64_t middle = round_to_odd(power, (4 * c) << shift);
  const uint64_t upper = round_to_odd(power, (4 * c + 2) << shift) - odd;
  const uint64_t s = middle / 4;
  if (s >= 10) {
    const uint64_t t = s / 10;
    const bool below = lower <= 40 * t, above = 40 * t + 40 <= upper;
    if (below != above) return (decimal){t + above, k + 1};
  }
  const bool below = lower <= 4 * s, above = 4 * s + 4 <= upper;
  if (below != above) return (decimal){s + above, k};
  const uint64_t half = 4 * s + 2;
  return (decimal){s + (middle > half || (middle == half && (s & 1))), k};
}

static char *put_decimal(char *text, decimal d) {
  while (d.digits % 10 == 0) {
    d.digits /= 10;
    d.exponent++;
  }
  const int count = digit_count(d.digits);
  const int point = count + d.exponent; /* value = 0.digits * 10^point */
  if (d.exponent >= 0 && point <= 17) {
    text = put_digits(text, d.digits, count);
    memset(text, '0', (size_t)d.exponent);
    return text + d.exponent;
  }
  if (point > 0 && point <= 17) {
    char *end = put_digits(text + 1, d.digits, count);
    memmove(text, text + 1, (size_t)point);
    text[point] = '.';
    return end;
  }
  if (point <= 0 && point > -4) {
    memcpy(text, "0.000", 5);
    return put_digits(text + 2 - point, d.digits, count);
  }
  char *end = put_digits(text + 1, d.digits, count);
  text[0] = text[1];
  text[1] = '.';
  if (count == 1) end = text + 1;
  *end++ = 'e';
  return laves__put_integer(end, point - 1);
}

/* The shortest decimal of a double above zero. */
static decimal shortest_of(uint64_t fraction, int exponent) {
  const uint64_t c = exponent ? fraction | UINT64_C(1) << 52 : fraction;
  const int q = exponent ? exponent - 1075 : -1074;
  const bool small_integer = q <= 0 && q > -53 && (c & ((UINT64_C(1) << -q) - 1)) == 0;
  return small_integer ? (decimal){c >> -q, 0} : shortest(c, q, fraction == 0 && exponent > 1);
}

char *laves__put_double(char *text, double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  const uint64_t fraction = bits & ((UINT64_C(1) << 52) - 1);
  const int exponent = (int)(bits >> 52 & 0x7ff);
  const bool negative = bits >> 63;
  if (exponent == 0x7ff && fraction) return (char *)memcpy(text, "nan", 3) + 3;
  if (negative) *text++ = '-';
  if (exponent == 0x7ff) return (char *)memcpy(text, "inf", 3) + 3;
  if (exponent == 0 && fraction == 0) {
    *text++ = '0';
    return text;
  }
  return put_decimal(text, shortest_of(fraction, exponent));
}

/* ---- fields ---- */

/* d with its last `count` digits rounded away. */
static decimal rounded(decimal d, int count) {
  uint64_t unit = 1;
  for (int i = 0; i < count; i++) unit *= 10;
  return (decimal){(d.digits + unit / 2) / unit, d.exponent + count};
}

/* Plain where the point is within or next to the digits, else with an exponent. */
static char *put_field(char *text, decimal d) {
  enum { PLAIN_MAX = 12 };
  while (d.digits % 10 == 0) {
    d.digits /= 10;
    d.exponent++;
  }
  char digits[20];
  const int count = digit_count(d.digits), point = count + d.exponent; /* value = 0.digits * 10^point */
  put_digits(digits, d.digits, count);
  const bool plain = point >= -2 && point <= PLAIN_MAX;
  const int before = plain ? (point > 0 ? point : 0) : 1; /* digits, or zeros behind them, before the point */
  for (int i = 0; i < before; i++) *text++ = i < count ? digits[i] : '0';
  *text++ = '.';
  for (int i = point; plain && i < 0; i++) *text++ = '0';
  for (int i = before; i < count; i++) *text++ = digits[i];
  if (plain) return text;
  *text++ = 'E';
  return laves__put_integer(text, point - 1);
}

char *laves__put_double_field(char *text, double value, int width) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  const uint64_t fraction = bits & ((UINT64_C(1) << 52) - 1);
  const int exponent = (int)(bits >> 52 & 0x7ff);
  const bool zero = exponent == 0 && fraction == 0, negative = bits >> 63 && !zero;
  if (zero || exponent == 0x7ff) return (char *)memcpy(text, "0.", 2) + 2;
  if (negative) *text++ = '-';
  const decimal d = shortest_of(fraction, exponent);
  for (int dropped = 0;; dropped++) {
    char field[LAVES__DOUBLE_TEXT_MAX + 2];
    const size_t length = (size_t)(put_field(field, rounded(d, dropped)) - field);
    if (length + negative > (size_t)width) continue;
    memcpy(text, field, length);
    return text + length;
  }
}
