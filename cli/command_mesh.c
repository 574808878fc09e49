/* laves mesh INPUT -o OUT: input -> generate -> certify -> write -> summary, JSON. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "command.h"
#include "feature_report.h"
#include "features.h"
#include "groups.h"
#include "input.h"
#include "output.h"
#include "report.h"
#include "second_order.h"
#include "session.h"
#include "sizing.h"
#include "statement.h"
#include "summary.h"
#include "text.h"

/* How far the count of tets or vertices may be from a wished one, as laves.h promises. */
static const double count_slack = 0.03;
/* Share of the solid's volume that a mesh may lack or add without a warning: smooth solids differ by 2 %. */
static const double volume_slack = 0.1;

typedef struct mesh_run {
  input in;
  outputs plan;
  laves_sizing *sizing;     /* NULL: none */
  laves_features *features; /* NULL: none */
  laves_options options;
  laves_mesh *mesh;
  laves_report report;
  laves_certificate certificate;
  bool has_certificate;
  double certify_seconds;
  second_order curved;
  report_outcome page;
} mesh_run;

static laves_options make_options(const settings *given, const laves_sizing *sizing, const laves_features *features,
                                  const laves_domain_info *info) {
  laves_options options = laves_options_default();
  options.size = given->size;
  options.relative_size = given->relative_size;
  options.tet_target = given->tets;
  options.vertex_target = given->vertices;
  options.align = given->alignment.align;
  memcpy(options.rotation, given->alignment.rotation, sizeof options.rotation);
  options.method = given->method;
  options.guarantee = given->guarantee;
  options.improve = !given->no_improve;
  options.regions = given->regions;
  options.face_sources = given->face_sources;
  options.streamed = given->stream;
  if (given->window.given) {
    options.min_dihedral = given->window.values[0];
    options.max_dihedral = given->window.values[1];
  }
  if (given->volume_length >= 0) options.volume_length = given->volume_length;
  sizing_options(given, sizing, info, &options);
  features_options(given, features, &options);
  return options;
}

static bool count_missed(int64_t wished, size_t attained) {
  return wished > 0 && fabs((double)attained - (double)wished) > count_slack * (double)wished;
}

/* The library looks at its default window too; only what was wished for on the command line makes the exit code 3. */
static bool wish_missed(const settings *given, const mesh_run *all) {
  const bool asked = given->window.given || given->volume_length >= 0;
  return (asked && all->report.outside_window > 0) || count_missed(given->tets, laves_mesh_tet_count(all->mesh)) ||
         count_missed(given->vertices, laves_mesh_vertex_count(all->mesh));
}

static laves_result certify(session *run, mesh_run *all) {
  const double start = progress_now();
  laves_certify_options options = laves_certify_options_default();
  options.domain = all->in.domain;
  options.input = all->in.text;
  options.options = &all->options;
  options.report = &all->report;
  laves_result result = statement_make(run, all->mesh, &options, &all->certificate);
  all->has_certificate = result == LAVES_OK;
  all->certify_seconds = progress_now() - start;
  if (all->has_certificate && !all->certificate.check.valid) {
    summary_faults(&all->certificate.check);
    return session_fail(run, LAVES_ERROR_INTERNAL, "the mesh made is not valid, so it was not written; please report this input");
  }
  return result;
}

static void say_stages(const mesh_run *all) {
  text_buffer wall, cpu;
  text_say("  read         %10s", text_seconds(&wall, all->in.seconds));
  for (int i = 0; i < all->report.stage_count; ++i) {
    text_say("  %-12s %10s %10s cpu", all->report.stages[i].name, text_seconds(&wall, all->report.stages[i].wall_seconds),
             text_seconds(&cpu, all->report.stages[i].cpu_seconds));
  }
  text_say("  certify      %10s", text_seconds(&wall, all->certify_seconds));
  if (all->curved.seconds > 0) text_say("  curve        %10s", text_seconds(&wall, all->curved.seconds));
  text_say("  write        %10s", text_seconds(&wall, all->plan.seconds));
}

