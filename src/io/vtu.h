/* The structure of VTK's XML files: which arrays a file has and where their data stands, before any of it is decoded. */
#ifndef LAVES_IO_VTU_H
#define LAVES_IO_VTU_H

#include "io/mesh_input.h"

/* How many bytes of numbers one byte of the file can hold: the limit of deflate; 8 for text ("1 " may be an Int64, and
 * there must be room left for rounding) and for plain bytes. */
enum { LAVES__VTU_COMPRESSED_LIMIT = 1032, LAVES__VTU_PLAIN_LIMIT = 8 };

typedef enum laves__vtu_kind {
  LAVES__VTU_INT8,
  LAVES__VTU_UINT8,
  LAVES__VTU_INT16,
  LAVES__VTU_UINT16,
  LAVES__VTU_INT32,
  LAVES__VTU_UINT32,
  LAVES__VTU_INT64,
  LAVES__VTU_UINT64,
  LAVES__VTU_FLOAT32,
  LAVES__VTU_FLOAT64,
  LAVES__VTU_KIND_COUNT
} laves__vtu_kind;
typedef struct laves__vtu_kind_info {
  const char *name;
  size_t bytes;
} laves__vtu_kind_info;
extern const laves__vtu_kind_info laves__vtu_kinds[LAVES__VTU_KIND_COUNT];

typedef enum laves__vtu_place {
  LAVES__VTU_ABSENT,
  LAVES__VTU_INLINE_TEXT,
  LAVES__VTU_INLINE_BASE64,
  LAVES__VTU_APPENDED
} laves__vtu_place;

/* Where an array's data is, as the XML says. */
typedef struct laves__vtu_source {
  laves__vtu_place place;
  laves__vtu_kind kind;
  size_t offset;           /* of appended data */
  const char *begin, *end; /* of inline data */
} laves__vtu_source;

/* The last four are those of polygon files. */
enum {
  LAVES__VTU_POINTS,
  LAVES__VTU_CONNECTIVITY,
  LAVES__VTU_OFFSETS,
  LAVES__VTU_TYPES,
  LAVES__VTU_REGION,
  LAVES__VTU_VALUES,
  LAVES__VTU_VERT_CONNECTIVITY,
  LAVES__VTU_VERT_OFFSETS,
  LAVES__VTU_LINE_CONNECTIVITY,
  LAVES__VTU_LINE_OFFSETS,
  LAVES__VTU_ARRAY_COUNT
};
extern const char *const laves__vtu_array_names[LAVES__VTU_ARRAY_COUNT];

typedef struct laves__vtu_piece {
  size_t point_count, cell_count; /* polygon files: of vertices and lines in the place of cells */
  size_t vert_count, line_count;
  laves__vtu_source sources[LAVES__VTU_ARRAY_COUNT];
} laves__vtu_piece;

/* An array that may be the one with the wanted values: one number for each point or cell. */
typedef struct laves__vtu_candidate {
  bool per_cell;
  size_t piece;
  laves__vtu_source source;
} laves__vtu_candidate;

typedef struct laves__vtu {
  laves__mesh_input *input;
  bool polygons; /* PolyData */
  bool wide_header, compressed;
  bool appended_base64;
  const char *appended; /* first byte behind the '_'; NULL: none */
  double decoded;       /* bytes of all arrays so far; pieces may share data, so each alone tells too little */
  laves__vtu_piece *pieces;
  size_t piece_count, piece_capacity;
  laves__vtu_candidate *candidates;
  laves__word *candidate_names;
  size_t candidate_count, candidate_capacity, candidate_name_capacity;
} laves__vtu;

/* Whether a file is one of these, by how it begins. Whoever reads them asks here, so that all take the same files. */
bool laves__is_vtu(const laves__mesh_input *input);

/* Walks the XML from the input's begin to its end, or to the appended data, and fills all but `decoded`. The input's `lines` and
 * `values` say what else than tets and triangles is wanted. Free with laves__vtu_free(), also after a failure. */
laves_result laves__vtu_read_structure(laves__vtu *r, laves_error *error);
void laves__vtu_free(laves__vtu *r);

/* LAVES_ERROR_INPUT: the data of an array is not what the XML announces. */
laves_result laves__vtu_fail_array(const laves__vtu *r, const char *name, laves_error *error);
/* Offsets, corners and types of a piece must be integers. */
laves_result laves__vtu_check_integers(const laves__vtu *r, const laves__vtu_piece *p, laves_error *error);

/* Corners of a tetrahedron or triangle of any order, which come first in a cell: 4 or 3; 0: another shape. */
int laves__vtu_corner_count(int64_t type);

/* A number of an integer kind; of UInt64 beyond 2^63 it is negative. */
int64_t laves__vtu_integer(laves__vtu_kind kind, const char *at);
/* A number of any kind. */
double laves__vtu_real(laves__vtu_kind kind, const char *at);

/* Whether programs give this name to the material of a cell. */
bool laves__vtu_is_region_name(laves__word name);

#endif
