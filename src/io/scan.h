/* Reading text: words, numbers and lines of a file that lies in memory.  Used by all readers of text formats.
 *
 * A scan is a window on the bytes and a place in it; nothing is copied and nothing is allocated. Functions that look for
 * something skip blanks before it, stay on the line, and leave the place where it was when they return false; files whose
 * lines do not matter call laves__scan_space() first, which crosses line ends and comments.
 *
 *   laves__scan scan = laves__scan_begin(name, bytes, length);
 *   scan.comment = '#';
 *   while (laves__scan_space(&scan)) {                     // false at the end of the file
 *     double x;
 *     if (!laves__scan_double(&scan, &x)) return laves__scan_fail_expected(&scan, error, "a coordinate");
 *     ...
 *   }
 *
 * Numbers do not depend on the locale and are rounded correctly, as strtod does in the "C" locale. */
#ifndef LAVES_IO_SCAN_H
#define LAVES_IO_SCAN_H

#include "base/base.h"

typedef struct laves__scan {
  const char *begin, *at, *end; /* the bytes, the place, one past the last byte; begin <= at <= end; no NUL is needed */
  const char *name;             /* of the file, for messages; NULL: none */
  char comment;                 /* from this character to the end of the line is skipped; 0 (the default): no comments */
  bool continuation;            /* a backslash before a line end joins the two lines; default false */
} laves__scan;

/* Bytes of the file, not followed by a NUL. */
typedef struct laves__word {
  const char *at;
  size_t length;
} laves__word;

/* A scan of the whole file; skips a UTF-8 byte order mark. `name` must outlive it. */
laves__scan laves__scan_begin(const char *name, const void *bytes, size_t length);

/* ---- between words ---- */

/* Skips spaces, tabs and (with `continuation`) joined line ends, then tells whether something other than a comment is
 * left on the line. */
bool laves__scan_blanks(laves__scan *scan);
/* Skips white space, line ends and comments; false at the end of the file. */
bool laves__scan_space(laves__scan *scan);
/* Goes behind the end of the line, which is LF, CR LF or CR; false when the file ends instead. */
bool laves__scan_next_line(laves__scan *scan);

/* ---- words and numbers; all stay on the line ---- */

/* The next run of characters that are not white space. */
bool laves__scan_word(laves__scan *scan, laves__word *word);
/* The next word if it is this one, in upper or lower case. */
bool laves__scan_keyword(laves__scan *scan, const char *keyword);
/* The rest of the line without blanks at its ends, comments included; may be empty. */
laves__word laves__scan_rest(laves__scan *scan);
/* A finite decimal number that is a whole word: "nan", "inf", "1e999" and "1x" are refused. */
bool laves__scan_double(laves__scan *scan, double *value);
/* A decimal integer that is a whole word. */
bool laves__scan_int(laves__scan *scan, int64_t *value);
/* An integer in [0, limit]. */
bool laves__scan_count(laves__scan *scan, size_t limit, size_t *value);

/* As the above without blanks before and with anything behind: they return one past the number, or NULL. */
const char *laves__parse_double(const char *at, const char *end, double *value);
const char *laves__parse_int(const char *at, const char *end, int64_t *value);

/* True when the word is `text`, in upper or lower case. */
bool laves__word_is(laves__word word, const char *text);

/* ---- messages ---- */

/* Line of the place, from 1. Cost: linear, so for messages only. */
size_t laves__scan_line(const laves__scan *scan);
/* LAVES_ERROR_INPUT with "name, line 12: sentence". */
laves_result laves__scan_fail(const laves__scan *scan, laves_error *error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* The same: "expected a coordinate, found 'x'", or "the line ends" or "the file ends" instead of the word. */
laves_result laves__scan_fail_expected(const laves__scan *scan, laves_error *error, const char *what);

enum { LAVES__QUOTE_SIZE = 40 };
/* Copies a word for use in a message: cut when long, odd bytes as '?'. Returns `text`. */
const char *laves__quote(laves__word word, char text[LAVES__QUOTE_SIZE]);

#endif
