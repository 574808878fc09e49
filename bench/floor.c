/* What no mesher can be faster than on this machine: filling as much memory, and writing as many bytes.
 *
 *   floor BYTES [FILE]
 *
 * Prints one line of JSON: wall seconds of filling fresh memory (the system's making of pages included), of filling it again,
 * and, when a file is named, of writing BYTES into it by write(2) from memory that is there; the file is removed. Nothing is
 * flushed to the device, as laves flushes nothing. Of more bytes than 4 GB so much memory is filled and written again and again,
 * and seconds of filling are those of BYTES at that rate. */
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

/* As much as laves hands over at once, about. */
enum { WRITE_BYTES = 1 << 20 };
#define MEMORY_MAX ((size_t)4 << 30)

static double wall_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Words that differ, so that the loop is a loop of stores and no call that knows zeros. */
static double fill(volatile uint64_t *words, size_t count, uint64_t first) {
  const double start = wall_seconds();
  for (size_t i = 0; i < count; i++) words[i] = first + i;
  return wall_seconds() - start;
}

/* Seconds, below 0 when it failed. */
static double write_out(const char *path, const char *bytes, size_t room, size_t count) {
  const double start = wall_seconds();
  const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (file < 0) return -1;
  for (size_t done = 0; done < count;) {
    const size_t next = count - done < WRITE_BYTES ? count - done : WRITE_BYTES;
    const ssize_t wrote = write(file, bytes + done % (room - WRITE_BYTES + 1), next);
    if (wrote <= 0) return -1;
    done += (size_t)wrote;
  }
  return close(file) == 0 ? wall_seconds() - start : -1;
}

int main(int count, char **words) {
  const size_t bytes = count >= 2 ? (size_t)strtoull(words[1], NULL, 10) / 8 * 8 : 0;
  if (!bytes || count > 3) {
    fputs("floor BYTES [FILE]\n", stderr);
    return 1;
  }
  const size_t room = bytes < MEMORY_MAX ? bytes + WRITE_BYTES : MEMORY_MAX;
  uint64_t *memory = malloc(room);
  if (!memory) {
    fprintf(stderr, "floor: no memory for %zu bytes\n", room);
    return 4;
  }
  const double scale = (double)bytes / (double)room;
  const double fresh = scale * fill(memory, room / 8, 1), again = scale * fill(memory, room / 8, 2);
  double written = 0;
  if (count == 3) {
    written = write_out(words[2], (const char *)memory, room, bytes);
    unlink(words[2]);
  }
  free(memory);
  if (written < 0) {
    fprintf(stderr, "floor: %s cannot be written\n", words[2]);
    return 2;
  }
  printf("{\"bytes\": %zu, \"fill_wall\": %.9g, \"refill_wall\": %.9g, \"write_wall\": %.9g}\n", bytes, fresh, again, written);
  return 0;
}
