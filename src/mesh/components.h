/* Components of the boundary layer: what hangs together by tets. */
#ifndef LAVES_MESH_COMPONENTS_H
#define LAVES_MESH_COMPONENTS_H

#include "mesh/layer.h"

typedef struct laves__components {
  laves_context *context;
  size_t vertex_count, count;
  int32_t *of; /* [vertex_count] the component of each vertex, -1: it is in no tet */
} laves__components;

/* Numbered by their first vertices. False when memory is short; free it either way. */
bool laves__components_find(const laves__layer *layer, laves__components *c);
void laves__components_free(laves__components *c);

#endif
