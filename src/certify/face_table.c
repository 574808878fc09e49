/* Faces of tets that come one after the other.
 *
 * Why a face may be forgotten: in a mesh that is sound at an inner vertex, the triangles opposite it form one sphere. No part of
 * them but the whole is closed, so once every face at the vertex has two tets there are no more tets to come. If some come
 * nevertheless the mesh may still be sound elsewhere, but whether a third tet has one of the faces that were forgotten is not
 * known: then the caller goes through the tets once more, and faces at such vertices are kept.
 *
 * Each shard is a hash table with open addressing. Nothing is taken out one by one: when a shard is four fifths full, the whole
 * table is swept, which finds the closed vertices, drops faces and makes the shards twice as large as what is left. Labels of
 * tets are renumbered at the same time, so that there are never many more than components that have a face in the table. The
 * number of components, and which faces are left in which state, do not depend on when that happens. */
#include "certify/face_table.h"

#include <string.h>

enum { SHARD_MIN = 64, LABELS_MIN = 1 << 12, WORDS_PER_BLOCK = 1 << 14, ENTRIES_BETWEEN_ASKING = 1 << 14 };

#define NO_LABEL UINT32_MAX

static size_t word_count(const laves__face_table *table) { return table->vertex_count / 64 + 1; }

static bool has_bit(const _Atomic uint64_t *set, size_t i) {
  return atomic_load_explicit(&set[i / 64], memory_order_relaxed) >> i % 64 & 1;
}

/* True when it was not there. */
static bool add_bit(_Atomic uint64_t *set, size_t i) {
  if (has_bit(set, i)) return false;
  const uint64_t bit = UINT64_C(1) << i % 64;
  return (atomic_fetch_or_explicit(&set[i / 64], bit, memory_order_relaxed) & bit) == 0;
}

/* ---- make and free ---- */

laves_result laves__face_table_make(laves__face_table *table, laves_context *context, size_t vertex_count, laves_error *error) {
  *table = (laves__face_table){.context = context, .vertex_count = vertex_count};
  const size_t words = word_count(table);
  table->used = laves__alloc_zeroed(context, words, sizeof *table->used);
  table->closed = laves__alloc_zeroed(context, words, sizeof *table->closed);
  table->reopened = laves__alloc_zeroed(context, words, sizeof *table->reopened);
  return table->used && table->closed && table->reopened ? LAVES_OK : laves__fail_memory(context, error);
}

static void free_shard(laves_context *context, laves__face_shard *shard) {
  laves__free(context, shard->entries, shard->capacity, sizeof *shard->entries);
  *shard = (laves__face_shard){0};
}

static void free_labels(laves__face_table *table) {
  laves__free(table->context, table->parents, table->label_capacity, sizeof *table->parents);
  laves__free(table->context, table->renamed, table->label_capacity, sizeof *table->renamed);
  table->parents = NULL;
  table->renamed = NULL;
  table->label_count = table->label_capacity = 0;
}

void laves__face_table_free(laves__face_table *table) {
  if (!table->context) return;
  const size_t words = word_count(table);
  for (size_t s = 0; s < LAVES__FACE_SHARDS; s++) free_shard(table->context, &table->shards[s]);
  free_labels(table);
  laves__free(table->context, table->used, words, sizeof *table->used);
  laves__free(table->context, table->closed, words, sizeof *table->closed);
  laves__free(table->context, table->reopened, words, sizeof *table->reopened);
  *table = (laves__face_table){0};
}

void laves__face_table_restart(laves__face_table *table) {
  const size_t words = word_count(table);
  for (size_t s = 0; s < LAVES__FACE_SHARDS; s++) free_shard(table->context, &table->shards[s]);
  free_labels(table);
  for (size_t i = 0; i < words; i++) {
    atomic_store_explicit(&table->used[i], 0, memory_order_relaxed);
    atomic_store_explicit(&table->closed[i], 0, memory_order_relaxed);
  }
  table->finished = 0;
  atomic_store(&table->was_reopened, false);
}

/* ---- records ---- */

static uint64_t hash_of(const uint32_t corners[3]) {
  uint64_t h = corners[0] * UINT64_C(0x9e3779b97f4a7c15) ^ corners[1] * UINT64_C(0xc2b2ae3d27d4eb4f);
  h = (h ^ h >> 32) * UINT64_C(0xd6e8feb86659fd93) + corners[2];
  h = (h ^ h >> 32) * UINT64_C(0xd6e8feb86659fd93);
  return h ^ h >> 29;
}

static size_t shard_of(uint64_t hash) { return hash >> 40 & (LAVES__FACE_SHARDS - 1); }

/* The lower half of the hash as a place in the table. */
static size_t place_of(uint64_t hash, size_t capacity) { return (size_t)((hash & UINT32_MAX) * (uint64_t)capacity >> 32); }

