/* The option table as completion for shells: bash, zsh, fish.
 *
 * What may stand behind an option is read off its argument: lower-case words between bars are what it can be, FILE and the like
 * stand for names of files, other capitals for what only the user knows. */
#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "options.h"

enum { CHOICES_CAPACITY = 200, SHORT_CAPACITY = 72 };

/* What an option or a command may be followed by. */
typedef struct completion {
  char choices[CHOICES_CAPACITY]; /* words with spaces between */
  bool files;
} completion;

static bool is_file_word(const char *word, size_t length) {
  static const char *const words[] = {"FILE", "INPUT", "MESH", "FIELD"};
  for (size_t i = 0; i < sizeof words / sizeof words[0]; ++i) {
    if (strlen(words[i]) == length && memcmp(words[i], word, length) == 0) return true;
  }
  return false;
}

static void add_choice(completion *out, const char *word, size_t length) {
  const size_t used = strlen(out->choices);
  snprintf(out->choices + used, sizeof out->choices - used, "%s%.*s", used ? " " : "", (int)length, word);
}

static completion argument_completion(const char *argument) {
  completion out = {.files = false};
  for (const char *word = argument; word && *word;) {
    const size_t length = strcspn(word, "|");
    bool plain = length > 0;
    for (size_t i = 0; i < length; ++i) plain = plain && (islower((unsigned char)word[i]) || word[i] == '-');
    if (plain && strchr(argument, '|')) add_choice(&out, word, length);
    out.files = out.files || is_file_word(word, length);
    word += length + (word[length] == '|');
  }
  return out;
}

static completion option_completion(const option *row) {
  completion out = argument_completion(row->argument);
  if (row->kind == OPTION_FORMAT) {
    option_format_names(out.choices, sizeof out.choices);
    for (char *c = out.choices; (c = strchr(c, ',')) != NULL;) memmove(c, c + 1, strlen(c));
  }
  return out;
}

/* The help up to where it goes into particulars, without what shells take for their own. */
static const char *short_help(const option *row, char *text) {
  enum { SHORTEST = 16 }; /* a colon before this does not end the phrase: "no: refuse ..." */
  char help[OPTION_HELP_CAPACITY];
  size_t length = strcspn(option_help(row, help, sizeof help), ";(`");
  const char *colon = strstr(help, ": ");
  if (colon && colon - help >= SHORTEST && (size_t)(colon - help) < length) length = (size_t)(colon - help);
  if (length >= SHORT_CAPACITY) {
    length = SHORT_CAPACITY - 1;
    while (length > 0 && help[length] != ' ') --length;
  }
  while (length > 0 && (help[length - 1] == ' ' || help[length - 1] == ',')) --length;
  size_t used = 0;
  for (size_t i = 0; i < length; ++i) {
    if (!strchr("'[]\\", help[i])) text[used++] = help[i];
  }
  text[used] = '\0';
  return text;
}

static bool belongs(const option *row, const command *about) { return (row->commands & about->bit) != 0; }

/* ---- bash ---- */

static void bash_values(FILE *file, const command *about) {
  fputs("      case $before in\n", file);
  for (size_t i = 0; i < option_count; ++i) {
    const option *row = &option_rows[i];
    if (!belongs(row, about) || !row->argument) continue;
    const completion after = option_completion(row);
    fprintf(file, "        --%s", row->name);
    if (row->letter) fprintf(file, " | -%c", row->letter);
    fprintf(file, ") what=value files=%s values='%s' ;;\n", after.files ? "yes" : "", after.choices);
  }
  fputs("      esac\n", file);
}

static void bash_command(FILE *file, const command *about) {
  fprintf(file, "    %s)\n      files=%s\n      options='", about->name, about->argument ? "yes" : "");
  const char *space = "";
  for (size_t i = 0; i < option_count; ++i) {
    if (!belongs(&option_rows[i], about)) continue;
    fprintf(file, "%s--%s", space, option_rows[i].name);
    space = " ";
  }
  fputs("'\n", file);
  bash_values(file, about);
  fputs("      ;;\n", file);
}

static void print_command_names(FILE *file) {
  for (size_t i = 0; i < command_count; ++i) fprintf(file, "%s ", commands[i].name);
}

