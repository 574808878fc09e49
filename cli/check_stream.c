/* laves check --stream MESH [--surface INPUT]: what can be said of a mesh that stays in its file, in the words of the check of
 * any mesh. */
#include "check_stream.h"

#include <math.h>

#include "input.h"
#include "output.h"
#include "place_list.h"
#include "session.h"
#include "summary.h"
#include "text.h"

typedef struct stream_run {
  input surface;
  laves_options window; /* only its window is used */
  place_list outside;
  laves_file_check found;
  bool has_check;
  double check_seconds;
} stream_run;

/* ---- words ---- */

/* How the triangles of the file stand to the boundary; nothing where they are it. */
static void say_triangles(const laves_file_check *found) {
  text_buffer count;
  if (found->file_faces == 0) return;
  if (found->file_faces_missing == 0 && found->file_faces_elsewhere == 0 && found->file_faces_turned == 0) {
    text_say("  the triangles of the file are the boundary");
    return;
  }
  text_say("  %s in the file: %zu are not on the boundary, %zu face inwards; %zu faces of the boundary are missing",
           text_plural(&count, found->file_faces, "triangle"), found->file_faces_elsewhere, found->file_faces_turned,
           found->file_faces_missing);
}

static void say_distance(const laves_check *check) {
  text_buffer to, from;
  if (!check->has_distance) return;
  text_say("  boundary to surface at most %.4g (mean %.3g) at %s", check->to_surface_max, check->to_surface_mean,
           text_place(&to, check->to_surface_place));
  text_say("  surface to boundary at most %.4g (mean %.3g) at %s", check->from_surface_max, check->from_surface_mean,
           text_place(&from, check->from_surface_place));
}

static void say_check(const session *run, const stream_run *all) {
  const laves_check *check = &all->found.check;
  summary_verdict(run->given->input, check);
  say_triangles(&all->found);
  say_distance(check);
  place_list_say_window(&all->outside, &all->window);
  if (run->given->verbose) {
    text_buffer checked, memory;
    text_say("  checked %s, at most %s at once", text_seconds(&checked, all->check_seconds),
             text_bytes(&memory, (double)laves_context_peak_bytes(run->context)));
  }
}

/* ---- JSON ---- */

static void stream_json(json *out, const session *run, const void *facts) {
  const stream_run *all = facts;
  json_text(out, "mesh", run->given->input);
  json_boolean(out, "stream", true);
  if (all->surface.text) input_write_json(out, "surface", &all->surface);
  if (!all->has_check) return;
  const laves_file_check *found = &all->found;
  summary_check_json(out, &found->check);
  if (found->check.has_distance) json_number(out, "domain_volume", found->check.domain_volume);
  json_integer(out, "file_faces", (int64_t)found->file_faces);
  json_integer(out, "file_faces_elsewhere", (int64_t)found->file_faces_elsewhere);
  json_integer(out, "file_faces_turned", (int64_t)found->file_faces_turned);
  json_integer(out, "file_faces_missing", (int64_t)found->file_faces_missing);
  json_numbers(out, "window", (const double[2]){all->window.min_dihedral, all->window.max_dihedral}, 2);
  json_number(out, "window_volume_length", all->window.volume_length);
  json_integer(out, "outside_window", (int64_t)all->outside.found);
  place_list_write_json(out, "outside_window_places", &all->outside);
  json_open_object(out, "seconds");
  json_number(out, "check", all->check_seconds);
  json_number(out, "total", progress_now() - run->start);
  json_close(out);
}

/* ---- steps ---- */

static laves_result refuse(session *run) {
  const settings *given = run->given;
  if (given->check_features)
    return session_fail(run, LAVES_ERROR_OPTION, "--features needs the whole mesh in memory: leave --stream out");
  if (given->certificate || given->write_certificate)
    return session_fail(run, LAVES_ERROR_OPTION, "certificates need the whole mesh in memory: leave --stream out");
  return outputs_check_json(run, given->input);
}

static laves_result check_steps(session *run, stream_run *all) {
  const settings *given = run->given;
  all->window = check_window(given);
  laves_result result = refuse(run);
  if (result == LAVES_OK && given->surface) result = input_open(run, given->surface, &all->surface);
  if (result != LAVES_OK) return result;
  if (!place_list_make(&all->outside, given->list))
    return session_fail(run, LAVES_ERROR_MEMORY, "no memory for a list of %lld places", (long long)given->list);
  laves_file_check_options options = laves_file_check_options_default();
  options.domain = all->surface.domain;
  options.min_dihedral = all->window.min_dihedral;
  options.max_dihedral = all->window.max_dihedral;
  options.volume_length = all->window.volume_length;
  options.places = all->outside.places;
  options.place_capacity = all->outside.capacity;

  const double start = progress_now();
  result = session_settle(run, laves_check_file(run->context, given->input, &options, &all->found, &run->error));
  all->check_seconds = progress_now() - start;
  all->outside.found = all->found.outside_window;
  all->has_check = result == LAVES_OK;
  if (result != LAVES_OK) return result;
  if (session_speaks(run)) say_check(run, all);
  const bool wished = given->window.given || given->volume_length >= 0;
  return !all->found.check.valid || (wished && all->outside.found > 0) ? LAVES_TARGET_MISSED : LAVES_OK;
}

int check_stream(const settings *given) {
  session run;
  stream_run all = {0};
  if (!session_open(&run, given)) return laves_result_exit_code(LAVES_ERROR_MEMORY);
  laves_result result = check_steps(&run, &all);
  session_write_json(&run, &result, stream_json, &all);
  place_list_free(&all.outside);
  laves_domain_free(all.surface.domain);
  return session_close(&run, result);
}
