/* Writes a certificate as JSON, from the table of its members. */
#include <math.h>
#include <string.h>

#include "base/utf8.h"
#include "io/certificate_table.h"
#include "io/number_text.h"
#include "io/output.h"

typedef struct writer {
  laves__output out;
  bool comma; /* something stands before in the object or array */
} writer;

static void begin_item(writer *w, const char *indent, const char *key) {
  laves__output_printf(&w->out, "%s\n%s", w->comma ? "," : "", indent);
  if (key) laves__output_printf(&w->out, "\"%s\": ", key);
  w->comma = true;
}

/* What is no UTF-8 becomes the replacement character. */
static void put_text(writer *w, const char *text) {
  laves__output_bytes(&w->out, "\"", 1);
  for (const unsigned char *at = (const unsigned char *)text; *at;) {
    const size_t length = laves__utf8_length(at);
    if (length == 0)
      laves__output_printf(&w->out, "\\ufffd");
    else if (*at < 0x20 || *at == 0x7f)
      laves__output_printf(&w->out, "\\u%04x", *at);
    else if (*at == '"' || *at == '\\')
      laves__output_printf(&w->out, "\\%c", *at);
    else
      laves__output_bytes(&w->out, at, length);
    at += length ? length : 1;
  }
  laves__output_bytes(&w->out, "\"", 1);
}

static void put_number(writer *w, double value) {
  char text[LAVES__DOUBLE_TEXT_MAX];
  if (!isfinite(value))
    laves__output_bytes(&w->out, "null", 4);
  else
    laves__output_bytes(&w->out, text, (size_t)(laves__put_double(text, value) - text));
}

static void put_numbers(writer *w, const double *values, size_t count) {
  if (count > 1) laves__output_bytes(&w->out, "[", 1);
  for (size_t i = 0; i < count; i++) {
    if (i > 0) laves__output_bytes(&w->out, ", ", 2);
    put_number(w, values[i]);
  }
  if (count > 1) laves__output_bytes(&w->out, "]", 1);
}

static void put_counts(writer *w, const size_t *values, size_t count) {
  if (count > 1) laves__output_bytes(&w->out, "[", 1);
  for (size_t i = 0; i < count; i++) laves__output_printf(&w->out, "%s%zu", i > 0 ? ", " : "", values[i]);
  if (count > 1) laves__output_bytes(&w->out, "]", 1);
}

static void put_member(writer *w, const laves_certificate *certificate, const laves__member *member) {
  const void *at = (const char *)certificate + member->offset;
  begin_item(w, "    ", member->name);
  switch (member->kind) {
    case LAVES__MEMBER_TEXT:
      if (*(const char *)at)
        put_text(w, at);
      else
        laves__output_bytes(&w->out, "null", 4);
      break;
    case LAVES__MEMBER_COUNT:
      put_counts(w, at, member->count);
      break;
    case LAVES__MEMBER_LATER:
      if (*(const size_t *)at == SIZE_MAX)
        laves__output_bytes(&w->out, "null", 4);
      else
        put_counts(w, at, 1);
      break;
    case LAVES__MEMBER_INTEGER:
      laves__output_printf(&w->out, "%lld", (long long)*(const int64_t *)at);
      break;
    case LAVES__MEMBER_NUMBER:
    case LAVES__MEMBER_LATER_NUMBER:
      put_numbers(w, at, member->count);
      break;
    case LAVES__MEMBER_FLAG:
    case LAVES__MEMBER_LATER_FLAG:
      laves__output_printf(&w->out, "%s", *(const bool *)at ? "true" : "false");
      break;
    case LAVES__MEMBER_ALIGN:
      put_text(w, laves__align_names[*(const laves_align *)at]);
      break;
    case LAVES__MEMBER_METHOD:
      put_text(w, laves__method_names[*(const laves_method *)at]);
      break;
  }
}

