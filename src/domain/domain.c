/* Domains as callers see them: makers, facts, evaluation.
 *
 * A maker fills a zeroed domain; whatever fails, the handle stays NULL and nothing is kept. */
#include <string.h>

#include "base/sha256.h"
#include "domain/oracle.h"
#include "domain/surface_input.h"
#include "io/file.h"

static laves_domain *domain_create(laves_context *context) {
  laves__progress_reset(context);
  laves_domain *domain = laves__alloc_zeroed(context, 1, sizeof *domain);
  if (domain) domain->context = context;
  return domain;
}

/* Hands the domain over when all went well, frees it otherwise. */
static laves_result finish(laves_result result, laves_domain *made, laves_domain **domain) {
  if (result == LAVES_OK) {
    made->info.format = made->format;
    *domain = made;
  } else {
    laves_domain_free(made);
  }
  return result;
}

static bool ends_with_lua(const char *path) {
  const size_t length = strlen(path);
  return length > 4 && strcmp(path + length - 4, ".lua") == 0;
}

/* The folder of a path: all before its last slash ("" for a plain name), in a block of *length + 1 bytes. */
static char *folder_of(laves_context *context, const char *path, size_t *length) {
  const char *slash = strrchr(path, '/');
  *length = slash ? (size_t)(slash - path) + (slash == path) : 0;
  char *folder = laves__alloc(context, *length + 1, 1);
  if (!folder) return NULL;
  memcpy(folder, path, *length);
  folder[*length] = 0;
  return folder;
}

static laves_result build_script(laves_context *context, const char *path, const char *text, size_t length, laves_domain *made,
                                 laves_error *error) {
  size_t folder_length;
  char *folder = folder_of(context, path, &folder_length);
  if (!folder) return laves__fail_memory(context, error);
  const laves_result result =
      laves__implicit_build(context, text, length, false, path, folder_length ? folder : NULL, made, error);
  laves__free(context, folder, folder_length + 1, 1);
  return result;
}

/* Takes over the file's bytes, which are given back once they are read: what follows needs the memory. */
static laves_result build_surface(laves_context *context, const char *path, char *bytes, size_t length,
                                  const laves_surface_options *options, laves_domain *made, laves_error *error) {
  laves__surface_input input = {0};
  const laves_result result = laves__surface_parse(context, bytes, length, path, &input, error);
  laves__free(context, bytes, length + 1, 1);
  return result == LAVES_OK ? laves__surface_build(context, &input, options, made, error) : result;
}

/* A script's surfaces have the defaults. */
static laves_result check_for_script(const laves_surface_options *options, laves_error *error) {
  const laves_surface_options usual = laves_surface_options_default();
  if (!options || (options->winding == usual.winding && options->close_holes && options->overlap == usual.overlap))
    return LAVES_OK;
  return laves__fail(error, LAVES_ERROR_OPTION,
                     "how a surface is read as a solid can be told for a surface file only, not for a script");
}

laves_result laves_domain_from_file(laves_context *context, const char *path, laves_domain **domain, laves_error *error) {
  return laves_domain_from_file_with(context, path, NULL, domain, error);
}

laves_result laves_domain_from_file_with(laves_context *context, const char *path, const laves_surface_options *options,
                                         laves_domain **domain, laves_error *error) {
  *domain = NULL;
  laves_result result = options ? laves__surface_options_check(options, error) : LAVES_OK;
  if (result == LAVES_OK && ends_with_lua(path)) result = check_for_script(options, error);
  if (result != LAVES_OK) return result;
  laves_domain *made = domain_create(context);
  if (!made) return laves__fail_memory(context, error);
  char *bytes = NULL;
  size_t length = 0;
  result = laves__input_read(context, path, &bytes, &length, error);
  if (result == LAVES_OK) {
    if (!laves__sha256_of(context, bytes, length, made->input_hash))
      result = laves__fail_cancelled(error);
    else if (ends_with_lua(path))
      result = build_script(context, path, bytes, length, made, error);
    else {
      result = build_surface(context, path, bytes, length, options, made, error);
      bytes = NULL;
    }
    laves__free(context, bytes, length + 1, 1);
  }
  return finish(result, made, domain);
}

laves_result laves_domain_from_expression(laves_context *context, const char *text, laves_domain **domain, laves_error *error) {
  *domain = NULL;
  laves_domain *made = domain_create(context);
  if (!made) return laves__fail_memory(context, error);
  const laves_result result = laves__sha256_of(context, text, strlen(text), made->input_hash)
                                  ? laves__implicit_build(context, text, strlen(text), true, "expression", NULL, made, error)
                                  : laves__fail_cancelled(error);
  return finish(result, made, domain);
}

/* Checked copies of the caller's arrays. */
static laves_result copy_triangles(laves_context *context, const double *points, size_t point_count, const uint32_t *triangles,
                                   size_t triangle_count, const int32_t *tags, laves__surface_input *input, laves_error *error) {
  for (size_t i = 0; i < 3 * point_count; i++)
    if (!isfinite(points[i])) return laves__fail(error, LAVES_ERROR_INPUT, "point %zu is not finite", i / 3);
  for (size_t i = 0; i < 3 * triangle_count; i++)
    if (triangles[i] >= point_count)
      return laves__fail(error, LAVES_ERROR_INPUT, "face %zu uses vertex %lu of %zu", i / 3, (unsigned long)triangles[i],
                         point_count);
  input->points = laves__alloc(context, point_count, sizeof *input->points);
  if (input->points) input->point_count = input->point_capacity = point_count;
  input->triangles = laves__alloc(context, triangle_count, sizeof *input->triangles);
  if (tags && input->triangles) input->tags = laves__alloc(context, triangle_count, sizeof *input->tags);
  if (input->triangles) input->triangle_count = input->triangle_capacity = triangle_count;
  if (!input->points || !input->triangles || (tags && !input->tags)) return laves__fail_memory(context, error);
  if (point_count) memcpy(input->points, points, point_count * sizeof *input->points);
  if (triangle_count) memcpy(input->triangles, triangles, triangle_count * sizeof *input->triangles);
  if (tags) memcpy(input->tags, tags, triangle_count * sizeof *tags);
  memcpy(input->format, "triangles", sizeof "triangles");
  return LAVES_OK;
}

