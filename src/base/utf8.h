/* UTF-8: what is text, and what is not (RFC 3629: no overlong forms, no surrogates). */
#ifndef LAVES_BASE_UTF8_H
#define LAVES_BASE_UTF8_H

#include <stdbool.h>
#include <stddef.h>

/* Bytes of the sequence at `text`, 1 to 4, or 0 when it is none. A NUL counts as one; nothing behind it is looked at. */
size_t laves__utf8_length(const unsigned char *text);

/* Whether a text that ends with NUL is UTF-8 all along. */
bool laves__is_utf8(const char *text);

#endif
