/* The two kinds of backgrounds behind background.h: images, and trees of tets or points. */
#ifndef LAVES_SIZE_BACKGROUND_PARTS_H
#define LAVES_SIZE_BACKGROUND_PARTS_H

#include "io/image_input.h"
#include "io/mesh_input.h"

/* ---- images ---- */

typedef struct laves__background_image {
  laves__image_input samples; /* without the file's bytes */
  laves__mat3 to_index;       /* from a place relative to the origin to sample numbers */
} laves__background_image;

/* Takes the samples over from `input`. LAVES_ERROR_INPUT when the axes lie in one plane or a sample is no size. */
laves_result laves__background_image_make(laves__image_input *input, laves__background_image *image, laves_error *error);
double laves__background_image_at(const laves__background_image *image, laves__vec3 p);

/* ---- tets or points in a tree of boxes ---- */

typedef struct laves__background_node {
  laves__box3 box;
  uint32_t first; /* of the items of a leaf; of the two children of another node */
  uint32_t count; /* of items; 0: not a leaf */
} laves__background_node;

typedef struct laves__background_tree {
  laves_context *context;
  laves__vec3 *points;
  double *values; /* one for each point, or for each item */
  bool per_item;
  int corners;     /* of an item: 4 for tets, 1 for points */
  uint32_t *items; /* [item_count][corners], in the order of the leaves */
  size_t point_count, value_count, item_count;
  laves__background_node *nodes; /* the first is the root */
  size_t node_count, node_capacity;
} laves__background_tree;

/* Copies tets with their values, or, where there are none, points. The input is checked. */
laves_result laves__background_tree_make(const laves__mesh_input *input, laves__background_tree *tree, laves_error *error);
double laves__background_tree_at(const laves__background_tree *tree, laves__vec3 p);
void laves__background_tree_free(laves__background_tree *tree);

#endif
