/* Whether the tets of a mesh fit together.
 *
 * Every tet is oriented by the exact predicate. All faces are grouped by their three vertices: a face with one tet
 * belongs to the boundary; one with two is sound when the triangle, turned outwards from each, runs in opposite
 * directions; anything else does not conform. Tets that share a face are united, so the roots that remain are the
 * components. The union-find is shared by all threads: parents only ever fall, and the number of roots at the end does
 * not depend on the order.
 *
 * Per tet: 1 byte for the orientation, 4 for the boundary, 8 for the parent, and 16 for the search. */
#include <stdatomic.h>

#include "base/predicates.h"
#include "certify/certify.h"
#include "mesh/face_match.h"

enum { TETS_PER_BLOCK = 1 << 14, VERTICES_PER_BLOCK = 1 << 16, UNUSABLE = 2 };

typedef struct survey {
  const laves_mesh *mesh;
  int8_t *orientation;    /* [tet_count] -1, 0, 1, or UNUSABLE */
  uint8_t *single;        /* [4 tet_count] by slot: only one tet has the face */
  _Atomic size_t *parent; /* [tet_count] */
  _Atomic uint8_t *used;  /* [vertex_count] */
  atomic_size_t bad_indices, inverted, nonconforming, components, unused;
} survey;

/* ---- tets one by one ---- */

static size_t bad_corners(const int32_t tet[4], size_t vertex_count) {
  size_t bad = 0;
  for (int i = 0; i < 4; i++) {
    bool repeated = false;
    for (int j = 0; j < i; j++) repeated |= tet[j] == tet[i];
    if (repeated || tet[i] < 0 || (size_t)tet[i] >= vertex_count) bad++;
  }
  return bad;
}

/* A tet whose points are not finite has no orientation and counts as flat. */
static void orient_block(void *user, size_t begin, size_t end, int worker) {
  survey *s = user;
  size_t bad = 0, inverted = 0;
  (void)worker;
  for (size_t t = begin; t < end; t++) {
    const int32_t *tet = s->mesh->tets[t];
    laves__vec3 p[4];
    atomic_store_explicit(&s->parent[t], t, memory_order_relaxed);
    s->orientation[t] = UNUSABLE;
    if (!laves__tet_usable(tet, s->mesh->vertex_count)) {
      bad += bad_corners(tet, s->mesh->vertex_count);
      continue;
    }
    s->orientation[t] = laves__tet_corners(s->mesh, t, p) ? (int8_t)laves__orient3d(p[0], p[1], p[2], p[3]) : 0;
    if (s->orientation[t] <= 0) inverted++;
    for (int i = 0; i < 4; i++) atomic_store_explicit(&s->used[tet[i]], 1, memory_order_relaxed);
  }
  atomic_fetch_add(&s->bad_indices, bad);
  atomic_fetch_add(&s->inverted, inverted);
}

/* ---- faces ---- */

static size_t find_root(_Atomic size_t *parent, size_t i) {
  for (;;) {
    const size_t above = atomic_load_explicit(&parent[i], memory_order_relaxed);
    if (above == i) return i;
    const size_t top = atomic_load_explicit(&parent[above], memory_order_relaxed);
    size_t expected = above;
    if (top != above)
      atomic_compare_exchange_weak_explicit(&parent[i], &expected, top, memory_order_relaxed, memory_order_relaxed);
    i = above;
  }
}

/* The higher root gets the lower one as its parent; when another thread was faster, the search starts again. */
static void unite(_Atomic size_t *parent, size_t a, size_t b) {
  for (;;) {
    a = find_root(parent, a);
    b = find_root(parent, b);
    if (a == b) return;
    size_t high = a > b ? a : b;
    const size_t low = a > b ? b : a;
    size_t expected = high;
    if (atomic_compare_exchange_strong_explicit(&parent[high], &expected, low, memory_order_relaxed, memory_order_relaxed))
      return;
  }
}

static void face_of_slot(const survey *s, uint64_t slot, int32_t corners[3]) {
  const size_t tet = slot / 4;
  laves__face_outwards(s->mesh->tets[tet], (int)(slot % 4), s->orientation[tet], corners);
}

