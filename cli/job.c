/* What a job file means: its keys are names of options, as the table of command_table.c has them, and `input`; each becomes a
 * word such as --size=0.5, so that one parser reads both command line and job.
 *
 * Keys outside tables are for whichever command is run, those in a table for the command of that name. All tables are looked
 * through, so that a slip in one of them is found by any run. */
#include "job.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "job_file.h"
#include "text.h"

enum { VALUE_CAPACITY = 1 << 16 };

typedef struct job_reader {
  const command *about;
  const char *path;
  job *said;
  bool is_certificate, no_memory;
  bool seen[OPTION_CAPACITY], seen_input; /* of those that are for this command */
  char value[VALUE_CAPACITY];
} job_reader;

/* ---- words ---- */

/* gcc 12 takes blocks that are kept in members of what it is handed for lost; job_free() frees them. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wanalyzer-malloc-leak"
#endif
static bool grow(job *said) {
  const int capacity = said->capacity ? 2 * said->capacity : 32;
  char **words = realloc(said->words, (size_t)capacity * sizeof *words);
  if (words) said->words = words;
  int *lines = words ? realloc(said->lines, (size_t)capacity * sizeof *lines) : NULL;
  if (lines) said->lines = lines;
  bool *used = lines ? realloc(said->used, (size_t)capacity * sizeof *used) : NULL;
  if (!used) return false;
  said->used = used;
  said->capacity = capacity;
  return true;
}

/* False without memory. */
static bool add_word(job *said, int line, const char *format, ...) __attribute__((format(printf, 3, 4)));
static bool add_word(job *said, int line, const char *format, ...) {
  if (said->count == said->capacity && !grow(said)) return false;
  va_list arguments;
  va_start(arguments, format);
  const int length = vsnprintf(NULL, 0, format, arguments);
  va_end(arguments);
  char *word = length < 0 ? NULL : malloc((size_t)length + 1);
  if (!word) return false;
  va_start(arguments, format);
  vsnprintf(word, (size_t)length + 1, format, arguments);
  va_end(arguments);
  said->words[said->count] = word;
  said->lines[said->count] = line;
  said->used[said->count++] = false;
  return true;
}
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

void job_free(job *said) {
  if (!said) return;
  for (int i = 0; i < said->count; ++i) free(said->words[i]);
  free(said->words);
  free(said->lines);
  free(said->used);
  free(said);
}

/* ---- names of files ---- */

/* Length of the folder in the job's own name, with its slash. */
static int folder_length(const job_reader *r) { return (int)(text_base_name(r->path) - r->path); }

static bool is_there(const job_reader *r, const char *name, size_t length) {
  char path[4096];
  struct stat status;
  const int size = snprintf(path, sizeof path, "%.*s%.*s", folder_length(r), r->path, (int)length, name);
  return size > 0 && (size_t)size < sizeof path && length > 0 && stat(path, &status) == 0;
}

static bool has_word(const char *list, const char *word) {
  const size_t length = strlen(word);
  for (const char *at = list; at && *at; at += strcspn(at, "|"), at += *at == '|') {
    if (strcspn(at, "|") == length && memcmp(at, word, length) == 0) return true;
  }
  return false;
}

/* Bytes of a value that stand before the name of a file in it, or -1 when it names none. What may be an expression as well is a
 * file where there is one. */
static int before_file(const job_reader *r, const char *argument, const char *value) {
  if (value[0] == '/' || strcmp(value, "-") == 0 || strcmp(value, "none") == 0) return -1;
  if (argument[0] == 'P') return strncmp(value, "curve:", 6) == 0 && value[6] != '/' ? 6 : -1; /* PLACE=SIZE[,RADIUS] */
  if (has_word(argument, "FILE")) return has_word(argument, value) ? -1 : 0;
  if (!has_word(argument, "INPUT") && !has_word(argument, "MESH") && !has_word(argument, "FIELD")) return -1;
  const char *colon = strrchr(value, ':');
  const bool there = is_there(r, value, strlen(value)) || (colon && is_there(r, value, (size_t)(colon - value)));
  return there || has_word(argument, "MESH") ? 0 : -1;
}

/* The value with the job's folder before its file; it holds until the next call. NULL: too long. */
static const char *placed_value(job_reader *r, const char *argument, const char *value) {
  const int before = argument ? before_file(r, argument, value) : -1;
  if (before < 0 || folder_length(r) == 0) return value;
  const int size = snprintf(r->value, sizeof r->value, "%.*s%.*s%s", before, value, folder_length(r), r->path, value + before);
  return size > 0 && (size_t)size < sizeof r->value ? r->value : NULL;
}

/* ---- settings ---- */

