/* Points in a hashed grid: what lies near a place.
 *
 * Cells are cubes of one width; a question looks at the 27 cells around its point, so whatever is nearer than the width is
 * found. Cells share lists where their hashes meet, so more may come; the asker looks at the distance anyway. */
#ifndef LAVES_DOMAIN_POINT_GRID_H
#define LAVES_DOMAIN_POINT_GRID_H

#include "base/base.h"
#include "base/vec3.h"

typedef struct laves__point_grid {
  laves_context *context;
  double width;
  laves__vec3 *at;
  uint32_t *next; /* the next of the same list + 1 */
  size_t count, at_capacity, next_capacity;
  uint32_t *head; /* [head_count], a power of two: the list's first + 1 */
  size_t head_count;
} laves__point_grid;

void laves__point_grid_init(laves__point_grid *grid, laves_context *context, double width);
void laves__point_grid_free(laves__point_grid *grid);
/* The point's number is the count before. False when memory is short. */
bool laves__point_grid_add(laves__point_grid *grid, laves__vec3 p);

/* Calls fn for every point in the cells around p, lists in fixed order, each newest first; one may come twice. */
typedef void laves__near_fn(void *user, uint32_t index);
void laves__point_grid_near(const laves__point_grid *grid, laves__vec3 p, laves__near_fn *fn, void *user);

#endif
