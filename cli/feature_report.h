/* What `laves check --features` finds, in words and as JSON. */
#ifndef LAVES_CLI_FEATURE_REPORT_H
#define LAVES_CLI_FEATURE_REPORT_H

#include "json.h"
#include "session.h"

typedef struct feature_report {
  bool made;
  laves_feature_check check;
  laves_feature_place *places; /* by fault, the worst first; free() */
  size_t place_count;
} feature_report;

/* Checks the features of a mesh against the surface that it was given. size: as laves_feature_options.size. */
laves_result feature_report_make(session *run, const laves_mesh *mesh, const laves_domain *surface, double size,
                                 feature_report *report);

/* A crease that is not short, or a corner, is lost. */
bool feature_report_misses(const feature_report *report);

/* The figures of a check as the object `features`; places: NULL: the member is left out. */
void feature_check_write_json(json *out, const laves_feature_check *check, const laves_feature_place *places, size_t place_count);

void feature_report_say(const feature_report *report);
void feature_report_write_json(json *out, const feature_report *report);

#endif