/* A fault of the program, but the mesh is valid and may still be of use. What a crease of the solid forces is none. */
static bool promise_broken(const mesh_run *all) {
  return all->has_certificate && !all->certificate.promise_holds &&
         all->certificate.exception_counts[LAVES_EXCEPTION_OUTSIDE_PROMISED] > all->report.forced_tets;
}

static void say_relaxed(const mesh_run *all) {
  const laves_report *report = &all->report;
  if (report->relaxed_vertices == 0) return;
  text_buffer vertices;
  text_say("  %s of the boundary relaxed for the guarantee: moved off the surface by up to %.4g (%.3f sizes)%s",
           text_plural(&vertices, report->relaxed_vertices, "vertex"), report->relaxed_max, report->relaxed_max / report->size,
           all->options.improve ? ", before improvement" : "");
}

/* The angles may be fine though most of the solid is lost; no other line would stand out. */
static void warn_of_volume(const mesh_run *all) {
  if (!all->has_certificate) return;
  const double share = all->certificate.check.volume / all->certificate.check.domain_volume;
  if (!(fabs(share - 1) > volume_slack)) return;
  text_warning("the mesh has %.3g %% of the volume of the solid, which is too thin or rough for the size; choose a smaller one",
               100 * share);
}

static void say_mesh(const session *run, const mesh_run *all) {
  text_buffer tets, vertices, time, memory;
  summary_input(&all->in, run->given->verbose);
  text_say("%s, %s, size %.4g, %s, %s", text_plural(&tets, laves_mesh_tet_count(all->mesh), "tet"),
           text_plural(&vertices, laves_mesh_vertex_count(all->mesh), "vertex"), all->report.size,
           text_seconds(&time, progress_now() - run->start), text_bytes(&memory, session_peak_bytes()));
  if (all->has_certificate) {
    summary_check(&all->certificate.check);
    statement_say(&all->certificate, false);
  }
  say_relaxed(all);
  if (run->given->order == 2) second_order_say(&all->curved);
  if (run->given->verbose) say_stages(all);
  for (int i = 0; i < all->report.warning_count; ++i) text_warning("%s", all->report.warnings[i]);
  warn_of_volume(all);
  if (promise_broken(all)) text_warning("the mesh leaves the window that was promised for it; please report this input");
  outputs_say(&all->plan);
  if (all->page.bytes > 0) report_say(&all->page, all->plan.report);
}

/* The page of --report, which needs the mesh in memory. */
static laves_result write_report_page(session *run, mesh_run *all) {
  const report_subject subject = {.name = all->plan.items[0].path,
                                  .mesh = all->mesh,
                                  .surface = &all->in,
                                  .certificate = &all->certificate,
                                  .defects = all->in.defects,
                                  .making = &all->report};
  return report_write(run, &subject, all->plan.report, &all->page);
}

static laves_result mesh_steps(session *run, mesh_run *all) {
  const settings *given = run->given;
  char fallback[PATH_CAPACITY];
  input_default_output(given->input, given->format, fallback, sizeof fallback);
  laves_result result = second_order_check(run);
  if (result == LAVES_OK) result = outputs_plan(run, fallback, given->input, &all->plan);
  if (result == LAVES_OK) result = outputs_plan_certificate(run, given->input, &all->plan);
  if (result == LAVES_OK) result = outputs_plan_report(run, given->input, &all->plan);
  if (result == LAVES_OK) result = sizing_open(run, &all->sizing);
  if (result == LAVES_OK) result = features_open(run, &all->features);
  if (result == LAVES_OK) result = input_open(run, given->input, &all->in);
  if (result != LAVES_OK) return result;

  all->options = make_options(given, all->sizing, all->features, &all->in.info);
  result = laves_generate(run->context, all->in.domain, &all->options, &all->mesh, &all->report, &run->error);
  result = session_settle(run, result);
  if (result != LAVES_OK && result != LAVES_TARGET_MISSED) return result;

  const bool missed = wish_missed(given, all);
  result = LAVES_OK;
  if (all->plan.certificate[0] || given->report) result = certify(run, all);
  if (result == LAVES_OK && given->order == 2)
    result = second_order_make(run, all->mesh, all->in.domain, &all->options, &all->report, &all->curved);
  if (result == LAVES_OK) result = outputs_write(run, all->mesh, all->has_certificate ? &all->certificate : NULL, &all->plan);
  if (result == LAVES_OK && given->report) result = write_report_page(run, all);
  if (result == LAVES_OK && session_speaks(run)) say_mesh(run, all);
  return result == LAVES_OK && (missed || promise_broken(all)) ? LAVES_TARGET_MISSED : result;
}

