/* The tets that a pass works on, in the blocks of space in which it does. */
#ifndef LAVES_IMPROVE_PATIENTS_H
#define LAVES_IMPROVE_PATIENTS_H

#include "improve/blocks.h"

/* A bad tet and the block of space in which it is worked on; blocks of a level are 2^level times as large. */
typedef struct laves__patient {
  int32_t level, colour, block[3];
  int32_t tet;
  double quality;
} laves__patient;

/* Which tets are bad. */
typedef struct laves__admission {
  double below;        /* the quality from which on they are not */
  bool thin;           /* tets that span a wall are good enough a little earlier */
  const uint8_t *near; /* [tet_count] which tets are meant; NULL: all */
  const int32_t *list; /* [list_count] the tets that are looked at, ascending; NULL: all */
  size_t list_count;
} laves__admission;

typedef struct laves__patients {
  laves__patient *item; /* by level, then colour, then block, then quality */
  size_t count, capacity;
  size_t bad;    /* those that are listed, and those that stand still in this turn of given blocks */
  size_t *block; /* first item of each block, and the end */
  size_t block_count, block_capacity;
} laves__patients;

bool laves__is_bad(const laves__layer *layer, const laves__admission *admission, int32_t tet);
/* How many tets are. */
size_t laves__count_bad(const laves__layer *layer, const laves__admission *admission);
/* Whether a tet is the whole of a wall: all its corners are on the surface, none of them at a crease. */
bool laves__spans_wall(const laves__layer *layer, int32_t tet);
/* The bad tets of the layer, in order, and where their blocks begin: of space, or those of a given mesh (NULL: none is given).
 * False when memory is short. After a cancel there are none. */
bool laves__patients_list(const laves__layer *layer, const laves__admission *admission, const laves__blocks *given,
                          laves__patients *patients);
void laves__patients_free(laves_context *context, laves__patients *patients);

static inline bool laves__same_colour(const laves__patient *a, const laves__patient *b) {
  return a->level == b->level && a->colour == b->colour;
}

#endif
