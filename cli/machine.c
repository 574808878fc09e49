#include "machine.h"

#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

/* Of two limits, of which 0 is none. */
static int64_t lesser(int64_t a, int64_t b) { return a == 0 || (b != 0 && b < a) ? b : a; }

static int64_t physical_memory(void) {
  const long pages = sysconf(_SC_PHYS_PAGES), bytes = sysconf(_SC_PAGESIZE);
  return pages > 0 && bytes > 0 ? (int64_t)pages * bytes : 0;
}

static int64_t address_space(void) {
  struct rlimit limit;
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur > INT64_MAX) return 0;
  return (int64_t)limit.rlim_cur;
}

/* The number in a file; 0 when there is none, as where it says "max". */
static int64_t number_in(const char *path) {
  long long number = 0;
  FILE *file = fopen(path, "r");
  if (!file) return 0;
  if (fscanf(file, "%lld", &number) != 1 || number < 0) number = 0;
  fclose(file);
  return number;
}

/* Of version 2, and of version 1, where a huge number stands for none. */
static int64_t control_group(void) {
  return lesser(number_in("/sys/fs/cgroup/memory.max"), number_in("/sys/fs/cgroup/memory/memory.limit_in_bytes"));
}

int64_t machine_memory(void) { return lesser(lesser(physical_memory(), control_group()), address_space()); }
