/* Small jobs that together go through the whole library. */
#include "fault/jobs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fixtures/line_files.h"
#include "fixtures/shapes.h"
#include "fixtures/size_files.h"

enum { PATH_BYTES = FIXTURE_FOLDER_MAX + 100 };

/* ---- digests: FNV-1a, 64 bits ---- */

static void take_bytes(job_outcome *out, const void *bytes, size_t count) {
  const unsigned char *at = bytes;
  for (size_t i = 0; i < count; i++) out->digest = (out->digest ^ at[i]) * UINT64_C(0x100000001b3);
}

static void take_number(job_outcome *out, double value) { take_bytes(out, &value, sizeof value); }

static void take_text(job_outcome *out, const char *text) { take_bytes(out, text, strlen(text) + 1); }

static void take_file(job_outcome *out, const char *path) {
  FILE *file = fopen(path, "rb");
  char bytes[4096];
  for (size_t got = 1; file && got > 0;) {
    got = fread(bytes, 1, sizeof bytes, file);
    take_bytes(out, bytes, got);
  }
  if (file) fclose(file);
}

static void take_mesh(job_outcome *out, const laves_mesh *mesh) {
  char hash[33];
  laves_mesh_hash(mesh, hash);
  take_text(out, hash);
  const int32_t *sources = laves_mesh_face_sources(mesh);
  if (sources) take_bytes(out, sources, laves_mesh_face_count(mesh) * sizeof *sources);
}

static void take_report(job_outcome *out, const laves_report *report) {
  take_number(out, report->size);
  take_number(out, report->volume);
  take_number(out, (double)report->outside_window);
  take_number(out, (double)report->off_surface);
  take_number(out, (double)report->corners_kept);
  take_number(out, report->crease_kept);
  take_number(out, (double)report->lost_count);
  for (int i = 0; i < report->warning_count; i++) take_text(out, report->warnings[i]);
}

static void take_info(job_outcome *out, const laves_domain *domain) {
  laves_domain_info info;
  laves_domain_get_info(domain, &info);
  take_text(out, info.format ? info.format : "");
  take_bytes(out, info.lower, sizeof info.lower);
  take_bytes(out, info.upper, sizeof info.upper);
  take_number(out, info.volume);
  take_bytes(out, info.defects, sizeof info.defects);
  for (int i = 0; i < info.tag_count; i++) take_text(out, laves_domain_tag_name(domain, i));
}

/* ---- places ---- */

static const char *input_path(const job_place *place, const char *name, char path[PATH_BYTES]) {
  snprintf(path, PATH_BYTES, "%s/%s", place->inputs, name);
  return path;
}

static const char *output_path(const job_place *place, const char *name, char path[PATH_BYTES]) {
  snprintf(path, PATH_BYTES, "%s/%s", place->outputs, name);
  return path;
}

/* ---- domains ---- */

static laves_result read_domain(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  char path[PATH_BYTES];
  laves_domain *domain = NULL;
  const laves_result result = laves_domain_from_file(context, input_path(place, what, path), &domain, &out->error);
  if (domain) take_info(out, domain);
  laves_domain_free(domain);
  return result;
}

static laves_result make_expression(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  (void)place;
  laves_domain *domain = NULL;
  const laves_result result = laves_domain_from_expression(context, what, &domain, &out->error);
  if (domain) take_info(out, domain);
  laves_domain_free(domain);
  return result;
}

static laves_result read_features(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  laves_features *features = NULL;
  laves_result result = laves_features_create(context, &features, &out->error);
  for (int kind = 0; result == LAVES_OK && kind < LINE_FILE_KINDS; kind++) {
    char name[40], path[PATH_BYTES];
    snprintf(name, sizeof name, "%s%d", what, kind);
    result = laves_features_add_file(features, input_path(place, name, path), &out->error);
  }
  laves_features_free(features);
  return result;
}

