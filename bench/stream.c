/* laves-stream SOLID TETS [--threads N]: a streamed mesh into a sink that counts and hashes, as JSON on standard output.
 *
 * SOLID is what `laves mesh` takes: a surface file or an expression. Times are those of the wall and of the processor: of
 * meshing, of making and hashing all points and tets, and of filling as many bytes as these have, for comparison. */
#include <laves/laves.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

static double wall_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double cpu_seconds(void) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

/* Writes a cache's worth of memory over and over, as often as `bytes` takes: what a machine does at best. */
static double fill_seconds(double bytes) {
  enum { ROOM = 64 << 20 };
  char *room = malloc(ROOM);
  if (!room) return NAN;
  memset(room, 1, ROOM);
  const double start = wall_seconds();
  for (double done = 0; done < bytes; done += ROOM) {
    memset(room, (int)(done / ROOM) & 255, ROOM);
    __asm__ volatile("" : : "r"(room) : "memory");
  }
  const double seconds = wall_seconds() - start;
  free(room);
  return seconds;
}

static int fail(const laves_error *error) {
  fprintf(stderr, "laves-stream: %s\n", error->text);
  return laves_result_exit_code(error->result);
}

int main(int count, char **words) {
  if (count != 3 && !(count == 5 && strcmp(words[3], "--threads") == 0)) {
    fprintf(stderr, "usage: laves-stream SOLID TETS [--threads N]\n");
    return 2;
  }
  laves_error error;
  laves_context_options settings = laves_context_options_default();
  if (count == 5) settings.thread_count = (int)strtol(words[4], NULL, 10);
  laves_context *context = laves_context_create(&settings);
  laves_options options = laves_options_default();
  options.tet_target = (int64_t)strtod(words[2], NULL);
  options.streamed = true;
  laves_domain *domain = NULL;
  laves_mesh *mesh = NULL;
  laves_report report;
  const bool is_file = strchr(words[1], '(') == NULL;
  const double read_start = wall_seconds();
  laves_result result = is_file ? laves_domain_from_file(context, words[1], &domain, &error)
                                : laves_domain_from_expression(context, words[1], &domain, &error);
  const double read = wall_seconds() - read_start;
  if (result != LAVES_OK) return fail(&error);
  const double start = wall_seconds(), cpu_start = cpu_seconds();
  result = laves_generate(context, domain, &options, &mesh, &report, &error);
  if (result != LAVES_OK && result != LAVES_TARGET_MISSED) return fail(&error);
  const double made = wall_seconds(), cpu_made = cpu_seconds();
  char hash[33];
  laves_mesh_hash(mesh, hash);
  const double hashed = wall_seconds(), cpu_hashed = cpu_seconds();
  const double bytes = 16.0 * (double)laves_mesh_tet_count(mesh) + 24.0 * (double)laves_mesh_vertex_count(mesh);
  printf("{\"tets\": %zu, \"vertices\": %zu, \"faces\": %zu, \"hash\": \"%s\",\n", laves_mesh_tet_count(mesh),
         laves_mesh_vertex_count(mesh), laves_mesh_face_count(mesh), hash);
  printf(" \"read\": %.4f, \"mesh\": %.4f, \"mesh_cpu\": %.4f, \"sink\": %.4f, \"sink_cpu\": %.4f, \"fill\": %.4f,\n", read,
         made - start, cpu_made - cpu_start, hashed - made, cpu_hashed - cpu_made, fill_seconds(bytes));
  printf(" \"peak_bytes\": %zu, \"stages\": {", laves_context_peak_bytes(context));
  for (int i = 0; i < report.stage_count; i++)
    printf("%s\"%s %d\": [%.4f, %.4f]", i ? ", " : "", report.stages[i].name, i, report.stages[i].wall_seconds,
           report.stages[i].cpu_seconds);
  printf("}}\n");
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  laves_context_free(context);
  return 0;
}
