/* A list of the worst places of a mesh. */
#ifndef LAVES_CLI_PLACE_LIST_H
#define LAVES_CLI_PLACE_LIST_H

#include <stdbool.h>

#include "json.h"
#include "laves/laves.h"
#include "options.h"

typedef struct place_list {
  laves_place *places;
  size_t capacity, found;                     /* found may exceed capacity */
  double crease_angles[LAVES_PLACE_CAPACITY]; /* of the first ones; NAN: no crease */
} place_list;

/* No places, and no crease angles; false when memory is short. Free with place_list_free(). */
bool place_list_make(place_list *list, int64_t capacity);
void place_list_free(place_list *list);
/* How many of those that were found are listed. */
size_t place_list_listed(const place_list *list);

/* The window that tets are held against: that of laves_options_default() but for what was given. */
laves_options check_window(const settings *given);
/* How many tets are outside it, and the worst of them, each on a line. */
void place_list_say_window(const place_list *list, const laves_options *window);
void place_list_write_json(json *out, const char *key, const place_list *list);

#endif
