/* How soon work ends when it is cancelled: runs jobs that take each stage of the library through a lot of data, finds the longest
 * time between two calls of the progress callback, then runs each again and cancels it at times spread over the run.
 *
 *   cancel [--threads N] [--tets N] [--cuts N] [--stacks SECONDS] [--list] [JOB...]
 *
 * JOB: the beginning of a name; none: all. Times are CPU seconds, which other programs on the machine do not disturb, where there
 * is one thread (the default), else those of the clock on the wall. Columns: seconds of the whole job; calls of the callback; the
 * longest time between two of them, and the phases on both sides of it; the longest time from the wish to cancel to the return.
 * Ends with 1 when a job fails, keeps memory, or takes more than 0.2 seconds to end. --stacks prints where the program is when it
 * has been silent so long. */
#include <execinfo.h>
#include <laves/laves.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include "fixtures/shapes.h"
#include "fixtures/size_files.h"

static const double promised_seconds = 0.2;
static const char how_to_use[] = "cancel [--threads N] [--tets N] [--cuts N] [--stacks SECONDS] [--list] [JOB...]\n";

/* ---- the watch on one call ---- */

typedef struct watch {
  bool by_wall;
  double asked;      /* when to cancel; negative: never */
  double latest;     /* when the callback was called, or the job began */
  const char *phase; /* then */
  double longest;
  const char *before, *after; /* phases of the longest silence */
  size_t calls;
} watch;

static watch the_watch; /* the signal handler looks at it as well */
static double stack_seconds;

