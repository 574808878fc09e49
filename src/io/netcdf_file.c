/* Classic NetCDF files.
 *
 * A file is the header, then the numbers of each variable one behind another, all big-endian, each part filled up to a multiple
 * of four bytes. Places in the file have 64 bits (the form called CDF-2); lengths have 32, and where a variable has 4 GiB or
 * more, 64 as well (CDF-5). The header does not depend in length on the places that it names: it is gone through once to find its
 * length, and once to write it. Source: Unidata, "NetCDF classic format specification", NetCDF User's Guide, Appendix B. */
#include "io/netcdf_file.h"

#include <stdio.h>
#include <string.h>

#include "io/big_endian.h"

enum { TAG_DIMENSION = 10, TAG_VARIABLE = 11, TAG_ATTRIBUTE = 12, TYPE_FLOAT = 5, FILL = 4 };
static const uint64_t narrow_bytes_max = UINT32_MAX - FILL, narrow_length_max = INT32_MAX;

/* The header on its way: to the output, or only counted. */
typedef struct header {
  laves__output *out; /* NULL: counted */
  bool wide;          /* CDF-5 */
  uint64_t bytes;
} header;

void laves__netcdf_begin(laves__netcdf_file *file, laves__output *out) { *file = (laves__netcdf_file){.out = out}; }

static void make_name(char name[LAVES__NETCDF_NAME_MAX], const char *text, size_t number) {
  if (number > 0)
    snprintf(name, LAVES__NETCDF_NAME_MAX, "%s%zu", text, number);
  else
    snprintf(name, LAVES__NETCDF_NAME_MAX, "%s", text);
}

int laves__netcdf_add_dimension(laves__netcdf_file *file, const char *name, size_t number, uint64_t length) {
  if (file->out->error.result != LAVES_OK) return 0;
  if (!laves__grow(file->out->context, &file->dimensions, &file->dimension_capacity, file->dimension_count + 1,
                   sizeof *file->dimensions)) {
    laves__output_fail_memory(file->out);
    return 0;
  }
  laves__netcdf_dimension *d = &file->dimensions[file->dimension_count];
  make_name(d->name, name, number);
  d->length = length;
  return (int)file->dimension_count++;
}

void laves__netcdf_global(laves__netcdf_file *file, laves__netcdf_attribute attribute) {
  LAVES_ASSERT(file->attribute_count < LAVES__NETCDF_ATTRIBUTES_MAX);
  file->attributes[file->attribute_count++] = attribute;
}

void laves__netcdf_add_variable(laves__netcdf_file *file, const char *name, size_t number, laves__netcdf_type type, int first,
                                int second, laves__netcdf_attribute attribute, laves__output_items_fn *pack, const void *user) {
  if (file->out->error.result != LAVES_OK) return;
  if (!laves__grow(file->out->context, &file->variables, &file->variable_capacity, file->variable_count + 1,
                   sizeof *file->variables)) {
    laves__output_fail_memory(file->out);
    return;
  }
  laves__netcdf_variable *v = &file->variables[file->variable_count++];
  *v = (laves__netcdf_variable){.type = type,
                                .dimensions = {first, second},
                                .rank = second < 0 ? 1 : 2,
                                .attribute = attribute,
                                .pack = pack,
                                .user = user};
  make_name(v->name, name, number);
}

/* ---- sizes ---- */

static uint64_t filled(uint64_t bytes) { return (bytes + FILL - 1) / FILL * FILL; }

static size_t row_bytes(const laves__netcdf_file *file, const laves__netcdf_variable *v) {
  const size_t item = v->type == LAVES__NETCDF_CHAR ? 1 : v->type == LAVES__NETCDF_INT ? 4 : 8;
  return v->rank == 1 ? item : item * (size_t)file->dimensions[v->dimensions[1]].length;
}

static size_t rows(const laves__netcdf_file *file, const laves__netcdf_variable *v) {
  return (size_t)file->dimensions[v->dimensions[0]].length;
}

/* The bytes of a variable, or of one of its records. */
static uint64_t variable_bytes(const laves__netcdf_file *file, const laves__netcdf_variable *v) {
  return filled((v->pack ? (uint64_t)rows(file, v) : 1) * row_bytes(file, v));
}

static bool needs_wide(const laves__netcdf_file *file) {
  for (size_t i = 0; i < file->variable_count; i++)
    if (variable_bytes(file, &file->variables[i]) > narrow_bytes_max) return true;
  for (size_t i = 0; i < file->dimension_count; i++)
    if (file->dimensions[i].length > narrow_length_max) return true;
  return false;
}

/* ---- the header ---- */

