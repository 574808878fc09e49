/* The points and polylines of a file, as indices into the file's points, and loose pieces joined to polylines. */
#ifndef LAVES_IO_LINE_LIST_H
#define LAVES_IO_LINE_LIST_H

#include "base/base.h"

typedef struct laves__line_list {
  laves_context *context;
  int32_t *single; /* points that stand alone */
  size_t single_count, single_capacity;
  int32_t *node; /* of all polylines */
  size_t node_count, node_capacity;
  size_t *line_end; /* [line_count] one past the last node of each */
  size_t line_count, line_capacity;
} laves__line_list;

/* Each returns false when memory is short. */
bool laves__line_list_add_single(laves__line_list *list, int32_t point);
/* The next node of the polyline that is being added. */
bool laves__line_list_add_node(laves__line_list *list, int32_t point);
/* Ends it: without nodes it is none, with one it is a point that stands alone. */
bool laves__line_list_end(laves__line_list *list);
/* The first node of a polyline. */
static inline size_t laves__line_list_first(const laves__line_list *list, size_t line) {
  return line ? list->line_end[line - 1] : 0;
}

/* Joins polylines of two points where exactly two of them meet, no longer one passes, and no single point stands, so that a
 * row of line elements becomes one polyline; what comes twice is dropped, and so are pieces from a point to itself. Indices
 * are below point_count. False when memory is short. Cost: n log n. */
bool laves__line_list_join(laves__line_list *list, size_t point_count);

void laves__line_list_free(laves__line_list *list);

#endif