static laves_result read_backgrounds(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  laves_sizing *sizing = NULL;
  laves_result result = laves_sizing_create(context, &sizing, &out->error);
  for (int kind = 0; result == LAVES_OK && kind < SIZE_FILE_KINDS; kind++) {
    char name[40], path[PATH_BYTES];
    snprintf(name, sizeof name, "%s%d", what, kind);
    result = laves_sizing_add_background(sizing, input_path(place, name, path), NULL, &out->error);
  }
  laves_sizing_free(sizing);
  return result;
}

/* ---- meshes ---- */

static laves_result generate(laves_context *context, const laves_domain *domain, const laves_options *options, job_outcome *out) {
  laves_mesh *mesh = NULL;
  laves_report report;
  const laves_result result = laves_generate(context, domain, options, &mesh, &report, &out->error);
  if (mesh) {
    take_mesh(out, mesh);
    take_report(out, &report);
  }
  laves_mesh_free(mesh);
  return result;
}

static bool is_file_name(const char *what) { return !strchr(what, '(') && strchr(what, '.'); }

static laves_result open_domain(laves_context *context, const job_place *place, const char *what, laves_domain **domain,
                                laves_error *error) {
  char path[PATH_BYTES];
  if (!is_file_name(what)) return laves_domain_from_expression(context, what, domain, error);
  return laves_domain_from_file(context, input_path(place, what, path), domain, error);
}

static laves_result mesh_with(laves_context *context, const job_place *place, const char *what, laves_options options,
                              job_outcome *out) {
  laves_domain *domain = NULL;
  laves_result result = open_domain(context, place, what, &domain, &out->error);
  if (result == LAVES_OK) result = generate(context, domain, &options, out);
  laves_domain_free(domain);
  return result;
}

static laves_options options_of_size(double size) {
  laves_options options = laves_options_default();
  options.size = size;
  return options;
}

static laves_result mesh_by_snap(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  laves_options options = options_of_size(0.45);
  options.method = LAVES_METHOD_SNAP;
  return mesh_with(context, place, what, options, out);
}

static laves_result mesh_by_stuff(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  laves_options options = options_of_size(0.6);
  options.method = LAVES_METHOD_STUFF;
  options.guarantee = 24;
  return mesh_with(context, place, what, options, out);
}

/* Snapping leaves tets outside so high a window, and what is near them is made anew. */
static laves_result mesh_by_graft(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  laves_options options = options_of_size(0.2);
  options.guarantee = 28;
  return mesh_with(context, place, what, options, out);
}

static laves_result mesh_by_default(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  return mesh_with(context, place, what, options_of_size(0.5), out);
}

static laves_result mesh_thin(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  return mesh_with(context, place, what, options_of_size(0.4), out);
}

static laves_result mesh_to_count(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  laves_options options = laves_options_default();
  options.tet_target = 400;
  options.align = LAVES_ALIGN_PCA;
  return mesh_with(context, place, what, options, out);
}

static laves_result mesh_parts(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  laves_options options = options_of_size(0.5);
  options.regions = LAVES_REGIONS_PARTS;
  options.face_sources = true;
  options.feature_tags = true;
  return mesh_with(context, place, what, options, out);
}

/* The text drawing holds a line over one side of the box [-0.5, 0.5]^3. */
static laves_result mesh_drawn(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  static const double points[] = {0.5, 0.1, 0.2}, line[] = {-0.5, -0.5, 0.1, -0.5, 0.5, -0.1};
  char path[PATH_BYTES];
  laves_features *features = NULL;
  laves_result result = laves_features_create(context, &features, &out->error);
  if (result == LAVES_OK) result = laves_features_add_file(features, input_path(place, "drawn.txt", path), &out->error);
  if (result == LAVES_OK) result = laves_features_add_points(features, points, 1, &out->error);
  if (result == LAVES_OK) result = laves_features_add_line(features, line, 2, &out->error);
  laves_options options = options_of_size(0.4);
  options.features = features;
  if (result == LAVES_OK) result = mesh_with(context, place, what, options, out);
  laves_features_free(features);
  return result;
}

