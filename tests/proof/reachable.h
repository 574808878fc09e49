/* Every way in which a background tet can meet the surface. */
#ifndef LAVES_TESTS_PROOF_REACHABLE_H
#define LAVES_TESTS_PROOF_REACHABLE_H

#include "stuff/stencil.h"

/* Ranges are rounded outward to multiples of GRID, and halved down to multiples of FINE_GRID. Coordinates are multiples of
 * FINE_GRID then, and their differences within a tet less than 8, so that a difference is an integer below 2^26 times
 * FINE_GRID, and products of two, and sums of two products, are exact in double. */
#define GRID 0x1p-16
#define FINE_GRID 0x1p-23

typedef struct range {
  double low, high;
} range;

/* A box of configurations of one background tet: each of its parameters is anywhere in its range. Quarter units. */
typedef struct configuration {
  int tet;
  int8_t label[4];
  bool was_outer[4];    /* ON corners: what they were before they snapped */
  laves__vec3 site[4];  /* integers */
  laves__vec3 along[4]; /* ON corners: the edge they move along, integers */
  range share[4];       /* ON corners: of `along` */
  range fraction[4][4]; /* [inner][outer]: of the cut */
  double length2[4][4];
} configuration;

/* Calls visit for every configuration of the tet with a corner IN, but not with all, until one call returns false. Returns
 * whether none did. */
typedef bool (*visit_configuration)(const configuration *c, void *user);
bool visit_reachable(const laves__guarantee *guarantee, int tet, visit_configuration visit, void *user);
/* The same for every configuration, also of tets that are dropped. */
bool visit_all(const laves__guarantee *guarantee, int tet, visit_configuration visit, void *user);

/* Largest alpha; the rule needs less than 1/2, so that a crossing violates one end at most. */
double largest_alpha(const laves__thresholds *thresholds);

/* What the mesher would be given at one point of the box: bit k of `corner` says which end of the k-th range. */
laves__cut_tet cut_tet_at(const configuration *c, unsigned corner);
/* How many ranges the box has, at most 4. */
int range_count(const configuration *c);

#endif
