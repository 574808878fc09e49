/* HDF5 files.
 *
 * Of the format's many forms we write the plainest that is still read by every version of the library from 1.8 on: superblock 0,
 * object headers 1, groups whose links are messages in their header, arrays in one piece. A file is
 *
 *   superblock | object header of each group and array | numbers of each array, from multiples of 8 bytes on
 *
 * Headers do not depend in length on the places that they name, so they are laid out twice: first for their lengths, then with
 * the places. Source: The HDF Group, "HDF5 File Format Specification Version 3.0", sections II.A, III.B, IV.A.1.a and IV.A.2. */
#include "io/hdf5_file.h"

#include <stdio.h>
#include <string.h>

enum { NAME_BYTES = 112, ATTRIBUTES_MAX = 2, INTEGERS_MAX = 2, ALIGNMENT = 8 };
enum { MESSAGE_SPACE = 1, MESSAGE_LINK_INFO = 2, MESSAGE_TYPE = 3, MESSAGE_FILL = 5, MESSAGE_LINK = 6, MESSAGE_LAYOUT = 8 };
enum { MESSAGE_GROUP_INFO = 10, MESSAGE_ATTRIBUTE = 12 };
enum { SUPERBLOCK_BYTES = 96, HEADER_PREFIX_BYTES = 16 };
static const uint64_t nowhere = UINT64_MAX;
static const size_t type_bytes[] = {8, 4, 8, 1};

typedef struct attribute {
  const char *name, *text; /* text NULL: integers */
  int64_t integers[INTEGERS_MAX];
  int count;
} attribute;

struct laves__hdf5_node {
  char name[NAME_BYTES];
  size_t parent;
  bool is_array;
  attribute attributes[ATTRIBUTES_MAX];
  int attribute_count;
  laves__hdf5_type type;
  size_t rows;
  int columns;
  laves__output_items_fn *pack;
  const void *user;
  uint64_t header_place, data_place;
};

static size_t row_bytes(const laves__hdf5_node *n) { return type_bytes[n->type] * (size_t)(n->columns ? n->columns : 1); }
static uint64_t data_bytes(const laves__hdf5_node *n) { return (uint64_t)n->rows * row_bytes(n); }

/* ---- what the file holds ---- */

static size_t add(laves__hdf5_file *file, size_t parent, const char *name) {
  if (file->out->error.result != LAVES_OK) return LAVES__HDF5_ROOT;
  if (!laves__grow(file->out->context, &file->nodes, &file->capacity, file->count + 1, sizeof *file->nodes)) {
    laves__output_fail_memory(file->out);
    return LAVES__HDF5_ROOT;
  }
  laves__hdf5_node *n = &file->nodes[file->count];
  memset(n, 0, sizeof *n);
  n->parent = parent;
  snprintf(n->name, sizeof n->name, "%s", name);
  for (char *c = n->name; *c; c++)
    if (*c == '/') *c = '_';
  if (strcmp(n->name, ".") == 0) n->name[0] = '_';
  return file->count++;
}

void laves__hdf5_begin(laves__hdf5_file *file, laves__output *out) {
  *file = (laves__hdf5_file){.out = out};
  add(file, LAVES__HDF5_ROOT, "");
}

size_t laves__hdf5_group(laves__hdf5_file *file, size_t parent, const char *name) { return add(file, parent, name); }

static attribute *add_attribute(laves__hdf5_file *file, size_t group, const char *name) {
  if (file->out->error.result != LAVES_OK) return NULL;
  laves__hdf5_node *n = &file->nodes[group];
  LAVES_ASSERT(n->attribute_count < ATTRIBUTES_MAX);
  attribute *a = &n->attributes[n->attribute_count++];
  a->name = name;
  return a;
}

void laves__hdf5_integers(laves__hdf5_file *file, size_t group, const char *name, const int64_t *values, int count) {
  LAVES_ASSERT(count <= INTEGERS_MAX);
  attribute *a = add_attribute(file, group, name);
  if (!a) return;
  memcpy(a->integers, values, (size_t)count * sizeof *values);
  a->count = count;
}

void laves__hdf5_text(laves__hdf5_file *file, size_t group, const char *name, const char *text) {
  attribute *a = add_attribute(file, group, name);
  if (a) a->text = text;
}

void laves__hdf5_array(laves__hdf5_file *file, size_t group, const char *name, laves__hdf5_type type, size_t rows, int columns,
                       laves__output_items_fn *pack, const void *user) {
  const size_t i = add(file, group, name);
  if (i == LAVES__HDF5_ROOT) return;
  laves__hdf5_node *n = &file->nodes[i];
  n->is_array = true;
  n->type = type;
  n->rows = rows;
  n->columns = columns;
  n->pack = pack;
  n->user = user;
}

/* ---- bytes of the header ---- */

