/* laves check MESH [--surface INPUT]: is it valid, how good is it, how far from the surface. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "command.h"
#include "input.h"
#include "output.h"
#include "session.h"
#include "summary.h"
#include "text.h"

/* Distances are listed from this share of the mean edge on: below it lies what flat triangles on a curved surface make. */
static const double listed_distance = 0.3;

typedef struct place_list {
  laves_place *places;
  size_t capacity, found; /* found may exceed capacity */
} place_list;

typedef struct check_run {
  laves_mesh *mesh;
  input surface;
  laves_check check;
  laves_options window; /* only its window is used */
  place_list outside, distant;
  bool has_check;
  double read_seconds, check_seconds;
} check_run;

static bool make_list(place_list *list, int64_t capacity) {
  list->capacity = (size_t)capacity;
  list->places = calloc(list->capacity + 1, sizeof *list->places);
  return list->places != NULL;
}

static size_t listed(const place_list *list) { return list->found < list->capacity ? list->found : list->capacity; }

static laves_result read_mesh(session *run, check_run *all) {
  const double start = progress_now();
  laves_result result = laves_mesh_read(run->context, run->given->input, &all->mesh, &run->error);
  result = session_settle(run, result);
  all->read_seconds = progress_now() - start;
  return result;
}

static laves_result find_places(session *run, check_run *all) {
  if (!make_list(&all->outside, run->given->list) || !make_list(&all->distant, run->given->list)) {
    return session_fail(run, LAVES_ERROR_MEMORY, "no memory for a list of %lld places", (long long)run->given->list);
  }
  laves_result result =
      laves_check_window(run->context, all->mesh, all->surface.domain, all->window.min_dihedral, all->window.max_dihedral,
                         all->window.volume_length, all->outside.places, all->outside.capacity, &all->outside.found, &run->error);
  result = session_settle(run, result);
  if (result != LAVES_OK || !all->check.has_distance) return result;
  result = laves_check_distance(run->context, all->mesh, all->surface.domain, listed_distance * all->check.edge_mean,
                                all->distant.places, all->distant.capacity, &all->distant.found, &run->error);
  return session_settle(run, result);
}

/* ---- words ---- */

static void say_distances(const check_run *all) {
  const laves_check *check = &all->check;
  const double edge = check->edge_mean;
  text_buffer place;
  text_say("  mesh to surface: max %.4g (%.3f edges) at %s, mean %.4g", check->to_surface_max, check->to_surface_max / edge,
           text_place(&place, check->to_surface_place), check->to_surface_mean);
  text_say("  surface to mesh: max %.4g (%.3f edges) at %s, mean %.4g", check->from_surface_max, check->from_surface_max / edge,
           text_place(&place, check->from_surface_place), check->from_surface_mean);
  if (!isnan(check->domain_volume)) {
    text_say("  volume of the surface %.9g, of the mesh %+.3f %%", check->domain_volume,
             100 * (check->volume / check->domain_volume - 1));
  }
  for (size_t i = 0; i < listed(&all->distant); ++i) {
    text_say("    %.4g apart at %s", all->distant.places[i].value, text_place(&place, all->distant.places[i].place));
  }
}

static void say_place(const laves_place *at) {
  text_buffer place;
  char curvature[60] = "";
  if (isfinite(at->curvature_radius)) snprintf(curvature, sizeof curvature, ", curvature radius %.3g", at->curvature_radius);
  if (at->value < 1) {
    text_say("    tet %lld: volume-length %.3f at %s%s", (long long)at->tet, at->value, text_place(&place, at->place), curvature);
  } else {
    text_say("    tet %lld: %.2f%s at %s%s", (long long)at->tet, at->value, text_degree(), text_place(&place, at->place),
             curvature);
  }
}

static void say_window(const check_run *all) {
  text_buffer count;
  if (all->outside.found == 0) {
    text_say("  every tet within %g .. %g%s, volume-length at least %g", all->window.min_dihedral, all->window.max_dihedral,
             text_degree(), all->window.volume_length);
    return;
  }
  text_say("  %s outside %g .. %g%s or below volume-length %g%s", text_plural(&count, all->outside.found, "tet"),
           all->window.min_dihedral, all->window.max_dihedral, text_degree(), all->window.volume_length,
           all->outside.capacity ? "; the worst:" : "");
  for (size_t i = 0; i < listed(&all->outside); ++i) say_place(&all->outside.places[i]);
}

