/* The boundary triangles of the layer. */
#ifndef LAVES_FEATURES_RIM_H
#define LAVES_FEATURES_RIM_H

#include "mesh/layer.h"

typedef struct laves__rim {
  laves_context *context;
  int32_t (*face)[3]; /* [face_count] vertices of the layer, counter-clockwise from outside */
  size_t face_count, face_capacity;
  uint32_t *first; /* the faces at each vertex: at[first[v] .. first[v + 1]) */
  uint32_t *at;
  size_t vertex_count;
} laves__rim;

/* Free whatever is returned. LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__rim_make(const laves__layer *layer, laves__rim *rim, laves_error *error);
void laves__rim_free(laves__rim *rim);

/* The vertex after, and the one before, a vertex of a face. */
static inline int32_t laves__rim_next(const laves__rim *rim, uint32_t face, int32_t vertex) {
  const int32_t *f = rim->face[face];
  return f[0] == vertex ? f[1] : f[1] == vertex ? f[2] : f[0];
}
static inline int32_t laves__rim_previous(const laves__rim *rim, uint32_t face, int32_t vertex) {
  const int32_t *f = rim->face[face];
  return f[0] == vertex ? f[2] : f[1] == vertex ? f[0] : f[1];
}

#endif