static void print_bash(FILE *file) {
  fputs(
      "# Completion of laves for bash: made by `laves help --completion bash`.\n"
      "_laves() {\n"
      "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
      "  local what=option options= values= files=\n"
      "  COMPREPLY=()\n"
      "  # --name=value comes as three words.\n"
      "  if [[ $word == = ]]; then\n"
      "    word=\n"
      "  elif [[ $before == = ]]; then\n"
      "    before=${COMP_WORDS[COMP_CWORD-2]}\n"
      "  fi\n"
      "  if ((COMP_CWORD == 1)); then\n"
      "    COMPREPLY=($(compgen -W '",
      file);
  print_command_names(file);
  fputs(
      "help --help --version' -- \"$word\"))\n"
      "    return\n"
      "  fi\n"
      "  case ${COMP_WORDS[1]} in\n"
      "    help)\n"
      "      options='--markdown --options --man --completion' values='",
      file);
  print_command_names(file);
  fputs(
      "'\n"
      "      if [[ $before == --completion ]]; then what=value values='bash zsh fish'; fi\n"
      "      ;;\n",
      file);
  for (size_t i = 0; i < command_count; ++i) bash_command(file, &commands[i]);
  fputs(
      "  esac\n"
      "  if [[ $what == option && $word == -* ]]; then\n"
      "    COMPREPLY=($(compgen -W \"$options\" -- \"$word\"))\n"
      "    return\n"
      "  fi\n"
      "  COMPREPLY=($(compgen -W \"$values\" -- \"$word\"))\n"
      "  if [[ $files ]]; then\n"
      "    local name\n"
      "    compopt -o filenames 2>/dev/null\n"
      "    while IFS= read -r name; do COMPREPLY+=(\"$name\"); done < <(compgen -f -- \"$word\")\n"
      "  fi\n"
      "}\n"
      "complete -F _laves laves\n",
      file);
}

/* ---- zsh ---- */

/* '(--size --tets)' before an option that excludes others, '*' before one that may be repeated. */
static void zsh_conditions(FILE *file, const option *row, const command *about) {
  if (row->kind == OPTION_WORDS) fputc('*', file);
  if (row->group == 0) return;
  const char *before = "(";
  for (size_t i = 0; i < option_count; ++i) {
    const option *other = &option_rows[i];
    if (!belongs(other, about) || other->group != row->group) continue;
    fprintf(file, "%s--%s", before, other->name);
    before = " ";
  }
  fputc(')', file);
}

/* What stands behind an option's or a command's ':NAME:'. */
static void zsh_values(FILE *file, const completion *after) {
  if (after->files && after->choices[0]) {
    fprintf(file, "{ compadd -- %s; _files }", after->choices);
  } else if (after->files) {
    fputs("_files", file);
  } else if (after->choices[0]) {
    fprintf(file, "(%s)", after->choices);
  }
}

static void zsh_option(FILE *file, const option *row, const command *about) {
  char help[SHORT_CAPACITY];
  fputs("            '", file);
  zsh_conditions(file, row, about);
  if (row->letter) {
    fprintf(file, "'{-%c%s,--%s%s}'", row->letter, row->argument ? "+" : "", row->name, row->argument ? "=" : "");
  } else {
    fprintf(file, "--%s%s", row->name, row->argument ? "=" : "");
  }
  fprintf(file, "[%s]", short_help(row, help));
  if (row->argument) {
    const completion after = option_completion(row);
    fputs(row->kind == OPTION_AUTO ? "::" : ":", file); /* two: it may be left out */
    for (const char *c = row->argument; *c; ++c) {
      if (!strchr("[]:", *c)) fputc(*c, file);
    }
    fputc(':', file);
    zsh_values(file, &after);
  }
  fputs("' \\\n", file);
}

static void zsh_command(FILE *file, const command *about) {
  fprintf(file, "        %s)\n          _arguments -s \\\n", about->name);
  for (size_t i = 0; i < option_count; ++i) {
    if (belongs(&option_rows[i], about)) zsh_option(file, &option_rows[i], about);
  }
  if (about->argument) {
    fprintf(file, "            '1:%s:_files'\n", about->argument);
  } else {
    fputs("            ':: :'\n", file);
  }
  fputs("          ;;\n", file);
}