static void say_check(const session *run, const check_run *all) {
  const laves_check *check = &all->check;
  text_buffer tets, vertices, unused;
  text_say("%s: %s, %s, %s", text_base_name(run->given->input), text_plural(&tets, check->tets, "tet"),
           text_plural(&vertices, check->vertices, "vertex"), check->valid ? "valid" : "NOT VALID");
  summary_faults(check);
  if (check->unused_vertices) text_say("  %s in no tet (harmless)", text_plural(&unused, check->unused_vertices, "vertex"));
  summary_check(check);
  say_window(all);
  if (check->has_distance) say_distances(all);
  if (run->given->verbose) {
    text_buffer read, checked;
    text_say("  read %s, checked %s", text_seconds(&read, all->read_seconds), text_seconds(&checked, all->check_seconds));
  }
}

/* ---- JSON ---- */

static void write_places(json *out, const char *key, const place_list *list) {
  json_open_array(out, key);
  for (size_t i = 0; i < listed(list); ++i) {
    json_open_object(out, NULL);
    json_numbers(out, "place", list->places[i].place, 3);
    json_number(out, "value", list->places[i].value);
    json_integer(out, "tet", list->places[i].tet);
    json_number(out, "curvature_radius", list->places[i].curvature_radius);
    json_close(out);
  }
  json_close(out);
}

static void check_json(json *out, const session *run, const void *facts) {
  const check_run *all = facts;
  json_text(out, "mesh", run->given->input);
  if (all->surface.text) input_write_json(out, "surface", &all->surface);
  if (!all->has_check) return;
  char hash[33];
  laves_mesh_hash(all->mesh, hash);
  json_text(out, "hash", hash);
  summary_check_json(out, &all->check);
  if (all->check.has_distance) json_number(out, "domain_volume", all->check.domain_volume);
  json_numbers(out, "window", (const double[2]){all->window.min_dihedral, all->window.max_dihedral}, 2);
  json_number(out, "window_volume_length", all->window.volume_length);
  json_integer(out, "outside_window", (int64_t)all->outside.found);
  write_places(out, "outside_window_places", &all->outside);
  if (all->check.has_distance) {
    json_number(out, "distant_from", listed_distance * all->check.edge_mean);
    json_integer(out, "distant", (int64_t)all->distant.found);
    write_places(out, "distant_places", &all->distant);
  }
  json_open_object(out, "seconds");
  json_number(out, "read", all->read_seconds);
  json_number(out, "check", all->check_seconds);
  json_number(out, "total", progress_now() - run->start);
  json_close(out);
}

static laves_result check_steps(session *run, check_run *all) {
  const settings *given = run->given;
  all->window = laves_options_default();
  if (given->window.given) {
    all->window.min_dihedral = given->window.values[0];
    all->window.max_dihedral = given->window.values[1];
  }
  if (given->volume_length >= 0) all->window.volume_length = given->volume_length;
  laves_result result = outputs_check_json(run, given->input);
  if (result == LAVES_OK) result = read_mesh(run, all);
  if (result == LAVES_OK && given->surface) result = input_open(run, given->surface, &all->surface);
  if (result != LAVES_OK) return result;

  const double start = progress_now();
  result = session_settle(run, laves_check_mesh(run->context, all->mesh, all->surface.domain, &all->check, &run->error));
  if (result == LAVES_OK) result = find_places(run, all);
  all->check_seconds = progress_now() - start;
  all->has_check = result == LAVES_OK;
  if (result != LAVES_OK) return result;

  if (session_speaks(run)) say_check(run, all);
  const bool wished = given->window.given || given->volume_length >= 0;
  return !all->check.valid || (wished && all->outside.found > 0) ? LAVES_TARGET_MISSED : LAVES_OK;
}

int command_check(const settings *given) {
  session run;
  check_run all = {0};
  if (!session_open(&run, given)) return laves_result_exit_code(LAVES_ERROR_MEMORY);
  laves_result result = check_steps(&run, &all);
  session_write_json(&run, &result, check_json, &all);
  free(all.outside.places);
  free(all.distant.places);
  laves_mesh_free(all.mesh);
  laves_domain_free(all.surface.domain);
  return session_close(&run, result);
}