static laves_result add_sources(laves_sizing *sizing, const job_place *place, laves_error *error) {
  static const double points[] = {0, 0, 0, 0.5, 0.5, 0.5};
  static const char *const files[] = {"size0", "size8", "size13"}; /* NRRD, VTU, pos */
  char path[PATH_BYTES];
  laves_result result = laves_sizing_add_expression(sizing, "0.3 + 0.1*abs(x) + d", error);
  if (result == LAVES_OK) result = laves_sizing_add_script(sizing, input_path(place, "size.lua", path), error);
  for (int i = 0; result == LAVES_OK && i < 3; i++)
    result = laves_sizing_add_background(sizing, input_path(place, files[i], path), NULL, error);
  if (result == LAVES_OK) result = laves_sizing_add_points(sizing, points, 1, 0.3, 0.1, error);
  if (result == LAVES_OK) result = laves_sizing_add_curve(sizing, points, 2, 0.3, 0.1, error);
  return result == LAVES_OK ? laves_sizing_add_tag(sizing, "x low", 0.35, 0, error) : result;
}

static laves_options graded_options(const laves_sizing *sizing) {
  laves_options options = options_of_size(0.6);
  options.sizing = sizing;
  options.min_size = 0.25;
  options.curvature_elements = 8;
  options.thickness_elements = 1;
  options.feature_elements = 1;
  options.max_distance = 0.1;
  options.interior_growth = 0.2;
  return options;
}

typedef laves_result use_sizing_fn(laves_context *context, const laves_domain *domain, const laves_options *options,
                                   job_outcome *out);

static laves_result with_sizing(laves_context *context, const job_place *place, const char *what, use_sizing_fn *use,
                                job_outcome *out) {
  laves_sizing *sizing = NULL;
  laves_domain *domain = NULL;
  laves_result result = laves_sizing_create(context, &sizing, &out->error);
  if (result == LAVES_OK) result = add_sources(sizing, place, &out->error);
  if (result == LAVES_OK) result = open_domain(context, place, what, &domain, &out->error);
  const laves_options options = graded_options(sizing);
  if (result == LAVES_OK) result = use(context, domain, &options, out);
  laves_domain_free(domain);
  laves_sizing_free(sizing);
  return result;
}

static laves_result mesh_graded(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  return with_sizing(context, place, what, generate, out);
}

static laves_result estimate_one(laves_context *context, const laves_domain *domain, const laves_options *options,
                                 job_outcome *out) {
  laves_expectation expectation;
  const laves_result result = laves_estimate(context, domain, options, &expectation, &out->error);
  if (result != LAVES_OK) return result;
  take_number(out, expectation.size);
  take_number(out, expectation.tets);
  take_number(out, expectation.vertices);
  return result;
}

static laves_result find_thin(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  laves_domain *domain = NULL;
  laves_thin_place places[4];
  laves_result result = open_domain(context, place, what, &domain, &out->error);
  if (result == LAVES_OK) {
    const size_t count = laves_domain_thin_places(domain, places, 4);
    for (size_t i = 0; i < count; i++) take_number(out, places[i].thickness);
    if (count == 0 && isnan(places[0].thickness)) {
      result = out->error.result = LAVES_ERROR_MEMORY;
      snprintf(out->error.text, sizeof out->error.text, "memory is short");
    }
  }
  laves_domain_free(domain);
  return result;
}

static laves_result estimate(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  return with_sizing(context, place, what, estimate_one, out);
}

static void ball(void *user, const double *points, size_t count, double *values) {
  (void)user;
  for (size_t i = 0; i < count; i++) {
    const double *p = points + 3 * i;
    values[i] = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1;
  }
}

