/* laves check MESH [--surface INPUT]: is it valid, how good is it, how far from the surface; and whether a certificate says so.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check_stream.h"
#include "command.h"
#include "feature_report.h"
#include "input.h"
#include "output.h"
#include "place_list.h"
#include "session.h"
#include "statement.h"
#include "summary.h"
#include "text.h"

enum { DIFFERENCES_SAID = 20 };

typedef struct check_run {
  laves_mesh *mesh;
  input surface;
  laves_certificate certificate;
  laves_options window; /* only its window is used */
  place_list outside, distant;
  feature_report features;
  bool has_check;
  laves_difference differences[DIFFERENCES_SAID];
  size_t difference_count; /* may exceed what was kept */
  double read_seconds, check_seconds;
} check_run;

static laves_result read_mesh(session *run, check_run *all) {
  const double start = progress_now();
  laves_result result = laves_mesh_read(run->context, run->given->input, &all->mesh, &run->error);
  result = session_settle(run, result);
  all->read_seconds = progress_now() - start;
  return result;
}

/* Takes the places of a kind from the certificate, which has a few of each. */
static void take_places(const laves_certificate *certificate, laves_exception_kind kind, place_list *list) {
  list->found = certificate->exception_counts[kind];
  size_t taken = 0;
  for (size_t i = 0; i < certificate->exception_count && taken < list->capacity; ++i) {
    const laves_exception *e = &certificate->exceptions[i];
    if (e->kind != kind) continue;
    if (taken < LAVES_PLACE_CAPACITY) list->crease_angles[taken] = e->crease_angle;
    laves_place *place = &list->places[taken++];
    *place = (laves_place){.value = e->value, .tet = e->index, .curvature_radius = e->curvature_radius};
    memcpy(place->place, e->place, sizeof e->place);
  }
}

/* More than a certificate lists is looked for anew. */
static laves_result find_places(session *run, check_run *all) {
  const laves_certificate *c = &all->certificate;
  if (!place_list_make(&all->outside, run->given->list) || !place_list_make(&all->distant, run->given->list)) {
    return session_fail(run, LAVES_ERROR_MEMORY, "no memory for a list of %lld places", (long long)run->given->list);
  }
  take_places(c, LAVES_EXCEPTION_OUTSIDE_ASKED, &all->outside);
  take_places(c, LAVES_EXCEPTION_DISTANT, &all->distant);
  laves_result result = LAVES_OK;
  if (place_list_listed(&all->outside) > LAVES_PLACE_CAPACITY) {
    result = laves_check_window(run->context, all->mesh, all->surface.domain, all->window.min_dihedral, all->window.max_dihedral,
                                all->window.volume_length, all->outside.places, all->outside.capacity, &all->outside.found,
                                &run->error);
  }
  if (result == LAVES_OK && place_list_listed(&all->distant) > LAVES_PLACE_CAPACITY) {
    result = laves_check_distance(run->context, all->mesh, all->surface.domain, c->distance_asked, all->distant.places,
                                  all->distant.capacity, &all->distant.found, &run->error);
  }
  return session_settle(run, result);
}

static laves_result certify(session *run, check_run *all) {
  laves_certify_options options = laves_certify_options_default();
  options.domain = all->surface.domain;
  options.input = all->surface.text;
  options.min_dihedral = all->window.min_dihedral;
  options.max_dihedral = all->window.max_dihedral;
  options.volume_length = all->window.volume_length;
  if (run->given->check_features) options.feature_angle = run->given->feature_angle;
  return session_settle(run, laves_certify(run->context, all->mesh, &options, &all->certificate, &run->error));
}

/* Reads --certificate and holds it against the mesh. */
static laves_result verify(session *run, check_run *all) {
  laves_certificate stated;
  const char *path = run->given->certificate;
  if (!path) return LAVES_OK;
  laves_result result = laves_certificate_read(run->context, path, &stated, &run->error);
  if (result != LAVES_OK) return result;
  result = laves_certificate_verify(run->context, all->mesh, all->surface.domain, all->surface.text, &stated, all->differences,
                                    DIFFERENCES_SAID, &all->difference_count, &run->error);
  return session_settle(run, result);
}

/* ---- words ---- */

static void say_distant(const check_run *all) {
  text_buffer place;
  for (size_t i = 0; i < place_list_listed(&all->distant); ++i) {
    text_say("    %.4g apart at %s", all->distant.places[i].value, text_place(&place, all->distant.places[i].place));
  }
}

