/* Lengths of the edges, each counted once however many tets share it.
 *
 * The upper ends of all edges of all tets are put into buckets by the lower end; each bucket, about thirty ends of which
 * six or seven differ, is reduced to its different ends in ascending order. Sums are taken over fixed blocks of buckets
 * and added in order. Memory: 24 bytes a tet and 8 a vertex. */
#include <stdatomic.h>

#include "certify/certify.h"
#include "mesh/face_match.h"

enum { TETS_PER_BLOCK = 1 << 14, BLOCK_VERTICES = 1024, INSERTION_MAX = 256 };

typedef struct partial {
  double min, max, sum;
  size_t count;
} partial;

typedef struct edges {
  const laves_mesh *mesh;
  bool alone;              /* one worker: cursors need no locked instructions, which cost more than all else */
  _Atomic uint64_t *start; /* [vertex_count + 1] cursor, then end, of each bucket */
  uint32_t *ends;
  partial *partials;
} edges;

static void order_two(int32_t *a, int32_t *b) {
  const int32_t low = *a < *b ? *a : *b, high = *a < *b ? *b : *a;
  *a = low;
  *b = high;
}

/* The corners ascending: the first is the lower end of three edges, the second of two, the third of one. */
static void sort_corners(const int32_t tet[4], int32_t c[4]) {
  for (int i = 0; i < 4; i++) c[i] = tet[i];
  order_two(&c[0], &c[1]);
  order_two(&c[2], &c[3]);
  order_two(&c[0], &c[2]);
  order_two(&c[1], &c[3]);
  order_two(&c[1], &c[2]);
}

static uint64_t start_of(const edges *e, size_t vertex) { return atomic_load_explicit(&e->start[vertex], memory_order_relaxed); }

/* Adds to a cursor; returns what it was. */
static uint64_t move(edges *e, int32_t vertex, uint64_t by) {
  if (!e->alone) return atomic_fetch_add_explicit(&e->start[vertex], by, memory_order_relaxed);
  const uint64_t before = start_of(e, (size_t)vertex);
  atomic_store_explicit(&e->start[vertex], before + by, memory_order_relaxed);
  return before;
}

static void count_block(void *user, size_t begin, size_t end, int worker) {
  edges *e = user;
  (void)worker;
  for (size_t t = begin; t < end; t++) {
    const int32_t *tet = e->mesh->tets[t];
    int32_t c[4];
    if (!laves__tet_usable(tet, e->mesh->vertex_count)) continue;
    sort_corners(tet, c);
    for (int i = 0; i < 3; i++) move(e, c[i], 3 - (uint64_t)i);
  }
}

/* start[v] is the end of bucket v, counted down to its beginning. The order within a bucket depends on the threads, but
 * only the set of its ends is used. */
static void fill_block(void *user, size_t begin, size_t end, int worker) {
  edges *e = user;
  (void)worker;
  for (size_t t = begin; t < end; t++) {
    const int32_t *tet = e->mesh->tets[t];
    int32_t c[4];
    if (!laves__tet_usable(tet, e->mesh->vertex_count)) continue;
    sort_corners(tet, c);
    for (int i = 0; i < 3; i++) {
      const uint64_t ends = 3 - (uint64_t)i, at = move(e, c[i], 0 - ends) - ends;
      for (int k = i + 1; k < 4; k++) e->ends[at + (uint64_t)(k - i - 1)] = (uint32_t)c[k];
    }
  }
}

/* Keeps the different ends, ascending; returns how many. */
static size_t reduce_short(uint32_t *ends, size_t count) {
  size_t kept = 0;
  for (size_t i = 0; i < count; i++) {
    const uint32_t end = ends[i];
    size_t at = kept;
    while (at > 0 && ends[at - 1] > end) at--;
    if (at > 0 && ends[at - 1] == end) continue;
    for (size_t j = kept; j > at; j--) ends[j] = ends[j - 1];
    ends[at] = end;
    kept++;
  }
  return kept;
}

static void sift_down(uint32_t *ends, size_t root, size_t count) {
  const uint32_t end = ends[root];
  for (size_t child; (child = 2 * root + 1) < count; root = child) {
    if (child + 1 < count && ends[child] < ends[child + 1]) child++;
    if (end >= ends[child]) break;
    ends[root] = ends[child];
  }
  ends[root] = end;
}

