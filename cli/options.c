/* Reads a command line by the table of command_table.c: each word is an option, its value, or the one argument.  What is
 * wrong is said in one sentence with the option's name, its range, and for a misspelt name the nearest one known. */
#include "options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "job.h"
#include "text.h"

/* ---- values ---- */

enum { SENTENCE_CAPACITY = OPTION_SENTENCE_CAPACITY };

/* Reads one number from the start of text. `end` is set behind it. */
static bool read_number(const char *text, double *value, const char **end) {
  char *after;
  *value = strtod(text, &after);
  *end = after;
  return after != text && isfinite(*value);
}

/* Reads one to `capacity` numbers with commas between and nothing behind; returns how many, 0 when it is not such a list. */
static int read_numbers(const char *text, double *values, int capacity) {
  int count = 0;
  while (count < capacity && read_number(text, &values[count], &text)) {
    ++count;
    if (*text == '\0') return count;
    if (*text++ != ',') return 0;
  }
  return 0;
}

/* The factor of a suffix such as k or M in powers of `step`, 0 when it is unknown. */
static double suffix_factor(const char *suffix, double step) {
  if (*suffix == '\0') return 1;
  static const char letters[] = "kMGT";
  const char upper[2] = {*suffix == 'K' ? 'k' : *suffix, '\0'};
  const char *found = strstr(letters, upper[0] == 'm' ? "M" : upper[0] == 'g' ? "G" : upper);
  if (!found) return 0;
  ++suffix;
  if (step == 1024 && *suffix == 'i') ++suffix;
  if (step == 1024 && *suffix == 'B') ++suffix;
  return *suffix == '\0' ? pow(step, (double)(found - letters) + 1) : 0;
}

const char *option_range(const option *row, char *text, size_t size) {
  const bool endless = row->high == INFINITY;
  const char *form =
      row->above ? (endless ? "above %.15g" : "above %.15g, at most %.15g") : (endless ? "%.15g or more" : "%.15g..%.15g");
  snprintf(text, size, form, row->low, row->high);
  return text;
}

static bool in_range(const option *row, double value) {
  return (row->above ? value > row->low : value >= row->low) && value <= row->high;
}

static bool parse_real(const option *row, const char *text, double *value, char *wrong) {
  const char *end;
  char range[64];
  if (!read_number(text, value, &end) || *end != '\0') {
    snprintf(wrong, SENTENCE_CAPACITY, "needs a number, not '%.60s'", text);
  } else if (!in_range(row, *value)) {
    snprintf(wrong, SENTENCE_CAPACITY, "must be %s, not %.60s", option_range(row, range, sizeof range), text);
  } else {
    return true;
  }
  return false;
}

static bool parse_count(const option *row, const char *text, double step, int64_t *value, char *wrong) {
  const char *end;
  double number;
  char range[64];
  const bool is_number = read_number(text, &number, &end);
  const double factor = is_number ? suffix_factor(end, step) : 0;
  number *= factor;
  if (factor == 0 || (factor == 1 && number != floor(number))) {
    snprintf(wrong, SENTENCE_CAPACITY, "needs a whole number such as %s, not '%.60s'", step == 1024 ? "500M or 2G" : "20 or 50k",
             text);
  } else if (!in_range(row, floor(number + 0.5))) {
    snprintf(wrong, SENTENCE_CAPACITY, "must be %s, not %.60s", option_range(row, range, sizeof range), text);
  } else {
    *value = (int64_t)floor(number + 0.5);
    return true;
  }
  return false;
}

static bool parse_window(const char *text, option_numbers *window, char *wrong) {
  if (read_numbers(text, window->values, 2) != 2) {
    snprintf(wrong, SENTENCE_CAPACITY, "needs two angles in degrees such as 40,125, not '%.60s'", text);
  } else if (!(window->values[0] >= 0 && window->values[0] <= 60 && window->values[1] >= 80 && window->values[1] <= 180)) {
    snprintf(wrong, SENTENCE_CAPACITY, "must go from 0..60 to 80..180 degrees, not %.60s", text);
  } else {
    window->given = true;
    return true;
  }
  return false;
}