static void say_verified(const session *run, const check_run *all) {
  const char *path = run->given->certificate;
  if (!path) return;
  if (all->difference_count == 0) {
    text_say("%s: belongs to the mesh, and every figure %sholds", path,
             all->surface.domain ? "" : "that needs no surface (--surface) ");
    return;
  }
  /* Another mesh differs in nearly every figure: that it is another is all there is to say. */
  const bool other_mesh = strncmp(all->differences[0].text, "mesh.sha256:", strlen("mesh.sha256:")) == 0;
  text_say("%s: %s", path, other_mesh ? "does NOT belong to the mesh" : "is of this mesh, but does NOT hold");
  const size_t said = other_mesh ? 1 : DIFFERENCES_SAID;
  for (size_t i = 0; i < all->difference_count && i < said; ++i) text_say("  %s", all->differences[i].text);
  if (all->difference_count > said) text_say("  and %zu more", all->difference_count - said);
}

static void say_check(const session *run, const check_run *all) {
  const laves_check *check = &all->certificate.check;
  summary_verdict(run->given->input, check);
  statement_say(&all->certificate, true);
  place_list_say_window(&all->outside, &all->window);
  say_distant(all);
  if (all->features.made) feature_report_say(&all->features);
  say_verified(run, all);
  if (run->given->verbose) {
    text_buffer read, checked;
    text_say("  read %s, checked %s", text_seconds(&read, all->read_seconds), text_seconds(&checked, all->check_seconds));
  }
}

/* ---- JSON ---- */

static void write_differences(json *out, const session *run, const check_run *all) {
  if (!run->given->certificate) return;
  json_integer(out, "certificate_differences", (int64_t)all->difference_count);
  json_open_array(out, "differences");
  for (size_t i = 0; i < all->difference_count && i < DIFFERENCES_SAID; ++i) json_text(out, NULL, all->differences[i].text);
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
  summary_check_json(out, &all->certificate.check);
  statement_write_json(out, &all->certificate);
  write_differences(out, run, all);
  if (all->certificate.check.has_distance) json_number(out, "domain_volume", all->certificate.check.domain_volume);
  json_numbers(out, "window", (const double[2]){all->window.min_dihedral, all->window.max_dihedral}, 2);
  json_number(out, "window_volume_length", all->window.volume_length);
  json_integer(out, "outside_window", (int64_t)all->outside.found);
  place_list_write_json(out, "outside_window_places", &all->outside);
  if (all->certificate.check.has_distance) {
    json_number(out, "distant_from", all->certificate.distance_asked);
    json_integer(out, "distant", (int64_t)all->distant.found);
    place_list_write_json(out, "distant_places", &all->distant);
  }
  feature_report_write_json(out, &all->features);
  json_open_object(out, "seconds");
  json_number(out, "read", all->read_seconds);
  json_number(out, "check", all->check_seconds);
  json_number(out, "total", progress_now() - run->start);
  json_close(out);
}

static laves_result check_steps(session *run, check_run *all) {
  const settings *given = run->given;
  all->window = check_window(given);
  const char *write_to = given->write_certificate;
  if (given->check_features && !given->surface)
    return session_fail(run, LAVES_ERROR_OPTION, "--features needs --surface, the solid whose creases the mesh should keep");
  laves_result result = outputs_check_json(run, given->input);
  if (result == LAVES_OK && write_to) result = outputs_check_text(run, write_to, given->input);
  if (result == LAVES_OK) result = read_mesh(run, all);
  if (result == LAVES_OK && given->surface) result = input_open(run, given->surface, &all->surface);
  if (result != LAVES_OK) return result;

  const double start = progress_now();
  result = certify(run, all);
  if (result == LAVES_OK) result = find_places(run, all);
  if (result == LAVES_OK && given->check_features)
    result = feature_report_make(run, all->mesh, all->surface.domain, all->certificate.features.size, &all->features);
  if (result == LAVES_OK) result = verify(run, all);
  all->check_seconds = progress_now() - start;
  all->has_check = result == LAVES_OK;
  if (result == LAVES_OK && write_to) result = laves_certificate_write(run->context, &all->certificate, write_to, &run->error);
  if (result != LAVES_OK) return result;

  if (session_speaks(run)) say_check(run, all);
  const bool wished = given->window.given || given->volume_length >= 0;
  const bool missed = (wished && all->outside.found > 0) || all->difference_count > 0 || feature_report_misses(&all->features);
  return !all->certificate.check.valid || missed ? LAVES_TARGET_MISSED : LAVES_OK;
}

int command_check(const settings *given) {
  if (given->stream) return check_stream(given);
  session run;
  check_run all = {0};
  if (!session_open(&run, given)) return laves_result_exit_code(LAVES_ERROR_MEMORY);
  laves_result result = check_steps(&run, &all);
  session_write_json(&run, &result, check_json, &all);
  place_list_free(&all.outside);
  place_list_free(&all.distant);
  free(all.features.places);
  laves_mesh_free(all.mesh);
  input_close(&all.surface);
  return session_close(&run, result);
}
