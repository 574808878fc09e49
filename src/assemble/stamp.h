/* Points and tets of the tiling's part of a mesh, in ranges, from the labelled lattice.
 *
 * Vertices and tets are in the order of the bricks, which the directory's order is, and in a brick in that of its cells. What
 * comes before a brick is summed up once; with it any range can be made alone, whoever asks and in whatever order, and always has
 * the same bytes: a mesh in memory is the range of all. */
#ifndef LAVES_ASSEMBLE_STAMP_H
#define LAVES_ASSEMBLE_STAMP_H

#include "background/lattice.h"

/* How many vertices and tets come before a brick. */
typedef struct laves__brick_base {
  int64_t vertex, tet;
} laves__brick_base;

/* What stamping reads. Only `base` and `first` are filled here. */
typedef struct laves__stamps {
  const laves__lattice *lattice;
  laves__frame frame;        /* only to place sites: the oracle and the features are not asked */
  const uint32_t *mask;      /* [record_count] kept sites */
  int32_t *first;            /* [record_count] number of the first of them */
  const laves__vec3 *placed; /* where the vertices of the boundary layer stand, in the input's coordinates */
  laves__brick_base *base;   /* [directory_count + 1] the last: how many there are */
} laves__stamps;

/* The cell `inside` of the brick in a directory slot: LAVES__OUT, LAVES__IN or a record. */
static inline int32_t laves__brick_cell(const laves__lattice *l, size_t slot, int inside) {
  const int32_t entry = l->directory[slot];
  return entry < 0 ? entry : l->brick[entry].cell[inside];
}

static inline int laves__stamped_count(const laves__record *r) {
  return __builtin_popcountll(r->stamped[0]) + __builtin_popcountll(r->stamped[1]) + __builtin_popcountll(r->stamped[2]);
}

/* Sums up what comes before each brick, and numbers the vertices of the records. LAVES_ERROR_CANCELLED. */
laves_result laves__stamps_count(const laves__stamps *s, laves_error *error);

/* The brick that vertex or tet `i` is of. */
size_t laves__stamps_vertex_brick(const laves__stamps *s, size_t i);
size_t laves__stamps_tet_brick(const laves__stamps *s, size_t i);

/* Vertices, or tets, [begin, end) of those of a brick, of which some may lie before or behind it: whichever of the range are its.
 * The first of the range goes to out[0]. */
void laves__stamp_points(const laves__stamps *s, size_t brick, size_t begin, size_t end, laves__vec3 *out);
void laves__stamp_tets(const laves__stamps *s, size_t brick, size_t begin, size_t end, int32_t (*out)[4]);

#endif