size_t laves__face_record(const int32_t outwards[3], uint64_t slot, uint32_t label, laves__face_entry *record) {
  const uint32_t a = (uint32_t)outwards[0], b = (uint32_t)outwards[1], c = (uint32_t)outwards[2];
  const unsigned rank_a = (a > b) + (a > c), rank_b = (b > a) + (b > c), rank_c = 3 - rank_a - rank_b;
  record->corners[rank_a] = a;
  record->corners[rank_b] = b;
  record->corners[rank_c] = c;
  record->label = label;
  record->tag = slot << 6 | (uint64_t)(3 * rank_a + rank_b) << 2 | LAVES__FACE_OPEN;
  return shard_of(hash_of(record->corners));
}

static void ranks_of(const laves__face_entry *entry, unsigned ranks[3]) {
  const unsigned code = (unsigned)(entry->tag >> 2 & 15);
  ranks[0] = code / 3;
  ranks[1] = code % 3;
  ranks[2] = 3 - ranks[0] - ranks[1];
}

void laves__face_outwards_of(const laves__face_entry *entry, int32_t outwards[3]) {
  unsigned ranks[3];
  ranks_of(entry, ranks);
  for (int i = 0; i < 3; i++) outwards[i] = (int32_t)entry->corners[ranks[i]];
}

/* Whether the outward triangle visits its vertices in ascending order, up to rotation. */
static bool ascends(const laves__face_entry *entry) {
  unsigned r[3];
  ranks_of(entry, r);
  return (r[0] < r[1]) + (r[1] < r[2]) + (r[2] < r[0]) == 2;
}

static void set_state(laves__face_entry *entry, laves__face_state state) { entry->tag = (entry->tag & ~UINT64_C(3)) | state; }

/* ---- labels ---- */

static uint32_t parent_of(const laves__face_table *table, uint32_t label) {
  return atomic_load_explicit(&table->parents[label], memory_order_relaxed);
}

static uint32_t find_root(laves__face_table *table, uint32_t label) {
  for (;;) {
    uint32_t above = parent_of(table, label);
    if (above == label) return label;
    const uint32_t top = parent_of(table, above);
    if (top != above)
      atomic_compare_exchange_weak_explicit(&table->parents[label], &above, top, memory_order_relaxed, memory_order_relaxed);
    label = top;
  }
}

/* The higher root gets the lower one as its parent; when another thread was faster, the search starts again. */
static void unite(laves__face_table *table, uint32_t a, uint32_t b) {
  for (;;) {
    a = find_root(table, a);
    b = find_root(table, b);
    if (a == b) return;
    uint32_t high = a > b ? a : b;
    const uint32_t low = a > b ? b : a;
    if (atomic_compare_exchange_strong_explicit(&table->parents[high], &high, low, memory_order_relaxed, memory_order_relaxed))
      return;
  }
}

void laves__face_table_drop_label(laves__face_table *table, uint32_t label) {
  atomic_store_explicit(&table->parents[label], NO_LABEL, memory_order_relaxed);
}

size_t laves__face_table_components(const laves__face_table *table) {
  size_t count = table->finished;
  for (size_t i = 0; i < table->label_count; i++) count += parent_of(table, (uint32_t)i) == i;
  return count;
}

/* Numbers the roots that are alive from 0, and counts the others as finished. */
static void rename_labels(laves__face_table *table) {
  size_t count = 0;
  for (size_t i = 0; i < table->label_count; i++) {
    if (parent_of(table, (uint32_t)i) != i) continue;
    if (table->renamed[i])
      table->renamed[i] = (uint32_t)count++;
    else
      table->finished++;
  }
  for (size_t i = 0; i < count; i++) atomic_store_explicit(&table->parents[i], (uint32_t)i, memory_order_relaxed);
  table->label_count = count;
}

/* ---- the sweep ---- */

/* Asks whether to cancel now and then; only the calling thread may. */
static bool stopped(const laves__face_table *table, size_t i, int worker) {
  if (i % ENTRIES_BETWEEN_ASKING != 0) return false;
  return worker == 0 ? laves__cancelled(table->context, "check", table->fraction) : laves__is_cancelled(table->context);
}

/* `closed` first holds the vertices that are open. */
static void mark_open(void *user, size_t begin, size_t end, int worker) {
  laves__face_table *table = user;
  for (size_t s = begin; s < end; s++)
    for (size_t i = 0; i < table->shards[s].capacity && !stopped(table, i, worker); i++) {
      const laves__face_entry *entry = &table->shards[s].entries[i];
      if (laves__face_state_of(entry) != LAVES__FACE_OPEN) continue;
      for (int j = 0; j < 3; j++) add_bit(table->closed, entry->corners[j]);
    }
}