static double now(void) {
  struct timespec t;
  clock_gettime(the_watch.by_wall ? CLOCK_MONOTONIC : CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void note(watch *w, const char *phase) {
  const double time = now(), silence = time - w->latest;
  if (silence > w->longest) {
    w->longest = silence;
    w->before = w->phase;
    w->after = phase;
  }
  w->phase = phase;
  w->latest = time;
}

static bool on_progress(void *user, const char *phase, double fraction) {
  (void)fraction;
  watch *w = user;
  note(w, phase);
  w->calls++;
  return w->asked < 0 || w->latest < w->asked;
}

/* backtrace() may allocate when it is called first, which main() does; this is a tool, and nothing else here is at risk. */
static void on_alarm(int number) {
  static double told = -1;
  (void)number;
  if (the_watch.latest <= 0 || told == the_watch.latest || now() - the_watch.latest < stack_seconds) return;
  told = the_watch.latest;
  void *frames[32];
  const int count = backtrace(frames, 32);
  static const char line[] = "silent in:\n";
  if (write(STDERR_FILENO, line, sizeof line - 1) > 0) backtrace_symbols_fd(frames + 2, count - 2, STDERR_FILENO);
}

static void start_alarms(void) {
  static const struct itimerval often = {{0, 10000}, {0, 10000}};
  struct sigaction action = {.sa_handler = on_alarm, .sa_flags = SA_RESTART};
  void *frame[1];
  backtrace(frame, 1);
  sigemptyset(&action.sa_mask);
  sigaction(SIGPROF, &action, NULL);
  setitimer(ITIMER_PROF, &often, NULL);
}

/* ---- what jobs work on ---- */

typedef struct bench {
  laves_context *context; /* the one that is watched */
  long long tets;
  char folder[64];
  laves_mesh *mesh;     /* of a ball, exact tiles for the greater part */
  laves_domain *domain; /* the ball */
  laves_mesh *spikes;   /* a fan of tets with a large surface */
  const char *argument; /* of the job at hand */
} bench;

static void demand(laves_result result, const laves_error *error) {
  if (result == LAVES_OK || result == LAVES_TARGET_MISSED) return;
  fprintf(stderr, "cancel: %s\n", error->text);
  exit(1);
}

static void need_ball(bench *b) {
  laves_error error = {0};
  if (b->mesh) return;
  laves_options options = laves_options_default();
  options.tet_target = b->tets;
  demand(laves_domain_from_expression(b->context, "sphere(1)", &b->domain, &error), &error);
  demand(laves_generate(b->context, b->domain, &options, &b->mesh, NULL, &error), &error);
}

/* The triangles of a fine torus, each with the origin. */
static void need_spikes(bench *b) {
  laves_error error = {0};
  if (b->spikes) return;
  int across = 3;
  while (6LL * across * across < b->tets / 3) across++;
  shape s = shape_torus(1, 0.3, 3 * across, across);
  double *points = calloc(s.point_count + 1, 3 * sizeof *points);
  int32_t *tets = malloc(s.triangle_count * 4 * sizeof *tets);
  if (!points || !tets) abort();
  memcpy(points, s.points, s.point_count * 3 * sizeof *points);
  for (size_t t = 0; t < s.triangle_count; t++) {
    tets[4 * t] = (int32_t)s.point_count;
    for (int k = 0; k < 3; k++) tets[4 * t + 1 + k] = (int32_t)s.triangles[3 * t + k];
  }
  demand(laves_mesh_from_arrays(b->context, points, s.point_count + 1, tets, s.triangle_count, NULL, &b->spikes, &error), &error);
  free(points);
  free(tets);
  shape_free(&s);
}

/* The words of a job's argument: a file's name, and how it is written. */
typedef struct kind {
  char name[40];
  bool ascii;
  int compression;
} kind;

static kind kind_of(const char *argument) {
  kind k = {.compression = 1};
  char how[16] = "";
  sscanf(argument, "%39s %15s", k.name, how);
  k.ascii = strcmp(how, "text") == 0;
  if (strcmp(how, "raw") == 0) k.compression = 0;
  if (strcmp(how, "small") == 0) k.compression = 9;
  return k;
}

static laves_result write_as(bench *b, const laves_mesh *mesh, const char *path, laves_error *error) {
  const kind k = kind_of(b->argument);
  laves_write_options options = laves_write_options_default();
  options.ascii = k.ascii;
  options.compression = k.compression;
  if (strstr(k.name, "22.msh")) options.format = LAVES_FORMAT_GMSH22;
  return laves_mesh_write(b->context, mesh, path, &options, error);
}

static void path_of(const bench *b, const char *name, char path[128]) { snprintf(path, 128, "%s/%s", b->folder, name); }

static void need_file(bench *b, const laves_mesh *mesh) {
  char path[128];
  struct stat status;
  laves_error error = {0};
  path_of(b, kind_of(b->argument).name, path);
  if (stat(path, &status) != 0) demand(write_as(b, mesh, path, &error), &error);
}

static void forget_file(const bench *b, const char *name) {
  char path[128], stem[40];
  path_of(b, name, path);
  unlink(path);
  snprintf(stem, sizeof stem, "%.*s", (int)strcspn(name, "."), name);
  static const char *const endings[] = {".node", ".ele", ".face"};
  for (int i = 0; i < 3; i++) {
    snprintf(path, sizeof path, "%s/%s%s", b->folder, stem, endings[i]);
    unlink(path);
  }
}

/* ---- jobs ---- */

static void prepare_nothing(bench *b) { (void)b; }
static void prepare_ball_file(bench *b) {
  need_ball(b);
  need_file(b, b->mesh);
}
static void prepare_spikes_file(bench *b) {
  need_spikes(b);
  need_file(b, b->spikes);
}

static laves_result read_mesh(bench *b, laves_error *error) {
  char path[128];
  laves_mesh *mesh = NULL;
  path_of(b, kind_of(b->argument).name, path);
  const laves_result result = laves_mesh_read(b->context, path, &mesh, error);
  laves_mesh_free(mesh);
  return result;
}

static laves_result read_surface(bench *b, laves_error *error) {
  char path[128];
  laves_domain *domain = NULL;
  path_of(b, kind_of(b->argument).name, path);
  const laves_result result = laves_domain_from_file(b->context, path, &domain, error);
  laves_domain_free(domain);
  return result;
}

static laves_result write_ball(bench *b, laves_error *error) {
  char path[128];
  path_of(b, kind_of(b->argument).name, path);
  const laves_result result = write_as(b, b->mesh, path, error);
  forget_file(b, kind_of(b->argument).name);
  return result;
}

static laves_result write_spikes(bench *b, laves_error *error) {
  char path[128];
  path_of(b, kind_of(b->argument).name, path);
  const laves_result result = write_as(b, b->spikes, path, error);
  forget_file(b, kind_of(b->argument).name);
  return result;
}

/* The argument is the number of a kind of background files. */
static size_file background_of(bench *b) {
  int cells = 1;
  while (24LL * cells * cells * cells < b->tets) cells++;
  return fixture_size_file(atoi(b->argument), cells);
}

static void background_path(const bench *b, const size_file *file, char path[128]) {
  char name[64];
  snprintf(name, sizeof name, "%s-%s", b->argument, file->name);
  path_of(b, name, path);
}

static void prepare_background(bench *b) {
  char path[128];
  const size_file file = background_of(b);
  background_path(b, &file, path);
  FILE *out = fopen(path, "wb");
  if (!out || fwrite(file.bytes, 1, file.length, out) != file.length || fclose(out) != 0) abort();
  free(file.bytes);
}

static laves_result read_background(bench *b, laves_error *error) {
  char path[128];
  laves_sizing *sizing = NULL;
  size_file few = fixture_size_file(atoi(b->argument), 1); /* for its name */
  background_path(b, &few, path);
  free(few.bytes);
  laves_result result = laves_sizing_create(b->context, &sizing, error);
  if (result == LAVES_OK) result = laves_sizing_add_background(sizing, path, NULL, error);
  laves_sizing_free(sizing);
  return result;
}

static laves_result run_script(bench *b, laves_error *error) {
  laves_domain *domain = NULL;
  const laves_result result = laves_domain_from_expression(b->context, b->argument, &domain, error);
  laves_domain_free(domain);
  return result;
}

/* The argument: "EXPRESSION | OPTION=VALUE OPTION=VALUE ..." */
static void read_options(const char *words, double tets, laves_options *options) {
  static const struct {
    const char *name;
    size_t offset;
  } numbers[] = {{"size", offsetof(laves_options, size)},
                 {"curvature", offsetof(laves_options, curvature_elements)},
                 {"thickness", offsetof(laves_options, thickness_elements)},
                 {"distance", offsetof(laves_options, max_distance)},
                 {"growth", offsetof(laves_options, interior_growth)},
                 {"min", offsetof(laves_options, min_size)},
                 {"guarantee", offsetof(laves_options, guarantee)},
                 {"highest", offsetof(laves_options, max_dihedral)}};
  char name[20];
  double value;
  for (int used = 0; sscanf(words, " %19[a-z]=%lf%n", name, &value, &used) == 2; words += used) {
    if (strcmp(name, "tets") == 0) options->tet_target = (int64_t)(value * tets);
    if (strcmp(name, "stuff") == 0) options->method = LAVES_METHOD_STUFF;
    if (strcmp(name, "parts") == 0) options->regions = LAVES_REGIONS_PARTS;
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
      if (strcmp(name, numbers[i].name) == 0) memcpy((char *)options + numbers[i].offset, &value, sizeof value);
  }
}

static laves_result make_mesh(bench *b, laves_error *error) {
  const char *bar = strrchr(b->argument, '|');
  char expression[400];
  laves_domain *domain = NULL;
  laves_mesh *mesh = NULL;
  laves_options options = laves_options_default();
  snprintf(expression, sizeof expression, "%.*s", (int)(bar - b->argument), b->argument);
  read_options(bar + 1, (double)b->tets, &options);
  struct stat status;
  laves_result result = stat(expression, &status) == 0 ? laves_domain_from_file(b->context, expression, &domain, error)
                                                       : laves_domain_from_expression(b->context, expression, &domain, error);
  if (result == LAVES_OK) result = laves_generate(b->context, domain, &options, &mesh, NULL, error);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  return result;
}

static laves_result estimate(bench *b, laves_error *error) {
  laves_domain *domain = NULL;
  laves_options options = laves_options_default();
  laves_expectation expectation;
  options.tet_target = b->tets;
  options.curvature_elements = 20;
  options.interior_growth = 1;
  laves_result result = laves_domain_from_expression(b->context, b->argument, &domain, error);
  if (result == LAVES_OK) result = laves_estimate(b->context, domain, &options, &expectation, error);
  laves_domain_free(domain);
  return result;
}

static laves_result check_ball(bench *b, laves_error *error) {
  laves_check check;
  return laves_check_mesh(b->context, b->mesh, b->domain, &check, error);
}

static laves_result check_spikes(bench *b, laves_error *error) {
  laves_check check;
  return laves_check_mesh(b->context, b->spikes, b->domain, &check, error);
}

static laves_result check_window(bench *b, laves_error *error) {
  enum { PLACES = 100000 };
  size_t count;
  laves_place *places = malloc(PLACES * sizeof *places);
  if (!places) abort();
  const laves_result result = laves_check_window(b->context, b->mesh, b->domain, 60, 80, 0.8, places, PLACES, &count, error);
  free(places);
  return result;
}

static laves_result check_distance(bench *b, laves_error *error) {
  laves_place places[100];
  size_t count;
  return laves_check_distance(b->context, b->mesh, b->domain, 1e-9, places, 100, &count, error);
}

static laves_result check_features(bench *b, laves_error *error) {
  laves_feature_check check;
  size_t count;
  return laves_check_features(b->context, b->mesh, b->domain, NULL, &check, NULL, 0, &count, error);
}

static laves_result certify(bench *b, laves_error *error) {
  laves_certify_options options = laves_certify_options_default();
  laves_certificate *certificate = malloc(sizeof *certificate);
  if (!certificate) abort();
  options.domain = b->domain;
  options.input = "sphere(1)";
  const laves_result result = laves_certify(b->context, b->mesh, &options, certificate, error);
  free(certificate);
  return result;
}

static laves_result copy_arrays(bench *b, laves_error *error) {
  laves_mesh *mesh = NULL;
  const laves_result result = laves_mesh_from_arrays(b->context, laves_mesh_points(b->mesh), laves_mesh_vertex_count(b->mesh),
                                                     laves_mesh_tets(b->mesh), laves_mesh_tet_count(b->mesh), NULL, &mesh, error);
  laves_mesh_free(mesh);
  return result;
}

static laves_result make_tiling(bench *b, laves_error *error) {
  int side = 1;
  laves_mesh *mesh = NULL;
  while (136LL * side * side * side < b->tets) side++;
  const laves_result result = laves_generate_tiling(b->context, (const int[3]){side, side, side}, 1, &mesh, error);
  laves_mesh_free(mesh);
  return result;
}

typedef struct job {
  const char *name, *argument;
  void (*prepare)(bench *b);
  laves_result (*run)(bench *b, laves_error *error);
} job;

#define LONG_LOOP "(function() local s = 0 for i = 1, 9000000 do s = s + i end return sphere(1) end)()"
#define MANY_HOLES                                                                                                               \
  "(function() local s = box(4, 4, 1) for i = 1, 12 do for j = 1, 12 do s = s - move(cylinder{r=0.08, h=2}, {i*0.3-2, j*0.3-2, " \
  "0}) end end return s end)()"

static const job jobs[] = {
    {"read-vtu", "a.vtu", prepare_ball_file, read_mesh},
    {"read-vtu-raw", "b.vtu raw", prepare_ball_file, read_mesh},
    {"read-vtu-text", "c.vtu text", prepare_ball_file, read_mesh},
    {"read-msh22", "a22.msh", prepare_ball_file, read_mesh},
    {"read-msh22-text", "b22.msh text", prepare_ball_file, read_mesh},
    {"read-msh41", "a41.msh", prepare_ball_file, read_mesh},
    {"read-msh41-text", "b41.msh text", prepare_ball_file, read_mesh},
    {"read-medit", "a.meshb", prepare_ball_file, read_mesh},
    {"read-medit-text", "a.mesh text", prepare_ball_file, read_mesh},
    {"read-tetgen", "t.node", prepare_ball_file, read_mesh},
    {"surface-stl", "s.stl", prepare_spikes_file, read_surface},
    {"surface-stl-text", "st.stl text", prepare_spikes_file, read_surface},
    {"surface-obj", "s.obj", prepare_spikes_file, read_surface},
    {"surface-ply", "s.ply", prepare_spikes_file, read_surface},
    {"surface-ply-text", "st.ply text", prepare_spikes_file, read_surface},
    {"surface-off", "s.off", prepare_spikes_file, read_surface},
    {"surface-msh41", "s.msh", prepare_spikes_file, read_surface},
    {"background-0", "0", prepare_background, read_background},
    {"background-1", "1", prepare_background, read_background},
    {"background-2", "2", prepare_background, read_background},
    {"background-3", "3", prepare_background, read_background},
    {"background-4", "4", prepare_background, read_background},
    {"background-5", "5", prepare_background, read_background},
    {"background-6", "6", prepare_background, read_background},
    {"background-7", "7", prepare_background, read_background},
    {"background-8", "8", prepare_background, read_background},
    {"background-9", "9", prepare_background, read_background},
    {"background-10", "10", prepare_background, read_background},
    {"background-11", "11", prepare_background, read_background},
    {"background-12", "12", prepare_background, read_background},
    {"background-13", "13", prepare_background, read_background},
    {"script-loop", LONG_LOOP, prepare_nothing, run_script},
    {"script-holes", MANY_HOLES, prepare_nothing, run_script},
    {"mesh-ball", "sphere(1)|tets=1", prepare_nothing, make_mesh},
    {"mesh-holes", MANY_HOLES "|tets=0.1", prepare_nothing, make_mesh},
    {"mesh-plate", "box(1, 1, 0.02)|tets=0.1", prepare_nothing, make_mesh},
    {"mesh-stuff", "torus(1, 0.3)|stuff=1 tets=0.1 guarantee=20", prepare_nothing, make_mesh},
    {"mesh-picky", "torus(1, 0.3)|tets=0.05 highest=90", prepare_nothing, make_mesh},
    {"mesh-curvature", "torus(1, 0.3)|tets=0.1 curvature=30", prepare_nothing, make_mesh},
    {"mesh-thickness", "torus(1, 0.3)|tets=0.1 thickness=8", prepare_nothing, make_mesh},
    {"mesh-growth", "sphere(1)|tets=0.2 growth=1", prepare_nothing, make_mesh},
    {"mesh-graded", "sphere(1)|tets=1 growth=0.05", prepare_nothing, make_mesh},
    {"mesh-distance", "torus(1, 0.3)|size=0.2 distance=1e-2", prepare_nothing, make_mesh},
    {"mesh-surface", "demo/knot.ply|tets=0.1", prepare_nothing, make_mesh},
    {"mesh-surface-sizes", "demo/knot.ply|tets=0.1 curvature=20 thickness=3", prepare_nothing, make_mesh},
    {"mesh-parts", "demo/bracket.obj|tets=1 parts=1", prepare_nothing, make_mesh},
    {"estimate", "torus(1, 0.3)", prepare_nothing, estimate},
    {"tiling", "", prepare_nothing, make_tiling},
    {"arrays", "", need_ball, copy_arrays},
    {"check", "", need_ball, check_ball},
    {"check-spikes", "", need_spikes, check_spikes},
    {"check-window", "", need_ball, check_window},
    {"check-distance", "", need_ball, check_distance},
    {"check-features", "", need_ball, check_features},
    {"certify", "", need_ball, certify},
    {"write-vtu", "w.vtu", need_ball, write_ball},
    {"write-vtu-raw", "w.vtu raw", need_ball, write_ball},
    {"write-vtu-small", "w.vtu small", need_ball, write_ball},
    {"write-vtu-text", "w.vtu text", need_ball, write_ball},
    {"write-msh22", "w22.msh", need_ball, write_ball},
    {"write-msh22-text", "w22.msh text", need_ball, write_ball},
    {"write-msh41", "w41.msh", need_ball, write_ball},
    {"write-msh41-text", "w41.msh text", need_ball, write_ball},
    {"write-medit", "w.meshb", need_ball, write_ball},
    {"write-medit-text", "w.mesh text", need_ball, write_ball},
    {"write-tetgen", "w.node", need_ball, write_ball},
    {"write-stl", "w.stl", need_spikes, write_spikes},
    {"write-obj", "w.obj", need_spikes, write_spikes},
    {"write-ply", "w.ply", need_spikes, write_spikes},
    {"write-off", "w.off", need_spikes, write_spikes},
};
enum { JOBS = sizeof jobs / sizeof jobs[0] };

/* ---- measuring ---- */

typedef struct measured {
  laves_result result;
  double seconds;   /* of the call */
  double late;      /* from the wish to cancel to the return; negative: none was asked for */
  size_t left_over; /* bytes that the job kept */
} measured;

/* Cancels the job when it has run for so long; negative: never. */
static measured run_once(bench *b, const job *j, double cancel_after) {
  laves_error error = {0};
  measured m = {0};
  const size_t held = laves_context_bytes(b->context);
  b->argument = j->argument;
  const double start = now();
  the_watch = (watch){.by_wall = the_watch.by_wall, .asked = cancel_after < 0 ? -1 : start + cancel_after, .latest = start};
  the_watch.phase = the_watch.before = the_watch.after = "(start)";
  m.result = j->run(b, &error);
  note(&the_watch, "(end)");
  m.seconds = now() - start;
  m.late = m.seconds - cancel_after;
  m.left_over = laves_context_bytes(b->context) - held;
  the_watch.latest = 0;
  the_watch.asked = -1;
  if (m.result != LAVES_OK && m.result != LAVES_TARGET_MISSED && m.result != LAVES_ERROR_CANCELLED)
    fprintf(stderr, "cancel: %s: %s\n", j->name, error.text);
  return m;
}

/* @return false when it does not keep the promise */
static bool measure(bench *b, const job *j, int cuts) {
  b->argument = j->argument;
  the_watch.asked = -1;
  j->prepare(b);
  const measured whole = run_once(b, j, -1);
  const watch seen = the_watch;
  bool fine = whole.left_over == 0 && (whole.result == LAVES_OK || whole.result == LAVES_TARGET_MISSED);
  double latest = 0;
  for (int cut = 0; fine && cut < cuts; cut++) {
    const measured part = run_once(b, j, whole.seconds * (cut + 0.5) / cuts);
    fine = part.left_over == 0; /* the last cuts may come too late, when nothing is left to be cancelled */
    if (part.late > latest) latest = part.late;
  }
  fine = fine && seen.longest <= promised_seconds && latest <= promised_seconds;
  printf("%-20s %8.2f %8zu %8.3f %8.3f  %s -> %s%s\n", j->name, whole.seconds, seen.calls, seen.longest, latest, seen.before,
         seen.after, fine ? "" : "   TOO LATE");
  fflush(stdout);
  return fine;
}

static bool is_named(const job *j, int count, char **words) {
  for (int i = 0; i < count; i++)
    if (strncmp(j->name, words[i], strlen(words[i])) == 0) return true;
  return count == 0;
}

static void list_jobs(void) {
  for (size_t i = 0; i < JOBS; i++) puts(jobs[i].name);
}

int main(int count, char **words) {
  bench b = {.tets = 5000000};
  int threads = 1, cuts = 8, first = 1;
  for (; first < count && strncmp(words[first], "--", 2) == 0; first += 2) {
    const char *value = first + 1 < count ? words[first + 1] : NULL;
    if (strcmp(words[first], "--list") == 0) {
      list_jobs();
      return 0;
    }
    if (value && strcmp(words[first], "--threads") == 0) {
      threads = atoi(value);
    } else if (value && strcmp(words[first], "--tets") == 0) {
      b.tets = atoll(value);
    } else if (value && strcmp(words[first], "--cuts") == 0) {
      cuts = atoi(value);
    } else if (value && strcmp(words[first], "--stacks") == 0) {
      stack_seconds = atof(value);
    } else {
      fputs(how_to_use, stderr);
      return 1;
    }
  }
  laves_context_options options = laves_context_options_default();
  options.thread_count = threads;
  options.progress = on_progress;
  options.progress_user = &the_watch;
  the_watch = (watch){.by_wall = threads != 1, .asked = -1};
  b.context = laves_context_create(&options);
  snprintf(b.folder, sizeof b.folder, "/tmp/laves-cancel-XXXXXX");
  if (!b.context || !mkdtemp(b.folder)) return 1;
  if (stack_seconds > 0) start_alarms();
  printf("%-20s %8s %8s %8s %8s\n", "job", "seconds", "calls", "silence", "latency");
  bool fine = true;
  for (size_t i = 0; i < JOBS; i++)
    if (is_named(&jobs[i], count - first, words + first)) fine = measure(&b, &jobs[i], cuts) && fine;
  laves_mesh_free(b.mesh);
  laves_mesh_free(b.spikes);
  laves_domain_free(b.domain);
  laves_context_free(b.context);
  char command[100];
  snprintf(command, sizeof command, "rm -r '%s'", b.folder);
  return system(command) != 0 || !fine;
}
