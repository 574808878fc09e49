/* Points of a mesh that stays in its file, of which some are held. */
#ifndef LAVES_CERTIFY_POINT_CACHE_H
#define LAVES_CERTIFY_POINT_CACHE_H

#include "mesh/mesh_stream.h"

enum { LAVES__CACHED_POINTS = 1024 }; /* that are read and held together */

typedef struct laves__point_cache {
  laves_context *context;
  laves__mesh_stream *stream;
  size_t block_count, slot_count;
  uint32_t *slot_of;   /* [block_count] 1 + the slot that holds the block; 0: none does */
  uint32_t *block_of;  /* [slot_count] */
  uint8_t *in_use;     /* [slot_count] since the hand came by */
  uint8_t *seen;       /* [block_count] has been read, so its points are finite */
  laves__vec3 *points; /* [slot_count][LAVES__CACHED_POINTS] */
  size_t filled, hand;
} laves__point_cache;

/* At most `bytes` for points, and 5 bytes for every 1024 of them beside. Free with laves__point_cache_free(), also after a
 * failure. */
laves_result laves__point_cache_make(laves__point_cache *cache, laves_context *context, laves__mesh_stream *stream, size_t bytes,
                                     laves_error *error);
void laves__point_cache_free(laves__point_cache *cache);

/* Reads the block of a point that is not held; one that is not finite is an error. */
laves_result laves__point_cache_load(laves__point_cache *cache, size_t block, laves_error *error);

static inline laves_result laves__point_cache_get(laves__point_cache *cache, int32_t vertex, laves__vec3 *point,
                                                  laves_error *error) {
  const size_t block = (size_t)vertex / LAVES__CACHED_POINTS;
  if (cache->slot_of[block] == 0) {
    const laves_result result = laves__point_cache_load(cache, block, error);
    if (result != LAVES_OK) return result;
  }
  const size_t slot = cache->slot_of[block] - 1;
  cache->in_use[slot] = 1;
  *point = cache->points[slot * LAVES__CACHED_POINTS + (size_t)vertex % LAVES__CACHED_POINTS];
  return LAVES_OK;
}

/* Reads whatever has not been read yet, since all points must be finite. */
laves_result laves__point_cache_see_all(laves__point_cache *cache, laves_error *error);

#endif