static bool parse_cells(const option *row, const char *text, option_numbers *cells, char *wrong) {
  const int count = read_numbers(text, cells->values, 3);
  bool right = count == 1 || count == 3;
  for (int i = 0; right && i < count; ++i) right = in_range(row, cells->values[i]) && cells->values[i] == floor(cells->values[i]);
  if (!right) {
    char range[64];
    snprintf(wrong, SENTENCE_CAPACITY, "needs one or three whole numbers in %s, not '%.60s'",
             option_range(row, range, sizeof range), text);
    return false;
  }
  if (count == 1) cells->values[1] = cells->values[2] = cells->values[0];
  cells->given = true;
  return true;
}

/* "; did you mean 'x'?" when one of the names is near, else nothing. */
static const char *suggestion(const char *text, const char *const *names, int count, char *sentence, size_t size) {
  const char *near = text_nearest(text, names, (size_t)count);
  sentence[0] = '\0';
  if (near) snprintf(sentence, size, "; did you mean '%s'?", near);
  return sentence;
}

/* "x, y or z" */
static void join_names(const char *const *names, int count, char *text, size_t size) {
  text[0] = '\0';
  for (int i = 0; i < count; ++i) {
    const size_t used = strlen(text);
    snprintf(text + used, size - used, "%s%s", i == 0 ? "" : i < count - 1 ? ", " : " or ", names[i]);
  }
}

int option_choose(const char *text, const char *const *names, int count, char *wrong) {
  char list[SENTENCE_CAPACITY / 2], meant[64];
  for (int i = 0; i < count; ++i) {
    if (strcmp(text, names[i]) == 0) return i;
  }
  join_names(names, count, list, sizeof list);
  snprintf(wrong, SENTENCE_CAPACITY, "must be %s, not '%.30s'%s", list, text,
           suggestion(text, names, count, meant, sizeof meant));
  return -1;
}

/* Rodrigues' formula: R = cos I + sin [a]x + (1 - cos) a a^T for the unit axis a. False for an axis of no length. */
static bool rotation_about(const double axis[3], double degrees, double rotation[9]) {
  const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  if (!(length > 0) || !isfinite(length)) return false;
  const double x = axis[0] / length, y = axis[1] / length, z = axis[2] / length;
  const double radians = degrees * (3.14159265358979323846 / 180);
  const double c = cos(radians), s = sin(radians), t = 1 - c;
  const double matrix[9] = {c + t * x * x,     t * x * y - s * z, t * x * z + s * y, t * x * y + s * z, c + t * y * y,
                            t * y * z - s * x, t * x * z - s * y, t * y * z + s * x, c + t * z * z};
  memcpy(rotation, matrix, sizeof matrix);
  return true;
}

/* Whether the rows are of length one and at right angles to one another, and the determinant is one. */
static bool is_rotation(const double m[9]) {
  static const double slack = 1e-6; /* numbers typed with seven digits pass, slips of a digit do not */
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      const double dot = m[3 * i] * m[3 * j] + m[3 * i + 1] * m[3 * j + 1] + m[3 * i + 2] * m[3 * j + 2];
      if (fabs(dot - (i == j)) > slack) return false;
    }
  }
  const double determinant =
      m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
  return determinant > 0;
}

static bool parse_alignment(const char *text, option_alignment *alignment, char *wrong) {
  *alignment = (option_alignment){.align = LAVES_ALIGN_NONE};
  if (strcmp(text, "none") == 0) return true;
  if (strcmp(text, "pca") == 0) {
    alignment->align = LAVES_ALIGN_PCA;
    return true;
  }
  alignment->align = LAVES_ALIGN_ROTATION;
  double numbers[9];
  const int count = read_numbers(text, numbers, 9);
  if (count == 4 && rotation_about(numbers, numbers[3], alignment->rotation)) return true;
  if (count == 9 && is_rotation(numbers)) {
    memcpy(alignment->rotation, numbers, sizeof numbers);
    return true;
  }
  static const char *const names[] = {"none", "pca"};
  char meant[64];
  snprintf(wrong, SENTENCE_CAPACITY, "%s%s",
           count == 9   ? "needs a rotation matrix: rows of length 1 at right angles, determinant 1"
           : count == 4 ? "needs an axis that is not of length 0"
                        : "needs none, pca, x,y,z,angle, or the 9 numbers of a rotation matrix",
           suggestion(text, names, 2, meant, sizeof meant));
  return false;
}

void option_format_names(char *text, size_t size) {
  text[0] = '\0';
  for (int i = LAVES_FORMAT_AUTO + 1; i < LAVES_FORMAT_COUNT; ++i) {
    const size_t used = strlen(text);
    snprintf(text + used, size - used, "%s%s", used ? ", " : "", laves_format_name((laves_format)i));
  }
}