/* ---- JSON ---- */

/* A stage that ran twice is one member. */
static double stage_seconds(const laves_report *report, int first, bool cpu) {
  double sum = 0;
  for (int i = first; i < report->stage_count; ++i) {
    if (strcmp(report->stages[i].name, report->stages[first].name) != 0) continue;
    sum += cpu ? report->stages[i].cpu_seconds : report->stages[i].wall_seconds;
  }
  return sum;
}

static bool stage_seen_before(const laves_report *report, int stage) {
  for (int i = 0; i < stage; ++i) {
    if (strcmp(report->stages[i].name, report->stages[stage].name) == 0) return true;
  }
  return false;
}

static void write_stages(json *out, const laves_report *report, bool cpu) {
  for (int i = 0; i < report->stage_count; ++i) {
    if (!stage_seen_before(report, i)) json_number(out, report->stages[i].name, stage_seconds(report, i, cpu));
  }
}

static void write_times(json *out, const session *run, const mesh_run *all) {
  json_open_object(out, "seconds");
  json_number(out, "read", all->in.seconds);
  write_stages(out, &all->report, false);
  json_number(out, "check", all->certify_seconds);
  if (run->given->order == 2) json_number(out, "curve", all->curved.seconds);
  json_number(out, "write", all->plan.seconds);
  json_number(out, "total", progress_now() - run->start);
  json_close(out);
  json_open_object(out, "cpu_seconds");
  write_stages(out, &all->report, true);
  json_close(out);
}

static void write_options(json *out, const settings *given, const laves_options *options) {
  static const char *const aligns[] = {"none", "pca", "rotation"}, *const methods[] = {"auto", "snap", "stuff"};
  json_open_object(out, "options");
  json_number(out, "size", given->size > 0 ? given->size : NAN);
  json_number(out, "relative_size", given->relative_size > 0 ? given->relative_size : NAN);
  json_number(out, "tets", given->tets > 0 ? (double)given->tets : NAN);
  json_number(out, "vertices", given->vertices > 0 ? (double)given->vertices : NAN);
  json_text(out, "align", aligns[options->align]);
  if (options->align == LAVES_ALIGN_ROTATION) json_numbers(out, "rotation", options->rotation, 9);
  json_text(out, "method", methods[options->method]);
  json_number(out, "guarantee", options->guarantee);
  json_boolean(out, "improve", options->improve);
  json_numbers(out, "window", (const double[2]){options->min_dihedral, options->max_dihedral}, 2);
  json_number(out, "volume_length", options->volume_length);
  json_text(out, "regions", options->regions == LAVES_REGIONS_PARTS ? "parts" : "none");
  json_boolean(out, "face_sources", options->face_sources);
  json_boolean(out, "streamed", options->streamed);
  json_integer(out, "order", given->order);
  sizing_write_json(out, given);
  features_write_json(out, given);
  json_close(out);
}

static void write_making(json *out, const laves_report *report) {
  json_open_object(out, "feature_making");
  json_integer(out, "creases", (int64_t)report->creases);
  json_integer(out, "corners", (int64_t)report->corners);
  json_integer(out, "corners_kept", (int64_t)report->corners_kept);
  json_number(out, "crease_length", report->crease_length);
  json_number(out, "crease_kept", report->crease_kept);
  json_integer(out, "released", (int64_t)report->features_released);
  json_integer(out, "dropped", (int64_t)report->creases_dropped);
  json_integer(out, "joined", (int64_t)report->creases_joined);
  json_close(out);
}