static laves_result mesh_function(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  (void)place, (void)what;
  const laves_function function = {.evaluate = ball, .lower = {-1.1, -1.1, -1.1}, .upper = {1.1, 1.1, 1.1}, .lipschitz = 1};
  laves_domain *domain = NULL;
  const laves_options options = options_of_size(0.6);
  laves_result result = laves_domain_from_function(context, &function, &domain, &out->error);
  if (result == LAVES_OK) result = generate(context, domain, &options, out);
  laves_domain_free(domain);
  return result;
}

/* Parted vertices, too, and a file of it. */
static laves_result mesh_streamed(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  laves_domain *domain = NULL;
  laves_mesh *mesh = NULL;
  laves_report report;
  char path[PATH_BYTES];
  laves_options options = options_of_size(0.4);
  options.streamed = true;
  snprintf(path, sizeof path, "%s/streamed.vtu", place->outputs);
  laves_result result = open_domain(context, place, what, &domain, &out->error);
  if (result == LAVES_OK) result = laves_generate(context, domain, &options, &mesh, &report, &out->error);
  if (mesh) result = laves_mesh_write(context, mesh, path, NULL, &out->error);
  if (result == LAVES_OK) {
    take_mesh(out, mesh);
    take_file(out, path);
    remove(path);
  }
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  return result;
}

static laves_result make_tiling(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  (void)place, (void)what;
  laves_mesh *mesh = NULL;
  const laves_result result = laves_generate_tiling(context, (const int[]){2, 1, 1}, 1, &mesh, &out->error);
  if (mesh) take_mesh(out, mesh);
  laves_mesh_free(mesh);
  return result;
}

/* ---- checks ---- */

typedef struct subject {
  laves_domain *domain;
  laves_mesh *mesh;
} subject;

/* The mesh in the file "cube.vtu", of the solid "cube.off". */
static laves_result open_subject(laves_context *context, const job_place *place, subject *s, laves_error *error) {
  char path[PATH_BYTES];
  *s = (subject){0};
  laves_result result = laves_domain_from_file(context, input_path(place, "cube.off", path), &s->domain, error);
  if (result == LAVES_OK) result = laves_mesh_read(context, input_path(place, "cube.vtu", path), &s->mesh, error);
  return result;
}

static void close_subject(const subject *s) {
  laves_mesh_free(s->mesh);
  laves_domain_free(s->domain);
}

static laves_result check_all(laves_context *context, const subject *s, job_outcome *out) {
  enum { CAPACITY = 20 };
  laves_check check;
  laves_place places[CAPACITY];
  size_t count = 0;
  laves_result result = laves_check_mesh(context, s->mesh, s->domain, &check, &out->error);
  if (result != LAVES_OK) return result;
  take_number(out, check.volume);
  take_bytes(out, check.histogram, sizeof check.histogram);
  take_number(out, check.to_surface_at_most);
  take_number(out, check.from_surface_max);
  result = laves_check_window(context, s->mesh, s->domain, 50, 90, 0.8, places, CAPACITY, &count, &out->error);
  take_number(out, (double)count);
  if (result != LAVES_OK) return result;
  result = laves_check_distance(context, s->mesh, s->domain, 1e-4, places, CAPACITY, &count, &out->error);
  take_number(out, (double)count);
  return result;
}

static laves_result check_mesh(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  (void)what;
  subject s;
  laves_result result = open_subject(context, place, &s, &out->error);
  if (result == LAVES_OK) result = check_all(context, &s, out);
  close_subject(&s);
  return result;
}

/* The mesh stays in its file. */
static laves_result check_file(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  enum { CAPACITY = 20 };
  char path[PATH_BYTES];
  laves_domain *domain = NULL;
  laves_file_check found;
  laves_place places[CAPACITY];
  laves_file_check_options options = laves_file_check_options_default();
  laves_result result = laves_domain_from_file(context, input_path(place, "cube.off", path), &domain, &out->error);
  options.domain = domain;
  options.min_dihedral = 50;
  options.places = places;
  options.place_capacity = CAPACITY;
  if (result == LAVES_OK) result = laves_check_file(context, input_path(place, what, path), &options, &found, &out->error);
  if (result == LAVES_OK) {
    take_number(out, found.check.volume);
    take_bytes(out, found.check.histogram, sizeof found.check.histogram);
    take_number(out, found.check.from_surface_max);
    take_number(out, (double)found.outside_window);
    take_number(out, (double)found.file_faces_missing);
    take_number(out, places[0].value);
  }
  laves_domain_free(domain);
  return result;
}

