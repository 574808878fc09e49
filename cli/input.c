/* INPUT on the command line: a surface file, a Lua script, or an expression.
 *
 * A name that exists is a file. One that does not, but looks like a path, is a mistake that deserves to be called by its
 * name; anything else is an expression. */
#include "input.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

#include "text.h"

/* Only an expression has one of these; a slash alone may also divide. */
static bool has_operators(const char *words) { return strpbrk(words, "(){}=*+<>^ \n\t") != NULL; }

static bool ends_like_file(const char *words) {
  const size_t length = strlen(words);
  if (length > 4 && strcmp(words + length - 4, ".lua") == 0) return true;
  return laves_format_from_path(words) != LAVES_FORMAT_COUNT;
}

static bool looks_like_path(const char *words) { return ends_like_file(words) || (strchr(words, '/') && !has_operators(words)); }

/* A bare word such as "bunny" is more likely a misspelt file name than an expression. */
static bool is_bare_word(const char *words) {
  for (; *words; ++words) {
    if (!isalnum((unsigned char)*words) && !strchr("_-.", *words)) return false;
  }
  return true;
}

static laves_result open_expression(session *run, const char *words, input *in) {
  const laves_result result = laves_domain_from_expression(run->context, words, &in->domain, &run->error);
  if (result != LAVES_ERROR_INPUT || !is_bare_word(words)) return result;
  const char *extension = strrchr(words, '.');
  if (extension && isalpha((unsigned char)extension[1]))
    return session_fail(run, result, "the file '%.300s' does not exist", words);
  char reason[sizeof run->error.text];
  memcpy(reason, run->error.text, sizeof reason);
  return session_fail(run, result, "there is no file '%.150s', and it is no expression either: %.300s", words, reason);
}

static laves_surface_options surface_options(const settings *given, laves_defects *defects) {
  laves_surface_options options = laves_surface_options_default();
  options.winding = given->winding;
  options.close_holes = given->close_holes;
  options.overlap = given->unite ? LAVES_OVERLAP_UNION : given->nested ? LAVES_OVERLAP_NESTED : LAVES_OVERLAP_DIRECTION;
  options.defects = defects;
  return options;
}

/* A report shows them. */
static bool wants_defects(const settings *given) { return given->report || strcmp(given->command, "report") == 0; }

/* What was found is written whether the surface is taken or refused. */
static laves_result open_file(session *run, const char *path, input *in) {
  const settings *given = run->given;
  laves_defects *defects = NULL;
  laves_result result = LAVES_OK;
  if (given->defects || wants_defects(given)) result = laves_defects_create(run->context, &defects, &run->error);
  if (result != LAVES_OK) return result;
  const laves_surface_options options = surface_options(given, defects);
  result = laves_domain_from_file_with(run->context, path, &options, &in->domain, &run->error);
  if (given->defects && (result == LAVES_OK || result == LAVES_ERROR_INPUT)) {
    laves_error error = {0};
    const laves_result written = laves_defects_write(run->context, defects, given->defects, &error);
    in->defect_places = laves_defects_count(defects);
    if (written == LAVES_OK && session_speaks(run)) {
      text_buffer places;
      progress_clear(&run->bar);
      text_say("wrote %s (%s of defects)", given->defects, text_plural(&places, in->defect_places, "place"));
    }
    if (written != LAVES_OK && result == LAVES_OK)
      result = session_fail(run, written, "%s", error.text);
    else if (written != LAVES_OK)
      text_warning("%s", error.text); /* the refusal itself comes last */
  }
  in->defects = defects;
  return result;
}

void input_close(input *in) {
  laves_domain_free(in->domain);
  laves_defects_free(in->defects);
  in->domain = NULL;
  in->defects = NULL;
}

/* An expression is no surface, and what is said about surfaces would be without effect. */
static bool tells_of_surfaces(const settings *given) {
  const laves_surface_options usual = laves_surface_options_default();
  return given->winding != usual.winding || !given->close_holes || given->unite || given->nested || given->defects;
}

laves_result input_open(session *run, const char *words, input *in) {
  *in = (input){.text = words};
  const double start = progress_now();
  struct stat status;
  laves_result result;
  if (stat(words, &status) == 0) {
    if (S_ISDIR(status.st_mode)) return session_fail(run, LAVES_ERROR_INPUT, "'%.200s' is a folder; name a file in it", words);
    result = open_file(run, words, in);
  } else if (looks_like_path(words)) {
    return session_fail(run, LAVES_ERROR_INPUT, "the file '%.200s' does not exist", words);
  } else if (tells_of_surfaces(run->given)) {
    return session_fail(run, LAVES_ERROR_OPTION,
                        "--winding, --close-holes, --union, --nested and --defects are about surface files; '%.200s' is an "
                        "expression",
                        words);
  } else {
    result = open_expression(run, words, in);
  }
  result = session_settle(run, result);
  if (result == LAVES_OK) laves_domain_get_info(in->domain, &in->info);
  in->seconds = progress_now() - start;
  return result;
}