laves_result laves_domain_from_triangles(laves_context *context, const double *points, size_t point_count,
                                         const uint32_t *triangles, size_t triangle_count, const int32_t *tags,
                                         laves_domain **domain, laves_error *error) {
  return laves_domain_from_triangles_with(context, points, point_count, triangles, triangle_count, tags, NULL, domain, error);
}

laves_result laves_domain_from_triangles_with(laves_context *context, const double *points, size_t point_count,
                                              const uint32_t *triangles, size_t triangle_count, const int32_t *tags,
                                              const laves_surface_options *options, laves_domain **domain, laves_error *error) {
  *domain = NULL;
  laves_domain *made = domain_create(context);
  if (!made) return laves__fail_memory(context, error);
  laves__surface_input input = {0};
  laves_result result = copy_triangles(context, points, point_count, triangles, triangle_count, tags, &input, error);
  if (result == LAVES_OK)
    result = laves__surface_build(context, &input, options, made, error);
  else
    laves__surface_input_free(context, &input);
  return finish(result, made, domain);
}

laves_result laves_domain_from_function(laves_context *context, const laves_function *function, laves_domain **domain,
                                        laves_error *error) {
  *domain = NULL;
  laves_domain *made = domain_create(context);
  if (!made) return laves__fail_memory(context, error);
  return finish(laves__function_build(context, function, made, error), made, domain);
}

void laves__project_many(const laves__oracle *oracle, size_t count, const laves__vec3 *points, double reach,
                         laves__projection *answers) {
  if (oracle->project_many) {
    oracle->project_many(oracle->self, count, points, reach, answers);
    return;
  }
  for (size_t i = 0; i < count; i++) {
    laves__projection *a = &answers[i];
    a->found = oracle->project(oracle->self, points[i], reach, &a->hint, &a->foot, &a->normal);
  }
}

static void free_names(laves_context *context, char **names, int count) {
  if (!names) return;
  for (int i = 0; i < count; i++)
    if (names[i]) laves__free(context, names[i], strlen(names[i]) + 1, 1);
  laves__free(context, names, (size_t)count, sizeof *names);
}

void laves_domain_free(laves_domain *domain) {
  if (!domain) return;
  laves_context *context = domain->context;
  if (domain->oracle.free) domain->oracle.free(context, domain->oracle.self);
  free_names(context, domain->tag_names, domain->info.tag_count);
  free_names(context, domain->region_names, domain->region_count);
  laves__free(context, domain, 1, sizeof *domain);
}

void laves_domain_evaluate(const laves_domain *domain, const double *points, size_t count, double *values) {
  enum { BATCH = 256 };
  laves__vec3 local[BATCH];
  for (size_t begin = 0; begin < count; begin += BATCH) {
    const size_t size = count - begin < BATCH ? count - begin : BATCH;
    for (size_t i = 0; i < size; i++) {
      const double *p = points + 3 * (begin + i);
      local[i] = v3_sub(v3(p[0], p[1], p[2]), domain->oracle.origin);
    }
    domain->oracle.evaluate(domain->oracle.self, size, local, values + begin, NULL);
  }
}

const char *laves_defect_text(laves_defect defect) {
  static const char *const texts[] = {
#define LAVES_DEFECT_TEXT(name, text) text,
      LAVES_DEFECT_LIST(LAVES_DEFECT_TEXT)
#undef LAVES_DEFECT_TEXT
  };
  return (size_t)defect < LAVES__COUNT_OF(texts) ? texts[defect] : "unknown defect";
}

void laves_domain_get_info(const laves_domain *domain, laves_domain_info *info) { *info = domain->info; }

const char *laves_domain_tag_name(const laves_domain *domain, int index) {
  return index >= 0 && index < domain->info.tag_count && domain->tag_names ? domain->tag_names[index] : NULL;
}

static size_t places_of_kind(const laves_domain *domain, laves_thin_kind kind, laves_thin_place *places, size_t capacity) {
  const laves__oracle *oracle = &domain->oracle;
  if (capacity > 0) places[0] = (laves_thin_place){.thickness = INFINITY, .kind = kind}; /* when none is found */
  if (!oracle->thin_places) return 0;
  const size_t count = oracle->thin_places(oracle->self, kind, places, capacity);
  for (size_t i = 0; i < count; i++) {
    places[i].place[0] += oracle->origin.x;
    places[i].place[1] += oracle->origin.y;
    places[i].place[2] += oracle->origin.z;
  }
  return count;
}

size_t laves_domain_thin_places(const laves_domain *domain, laves_thin_place *places, size_t capacity) {
  return places_of_kind(domain, LAVES_THIN_WALL, places, capacity);
}

size_t laves_domain_gap_places(const laves_domain *domain, laves_thin_place *places, size_t capacity) {
  return places_of_kind(domain, LAVES_THIN_GAP, places, capacity);
}
