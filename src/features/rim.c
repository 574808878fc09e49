/* Faces that only one tet has, found through stars, tet by tet, so that their order depends on the layer alone. */
#include "features/rim.h"

#include <string.h>

#include "mesh/mesh.h"

typedef struct search {
  const laves__layer *layer;
  uint8_t *faces; /* [tets] bit k: the face opposite corner k */
} search;

static void find_faces(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const search *s = user;
  const laves__layer *layer = s->layer;
  for (size_t t = begin; t < end; t++) {
    const int32_t *tet = layer->tet[t];
    int on = 0;
    s->faces[t] = 0;
    for (int k = 0; k < 4 && tet[0] >= 0; k++) on += layer->depth[tet[k]] == 0;
    for (int k = 0; k < 4 && on >= 3; k++)
      if (laves__layer_is_boundary_face(layer, (int32_t)t, k)) s->faces[t] |= (uint8_t)(1 << k);
  }
}

static void list_faces(const search *s, laves__rim *rim) {
  const laves__layer *layer = s->layer;
  for (size_t t = 0; t < layer->tet_count; t++)
    for (int k = 0; k < 4; k++) {
      if (!(s->faces[t] >> k & 1)) continue;
      for (int j = 0; j < 3; j++) rim->face[rim->face_count][j] = layer->tet[t][laves__tet_face[k][j]];
      rim->face_count++;
    }
}

static void list_around(laves__rim *rim) {
  uint32_t sum = 0;
  for (size_t f = 0; f < rim->face_count; f++)
    for (int j = 0; j < 3; j++) rim->first[rim->face[f][j]]++;
  for (size_t v = 0; v <= rim->vertex_count; v++) {
    sum += rim->first[v];
    rim->first[v] = sum;
  }
  for (size_t f = rim->face_count; f-- > 0;)
    for (int j = 0; j < 3; j++) rim->at[--rim->first[rim->face[f][j]]] = (uint32_t)f;
}

laves_result laves__rim_make(const laves__layer *layer, laves__rim *rim, laves_error *error) {
  laves_context *context = layer->context;
  search s = {layer, laves__alloc(context, layer->tet_count, 1)};
  *rim = (laves__rim){.context = context, .vertex_count = layer->vertex_count};
  laves_result result = s.faces ? LAVES_OK : laves__fail_memory(context, error);
  if (result == LAVES_OK && !laves__parallel_for(context, "features", layer->tet_count, 256, find_faces, &s))
    result = laves__fail_cancelled(error);
  for (size_t t = 0; result == LAVES_OK && t < layer->tet_count; t++)
    rim->face_capacity += (size_t)__builtin_popcount(s.faces[t]);
  if (result == LAVES_OK) {
    rim->face = laves__alloc(context, rim->face_capacity, sizeof *rim->face);
    rim->first = laves__alloc_zeroed(context, rim->vertex_count + 1, sizeof *rim->first);
    rim->at = laves__alloc(context, 3 * rim->face_capacity, sizeof *rim->at);
    if (rim->face && rim->first && rim->at) {
      list_faces(&s, rim);
      list_around(rim);
    } else {
      result = laves__fail_memory(context, error);
    }
  }
  laves__free(context, s.faces, layer->tet_count, 1);
  return result;
}

void laves__rim_free(laves__rim *rim) {
  if (!rim->context) return;
  laves__free(rim->context, rim->face, rim->face_capacity, sizeof *rim->face);
  laves__free(rim->context, rim->first, rim->vertex_count + 1, sizeof *rim->first);
  laves__free(rim->context, rim->at, 3 * rim->face_capacity, sizeof *rim->at);
  memset(rim, 0, sizeof *rim);
}
