/* laves improve MESH -o OUT: read -> improve -> certify -> write -> before and after, JSON. */
#include <math.h>
#include <stdio.h>

#include "command.h"
#include "groups.h"
#include "output.h"
#include "session.h"
#include "statement.h"
#include "summary.h"
#include "text.h"

typedef struct improve_run {
  laves_mesh *before, *after;
  laves_improve_options options;
  laves_improve_report report;
  laves_certificate certificate;
  bool has_certificate, done;
  outputs plan;
  double read_seconds, certify_seconds;
} improve_run;

static laves_result read_mesh(session *run, improve_run *all) {
  const double start = progress_now();
  const laves_result result = session_settle(run, laves_mesh_read(run->context, run->given->input, &all->before, &run->error));
  all->read_seconds = progress_now() - start;
  return result;
}

static laves_improve_options make_options(const settings *given) {
  laves_improve_options options = laves_improve_options_default();
  if (given->window.given) {
    options.min_dihedral = given->window.values[0];
    options.max_dihedral = given->window.values[1];
  }
  if (given->volume_length >= 0) options.volume_length = given->volume_length;
  options.tolerance = given->tolerance;
  options.fixed_boundary = given->fixed_boundary;
  options.passes = (size_t)given->passes;
  options.seconds = given->budget;
  return options;
}

static laves_result certify(session *run, improve_run *all) {
  const double start = progress_now();
  laves_certify_options options = laves_certify_options_default();
  options.min_dihedral = all->options.min_dihedral;
  options.max_dihedral = all->options.max_dihedral;
  options.volume_length = all->options.volume_length;
  options.feature_angle = 0; /* there is no surface beside the mesh */
  const laves_result result = statement_make(run, all->after, &options, &all->certificate);
  all->has_certificate = result == LAVES_OK;
  all->certify_seconds = progress_now() - start;
  return result;
}

/* ---- words ---- */

static void say_side(const char *name, const laves_check *check, size_t outside) {
  text_buffer tets, vertices, count;
  const char *degree = text_degree();
  text_say("  %-7s %s, %s, dihedral angles %.2f .. %.2f%s, %s outside the window, volume-length min %.3f mean %.3f", name,
           text_plural(&tets, check->tets, "tet"), text_plural(&vertices, check->vertices, "vertex"), check->min_dihedral.min,
           check->max_dihedral.max, degree, text_count(&count, outside), check->volume_length.min, check->volume_length.mean);
}

static void say_boundary(const improve_run *all) {
  const laves_improve_report *r = &all->report;
  text_buffer triangles, patches, fixed, creases, flat;
  text_say("  boundary: %s in %s; %s stay, %s move along straight edges, %s in flat parts",
           text_plural(&triangles, r->before.faces, "triangle"), text_plural(&patches, r->patches, "flat part"),
           text_plural(&fixed, r->fixed_vertices, "vertex"), text_count(&creases, r->crease_vertices),
           text_count(&flat, r->flat_vertices));
  if (r->sharpest < all->options.min_dihedral)
    text_say("  its sharpest edge is %.2f%s wide inside: no mesh with this boundary has a larger smallest angle", r->sharpest,
             text_degree());
}

static void say_improved(const session *run, const improve_run *all) {
  const laves_improve_report *r = &all->report;
  text_buffer time, memory, read, certified, written;
  text_say("%s: improved in %s, %s, window %.4g .. %.4g%s", run->given->input, text_seconds(&time, r->wall_seconds),
           text_bytes(&memory, session_peak_bytes()), all->options.min_dihedral, all->options.max_dihedral, text_degree());
  say_side("before", &r->before, r->outside_before);
  say_side("after", &r->after, r->outside_after);
  say_boundary(all);
  summary_check(&r->after);
  if (all->has_certificate) statement_say(&all->certificate, false);
  if (run->given->verbose)
    text_say("  read %s, certified %s, written %s", text_seconds(&read, all->read_seconds),
             text_seconds(&certified, all->certify_seconds), text_seconds(&written, all->plan.seconds));
  if (r->out_of_time) text_warning("the time of --budget was over before nothing more helped");
  if (r->kept_as_it_was) text_warning("the mesh could not be improved and is as it was");
  outputs_say(&all->plan);
}

/* ---- JSON ---- */

