/* Which faces of tetrahedra coincide.
 *
 * The faces are put into buckets by their lowest vertex (a counting sort), and each bucket, about twenty faces in a
 * usual mesh, is sorted by the other two vertices and the slot, so that equal faces stand side by side. Buckets are
 * independent and done in parallel; so are counting and filling, with atomic cursors. To keep memory low the lowest vertices are
 * taken range by range: a range holds about a quarter of all faces, and each range costs one more pass over the tets, which
 * leaves out chunks of tets that have no face in it: near tets mostly have near numbers. */
#include "mesh/face_match.h"

#include <stdatomic.h>

enum {
  RANGES = 4,
  RANGE_FACES_MIN = 1 << 20, /* a range this small needs 16 MB; more ranges would save nothing worth having */
  BUCKETS_PER_BLOCK = 256,
  INSERTION_MAX = 48, /* longer buckets are sorted by heap, so that hostile fans cost n log n */
  CHUNK_TETS = 1 << 12,
  CHUNKS_PER_BLOCK = 4,
};

/* Which vertices are the lowest of a face of some tet in a chunk: none outside [low, high]. */
typedef struct chunk {
  int32_t low, high;
} chunk;

void laves__face_outwards(const int32_t tet[4], int face, int orientation, int32_t corners[3]) {
  const uint8_t *f = laves__tet_face[face];
  corners[0] = tet[f[0]];
  corners[1] = tet[f[orientation < 0 ? 2 : 1]];
  corners[2] = tet[f[orientation < 0 ? 1 : 2]];
}

/* ---- sorting of one bucket ---- */

static bool before(const laves__face_use *a, const laves__face_use *b) {
  if (a->middle != b->middle) return a->middle < b->middle;
  if (a->high != b->high) return a->high < b->high;
  return a->slot < b->slot;
}

static void insertion_sort(laves__face_use *uses, size_t count) {
  for (size_t i = 1; i < count; i++) {
    const laves__face_use use = uses[i];
    size_t j = i;
    for (; j > 0 && before(&use, &uses[j - 1]); j--) uses[j] = uses[j - 1];
    uses[j] = use;
  }
}

static void sift_down(laves__face_use *uses, size_t root, size_t count) {
  const laves__face_use use = uses[root];
  for (;;) {
    size_t child = 2 * root + 1;
    if (child >= count) break;
    if (child + 1 < count && before(&uses[child], &uses[child + 1])) child++;
    if (!before(&use, &uses[child])) break;
    uses[root] = uses[child];
    root = child;
  }
  uses[root] = use;
}

static void heap_sort(laves__face_use *uses, size_t count) {
  for (size_t i = count / 2; i-- > 0;) sift_down(uses, i, count);
  for (size_t i = count; i-- > 1;) {
    const laves__face_use top = uses[0];
    uses[0] = uses[i];
    uses[i] = top;
    sift_down(uses, 0, i);
  }
}

/* ---- ranges of lowest vertices ---- */

typedef struct matcher {
  laves_context *context;
  const char *phase;
  const int32_t (*tets)[4];
  size_t tet_count, vertex_count;
  bool alone;    /* one worker: cursors need no locked instructions, which cost more than all else */
  chunk *chunks; /* [chunk_count] */
  size_t chunk_count;
  _Atomic uint64_t *start; /* [vertex_count + 1] where the bucket of each lowest vertex starts, over all ranges */
  laves__face_use *uses;
  uint64_t first; /* start of the range in hand: uses[0] is number `first` */
  size_t vertex_begin, vertex_end;
  laves__face_group_fn *fn;
  void *user;
} matcher;

/* A corner's vertex above its index, so that both are sorted in one. */
static uint64_t labelled(const int32_t tet[4], int i) { return (uint64_t)tet[i] << 2 | (uint64_t)i; }

static void order_two(uint64_t *a, uint64_t *b) {
  const uint64_t low = *a < *b ? *a : *b, high = *a < *b ? *b : *a;
  *a = low;
  *b = high;
}

/* The four vertices ascending: the lowest vertex of each face is corner[0], but for the face opposite it. Always the same five
 * comparisons, which compilers make without a jump. */
static void sort_corners(const int32_t tet[4], int32_t corner[4], uint8_t index[4]) {
  uint64_t key[4] = {labelled(tet, 0), labelled(tet, 1), labelled(tet, 2), labelled(tet, 3)};
  order_two(&key[0], &key[1]);
  order_two(&key[2], &key[3]);
  order_two(&key[0], &key[2]);
  order_two(&key[1], &key[3]);
  order_two(&key[1], &key[2]);
  for (int i = 0; i < 4; i++) {
    corner[i] = (int32_t)(key[i] >> 2);
    index[i] = (uint8_t)(key[i] & 3);
  }
}