static void put_group(writer *w, const laves_certificate *certificate, const laves__member_group *group) {
  begin_item(w, "  ", group->name);
  if (group->flag && !*((const bool *)((const char *)certificate + group->flag))) {
    laves__output_bytes(&w->out, "null", 4);
    return;
  }
  laves__output_bytes(&w->out, "{", 1);
  w->comma = false;
  for (size_t i = 0; i < laves__certificate_member_count; i++)
    if (strcmp(laves__certificate_members[i].group, group->name) == 0) put_member(w, certificate, &laves__certificate_members[i]);
  laves__output_printf(&w->out, "\n  }");
  w->comma = true;
}

static void put_exception(writer *w, const laves_exception *e) {
  begin_item(w, "      ", NULL);
  laves__output_printf(&w->out, "{\"kind\": \"%s\", \"cause\": \"%s\", \"place\": ", laves_exception_key(e->kind),
                       laves_cause_key(e->cause));
  put_numbers(w, e->place, 3);
  laves__output_printf(&w->out, ", \"value\": ");
  put_number(w, e->value);
  laves__output_printf(&w->out, ", \"limit\": ");
  put_number(w, e->limit);
  laves__output_printf(&w->out, ", \"index\": %lld, \"curvature_radius\": ", (long long)e->index);
  put_number(w, e->curvature_radius);
  laves__output_printf(&w->out, ", \"crease_angle\": ");
  put_number(w, e->crease_angle);
  laves__output_bytes(&w->out, "}", 1);
}

/* The words that make the mesh again, or null. */
static void put_command(writer *w, const laves_certificate *certificate) {
  begin_item(w, "  ", "command");
  laves__output_bytes(&w->out, certificate->command_count > 0 ? "[" : "null", certificate->command_count > 0 ? 1 : 4);
  const char *word = certificate->command;
  for (int i = 0; i < certificate->command_count; i++) {
    if (i > 0) laves__output_bytes(&w->out, ", ", 2);
    put_text(w, word);
    word += strlen(word) + 1;
  }
  if (certificate->command_count > 0) laves__output_bytes(&w->out, "]", 1);
}

static void put_exceptions(writer *w, const laves_certificate *certificate) {
  begin_item(w, "  ", "exceptions");
  laves__output_printf(&w->out, "{\n    \"counts\": {");
  w->comma = false;
  for (int i = 0; i < LAVES_EXCEPTION_COUNT; i++) {
    begin_item(w, "      ", laves_exception_key((laves_exception_kind)i));
    laves__output_printf(&w->out, "%zu", certificate->exception_counts[i]);
  }
  laves__output_printf(&w->out, "\n    },\n    \"listed\": [");
  w->comma = false;
  for (size_t i = 0; i < certificate->exception_count; i++) put_exception(w, &certificate->exceptions[i]);
  laves__output_printf(&w->out, "%s]\n  }", certificate->exception_count ? "\n    " : "");
  w->comma = true;
}

static void put_all(writer *w, const laves_certificate *certificate) {
  laves__output_bytes(&w->out, "{", 1);
  begin_item(w, "  ", "certificate");
  put_text(w, "laves");
  begin_item(w, "  ", "schema");
  laves__output_printf(&w->out, "%d", LAVES__CERTIFICATE_SCHEMA);
  begin_item(w, "  ", "version");
  put_text(w, certificate->version);
  for (size_t i = 0; i < laves__certificate_group_count; i++) put_group(w, certificate, &laves__certificate_groups[i]);
  put_command(w, certificate);
  put_exceptions(w, certificate);
  laves__output_bytes(&w->out, "\n}\n", 3);
}

laves_result laves_certificate_write(laves_context *context, const laves_certificate *certificate, const char *path,
                                     laves_error *error) {
  writer w = {0};
  laves__progress_reset(context);
  if (laves__output_open(&w.out, context, path) == LAVES_OK) {
    put_all(&w, certificate);
    if (laves__output_complete(&w.out) == LAVES_OK) laves__output_publish(&w.out);
  }
  const laves_result result = w.out.error.result;
  laves__output_discard(&w.out);
  return result == LAVES_OK ? LAVES_OK : laves__fail(error, result, "%s", w.out.error.text);
}
