/* Meshes one solid and prints what the benchmark needs to know about it as one line of JSON.
 *
 *   measure INPUT TETS [--size H] [--method HOW] [--window LO,HI] [--no-features] [--threads N] [--repeat N]
 *           [--judge] [--distance] [--write FILE]
 *
 * INPUT: a surface, a script, noise:KIND:SEED:SCALE (tests/fixtures/noise.h), or else an expression; TETS: how many are wished,
 * unless a size is given. Seconds, of CPU those of the whole process, are told
 * apart for reading, meshing and writing (an uncompressed VTU), lists of one number a run. Bytes are those of the context: held
 * by the domain once it is read, by domain and mesh in the end, and the most at once.
 * --judge adds angles, validity and every tet outside the window of angles and volume-length with the radius of curvature
 * there; --distance adds the distances both ways and the places that are further than 0.3 sizes from the surface. */
#include <laves/laves.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "fixtures/noise.h"

enum { RUNS_MAX = 100, PLACES_MAX = 1000000 };

/* Windows whose violations are told: what is asked by default, what is to be attained where the solid is resolved, and what
 * can be asked for. */
typedef struct window {
  const char *name;
  double min_dihedral, max_dihedral, volume_length;
} window;
static const window windows[] = {{"outside", 40, 125, 0.6}, {"goal", 41, 122.5, 0.64}, {"aim", 43, 120, 0}};
/* From where on a distance is told. */
static const double distance_in_sizes = 0.3;

static const char how_to_use[] =
    "measure INPUT TETS [--size H] [--method HOW] [--window LO,HI] [--no-features] [--threads N] [--repeat N] [--judge] "
    "[--distance] [--write FILE]\n";

typedef struct request {
  const char *input, *output;
  long long tets;
  double size;
  double window[2]; /* asked; 0: the default */
  laves_method method;
  int threads, repeat;
  bool judge, distance, no_features;
} request;

/* Seconds of each run. */
typedef struct times {
  double read[RUNS_MAX], mesh[RUNS_MAX], write[RUNS_MAX];
  double read_wall[RUNS_MAX], mesh_wall[RUNS_MAX], write_wall[RUNS_MAX];
  double least; /* of mesh */
} times;

typedef struct run {
  laves_context *context;
  noise noise;
  laves_domain *domain;
  laves_mesh *mesh;
  size_t empty_bytes, domain_bytes; /* what the context held before and after the input was read */
  laves_report report;              /* of the run that took the fewest CPU seconds */
  laves_error error;
} run;

static double cpu_seconds(void) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return (double)usage.ru_utime.tv_sec + (double)usage.ru_stime.tv_sec +
         1e-6 * ((double)usage.ru_utime.tv_usec + (double)usage.ru_stime.tv_usec);
}

static double wall_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- output ---- */

static void print_text(const char *text) {
  putchar('"');
  for (; *text; text++) {
    if (*text == '"' || *text == '\\') putchar('\\');
    putchar((unsigned char)*text < ' ' ? ' ' : *text);
  }
  putchar('"');
}

/* JSON has no word for what is not finite. */
static void print_number(double value) {
  if (isfinite(value))
    printf("%.9g", value);
  else
    printf("null");
}

static void print_field(const char *name, double value) {
  printf(", \"%s\": ", name);
  print_number(value);
}

static void print_list(const char *name, const double *values, int count) {
  printf(", \"%s\": [", name);
  for (int i = 0; i < count; i++) {
    if (i) printf(", ");
    print_number(values[i]);
  }
  printf("]");
}

/* Each place as [x, y, z, value, radius of curvature]; null for a radius means flat. */
static void print_places(const char *name, const laves_place *places, size_t count) {
  printf(", \"%s\": [", name);
  for (size_t i = 0; i < count; i++) {
    const laves_place *p = &places[i];
    const double values[5] = {p->place[0], p->place[1], p->place[2], p->value, p->curvature_radius};
    printf(i ? ", [" : "[");
    for (int k = 0; k < 5; k++) {
      if (k) printf(", ");
      print_number(values[k]);
    }
    printf("]");
  }
  printf("]");
}

/* ---- judging ---- */

static laves_result judge_window(run *r, const window *w, laves_place *places) {
  size_t count = 0;
  char name[40];
  const laves_result result = laves_check_window(r->context, r->mesh, r->domain, w->min_dihedral, w->max_dihedral,
                                                 w->volume_length, places, PLACES_MAX, &count, &r->error);
  if (result != LAVES_OK) return result;
  print_field(w->name, (double)count);
  snprintf(name, sizeof name, "%s_places", w->name);
  print_places(name, places, count < PLACES_MAX ? count : PLACES_MAX);
  return LAVES_OK;
}

