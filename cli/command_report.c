/* laves report MESH [--surface INPUT] -o PAGE.html: certifies a mesh of any program and shows it on a page. */
#include "command.h"
#include "output.h"
#include "place_list.h"
#include "report.h"
#include "session.h"
#include "summary.h"
#include "text.h"

typedef struct report_run {
  laves_mesh *mesh;
  input surface;
  laves_certificate certificate;
  report_outcome outcome;
  bool has_certificate;
  double read_seconds, check_seconds;
} report_run;

static laves_result certify(session *run, report_run *all) {
  const settings *given = run->given;
  const double start = progress_now();
  const laves_options window = check_window(given);
  laves_certify_options options = laves_certify_options_default();
  options.domain = all->surface.domain;
  options.input = all->surface.text;
  options.min_dihedral = window.min_dihedral;
  options.max_dihedral = window.max_dihedral;
  options.volume_length = window.volume_length;
  if (all->surface.domain) options.feature_angle = given->feature_angle;
  laves_result result = laves_certify(run->context, all->mesh, &options, &all->certificate, &run->error);
  result = session_settle(run, result);
  all->has_certificate = result == LAVES_OK;
  all->check_seconds = progress_now() - start;
  return result;
}

static laves_result report_steps(session *run, report_run *all) {
  const settings *given = run->given;
  if (given->outputs.count != 1)
    return session_fail(run, LAVES_ERROR_OPTION, "'laves report' needs one page to write: --output FILE.html");
  const char *path = given->outputs.items[0];
  laves_result result = outputs_check_page(run, path);
  if (result == LAVES_OK) result = outputs_check_text(run, path, given->input);
  if (result == LAVES_OK) result = outputs_check_json(run, given->input);
  const double start = progress_now();
  if (result == LAVES_OK) result = session_settle(run, laves_mesh_read(run->context, given->input, &all->mesh, &run->error));
  all->read_seconds = progress_now() - start;
  if (result == LAVES_OK && laves_mesh_tet_count(all->mesh) == 0)
    result = session_fail(run, LAVES_ERROR_INPUT, "'%.200s' has no tetrahedra", given->input);
  if (result == LAVES_OK && given->surface) result = input_open(run, given->surface, &all->surface);
  if (result == LAVES_OK) result = certify(run, all);
  if (result != LAVES_OK) return result;

  const report_subject subject = {.name = given->input,
                                  .mesh = all->mesh,
                                  .surface = all->surface.domain ? &all->surface : NULL,
                                  .certificate = &all->certificate,
                                  .defects = all->surface.defects};
  result = report_write(run, &subject, path, &all->outcome);
  if (result != LAVES_OK) return result;
  if (session_speaks(run)) {
    summary_verdict(given->input, &all->certificate.check);
    report_say(&all->outcome, path);
  }
  return all->certificate.check.valid ? LAVES_OK : LAVES_TARGET_MISSED;
}

static void report_json(json *out, const session *run, const void *facts) {
  const report_run *all = facts;
  json_text(out, "mesh", run->given->input);
  if (all->surface.text) input_write_json(out, "surface", &all->surface);
  if (!all->has_certificate) return;
  summary_check_json(out, &all->certificate.check);
  report_write_json(out, &all->outcome, run->given->outputs.items[0]);
  json_open_object(out, "seconds");
  json_number(out, "read", all->read_seconds);
  json_number(out, "check", all->check_seconds);
  json_number(out, "report", all->outcome.seconds);
  json_number(out, "total", progress_now() - run->start);
  json_close(out);
}

int command_report(const settings *given) {
  session run;
  report_run all = {0};
  if (!session_open(&run, given)) return laves_result_exit_code(LAVES_ERROR_MEMORY);
  laves_result result = report_steps(&run, &all);
  session_write_json(&run, &result, report_json, &all);
  laves_mesh_free(all.mesh);
  input_close(&all.surface);
  return session_close(&run, result);
}