static void clear_words(void *user, size_t begin, size_t end, int worker) {
  laves__face_table *table = user;
  (void)worker;
  for (size_t i = begin; i < end; i++) atomic_store_explicit(&table->closed[i], 0, memory_order_relaxed);
}

static void close_words(void *user, size_t begin, size_t end, int worker) {
  laves__face_table *table = user;
  (void)worker;
  for (size_t i = begin; i < end; i++) {
    const uint64_t used = atomic_load_explicit(&table->used[i], memory_order_relaxed);
    const uint64_t open = atomic_load_explicit(&table->closed[i], memory_order_relaxed);
    const uint64_t kept = atomic_load_explicit(&table->reopened[i], memory_order_relaxed);
    atomic_store_explicit(&table->closed[i], used & ~open & ~kept, memory_order_relaxed);
  }
}

static bool may_go(const laves__face_table *table, const laves__face_entry *entry) {
  if (table->keep_all || laves__face_state_of(entry) != LAVES__FACE_MATCHED) return false;
  return has_bit(table->closed, entry->corners[0]) || has_bit(table->closed, entry->corners[1]) ||
         has_bit(table->closed, entry->corners[2]);
}

/* Drops faces, which leaves the shard without order, and notes which labels are in use. Threads that mark the same label write
 * the same value. */
static void drop_faces(void *user, size_t begin, size_t end, int worker) {
  laves__face_table *table = user;
  for (size_t s = begin; s < end; s++) {
    laves__face_shard *shard = &table->shards[s];
    for (size_t i = 0; i < shard->capacity && !stopped(table, i, worker); i++) {
      laves__face_entry *entry = &shard->entries[i];
      if (laves__face_state_of(entry) == LAVES__FACE_NONE) continue;
      if (may_go(table, entry)) {
        entry->tag = LAVES__FACE_NONE;
        shard->count--;
      } else {
        entry->label = find_root(table, entry->label);
        __atomic_store_n(&table->renamed[entry->label], 1, __ATOMIC_RELAXED);
      }
    }
  }
}

static size_t place_in(const laves__face_shard *shard, const uint32_t corners[3]) {
  return place_of(hash_of(corners), shard->capacity);
}

/* The entry with these corners, or the empty one where it would be; i: place_in(). */
static laves__face_entry *find_entry(const laves__face_shard *shard, const uint32_t corners[3], size_t i) {
  for (;;) {
    laves__face_entry *entry = &shard->entries[i];
    if (entry->tag == LAVES__FACE_NONE || memcmp(entry->corners, corners, sizeof entry->corners) == 0) return entry;
    if (++i == shard->capacity) i = 0;
  }
}

typedef struct rebuilding {
  laves__face_table *table;
  size_t capacity;
} rebuilding;

static void rebuild_shards(void *user, size_t begin, size_t end, int worker) {
  const rebuilding *r = user;
  laves__face_table *table = r->table;
  for (size_t s = begin; s < end; s++) {
    laves__face_shard *shard = &table->shards[s];
    laves__face_shard fresh = {laves__alloc_zeroed(table->context, r->capacity, sizeof *fresh.entries), r->capacity,
                               shard->count};
    if (!fresh.entries) {
      atomic_store(&table->failed, true);
      return;
    }
    for (size_t i = 0; i < shard->capacity && !stopped(table, i, worker); i++) {
      const laves__face_entry *entry = &shard->entries[i];
      if (laves__face_state_of(entry) == LAVES__FACE_NONE) continue;
      laves__face_entry *to = find_entry(&fresh, entry->corners, place_in(&fresh, entry->corners));
      *to = *entry;
      to->label = table->renamed[entry->label];
    }
    free_shard(table->context, shard);
    *shard = fresh;
  }
}

/* Shards twice as large as what they hold and are to take. */
static size_t capacity_for(const laves__face_table *table, const size_t counts[LAVES__FACE_SHARDS]) {
  size_t most = SHARD_MIN / 2;
  for (size_t s = 0; s < LAVES__FACE_SHARDS; s++)
    if (table->shards[s].count + counts[s] > most) most = table->shards[s].count + counts[s];
  return 2 * most;
}

/* Room for the labels until the shards are full again: every tet that adds none of its faces to them took away two. */
static bool grow_labels(laves__face_table *table, size_t needed, size_t faces) {
  size_t capacity = faces / 4 > LABELS_MIN ? faces / 4 : LABELS_MIN;
  if (capacity < table->label_count + needed) capacity = table->label_count + needed;
  if (capacity > NO_LABEL || table->label_capacity >= capacity) return capacity <= NO_LABEL;
  _Atomic uint32_t *parents = laves__realloc(table->context, table->parents, table->label_capacity, capacity, sizeof *parents);
  if (!parents) return false;
  table->parents = parents;
  laves__free(table->context, table->renamed, table->label_capacity, sizeof *table->renamed);
  table->label_capacity = capacity;
  table->renamed = laves__alloc(table->context, capacity, sizeof *table->renamed);
  return table->renamed != NULL;
}

