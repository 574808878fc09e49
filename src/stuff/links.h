/* Look-ups that the tiling's table does not hold but stuffing needs all the time; filled once for each run. */
#ifndef LAVES_STUFF_LINKS_H
#define LAVES_STUFF_LINKS_H

#include "background/site.h"

typedef struct laves__links {
  uint8_t slot[LAVES__C15_TETS][4][4];                      /* corner j is neighbour slot[t][i][j] of corner i of tet t */
  uint8_t back[LAVES__C15_SITES][LAVES__C15_MAX_DEGREE];    /* a site is neighbour back[s][k] of its neighbour k */
  double length2[LAVES__C15_SITES][LAVES__C15_MAX_DEGREE];  /* squared length of the edge to neighbour k, in sizes */
  uint8_t link[LAVES__C15_SITES][LAVES__C15_MAX_STAR][3];   /* the other corners of a star's tet, as neighbours */
  uint8_t across[LAVES__C15_SITES][LAVES__C15_MAX_STAR][3]; /* the star's tet on the other side of the face without link[j] */
} laves__links;

void laves__links_fill(laves__links *links);

#endif