static bool parse_format(const char *text, laves_format *format, char *wrong) {
  const char *names[LAVES_FORMAT_COUNT];
  int count = 0;
  *format = laves_format_from_name(text);
  if (*format != LAVES_FORMAT_COUNT && *format != LAVES_FORMAT_AUTO) return true;
  for (int i = LAVES_FORMAT_AUTO + 1; i < LAVES_FORMAT_COUNT; ++i) names[count++] = laves_format_name((laves_format)i);
  option_choose(text, names, count, wrong);
  return false;
}

static bool parse_method(const char *text, laves_method *method, char *wrong) {
  static const char *const names[] = {"auto", "snap", "stuff"};
  const int chosen = option_choose(text, names, 3, wrong);
  if (chosen >= 0) *method = (laves_method)chosen;
  return chosen >= 0;
}

static bool parse_regions(const char *text, laves_regions *regions, char *wrong) {
  static const char *const names[] = {"none", "parts"};
  const int chosen = option_choose(text, names, 2, wrong);
  if (chosen >= 0) *regions = (laves_regions)chosen;
  return chosen >= 0;
}

static bool parse_switch(const char *text, bool *value, char *wrong) {
  static const char *const names[] = {"yes", "no"};
  const int chosen = option_choose(text, names, 2, wrong);
  *value = chosen == 0;
  return chosen >= 0;
}

static bool parse_words(const option *row, const char *text, option_texts *list, char *wrong) {
  if (list->count == (int)row->high) {
    snprintf(wrong, SENTENCE_CAPACITY, "can be given %d times at most", list->count);
    return false;
  }
  list->items[list->count++] = text;
  return true;
}

/* Stores the value of an option; false with half a sentence in `wrong` that follows the option's name. */
static bool store_value(const option *row, const char *text, settings *given, char *wrong) {
  void *member = (char *)given + row->member;
  switch (row->kind) {
    case OPTION_FLAG:
      *(bool *)member = true;
      return true;
    case OPTION_SWITCH:
      return parse_switch(text, member, wrong);
    case OPTION_WORD:
    case OPTION_AUTO:
      *(const char **)member = text;
      return true;
    case OPTION_WORDS:
      return parse_words(row, text, member, wrong);
    case OPTION_REAL:
      return parse_real(row, text, member, wrong);
    case OPTION_COUNT:
      return parse_count(row, text, 1000, member, wrong);
    case OPTION_BYTES:
      return parse_count(row, text, 1024, member, wrong);
    case OPTION_WINDOW:
      return parse_window(text, member, wrong);
    case OPTION_CELLS:
      return parse_cells(row, text, member, wrong);
    case OPTION_METHOD:
      return parse_method(text, member, wrong);
    case OPTION_REGIONS:
      return parse_regions(text, member, wrong);
    case OPTION_ALIGNMENT:
      return parse_alignment(text, member, wrong);
    case OPTION_FORMAT:
      return parse_format(text, member, wrong);
  }
  return false;
}

/* ---- words ---- */

typedef struct parser {
  const command *about;
  settings *given;
  int count, next, current; /* words; the next one; the one that is looked at */
  char **words;
  const struct parser *over;  /* of a job: the command line's, which counts for more; else NULL */
  const char *group_names[4]; /* the first option of each group that was seen */
  bool seen[OPTION_CAPACITY];
  bool given_input;
} parser;

static options_outcome wrong_usage(const parser *state, const char *sentence) {
  const int line = state->over && state->current < state->count ? state->given->job->lines[state->current] : 0;
  if (line > 0) {
    text_error("%s:%d: %s", state->given->job_path, line, sentence);
  } else if (state->over) {
    text_error("%s: %s", state->given->job_path, sentence);
  } else {
    text_error("%s", sentence);
  }
  text_say("Try 'laves %s --help'.", state->about->name);
  return OPTIONS_WRONG;
}

const option *option_find(const command *about, const char *name, size_t length) {
  for (size_t i = 0; i < option_count; ++i) {
    const option *row = &option_rows[i];
    if (!(row->commands & about->bit)) continue;
    if (strncmp(row->name, name, length) == 0 && row->name[length] == '\0') return row;
  }
  return NULL;
}