static laves_result check_features(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  (void)what;
  enum { CAPACITY = 5 };
  laves_feature_check check;
  laves_feature_place places[LAVES_FEATURE_FAULT_COUNT * CAPACITY];
  size_t count = 0;
  subject s;
  laves_result result = open_subject(context, place, &s, &out->error);
  if (result == LAVES_OK)
    result = laves_check_features(context, s.mesh, s.domain, NULL, &check, places, CAPACITY, &count, &out->error);
  if (result == LAVES_OK) {
    take_number(out, (double)count);
    take_number(out, check.kept_share);
    take_number(out, check.away_min_dihedral);
  }
  close_subject(&s);
  return result;
}

/* Certifies, writes, reads what was written and verifies it. */
static laves_result certify(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  static laves_certificate made, read;
  enum { CAPACITY = 5 };
  laves_difference differences[CAPACITY];
  size_t count = 0;
  char path[PATH_BYTES], input[PATH_BYTES];
  subject s;
  laves_certify_options options = laves_certify_options_default();
  laves_result result = open_subject(context, place, &s, &out->error);
  options.domain = s.domain;
  options.input = input_path(place, "cube.off", input);
  options.feature_angle = 40;
  output_path(place, what, path);
  if (result == LAVES_OK) result = laves_certify(context, s.mesh, &options, &made, &out->error);
  if (result == LAVES_OK) result = laves_certificate_write(context, &made, path, &out->error);
  const bool written = result == LAVES_OK;
  if (written) take_file(out, path);
  if (written) result = laves_certificate_read(context, path, &read, &out->error);
  if (result == LAVES_OK)
    result = laves_certificate_verify(context, s.mesh, s.domain, input, &read, differences, CAPACITY, &count, &out->error);
  take_number(out, (double)count);
  if (written) remove(path);
  close_subject(&s);
  return result;
}

static laves_result read_certificate(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  static laves_certificate read;
  char path[PATH_BYTES];
  const laves_result result = laves_certificate_read(context, input_path(place, what, path), &read, &out->error);
  if (result == LAVES_OK) take_text(out, read.mesh_hash);
  return result;
}

/* ---- mesh files ---- */

static laves_result read_mesh(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  char path[PATH_BYTES];
  laves_mesh *mesh = NULL;
  const laves_result result = laves_mesh_read(context, input_path(place, what, path), &mesh, &out->error);
  if (mesh) take_mesh(out, mesh);
  laves_mesh_free(mesh);
  return result;
}

/* Names that end in the first of these stand for several files. */
static const char *const companions[][3] = {{".node", ".ele", ".face"}, {".xdmf", ".h5", NULL}};

static bool ends_in(const char *path, const char *ending) {
  const size_t length = strlen(path), tail = strlen(ending);
  return length > tail && strcmp(path + length - tail, ending) == 0;
}

static void take_and_remove(const char *path, job_outcome *out) {
  take_file(out, path);
  remove(path);
}

/* Takes what was written, and removes it. */
static void take_written(const char *path, job_outcome *out) {
  take_and_remove(path, out);
  for (int kind = 0; kind < 2; kind++)
    for (int i = 1; i < 3 && companions[kind][i] && ends_in(path, companions[kind][0]); i++) {
      char name[PATH_BYTES];
      snprintf(name, sizeof name, "%.*s%s", (int)(strlen(path) - strlen(companions[kind][0])), path, companions[kind][i]);
      take_and_remove(name, out);
    }
}

