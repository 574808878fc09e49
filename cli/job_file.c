/* Reads the text of a job file: a small part of TOML, or JSON of the same shape.
 *
 * One scanner walks over the bytes and counts lines; both grammars are made of the same values. Texts are decoded into an arena
 * as long as the file twice over, which no text can outgrow: a decoded character is never longer than its spelling, and each
 * text has at least one byte of spelling for its NUL. Nothing recurses: depth is what the grammar has, two. */
#include "job_file.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct scanner {
  const char *at, *end;
  int line;
  bool json;
  char *arena;
  size_t used;
  job_entry entry;
  job_take_fn *take;
  void *user;
  job_error *error;
} scanner;

static bool fail(scanner *s, const char *format, ...) __attribute__((format(printf, 2, 3)));
static bool fail(scanner *s, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  s->error->line = s->line;
  vsnprintf(s->error->text, sizeof s->error->text, format, arguments);
  va_end(arguments);
  return false;
}

/* ---- characters ---- */

/* The next byte, or 0 at the end; a byte 0 in the file is refused by all that follows, as any other control character. */
static char peek(const scanner *s) { return s->at < s->end ? *s->at : '\0'; }

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

static bool is_bare(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) || c == '_' || c == '-'; }

static bool take_char(scanner *s, char wanted) {
  if (s->at == s->end || *s->at != wanted) return false;
  ++s->at;
  return true;
}

static void skip_spaces(scanner *s) {
  while (peek(s) == ' ' || peek(s) == '\t') ++s->at;
}

static void skip_comment(scanner *s) {
  if (s->json || peek(s) != '#') return;
  while (s->at < s->end && *s->at != '\n') ++s->at;
}

/* Spaces, ends of lines, and comments where there are any. */
static void skip_blank(scanner *s) {
  for (;;) {
    skip_spaces(s);
    skip_comment(s);
    if (take_char(s, '\n')) {
      ++s->line;
    } else if (peek(s) == '\r' && s->at + 1 < s->end && s->at[1] == '\n') {
      ++s->at;
    } else {
      return;
    }
  }
}

/* "'x'" for messages; what is not printable is told by its code. */
static const char *name_next(const scanner *s, char *text, size_t size) {
  const unsigned char c = (unsigned char)peek(s);
  if (s->at == s->end) {
    snprintf(text, size, "the end of the file");
  } else if (c == '\n' || c == '\r') {
    snprintf(text, size, "the end of the line");
  } else if (c < 0x20 || c >= 0x7f) {
    snprintf(text, size, "a byte %u", c);
  } else {
    snprintf(text, size, "'%c'", c);
  }
  return text;
}

static bool fail_next(scanner *s, const char *wanted) {
  char text[40];
  return fail(s, "%s is wanted here, not %s", wanted, name_next(s, text, sizeof text));
}

/* ---- texts ---- */

static void keep(scanner *s, char c) { s->arena[s->used++] = c; }

/* Length of the UTF-8 sequence that begins here, 0 when it is none (RFC 3629). */
static size_t sequence_length(const scanner *s) {
  const unsigned char *at = (const unsigned char *)s->at;
  const size_t left = (size_t)(s->end - s->at);
  const size_t length = at[0] < 0x80                     ? 1
                        : at[0] >= 0xc2 && at[0] <= 0xdf ? 2
                        : (at[0] & 0xf0) == 0xe0         ? 3
                        : at[0] >= 0xf0 && at[0] <= 0xf4 ? 4
                                                         : 0;
  if (length == 0 || length > left) return 0;
  for (size_t i = 1; i < length; ++i) {
    if ((at[i] & 0xc0) != 0x80) return 0;
  }
  const bool overlong = (at[0] == 0xe0 && at[1] < 0xa0) || (at[0] == 0xf0 && at[1] < 0x90);
  const bool beyond = (at[0] == 0xed && at[1] > 0x9f) || (at[0] == 0xf4 && at[1] > 0x8f);
  return overlong || beyond ? 0 : length;
}

