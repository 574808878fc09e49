/* Runs a fuzz target on the files and folders given: a main() for every compiler, so that what fuzzing found once is
 * tried by every run of the tests. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "fuzz/fuzz_target.h"

/* Number of files run, or -1. The content goes to a block of just its size, so that sanitizers see a step beyond. */
static int replay_file(const char *path, size_t length) {
  uint8_t *bytes = malloc(length ? length : 1);
  FILE *file = fopen(path, "rb");
  const size_t got = bytes && file ? fread(bytes, 1, length, file) : 0;
  const int count = bytes && file && got == length ? 1 : -1;
  if (count == 1) {
    printf("%s\n", path);
    fflush(stdout);
    LLVMFuzzerTestOneInput(bytes, length);
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