/* `what` is the file's name; an 'a' in front of it means text instead of binary, a 'c' compressed. */
static laves_result improve(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  char path[PATH_BYTES];
  laves_mesh *mesh = NULL, *improved = NULL;
  laves_improve_options options = laves_improve_options_default();
  laves_improve_report report = {0};
  options.min_dihedral = 40;
  options.max_dihedral = 125;
  laves_result result = laves_mesh_read(context, input_path(place, what, path), &mesh, &out->error);
  if (result == LAVES_OK) result = laves_improve(context, mesh, &options, &improved, &report, &out->error);
  if (improved) take_mesh(out, improved);
  take_number(out, (double)report.outside_after);
  laves_mesh_free(improved);
  laves_mesh_free(mesh);
  return result == LAVES_TARGET_MISSED ? LAVES_OK : result;
}

static laves_result write_mesh(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  char path[PATH_BYTES];
  laves_write_options options = laves_write_options_default();
  options.ascii = what[0] == 'a';
  options.compression = what[0] == 'c' ? 6 : 0;
  if (strstr(what, "22")) options.format = LAVES_FORMAT_GMSH22;
  laves_mesh *mesh = NULL;
  laves_result result = laves_mesh_read(context, input_path(place, "tagged.vtu", path), &mesh, &out->error);
  if (result == LAVES_OK) result = laves_mesh_write(context, mesh, output_path(place, what, path), &options, &out->error);
  if (result == LAVES_OK) take_written(path, out);
  laves_mesh_free(mesh);
  return result;
}

/* Reads the mesh of a cube, gives it nodes of second order for a larger one that shares three of its sides, and writes it. */
static laves_result curve(laves_context *context, const job_place *place, const char *what, job_outcome *out) {
  char path[PATH_BYTES];
  laves_mesh *mesh = NULL;
  laves_domain *domain = NULL;
  laves_curve_report report = {0};
  laves_result result = laves_mesh_read(context, input_path(place, "tagged.vtu", path), &mesh, &out->error);
  if (result == LAVES_OK) result = laves_domain_from_expression(context, "box(2, 2, 2)", &domain, &out->error);
  if (result == LAVES_OK) result = laves_mesh_curve(context, mesh, domain, NULL, &report, &out->error);
  if (result == LAVES_OK) result = laves_mesh_write(context, mesh, output_path(place, what, path), NULL, &out->error);
  if (result == LAVES_OK) take_written(path, out);
  take_number(out, (double)report.on_surface);
  take_number(out, report.least_jacobian);
  laves_domain_free(domain);
  laves_mesh_free(mesh);
  return result;
}

