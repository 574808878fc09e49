/* VTK's legacy files, text and binary: what their readers share.
 *
 * A file is a head of four lines, then sections that start with a word. Binary numbers are big-endian. Cells stand in one of two
 * ways: each with its count in front (up to version 4), or as offsets and connectivity (version 5); a laves__legacy_cells walks
 * either. What cells are comes behind them in unstructured grids, so their place is kept and they are read then. Sizes are never
 * believed: every number is looked for in the bytes of the file.
 * Source: VTK file formats, "Simple Legacy Formats", https://docs.vtk.org/en/latest/vtk_file_formats/index.html */
#ifndef LAVES_IO_LEGACY_VTK_H
#define LAVES_IO_LEGACY_VTK_H

#include "io/mesh_input.h"

typedef enum laves__legacy_kind {
  LAVES__LEGACY_INT8,
  LAVES__LEGACY_UINT8,
  LAVES__LEGACY_INT16,
  LAVES__LEGACY_UINT16,
  LAVES__LEGACY_INT32,
  LAVES__LEGACY_UINT32,
  LAVES__LEGACY_INT64,
  LAVES__LEGACY_UINT64,
  LAVES__LEGACY_FLOAT32,
  LAVES__LEGACY_FLOAT64,
  LAVES__LEGACY_KINDS
} laves__legacy_kind;

/* A row of numbers in the file. */
typedef struct laves__legacy_row {
  const char *at;
  laves__legacy_kind kind;
} laves__legacy_row;

typedef struct laves__legacy_cells {
  bool known;
  bool split; /* offsets and connectivity, else counts within connectivity */
  size_t count;
  laves__legacy_row offsets, connectivity;
  int64_t offset; /* of the cell that comes next, when split */
} laves__legacy_cells;

typedef struct laves__legacy {
  laves__mesh_input *input;
  laves__scan scan;
  bool binary;
  laves__legacy_cells grid; /* of an unstructured grid, until its types come */
} laves__legacy;

/* The next number of a row; false at its end. Unsigned ones beyond 2^63 become negative integers and are refused as indices. */
bool laves__legacy_integer(const laves__legacy *r, laves__legacy_row *numbers, int64_t *value);
bool laves__legacy_real(const laves__legacy *r, laves__legacy_row *numbers, double *value);
/* Moves behind `count` numbers of any kind. */
bool laves__legacy_skip(const laves__legacy *r, laves__legacy_row *numbers, size_t count);
/* LAVES_ERROR_INPUT: the file ends at `at`, where `what` should be. */
laves_result laves__legacy_fail_short(const laves__legacy *r, const char *at, const char *what, laves_error *error);

laves_result laves__legacy_read_kind(laves__legacy *r, laves__legacy_kind *kind, laves_error *error);
laves_result laves__legacy_read_count(laves__legacy *r, size_t *count, laves_error *error);
/* Numbers start behind the line that tells of them. */
laves__legacy_row laves__legacy_begin_row(laves__legacy *r, laves__legacy_kind kind);

/* Lines with the version, the title, ASCII or BINARY, and the kind of the data. */
laves_result laves__legacy_read_head(laves__legacy *r, laves_error *error);
laves_result laves__legacy_read_points(laves__legacy *r, laves_error *error);
/* The head of cells, in either form; the place moves behind them. */
laves_result laves__legacy_find_cells(laves__legacy *r, laves__legacy_cells *c, laves_error *error);
/* How many points the next cell has; they come next in c->connectivity. */
laves_result laves__legacy_begin_cell(const laves__legacy *r, laves__legacy_cells *c, int64_t *size, laves_error *error);
/* Passes over a FIELD, and over text until an empty line. */
laves_result laves__legacy_skip_field(laves__legacy *r, laves_error *error);
void laves__legacy_skip_metadata(laves__legacy *r);

#endif
