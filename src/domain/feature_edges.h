/* Which edges of a triangle surface are creases. */
#ifndef LAVES_DOMAIN_FEATURE_EDGES_H
#define LAVES_DOMAIN_FEATURE_EDGES_H

#include "domain/features.h"
#include "domain/surface.h"

typedef struct laves__feature_edges {
  laves_context *context;
  const laves__surface *surface;
  const laves__feature_wish *wish;
  laves__vec3 *normal;  /* [faces] of length one; that of a neighbour where a face is too slim to have a direction; or zero */
  bool *is_crease;      /* [3 faces] for both half-edges of an edge */
  uint32_t *first, *at; /* the half-edges that start at each point: at[first[p] .. first[p + 1]) */
  uint32_t *degree;     /* [points] creases that end there */
  size_t dropped, joined;
} laves__feature_edges;

/* Finds them all. Free whatever is returned; false when memory is short. */
bool laves__feature_edges_find(laves_context *context, const laves__surface *surface, const laves__feature_wish *wish,
                               laves__feature_edges *edges);
void laves__feature_edges_free(laves__feature_edges *edges);

static inline uint32_t laves__half_start(const laves__surface *s, uint32_t half) { return s->faces[half / 3][half % 3]; }
static inline uint32_t laves__half_end(const laves__surface *s, uint32_t half) { return s->faces[half / 3][(half % 3 + 1) % 3]; }

#endif