static void write_options(json *out, const laves_improve_options *o) {
  json_open_object(out, "options");
  json_numbers(out, "window", (const double[2]){o->min_dihedral, o->max_dihedral}, 2);
  json_number(out, "volume_length", o->volume_length);
  json_number(out, "tolerance", o->tolerance);
  json_boolean(out, "fixed_boundary", o->fixed_boundary);
  json_number(out, "passes", o->passes > 0 ? (double)o->passes : NAN);
  json_number(out, "budget", o->seconds > 0 ? o->seconds : NAN);
  json_close(out);
}

static void write_boundary(json *out, const laves_improve_report *r) {
  json_open_object(out, "boundary");
  json_integer(out, "patches", (int64_t)r->patches);
  json_integer(out, "fixed_vertices", (int64_t)r->fixed_vertices);
  json_integer(out, "crease_vertices", (int64_t)r->crease_vertices);
  json_integer(out, "flat_vertices", (int64_t)r->flat_vertices);
  json_number(out, "sharpest", r->sharpest);
  json_close(out);
}

static void write_times(json *out, const session *run, const improve_run *all) {
  json_open_object(out, "seconds");
  json_number(out, "read", all->read_seconds);
  json_number(out, "improve", all->report.wall_seconds);
  json_number(out, "check", all->certify_seconds);
  json_number(out, "write", all->plan.seconds);
  json_number(out, "total", progress_now() - run->start);
  json_close(out);
  json_open_object(out, "cpu_seconds");
  json_number(out, "improve", all->report.cpu_seconds);
  json_close(out);
}

static void improve_json(json *out, const session *run, const void *facts) {
  const improve_run *all = facts;
  const laves_improve_report *r = &all->report;
  char hash[33];
  json_text(out, "mesh", run->given->input);
  if (all->options.cookie) write_options(out, &all->options);
  if (!all->done) return;
  laves_mesh_hash(all->after, hash);
  json_text(out, "hash", hash);
  json_open_object(out, "before");
  summary_check_json(out, &r->before);
  json_integer(out, "outside_window", (int64_t)r->outside_before);
  json_close(out);
  summary_check_json(out, &r->after);
  json_integer(out, "outside_window", (int64_t)r->outside_after);
  write_boundary(out, r);
  json_boolean(out, "out_of_time", r->out_of_time);
  json_boolean(out, "kept_as_it_was", r->kept_as_it_was);
  if (all->has_certificate) statement_write_json(out, &all->certificate);
  groups_write_json(out, all->after);
  outputs_write_json(out, &all->plan);
  json_text(out, "certificate", all->plan.certificate_bytes > 0 ? all->plan.certificate : NULL);
  write_times(out, run, all);
}

static laves_result improve_steps(session *run, improve_run *all) {
  const settings *given = run->given;
  if (given->outputs.count == 0)
    return session_fail(run, LAVES_ERROR_OPTION, "where shall the improved mesh go? Name a file with --output");
  laves_result result = outputs_plan(run, NULL, given->input, &all->plan);
  if (result == LAVES_OK) result = outputs_plan_certificate(run, given->input, &all->plan);
  if (result == LAVES_OK) result = read_mesh(run, all);
  if (result != LAVES_OK) return result;

  all->options = make_options(given);
  result = laves_improve(run->context, all->before, &all->options, &all->after, &all->report, &run->error);
  const bool missed = result == LAVES_TARGET_MISSED && (given->window.given || given->volume_length >= 0);
  result = session_settle(run, result == LAVES_TARGET_MISSED ? LAVES_OK : result);
  if (result != LAVES_OK) return result;
  all->done = true;
  if (all->plan.certificate[0]) result = certify(run, all);
  if (result == LAVES_OK) result = outputs_write(run, all->after, all->has_certificate ? &all->certificate : NULL, &all->plan);
  if (result == LAVES_OK && session_speaks(run)) say_improved(run, all);
  return result == LAVES_OK && missed ? LAVES_TARGET_MISSED : result;
}

int command_improve(const settings *given) {
  session run;
  improve_run all = {0};
  if (!session_open(&run, given)) return laves_result_exit_code(LAVES_ERROR_MEMORY);
  laves_result result = improve_steps(&run, &all);
  session_write_json(&run, &result, improve_json, &all);
  laves_mesh_free(all.after);
  laves_mesh_free(all.before);
  return session_close(&run, result);
}
