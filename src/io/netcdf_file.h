/* Classic NetCDF files, written by ourselves: dimensions, variables of fixed shape with a text or a number as attribute, global
 * attributes.
 *
 *   laves__netcdf_begin -> _global, _add_dimension, _add_variable ... -> _write
 *
 * The first failure sticks to the output, as everywhere. */
#ifndef LAVES_IO_NETCDF_FILE_H
#define LAVES_IO_NETCDF_FILE_H

#include "io/output.h"

typedef enum laves__netcdf_type { LAVES__NETCDF_CHAR = 2, LAVES__NETCDF_INT = 4, LAVES__NETCDF_DOUBLE = 6 } laves__netcdf_type;
enum { LAVES__NETCDF_NAME_MAX = 32, LAVES__NETCDF_ATTRIBUTES_MAX = 8 };

typedef struct laves__netcdf_dimension {
  char name[LAVES__NETCDF_NAME_MAX];
  uint64_t length; /* 0: of records, of which there are none */
} laves__netcdf_dimension;

/* A text, or an int, or a float. */
typedef struct laves__netcdf_attribute {
  const char *name; /* NULL: none */
  const char *text;
  int32_t integer;
  float real;
  bool is_real;
} laves__netcdf_attribute;

typedef struct laves__netcdf_variable {
  char name[LAVES__NETCDF_NAME_MAX];
  laves__netcdf_type type;
  int dimensions[2];
  int rank;
  laves__netcdf_attribute attribute;
  laves__output_items_fn *pack; /* rows, big-endian; NULL: of records, and no data */
  const void *user;
  uint64_t place;
} laves__netcdf_variable;

typedef struct laves__netcdf_file {
  laves__output *out;
  laves__netcdf_dimension *dimensions;
  laves__netcdf_variable *variables;
  size_t dimension_count, dimension_capacity, variable_count, variable_capacity;
  laves__netcdf_attribute attributes[LAVES__NETCDF_ATTRIBUTES_MAX];
  size_t attribute_count;
} laves__netcdf_file;

void laves__netcdf_begin(laves__netcdf_file *file, laves__output *out);
/* Returns its number. `number`, unless 0, is appended to the name: "num_el_in_blk" and 3. */
int laves__netcdf_add_dimension(laves__netcdf_file *file, const char *name, size_t number, uint64_t length);
void laves__netcdf_global(laves__netcdf_file *file, laves__netcdf_attribute attribute);
/* second: -1 for one dimension. `pack` writes rows, which are of the second dimension, from `user`. The names and texts of
 * attributes must outlive the file. */
void laves__netcdf_add_variable(laves__netcdf_file *file, const char *name, size_t number, laves__netcdf_type type, int first,
                                int second, laves__netcdf_attribute attribute, laves__output_items_fn *pack, const void *user);
/* Writes everything and frees the file's memory, which it does after a failure too. */
void laves__netcdf_write(laves__netcdf_file *file);

#endif