static bool sweep(laves__face_table *table, const size_t counts[LAVES__FACE_SHARDS], size_t labels) {
  laves_context *context = table->context;
  const size_t words = word_count(table);
  if (table->label_count > 0) memset(table->renamed, 0, table->label_count * sizeof *table->renamed);
  if (!laves__parallel_for(context, NULL, words, WORDS_PER_BLOCK, clear_words, table) ||
      !laves__parallel_for(context, NULL, LAVES__FACE_SHARDS, 1, mark_open, table) ||
      !laves__parallel_for(context, NULL, words, WORDS_PER_BLOCK, close_words, table) ||
      !laves__parallel_for(context, NULL, LAVES__FACE_SHARDS, 1, drop_faces, table))
    return false;
  rename_labels(table);
  rebuilding r = {table, capacity_for(table, counts)};
  if (!laves__parallel_for(context, NULL, LAVES__FACE_SHARDS, 1, rebuild_shards, &r) || atomic_load(&table->failed)) return false;
  const bool enough = grow_labels(table, labels, r.capacity * LAVES__FACE_SHARDS);
  if (!enough) atomic_store(&table->failed, true);
  return enough;
}

bool laves__face_table_reserve(laves__face_table *table, const size_t counts[LAVES__FACE_SHARDS], size_t labels,
                               uint32_t *label) {
  bool room = table->label_count + labels <= table->label_capacity;
  for (size_t s = 0; s < LAVES__FACE_SHARDS; s++)
    room = room && table->shards[s].count + counts[s] <= table->shards[s].capacity / 5 * 4;
  if (!room && !sweep(table, counts, labels)) return false;
  *label = (uint32_t)table->label_count;
  for (size_t i = 0; i < labels; i++)
    atomic_store_explicit(&table->parents[table->label_count + i], *label + (uint32_t)i, memory_order_relaxed);
  table->label_count += labels;
  return true;
}

/* ---- tets ---- */

void laves__face_table_use(laves__face_table *table, int32_t vertex) {
  const size_t v = (size_t)vertex;
  if (add_bit(table->used, v) || !has_bit(table->closed, v)) return;
  if (add_bit(table->reopened, v)) atomic_store_explicit(&table->was_reopened, true, memory_order_relaxed);
}

static void insert(laves__face_table *table, laves__face_shard *into, const laves__face_entry *record, size_t place,
                   uint32_t label) {
  laves__face_entry *entry = find_entry(into, record->corners, place);
  const laves__face_state state = laves__face_state_of(entry);
  if (state == LAVES__FACE_NONE) {
    *entry = *record;
    entry->label += label;
    into->count++;
    return;
  }
  unite(table, entry->label, label + record->label);
  const bool fits = state == LAVES__FACE_OPEN && ascends(entry) != ascends(record);
  set_state(entry, fits ? LAVES__FACE_MATCHED : LAVES__FACE_BAD);
}

/* Places are looked up some records ahead, so that memory has time to bring them. */
void laves__face_table_insert(laves__face_table *table, size_t shard, const laves__face_entry *records, size_t count,
                              uint32_t label) {
  enum { AHEAD = 16 };
  laves__face_shard *into = &table->shards[shard];
  size_t places[AHEAD];
  for (size_t i = 0; i < count + AHEAD; i++) {
    if (i >= AHEAD) insert(table, into, &records[i - AHEAD], places[i % AHEAD], label);
    if (i >= count) continue;
    places[i % AHEAD] = place_in(into, records[i].corners);
    __builtin_prefetch(&into->entries[places[i % AHEAD]], 1);
  }
}

/* ---- what is left ---- */

size_t laves__face_table_used(const laves__face_table *table) {
  size_t count = 0;
  for (size_t i = 0; i < word_count(table); i++)
    count += (size_t)__builtin_popcountll(atomic_load_explicit(&table->used[i], memory_order_relaxed));
  return count;
}

size_t laves__face_table_count(const laves__face_table *table, laves__face_state state) {
  size_t count = 0;
  for (size_t s = 0; s < LAVES__FACE_SHARDS; s++)
    for (size_t i = 0; i < table->shards[s].capacity; i++) count += laves__face_state_of(&table->shards[s].entries[i]) == state;
  return count;
}

void laves__face_table_copy(const laves__face_table *table, laves__face_state state, laves__face_entry *entries) {
  for (size_t s = 0; s < LAVES__FACE_SHARDS; s++)
    for (size_t i = 0; i < table->shards[s].capacity; i++)
      if (laves__face_state_of(&table->shards[s].entries[i]) == state) *entries++ = table->shards[s].entries[i];
}
