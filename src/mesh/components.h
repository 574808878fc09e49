/* Components of the boundary layer: what hangs together by tets.
 *
 * Improvement works on each by itself. So where a part of the boundary is made anew, the components that come out as they were
 * before need not be improved a second time: they are set aside, and what was made of them is put in their place. */
#ifndef LAVES_MESH_COMPONENTS_H
#define LAVES_MESH_COMPONENTS_H

#include "mesh/hash128.h"
#include "mesh/layer.h"

typedef struct laves__components {
  laves_context *context;
  size_t vertex_count, count;
  int32_t *of;          /* [vertex_count] the component of each vertex, -1: it is in no tet */
  int32_t *place;       /* [vertex_count] where it stands in `vertex` */
  int32_t *vertex;      /* [vertex_count] by component, then ascending; those of no component come last */
  int32_t *first;       /* [count + 1] those of component c stand in vertex[first[c] .. first[c + 1]) */
  laves__hash128 *hash; /* [count] of vertices, holds and tets: with the same hash a component is the same */
} laves__components;

/* Numbered by their first vertices. Both false when memory is short; free it either way. */
bool laves__components_find(const laves__layer *layer, laves__components *c);
void laves__components_free(laves__components *c);

/* The layer `old` and its components before it was improved, and which of those have a twin among others. */
typedef struct laves__twins {
  const laves__layer *improved;
  const laves__components *before, *now;
  int32_t *owner; /* [improved->vertex_count] component before the improvement, or -1 */
  int32_t *twin;  /* [before->count] component now, or -1 */
} laves__twins;

/* Which components of `now` are as they were before. `again`: those of `before` that shall be improved again all the same; NULL:
 * none. False when memory is short. */
bool laves__twins_find(const laves__layer *improved, const laves__components *before, const laves__components *now,
                       const bool *again, laves__twins *t);
void laves__twins_free(laves__twins *t);
/* Takes their tets out of a layer just made, of which `now` are the components. */
void laves__twins_set_aside(const laves__twins *t, laves__layer *layer);
/* Puts what was made of them in their place: their vertices keep their numbers, new vertices and the tets come last. */
bool laves__twins_bring_back(const laves__twins *t, laves__layer *layer);

#endif
