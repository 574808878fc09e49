/* Elements grouped by their tag.
 *
 * The different tags are found from the starts of runs of equal ones, sorted: meshes have few tags in long runs, and where
 * they don't it is still one sort. Then a counting sort orders the elements. */
#include "io/tag_order.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int compare(const void *a, const void *b) {
  const int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
  return (x > y) - (x < y);
}

static bool starts_run(const int32_t *tags, size_t i) { return i == 0 || tags[i] != tags[i - 1]; }

/* Drops repetitions from a sorted array and returns how many are left. */
static size_t unique(int32_t *tags, size_t count) {
  size_t kept = 0;
  for (size_t i = 0; i < count; i++)
    if (starts_run(tags, i)) tags[kept++] = tags[i];
  return kept;
}

/* Sets tags and count. */
static bool find_tags(laves_context *context, const int32_t *tags, size_t element_count, laves__tag_order *order) {
  static const int32_t one[] = {1};
  if (!tags || element_count == 0) {
    tags = one;
    element_count = 1;
  }
  size_t runs = 0;
  for (size_t i = 0; i < element_count; i++) runs += starts_run(tags, i);
  int32_t *found = laves__alloc(context, runs, sizeof *found);
  if (!found) return false;
  for (size_t i = 0, n = 0; i < element_count; i++)
    if (starts_run(tags, i)) found[n++] = tags[i];
  qsort(found, runs, sizeof *found, compare);
  order->count = unique(found, runs);
  order->tags = laves__realloc(context, found, runs, order->count, sizeof *found);
  if (!order->tags) laves__free(context, found, runs, sizeof *found);
  return order->tags != NULL;
}

static size_t tag_index(const laves__tag_order *order, int32_t tag) {
  const int32_t *found = bsearch(&tag, order->tags, order->count, sizeof tag, compare);
  return (size_t)(found - order->tags);
}

static bool sort_elements(laves_context *context, const int32_t *tags, size_t element_count, laves__tag_order *order) {
  order->order = laves__alloc(context, element_count, sizeof *order->order);
  if (!order->order) return false;
  size_t index = 0;
  for (size_t i = 0; i < element_count; i++) {
    if (starts_run(tags, i)) index = tag_index(order, tags[i]);
    order->first[index + 1]++;
  }
  for (size_t t = 0; t < order->count; t++) order->first[t + 1] += order->first[t];
  for (size_t i = 0; i < element_count; i++) { /* first[t] runs to the start of t + 1 ... */
    if (starts_run(tags, i)) index = tag_index(order, tags[i]);
    order->order[order->first[index]++] = i;
  }
  memmove(order->first + 1, order->first, order->count * sizeof *order->first); /* ... and is put back */
  order->first[0] = 0;
  return true;
}

bool laves__tag_order_make(laves_context *context, const int32_t *tags, size_t element_count, laves__tag_order *order) {
  memset(order, 0, sizeof *order);
  if (!find_tags(context, tags, element_count, order)) goto failed;
  order->first = laves__alloc_zeroed(context, order->count + 1, sizeof *order->first);
  if (!order->first) goto failed;
  order->first[order->count] = element_count;
  if (order->count == 1) return true;
  order->first[order->count] = 0;
  if (sort_elements(context, tags, element_count, order)) return true;
failed:
  laves__tag_order_free(context, order);
  return false;
}

void laves__tag_order_free(laves_context *context, laves__tag_order *order) {
  const size_t elements = order->first ? order->first[order->count] : 0;
  laves__free(context, order->tags, order->count, sizeof *order->tags);
  laves__free(context, order->order, elements, sizeof *order->order);
  laves__free(context, order->first, order->count + 1, sizeof *order->first);
  memset(order, 0, sizeof *order);
}

int32_t laves__tag_number(const laves__tag_order *order, size_t i) {
  return order->tags[0] > 0 ? order->tags[i] : (int32_t)i + 1;
}

static void make_printable(char *name) {
  for (char *c = name; *c; c++)
    if ((unsigned char)*c < ' ' || *c == '"') *c = '_';
}

void laves__tag_comments(laves__output *out, const laves_mesh *mesh, int dimension, const char *start) {
  if (!(dimension == 3 ? mesh->regions : mesh->face_tags)) return;
  for (size_t i = 0; i < mesh->group_count; i++) {
    char name[LAVES__TAG_NAME_MAX];
    if (mesh->groups[i].dimension != dimension || !mesh->groups[i].name[0]) continue;
    snprintf(name, sizeof name, "%s", mesh->groups[i].name);
    make_printable(name);
    laves__output_printf(out, "%s%ld %s\n", start, (long)mesh->groups[i].tag, name);
  }
}

void laves__tag_name(const laves_mesh *mesh, int dimension, const laves__tag_order *order, size_t i,
                     char name[LAVES__TAG_NAME_MAX]) {
  const char *known = laves_mesh_group_name(mesh, dimension, order->tags[i]);
  const char *general = dimension == 3 ? "solid" : "boundary";
  if (known && known[0])
    snprintf(name, LAVES__TAG_NAME_MAX, "%s", known);
  else if (order->count == 1)
    snprintf(name, LAVES__TAG_NAME_MAX, "%s", general);
  else
    snprintf(name, LAVES__TAG_NAME_MAX, "%s_%ld", general, (long)order->tags[i]);
  make_printable(name);
}
