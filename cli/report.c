/* A page that shows a mesh: one HTML file that opens anywhere, without a network.
 *
 * The template (report_template.html, built from web/ and carried in the program) has two marks. At the first go the facts, as
 * JSON, and the blocks of numbers; at the second, behind the script, so that a browser draws before it has read them, the
 * sections of large meshes. */
#include "report.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "report_facts.h"
#include "report_parts.h"
#include "report_shapes.h"
#include "report_template.h"
#include "text.h"
#include "whole_file.h"

/* Faces are told as 4 * tet + corner, in 32 bits. */
#define TETS_MOST ((UINT32_MAX - 3) / 4)

static const char data_mark[] = "<!--laves:data-->", sections_mark[] = "<!--laves:sections-->";

static bool write_facts(FILE *file, const report_subject *subject, const report_shapes *shapes, const report_parts *parts) {
  fputs("<script type=\"application/json\" id=\"facts\">", file);
  json out = json_start(file);
  out.in_page = true;
  const bool known = report_facts_write(&out, subject, shapes, parts);
  json_finish(&out);
  fputs("</script>\n", file);
  return known;
}

/* False when memory is short or the work is to stop; what cannot be written shows in ferror(). */
static bool write_page(FILE *file, const report_subject *subject, const report_shapes *shapes, const report_parts *parts) {
  const char *template = (const char *)report_template;
  const char *data = strstr(template, data_mark), *sections = strstr(template, sections_mark);
  if (!data || !sections) return false; /* a test holds the template against it */
  fwrite(template, 1, (size_t)(data - template), file);
  if (!write_facts(file, subject, shapes, parts)) return false;
  if (!report_parts_write(file, subject->mesh, shapes, parts)) return false;
  data += strlen(data_mark);
  fwrite(data, 1, (size_t)(sections - data), file);
  if (!parts->whole && !report_sections_write(file, subject->mesh, shapes, parts, subject->certificate->check.edge_max))
    return false;
  fputs(sections + strlen(sections_mark), file);
  return true;
}

static laves_result fail_writing(session *run, const char *path, int reason) {
  if (reason == ENOMEM) return session_fail(run, LAVES_ERROR_MEMORY, "no memory to write the report '%.200s'", path);
  return session_fail(run, LAVES_ERROR_WRITE, "cannot write '%.200s': %s", path, strerror(reason));
}

static laves_result save(session *run, const report_subject *subject, const report_shapes *shapes, const report_parts *parts,
                         const char *path, double *bytes) {
  whole_file out;
  if (!whole_file_open(&out, path)) return fail_writing(run, path, errno);
  errno = 0;
  const bool made = write_page(out.file, subject, shapes, parts);
  const bool lost = ferror(out.file);
  int reason = errno;
  *bytes = (double)ftell(out.file);
  const bool written = whole_file_close(&out, made);
  if (written) return session_settle(run, LAVES_OK);
  if (lost || made) {
    if (made && !lost) reason = errno;
    return fail_writing(run, path, reason);
  }
  return session_settle(run, fail_writing(run, path, ENOMEM));
}

laves_result report_write(session *run, const report_subject *subject, const char *path, report_outcome *outcome) {
  const double start = progress_now();
  report_shapes shapes = {0};
  report_parts parts = {0};
  *outcome = (report_outcome){0};
  laves_result result = LAVES_OK;
  if (laves_mesh_tet_count(subject->mesh) > TETS_MOST)
    return session_fail(run, LAVES_ERROR_OPTION, "a report is of %u tetrahedra at most", TETS_MOST);
  if (!report_shapes_make(subject->mesh, subject->certificate, &shapes))
    result = session_fail(run, LAVES_ERROR_MEMORY, "no memory for the shapes of the tetrahedra");
  result = session_settle(run, result);
  if (result == LAVES_OK) result = report_parts_make(run, subject, &shapes, (size_t)run->given->whole, &parts);
  if (result == LAVES_OK) result = save(run, subject, &shapes, &parts, path, &outcome->bytes);
  progress_clear(&run->bar);
  outcome->whole = parts.whole;
  outcome->seconds = progress_now() - start;
  report_parts_free(&parts);
  report_shapes_free(&shapes);
  return result;
}

void report_say(const report_outcome *outcome, const char *path) {
  text_buffer bytes, seconds;
  text_say("wrote %s (%s, %s)%s", path, text_bytes(&bytes, outcome->bytes), text_seconds(&seconds, outcome->seconds),
           outcome->whole ? "" : ": the boundary, sections along the axes, and the worst tetrahedra");
}

void report_write_json(json *out, const report_outcome *outcome, const char *path) {
  if (outcome->bytes == 0) {
    json_text(out, "report", NULL);
    return;
  }
  json_open_object(out, "report");
  json_text(out, "path", path);
  json_number(out, "bytes", outcome->bytes);
  json_boolean(out, "whole", outcome->whole);
  json_close(out);
}
