/* The program: finds the command, reads its options, runs it.
 *
 *   main -> options (one table, command_table.c) -> command_*.c -> session (context, errors, JSON) -> laves.h
 *
 * Human text goes to stderr, data to stdout. Exit codes: docs/errors.md. */
#include <locale.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "interrupt.h"
#include "laves/laves.h"
#include "options.h"
#include "text.h"

enum { EXIT_USAGE = 1 };

static int unknown_command(const char *word) {
  const char *known[16] = {"help"};
  size_t count = 1;
  for (size_t i = 0; i < command_count; ++i) known[count++] = commands[i].name;
  const char *near = text_nearest(word, known, count);
  struct stat status;
  if (near) {
    text_error("unknown command '%s'; did you mean '%s'?", word, near);
  } else if (stat(word, &status) == 0 || strchr(word, '(')) {
    text_error("unknown command '%s'; did you mean: laves mesh '%s'?", word, word);
  } else {
    text_error("unknown command '%s'", word);
  }
  text_say("Try 'laves help'.");
  return EXIT_USAGE;
}

static int show_help(const char *topic) {
  if (!topic) {
    options_print_overview(stdout);
  } else if (strcmp(topic, "--markdown") == 0) {
    options_print_markdown(stdout);
  } else if (strcmp(topic, "--options") == 0) {
    options_print_json(stdout);
  } else if (command_find(topic)) {
    options_print_help(stdout, command_find(topic));
  } else {
    return unknown_command(topic);
  }
  return 0;
}

int main(int count, char **words) {
  setlocale(LC_CTYPE, ""); /* only to learn whether the terminal writes UTF-8; numbers keep their point */
  if (count < 2) {
    options_print_overview(stderr);
    return EXIT_USAGE;
  }
  const char *name = words[1];
  if (strcmp(name, "--version") == 0 || strcmp(name, "version") == 0) {
    printf("laves %s\n", laves_version());
    return 0;
  }
  if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) return show_help(NULL);
  if (strcmp(name, "help") == 0) return show_help(count > 2 ? words[2] : NULL);
  const command *about = command_find(name);
  if (!about) return unknown_command(name);

  settings given;
  switch (options_parse(about, count - 2, words + 2, &given)) {
    case OPTIONS_WRONG:
      return EXIT_USAGE;
    case OPTIONS_HELP:
      options_print_help(stdout, about);
      return 0;
    case OPTIONS_RUN:
      break;
  }
  interrupt_watch();
  return about->run(&given);
}