static void put_bytes(header *h, const void *bytes, size_t count) {
  if (h->out) laves__output_bytes(h->out, bytes, count);
  h->bytes += count;
}

static void put32(header *h, uint32_t value) {
  char bytes[4];
  laves__put_big32(bytes, value);
  put_bytes(h, bytes, sizeof bytes);
}

static void put64(header *h, uint64_t value) {
  char bytes[8];
  laves__put_big64(bytes, value);
  put_bytes(h, bytes, sizeof bytes);
}

static void put_length(header *h, uint64_t value) {
  if (h->wide)
    put64(h, value);
  else
    put32(h, (uint32_t)value);
}

static void put_text(header *h, const char *text) {
  static const char zeros[FILL];
  const size_t length = strlen(text);
  put_length(h, length);
  put_bytes(h, text, length);
  put_bytes(h, zeros, filled(length) - length);
}

/* A list that is empty has no tag. */
static void put_list(header *h, uint32_t tag, size_t count) {
  put32(h, count ? tag : 0);
  put_length(h, count);
}

static void put_attribute(header *h, const laves__netcdf_attribute *a) {
  put_text(h, a->name);
  if (a->text) {
    put32(h, LAVES__NETCDF_CHAR);
    put_text(h, a->text); /* a count and so many bytes */
    return;
  }
  uint32_t bits = (uint32_t)a->integer;
  if (a->is_real) memcpy(&bits, &a->real, sizeof bits);
  put32(h, a->is_real ? TYPE_FLOAT : LAVES__NETCDF_INT);
  put_length(h, 1);
  put32(h, bits);
}

static void put_variable(header *h, const laves__netcdf_file *file, const laves__netcdf_variable *v) {
  put_text(h, v->name);
  put_length(h, (uint64_t)v->rank);
  for (int i = 0; i < v->rank; i++) put_length(h, (uint64_t)v->dimensions[i]);
  put_list(h, TAG_ATTRIBUTE, v->attribute.name != NULL);
  if (v->attribute.name) put_attribute(h, &v->attribute);
  put32(h, (uint32_t)v->type);
  put_length(h, variable_bytes(file, v));
  put64(h, v->place);
}

static void put_header(header *h, const laves__netcdf_file *file) {
  const char magic[4] = {'C', 'D', 'F', h->wide ? 5 : 2};
  put_bytes(h, magic, sizeof magic);
  put_length(h, 0); /* records */
  put_list(h, TAG_DIMENSION, file->dimension_count);
  for (size_t i = 0; i < file->dimension_count; i++) {
    put_text(h, file->dimensions[i].name);
    put_length(h, file->dimensions[i].length);
  }
  put_list(h, TAG_ATTRIBUTE, file->attribute_count);
  for (size_t i = 0; i < file->attribute_count; i++) put_attribute(h, &file->attributes[i]);
  put_list(h, TAG_VARIABLE, file->variable_count);
  for (size_t i = 0; i < file->variable_count; i++) put_variable(h, file, &file->variables[i]);
}

/* ---- the file ---- */

/* Returns where the last variable ends; variables of records come behind all others. */
static uint64_t place_variables(laves__netcdf_file *file, uint64_t place) {
  for (size_t i = 0; i < file->variable_count; i++) {
    laves__netcdf_variable *v = &file->variables[i];
    if (!v->pack) continue;
    v->place = place;
    place += variable_bytes(file, v);
  }
  for (size_t i = 0; i < file->variable_count; i++)
    if (!file->variables[i].pack) file->variables[i].place = place;
  return place;
}

static void write_variable(laves__netcdf_file *file, const laves__netcdf_variable *v) {
  static const char zeros[FILL];
  const uint64_t bytes = (uint64_t)rows(file, v) * row_bytes(file, v);
  laves__output_rows(file->out, rows(file, v), row_bytes(file, v), v->pack, v->user);
  laves__output_bytes(file->out, zeros, filled(bytes) - bytes);
}

void laves__netcdf_write(laves__netcdf_file *file) {
  laves__output *out = file->out;
  if (out->error.result == LAVES_OK) {
    header counted = {.wide = needs_wide(file)}, written = {.out = out, .wide = counted.wide};
    put_header(&counted, file);
    out->expected = (double)place_variables(file, counted.bytes);
    put_header(&written, file);
  }
  for (size_t i = 0; i < file->variable_count && out->error.result == LAVES_OK; i++)
    if (file->variables[i].pack) write_variable(file, &file->variables[i]);
  laves__free(out->context, file->dimensions, file->dimension_capacity, sizeof *file->dimensions);
  laves__free(out->context, file->variables, file->variable_capacity, sizeof *file->variables);
  *file = (laves__netcdf_file){.out = out};
}
