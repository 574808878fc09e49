/* The commands of the program and their options: one table that parses, helps, corrects and documents. */
#ifndef LAVES_CLI_OPTIONS_H
#define LAVES_CLI_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "laves/laves.h"

enum { OUTPUT_CAPACITY = 8, TEXTS_CAPACITY = 64, OPTION_CAPACITY = 96 /* rows of the table */ };

/* A list of values of one option that may be repeated. */
typedef struct option_texts {
  const char *items[TEXTS_CAPACITY];
  int count;
} option_texts;

/* An option with several numbers. */
typedef struct option_numbers {
  bool given;
  double values[9];
} option_numbers;

typedef struct option_alignment {
  laves_align align;
  double rotation[9];
} option_alignment;

struct job; /* job.h */

/* What the command line and its job file said; members of options that were not given hold the table's defaults. */
typedef struct settings {
  const char *command;
  const char *job_path;     /* NULL: not given */
  struct job *job;          /* what it said; NULL: nothing */
  int word_count;           /* of the command line, behind the command's name */
  char **words;             /* of the command line */
  int job_first, job_after; /* those of them that are --job itself */
  int auto_after;           /* the one behind which "auto" is understood, or -1 */
  const char *input;        /* NULL where the command takes none */
  option_texts outputs;
  const char *boundary, *json, *surface; /* NULL: not given */
  const char *certificate, *write_certificate, *report;
  const char *defects; /* NULL: not given */
  double winding;      /* the number that inside exceeds */
  bool close_holes, unite, nested;
  double size, relative_size; /* 0: not given */
  int64_t tets, vertices;     /* 0: not given */
  option_alignment alignment;
  bool no_improve, ascii, quiet, verbose;
  bool face_sources;
  int64_t order; /* 1 or 2 */
  laves_regions regions;
  option_numbers window; /* lowest, highest dihedral angle */
  double volume_length;  /* negative: not given */
  bool check_features, stream;
  laves_method method;
  double guarantee; /* degrees */
  laves_format format;
  int64_t compress, threads, list, whole;
  int64_t memory; /* bytes; 0: what the machine has */
  double timeout; /* seconds; 0: no limit */
  option_numbers cells;
  double grading, min_size, max_size; /* sizes 0: not given */
  double curvature_elements, thickness_elements, feature_elements, max_distance, relative_distance, interior_growth;
  option_texts size_fields, refinements;
  option_texts features;
  double feature_angle; /* degrees */
  bool feature_tags, no_keep_thin;
  double tolerance, budget; /* units of the mesh; seconds, 0: no limit */
  bool fixed_boundary;
  int64_t passes;  /* 0: not given */
  const char *cut; /* NULL: not given */
  const char *color, *view, *up, *pixels, *background;
  double lines, creases; /* pixels */
  const char *plot;      /* NULL: a picture */
  int64_t worst;
} settings;

typedef enum option_kind {
  OPTION_FLAG,      /* bool */
  OPTION_SWITCH,    /* bool: yes or no */
  OPTION_WORD,      /* const char * */
  OPTION_WORDS,     /* option_texts, of `high` at most */
  OPTION_AUTO,      /* const char *: "auto" where no value follows */
  OPTION_REAL,      /* double */
  OPTION_COUNT,     /* int64_t; 50k, 1.5M */
  OPTION_BYTES,     /* int64_t; 500M, 2G, powers of 1024 */
  OPTION_WINDOW,    /* option_numbers, two */
  OPTION_CELLS,     /* option_numbers, one or three */
  OPTION_ALIGNMENT, /* option_alignment */
  OPTION_FORMAT,    /* laves_format */
  OPTION_METHOD,    /* laves_method */
  OPTION_REGIONS,   /* laves_regions */
} option_kind;

enum { OPTION_KINDS = OPTION_REGIONS + 1 };

/* One row of the table. */
typedef struct option {
  const char *name; /* without dashes */
  char letter;      /* or 0 */
  unsigned commands;
  const char *section;
  option_kind kind;
  const char *argument; /* NULL for flags; "a|b|FILE": one of these words, or a file (completion.c) */
  const char *unit;     /* NULL: none */
  bool above;           /* the lowest value itself is not allowed */
  double low, high;
  const char *standard; /* the default in words; NULL: none or off */
  size_t member;        /* offset in settings */
  int group;            /* of options that exclude one another; 0: none */
  const char *help;
} option;

typedef struct command {
  const char *name;
  const char *argument; /* of the one thing that is not an option, or NULL */
  const char *summary;  /* one line */
  const char *description;
  const char *examples; /* lines, each ends with a line break */
  unsigned bit;         /* in option.commands */
  int (*run)(const settings *given);
} command;

extern const command commands[];
extern const size_t command_count;
extern const option option_rows[];
extern const size_t option_count;

const command *command_find(const char *name);
/* The option of a command with that name, or NULL. */
const option *option_find(const command *about, const char *name, size_t length);
/* The name of a command's option that is nearest to a misspelt one, or NULL. */
const char *option_nearest(const command *about, const char *name);

typedef enum options_outcome { OPTIONS_RUN, OPTIONS_HELP, OPTIONS_WRONG, OPTIONS_UNREADABLE, OPTIONS_NO_MEMORY } options_outcome;

/* Reads the words after the command's name, and the job file that they name; what stands on the command line counts.
 * WRONG, UNREADABLE (the job file), NO_MEMORY: that has been said on stderr. Settings point into the words; release them in any
 * case. */
options_outcome options_parse(const command *about, int count, char **words, settings *given);
void options_release(settings *given);

/* The command that does the same without a job file: "laves", its name, the words of the job that count, those of the command
 * line. *count of them in an array for free(); NULL without memory. */
const char **options_command(const settings *given, int *count);

/* ---- words that parser, commands and help share ---- */

/* The index of a value in the list of those that there are; else -1 with half a sentence that follows the option's name:
 * "must be x, y or z, not 'w'", and the nearest of them, if one is near, in `wrong`, of OPTION_SENTENCE_CAPACITY. */
enum { OPTION_SENTENCE_CAPACITY = 300 };
int option_choose(const char *text, const char *const *names, int count, char *wrong);

/* "above 0", "0..9", "1 or more"; returns text. */
const char *option_range(const option *row, char *text, size_t size);
/* The names of all formats with commas between. */
void option_format_names(char *text, size_t size);
/* The help of a row, with what only the library knows filled in; returns text. */
enum { OPTION_HELP_CAPACITY = 400 };
const char *option_help(const option *row, char *text, size_t size);
bool option_has_range(const option *row);

/* ---- help ---- */

void options_print_help(FILE *file, const command *about);
void options_print_overview(FILE *file);
/* docs/options.md */
void options_print_markdown(FILE *file);
/* The whole table as JSON. */
void options_print_json(FILE *file);
/* The man page laves(1). */
void options_print_manual(FILE *file);
/* The completion file of a shell: bash, zsh or fish; false for another. */
bool options_print_completion(FILE *file, const char *shell);

#endif