static const char *format_extension(laves_format format) {
  switch (format) {
    case LAVES_FORMAT_AUTO:
      return "vtu";
    case LAVES_FORMAT_GMSH22:
    case LAVES_FORMAT_GMSH41:
      return "msh";
    case LAVES_FORMAT_MEDIT:
      return "mesh";
    case LAVES_FORMAT_TETGEN:
      return "ele";
    case LAVES_FORMAT_EXODUS:
      return "exo";
    case LAVES_FORMAT_ABAQUS:
      return "inp";
    case LAVES_FORMAT_NASTRAN:
      return "bdf";
    case LAVES_FORMAT_DMTET:
      return "npz";
    default:
      return laves_format_name(format);
  }
}

void input_default_output(const char *words, laves_format format, char *path, size_t size) {
  struct stat status;
  const bool is_file = stat(words, &status) == 0;
  const char *base = is_file ? text_base_name(words) : "mesh";
  const char *dot = strrchr(base, '.');
  const int length = dot && dot != base ? (int)(dot - base) : (int)strlen(base);
  snprintf(path, size, "%.*s.%s", length, base, format_extension(format));
}

double input_diagonal(const laves_domain_info *info) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += (info->upper[i] - info->lower[i]) * (info->upper[i] - info->lower[i]);
  return sqrt(sum);
}

static const char *const overlap_names[] = {"direction", "union", "nested"};
static const char *const kind_names[] = {"surface", "implicit", "function"};

/* "open_edge" and the like: the names of the enum in small letters. */
static const char *defect_key(laves_defect defect, char *key, size_t size) {
  static const char *const names[] = {
#define DEFECT_NAME(name, text) #name,
      LAVES_DEFECT_LIST(DEFECT_NAME)
#undef DEFECT_NAME
  };
  size_t i = 0;
  for (; names[defect][i] && i + 1 < size; ++i) key[i] = (char)tolower((unsigned char)names[defect][i]);
  key[i] = '\0';
  return key;
}

static void write_defects(json *out, const laves_domain_info *info) {
  json_open_object(out, "defects");
  for (int i = 0; i < LAVES_DEFECT_COUNT; ++i) {
    if (info->defects[i] == 0) continue;
    char key[40];
    json_open_object(out, defect_key((laves_defect)i, key, sizeof key));
    json_integer(out, "count", (int64_t)info->defects[i]);
    json_numbers(out, "place", info->defect_place[i], 3);
    json_close(out);
  }
  json_close(out);
}

void input_write_json(json *out, const char *key, const input *in) {
  const laves_domain_info *info = &in->info;
  json_open_object(out, key);
  json_text(out, "name", in->text);
  if (in->domain && info->format) {
    json_text(out, "kind", kind_names[info->kind]);
    json_text(out, "format", info->format);
    json_numbers(out, "lower", info->lower, 3);
    json_numbers(out, "upper", info->upper, 3);
    json_number(out, "diagonal", input_diagonal(info));
    json_number(out, "volume", info->volume);
    json_number(out, "area", info->area);
  }
  if (in->domain && info->format && info->kind == LAVES_DOMAIN_SURFACE) {
    json_integer(out, "points", (int64_t)info->point_count);
    json_integer(out, "triangles", (int64_t)info->triangle_count);
    json_integer(out, "components", (int64_t)info->component_count);
    json_number(out, "genus", info->topology_known ? (double)info->genus : NAN);
    json_boolean(out, "closed", info->closed);
    json_boolean(out, "turned", info->turned);
    json_boolean(out, "winding", info->winding);
    json_number(out, "winding_level", info->winding_level);
    json_text(out, "overlap", overlap_names[info->overlap]);
    json_integer(out, "open_edges_left", (int64_t)info->open_edges_left);
    json_integer(out, "crossing_parts", (int64_t)info->crossing_parts);
    json_integer(out, "nested_parts", (int64_t)info->nested_parts);
    json_integer(out, "hollow_parts", (int64_t)info->hollow_parts);
    write_defects(out, info);
  }
  if (in->domain && info->format && (info->kind == LAVES_DOMAIN_SURFACE || info->tag_count > 0)) {
    json_open_array(out, "tags");
    for (int i = 0; i < info->tag_count; ++i) json_text(out, NULL, laves_domain_tag_name(in->domain, i));
    json_close(out);
  }
  json_close(out);
}
