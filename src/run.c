/* Timers and warnings of a run. */
#include "run.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void laves__stage_begin(laves__run *r) {
  r->wall = laves__wall_seconds();
  r->cpu = laves__cpu_seconds();
}

/* Adds the time since laves__stage_begin() to the stage's line in the report. */
void laves__stage_end(laves__run *r, const char *name) {
  laves_report *report = r->report;
  int i = 0;
  while (i < report->stage_count && strcmp(report->stages[i].name, name) != 0) i++;
  if (i == LAVES_STAGE_CAPACITY) return;
  if (i == report->stage_count) {
    report->stages[i].name = name;
    report->stages[i].wall_seconds = report->stages[i].cpu_seconds = 0;
    report->stage_count++;
  }
  report->stages[i].wall_seconds += laves__wall_seconds() - r->wall;
  report->stages[i].cpu_seconds += laves__cpu_seconds() - r->cpu;
}

bool laves__tell_gaps(const laves__run *r, char *text, size_t size) {
  laves__vec3 place;
  const size_t gaps = laves__function_gaps(r->domain, &place) - r->gaps_before;
  text[0] = '\0';
  if (gaps > 0)
    snprintf(text, size, "the function gave no number %zu times, as at (%g, %g, %g)", gaps, place.x, place.y, place.z);
  return gaps > 0;
}

void laves__warn(laves__run *r, const char *format, ...) {
  laves_report *report = r->report;
  if (report->warning_count == LAVES_WARNING_CAPACITY) return;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(report->warnings[report->warning_count++], sizeof report->warnings[0], format, arguments);
  va_end(arguments);
}
