/* The graded background: an explicit mesh of tetrahedra of varying size.
 *
 * It stands in the place of the tiling: laves__lattice.graph points to it, and records hold what is known of its vertices,
 * 24 to a record as they come, so that vertex v is site v % 24 of record v / 24. What the table tells of the tiling
 * (neighbours, stars, corners), the lists here tell of the graph; background/site.h asks either.
 *
 * Every tetrahedron that may touch the solid is there, with at least one more all around; the outermost vertices are the
 * *hull*: they count as outside whatever the oracle says, and never go ON. */
#ifndef LAVES_BACKGROUND_GRAPH_H
#define LAVES_BACKGROUND_GRAPH_H

#include "base/base.h"
#include "base/vec3.h"

/* Where a tetrahedron comes from: a tile of C15 or of BCC as it is, or a transition between sizes. */
typedef enum laves__tile { LAVES__TILE_OTHER, LAVES__TILE_C15, LAVES__TILE_BCC } laves__tile;

/* What the stages know of a tetrahedron; see laves__record for what each means. */
typedef enum laves__tet_flag {
  LAVES__TET_SOLID = 1,
  LAVES__TET_ELIGIBLE = 2,
  LAVES__TET_STAMPED = 4,
  LAVES__TET_LAYER = 8,
} laves__tet_flag;

/* More tets than this around one vertex are refused by whoever makes them: stars are masks of 64 bits. */
enum { LAVES__STAR_LIMIT = 60, LAVES__LINK_LIMIT = 32 };

typedef struct laves__graph {
  laves_context *context;
  size_t vertex_count, tet_count;
  laves__vec3 *position; /* [vertex_count] lattice coordinates */
  float *scale;          /* [vertex_count] the mean length of the edges around it, in sizes */
  bool *hull;            /* [vertex_count] see above */
  int32_t (*tet)[4];     /* [tet_count] all positive */
  uint8_t *tile;         /* [tet_count] laves__tile */

  /* Made by laves__graph_link(). */
  uint32_t *star_first; /* [vertex_count + 1] */
  int32_t *star;        /* tets around each vertex, ascending */
  uint32_t *link_first; /* [vertex_count + 1] */
  int32_t *link;        /* vertices around each vertex, ascending */
  uint8_t *flags;       /* [tet_count] laves__tet_flag, which records hold as bits for the tiling */
} laves__graph;

/* The lists; LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__graph_link(laves__graph *graph, laves_error *error);
void laves__graph_free(laves__graph *graph);

#endif
