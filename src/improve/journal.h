/* What an operation changed, so that it can be undone, and which tets it touched, so that it can be judged by all of
 * them.  One for each worker; entries in order, undone backwards. */
#ifndef LAVES_IMPROVE_JOURNAL_H
#define LAVES_IMPROVE_JOURNAL_H

#include "mesh/layer.h"

typedef struct laves__vertex_entry {
  int32_t vertex;
  uint32_t hint;
  laves__vec3 position, normal;
  bool off_surface;
} laves__vertex_entry;

typedef struct laves__tet_entry {
  int32_t tet, corner[4], patch[4];
  double quality;
} laves__tet_entry;

/* A star as it was: `count` tets in the pool from `first` on. */
typedef struct laves__star_entry {
  int32_t vertex, count;
  size_t first;
} laves__star_entry;

typedef struct laves__journal {
  laves_context *context;
  laves__vertex_entry *vertex;
  laves__tet_entry *tet;
  laves__star_entry *star;
  int32_t *pool;
  size_t vertex_count, vertex_capacity, tet_count, tet_capacity, star_count, star_capacity, pool_count, pool_capacity;
  bool short_of_memory; /* an operation was left out for that reason: the improvement has failed */
} laves__journal;

void laves__journal_free(laves__journal *journal);
void laves__journal_clear(laves__journal *journal);
/* To be called before the change; false when memory is short. A NULL journal is allowed and remembers nothing. */
bool laves__journal_vertex(laves__journal *journal, const laves__layer *layer, int32_t vertex);
bool laves__journal_tet(laves__journal *journal, const laves__layer *layer, int32_t tet);
bool laves__journal_star(laves__journal *journal, const laves__layer *layer, int32_t vertex);
/* Adds a tet to a star that the journal has; false when memory is short. */
bool laves__journal_star_add(laves__journal *journal, laves__layer *layer, int32_t vertex, int32_t tet);
/* Whether the tets that it has lack less of what is asked than before, taken together. */
bool laves__lacks_less(const laves__layer *layer, const laves__journal *journal);
/* Puts everything back. */
void laves__journal_undo(laves__journal *journal, laves__layer *layer);

#endif
