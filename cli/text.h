/* Words for people: messages on stderr, numbers with units, and what the terminal can show. */
#ifndef LAVES_CLI_TEXT_H
#define LAVES_CLI_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A buffer for one formatted number; functions below return it so that they can be used inside printf calls. */
typedef struct text_buffer {
  char text[48];
} text_buffer;

/* "1,234,567" */
const char *text_count(text_buffer *buffer, uint64_t count);
/* "1 tet", "2 tets": the count and the noun, with an s where needed */
const char *text_plural(text_buffer *buffer, uint64_t count, const char *noun);
/* "3.2 MB", in powers of 1000 */
const char *text_bytes(text_buffer *buffer, double bytes);
/* "12 ms", "3.4 s", "2 min 5 s" */
const char *text_seconds(text_buffer *buffer, double seconds);
/* "(1.2, 3, -0.5)" */
const char *text_place(text_buffer *buffer, const double place[3]);

/* Whether stderr is a terminal that understands a carriage return. */
bool text_is_terminal(void);
/* Whether colours are wanted there: a terminal, no NO_COLOR, TERM not "dumb". */
bool text_has_colour(void);
/* Whether the locale writes UTF-8; else only ASCII is printed. Needs setlocale() before. */
bool text_is_utf8(void);
/* "°" or " deg" */
const char *text_degree(void);

/* One line on stderr each: plain, "laves: error: ...", "laves: warning: ...". */
void text_say(const char *format, ...) __attribute__((format(printf, 1, 2)));
void text_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
void text_warning(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Sends to the standard output what waits for it. False, and errno tells why, when anything written to it was lost. */
bool text_flush_output(void);

/* The known word, in lower case, that is nearest to a misspelt one, or NULL when none is near. */
const char *text_nearest(const char *word, const char *const *known, size_t count);

/* The part of a path after the last slash. */
const char *text_base_name(const char *path);

#endif