static void put_bytes(laves__hdf5_file *file, const void *bytes, size_t count) {
  if (file->out->error.result != LAVES_OK) return;
  if (!laves__grow(file->out->context, &file->header, &file->room, file->used + count, 1)) {
    laves__output_fail_memory(file->out);
    return;
  }
  if (bytes)
    memcpy(file->header + file->used, bytes, count);
  else
    memset(file->header + file->used, 0, count);
  file->used += count;
}

static void put(laves__hdf5_file *file, uint64_t value, size_t bytes) { put_bytes(file, &value, bytes); }
static void align(laves__hdf5_file *file) { put_bytes(file, NULL, (ALIGNMENT - file->used % ALIGNMENT) % ALIGNMENT); }
static size_t aligned(size_t bytes) { return (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT; }

/* Begins a message of `bytes`, which are followed by zeros up to the next multiple of 8. */
static void put_message(laves__hdf5_file *file, int kind, size_t bytes) {
  put(file, (uint64_t)kind, 2);
  put(file, aligned(bytes), 2);
  put(file, 0, 4); /* flags, reserved */
}

static size_t type_message_bytes(laves__hdf5_type type) { return type == LAVES__HDF5_FLOAT64 ? 20 : 12; }

static void put_type(laves__hdf5_file *file, laves__hdf5_type type) {
  enum { VERSION = 1 << 4, FIXED_POINT = 0, FLOATING_POINT = 1, SIGNED = 8 };
  const size_t bytes = type_bytes[type];
  if (type != LAVES__HDF5_FLOAT64) {
    put(file, VERSION | FIXED_POINT, 1);
    put(file, type == LAVES__HDF5_UINT8 ? 0 : SIGNED, 3);
    put(file, bytes, 4);
    put(file, 0, 2); /* offset of the bits */
    put(file, 8 * bytes, 2);
    return;
  }
  put(file, VERSION | FLOATING_POINT, 1);
  put(file, 0x3f20, 3); /* sign at bit 63, the mantissa's first bit implied, little-endian */
  put(file, bytes, 4);
  put(file, 0, 2);
  put(file, 64, 2);
  put(file, 52, 1); /* exponent at, its bits, mantissa at, its bits, bias */
  put(file, 11, 1);
  put(file, 0, 1);
  put(file, 52, 1);
  put(file, 1023, 4);
}

/* columns 0: one dimension; a single value has none. */
static void put_space(laves__hdf5_file *file, size_t rows, int columns, bool single) {
  put(file, 1, 1); /* version */
  put(file, single ? 0 : columns ? 2 : 1, 1);
  put(file, 0, 6);
  if (!single) put(file, rows, 8);
  if (!single && columns) put(file, (uint64_t)columns, 8);
}

static void put_attribute(laves__hdf5_file *file, const attribute *a) {
  enum { STRING = 1 << 4 | 3, STRING_BYTES = 8 };
  const size_t name = strlen(a->name) + 1, text = a->text ? strlen(a->text) : 0;
  const size_t type = a->text ? STRING_BYTES : type_message_bytes(LAVES__HDF5_INT64), space = a->text ? 8 : 16;
  const size_t data = a->text ? text : (size_t)a->count * 8;
  put_message(file, MESSAGE_ATTRIBUTE, 8 + aligned(name) + aligned(type) + space + data);
  put(file, 1, 2); /* version */
  put(file, name, 2);
  put(file, type, 2);
  put(file, space, 2);
  put_bytes(file, a->name, name);
  align(file);
  if (a->text) {
    put(file, STRING, 1);
    put(file, 0, 3); /* ASCII */
    put(file, text, 4);
  } else {
    put_type(file, LAVES__HDF5_INT64);
    align(file);
  }
  put_space(file, (size_t)a->count, 0, a->text != NULL);
  put_bytes(file, a->text ? (const void *)a->text : a->integers, data);
  align(file);
}

/* ---- object headers ---- */

static int put_group(laves__hdf5_file *file, size_t group) {
  enum { NAME_IS_UTF8 = 1 << 4, UTF8 = 1 };
  const laves__hdf5_node *n = &file->nodes[group];
  int messages = 2 + n->attribute_count;
  put_message(file, MESSAGE_LINK_INFO, 18);
  put(file, 0, 2);
  put(file, nowhere, 8); /* links are not elsewhere */
  put(file, nowhere, 8);
  align(file);
  put_message(file, MESSAGE_GROUP_INFO, 2);
  put(file, 0, 8);
  for (int i = 0; i < n->attribute_count; i++) put_attribute(file, &n->attributes[i]);
  for (size_t i = group + 1; i < file->count; i++) {
    const laves__hdf5_node *child = &file->nodes[i];
    if (child->parent != group) continue;
    const size_t name = strlen(child->name);
    put_message(file, MESSAGE_LINK, 4 + name + 8);
    put(file, 1, 1); /* version */
    put(file, NAME_IS_UTF8, 1);
    put(file, UTF8, 1);
    put(file, name, 1);
    put_bytes(file, child->name, name);
    put(file, child->header_place, 8);
    align(file);
    messages++;
  }
  return messages;
}

static int put_array(laves__hdf5_file *file, const laves__hdf5_node *n) {
  enum { FILL_VERSION = 2, ALLOCATED_EARLY = 1, WRITTEN_IF_SET = 2, LAYOUT_VERSION = 3, CONTIGUOUS = 1 };
  put_message(file, MESSAGE_SPACE, n->columns ? 24 : 16);
  put_space(file, n->rows, n->columns, false);
  put_message(file, MESSAGE_TYPE, type_message_bytes(n->type));
  put_type(file, n->type);
  align(file);
  put_message(file, MESSAGE_FILL, 4);
  put(file, FILL_VERSION, 1);
  put(file, ALLOCATED_EARLY, 1);
  put(file, WRITTEN_IF_SET, 1);
  put(file, 0, 1); /* none */
  align(file);
  put_message(file, MESSAGE_LAYOUT, 18);
  put(file, LAYOUT_VERSION, 1);
  put(file, CONTIGUOUS, 1);
  put(file, n->rows > 0 ? n->data_place : nowhere, 8);
  put(file, data_bytes(n), 8);
  align(file);
  return 4;
}

static void put_object(laves__hdf5_file *file, size_t i) {
  laves__hdf5_node *n = &file->nodes[i];
  n->header_place = file->used;
  put_bytes(file, NULL, HEADER_PREFIX_BYTES);
  const uint16_t messages = (uint16_t)(n->is_array ? put_array(file, n) : put_group(file, i));
  if (file->out->error.result != LAVES_OK) return;
  const uint32_t references = 1, bytes = (uint32_t)(file->used - n->header_place - HEADER_PREFIX_BYTES);
  char *prefix = file->header + n->header_place;
  prefix[0] = 1; /* version */
  memcpy(prefix + 2, &messages, 2);
  memcpy(prefix + 4, &references, 4);
  memcpy(prefix + 8, &bytes, 4);
}

static void put_superblock(laves__hdf5_file *file, uint64_t file_bytes) {
  put_bytes(file, "\211HDF\r\n\032\n", 8);
  put(file, 0, 5); /* versions */
  put(file, 8, 1); /* bytes of a place */
  put(file, 8, 1); /* and of a length */
  put(file, 0, 1);
  put(file, 4, 2); /* of groups in an older form, which there are none of */
  put(file, 16, 2);
  put(file, 0, 4);
  put(file, 0, 8); /* the file begins here */
  put(file, nowhere, 8);
  put(file, file_bytes, 8);
  put(file, nowhere, 8);
  put(file, 0, 8);
  put(file, SUPERBLOCK_BYTES, 8); /* the root's header */
  put_bytes(file, NULL, 24);
}

static void lay_out(laves__hdf5_file *file, uint64_t file_bytes) {
  file->used = 0;
  put_superblock(file, file_bytes);
  LAVES_ASSERT(file->out->error.result != LAVES_OK || file->used == SUPERBLOCK_BYTES);
  for (size_t i = 0; i < file->count; i++) put_object(file, i);
}

/* Puts the arrays one behind another and returns where the last ends. */
static uint64_t place_arrays(laves__hdf5_file *file) {
  uint64_t place = file->used;
  for (size_t i = 0; i < file->count; i++) {
    if (!file->nodes[i].is_array || file->nodes[i].rows == 0) continue;
    file->nodes[i].data_place = place;
    place += aligned(data_bytes(&file->nodes[i]));
  }
  return place;
}

void laves__hdf5_write(laves__hdf5_file *file) {
  laves__output *out = file->out;
  lay_out(file, 0);
  const uint64_t bytes = out->error.result == LAVES_OK ? place_arrays(file) : 0;
  lay_out(file, bytes);
  out->expected = (double)bytes;
  if (out->error.result == LAVES_OK) laves__output_bytes(out, file->header, file->used);
  for (size_t i = 0; i < file->count && out->error.result == LAVES_OK; i++) {
    const laves__hdf5_node *n = &file->nodes[i];
    static const char zeros[ALIGNMENT];
    if (!n->is_array || n->rows == 0) continue;
    laves__output_rows(out, n->rows, row_bytes(n), n->pack, n->user);
    laves__output_bytes(out, zeros, aligned(data_bytes(n)) - data_bytes(n));
  }
  laves__free(out->context, file->header, file->room, 1);
  laves__free(out->context, file->nodes, file->capacity, sizeof *file->nodes);
  *file = (laves__hdf5_file){.out = out};
}