/* Whether the outward triangle visits its vertices in ascending order, up to rotation. */
static bool ascends(const survey *s, uint64_t slot) {
  int32_t c[3];
  face_of_slot(s, slot, c);
  return (c[0] < c[1]) + (c[1] < c[2]) + (c[2] < c[0]) == 2;
}

static void face_group(void *user, uint32_t low, const laves__face_use *uses, size_t count, int worker) {
  survey *s = user;
  (void)low;
  (void)worker;
  if (count == 1) {
    s->single[uses[0].slot] = 1;
    return;
  }
  for (size_t i = 1; i < count; i++) unite(s->parent, uses[0].slot / 4, uses[i].slot / 4);
  if (count > 2 || ascends(s, uses[0].slot) == ascends(s, uses[1].slot)) atomic_fetch_add(&s->nonconforming, 1);
}

/* ---- results ---- */

static void count_components(void *user, size_t begin, size_t end, int worker) {
  survey *s = user;
  size_t roots = 0;
  (void)worker;
  for (size_t t = begin; t < end; t++)
    roots += s->orientation[t] != UNUSABLE && atomic_load_explicit(&s->parent[t], memory_order_relaxed) == t;
  atomic_fetch_add(&s->components, roots);
}

static void count_unused(void *user, size_t begin, size_t end, int worker) {
  survey *s = user;
  size_t unused = 0;
  (void)worker;
  for (size_t v = begin; v < end; v++) unused += !atomic_load_explicit(&s->used[v], memory_order_relaxed);
  atomic_fetch_add(&s->unused, unused);
}

static laves_result collect_boundary(laves_context *context, const survey *s, laves__boundary *boundary, laves_error *error) {
  const size_t slots = 4 * s->mesh->tet_count;
  size_t count = 0;
  for (size_t i = 0; i < slots; i++) count += s->single[i];
  int32_t(*faces)[3] = laves__alloc(context, count, sizeof *faces);
  if (!faces) return laves__fail_memory(context, error);
  *boundary = (laves__boundary){context, count, faces};
  count = 0;
  for (size_t i = 0; i < slots; i++)
    if (s->single[i]) face_of_slot(s, i, faces[count++]);
  return LAVES_OK;
}

static laves_result run_survey(laves_context *context, survey *s, laves_error *error) {
  const laves_mesh *mesh = s->mesh;
  if (!laves__parallel_for(context, "check", mesh->tet_count, TETS_PER_BLOCK, orient_block, s))
    return laves__fail_cancelled(error);
  const laves_result result = laves__match_faces(context, "check", (const int32_t(*)[4])mesh->tets, mesh->tet_count,
                                                 mesh->vertex_count, face_group, s, error);
  if (result != LAVES_OK) return result;
  if (!laves__parallel_for(context, "check", mesh->tet_count, TETS_PER_BLOCK, count_components, s) ||
      !laves__parallel_for(context, "check", mesh->vertex_count, VERTICES_PER_BLOCK, count_unused, s))
    return laves__fail_cancelled(error);
  return LAVES_OK;
}

laves_result laves__check_topology(laves_context *context, const laves_mesh *mesh, laves_check *check, laves__boundary *boundary,
                                   laves_error *error) {
  laves_result result = LAVES_OK;
  survey s = {.mesh = mesh};
  s.orientation = laves__alloc(context, mesh->tet_count, sizeof *s.orientation);
  s.single = laves__alloc_zeroed(context, mesh->tet_count, 4);
  s.parent = laves__alloc(context, mesh->tet_count, sizeof *s.parent);
  s.used = laves__alloc_zeroed(context, mesh->vertex_count, sizeof *s.used);
  if (!s.orientation || !s.single || !s.parent || !s.used) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  result = run_survey(context, &s, error);
  if (result != LAVES_OK) goto clean_up;
  check->bad_indices = s.bad_indices;
  check->inverted_tets = s.inverted;
  check->nonconforming_faces = s.nonconforming;
  check->components = s.components;
  check->unused_vertices = s.unused;
  result = collect_boundary(context, &s, boundary, error);
clean_up:
  laves__free(context, s.orientation, mesh->tet_count, sizeof *s.orientation);
  laves__free(context, s.single, mesh->tet_count, 4);
  laves__free(context, s.parent, mesh->tet_count, sizeof *s.parent);
  laves__free(context, s.used, mesh->vertex_count, sizeof *s.used);
  return result;
}
