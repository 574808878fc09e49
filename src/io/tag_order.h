/* Elements grouped by their tag: what formats with named parts need. */
#ifndef LAVES_IO_TAG_ORDER_H
#define LAVES_IO_TAG_ORDER_H

#include "io/output.h"
#include "mesh/mesh.h"

typedef struct laves__tag_order {
  size_t count;  /* different tags */
  int32_t *tags; /* [count], ascending */
  size_t *first; /* [count + 1]: where the elements of each tag start in the order; the last is their number */
  size_t *order; /* [number of elements], or NULL: as they stand */
} laves__tag_order;

/* tags NULL: all are 1. Elements of equal tag keep their order. Without elements there is still the tag 1, with none.
 * False when memory is short; then there is nothing to free. */
bool laves__tag_order_make(laves_context *context, const int32_t *tags, size_t element_count, laves__tag_order *order);
void laves__tag_order_free(laves_context *context, laves__tag_order *order);
static inline size_t laves__tag_order_item(const laves__tag_order *order, size_t i) { return order->order ? order->order[i] : i; }

/* The number of tag i in formats that want positive ones: the tag itself, or, where a tag is zero or less, 1, 2, ... in ascending
 * order. */
int32_t laves__tag_number(const laves__tag_order *order, size_t i);

/* One line for each name of a region (dimension 3) or tag (2) that the mesh has: `start`, number, name. For formats that have
 * comments but no names. */
void laves__tag_comments(laves__output *out, const laves_mesh *mesh, int dimension, const char *start);

/* The name of tag number i: as the mesh has it, else "solid" or "boundary" (by dimension 3 or 2), with "_" and the tag
 * behind it when there are several. Quotes and control characters become "_". */
enum { LAVES__TAG_NAME_MAX = 100 };
void laves__tag_name(const laves_mesh *mesh, int dimension, const laves__tag_order *order, size_t i,
                     char name[LAVES__TAG_NAME_MAX]);

#endif