const char *option_nearest(const command *about, const char *name) {
  const char *known[OPTION_CAPACITY];
  size_t count = 0;
  for (size_t i = 0; i < option_count; ++i) {
    if (option_rows[i].commands & about->bit) known[count++] = option_rows[i].name;
  }
  return text_nearest(name, known, count);
}

static const option *find_letter(const command *about, char letter) {
  for (size_t i = 0; i < option_count; ++i) {
    if ((option_rows[i].commands & about->bit) && option_rows[i].letter == letter) return &option_rows[i];
  }
  return NULL;
}

static options_outcome unknown_option(const parser *state, const char *word) {
  char name[64], sentence[SENTENCE_CAPACITY];
  snprintf(name, sizeof name, "%.*s", (int)strcspn(word, "="), word);
  const char *near = option_nearest(state->about, name + strspn(name, "-"));
  if (near) {
    snprintf(sentence, sizeof sentence, "unknown option '%s'; did you mean '--%s'?", name, near);
  } else {
    snprintf(sentence, sizeof sentence, "unknown option '%s'", name);
  }
  return wrong_usage(state, sentence);
}

/* Twice the same option, or two of one group, would leave open which one counts. */
static bool note_use(parser *state, const option *row, char *sentence) {
  bool *seen = &state->seen[row - option_rows];
  if (*seen && row->kind != OPTION_WORDS && row->kind != OPTION_FLAG) {
    snprintf(sentence, SENTENCE_CAPACITY, "option '--%s' is given twice", row->name);
    return false;
  }
  *seen = true;
  if (row->group == 0) return true;
  const char **first = &state->group_names[row->group];
  if (*first) {
    snprintf(sentence, SENTENCE_CAPACITY, "'--%s' and '--%s' cannot both be given: they set the same", *first, row->name);
    return false;
  }
  *first = row->name;
  return true;
}

/* Whether the command line says what a job says of this option, too. */
static bool is_overridden(const parser *state, const option *row) {
  if (!state->over) return false;
  return state->over->seen[row - option_rows] || (row->group > 0 && state->over->group_names[row->group]);
}

/* The words that were just read count. */
static void note_words(const parser *state, const option *row) {
  settings *given = state->given;
  for (int i = state->current; state->over && i < state->next; ++i) given->job->used[i] = true;
  if (state->over || row->member != offsetof(settings, job_path) || row->kind != OPTION_WORD) return;
  given->job_first = state->current;
  given->job_after = state->next;
}

/* What follows an option is its value, but for another option; negative numbers are none. NULL: no value. */
static const char *take_value(parser *state) {
  if (state->next == state->count) return NULL;
  const char *word = state->words[state->next];
  const bool is_option = word[0] == '-' && word[1] != '\0' && strcspn(word + 1, "0123456789.") > 0;
  if (is_option) return NULL;
  ++state->next;
  return word;
}

/* `value` is what stood behind = or the letter, or NULL. */
static options_outcome take_option(parser *state, const option *row, const char *value) {
  char wrong[SENTENCE_CAPACITY] = "", sentence[SENTENCE_CAPACITY + 80];
  if (strcmp(row->name, "help") == 0) return OPTIONS_HELP;
  if (row->kind == OPTION_FLAG && value) {
    snprintf(sentence, sizeof sentence, "option '--%s' takes no value", row->name);
    return wrong_usage(state, sentence);
  }
  if (row->kind != OPTION_FLAG && !value) value = take_value(state);
  if (row->kind == OPTION_AUTO && !value) {
    value = "auto";
    if (!state->over) state->given->auto_after = state->current;
  }
  if (row->kind != OPTION_FLAG && (!value || *value == '\0')) {
    snprintf(sentence, sizeof sentence, "option '--%s' needs a value: --%s %s", row->name, row->name, row->argument);
    return wrong_usage(state, sentence);
  }
  if (is_overridden(state, row)) return OPTIONS_RUN;
  note_words(state, row);
  if (!note_use(state, row, sentence)) return wrong_usage(state, sentence);
  if (!store_value(row, value, state->given, wrong)) {
    snprintf(sentence, sizeof sentence, "option '--%s' %s", row->name, wrong);
    return wrong_usage(state, sentence);
  }
  return OPTIONS_RUN;
}

