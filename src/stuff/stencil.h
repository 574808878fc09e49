/* How a background tetrahedron is cut: the stencil table. See stencil.c for the drawings. */
#ifndef LAVES_STUFF_STENCIL_H
#define LAVES_STUFF_STENCIL_H

#include "background/lattice.h"
#include "stuff/rule.h"

/* Corner codes of the pieces: 0..3 the corner itself, LAVES__CUT(i, o) the cut on the edge from corner i (IN) to o (OUT). */
#define LAVES__CUT(i, o) (4 + 4 * (i) + (o))
enum { LAVES__PIECES_MAX = 3, LAVES__CODES = 20 };

/* A table entry: pieces of a tet whose corners are sorted, all positive when the sorting is an even permutation. */
typedef struct laves__stencil {
  int8_t count;
  uint8_t piece[LAVES__PIECES_MAX][4];
} laves__stencil;

typedef enum laves__stencil_case {
  LAVES__STENCIL_WHOLE, /* no corner OUT */
  LAVES__STENCIL_ISSO,
  LAVES__STENCIL_ISOO,
  LAVES__STENCIL_IOOO,
  LAVES__STENCIL_IISO,
  LAVES__STENCIL_IIIO,
  LAVES__STENCIL_IIOO, /* and two more, for the diagonals that are possible; see stencil.c */
  LAVES__STENCIL_IIOO_OTHER,
  LAVES__STENCIL_IIOO_CROSSED,
  LAVES__STENCIL_CASES
} laves__stencil_case;

extern const laves__stencil laves__stencils[LAVES__STENCIL_CASES];

/* A background tet as stuffing sees it. Lengths in any unit. */
typedef struct laves__cut_tet {
  int8_t label[4];         /* laves__label; at least one IN */
  uint32_t id[4];          /* of the sites, all different: decides between equals */
  laves__vec3 position[4]; /* of the sites, ON ones displaced */
  double length2[4][4];    /* square of the undisturbed length of the edge from i to o */
  double fraction[4][4];   /* of the edge from i (IN) to o (OUT): where it is cut, from i */
} laves__cut_tet;

/* Where the cut on the edge from i to o is. */
laves__vec3 laves__cut_position(const laves__cut_tet *tet, int i, int o);
/* The point of a corner code. */
laves__vec3 laves__code_position(const laves__cut_tet *tet, int code);

/* What orders the inner corners of a face with one outer corner o: the power of o with respect to the circle through the
 * inner corner and the cuts, |o i| |o cut|. The diagonal of the face's quad starts at the inner corner with the lesser key;
 * that is the planar Delaunay diagonal, the same from both sides, and never cyclic. */
double laves__diagonal_key(const laves__cut_tet *tet, int i, int o);

/* Corners in the order IN by key, ON, OUT (equals by id) and the case. `order` has the corner at each place; the result's
 * IIOO cases leave the free diagonal open: both LAVES__STENCIL_IIOO and _OTHER fit when LAVES__STENCIL_IIOO is returned. */
laves__stencil_case laves__stencil_sort(const laves__cut_tet *tet, uint8_t order[4]);

/* The pieces of one case in terms of the tet's own corners, all positive. Returns how many. */
int laves__stencil_apply(laves__stencil_case which, const uint8_t order[4], uint8_t pieces[LAVES__PIECES_MAX][4]);

/* The pieces of a tet. Where the diagonal on the surface is free, the one with the larger margin. Returns how many. */
int laves__stencil_cut(const laves__guarantee *guarantee, const laves__cut_tet *tet, uint8_t pieces[LAVES__PIECES_MAX][4]);

#endif
