/* The facts of a report: what its page shows in words and numbers, as JSON. */
#ifndef LAVES_CLI_REPORT_FACTS_H
#define LAVES_CLI_REPORT_FACTS_H

#include "report.h"
#include "report_parts.h"
#include "report_shapes.h"

/* False when memory is short. */
bool report_facts_write(json *out, const report_subject *subject, const report_shapes *shapes, const report_parts *parts);

#endif