static void keep_code(scanner *s, uint32_t code) {
  if (code < 0x80) {
    keep(s, (char)code);
  } else if (code < 0x800) {
    keep(s, (char)(0xc0 | code >> 6));
    keep(s, (char)(0x80 | (code & 0x3f)));
  } else if (code < 0x10000) {
    keep(s, (char)(0xe0 | code >> 12));
    keep(s, (char)(0x80 | (code >> 6 & 0x3f)));
    keep(s, (char)(0x80 | (code & 0x3f)));
  } else {
    keep(s, (char)(0xf0 | code >> 18));
    keep(s, (char)(0x80 | (code >> 12 & 0x3f)));
    keep(s, (char)(0x80 | (code >> 6 & 0x3f)));
    keep(s, (char)(0x80 | (code & 0x3f)));
  }
}

/* So many hexadecimal digits. */
static bool take_code(scanner *s, int digits, uint32_t *code) {
  *code = 0;
  for (int i = 0; i < digits; ++i) {
    const char c = peek(s);
    const int value = is_digit(c) ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
    if (value < 0) return fail(s, "\\%c needs %d hexadecimal digits", digits == 4 ? 'u' : 'U', digits);
    *code = *code << 4 | (uint32_t)value;
    ++s->at;
  }
  return true;
}

/* Behind \u or \U; in JSON two of \u may make one character. */
static bool take_unicode(scanner *s, int digits) {
  uint32_t code, low;
  if (!take_code(s, digits, &code)) return false;
  if (s->json && code >= 0xd800 && code < 0xdc00) {
    if (!take_char(s, '\\') || !take_char(s, 'u')) return fail(s, "\\u%04x is half a character", (unsigned)code);
    if (!take_code(s, 4, &low)) return false;
    if (low < 0xdc00 || low > 0xdfff) return fail(s, "\\u%04x is half a character", (unsigned)code);
    code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
  }
  if (code < 0x20 || code == 0x7f || (code >= 0xd800 && code < 0xe000) || code > 0x10ffff)
    return fail(s, "a text cannot hold the character U+%04X", (unsigned)code);
  keep_code(s, code);
  return true;
}

/* Behind a backslash. Ends of lines and the like are no part of any setting. */
static bool take_escape(scanner *s) {
  const char c = peek(s);
  if (c == 'u' || (c == 'U' && !s->json)) {
    ++s->at;
    return take_unicode(s, c == 'u' ? 4 : 8);
  }
  if (c != '"' && c != '\\' && !(c == '/' && s->json)) return fail(s, "only \\\", \\\\ and \\u are known in a text");
  keep(s, c);
  ++s->at;
  return true;
}

static bool take_letter(scanner *s) {
  const size_t length = sequence_length(s);
  if (length == 0) return fail(s, "a text that is not UTF-8");
  if ((unsigned char)*s->at < 0x20 || *s->at == 0x7f) return fail_next(s, "a text on one line without control characters");
  for (size_t i = 0; i < length; ++i) keep(s, *s->at++);
  return true;
}

/* "text", or 'text' in TOML, where backslashes are plain. *text: in the arena. */
static bool take_text(scanner *s, const char **text) {
  const char quote = *s->at++;
  *text = s->arena + s->used;
  if (!s->json && s->end - s->at >= 2 && s->at[0] == quote && s->at[1] == quote)
    return fail(s, "texts of several lines are not known here");
  while (peek(s) != quote) {
    if (s->at == s->end || *s->at == '\n' || *s->at == '\r') return fail(s, "a text without its closing %c", quote);
    if (quote == '"' && take_char(s, '\\') ? !take_escape(s) : !take_letter(s)) return false;
  }
  ++s->at;
  keep(s, '\0');
  return true;
}

/* ---- numbers ---- */