static laves_result judge_shapes(run *r, laves_place *places) {
  laves_check check;
  laves_result result = laves_check_mesh(r->context, r->mesh, NULL, &check, &r->error);
  if (result != LAVES_OK) return result;
  printf(", \"valid\": %s", check.valid ? "true" : "false");
  print_field("min_dihedral", check.min_dihedral.min);
  print_field("max_dihedral", check.max_dihedral.max);
  print_field("volume_length", check.volume_length.min);
  print_field("radius_ratio_mean", check.radius_ratio.mean);
  for (size_t i = 0; i < sizeof windows / sizeof windows[0] && result == LAVES_OK; i++)
    result = judge_window(r, &windows[i], places);
  return result;
}

static laves_result judge_distance(run *r, laves_place *places) {
  size_t count = 0;
  laves_check check;
  laves_result result = laves_check_mesh(r->context, r->mesh, r->domain, &check, &r->error);
  if (result == LAVES_OK)
    result = laves_check_distance(r->context, r->mesh, r->domain, distance_in_sizes * r->report.size, places, PLACES_MAX, &count,
                                  &r->error);
  if (result != LAVES_OK) return result;
  print_field("to_surface_mean", check.to_surface_mean);
  print_field("to_surface_max", check.to_surface_max);
  print_field("from_surface_mean", check.from_surface_mean);
  print_field("from_surface_max", check.from_surface_max);
  print_field("distant", (double)count);
  print_places("distant_places", places, count < PLACES_MAX ? count : PLACES_MAX);
  return LAVES_OK;
}

static laves_result judge(const request *q, run *r) {
  laves_result result = LAVES_OK;
  laves_place *places = malloc(PLACES_MAX * sizeof *places);
  if (!places) return LAVES_ERROR_MEMORY;
  if (q->judge) result = judge_shapes(r, places);
  if (q->distance && result == LAVES_OK) result = judge_distance(r, places);
  free(places);
  return result;
}

static void describe(const request *q, const run *r, const times *t) {
  laves_domain_info info;
  char hash[33];
  double diagonal = 0;
  laves_domain_get_info(r->domain, &info);
  for (int i = 0; i < 3; i++) diagonal += (info.upper[i] - info.lower[i]) * (info.upper[i] - info.lower[i]);
  laves_mesh_hash(r->mesh, hash);
  printf("{\"input\": ");
  print_text(q->input);
  printf(", \"hash\": \"%s\"", hash);
  print_field("tets", (double)laves_mesh_tet_count(r->mesh));
  print_field("size", r->report.size);
  print_field("diagonal", sqrt(diagonal));
  print_field("promised_min", r->report.promised_min_dihedral);
  print_field("promised_max", r->report.promised_max_dihedral);
  print_field("stuffed_vertices", (double)r->report.stuffed_vertices);
  print_field("domain_bytes", (double)r->domain_bytes - (double)r->empty_bytes);
  print_field("result_bytes", (double)laves_context_bytes(r->context) - (double)r->empty_bytes);
  print_field("peak_bytes", (double)laves_context_peak_bytes(r->context));
  print_list("read_cpu", t->read, q->repeat);
  print_list("read_wall", t->read_wall, q->repeat);
  print_list("mesh_cpu", t->mesh, q->repeat);
  print_list("mesh_wall", t->mesh_wall, q->repeat);
  print_list("write_cpu", t->write, q->repeat);
  print_list("write_wall", t->write_wall, q->repeat);
  printf(", \"stages_cpu\": {");
  for (int i = 0; i < r->report.stage_count; i++) {
    printf("%s\"%s\": ", i ? ", " : "", r->report.stages[i].name);
    print_number(r->report.stages[i].cpu_seconds);
  }
  printf("}");
}

/* ---- meshing ---- */

static laves_result read_input(run *r, const char *input) {
  if (access(input, F_OK) == 0) return laves_domain_from_file(r->context, input, &r->domain, &r->error);
  int kind;
  unsigned long long seed;
  if (sscanf(input, "noise:%d:%llu:%lf", &kind, &seed, &r->noise.scale) == 3 && kind >= 0 && kind < NOISE_KINDS) {
    r->noise.kind = (noise_kind)kind;
    r->noise.seed = seed;
    const laves_function function = noise_function(&r->noise);
    return laves_domain_from_function(r->context, &function, &r->domain, &r->error);
  }
  return laves_domain_from_expression(r->context, input, &r->domain, &r->error);
}