/* The same for the long buckets of hostile meshes, in n log n. */
static size_t reduce_long(uint32_t *ends, size_t count) {
  for (size_t i = count / 2; i-- > 0;) sift_down(ends, i, count);
  for (size_t i = count; i-- > 1;) {
    const uint32_t top = ends[0];
    ends[0] = ends[i];
    ends[i] = top;
    sift_down(ends, 0, i);
  }
  size_t kept = 0;
  for (size_t i = 0; i < count; i++)
    if (kept == 0 || ends[kept - 1] != ends[i]) ends[kept++] = ends[i];
  return kept;
}

static void measure_bucket(edges *e, size_t vertex, partial *part) {
  uint32_t *ends = e->ends + start_of(e, vertex);
  const size_t count = start_of(e, vertex + 1) - start_of(e, vertex);
  const size_t kept = count <= INSERTION_MAX ? reduce_short(ends, count) : reduce_long(ends, count);
  for (size_t i = 0; i < kept; i++) {
    const double length = v3_distance(e->mesh->points[vertex], e->mesh->points[ends[i]]);
    if (!isfinite(length)) continue;
    if (length < part->min) part->min = length;
    if (length > part->max) part->max = length;
    part->sum += length;
    part->count++;
  }
}

static void measure_blocks(void *user, size_t begin, size_t end, int worker) {
  edges *e = user;
  (void)worker;
  for (size_t b = begin; b < end; b++) {
    const size_t first = b * BLOCK_VERTICES, last = first + BLOCK_VERTICES;
    e->partials[b] = (partial){.min = INFINITY};
    for (size_t v = first; v < last && v < e->mesh->vertex_count; v++) measure_bucket(e, v, &e->partials[b]);
  }
}

static void report(const edges *e, size_t block_count, laves_check *check) {
  partial all = {.min = INFINITY};
  for (size_t b = 0; b < block_count; b++) {
    all.min = fmin(all.min, e->partials[b].min);
    all.max = fmax(all.max, e->partials[b].max);
    all.sum += e->partials[b].sum;
    all.count += e->partials[b].count;
  }
  if (all.count == 0) return;
  check->edge_min = all.min;
  check->edge_max = all.max;
  check->edge_mean = all.sum / (double)all.count;
}

/* Turns counts into the ends of buckets. */
static uint64_t sum_up(edges *e) {
  uint64_t sum = 0;
  for (size_t v = 0; v <= e->mesh->vertex_count; v++) {
    sum += start_of(e, v);
    atomic_store_explicit(&e->start[v], sum, memory_order_relaxed);
  }
  return sum;
}

laves_result laves__check_edges(laves_context *context, const laves_mesh *mesh, laves_check *check, laves_error *error) {
  const size_t block_count = (mesh->vertex_count + BLOCK_VERTICES - 1) / BLOCK_VERTICES;
  laves_result result = LAVES_OK;
  uint64_t end_count = 0;
  edges e = {.mesh = mesh, .alone = laves__workers(context) == 1};
  e.start = laves__alloc_zeroed(context, mesh->vertex_count + 1, sizeof *e.start);
  e.partials = laves__alloc(context, block_count, sizeof *e.partials);
  if (!e.start || !e.partials) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  bool complete = laves__parallel_for(context, "check", mesh->tet_count, TETS_PER_BLOCK, count_block, &e);
  end_count = sum_up(&e);
  e.ends = laves__alloc(context, end_count, sizeof *e.ends);
  if (!e.ends) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  complete = complete && laves__parallel_for(context, "check", mesh->tet_count, TETS_PER_BLOCK, fill_block, &e) &&
             laves__parallel_for(context, "check", block_count, 1, measure_blocks, &e);
  if (complete)
    report(&e, block_count, check);
  else
    result = laves__fail_cancelled(error);
clean_up:
  laves__free(context, e.ends, end_count, sizeof *e.ends);
  laves__free(context, e.start, mesh->vertex_count + 1, sizeof *e.start);
  laves__free(context, e.partials, block_count, sizeof *e.partials);
  return result;
}