/* Digits, in TOML with underscores between; false when there is none. */
static bool take_digits(scanner *s) {
  bool any = false;
  while (is_digit(peek(s)) || (any && !s->json && peek(s) == '_')) {
    if (*s->at == '_') {
      if (s->at + 1 == s->end || !is_digit(s->at[1])) return false;
    } else {
      keep(s, *s->at);
    }
    any = true;
    ++s->at;
  }
  return any;
}

static bool take_number_parts(scanner *s) {
  if (peek(s) == '-' || (peek(s) == '+' && !s->json)) keep(s, *s->at++);
  if (peek(s) == '0' && s->at + 1 < s->end && is_digit(s->at[1])) return false;
  if (!take_digits(s)) return false;
  if (peek(s) == '.') {
    keep(s, *s->at++);
    if (!take_digits(s)) return false;
  }
  if (peek(s) == 'e' || peek(s) == 'E') {
    keep(s, *s->at++);
    if (peek(s) == '-' || peek(s) == '+') keep(s, *s->at++);
    if (!take_digits(s)) return false;
  }
  return !is_bare(peek(s)) && peek(s) != '.' && peek(s) != ':';
}

static bool take_number(scanner *s, const char **text) {
  *text = s->arena + s->used;
  if (!take_number_parts(s)) return fail(s, "a number in decimal digits is wanted here; dates and other words go in quotes");
  keep(s, '\0');
  return true;
}

/* ---- values ---- */

static bool is_quote(const scanner *s, char c) { return c == '"' || (c == '\'' && !s->json); }

/* A text or number becomes the entry's next item. */
static bool take_item(scanner *s) {
  job_entry *e = &s->entry;
  const char c = peek(s);
  if (e->count == JOB_ITEMS_MAX) return fail(s, "an array of more than %d items", JOB_ITEMS_MAX);
  e->is_text[e->count] = is_quote(s, c);
  if (!is_quote(s, c) && !is_digit(c) && c != '-' && (c != '+' || s->json)) return fail_next(s, "a text in quotes or a number");
  if (!(is_quote(s, c) ? take_text : take_number)(s, &e->items[e->count])) return false;
  ++e->count;
  return true;
}

static bool take_array(scanner *s) {
  ++s->at;
  for (;;) {
    skip_blank(s);
    if (peek(s) == ']' && (!s->json || s->entry.count == 0)) return take_char(s, ']');
    if (!take_item(s)) return false;
    skip_blank(s);
    if (take_char(s, ']')) return true;
    if (!take_char(s, ',')) return fail_next(s, "a comma or ]");
  }
}

static bool take_word(scanner *s, const char *word) {
  const size_t length = strlen(word);
  if ((size_t)(s->end - s->at) < length || memcmp(s->at, word, length) != 0) return false;
  if ((size_t)(s->end - s->at) > length && is_bare(s->at[length])) return false;
  s->at += length;
  return true;
}

/* The value of the entry, whose key is known. */
static bool take_value(scanner *s) {
  job_entry *e = &s->entry;
  const char c = peek(s);
  e->count = 0;
  if (c == '[') {
    e->kind = JOB_ARRAY;
    return take_array(s);
  }
  if (c == '{') return fail(s, s->json ? "tables within tables are not known here" : "tables in braces are not known here");
  if (take_word(s, "true") || take_word(s, "false")) {
    e->kind = c == 't' ? JOB_TRUE : JOB_FALSE;
    return true;
  }
  if (!is_quote(s, c) && !is_digit(c) && c != '-' && (c != '+' || s->json))
    return fail_next(s, "a text in quotes, a number, true, false or an array");
  e->kind = is_quote(s, c) ? JOB_TEXT : JOB_NUMBER;
  return take_item(s);
}

static bool hand_over(scanner *s) {
  if (s->take(s->user, &s->entry, s->error)) return true;
  s->error->line = s->entry.line;
  return false;
}

/* ---- TOML ---- */

