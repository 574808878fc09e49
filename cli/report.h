/* A page that shows a mesh: one HTML file that opens anywhere, without a network. docs/report.md tells what it holds. */
#ifndef LAVES_CLI_REPORT_H
#define LAVES_CLI_REPORT_H

#include "input.h"
#include "json.h"
#include "session.h"

/* What a report is about. */
typedef struct report_subject {
  const char *name; /* of the mesh, to be shown */
  const laves_mesh *mesh;
  const input *surface; /* NULL: none was given */
  const laves_certificate *certificate;
  const laves_defects *defects; /* NULL: not known */
  const laves_report *making;   /* NULL: the mesh came from a file */
} report_subject;

/* What was written. */
typedef struct report_outcome {
  bool whole; /* every tetrahedron is embedded */
  double bytes, seconds;
} report_outcome;

/* Writes the page, whole or not at all.
 * @param outcome  out */
laves_result report_write(session *run, const report_subject *subject, const char *path, report_outcome *outcome);
void report_say(const report_outcome *outcome, const char *path);
/* The member "report"; null when none was written. */
void report_write_json(json *out, const report_outcome *outcome, const char *path);

#endif
