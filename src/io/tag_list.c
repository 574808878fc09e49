/* Names for runs of triangles.  Nothing is done per triangle: a tag is written to all triangles of a run when the run ends.
 * Names are found by hashing, since a file may have as many of them as triangles. */
#include "io/tag_list.h"

#include <string.h>

/* FNV-1a, 32 bits: http://www.isthe.com/chongo/tech/comp/fnv/ */
static uint32_t hash_of(const char *name, size_t length) {
  uint32_t hash = 2166136261u;
  for (size_t i = 0; i < length; ++i) {
    hash = (hash ^ (unsigned char)name[i]) * 16777619u;
  }
  return hash;
}

/* The slot that holds the name, or the empty one where it belongs; slot_count is a power of two with room left. */
static size_t find_slot(const laves__tag_list *list, const char *name, size_t length) {
  size_t slot = hash_of(name, length) & (list->slot_count - 1);
  for (; list->slots[slot] >= 0; slot = (slot + 1) & (list->slot_count - 1)) {
    const char *other = list->names[list->slots[slot]];
    // Looks at no more than `length` bytes, however long the other name is.
    if (strncmp(other, name, length) == 0 && other[length] == 0) break;
  }
  return slot;
}

/* Keeps at least half of the slots empty. */
static bool grow_slots(laves_context *context, laves__tag_list *list) {
  if (list->count * 2 + 2 <= list->slot_count) return true;
  const size_t larger = list->slot_count ? list->slot_count * 2 : 16;
  int32_t *slots = laves__alloc(context, larger, sizeof *slots);
  if (slots == NULL) return false;
  laves__free(context, list->slots, list->slot_count, sizeof *slots);
  list->slots = slots;
  list->slot_count = larger;
  memset(slots, 0xFF, larger * sizeof *slots);
  for (size_t i = 0; i < list->count; ++i) {
    list->slots[find_slot(list, list->names[i], strlen(list->names[i]))] = (int32_t)i;
  }
  return true;
}

/* Makes `name` the current one; it is cut at a NUL, so that its length is what strlen says. */
static bool select_name(laves_context *context, laves__tag_list *list, const char *name, size_t length) {
  const char *nul = memchr(name, 0, length);
  length = nul ? (size_t)(nul - name) : length;
  if (!grow_slots(context, list)) return false;
  const size_t slot = find_slot(list, name, length);
  if (list->slots[slot] < 0) {
    if (!laves__grow(context, &list->names, &list->capacity, list->count + 1, sizeof *list->names)) return false;
    char *copy = laves__alloc(context, length + 1, 1);
    if (copy == NULL) return false;
    memcpy(copy, name, length);
    copy[length] = 0;
    list->names[list->count] = copy;
    list->slots[slot] = (int32_t)list->count++;
  }
  list->current = list->slots[slot];
  return true;
}

bool laves__tag_list_end(laves_context *context, laves__tag_list *list, size_t triangle_count) {
  if (!laves__grow(context, &list->tags, &list->tag_capacity, triangle_count, sizeof *list->tags)) return false;
  while (list->tag_count < triangle_count) {
    list->tags[list->tag_count++] = list->current;
  }
  return true;
}

bool laves__tag_list_start(laves_context *context, laves__tag_list *list, const char *name, size_t length, size_t triangle_count,
                           const char *before) {
  if (list->count == 0 && triangle_count > 0 && !select_name(context, list, before, strlen(before))) return false;
  return laves__tag_list_end(context, list, triangle_count) && select_name(context, list, name, length);
}

int laves__tag_list_variety(const laves__tag_list *list) {
  for (size_t i = 1; i < list->tag_count; ++i) {
    if (list->tags[i] != list->tags[0]) return 2;
  }
  return list->count > 0 && list->tag_count > 0;
}

void laves__tag_list_free(laves_context *context, laves__tag_list *list) {
  for (size_t i = 0; i < list->count; ++i) {
    laves__free(context, list->names[i], strlen(list->names[i]) + 1, 1);
  }
  laves__free(context, list->names, list->capacity, sizeof *list->names);
  laves__free(context, list->slots, list->slot_count, sizeof *list->slots);
  laves__free(context, list->tags, list->tag_capacity, sizeof *list->tags);
  *list = (laves__tag_list){0};
}