/* bare-key or "key" */
static bool take_key(scanner *s, const char **key) {
  if (is_quote(s, peek(s))) return take_text(s, key);
  if (!is_bare(peek(s))) return fail_next(s, "a key");
  *key = s->arena + s->used;
  while (is_bare(peek(s))) keep(s, *s->at++);
  keep(s, '\0');
  return true;
}

/* The name of a table, behind [. */
static bool take_table(scanner *s) {
  if (peek(s) == '[') return fail(s, "arrays of tables are not known here");
  skip_spaces(s);
  if (!take_key(s, &s->entry.table)) return false;
  skip_spaces(s);
  if (peek(s) == '.') return fail(s, "tables within tables are not known here");
  return take_char(s, ']') || fail_next(s, "]");
}

static bool take_setting(scanner *s) {
  s->entry.line = s->line;
  if (!take_key(s, &s->entry.key)) return false;
  skip_spaces(s);
  if (peek(s) == '.') return fail(s, "keys with dots are not known here");
  if (!take_char(s, '=')) return fail_next(s, "=");
  skip_spaces(s);
  return take_value(s) && hand_over(s);
}

static bool parse_toml(scanner *s) {
  for (;;) {
    skip_blank(s);
    if (s->at == s->end) return true;
    if (!(take_char(s, '[') ? take_table : take_setting)(s)) return false;
    skip_spaces(s);
    skip_comment(s);
    if (s->at < s->end && *s->at != '\n' && *s->at != '\r') return fail_next(s, "the end of the line");
  }
}

/* ---- JSON ---- */

/* "key": */
static bool take_json_key(scanner *s, const char **key) {
  skip_blank(s);
  s->entry.line = s->line;
  if (peek(s) != '"') return fail_next(s, "a key in quotes");
  if (!take_text(s, key)) return false;
  skip_blank(s);
  if (!take_char(s, ':')) return fail_next(s, ":");
  skip_blank(s);
  return true;
}

/* Behind a member: whether there is another. */
static bool take_json_next(scanner *s, bool *more) {
  skip_blank(s);
  *more = take_char(s, ',');
  return *more || take_char(s, '}') || fail_next(s, "a comma or }");
}

static bool is_empty_object(scanner *s) {
  skip_blank(s);
  return take_char(s, '}');
}

/* The members of a table, behind its brace. */
static bool parse_json_table(scanner *s) {
  bool more = !is_empty_object(s);
  while (more) {
    if (!take_json_key(s, &s->entry.key) || !take_value(s) || !hand_over(s) || !take_json_next(s, &more)) return false;
  }
  return true;
}

static bool parse_json(scanner *s) {
  ++s->at;
  bool more = !is_empty_object(s);
  while (more) {
    if (!take_json_key(s, &s->entry.key)) return false;
    if (take_char(s, '{')) {
      s->entry.table = s->entry.key;
      if (!parse_json_table(s)) return false;
      s->entry.table = "";
    } else if (!take_value(s) || !hand_over(s)) {
      return false;
    }
    if (!take_json_next(s, &more)) return false;
  }
  skip_blank(s);
  return s->at == s->end || fail_next(s, "the end of the file");
}

bool job_file_parse(const char *bytes, size_t length, job_take_fn *take, void *user, job_error *error) {
  *error = (job_error){0};
  scanner s = {.at = bytes, .end = bytes + length, .line = 1, .take = take, .user = user, .error = error};
  if (length > JOB_BYTES_MAX) {
    s.line = 0;
    return fail(&s, "it has more than %d bytes", JOB_BYTES_MAX);
  }
  s.arena = malloc(2 * length + 1);
  if (!s.arena) return false;
  s.entry.table = "";
  if (length >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0) s.at += 3;
  skip_blank(&s);
  s.json = peek(&s) == '{';
  const bool right = s.json ? parse_json(&s) : parse_toml(&s);
  free(s.arena);
  return right;
}
