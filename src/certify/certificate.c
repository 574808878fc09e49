/* The certificate: what a mesh is, stated from its final arrays alone.
 *
 *   hash -> check (counts, validity, topology, quality, distances) -> tiles by their shape -> window -> features -> exceptions
 *
 * Nothing is taken over from the stages that made the mesh but what cannot be recomputed: which options were asked, which window
 * is promised for them, and how many vertices were made how. Whether the promise holds is found here.
 *
 * The attained window contains every angle of the mesh, not only the computed values: it is widened by a bound of their error.
 * With q the least volume-length ratio and u half a unit of rounding, an angle t of a tet has: area vectors of faces known to
 * 8 u |e| |f| with |e| |f| / |e x f| <= 21 / q, so cos t to 700 u / q; sin t = 3/2 V l / (A B) >= 0.028 q^2; so t to 25000 u /
 * q^3, which is 1.6e-10 / q^3 degrees. The margin is more than twice that. */
#include <stdio.h>
#include <string.h>

#include "base/sha256.h"
#include "base/utf8.h"
#include "certify/check_features.h"
#include "io/file.h"

static const uint32_t certify_cookie = 0x63657274;

/* Degrees times the cube of the least volume-length ratio; see above. */
#define MARGIN_FACTOR 4e-10
/* Share of the mean edge from which on a boundary vertex counts as off the surface: far above what Newton's steps leave. */
#define OFF_SURFACE_SHARE 1e-3
/* Share of the mean edge from which on places count as distant: below it lies what flat triangles on a curved surface make. */
#define DISTANT_SHARE 0.3
/* One tet in so many must be an exact tile for the tiles to tell the size. */
#define TILES_TELLING 8

laves_certify_options laves_certify_options_default(void) {
  const laves_options asked = laves_options_default();
  return (laves_certify_options){.distances = true,
                                 .promised_max_dihedral = 180,
                                 .min_dihedral = asked.min_dihedral,
                                 .max_dihedral = asked.max_dihedral,
                                 .volume_length = asked.volume_length,
                                 .cookie = certify_cookie};
}

/* ---- what was asked ---- */

static void copy_text(char *to, size_t capacity, const char *from) { snprintf(to, capacity, "%s", from); }

/* The base name of a file, or an expression as far as there is room for it; cut between characters of UTF-8. */
static void name_input(laves_certificate *c, const char *input, bool is_file) {
  const char *slash = is_file ? strrchr(input, '/') : NULL;
  copy_text(c->input_name, sizeof c->input_name, slash ? slash + 1 : input);
  size_t end = strlen(c->input_name);
  if (end + 1 < sizeof c->input_name) return;
  while (end > 0 && (c->input_name[end - 1] & 0xc0) == 0x80) end--;
  if (end > 0 && (c->input_name[end - 1] & 0x80)) end--;
  c->input_name[end] = 0;
}

/* Expressions have the format of that name; everything else came from a file. A domain knows the hash of what it was read from:
 * the file may have changed since, and a pipe cannot be read again. */
static laves_result describe_input(laves_context *context, const laves_certify_options *options, laves_certificate *c,
                                   laves_error *error) {
  static const char *const kinds[] = {"surface", "implicit", "function"};
  const laves_domain *domain = options->domain;
  if (!domain) return LAVES_OK;
  c->has_input = true;
  copy_text(c->input_kind, sizeof c->input_kind, kinds[domain->info.kind]);
  copy_text(c->input_format, sizeof c->input_format, domain->info.format ? domain->info.format : "");
  if (!options->input) return LAVES_OK;
  const bool is_file = strstr(c->input_format, "expression") == NULL;
  name_input(c, options->input, is_file);
  if (domain->input_hash[0]) {
    copy_text(c->input_hash, sizeof c->input_hash, domain->input_hash);
    return LAVES_OK;
  }
  char *bytes;
  size_t length;
  const laves_result result = laves__file_read(context, options->input, &bytes, &length, error);
  if (result != LAVES_OK) return result;
  const bool hashed = laves__sha256_of(context, bytes, length, c->input_hash);
  laves__free(context, bytes, length + 1, 1);
  return hashed ? LAVES_OK : laves__fail_cancelled(error);
}

/* A command is there whole or not at all: a part of it would make another mesh. */
static void note_command(const laves_certify_options *options, laves_certificate *c) {
  size_t used = 0;
  if (!options->command || options->command_count > LAVES_COMMAND_WORDS) return;
  for (int i = 0; i < options->command_count; i++) {
    const size_t bytes = strlen(options->command[i]) + 1;
    if (bytes > sizeof c->command - used || !laves__is_utf8(options->command[i])) {
      memset(c->command, 0, sizeof c->command);
      return;
    }
    memcpy(c->command + used, options->command[i], bytes);
    used += bytes;
  }
  c->command_count = options->command_count > 0 ? options->command_count : 0;
}

static void note_making(const laves_certify_options *options, laves_certificate *c) {
  const laves_report *report = options->report;
  c->asked_min_dihedral = options->options ? options->options->min_dihedral : options->min_dihedral;
  c->asked_max_dihedral = options->options ? options->options->max_dihedral : options->max_dihedral;
  c->asked_volume_length = options->options ? options->options->volume_length : options->volume_length;
  c->promised_min_dihedral = report ? report->promised_min_dihedral : options->promised_min_dihedral;
  c->promised_max_dihedral = report ? report->promised_max_dihedral : options->promised_max_dihedral;
  c->has_promise = c->promised_max_dihedral > 0 && (c->promised_min_dihedral > 0 || c->promised_max_dihedral < 180);
  if (!c->has_promise) c->promised_min_dihedral = 0, c->promised_max_dihedral = 180;
  if (!options->options || !report) return;
  c->has_options = true;
  c->options = *options->options;
  c->size = report->size;
  c->stuffed_vertices = report->stuffed_vertices;
  c->relaxed_vertices = report->relaxed_vertices;
  c->relaxed_max = report->relaxed_max;
  c->pinches = report->pinches;
  if (isnan(c->check.domain_volume) && report->volume > 0) c->check.domain_volume = report->volume;
}