static void print_zsh(FILE *file) {
  fputs(
      "#compdef laves\n"
      "# Completion of laves for zsh: made by `laves help --completion zsh`.\n"
      "_laves() {\n"
      "  local curcontext=$curcontext state line\n"
      "  local -a commands\n"
      "  commands=(\n",
      file);
  for (size_t i = 0; i < command_count; ++i) fprintf(file, "    '%s:%s'\n", commands[i].name, commands[i].summary);
  fputs(
      "    'help:the options of a command'\n"
      "  )\n"
      "  _arguments -C '(- *)'{-h,--help}'[what there is]' '(- *)--version[which version this is]' \\\n"
      "    '1:command:->command' '*::argument:->argument'\n"
      "  case $state in\n"
      "    command) _describe command commands ;;\n"
      "    argument)\n"
      "      case $words[1] in\n"
      "        help)\n"
      "          _arguments '(- *)--markdown[docs/options.md]' '(- *)--options[the table as JSON]' '(- *)--man[the man page]' "
      "\\\n"
      "            '(- *)--completion[completion for a shell]:shell:(bash zsh fish)' '1:command:(",
      file);
  print_command_names(file);
  fputs(")'\n          ;;\n", file);
  for (size_t i = 0; i < command_count; ++i) zsh_command(file, &commands[i]);
  fputs(
      "      esac\n"
      "      ;;\n"
      "  esac\n"
      "}\n"
      "if [[ $funcstack[1] == _laves ]]; then _laves \"$@\"; else compdef _laves laves; fi\n",
      file);
}

/* ---- fish ---- */

static void fish_option(FILE *file, const option *row, const command *about) {
  char help[SHORT_CAPACITY];
  fprintf(file, "complete -c laves -n '__fish_seen_subcommand_from %s' -l %s", about->name, row->name);
  if (row->letter) fprintf(file, " -s %c", row->letter);
  if (row->argument) {
    const completion after = option_completion(row);
    fputs(after.files ? " -r -F" : " -x", file);
    if (after.choices[0]) fprintf(file, " -a '%s'", after.choices);
  }
  fprintf(file, " -d '%s'\n", short_help(row, help));
}

static void print_fish(FILE *file) {
  fputs(
      "# Completion of laves for fish: made by `laves help --completion fish`.\n"
      "complete -c laves -f\n"
      "complete -c laves -n __fish_use_subcommand -l version -d 'which version this is'\n"
      "complete -c laves -n __fish_use_subcommand -l help -s h -d 'what there is'\n"
      "complete -c laves -n __fish_use_subcommand -a help -d 'the options of a command'\n"
      "complete -c laves -n '__fish_seen_subcommand_from help' -l markdown -d 'docs/options.md'\n"
      "complete -c laves -n '__fish_seen_subcommand_from help' -l options -d 'the table as JSON'\n"
      "complete -c laves -n '__fish_seen_subcommand_from help' -l man -d 'the man page'\n"
      "complete -c laves -n '__fish_seen_subcommand_from help' -l completion -x -a 'bash zsh fish'\n"
      "complete -c laves -n '__fish_seen_subcommand_from help' -a '",
      file);
  print_command_names(file);
  fputs("'\n", file);
  for (size_t i = 0; i < command_count; ++i) {
    const command *about = &commands[i];
    fprintf(file, "complete -c laves -n __fish_use_subcommand -a %s -d '%s'\n", about->name, about->summary);
    if (about->argument) fprintf(file, "complete -c laves -n '__fish_seen_subcommand_from %s' -F\n", about->name);
    for (size_t j = 0; j < option_count; ++j) {
      if (belongs(&option_rows[j], about)) fish_option(file, &option_rows[j], about);
    }
  }
}

bool options_print_completion(FILE *file, const char *shell) {
  static const struct {
    const char *shell;
    void (*print)(FILE *);
  } shells[] = {{"bash", print_bash}, {"zsh", print_zsh}, {"fish", print_fish}};
  for (size_t i = 0; i < sizeof shells / sizeof shells[0]; ++i) {
    if (strcmp(shell, shells[i].shell) != 0) continue;
    shells[i].print(file);
    return true;
  }
  return false;
}