static uint64_t add(matcher *m, int32_t vertex, uint64_t faces) {
  if (!m->alone) return atomic_fetch_add_explicit(&m->start[vertex], faces, memory_order_relaxed);
  const uint64_t before = atomic_load_explicit(&m->start[vertex], memory_order_relaxed);
  atomic_store_explicit(&m->start[vertex], before + faces, memory_order_relaxed);
  return before;
}

static uint64_t start_of(const matcher *m, size_t vertex) {
  return atomic_load_explicit(&m->start[vertex], memory_order_relaxed);
}

static void set_start(matcher *m, size_t vertex, uint64_t start) {
  atomic_store_explicit(&m->start[vertex], start, memory_order_relaxed);
}

static size_t chunk_end(const matcher *m, size_t k) {
  const size_t end = (k + 1) * CHUNK_TETS;
  return end < m->tet_count ? end : m->tet_count;
}

/* Counts bucket v into start[v + 1]. Counters are shared by all threads: sums don't depend on the order. */
static void count_chunks(void *user, size_t begin, size_t end, int worker) {
  matcher *m = user;
  (void)worker;
  for (size_t k = begin; k < end; k++) {
    chunk seen = {INT32_MAX, -1};
    for (size_t t = k * CHUNK_TETS; t < chunk_end(m, k); t++) {
      if (!laves__tet_usable(m->tets[t], m->vertex_count)) continue;
      int32_t corner[4];
      uint8_t index[4];
      sort_corners(m->tets[t], corner, index);
      add(m, corner[0] + 1, 3);
      add(m, corner[1] + 1, 1);
      if (corner[0] < seen.low) seen.low = corner[0];
      if (corner[1] > seen.high) seen.high = corner[1];
    }
    m->chunks[k] = seen;
  }
}

/* Puts the faces of a tet into the buckets of the range; start[v] is the cursor of bucket v. */
static void fill_tet(matcher *m, size_t t) {
  int32_t c[4];
  uint8_t index[4];
  sort_corners(m->tets[t], c, index);
  const uint64_t slot = 4 * (uint64_t)t;
  if ((size_t)c[0] >= m->vertex_begin && (size_t)c[0] < m->vertex_end) {
    laves__face_use *use = &m->uses[add(m, c[0], 3) - m->first];
    use[0] = (laves__face_use){(uint32_t)c[1], (uint32_t)c[2], slot + index[3]};
    use[1] = (laves__face_use){(uint32_t)c[1], (uint32_t)c[3], slot + index[2]};
    use[2] = (laves__face_use){(uint32_t)c[2], (uint32_t)c[3], slot + index[1]};
  }
  if ((size_t)c[1] >= m->vertex_begin && (size_t)c[1] < m->vertex_end)
    m->uses[add(m, c[1], 1) - m->first] = (laves__face_use){(uint32_t)c[2], (uint32_t)c[3], slot + index[0]};
}

/* The order within a bucket depends on the threads, but the bucket is sorted afterwards and no two of its faces are equal. */
static void fill_chunks(void *user, size_t begin, size_t end, int worker) {
  matcher *m = user;
  (void)worker;
  for (size_t k = begin; k < end; k++) {
    const chunk *seen = &m->chunks[k];
    if (seen->high < 0 || (size_t)seen->high < m->vertex_begin || (size_t)seen->low >= m->vertex_end) continue;
    for (size_t t = k * CHUNK_TETS; t < chunk_end(m, k); t++)
      if (laves__tet_usable(m->tets[t], m->vertex_count)) fill_tet(m, t);
  }
}

/* After filling, each cursor stands where the next bucket starts: moves them back by one place. */
static void reset_cursors(matcher *m) {
  for (size_t v = m->vertex_end - 1; v > m->vertex_begin; v--) set_start(m, v, start_of(m, v - 1));
  set_start(m, m->vertex_begin, m->first);
}

/* Sorts buckets and hands out their groups: each bucket belongs to one block, so blocks share nothing. */
static void group_block(void *user, size_t begin, size_t end, int worker) {
  const matcher *m = user;
  for (size_t v = m->vertex_begin + begin; v < m->vertex_begin + end; v++) {
    laves__face_use *uses = m->uses + (start_of(m, v) - m->first);
    const size_t count = start_of(m, v + 1) - start_of(m, v);
    if (count <= INSERTION_MAX)
      insertion_sort(uses, count);
    else
      heap_sort(uses, count);
    for (size_t i = 0, j; i < count; i = j) {
      for (j = i + 1; j < count && uses[j].middle == uses[i].middle && uses[j].high == uses[i].high;) j++;
      m->fn(m->user, (uint32_t)v, uses + i, j - i, worker);
    }
  }
}

