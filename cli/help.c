/* The option table as text for people (--help), as docs/options.md, and as JSON. */
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "json.h"
#include "laves/laves.h"
#include "options.h"

/* What the kinds are called in the dump. */
static const char *const kind_names[] = {
    [OPTION_SWITCH] = "switch",   [OPTION_FLAG] = "flag",     [OPTION_WORD] = "text",           [OPTION_WORDS] = "texts",
    [OPTION_REAL] = "real",       [OPTION_COUNT] = "count",   [OPTION_BYTES] = "bytes",         [OPTION_WINDOW] = "window",
    [OPTION_CELLS] = "cells",     [OPTION_FORMAT] = "format", [OPTION_ALIGNMENT] = "alignment", [OPTION_METHOD] = "method",
    [OPTION_REGIONS] = "regions", [OPTION_AUTO] = "text",
};
_Static_assert(sizeof kind_names / sizeof kind_names[0] == OPTION_KINDS, "a kind has no name");

/* Prints words from column `indent` on, with line breaks before column 100. */
static void print_wrapped(FILE *file, const char *text, int column, int indent) {
  enum { LAST_COLUMN = 100 };
  bool first = true;
  while (*text) {
    const int length = (int)strcspn(text, " ");
    if (!first && column + 1 + length > LAST_COLUMN) {
      fprintf(file, "\n%*s", indent, "");
      column = indent;
    } else if (!first) {
      fputc(' ', file);
      ++column;
    }
    first = false;
    fprintf(file, "%.*s", length, text);
    column += length;
    text += length;
    if (*text == ' ') ++text;
  }
}

static void option_spelling(const option *row, char *text, size_t size) {
  char letter[8] = "";
  if (row->letter) snprintf(letter, sizeof letter, "-%c, ", row->letter);
  snprintf(text, size, "%s--%s%s%s", letter, row->name, row->argument ? " " : "", row->argument ? row->argument : "");
}

const char *option_help(const option *row, char *text, size_t size) {
  snprintf(text, size, "%s", row->help);
  if (row->kind == OPTION_FORMAT) option_format_names(text + strlen(text), size - strlen(text));
  return text;
}

bool option_has_range(const option *row) {
  return row->kind == OPTION_REAL || row->kind == OPTION_COUNT || row->kind == OPTION_CELLS;
}

enum { HELP_INDENT = 25 };

static void print_option(FILE *file, const option *row) {
  char spelling[64], help[OPTION_HELP_CAPACITY], range[64], line[OPTION_HELP_CAPACITY + 200];
  option_spelling(row, spelling, sizeof spelling);
  option_help(row, help, sizeof help);
  snprintf(line, sizeof line, "%s", help);
  if (option_has_range(row)) {
    const size_t used = strlen(line);
    snprintf(line + used, sizeof line - used, " (%s%s%s)", option_range(row, range, sizeof range), row->unit ? ", " : "",
             row->unit ? row->unit : "");
  }
  if (row->standard) {
    const size_t used = strlen(line);
    snprintf(line + used, sizeof line - used, " [%s]", row->standard);
  }
  fprintf(file, "  %-*s", HELP_INDENT - 2, spelling);
  if ((int)strlen(spelling) > HELP_INDENT - 3) fprintf(file, "\n%*s", HELP_INDENT, "");
  print_wrapped(file, line, HELP_INDENT, HELP_INDENT);
  fputc('\n', file);
}

static void print_examples(FILE *file, const char *examples) {
  while (*examples) {
    const int length = (int)strcspn(examples, "\n");
    fprintf(file, "  %.*s\n", length, examples);
    examples += length + 1;
  }
}

void options_print_help(FILE *file, const command *about) {
  fprintf(file, "laves %s%s%s [options]\n\n%s\n", about->name, about->argument ? " " : "", about->argument ? about->argument : "",
          about->description);
  const char *section = NULL;
  for (size_t i = 0; i < option_count; ++i) {
    const option *row = &option_rows[i];
    if (!(row->commands & about->bit)) continue;
    if (!section || strcmp(section, row->section) != 0) fprintf(file, "\n%s:\n", row->section);
    section = row->section;
    print_option(file, row);
  }
  fprintf(file, "\nExamples:\n");
  print_examples(file, about->examples);
}

