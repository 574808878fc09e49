/* Numbers as text, fast and independent of the locale: integers by hand, doubles in the shortest form that reads back as
 * the same double. */
#ifndef LAVES_IO_NUMBER_TEXT_H
#define LAVES_IO_NUMBER_TEXT_H

#include <stdint.h>

/* The most characters that one number takes. */
enum { LAVES__INTEGER_TEXT_MAX = 20, LAVES__DOUBLE_TEXT_MAX = 25 };

enum { LAVES__POW10_FIRST = -292, LAVES__POW10_LAST = 324 };
extern const uint64_t laves__pow10_table[LAVES__POW10_LAST - LAVES__POW10_FIRST + 1][2];

/* Both write at `text` without a NUL and return the end of what they wrote. */
char *laves__put_integer(char *text, int64_t value);
/* "nan", "inf" and "-inf" for values that are not finite. */
char *laves__put_double(char *text, double value);
/* The same in at most `width` characters, 16 or more, for formats with fields: the shortest form where it fits, else rounded to
 * as many digits as do. Always with a point and with 'E', as programs in Fortran want real numbers: "1.", ".5", "2.5E-9". For
 * finite values; 0 for others. */
char *laves__put_double_field(char *text, double value, int width);

#endif
