/* A small JSON writer. */
#include "json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

json json_start(FILE *file) {
  json out = {.file = file};
  fputc('{', file);
  out.depth = 1;
  return out;
}

void json_finish(json *out) {
  while (out->depth > 0) json_close(out);
  fputc('\n', out->file);
}

static void new_line(const json *out) {
  fputc('\n', out->file);
  for (int i = 0; i < out->depth; ++i) fputs("  ", out->file);
}

/* Length of the UTF-8 sequence at `text`, 0 when it is none (RFC 3629: no overlong forms, no surrogates). */
static int sequence_length(const unsigned char *text) {
  const unsigned char lead = text[0];
  if (lead < 0x80) return 1;
  const int length = lead >= 0xc2 && lead <= 0xdf ? 2 : (lead & 0xf0) == 0xe0 ? 3 : lead >= 0xf0 && lead <= 0xf4 ? 4 : 0;
  for (int i = 1; i < length; ++i) {
    if ((text[i] & 0xc0) != 0x80) return 0;
  }
  if ((lead == 0xe0 && text[1] < 0xa0) || (lead == 0xed && text[1] > 0x9f)) return 0;
  if ((lead == 0xf0 && text[1] < 0x90) || (lead == 0xf4 && text[1] > 0x8f)) return 0;
  return length;
}

static void write_text(const json *out, const char *text) {
  FILE *file = out->file;
  fputc('"', file);
  for (const unsigned char *at = (const unsigned char *)text; *at;) {
    const int length = sequence_length(at);
    if (length == 0) {
      fputs("\\ufffd", file);
    } else if (*at == '"' || *at == '\\') {
      fprintf(file, "\\%c", *at);
    } else if (*at < 0x20 || *at == 0x7f || (*at == '<' && out->in_page)) {
      fprintf(file, "\\u%04x", *at);
    } else {
      fwrite(at, 1, (size_t)length, file);
    }
    at += length ? length : 1;
  }
  fputc('"', file);
}

static void begin_item(json *out, const char *key) {
  if (out->has_items) fputc(',', out->file);
  new_line(out);
  out->has_items = true;
  if (!key) return;
  write_text(out, key);
  fputs(": ", out->file);
}

static void open_level(json *out, const char *key, bool array) {
  begin_item(out, key);
  fputc(array ? '[' : '{', out->file);
  ++out->depth;
  out->has_items = false;
  out->arrays = array ? out->arrays | 1u << out->depth : out->arrays & ~(1u << out->depth);
}

void json_open_object(json *out, const char *key) { open_level(out, key, false); }

void json_open_array(json *out, const char *key) { open_level(out, key, true); }

void json_close(json *out) {
  const bool array = out->arrays >> out->depth & 1u;
  --out->depth;
  if (out->has_items) new_line(out);
  fputc(array ? ']' : '}', out->file);
  out->has_items = true;
}

void json_text(json *out, const char *key, const char *text) {
  begin_item(out, key);
  if (text) {
    write_text(out, text);
  } else {
    fputs("null", out->file);
  }
}

void json_boolean(json *out, const char *key, bool value) {
  begin_item(out, key);
  fputs(value ? "true" : "false", out->file);
}

void json_integer(json *out, const char *key, int64_t value) {
  begin_item(out, key);
  fprintf(out->file, "%lld", (long long)value);
}

/* The shortest of the three forms that reads back as the same number. */
static void write_number(FILE *file, double value) {
  if (!isfinite(value)) {
    fputs("null", file);
    return;
  }
  char text[40];
  for (int digits = 15; digits <= 17; ++digits) {
    snprintf(text, sizeof text, "%.*g", digits, value);
    if (strtod(text, NULL) == value) break;
  }
  fputs(text, file);
}

void json_number(json *out, const char *key, double value) {
  begin_item(out, key);
  write_number(out->file, value);
}

void json_numbers(json *out, const char *key, const double *values, size_t count) {
  begin_item(out, key);
  fputc('[', out->file);
  for (size_t i = 0; i < count; ++i) {
    if (i > 0) fputs(", ", out->file);
    write_number(out->file, values[i]);
  }
  fputc(']', out->file);
}