const job jobs[] = {
    {"read STL, text", read_domain, "cube_text.stl"},
    {"read STL, binary", read_domain, "cube.stl"},
    {"read OBJ", read_domain, "cube.obj"},
    {"read PLY, text", read_domain, "cube_text.ply"},
    {"read PLY, binary", read_domain, "cube.ply"},
    {"read OFF", read_domain, "cube.off"},
    {"read a Gmsh surface, 2.2", read_domain, "cube22.msh"},
    {"read a Gmsh surface, 4.1", read_domain, "cube.msh"},
    {"read a surface with a hole", read_domain, "open.off"},
    {"read a surface that crosses itself", read_domain, "crossing.off"},
    {"read a script", read_domain, "leaf.lua"},
    {"read an expression", make_expression,
     "tag('rod', cylinder{r=0.3, h=4}):rotate(30, 'x') + smooth_union(sphere(1), box(1), 0.2)"},
    {"read features", read_features, "lines"},
    {"read backgrounds", read_backgrounds, "size"},
    {"mesh by snapping", mesh_by_snap, "sphere(1) - sphere(0.5)"},
    {"mesh by stuffing", mesh_by_stuff, "sphere(1)"},
    {"mesh by grafting", mesh_by_graft, "gyroid{period=1, thickness=0.25} & sphere(0.5)"},
    {"mesh a script with a surface", mesh_by_default, "leaf.lua"},
    {"mesh an open surface", mesh_by_default, "open.off"},
    {"mesh a surface that crosses itself", mesh_by_default, "crossing.off"},
    {"mesh a thin plate", mesh_thin, "box(1.6, 1.6, 0.3)"},
    {"mesh a function", mesh_function, ""},
    {"mesh to a count", mesh_to_count, "box(1, 1.5, 2)"},
    {"mesh parts", mesh_parts, "parts.off"},
    {"mesh with drawn features", mesh_drawn, "box(1, 1, 1)"},
    {"mesh graded", mesh_graded, "cube.obj"},
    {"mesh streamed", mesh_streamed, "tag('a', sphere(1)) - sphere(0.8)"},
    {"mesh tiling", make_tiling, ""},
    {"improve", improve, "bad.inp"},
    {"improve with regions and tags", improve, "tagged.vtu"},
    {"estimate", estimate, "cube.obj"},
    {"find thin places", find_thin, "cube.obj"},
    {"check a mesh", check_mesh, ""},
    {"check a file", check_file, "cube.vtu"},
    {"check a file with triangles", check_file, "tagged.vtu"},
    {"check features", check_features, ""},
    {"certify", certify, "certificate.json"},
    {"read a certificate", read_certificate, "cube.json"},
    {"write VTU, text", write_mesh, "a.vtu"},
    {"write VTU, raw", write_mesh, "raw.vtu"},
    {"write VTU, compressed", write_mesh, "c.vtu"},
    {"write Gmsh 2.2, text", write_mesh, "a22.msh"},
    {"write Gmsh 2.2, binary", write_mesh, "22.msh"},
    {"write Gmsh 4.1, text", write_mesh, "a.msh"},
    {"write Gmsh 4.1, binary", write_mesh, "41.msh"},
    {"write Medit, text", write_mesh, "x.mesh"},
    {"write Medit, binary", write_mesh, "x.meshb"},
    {"write TetGen", write_mesh, "x.node"},
    {"write VTKHDF", write_mesh, "x.vtkhdf"},
    {"write legacy VTK, text", write_mesh, "a.vtk"},
    {"write legacy VTK, binary", write_mesh, "b.vtk"},
    {"write XDMF", write_mesh, "x.xdmf"},
    {"write Exodus", write_mesh, "x.exo"},
    {"write Abaqus", write_mesh, "x.inp"},
    {"write Nastran", write_mesh, "x.bdf"},
    {"write NumPy", write_mesh, "x.npz"},
    {"write STL, text", write_mesh, "a.stl"},
    {"write STL, binary", write_mesh, "b.stl"},
    {"write OBJ", write_mesh, "x.obj"},
    {"write PLY", write_mesh, "x.ply"},
    {"write OFF", write_mesh, "x.off"},
    {"curve and write VTU", curve, "x.vtu"},
    {"curve and write Gmsh", curve, "x.msh"},
    {"curve and write XDMF", curve, "x.xdmf"},
    {"curve and write Abaqus", curve, "x.inp"},
    {"curve and write Exodus", curve, "x.exo"},
    {"curve and write Nastran", curve, "x.bdf"},
    {"curve and write Medit", curve, "x.meshb"},
    {"read VTU, text", read_mesh, "tagged_text.vtu"},
    {"read VTU, compressed", read_mesh, "tagged.vtu"},
    {"read Gmsh 2.2", read_mesh, "tagged22.msh"},
    {"read Gmsh 4.1", read_mesh, "tagged.msh"},
    {"read Gmsh 4.1, text", read_mesh, "tagged_text.msh"},
    {"read Medit, text", read_mesh, "tagged.mesh"},
    {"read Medit, binary", read_mesh, "tagged.meshb"},
    {"read TetGen", read_mesh, "tagged.node"},
    {"read legacy VTK", read_mesh, "two.vtk"},
    {"read Abaqus", read_mesh, "bad.inp"},
};
const int job_count = sizeof jobs / sizeof *jobs;