static bool refuse(job_error *error, const char *format, ...) __attribute__((format(printf, 2, 3)));
static bool refuse(job_error *error, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(error->text, sizeof error->text, format, arguments);
  va_end(arguments);
  return false;
}

static bool finish_word(job_reader *r, bool right) {
  r->no_memory = r->no_memory || !right;
  return right;
}

static bool add_option(job_reader *r, const job_entry *e, const option *row, const char *value, job_error *error) {
  const char *placed = placed_value(r, row->argument, value);
  if (!placed) return refuse(error, "the value of '%.40s' is too long", e->key);
  return finish_word(r, add_word(r->said, e->line, "--%s=%s", row->name, placed));
}

static bool take_input(job_reader *r, const job_entry *e, bool counts, job_error *error) {
  if (e->kind != JOB_TEXT) return refuse(error, "'input' must be a text in quotes");
  if (!counts) return true;
  if (r->seen_input) return refuse(error, "'input' is given twice");
  if (!r->about->argument) return refuse(error, "unknown key 'input': laves %s takes no input", r->about->name);
  if (e->items[0][0] == '-') return refuse(error, "an input cannot begin with a dash; put ./ or a space before it");
  r->seen_input = true;
  const char *placed = placed_value(r, r->about->argument, e->items[0]);
  if (!placed) return refuse(error, "the value of 'input' is too long");
  return finish_word(r, add_word(r->said, e->line, "%s", placed));
}

/* [40, 125] becomes 40,125. */
static bool take_numbers(job_reader *r, const job_entry *e, const option *row, job_error *error) {
  size_t used = 0;
  r->value[0] = '\0';
  for (int i = 0; i < e->count; ++i) {
    if (e->is_text[i]) return refuse(error, "'%.40s' must be an array of numbers, or one text", e->key);
    const int size = snprintf(r->value + used, sizeof r->value - used, "%s%s", i > 0 ? "," : "", e->items[i]);
    if (size < 0 || (size_t)size >= sizeof r->value - used) return refuse(error, "the value of '%.40s' is too long", e->key);
    used += (size_t)size;
  }
  return finish_word(r, add_word(r->said, e->line, "--%s=%s", row->name, r->value));
}

static bool take_array(job_reader *r, const job_entry *e, const option *row, job_error *error) {
  if (row->kind == OPTION_WINDOW || row->kind == OPTION_CELLS || row->kind == OPTION_ALIGNMENT)
    return take_numbers(r, e, row, error);
  if (row->kind != OPTION_WORDS) return refuse(error, "'%.40s' takes one value, not an array", e->key);
  for (int i = 0; i < e->count; ++i) {
    if (!e->is_text[i]) return refuse(error, "'%.40s' must be an array of texts in quotes", e->key);
    if (!add_option(r, e, row, e->items[i], error)) return false;
  }
  return true;
}

static bool take_flag(job_reader *r, const job_entry *e, const option *row, job_error *error) {
  if (e->kind != JOB_TRUE && e->kind != JOB_FALSE) return refuse(error, "'%.40s' must be true or false", e->key);
  return e->kind == JOB_FALSE || finish_word(r, add_word(r->said, e->line, "--%s", row->name));
}

static bool take_option(job_reader *r, const job_entry *e, const option *row, job_error *error) {
  const bool is_truth = e->kind == JOB_TRUE || e->kind == JOB_FALSE;
  if (row->kind == OPTION_FLAG) return take_flag(r, e, row, error);
  if (e->kind == JOB_ARRAY) return take_array(r, e, row, error);
  if (is_truth && row->kind != OPTION_SWITCH)
    return refuse(error, "'%.40s' needs a value (%s), not true or false", e->key, row->argument);
  if (is_truth) return add_option(r, e, row, e->kind == JOB_TRUE ? "yes" : "no", error);
  return add_option(r, e, row, e->items[0], error);
}

static bool refuse_key(const command *about, const char *key, job_error *error) {
  const char *near = option_nearest(about, key);
  if (near) return refuse(error, "unknown key '%.40s' of laves %s; did you mean '%s'?", key, about->name, near);
  return refuse(error, "unknown key '%.40s' of laves %s", key, about->name);
}

static bool take_entry(void *user, const job_entry *e, job_error *error) {
  job_reader *r = user;
  const command *about = e->table[0] ? command_find(e->table) : r->about;
  if (r->said->count == 0 && strcmp(e->key, "certificate") == 0 && e->kind == JOB_TEXT && strcmp(e->items[0], "laves") == 0 &&
      e->table[0] == '\0') {
    r->is_certificate = true; /* it is read as what it is */
    return false;
  }
  if (!about) return refuse(error, "unknown table '%.40s'; tables have the names of commands", e->table);
  const bool counts = about == r->about;
  if (strcmp(e->key, "input") == 0) return take_input(r, e, counts, error);
  const option *row = option_find(about, e->key, strlen(e->key));
  if (!row || strcmp(e->key, "help") == 0 || strcmp(e->key, "job") == 0) return refuse_key(about, e->key, error);
  if (!counts) return true;
  if (r->seen[row - option_rows]) return refuse(error, "'%.40s' is given twice", e->key);
  r->seen[row - option_rows] = true;
  return take_option(r, e, row, error);
}

