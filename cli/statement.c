/* The statement on a mesh in words and in the JSON of a run. */
#include "statement.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "text.h"

static void say_distance(const char *way, double max, double at_most, double mean, const double place[3], double edge) {
  text_buffer where;
  char bound[60] = "";
  if (isfinite(at_most)) snprintf(bound, sizeof bound, ", surely below %.4g", at_most);
  text_say("  %s: max %.4g (%.3f edges) at %s%s, mean %.4g", way, max, max / edge, text_place(&where, place), bound, mean);
}

static void say_distances(const laves_check *check) {
  say_distance("mesh to surface", check->to_surface_max, check->to_surface_at_most, check->to_surface_mean,
               check->to_surface_place, check->edge_mean);
  say_distance("surface to mesh", check->from_surface_max, check->from_surface_at_most, check->from_surface_mean,
               check->from_surface_place, check->edge_mean);
  if (!isnan(check->domain_volume))
    text_say("  volume of the surface %.9g, of the mesh %+.3f %%", check->domain_volume,
             100 * (check->volume / check->domain_volume - 1));
}

/* "2 thin, 1 crease" over the listed ones. */
static const char *causes_of(const laves_certificate *c, laves_exception_kind kind, char *text, size_t size) {
  text[0] = '\0';
  for (int cause = 1; cause < LAVES_CAUSE_COUNT; ++cause) {
    int count = 0;
    for (size_t i = 0; i < c->exception_count; ++i) {
      count += c->exceptions[i].kind == kind && (int)c->exceptions[i].cause == cause;
    }
    const size_t used = strlen(text);
    if (count) snprintf(text + used, size - used, "%s%d %s", used ? ", " : " (", count, laves_cause_key((laves_cause)cause));
  }
  const size_t used = strlen(text);
  const bool all = c->exception_counts[kind] <= LAVES_PLACE_CAPACITY;
  if (used) snprintf(text + used, size - used, "%s", all ? ")" : " among the worst)");
  return text;
}

static bool is_of_features(int kind) { return kind == LAVES_EXCEPTION_CREASE_LOST || kind == LAVES_EXCEPTION_CORNER_LOST; }

/* The first of a kind that is listed, or NULL. */
static const laves_exception *first_of(const laves_certificate *c, laves_exception_kind kind) {
  for (size_t i = 0; i < c->exception_count; ++i) {
    if (c->exceptions[i].kind == kind) return &c->exceptions[i];
  }
  return NULL;
}

static void say_sharp(const laves_certificate *c) {
  const laves_exception *sharpest = first_of(c, LAVES_EXCEPTION_SHARP_INPUT);
  text_buffer count, place;
  if (!sharpest) return;
  text_say("  %s of the input below the window's %.4g%s, which forces angles below it: the sharpest %.2f%s at %s",
           text_plural(&count, c->exception_counts[LAVES_EXCEPTION_SHARP_INPUT], "crease"), sharpest->limit, text_degree(),
           sharpest->value, text_degree(), text_place(&place, sharpest->place));
}

static void say_exceptions(const laves_certificate *c, bool lists) {
  char causes[160];
  text_buffer count;
  for (int kind = LAVES_EXCEPTION_OUTSIDE_PROMISED; kind < LAVES_EXCEPTION_COUNT; ++kind) {
    if (c->exception_counts[kind] == 0 || kind == LAVES_EXCEPTION_THIN || kind == LAVES_EXCEPTION_SHARP_INPUT) continue;
    if (lists && (kind == LAVES_EXCEPTION_OUTSIDE_ASKED || kind == LAVES_EXCEPTION_DISTANT || is_of_features(kind))) continue;
    text_say("  %s %s%s", text_count(&count, c->exception_counts[kind]), laves_exception_text((laves_exception_kind)kind),
             causes_of(c, (laves_exception_kind)kind, causes, sizeof causes));
  }
}

static void say_tiles(const laves_certificate *c) {
  const double percent = c->check.tets ? 100 / (double)c->check.tets : 0;
  if (c->bcc_tets > 0 && c->bcc_tets != SIZE_MAX)
    text_say("  %.1f %% exact tiles, and %.1f %% exact tiles of BCC", percent * (double)c->lattice_tets,
             percent * (double)c->bcc_tets);
  else
    text_say("  %.1f %% exact tiles", percent * (double)c->lattice_tets);
}

static void say_features(const laves_feature_check *f) {
  text_buffer creases;
  char corners[64] = "";
  const size_t all = f->corners - f->short_corners;
  if (all > 0) snprintf(corners, sizeof corners, "; %zu of %zu corners kept", f->corners_kept, all);
  text_say("  %s, %.2f %% of the length kept within %.4g%s", text_plural(&creases, f->creases, "crease"), 100 * f->kept_share,
           f->tolerance, corners);
}

/* Whether what leaves the promised window does so on creases of the input that are sharper, as far as is listed. */
static bool all_forced(const laves_certificate *c) {
  for (size_t i = 0; i < c->exception_count; ++i) {
    const laves_exception *e = &c->exceptions[i];
    if (e->kind == LAVES_EXCEPTION_OUTSIDE_PROMISED && !(e->crease_angle < c->promised_min_dihedral)) return false;
  }
  return c->check.valid;
}

void statement_say(const laves_certificate *c, bool lists) {
  say_tiles(c);
  if (c->check.has_distance) say_distances(&c->check);
  if (c->has_promise) {
    text_say("  promised %.6g .. %.6g%s: %s", c->promised_min_dihedral, c->promised_max_dihedral, text_degree(),
             c->promise_holds ? "holds"
             : all_forced(c)  ? "holds but on creases of the input that are sharper"
                              : "BROKEN");
  }
  if (c->has_features && !lists) say_features(&c->features);
  say_exceptions(c, lists);
  say_sharp(c);
}

static void write_exceptions(json *out, const laves_certificate *c) {
  json_open_object(out, "exceptions");
  for (int kind = 0; kind < LAVES_EXCEPTION_COUNT; ++kind) {
    json_integer(out, laves_exception_key((laves_exception_kind)kind), (int64_t)c->exception_counts[kind]);
  }
  json_close(out);
}

void statement_write_json(json *out, const laves_certificate *c) {
  json_text(out, "sha256", c->mesh_hash);
  json_integer(out, "exact_tets", (int64_t)c->lattice_tets);
  if (c->bcc_tets != SIZE_MAX) json_integer(out, "bcc_tets", (int64_t)c->bcc_tets);
  json_numbers(out, "attained", (const double[2]){c->attained_min_dihedral, c->attained_max_dihedral}, 2);
  json_boolean(out, "promise_holds", c->promise_holds);
  write_exceptions(out, c);
}

laves_result statement_make(session *run, const laves_mesh *mesh, laves_certify_options *options,
                            laves_certificate *certificate) {
  const char **words = options_command(run->given, &options->command_count);
  if (!words) return session_fail(run, LAVES_ERROR_MEMORY, "no memory for the words of the command");
  options->command = words;
  const laves_result result = laves_certify(run->context, mesh, options, certificate, &run->error);
  options->command = NULL;
  free(words);
  return session_settle(run, result);
}