static void write_report(json *out, const mesh_run *all) {
  const laves_report *report = &all->report;
  char hash[33];
  laves_mesh_hash(all->mesh, hash);
  json_text(out, "hash", hash);
  json_number(out, "size", report->size);
  json_number(out, "domain_volume", report->volume);
  json_integer(out, "lattice_tets", (int64_t)report->lattice_tets);
  json_integer(out, "snapped_vertices", (int64_t)report->snapped_vertices);
  json_integer(out, "pinches", (int64_t)report->pinches);
  json_integer(out, "off_surface", (int64_t)report->off_surface);
  json_integer(out, "outside_window", (int64_t)report->outside_window);
  json_numbers(out, "promised_window", (const double[2]){report->promised_min_dihedral, report->promised_max_dihedral}, 2);
  json_integer(out, "stuffed_vertices", (int64_t)report->stuffed_vertices);
  json_integer(out, "relaxed_vertices", (int64_t)report->relaxed_vertices);
  json_number(out, "relaxed_max", report->relaxed_max);
  json_integer(out, "forced_tets", (int64_t)report->forced_tets);
  write_making(out, report);
}

/* Pieces and genus of the boundary, and where it lost something. */
static void write_thin(json *out, const laves_report *report) {
  json_open_object(out, "thin");
  json_boolean(out, "topology_known", report->topology_known);
  json_number(out, "domain_pieces", report->topology_known ? (double)report->domain_pieces : NAN);
  json_number(out, "domain_genus", report->topology_known ? (double)report->domain_genus : NAN);
  json_integer(out, "pieces", (int64_t)report->pieces);
  json_integer(out, "genus", report->genus);
  json_open_array(out, "lost");
  for (size_t i = 0; i < report->lost_count; ++i) {
    json_open_object(out, NULL);
    json_text(out, "kind", report->lost[i].kind == LAVES_THIN_GAP ? "gap" : "wall");
    json_numbers(out, "place", report->lost[i].place, 3);
    json_number(out, "thickness", report->lost[i].thickness);
    json_close(out);
  }
  json_close(out);
  json_close(out);
}

static void mesh_json(json *out, const session *run, const void *facts) {
  const mesh_run *all = facts;
  if (all->in.text) input_write_json(out, "input", &all->in);
  if (all->options.cookie) write_options(out, run->given, &all->options);
  if (all->mesh) {
    write_report(out, all);
    write_thin(out, &all->report);
  }
  if (all->has_certificate) {
    summary_check_json(out, &all->certificate.check);
    statement_write_json(out, &all->certificate);
    if (all->certificate.has_features) feature_check_write_json(out, &all->certificate.features, NULL, 0);
  } else if (all->mesh) {
    json_integer(out, "tets", (int64_t)laves_mesh_tet_count(all->mesh));
    json_integer(out, "vertices", (int64_t)laves_mesh_vertex_count(all->mesh));
    json_integer(out, "faces", (int64_t)laves_mesh_face_count(all->mesh));
  }
  if (all->curved.made) second_order_write_json(out, &all->curved);
  if (all->mesh) groups_write_json(out, all->mesh);
  outputs_write_json(out, &all->plan);
  json_text(out, "certificate", all->plan.certificate_bytes > 0 ? all->plan.certificate : NULL);
  if (run->given->report) report_write_json(out, &all->page, all->plan.report);
  if (all->mesh) write_times(out, run, all);
  json_open_array(out, "warnings");
  for (int i = 0; i < all->report.warning_count; ++i) json_text(out, NULL, all->report.warnings[i]);
  json_close(out);
}

int command_mesh(const settings *given) {
  session run;
  mesh_run all = {0};
  if (!session_open(&run, given)) return laves_result_exit_code(LAVES_ERROR_MEMORY);
  laves_result result = mesh_steps(&run, &all);
  session_write_json(&run, &result, mesh_json, &all);
  laves_mesh_free(all.mesh);
  laves_sizing_free(all.sizing);
  laves_features_free(all.features);
  input_close(&all.in);
  return session_close(&run, result);
}
