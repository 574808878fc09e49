/* Words for people: messages, numbers with units, and what the terminal can show. */
#include "text.h"

#include <ctype.h>
#include <errno.h>
#include <langinfo.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *text_count(text_buffer *buffer, uint64_t count) {
  char digits[24];
  const int length = snprintf(digits, sizeof digits, "%llu", (unsigned long long)count);
  char *out = buffer->text;
  for (int i = 0; i < length; ++i) {
    if (i > 0 && (length - i) % 3 == 0) *out++ = ',';
    *out++ = digits[i];
  }
  *out = '\0';
  return buffer->text;
}

const char *text_plural(text_buffer *buffer, uint64_t count, const char *noun) {
  text_buffer number;
  const bool one = count == 1, vertex = strcmp(noun, "vertex") == 0;
  snprintf(buffer->text, sizeof buffer->text, "%.27s %.16s%s", text_count(&number, count), vertex && !one ? "vertices" : noun,
           one || vertex ? "" : "s");
  return buffer->text;
}

const char *text_bytes(text_buffer *buffer, double bytes) {
  static const char *const units[] = {"bytes", "kB", "MB", "GB", "TB"};
  int unit = 0;
  while (bytes >= 999.5 && unit < 4) {
    bytes /= 1000;
    ++unit;
  }
  snprintf(buffer->text, sizeof buffer->text, "%.3g %s", bytes, units[unit]);
  return buffer->text;
}

const char *text_seconds(text_buffer *buffer, double seconds) {
  if (seconds < 0.9995) {
    snprintf(buffer->text, sizeof buffer->text, "%.3g ms", seconds * 1e3);
  } else if (seconds < 100) {
    snprintf(buffer->text, sizeof buffer->text, "%.3g s", seconds);
  } else if (seconds < 6000) {
    snprintf(buffer->text, sizeof buffer->text, "%d min %d s", (int)seconds / 60, (int)seconds % 60);
  } else {
    snprintf(buffer->text, sizeof buffer->text, "%.3g h", seconds / 3600);
  }
  return buffer->text;
}

const char *text_place(text_buffer *buffer, const double place[3]) {
  snprintf(buffer->text, sizeof buffer->text, "(%.6g, %.6g, %.6g)", place[0], place[1], place[2]);
  return buffer->text;
}

static bool is_dumb(void) {
  const char *term = getenv("TERM");
  return !term || strcmp(term, "dumb") == 0;
}

bool text_is_terminal(void) { return isatty(STDERR_FILENO) && !is_dumb(); }

bool text_has_colour(void) {
  const char *refused = getenv("NO_COLOR");
  return text_is_terminal() && (!refused || refused[0] == '\0');
}

bool text_is_utf8(void) { return strcmp(nl_langinfo(CODESET), "UTF-8") == 0; }

const char *text_degree(void) { return text_is_utf8() ? "\u00b0" : " deg"; }

void text_say(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vfprintf(stderr, format, arguments);
  va_end(arguments);
  fputc('\n', stderr);
}

static void say_with_label(const char *label, const char *colour, const char *format, va_list arguments) {
  if (text_has_colour()) {
    fprintf(stderr, "laves: \033[%sm%s:\033[0m ", colour, label);
  } else {
    fprintf(stderr, "laves: %s: ", label);
  }
  vfprintf(stderr, format, arguments);
  fputc('\n', stderr);
}

void text_error(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  say_with_label("error", "1;31", format, arguments);
  va_end(arguments);
}

void text_warning(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  say_with_label("warning", "1;33", format, arguments);
  va_end(arguments);
}

bool text_flush_output(void) {
  errno = EIO; /* of an earlier loss nothing else is known */
  return fflush(stdout) == 0 && !ferror(stdout);
}

enum { WORD_CAPACITY = 32 };

static size_t least(size_t a, size_t b, size_t c) {
  const size_t ab = a < b ? a : b;
  return ab < c ? ab : c;
}

/* Edit distance with swaps of neighbours counted once (optimal string alignment); both words below WORD_CAPACITY. */
static size_t edit_distance(const char *a, const char *b) {
  size_t table[WORD_CAPACITY][WORD_CAPACITY];
  const size_t rows = strlen(a), columns = strlen(b);
  for (size_t i = 0; i <= rows; ++i) table[i][0] = i;
  for (size_t j = 0; j <= columns; ++j) table[0][j] = j;
  for (size_t i = 1; i <= rows; ++i) {
    for (size_t j = 1; j <= columns; ++j) {
      const size_t change = table[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
      table[i][j] = least(table[i - 1][j] + 1, table[i][j - 1] + 1, change);
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped && table[i - 2][j - 2] + 1 < table[i][j]) table[i][j] = table[i - 2][j - 2] + 1;
    }
  }
  return table[rows][columns];
}

/* A change of every letter is no slip, so words of one letter are near to nothing. */
static size_t most_changes(size_t length) { return (length > 1) + (length > 4) + (length > 8); }

const char *text_nearest(const char *word, const char *const *known, size_t count) {
  char lower[WORD_CAPACITY];
  const size_t length = strlen(word);
  if (length == 0 || length >= WORD_CAPACITY) return NULL;
  for (size_t i = 0; i <= length; ++i) lower[i] = (char)tolower((unsigned char)word[i]);
  const char *begun = NULL, *best = NULL; /* the shortest that begins with the word; the least changed */
  size_t best_distance = most_changes(length) + 1;
  for (size_t i = 0; i < count; ++i) {
    if (strlen(known[i]) >= WORD_CAPACITY) continue;
    const bool begins = length >= 3 && strncmp(known[i], lower, length) == 0;
    if (begins && (!begun || strlen(known[i]) < strlen(begun))) begun = known[i];
    const size_t distance = edit_distance(lower, known[i]);
    if (distance < best_distance) {
      best = known[i];
      best_distance = distance;
    }
  }
  return begun ? begun : best;
}

const char *text_base_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}
