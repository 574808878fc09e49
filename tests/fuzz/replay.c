/* Runs a fuzz target on the files and folders given: a main() for every compiler, so that what fuzzing found once is
 * tried by every run of the tests.
 *
 *     replay_NAME [--alter] PATH...
 *
 * With --alter each file of up to ALTERED_BYTES is also tried cut off behind every byte, and with every byte changed in some
 * ways, so that what the target requires is seen to hold all round the seeds without a fuzzer. */
#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "fuzz/fuzz_target.h"

enum { ALTERED_BYTES = 4096 };

static bool altering;

/* The content goes to a block of just its size, so that sanitizers see a step beyond. */
static void try_copy(const uint8_t *bytes, size_t length) {
  uint8_t *copy = malloc(length ? length : 1);
  if (!copy) abort();
  memcpy(copy, bytes, length);
  LLVMFuzzerTestOneInput(copy, length);
  free(copy);
}

static void try_altered(uint8_t *bytes, size_t length) {
  static const uint8_t put[] = {0, 0xff, '9', '-', ' ', '\n', '"'};
  for (size_t i = 0; i < length; ++i) {
    const uint8_t kept = bytes[i];
    try_copy(bytes, i);
    for (size_t k = 0; k < sizeof put; ++k) {
      bytes[i] = put[k];
      if (put[k] != kept) LLVMFuzzerTestOneInput(bytes, length);
    }
    bytes[i] = kept ^ 0x80;
    LLVMFuzzerTestOneInput(bytes, length);
    bytes[i] = kept ^ 1;
    LLVMFuzzerTestOneInput(bytes, length);
    bytes[i] = kept;
  }
}

/* Number of files run, or -1. */
static int replay_file(const char *path, size_t length) {
  uint8_t *bytes = malloc(length ? length : 1);
  FILE *file = fopen(path, "rb");
  const size_t got = bytes && file ? fread(bytes, 1, length, file) : 0;
  const int count = bytes && file && got == length ? 1 : -1;
  if (count == 1) {
    printf("%s\n", path);
    fflush(stdout);
    try_copy(bytes, length);
    if (altering && length <= ALTERED_BYTES) try_altered(bytes, length);
  } else {
    fprintf(stderr, "cannot read %s\n", path);
  }
  if (file) fclose(file);
  free(bytes);
  return count;
}

static int replay_folder(const char *path) {
  DIR *folder = opendir(path);
  int count = folder ? 0 : -1;
  for (struct dirent *entry; count >= 0 && (entry = readdir(folder)) != NULL;) {
    char name[4096];
    struct stat status;
    snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
    if (stat(name, &status) != 0 || !S_ISREG(status.st_mode)) continue;
    const int more = replay_file(name, (size_t)status.st_size);
    count = more < 0 ? -1 : count + more;
  }
  if (folder) closedir(folder);
  return count;
}

int main(int argc, char **argv) {
  int count = 0;
  for (int i = 1; i < argc; ++i) {
    struct stat status;
    if (strcmp(argv[i], "--alter") == 0) {
      altering = true;
      continue;
    }
    const int known = stat(argv[i], &status);
    const int more = known != 0                ? -1
                     : S_ISDIR(status.st_mode) ? replay_folder(argv[i])
                                               : replay_file(argv[i], (size_t)status.st_size);
    if (more < 0) return EXIT_FAILURE;
    count += more;
  }
  printf("%d inputs\n", count);
  return count > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