/* The end of the range that begins at `begin`: as many buckets as fit into `capacity`, at least one. */
static size_t range_end(const matcher *m, size_t begin, size_t capacity) {
  size_t end = begin + 1;
  while (end < m->vertex_count && start_of(m, end + 1) - start_of(m, begin) <= capacity) end++;
  return end;
}

/* The faces in the largest range. */
static size_t largest_range(const matcher *m, size_t capacity) {
  size_t largest = 0;
  for (size_t begin = 0, end; begin < m->vertex_count; begin = end) {
    end = range_end(m, begin, capacity);
    const size_t faces = start_of(m, end) - start_of(m, begin);
    if (faces > largest) largest = faces;
  }
  return largest;
}

static bool count_buckets(matcher *m) {
  if (!laves__parallel_for(m->context, m->phase, m->chunk_count, CHUNKS_PER_BLOCK, count_chunks, m)) return false;
  for (size_t v = 0; v < m->vertex_count; v++) set_start(m, v + 1, start_of(m, v + 1) + start_of(m, v));
  return true;
}

static bool match_range(matcher *m) {
  m->first = start_of(m, m->vertex_begin);
  if (!laves__parallel_for(m->context, m->phase, m->chunk_count, CHUNKS_PER_BLOCK, fill_chunks, m)) return false;
  reset_cursors(m);
  return laves__parallel_for(m->context, m->phase, m->vertex_end - m->vertex_begin, BUCKETS_PER_BLOCK, group_block, m);
}

laves_result laves__match_faces(laves_context *context, const char *phase, const int32_t (*tets)[4], size_t tet_count,
                                size_t vertex_count, laves__face_group_fn *fn, void *user, laves_error *error) {
  laves_result result = LAVES_OK;
  matcher m = {.context = context,
               .phase = phase,
               .tets = tets,
               .tet_count = tet_count,
               .vertex_count = vertex_count,
               .alone = laves__workers(context) == 1,
               .chunk_count = (tet_count + CHUNK_TETS - 1) / CHUNK_TETS,
               .fn = fn,
               .user = user};
  size_t largest = 0;
  m.start = laves__alloc_zeroed(context, vertex_count + 1, sizeof *m.start);
  m.chunks = laves__alloc(context, m.chunk_count, sizeof *m.chunks);
  if (!m.start || !m.chunks) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  bool complete = count_buckets(&m);
  size_t capacity = start_of(&m, vertex_count) / RANGES + 1;
  if (capacity < RANGE_FACES_MIN) capacity = RANGE_FACES_MIN;
  if (complete) largest = largest_range(&m, capacity);
  m.uses = laves__alloc(context, largest, sizeof *m.uses);
  if (!m.uses) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  for (; complete && m.vertex_begin < vertex_count; m.vertex_begin = m.vertex_end) {
    m.vertex_end = range_end(&m, m.vertex_begin, capacity);
    complete = match_range(&m);
  }
  if (!complete) result = laves__fail_cancelled(error);
clean_up:
  laves__free(context, m.uses, largest, sizeof *m.uses);
  laves__free(context, m.chunks, m.chunk_count, sizeof *m.chunks);
  laves__free(context, m.start, vertex_count + 1, sizeof *m.start);
  return result;
}

/* ---- boundary ---- */

static void mark_single(void *user, uint32_t low, const laves__face_use *uses, size_t count, int worker) {
  uint8_t *single = user;
  (void)low;
  (void)worker;
  if (count == 1) single[uses[0].slot] = 1;
}

laves_result laves__boundary_slots(laves_context *context, const char *phase, const int32_t (*tets)[4], size_t tet_count,
                                   size_t vertex_count, uint64_t **slots, size_t *count, laves_error *error) {
  *slots = NULL;
  *count = 0;
  uint8_t *single = laves__alloc_zeroed(context, tet_count, 4);
  if (!single) return laves__fail_memory(context, error);
  laves_result result = laves__match_faces(context, phase, tets, tet_count, vertex_count, mark_single, single, error);
  if (result != LAVES_OK) goto clean_up;
  for (size_t i = 0; i < 4 * tet_count; i++) *count += single[i];
  *slots = laves__alloc(context, *count, sizeof **slots);
  if (!*slots) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  size_t filled = 0;
  for (size_t i = 0; i < 4 * tet_count; i++)
    if (single[i]) (*slots)[filled++] = i;
clean_up:
  laves__free(context, single, tet_count, 4);
  return result;
}
