/* Elementary functions written out, so that every machine yields the same bits and plain loops over them vectorise.
 *
 * Reduction and polynomials after fdlibm (Sun Microsystems, 1993: k_sin.c, k_cos.c, e_exp.c), rounding by adding and
 * taking away 1.5 * 2^52. Errors are below 2 ulp, or 2e-16 absolutely near the zeros of sine and cosine, while the argument
 * stays below 1e6; sine and cosine lose digits in proportion beyond that, and beyond 2^50 they stay what they are there, since
 * then there is nothing left to reduce. No function returns NaN or infinity for
 * finite arguments: square roots and logarithms of what is negative are those of zero or of the smallest normal number,
 * exponentials saturate. A solid thus has a sign everywhere. */
#ifndef LAVES_DOMAIN_ELEMENTARY_H
#define LAVES_DOMAIN_ELEMENTARY_H

#include <math.h>
#include <stdint.h>
#include <string.h>

static inline double min_of(double a, double b) { return a < b ? a : b; }
static inline double max_of(double a, double b) { return a > b ? a : b; }

/* To the nearest integer, ties to even; right for |x| < 2^51. */
static inline double round_near(double x) {
  const double magic = 6755399441055744.0;
  return (x + magic) - magic;
}

static inline double floor_of(double x) {
  const double r = round_near(x), down = r > x ? r - 1 : r;
  return fabs(x) < 2251799813685248.0 ? down : x;
}

/* a - b floor(a / b), in [0, b) but for rounding; 0 where the quotient is no number, as for b = 0. */
static inline double mod_of(double a, double b) {
  const double quotient = b != 0 ? a / b : 0, rest = a - b * floor_of(quotient);
  return b == 0 || fabs(quotient) > 1.7976931348623157e308 ? 0 : rest;
}

/* sin(x + quarter pi / 2) for quarter 0 or 1. */
static inline double sine_shifted(double x, double quarter) {
  const double two_over_pi = 0.63661977236758134308, furthest = 1125899906842624.0;
  x = min_of(furthest, max_of(-furthest, x)); /* in this order NaN stays NaN */
  const double k = round_near(x * two_over_pi);
  const double r = ((x - k * 1.57079632673412561417e+00) - k * 6.07710050630396597660e-11) - k * 2.02226624879595063154e-21;
  const double z = r * r;
  const double s =
      r + r * z *
              (-1.66666666666666324348e-01 +
               z * (8.33333333332248946124e-03 +
                    z * (-1.98412698298579493134e-04 +
                         z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
  const double c =
      1.0 - 0.5 * z +
      z * z *
          (4.16666666666666019037e-02 +
           z * (-1.38888888888741095749e-03 +
                z * (2.48015872894767294178e-05 +
                     z * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
  const double turns = k + quarter;
  const double m = turns - 4 * round_near(turns * 0.25 - 0.375);                        /* 0, 1, 2 or 3 */
  const double lower_half = round_near(m * 0.5 - 0.25), is_cosine = m - 2 * lower_half; /* 0 or 1 */
  return (s * (1 - is_cosine) + c * is_cosine) * (1 - 2 * lower_half);
}

static inline double sin_of(double x) { return sine_shifted(x, 0); }
static inline double cos_of(double x) { return sine_shifted(x, 1); }

/* Saturates at exp(-708) and exp(709). */
static inline double exp_of(double x) {
  x = min_of(max_of(x, -708), 709);
  const double k = round_near(x * 1.44269504088896338700);
  const double r = (x - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
  double p = 1.0 / 6227020800.0; /* the series of exp to r^13 / 13!, enough for |r| < 0.35 */
  p = p * r + 1.0 / 479001600.0;
  p = p * r + 1.0 / 39916800.0;
  p = p * r + 1.0 / 3628800.0;
  p = p * r + 1.0 / 362880.0;
  p = p * r + 1.0 / 40320.0;
  p = p * r + 1.0 / 5040.0;
  p = p * r + 1.0 / 720.0;
  p = p * r + 1.0 / 120.0;
  p = p * r + 1.0 / 24.0;
  p = p * r + 1.0 / 6.0;
  p = p * r + 0.5;
  p = p * r * r + r + 1.0;
  const double biased = k + (4503599627370496.0 + 1023.0); /* the exponent now stands in the lowest bits */
  uint64_t bits;
  memcpy(&bits, &biased, sizeof bits);
  bits <<= 52;
  double power;
  memcpy(&power, &bits, sizeof power);
  return p * power;
}

/* Of the smallest normal number where x is below it. */
static inline double log_of(double x) {
  x = max_of(x, 2.2250738585072014e-308);
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  const uint64_t shifted = bits - 0x3fe6a09e667f3bcdULL + 0x3ff0000000000000ULL; /* splits at sqrt(1/2) */
  uint64_t exponent_bits = (shifted >> 52) | 0x4330000000000000ULL;
  double exponent;
  memcpy(&exponent, &exponent_bits, sizeof exponent);
  exponent -= 4503599627370496.0 + 1023.0;
  const uint64_t mantissa_bits = (shifted & 0x000fffffffffffffULL) + 0x3fe6a09e667f3bcdULL;
  double m;
  memcpy(&m, &mantissa_bits, sizeof m);
  const double s = (m - 1) / (m + 1), z = s * s; /* log m = 2 atanh s, |s| < 0.172 */
  double p = 1.0 / 21.0;
  p = p * z + 1.0 / 19.0;
  p = p * z + 1.0 / 17.0;
  p = p * z + 1.0 / 15.0;
  p = p * z + 1.0 / 13.0;
  p = p * z + 1.0 / 11.0;
  p = p * z + 1.0 / 9.0;
  p = p * z + 1.0 / 7.0;
  p = p * z + 1.0 / 5.0;
  p = p * z + 1.0 / 3.0;
  return exponent * 6.93147180369123816490e-01 + (2 * s + (2 * s * z * p + exponent * 1.90821492927058770002e-10));
}

/* a^b for a >= 0; a below zero counts as zero. */
static inline double pow_of(double a, double b) {
  const double power = exp_of(b * log_of(a));
  return a > 0 ? power : (b > 0 ? 0.0 : (b < 0 ? power : 1.0));
}

static inline double sqrt_of(double x) { return sqrt(x > 0 ? x : 0); }
static inline double tan_of(double x) { return sin_of(x) / cos_of(x); }
static inline double asin_of(double x) { return asin(min_of(max_of(x, -1), 1)); }
static inline double acos_of(double x) { return acos(min_of(max_of(x, -1), 1)); }
static inline double norm2_of(double a, double b) { return sqrt(a * a + b * b); }
static inline double norm3_of(double a, double b, double c) { return sqrt(a * a + b * b + c * c); }

#endif
