/* The octree of a size field: cubes whose side follows the wished size, balanced two to one.
 *
 * Coordinates are integers from the root's lower corner, so that nothing about neighbours is ever decided by rounding. The
 * unit is a quarter of the smallest cube that the field may ask for: a cube of side 4 is the smallest leaf, and all sites of
 * its lattices (corners, centre, midpoints of bonds) have whole coordinates. The root lies so that leaves whose size is the
 * asked one make the very lattice of the uniform tiling: eight of them are one period.
 *
 * A leaf is *outside* when it, widened by one and a half of its sides, holds nothing of the solid; nothing is made there. */
#ifndef LAVES_GRADED_OCTREE_H
#define LAVES_GRADED_OCTREE_H

#include "domain/frame.h"

/* What is wished, in lattice coordinates and sizes. */
typedef struct laves__demand {
  const void *self;
  /* The wished size at each point, positive; any count, from many threads. */
  void (*evaluate)(const void *self, size_t count, const laves__vec3 *points, double *sizes);
  const laves__vec3 *sample; /* places with a wish of their own */
  const double *sample_size;
  size_t sample_count;
  double grading;           /* largest gradient of the size */
  double smallest, largest; /* bounds of all wishes */
} laves__demand;

typedef struct laves__node {
  int32_t at[3]; /* lower corner */
  int32_t side;  /* 4 times a power of two */
  int32_t child; /* first of eight, x fastest; -1: a leaf */
  int32_t order; /* of leaves that are not outside: place in the list */
  float size;    /* wished at the centre, never steeper than the grading */
  bool outside;
  bool even; /* of leaves: those on its faces are as large, those at its edges not smaller */
} laves__node;

typedef struct laves__octree {
  laves_context *context;
  laves__vec3 lower; /* of the root, lattice coordinates */
  double unit;       /* in sizes */
  laves__node *node;
  size_t node_count, node_capacity;
  int32_t *leaf; /* [leaf_count] the leaves that are not outside, along the Morton curve */
  size_t leaf_count;
} laves__octree;

/* Bytes at the peak of making a mesh from so many leaves, by measurement: what the octree takes is in it. */
double laves__graded_bytes(size_t leaves);

/* LAVES_ERROR_OPTION when the field asks for more than can be indexed; LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__octree_build(const laves__frame *frame, const laves__demand *demand, laves_context *context,
                                 laves__octree *tree, laves_error *error);
void laves__octree_free(laves__octree *tree);

/* The leaf that holds a point (its lower faces belong to it), or -1 beyond the root. */
int32_t laves__octree_locate(const laves__octree *tree, int32_t x, int32_t y, int32_t z);

/* The wished size at a point of the lattice, in sizes; 0 where nothing of the solid is near. *halving: the largest wish for
 * which the leaf there would be halved. */
double laves__octree_size(const laves__octree *tree, laves__vec3 point, double *halving);

static inline laves__vec3 laves__octree_point(const laves__octree *tree, double x, double y, double z) {
  return v3(tree->lower.x + x * tree->unit, tree->lower.y + y * tree->unit, tree->lower.z + z * tree->unit);
}

#endif
