/* The table from key to number: open addressing, at most half full. */
#include "graded/keys.h"

#include <string.h>

#include "base/sort.h"

static size_t first_slot(const laves__key_table *t, uint64_t key) {
  uint64_t h = key * UINT64_C(0x9e3779b97f4a7c15);
  h ^= h >> 29;
  return (size_t)(h & (t->slot_count - 1));
}

static bool sort_keys(laves__key_table *t) {
  uint64_t *scratch = laves__alloc(t->context, t->count, sizeof *scratch);
  if (!scratch) return false;
  laves__sort_u64(t->key, scratch, t->count);
  laves__free(t->context, scratch, t->count, sizeof *scratch);
  size_t kept = 0;
  for (size_t i = 0; i < t->count; i++)
    if (i == 0 || t->key[i] != t->key[kept - 1]) t->key[kept++] = t->key[i];
  t->count = kept;
  return true;
}

bool laves__key_table_make(laves_context *context, uint64_t *keys, size_t count, size_t capacity, laves__key_table *t) {
  *t = (laves__key_table){.context = context, .key = keys, .count = count, .capacity = capacity, .slot_count = 16};
  if (!sort_keys(t)) return false;
  size_t slots = t->slot_count;
  while (slots < 2 * t->count) slots *= 2;
  t->slot = laves__alloc(context, slots, sizeof *t->slot);
  if (!t->slot) return false;
  t->slot_count = slots;
  memset(t->slot, -1, slots * sizeof *t->slot);
  for (size_t i = 0; i < t->count; i++) {
    if (laves__cancelled_at(context, "background", i, t->count)) return false;
    size_t s = first_slot(t, t->key[i]);
    while (t->slot[s] >= 0) s = (s + 1) & (slots - 1);
    t->slot[s] = (int32_t)i;
  }
  return true;
}

int32_t laves__key_find(const laves__key_table *t, uint64_t key) {
  for (size_t s = first_slot(t, key);; s = (s + 1) & (t->slot_count - 1)) {
    const int32_t i = t->slot[s];
    if (i < 0 || t->key[i] == key) return i;
  }
}

void laves__key_table_free(laves__key_table *t) {
  if (!t->context) return;
  laves__free(t->context, t->key, t->capacity, sizeof *t->key);
  if (t->slot) laves__free(t->context, t->slot, t->slot_count, sizeof *t->slot);
  memset(t, 0, sizeof *t);
}
