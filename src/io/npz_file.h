/* NumPy's .npz: an uncompressed ZIP archive of .npy files, one for each array. */
#ifndef LAVES_IO_NPZ_FILE_H
#define LAVES_IO_NPZ_FILE_H

#include "io/output.h"

typedef struct laves__npz_array {
  const char *name; /* without ".npy" */
  const char *type; /* NumPy's, such as "<f8" */
  size_t rows;
  int columns; /* 0: one dimension */
  size_t row_bytes;
  laves__output_items_fn *pack; /* writes rows; the same bytes whenever it is called, which is twice */
  const void *user;
  uint64_t place; /* the rest is laves__write_npz_arrays()'s own */
  uint32_t checksum;
} laves__npz_array;

enum { LAVES__NPZ_ARRAYS_MAX = 16 };
void laves__write_npz_arrays(laves__output *out, laves__npz_array *arrays, int count);

#endif
