/* Loaded before the program (LD_PRELOAD), fails its n-th call of malloc, calloc or realloc, wherever it comes from: the program,
 * the library, zlib, Lua or the C library.
 *
 *   FAULT_AT=N       which one, from 1; 0 or none: none
 *   FAULT_FOR_GOOD   set: all that follow too
 *   FAULT_COUNT=FILE where to write how many calls there were, at the end of the program
 *
 * Calls count from the start of main() to its end, and of that thread alone, for what libraries ask for before main() they may be
 * unable to do without. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

void *__libc_malloc(size_t bytes);
void *__libc_calloc(size_t count, size_t bytes);
void *__libc_realloc(void *block, size_t bytes);

typedef int main_fn(int count, char **words, char **environment);
typedef int start_fn(main_fn *run, int count, char **words, void (*init)(void), void (*fini)(void), void (*rtld_fini)(void),
                     void *stack_end);
int __libc_start_main(main_fn *run, int count, char **words, void (*init)(void), void (*fini)(void), void (*rtld_fini)(void),
                      void *stack_end);

static _Thread_local bool counts; /* true between start and end of main(), in its thread */
static unsigned long asked, fails_at;
static bool for_good;
static main_fn *real_main;

static bool fails(void) {
  if (!counts) return false;
  ++asked;
  if (fails_at == 0 || (for_good ? asked < fails_at : asked != fails_at)) return false;
  errno = ENOMEM;
  return true;
}

void *malloc(size_t bytes) { return fails() ? NULL : __libc_malloc(bytes); }

void *calloc(size_t count, size_t bytes) { return fails() ? NULL : __libc_calloc(count, bytes); }

void *realloc(void *block, size_t bytes) { return fails() ? NULL : __libc_realloc(block, bytes); }

static void write_count(void) {
  const char *path = getenv("FAULT_COUNT");
  FILE *file = path ? fopen(path, "w") : NULL;
  if (!file) return;
  fprintf(file, "%lu\n", asked);
  fclose(file);
}

static int counted_main(int count, char **words, char **environment) {
  const char *at = getenv("FAULT_AT");
  fails_at = at ? strtoul(at, NULL, 10) : 0;
  for_good = getenv("FAULT_FOR_GOOD") != NULL;
  counts = true;
  const int code = real_main(count, words, environment);
  counts = false;
  write_count();
  return code;
}

int __libc_start_main(main_fn *run, int count, char **words, void (*init)(void), void (*fini)(void), void (*rtld_fini)(void),
                      void *stack_end) {
  void *found = dlsym(RTLD_NEXT, "__libc_start_main");
  start_fn *start;
  *(void **)&start = found;
  real_main = run;
  return start(counted_main, count, words, init, fini, rtld_fini, stack_end);
}