/* ---- certificates ---- */

static options_outcome say_no_memory(const char *path) {
  text_error("no memory to read the job '%.200s'", path);
  return OPTIONS_NO_MEMORY;
}

static options_outcome take_command(job_reader *r, const laves_certificate *certificate) {
  const char *word = certificate->command;
  if (certificate->command_count < 2) {
    text_error("%s: the certificate does not tell the command that made the mesh", r->path);
    return OPTIONS_WRONG;
  }
  for (int i = 0; i < certificate->command_count; ++i) {
    if (i == 1 && strcmp(word, r->about->name) != 0) {
      text_error("%s: the mesh of this certificate is made by 'laves %.40s', not by 'laves %s'", r->path, word, r->about->name);
      return OPTIONS_WRONG;
    }
    if (i > 1 && !add_word(r->said, 0, "%s", word)) return say_no_memory(r->path);
    word += strlen(word) + 1;
  }
  return OPTIONS_RUN;
}

static options_outcome read_certificate(job_reader *r) {
  laves_certificate *certificate = malloc(sizeof *certificate);
  laves_context *context = laves_context_create(NULL);
  laves_error error = {.result = LAVES_ERROR_MEMORY};
  options_outcome outcome;
  if (certificate && context && laves_certificate_read(context, r->path, certificate, &error) == LAVES_OK) {
    outcome = take_command(r, certificate);
  } else if (error.result == LAVES_ERROR_MEMORY) {
    outcome = say_no_memory(r->path);
  } else {
    text_error("%s", error.text);
    outcome = OPTIONS_UNREADABLE;
  }
  laves_context_free(context);
  free(certificate);
  return outcome;
}

/* ---- all ---- */

static options_outcome say_unreadable(const char *path, const char *why) {
  text_error("cannot read the job '%.200s': %s", path, why);
  return OPTIONS_UNREADABLE;
}

/* The file's bytes, for free(). Pipes and devices have no folder and no end. */
static options_outcome read_bytes(const char *path, char **bytes, size_t *length) {
  struct stat status;
  const int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  options_outcome outcome = OPTIONS_RUN;
  if (file < 0) return say_unreadable(path, strerror(errno));
  if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) {
    outcome = say_unreadable(path, "it is not an ordinary file");
  } else if (status.st_size > JOB_BYTES_MAX) {
    outcome = say_unreadable(path, "it is larger than 1 MiB");
  } else if (!(*bytes = malloc((size_t)status.st_size + 1))) {
    outcome = say_no_memory(path);
  }
  *length = 0;
  while (outcome == OPTIONS_RUN && *length < (size_t)status.st_size) {
    const ssize_t got = read(file, *bytes + *length, (size_t)status.st_size - *length);
    if (got < 0) outcome = say_unreadable(path, strerror(errno));
    if (got <= 0) break;
    *length += (size_t)got;
  }
  close(file);
  return outcome;
}

static options_outcome parse(job_reader *r, const char *bytes, size_t length) {
  job_error error;
  if (job_file_parse(bytes, length, take_entry, r, &error)) return OPTIONS_RUN;
  if (r->is_certificate) return read_certificate(r);
  if (r->no_memory || error.text[0] == '\0') return say_no_memory(r->path);
  if (error.line > 0) {
    text_error("%s:%d: %s", r->path, error.line, error.text);
  } else {
    text_error("%s: %s", r->path, error.text);
  }
  text_say("Try 'laves %s --help'.", r->about->name);
  return OPTIONS_WRONG;
}

options_outcome job_read(const command *about, const char *path, job **out) {
  char *bytes = NULL;
  size_t length;
  options_outcome outcome = read_bytes(path, &bytes, &length);
  job_reader *r = calloc(1, sizeof *r);
  *out = NULL;
  if (outcome == OPTIONS_RUN && (!r || !(r->said = calloc(1, sizeof *r->said)))) outcome = say_no_memory(path);
  if (outcome == OPTIONS_RUN) {
    r->about = about;
    r->path = path;
    outcome = parse(r, bytes, length);
  }
  if (outcome == OPTIONS_RUN) {
    *out = r->said;
  } else if (r) {
    job_free(r->said);
  }
  free(r);
  free(bytes);
  return outcome;
}
