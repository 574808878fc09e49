/* Sizes that vary, from the command line.
 *
 * In: --size-field TEXT|FILE and --refine PLACE=SIZE[,RADIUS].  Out: the library's list of sources.
 *
 * A field that names a file is a script or a background; a background may be followed by a colon and the name of the array to
 * take. A place is tag:NAME, point:X,Y,Z or curve:FILE. The last = of a refinement ends its place, so names may hold others. */
#include "sizing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Devices and pipes are left to the library, which says what it takes. */
static bool is_file(const char *path) {
  struct stat status;
  return stat(path, &status) == 0 && !S_ISDIR(status.st_mode);
}

static bool ends_with(const char *text, const char *ending) {
  const size_t length = strlen(text), tail = strlen(ending);
  return length > tail && strcmp(text + length - tail, ending) == 0;
}

/* ---- --size-field ---- */

static bool looks_like_file(const char *text) {
  static const char *const endings[] = {".lua", ".vtu", ".msh", ".pos", ".nrrd", ".nhdr"};
  for (size_t i = 0; i < sizeof endings / sizeof endings[0]; ++i) {
    if (ends_with(text, endings[i])) return true;
  }
  return false;
}

/* FILE:ARRAY, where FILE exists. */
static laves_result add_array(session *run, laves_sizing *sizing, const char *text, bool *is_array) {
  const char *colon = strrchr(text, ':');
  char path[4096];
  *is_array = colon && colon > text && (size_t)(colon - text) < sizeof path;
  if (!*is_array) return LAVES_OK;
  memcpy(path, text, (size_t)(colon - text));
  path[colon - text] = '\0';
  *is_array = is_file(path);
  return *is_array ? laves_sizing_add_background(sizing, path, colon + 1, &run->error) : LAVES_OK;
}

static laves_result add_field(session *run, laves_sizing *sizing, const char *text) {
  bool is_array;
  if (is_file(text)) {
    return ends_with(text, ".lua") ? laves_sizing_add_script(sizing, text, &run->error)
                                   : laves_sizing_add_background(sizing, text, NULL, &run->error);
  }
  const laves_result result = add_array(run, sizing, text, &is_array);
  if (is_array) return result;
  if (looks_like_file(text)) return session_fail(run, LAVES_ERROR_INPUT, "the file '%.200s' does not exist", text);
  return laves_sizing_add_expression(sizing, text, &run->error);
}

/* ---- --refine ---- */

typedef struct refinement {
  char place[1024]; /* behind the colon */
  double size, radius;
} refinement;

static const char refine_form[] =
    "option '--refine' needs PLACE=SIZE[,RADIUS], where PLACE is tag:NAME, point:X,Y,Z or curve:FILE, not '%.100s'";

/* One number and what follows it, behind spaces and a comma. */
static bool take_number(const char **text, double *value) {
  char *end;
  *value = strtod(*text, &end);
  if (end == *text || !isfinite(*value)) return false;
  end += strspn(end, " \t\r");
  if (*end == ',') ++end;
  *text = end + strspn(end, " \t\r");
  return true;
}

static bool take_three(const char *text, double point[3]) {
  for (int i = 0; i < 3; ++i) {
    if (!take_number(&text, &point[i])) return false;
  }
  return *text == '\0';
}

/* Parts PLACE=SIZE[,RADIUS]; *kind_length: of the word before the colon. */
static bool parse_refinement(const char *text, refinement *r) {
  const char *colon = strchr(text, ':'), *equals = strrchr(text, '=');
  if (!colon || !equals || equals <= colon + 1 || (size_t)(equals - colon) > sizeof r->place) return false;
  memcpy(r->place, colon + 1, (size_t)(equals - colon - 1));
  r->place[equals - colon - 1] = '\0';
  const char *numbers = equals + 1;
  r->radius = 0;
  if (!take_number(&numbers, &r->size)) return false;
  return (*numbers == '\0' || take_number(&numbers, &r->radius)) && *numbers == '\0';
}

static laves_result add_refinement(session *run, laves_sizing *sizing, const char *text) {
  refinement r;
  double point[3];
  if (!parse_refinement(text, &r)) return session_fail(run, LAVES_ERROR_OPTION, refine_form, text);
  if (strncmp(text, "tag:", 4) == 0) return laves_sizing_add_tag(sizing, r.place, r.size, r.radius, &run->error);
  if (strncmp(text, "curve:", 6) == 0) return laves_sizing_add_curve_file(sizing, r.place, r.size, r.radius, &run->error);
  if (strncmp(text, "point:", 6) == 0 && take_three(r.place, point))
    return laves_sizing_add_points(sizing, point, 1, r.size, r.radius, &run->error);
  return session_fail(run, LAVES_ERROR_OPTION, refine_form, text);
}

/* ---- all ---- */

laves_result sizing_open(session *run, laves_sizing **sizing) {
  const settings *given = run->given;
  *sizing = NULL;
  if (given->size_fields.count == 0 && given->refinements.count == 0) return LAVES_OK;
  laves_result result = laves_sizing_create(run->context, sizing, &run->error);
  for (int i = 0; result == LAVES_OK && i < given->size_fields.count; ++i)
    result = add_field(run, *sizing, given->size_fields.items[i]);
  for (int i = 0; result == LAVES_OK && i < given->refinements.count; ++i)
    result = add_refinement(run, *sizing, given->refinements.items[i]);
  return session_settle(run, result);
}

static double diagonal_of(const laves_domain_info *info) {
  double square = 0;
  for (int i = 0; i < 3; ++i) square += (info->upper[i] - info->lower[i]) * (info->upper[i] - info->lower[i]);
  return sqrt(square);
}

void sizing_options(const settings *given, const laves_sizing *sizing, const laves_domain_info *info, laves_options *options) {
  options->sizing = sizing;
  options->grading = given->grading;
  options->min_size = given->min_size;
  options->max_size = given->max_size;
  options->curvature_elements = given->curvature_elements;
  options->thickness_elements = given->thickness_elements;
  options->feature_elements = given->feature_elements;
  options->max_distance = given->max_distance > 0 ? given->max_distance : given->relative_distance * diagonal_of(info);
  options->interior_growth = given->interior_growth;
}

bool sizing_is_asked(const settings *given) {
  return given->size_fields.count > 0 || given->refinements.count > 0 || given->curvature_elements > 0 ||
         given->thickness_elements > 0 || given->feature_elements > 0 || given->max_distance > 0 ||
         given->relative_distance > 0 || given->interior_growth > 0;
}

static void write_texts(json *out, const char *key, const option_texts *list) {
  if (list->count == 0) return;
  json_open_array(out, key);
  for (int i = 0; i < list->count; ++i) json_text(out, NULL, list->items[i]);
  json_close(out);
}

void sizing_write_json(json *out, const settings *given) {
  const struct {
    const char *key;
    double value;
  } numbers[] = {
      {"min_size", given->min_size},
      {"max_size", given->max_size},
      {"curvature_elements", given->curvature_elements},
      {"thickness_elements", given->thickness_elements},
      {"feature_elements", given->feature_elements},
      {"max_distance", given->max_distance},
      {"relative_distance", given->relative_distance},
      {"interior_growth", given->interior_growth},
  };
  json_open_object(out, "sizing");
  json_number(out, "grading", given->grading);
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; ++i) {
    if (numbers[i].value > 0) json_number(out, numbers[i].key, numbers[i].value);
  }
  write_texts(out, "fields", &given->size_fields);
  write_texts(out, "refinements", &given->refinements);
  json_close(out);
}