/* ---- what is there ---- */

static void find_window(laves_certificate *c) {
  const laves_check *check = &c->check;
  const double q = fmax(0, check->volume_length.min);
  c->angle_margin = fmin(180, MARGIN_FACTOR / (q * q * q));
  if (!isfinite(check->volume_length.min) || check->min_dihedral_tet < 0) c->angle_margin = 180;
  c->attained_min_dihedral = fmax(0, check->min_dihedral.min - c->angle_margin);
  c->attained_max_dihedral = fmin(180, check->max_dihedral.max + c->angle_margin);
}

static void explain_distances(laves_certificate *c) {
  const laves_check *check = &c->check;
  if (!check->has_distance) return;
  if (isnan(check->to_surface_at_most))
    copy_text(c->to_surface_reason, sizeof c->to_surface_reason,
              "at some samples it was not seen that the surface passes where iteration found it");
  if (isnan(check->from_surface_at_most))
    copy_text(c->from_surface_reason, sizeof c->from_surface_reason,
              "the surface is no clean set of flat faces, so what lies between its samples is not known");
  c->distance_asked = DISTANT_SHARE * check->edge_mean;
  c->off_surface_asked = OFF_SURFACE_SHARE * check->edge_mean;
}

/* ---- features ---- */

typedef struct feature_part {
  laves__features features;
  laves__feature_findings findings;
} feature_part;

/* The size that a mesh was made with, where its tiles tell; 0: they do not. What is found of a surface depends on it a little. */
static double size_by_tiles(const laves_certificate *c) {
  return c->lattice_tets >= c->check.tets / TILES_TELLING ? c->lattice_size : 0;
}

static laves_feature_options asked_features(const laves_certify_options *options, const laves_certificate *c) {
  laves_feature_options asked = laves_feature_options_default();
  const laves_options *making = options->options;
  asked.angle = making ? making->feature_angle : options->feature_angle;
  asked.tags = making ? making->feature_tags : options->feature_tags;
  asked.features = making ? making->features : NULL;
  asked.size = making && options->report ? options->report->feature_size : options->feature_size;
  if (!(asked.size > 0)) asked.size = size_by_tiles(c);
  return asked;
}

/* Only where the domain has features; else nothing is said of them. *part: to be freed whatever is returned. */
static laves_result measure_features(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                     const laves_certify_options *options, laves_certificate *c, feature_part *part,
                                     laves_error *error) {
  const laves_feature_options asked = asked_features(options, c);
  if (!options->domain || !options->distances || boundary->count == 0) return LAVES_OK;
  if (!(asked.angle > 0) && !asked.tags && !asked.features) return LAVES_OK;
  laves_result result = laves__check_feature_options(&asked, error);
  if (result == LAVES_OK)
    result = laves__find_features_for(context, mesh, boundary, &options->domain->oracle, &asked, &part->features, error);
  if (result != LAVES_OK || part->features.crease_count + part->features.corner_count == 0) return result;
  result = laves__check_features_of(context, mesh, boundary, &part->features, &asked, &c->features, &part->findings, error);
  c->has_features = result == LAVES_OK;
  c->features_tags = asked.tags;
  c->features_drawn = asked.features != NULL;
  return result;
}

static void free_features(feature_part *part) {
  laves__feature_findings_free(&part->findings);
  laves__features_free(&part->features);
}

/* ---- all ---- */

laves_result laves_certify(laves_context *context, const laves_mesh *mesh, const laves_certify_options *options,
                           laves_certificate *certificate, laves_error *error) {
  const laves_result held = laves__mesh_require_arrays(mesh, "a certificate", error);
  if (held != LAVES_OK) return held;
  const laves_certify_options defaults = laves_certify_options_default();
  if (!options) options = &defaults;
  if (options->cookie != certify_cookie)
    return laves__fail(error, LAVES_ERROR_OPTION, "the options do not come from laves_certify_options_default()");
  laves__progress_reset(context);
  laves_certificate *c = certificate;
  laves__survey survey;
  feature_part part = {0};
  memset(c, 0, sizeof *c);
  copy_text(c->version, sizeof c->version, laves_version());
  const laves_domain *domain = options->domain;
  laves_result result = laves__survey_mesh(context, mesh, options->distances ? domain : NULL, &c->check, &survey, error);
  if (result != LAVES_OK) return result;
  result = describe_input(context, options, c, error);
  if (result == LAVES_OK) result = laves__mesh_digest(context, mesh, c->mesh_hash, error);
  if (result == LAVES_OK) result = laves__find_tiles(context, mesh, c, error);
  note_making(options, c);
  note_command(options, c);
  find_window(c);
  explain_distances(c);
  if (result == LAVES_OK) result = measure_features(context, mesh, &survey.boundary, options, c, &part, error);
  if (result == LAVES_OK)
    result = laves__list_exceptions(context, mesh, domain, &survey, c->has_features ? &part.findings : NULL, c, error);
  free_features(&part);
  laves__survey_free(&survey);
  return result;
}
