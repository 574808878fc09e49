/* Lines of numbers that several text formats share. */
#ifndef LAVES_IO_WRITE_TEXT_H
#define LAVES_IO_WRITE_TEXT_H

#include "base/vec3.h"
#include "io/number_text.h"
#include "io/output.h"

enum { LAVES__POINT_TEXT_MAX = 3 * (LAVES__DOUBLE_TEXT_MAX + 1) };

/* "x y z" without an end of line; returns the end. */
static inline char *laves__put_point(char *text, laves__vec3 p) {
  text = laves__put_double(text, p.x);
  *text++ = ' ';
  text = laves__put_double(text, p.y);
  *text++ = ' ';
  return laves__put_double(text, p.z);
}

/* "base+a base+b ..." without an end of line; returns the end. */
static inline char *laves__put_indices(char *text, const int32_t *indices, int count, int base) {
  for (int i = 0; i < count; i++) {
    if (i > 0) *text++ = ' ';
    text = laves__put_integer(text, (int64_t)indices[i] + base);
  }
  return text;
}

/* Text of an attribute of XML: what would end it or begin markup is spelled out. */
void laves__write_escaped(laves__output *out, const char *text);

#endif