static laves_result mesh_once(const request *q, run *r, times *t, int turn) {
  laves_options options = laves_options_default();
  if (q->no_features) options.feature_angle = 0;
  laves_write_options files = laves_write_options_default();
  if (q->size > 0)
    options.size = q->size;
  else
    options.tet_target = q->tets;
  options.method = q->method;
  if (q->window[0] > 0) {
    options.min_dihedral = q->window[0];
    options.max_dihedral = q->window[1];
  }
  files.compression = 0;
  r->empty_bytes = laves_context_bytes(r->context);
  const double start = cpu_seconds(), start_wall = wall_seconds();
  laves_result result = read_input(r, q->input);
  if (result != LAVES_OK) return result;
  const double have_domain = cpu_seconds(), have_domain_wall = wall_seconds();
  r->domain_bytes = laves_context_bytes(r->context);
  laves_report report;
  result = laves_generate(r->context, r->domain, &options, &r->mesh, &report, &r->error);
  if (result != LAVES_OK && result != LAVES_TARGET_MISSED) return result;
  const double have_mesh = cpu_seconds(), have_mesh_wall = wall_seconds();
  t->read[turn] = have_domain - start;
  t->read_wall[turn] = have_domain_wall - start_wall;
  t->mesh[turn] = have_mesh - have_domain;
  t->mesh_wall[turn] = have_mesh_wall - have_domain_wall;
  if (turn == 0 || t->mesh[turn] < t->least) {
    t->least = t->mesh[turn];
    r->report = report;
  }
  t->write[turn] = t->write_wall[turn] = 0;
  if (!q->output) return LAVES_OK;
  result = laves_mesh_write(r->context, r->mesh, q->output, &files, &r->error);
  t->write[turn] = cpu_seconds() - have_mesh;
  t->write_wall[turn] = wall_seconds() - have_mesh_wall;
  return result;
}

static void drop(run *r) {
  laves_mesh_free(r->mesh);
  laves_domain_free(r->domain);
  r->mesh = NULL;
  r->domain = NULL;
}

static laves_result work(const request *q, run *r) {
  times t;
  laves_result result = LAVES_OK;
  for (int i = 0; i < q->repeat && result == LAVES_OK; i++) {
    drop(r);
    result = mesh_once(q, r, &t, i);
  }
  if (result != LAVES_OK) return result;
  describe(q, r, &t);
  result = judge(q, r);
  printf("}\n");
  return result;
}

static bool parse_method(const char *word, laves_method *method) {
  static const char *const names[] = {"auto", "snap", "stuff"};
  for (int i = 0; i < 3; i++) {
    if (strcmp(word, names[i]) != 0) continue;
    *method = (laves_method)i;
    return true;
  }
  return false;
}

static bool parse(int count, char **words, request *q) {
  *q = (request){.repeat = 1};
  if (count < 3) return false;
  q->input = words[1];
  q->tets = atoll(words[2]);
  for (int i = 3; i < count; i++) {
    const bool more = i + 1 < count;
    if (strcmp(words[i], "--judge") == 0)
      q->judge = true;
    else if (strcmp(words[i], "--distance") == 0)
      q->distance = true;
    else if (strcmp(words[i], "--no-features") == 0)
      q->no_features = true;
    else if (strcmp(words[i], "--size") == 0 && more)
      q->size = atof(words[++i]);
    else if (strcmp(words[i], "--method") == 0 && more && parse_method(words[i + 1], &q->method))
      i++;
    else if (strcmp(words[i], "--window") == 0 && more && sscanf(words[i + 1], "%lf,%lf", &q->window[0], &q->window[1]) == 2)
      i++;
    else if (strcmp(words[i], "--threads") == 0 && more)
      q->threads = atoi(words[++i]);
    else if (strcmp(words[i], "--repeat") == 0 && more)
      q->repeat = atoi(words[++i]);
    else if (strcmp(words[i], "--write") == 0 && more)
      q->output = words[++i];
    else
      return false;
  }
  return q->tets > 0 && q->repeat >= 1 && q->repeat <= RUNS_MAX;
}

int main(int count, char **words) {
  request q;
  run r = {0};
  if (!parse(count, words, &q)) {
    fputs(how_to_use, stderr);
    return 1;
  }
  laves_context_options options = laves_context_options_default();
  options.thread_count = q.threads;
  r.context = laves_context_create(&options);
  laves_result result = r.context ? work(&q, &r) : LAVES_ERROR_MEMORY;
  if (result != LAVES_OK) fprintf(stderr, "measure: %s: %s\n", q.input, r.error.text);
  drop(&r);
  laves_context_free(r.context);
  return laves_result_exit_code(result);
}
