/* HDF5 files, written by ourselves: groups, attributes, and arrays that lie in one piece each, without compression.
 *
 *   laves__hdf5_begin -> _group, _attribute, _array ... -> _write
 *
 * All that is told before the arrays' numbers is laid out in memory first, so every place in the file is known and the file is
 * written in one go, arrays by all threads. The first failure sticks to the output, as everywhere. */
#ifndef LAVES_IO_HDF5_FILE_H
#define LAVES_IO_HDF5_FILE_H

#include "io/output.h"

typedef enum laves__hdf5_type { LAVES__HDF5_FLOAT64, LAVES__HDF5_INT32, LAVES__HDF5_INT64, LAVES__HDF5_UINT8 } laves__hdf5_type;

typedef struct laves__hdf5_node laves__hdf5_node;

typedef struct laves__hdf5_file {
  laves__output *out;
  laves__hdf5_node *nodes; /* the root first, parents before their children */
  size_t count, capacity;
  char *header; /* all that stands before the arrays */
  size_t used, room;
} laves__hdf5_file;

enum { LAVES__HDF5_ROOT = 0 };

void laves__hdf5_begin(laves__hdf5_file *file, laves__output *out);
/* A group within another; returns its number. Names are copied; '/' in them becomes '_', as HDF5 has it for paths. */
size_t laves__hdf5_group(laves__hdf5_file *file, size_t parent, const char *name);
/* Attributes of a group: integers, `count` of 1 or 2, or a text of ASCII. At most two for each group. The text must outlive the
 * file. */
void laves__hdf5_integers(laves__hdf5_file *file, size_t group, const char *name, const int64_t *values, int count);
void laves__hdf5_text(laves__hdf5_file *file, size_t group, const char *name, const char *text);
/* An array of rows x columns (0: one dimension) whose rows are made by `pack`, with `user`, when the file is written. */
void laves__hdf5_array(laves__hdf5_file *file, size_t group, const char *name, laves__hdf5_type type, size_t rows, int columns,
                       laves__output_items_fn *pack, const void *user);
/* Writes everything and frees the file's memory, which it does after a failure too. */
void laves__hdf5_write(laves__hdf5_file *file);

#endif