static options_outcome take_word(parser *state, const char *word) {
  char sentence[SENTENCE_CAPACITY];
  if (state->over && state->over->given_input) return OPTIONS_RUN;
  if (!state->about->argument || state->given->input) {
    snprintf(sentence, sizeof sentence, "'%.100s' is one argument too many%s", word,
             state->about->argument ? "; put an expression in quotes" : "");
    return wrong_usage(state, sentence);
  }
  state->given->input = word;
  state->given_input = true;
  if (state->over) state->given->job->used[state->current] = true;
  return OPTIONS_RUN;
}

static options_outcome take_next(parser *state, bool *options_ended) {
  const char *word = state->words[state->next++];
  state->current = state->next - 1;
  if (*options_ended || word[0] != '-' || word[1] == '\0') return take_word(state, word);
  if (strcmp(word, "--") == 0) {
    *options_ended = true;
    return OPTIONS_RUN;
  }
  if (word[1] != '-') {
    const option *row = find_letter(state->about, word[1]);
    if (!row || (row->kind == OPTION_FLAG && word[2] != '\0')) return unknown_option(state, word);
    return take_option(state, row, word[2] ? word + 2 : NULL);
  }
  const size_t length = strcspn(word + 2, "=");
  const option *row = option_find(state->about, word + 2, length);
  if (!row) return unknown_option(state, word);
  return take_option(state, row, word[2 + length] ? word + 2 + length + 1 : NULL);
}

static options_outcome take_all(parser *state) {
  bool options_ended = false;
  while (state->next < state->count) {
    const options_outcome outcome = take_next(state, &options_ended);
    if (outcome != OPTIONS_RUN) return outcome;
  }
  return OPTIONS_RUN;
}

/* What the job says and the command line does not. */
static options_outcome take_job(const parser *over) {
  settings *given = over->given;
  const options_outcome read = job_read(over->about, given->job_path, &given->job);
  if (read != OPTIONS_RUN) return read;
  parser state = {.about = over->about, .given = given, .count = given->job->count, .words = given->job->words, .over = over};
  return take_all(&state);
}

void options_release(settings *given) {
  job_free(given->job);
  given->job = NULL;
}

const char **options_command(const settings *given, int *count) {
  const int job_words = given->job ? given->job->count : 0;
  const char **words = malloc((size_t)(3 + job_words + given->word_count) * sizeof *words);
  *count = 0;
  if (!words) return NULL;
  words[(*count)++] = "laves";
  words[(*count)++] = given->command;
  for (int i = 0; i < job_words; ++i) {
    if (given->job->used[i]) words[(*count)++] = given->job->words[i];
  }
  for (int i = 0; i < given->word_count; ++i) {
    if (i < given->job_first || i >= given->job_after) words[(*count)++] = given->words[i];
    if (i == given->auto_after) words[(*count)++] = "auto"; /* what follows --job may be the input */
  }
  return words;
}

options_outcome options_parse(const command *about, int count, char **words, settings *given) {
  *given = (settings){.command = about->name,
                      .word_count = count,
                      .words = words,
                      .auto_after = -1,
                      .volume_length = -1,
                      .order = 1,
                      .guarantee = 14.4,
                      .winding = 0.5,
                      .close_holes = true,
                      .grading = 0.3,
                      .feature_angle = 40,
                      .compress = 1,
                      .list = 5,
                      .whole = 400000,
                      .color = "class",
                      .view = "30,25",
                      .up = "z",
                      .background = "white",
                      .lines = 0.9};
  given->window.values[0] = 40;
  given->window.values[1] = 125;
  for (int i = 0; i < 3; ++i) given->cells.values[i] = 4;
  parser state = {.about = about, .given = given, .count = count, .words = words};
  options_outcome outcome = take_all(&state);
  if (outcome == OPTIONS_RUN && given->job_path) outcome = take_job(&state);
  if (outcome != OPTIONS_RUN) return outcome;
  if (about->argument && (!given->input || given->input[0] == '\0')) {
    char sentence[SENTENCE_CAPACITY];
    snprintf(sentence, sizeof sentence, "%s is missing: laves %s %s", about->argument, about->name, about->argument);
    if (given->report && strcmp(given->report, "auto") != 0)
      snprintf(sentence, sizeof sentence, "%s is missing: '%.100s' is the page of '--report'; put %s before that",
               about->argument, given->report, about->argument);
    return wrong_usage(&state, sentence);
  }
  if (given->format != LAVES_FORMAT_AUTO && given->outputs.count > 1) {
    return wrong_usage(&state, "'--format' goes with one output only; with several, the extension of each says its format");
  }
  return OPTIONS_RUN;
}
