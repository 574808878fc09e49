/* The program: finds the command, reads its options, runs it.
 *
 *   main -> options (one table, command_table.c) -> command_*.c -> session (context, errors, JSON) -> laves.h
 *
 * Human text goes to stderr, data to stdout. Exit codes: docs/errors.md. */
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "interrupt.h"
#include "laves/laves.h"
#include "options.h"
#include "text.h"

enum { EXIT_USAGE = 1 };

/* The descriptors of the three streams are taken, even where the caller closed them: else the first output file would get one
 * of their numbers, and messages would go into it. /dev/null is opened so that writing fails, as it does on a closed one. */
static void hold_streams(void) {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (fcntl(stream, F_GETFD) < 0 && open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0) return;
  }
}

/* A pipe that nobody reads any more and a file that may not grow are failed writes, with a sentence and an exit code. */
static void ignore_write_signals(void) {
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);
}

/* The exit code of what was printed on the standard output. */
static int finish_output(void) {
  if (text_flush_output()) return 0;
  text_error("cannot write to the standard output: %s", strerror(errno));
  return laves_result_exit_code(LAVES_ERROR_WRITE);
}

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

static int show_completion(const char *shell) {
  if (shell && options_print_completion(stdout, shell)) return finish_output();
  text_error("completion is there for bash, zsh and fish: laves help --completion bash");
  return EXIT_USAGE;
}

/* `more`: the word after the topic, or NULL. */
static int show_help(const char *topic, const char *more) {
  if (!topic) {
    options_print_overview(stdout);
  } else if (strcmp(topic, "--markdown") == 0) {
    options_print_markdown(stdout);
  } else if (strcmp(topic, "--options") == 0) {
    options_print_json(stdout);
  } else if (strcmp(topic, "--man") == 0) {
    options_print_manual(stdout);
  } else if (strcmp(topic, "--completion") == 0) {
    return show_completion(more);
  } else if (command_find(topic)) {
    options_print_help(stdout, command_find(topic));
  } else {
    return unknown_command(topic);
  }
  return finish_output();
}

int main(int count, char **words) {
  hold_streams();
  ignore_write_signals();
  setlocale(LC_CTYPE, ""); /* only to learn whether the terminal writes UTF-8; numbers keep their point */
  if (count < 2) {
    options_print_overview(stderr);
    return EXIT_USAGE;
  }
  const char *name = words[1];
  if (strcmp(name, "--version") == 0 || strcmp(name, "version") == 0) {
    printf("laves %s\n", laves_version());
    return finish_output();
  }
  if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) return show_help(NULL, NULL);
  if (strcmp(name, "help") == 0) return show_help(count > 2 ? words[2] : NULL, count > 3 ? words[3] : NULL);
  const command *about = command_find(name);
  if (!about) return unknown_command(name);

  settings given;
  int code = EXIT_USAGE;
  switch (options_parse(about, count - 2, words + 2, &given)) {
    case OPTIONS_WRONG:
      code = EXIT_USAGE;
      break;
    case OPTIONS_UNREADABLE:
      code = laves_result_exit_code(LAVES_ERROR_INPUT);
      break;
    case OPTIONS_NO_MEMORY:
      code = laves_result_exit_code(LAVES_ERROR_MEMORY);
      break;
    case OPTIONS_HELP:
      options_print_help(stdout, about);
      code = finish_output();
      break;
    case OPTIONS_RUN:
      interrupt_watch();
      code = about->run(&given);
  }
  options_release(&given);
  return code;
}
