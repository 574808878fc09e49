/* Points of a mesh that stays in its file.
 *
 * Blocks of points are read when one of theirs is asked for. When there is no room left, a hand goes round the slots and takes
 * the first that has not been used since it last came by: about the one that was used longest ago, at no cost when a point is
 * found. */
#include "certify/point_cache.h"

enum { SLOTS_MIN = 8, BLOCKS_BETWEEN_ASKING = 64 };

laves_result laves__point_cache_make(laves__point_cache *cache, laves_context *context, laves__mesh_stream *stream, size_t bytes,
                                     laves_error *error) {
  const size_t blocks = (stream->point_count + LAVES__CACHED_POINTS - 1) / LAVES__CACHED_POINTS;
  size_t slots = bytes / (LAVES__CACHED_POINTS * sizeof(laves__vec3));
  if (slots < SLOTS_MIN) slots = SLOTS_MIN;
  if (slots > blocks) slots = blocks;
  *cache = (laves__point_cache){.context = context, .stream = stream, .block_count = blocks, .slot_count = slots};
  cache->slot_of = laves__alloc_zeroed(context, blocks, sizeof *cache->slot_of);
  cache->block_of = laves__alloc(context, slots, sizeof *cache->block_of);
  cache->in_use = laves__alloc_zeroed(context, slots, 1);
  cache->seen = laves__alloc_zeroed(context, blocks, 1);
  cache->points = laves__alloc(context, slots * LAVES__CACHED_POINTS, sizeof *cache->points);
  if (cache->slot_of && cache->block_of && cache->in_use && cache->seen && cache->points) return LAVES_OK;
  return laves__fail_memory(context, error);
}

void laves__point_cache_free(laves__point_cache *cache) {
  laves_context *context = cache->context;
  if (!context) return;
  laves__free(context, cache->slot_of, cache->block_count, sizeof *cache->slot_of);
  laves__free(context, cache->block_of, cache->slot_count, sizeof *cache->block_of);
  laves__free(context, cache->in_use, cache->slot_count, 1);
  laves__free(context, cache->seen, cache->block_count, 1);
  laves__free(context, cache->points, cache->slot_count * LAVES__CACHED_POINTS, sizeof *cache->points);
  *cache = (laves__point_cache){0};
}

/* A slot for another block. */
static size_t take_slot(laves__point_cache *cache) {
  if (cache->filled < cache->slot_count) return cache->filled++;
  while (cache->in_use[cache->hand]) {
    cache->in_use[cache->hand] = 0;
    cache->hand = (cache->hand + 1) % cache->slot_count;
  }
  const size_t slot = cache->hand;
  cache->hand = (cache->hand + 1) % cache->slot_count;
  cache->slot_of[cache->block_of[slot]] = 0;
  return slot;
}

laves_result laves__point_cache_load(laves__point_cache *cache, size_t block, laves_error *error) {
  const size_t slot = take_slot(cache), first = block * LAVES__CACHED_POINTS;
  const size_t left = cache->stream->point_count - first, count = left < LAVES__CACHED_POINTS ? left : LAVES__CACHED_POINTS;
  laves__vec3 *points = cache->points + slot * LAVES__CACHED_POINTS;
  const laves_result result = cache->stream->read_points(cache->stream->user, first, count, points, error);
  if (result != LAVES_OK) return result;
  for (size_t i = 0; i < count && !cache->seen[block]; i++)
    if (!v3_finite(points[i]))
      return laves__fail(error, LAVES_ERROR_INPUT, "%s: vertex %zu (counted from 1) has a coordinate that is not finite",
                         cache->stream->name, first + i + 1);
  cache->seen[block] = 1;
  cache->block_of[slot] = (uint32_t)block;
  cache->slot_of[block] = (uint32_t)slot + 1;
  return LAVES_OK;
}

laves_result laves__point_cache_see_all(laves__point_cache *cache, laves_error *error) {
  for (size_t block = 0; block < cache->block_count; block++) {
    if (cache->seen[block]) continue;
    if (block % BLOCKS_BETWEEN_ASKING == 0 && laves__cancelled(cache->context, "check", 0.8)) return laves__fail_cancelled(error);
    const laves_result result = laves__point_cache_load(cache, block, error);
    if (result != LAVES_OK) return result;
  }
  return LAVES_OK;
}
