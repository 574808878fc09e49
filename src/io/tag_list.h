/* Names for runs of triangles, gathered while a file is read: STL solids, OBJ groups, PLY labels. */
#ifndef LAVES_IO_TAG_LIST_H
#define LAVES_IO_TAG_LIST_H

#include "base/base.h"

typedef struct laves__tag_list {
  char **names; /* each allocated with its length + 1 */
  size_t count, capacity;
  int32_t *slots; /* hash table of names: index, or -1 */
  size_t slot_count;
  int32_t *tags; /* of the triangles before the run that goes on now */
  size_t tag_count, tag_capacity;
  int32_t current; /* of the run that goes on now; meaningless while count is 0 */
} laves__tag_list;

/* Ends the run at triangle `triangle_count` and starts one with this name. Triangles before the first run get a run of
 * their own called `before`. False when memory is short. */
bool laves__tag_list_start(laves_context *context, laves__tag_list *list, const char *name, size_t length, size_t triangle_count,
                           const char *before);
/* Ends the last run: afterwards tags[0 .. triangle_count) are valid. */
bool laves__tag_list_end(laves_context *context, laves__tag_list *list, size_t triangle_count);
/* How many of the names triangles use, counted up to 2; after laves__tag_list_end(). */
int laves__tag_list_variety(const laves__tag_list *list);
void laves__tag_list_free(laves_context *context, laves__tag_list *list);

#endif
