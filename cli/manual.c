/* The option table as the man page laves(1), in the macros that groff and mandoc share (man(7)). */
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "laves/laves.h"
#include "options.h"

/* Text with what the formatter would take for its own escaped: backslashes, dashes that are to stay dashes, and a dot or a quote
 * at the start of a line. */
static void print_escaped(FILE *file, const char *text) {
  bool line_start = true;
  for (; *text; ++text) {
    if (line_start && (*text == '.' || *text == '\'')) fputs("\\&", file);
    line_start = *text == '\n';
    if (*text == '\\') {
      fputs("\\e", file);
    } else if (*text == '-') {
      fputs("\\-", file);
    } else if (*text == '\'') {
      fputs("\\(aq", file);
    } else if (*text == '`') {
      fputs("\\(ga", file);
    } else {
      fputc(*text, file);
    }
  }
}

/* The part of a heading that follows ".SS": a quote would end it. */
static void print_heading(FILE *file, const char *macro, const char *text) {
  fprintf(file, "%s \"", macro);
  print_escaped(file, text);
  fputs("\"\n", file);
}

/* "-o, --output FILE" with names in bold and the argument in italics. */
static void print_spelling(FILE *file, const option *row) {
  fputs(".TP\n", file);
  if (row->letter) fprintf(file, "\\fB\\-%c\\fR, ", row->letter);
  fputs("\\fB", file);
  print_escaped(file, "--");
  print_escaped(file, row->name);
  fputs("\\fR", file);
  if (row->argument) {
    fputs(" \\fI", file);
    print_escaped(file, row->argument);
    fputs("\\fR", file);
  }
  fputc('\n', file);
}

static void print_option(FILE *file, const option *row) {
  char help[OPTION_HELP_CAPACITY], range[64];
  print_spelling(file, row);
  print_escaped(file, option_help(row, help, sizeof help));
  if (option_has_range(row)) {
    fputs(" (", file);
    print_escaped(file, option_range(row, range, sizeof range));
    if (row->unit) fprintf(file, ", %s", row->unit);
    fputc(')', file);
  }
  if (row->standard) {
    fputs(". Default: ", file);
    print_escaped(file, row->standard);
  }
  fputs(".\n", file);
}

static void print_command(FILE *file, const command *about) {
  char title[80];
  snprintf(title, sizeof title, "laves %s%s%s", about->name, about->argument ? " " : "", about->argument ? about->argument : "");
  print_heading(file, ".SH", title);
  print_escaped(file, about->description);
  fputc('\n', file);
  const char *section = NULL;
  for (size_t i = 0; i < option_count; ++i) {
    const option *row = &option_rows[i];
    if (!(row->commands & about->bit)) continue;
    if (!section || strcmp(section, row->section) != 0) print_heading(file, ".SS", row->section);
    section = row->section;
    print_option(file, row);
  }
  fputs(".SS Examples\n.EX\n", file);
  print_escaped(file, about->examples);
  fputs(".EE\n", file);
}

static void print_synopsis(FILE *file) {
  fputs(".SH SYNOPSIS\n", file);
  for (size_t i = 0; i < command_count; ++i) {
    fprintf(file, ".B laves %s\n", commands[i].name);
    if (commands[i].argument) fprintf(file, ".I %s\n", commands[i].argument);
    fputs("[options]\n.br\n", file);
  }
  fputs(
      ".B laves help\n"
      "[\\fICOMMAND\\fR | \\fB\\-\\-markdown\\fR | \\fB\\-\\-options\\fR | \\fB\\-\\-man\\fR |\n"
      "\\fB\\-\\-completion\\fR \\fIbash|zsh|fish\\fR]\n.br\n"
      ".B laves \\-\\-version\n",
      file);
}

static void print_exit_codes(FILE *file) {
  fputs(".SH EXIT STATUS\n", file);
#define PRINT_RESULT(name, code, text)                                                                       \
  fprintf(file, ".TP\n.B %d\n%s%s\n", laves_result_exit_code(LAVES_##name), laves_result_text(LAVES_##name), \
          LAVES_##name == LAVES_TARGET_MISSED ? "; in\n.BR \"laves check\" :\nthe mesh is not valid, or not as asked" : "");
  LAVES_RESULT_LIST(PRINT_RESULT)
#undef PRINT_RESULT
}

void options_print_manual(FILE *file) {
  fputs(".\\\" Made by `laves help --man`; change cli/command_table.c, not this file.\n", file);
  fprintf(file, ".TH LAVES 1 \"\" \"laves %s\" \"User commands\"\n", laves_version());
  fputs(".SH NAME\nlaves \\- fill any solid with nearly regular tetrahedra\n", file);
  print_synopsis(file);
  fputs(
      ".SH DESCRIPTION\n"
      "Inside, a mesh is the C15 (Laves) tiling, with dihedral angles of 60 to 74.21 degrees; its boundary layer lies on the\n"
      "surface of the solid and is improved. Solids are triangle surfaces, clean or dirty, Lua scripts, and expressions.\n"
      "Words for people go to the standard error, data to the standard output.\n"
      ".PP\n"
      "An option and its value are two words, or one with = between:\n"
      ".B \\-\\-size 0.5\nor\n.BR \\-\\-size=0.5 .\n"
      "Counts may end in k, M or G. Each option is given once, but for those that are called repeatable.\n",
      file);
  for (size_t i = 0; i < command_count; ++i) print_command(file, &commands[i]);
  print_exit_codes(file);
  fputs(
      ".SH ENVIRONMENT\n"
      ".TP\n.B NO_COLOR\nwhen set and not empty: no colours. They are used on terminals only.\n"
      ".TP\n.B TERM\n\\(lqdumb\\(rq: no colours and no progress line.\n"
      ".TP\n.BR LC_ALL \", \" LC_CTYPE \", \" LANG\nwhether the terminal shows UTF\\-8; else only ASCII is printed. Numbers "
      "always\n"
      "have a point.\n"
      ".SH SEE ALSO\n.BR gmsh (1),\n.BR tetgen (1)\n",
      file);
}