void options_print_overview(FILE *file) {
  fprintf(file, "laves %s: nearly regular tetrahedral meshes of any solid\n\n", laves_version());
  for (size_t i = 0; i < command_count; ++i) {
    char usage[40];
    snprintf(usage, sizeof usage, "%s %s", commands[i].name, commands[i].argument ? commands[i].argument : "");
    fprintf(file, "  laves %-14s %s\n", usage, commands[i].summary);
  }
  fprintf(file,
          "  laves help [COMMAND] the same as COMMAND --help; --man, --completion SHELL: for your system\n"
          "  laves --version      say which version this is\n\n"
          "Try: laves mesh 'sphere(1) - cylinder{r=0.4}' -o bead.vtu\n");
}

/* ---- documentation ---- */

static void print_markdown_text(FILE *file, const char *text) {
  for (; *text; ++text) {
    if (*text == '|') fputc('\\', file);
    fputc(*text, file);
  }
}

static void print_markdown_row(FILE *file, const option *row) {
  char spelling[64], help[OPTION_HELP_CAPACITY], range[64];
  option_spelling(row, spelling, sizeof spelling);
  option_help(row, help, sizeof help);
  fputs("| `", file);
  print_markdown_text(file, spelling);
  fputs("` | ", file);
  print_markdown_text(file, help);
  fprintf(file, " | %s | %s | %s |\n", option_has_range(row) ? option_range(row, range, sizeof range) : "",
          row->unit ? row->unit : "", row->standard ? row->standard : "");
}

void options_print_markdown(FILE *file) {
  fputs(
      "# Options\n\nMade from the program's own table by `laves help --markdown`; change `cli/command_table.c`, not this file.\n"
      "Exit codes and error sentences: [errors.md](errors.md). JSON: [json.md](json.md).\n",
      file);
  for (size_t i = 0; i < command_count; ++i) {
    const command *about = &commands[i];
    fprintf(file, "\n## laves %s%s%s\n\n", about->name, about->argument ? " " : "", about->argument ? about->argument : "");
    fprintf(file, "%s\n\n```sh\n%s```\n\n", about->description, about->examples);
    fputs("| option | what it does | range | unit | default |\n|---|---|---|---|---|\n", file);
    for (size_t j = 0; j < option_count; ++j) {
      if (option_rows[j].commands & about->bit) print_markdown_row(file, &option_rows[j]);
    }
  }
}

static void print_json_option(json *out, const option *row) {
  char help[OPTION_HELP_CAPACITY];
  const char letter[2] = {row->letter, '\0'};
  option_help(row, help, sizeof help);
  json_open_object(out, NULL);
  json_text(out, "name", row->name);
  json_text(out, "letter", row->letter ? letter : NULL);
  json_text(out, "kind", kind_names[row->kind]);
  json_text(out, "argument", row->argument);
  json_text(out, "unit", row->unit);
  if (option_has_range(row)) {
    json_number(out, "low", row->low);
    json_number(out, "high", row->high);
    json_boolean(out, "above_low", row->above);
  }
  json_text(out, "default", row->standard);
  json_boolean(out, "repeatable", row->kind == OPTION_WORDS);
  json_integer(out, "group", row->group);
  json_text(out, "help", help);
  json_close(out);
}

void options_print_json(FILE *file) {
  json out = json_start(file);
  json_text(&out, "version", laves_version());
  json_open_object(&out, "commands");
  for (size_t i = 0; i < command_count; ++i) {
    json_open_object(&out, commands[i].name);
    json_text(&out, "argument", commands[i].argument);
    json_text(&out, "summary", commands[i].summary);
    json_open_array(&out, "options");
    for (size_t j = 0; j < option_count; ++j) {
      if (option_rows[j].commands & commands[i].bit) print_json_option(&out, &option_rows[j]);
    }
    json_close(&out);
    json_close(&out);
  }
  json_finish(&out);
}
