/* Whether the boundary of a mesh is a closed 2-manifold, and of which kind.
 *
 * The edges of the boundary's triangles are sorted by their ends; each must occur exactly twice. Triangles are united
 * across edges: what remains are the boundary's components. The corners of triangles are united across edges too, each
 * with the corner at the same vertex: what remains are fans, of which every vertex must have one. With fans for vertices
 * Euler's formula V - E + F = 2 components - 2 genus gives the genus.
 *
 * The faces that the mesh stores must be these very triangles, in any order and rotation. */
#include <string.h>

#include "certify/certify.h"

/* ---- union-find ---- */

static size_t find_root(size_t *parent, size_t i) {
  while (parent[i] != i) {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

static void unite(size_t *parent, size_t a, size_t b) {
  a = find_root(parent, a);
  b = find_root(parent, b);
  if (a < b) parent[b] = a;
  if (b < a) parent[a] = b;
}

static size_t count_roots(const size_t *parent, size_t count) {
  size_t roots = 0;
  for (size_t i = 0; i < count; i++) roots += parent[i] == i;
  return roots;
}

/* ---- edges, fans and components ---- */

typedef struct seams {
  const int32_t (*faces)[3];
  size_t face_count, vertex_count;
  laves__keyed *edges, *scratch; /* [3 face_count] key: ends ascending; value: 3 face + the corner it starts from */
  size_t *face_parent;           /* [face_count] */
  size_t *corner_parent;         /* [3 face_count] */
  uint8_t *fans;                 /* [vertex_count] 0, 1, or 2 for more */
  laves__faults *faults;
} seams;

static void list_edges(seams *s) {
  for (size_t corner = 0; corner < 3 * s->face_count; corner++) {
    const uint64_t a = (uint64_t)s->faces[corner / 3][corner % 3];
    const uint64_t b = (uint64_t)s->faces[corner / 3][(corner + 1) % 3];
    s->edges[corner] = (laves__keyed){a < b ? a << 32 | b : b << 32 | a, corner};
    s->corner_parent[corner] = corner;
  }
  for (size_t face = 0; face < s->face_count; face++) s->face_parent[face] = face;
}

/* Unites two triangles and their corners at both ends of an edge that they share. */
static void join(seams *s, size_t corner_a, size_t corner_b) {
  const size_t a = corner_a / 3, b = corner_b / 3;
  const size_t end_a = 3 * a + (corner_a + 1) % 3, end_b = 3 * b + (corner_b + 1) % 3;
  const bool opposite = s->faces[a][corner_a % 3] != s->faces[b][corner_b % 3];
  unite(s->face_parent, a, b);
  unite(s->corner_parent, corner_a, opposite ? end_b : corner_b);
  unite(s->corner_parent, end_a, opposite ? corner_b : end_b);
}

static void note_edge(laves__faults *faults, uint64_t key, size_t *count) {
  if (*count < LAVES_PLACE_CAPACITY) {
    faults->edges[*count][0] = (int32_t)(key >> 32);
    faults->edges[*count][1] = (int32_t)(key & UINT32_MAX);
  }
  ++*count;
}

static void note_vertex(laves__faults *faults, int32_t vertex, size_t *count) {
  if (*count < LAVES_PLACE_CAPACITY) faults->vertices[*count] = vertex;
  ++*count;
}

/* Returns the number of different edges, and in *nonmanifold that of edges without exactly two triangles. */
static size_t sew(seams *s, size_t *nonmanifold) {
  const size_t count = 3 * s->face_count;
  size_t edges = 0;
  *nonmanifold = 0;
  for (size_t i = 0, j; i < count; i = j, edges++) {
    for (j = i + 1; j < count && s->edges[j].key == s->edges[i].key; j++) join(s, s->edges[i].value, s->edges[j].value);
    if (j - i != 2) note_edge(s->faults, s->edges[i].key, nonmanifold);
  }
  return edges;
}

/* Returns the number of fans; vertices with more than one are counted in *nonmanifold. */
static size_t count_fans(seams *s, size_t *nonmanifold) {
  size_t total = 0;
  *nonmanifold = 0;
  for (size_t corner = 0; corner < 3 * s->face_count; corner++) {
    if (s->corner_parent[corner] != corner) continue;
    const int32_t vertex = s->faces[corner / 3][corner % 3];
    uint8_t *fans = &s->fans[vertex];
    total++;
    if (*fans == 1) note_vertex(s->faults, vertex, nonmanifold);
    if (*fans < 2) ++*fans;
  }
  return total;
}

static laves_result check_seams(laves_context *context, seams *s, laves_check *check, laves_error *error) {
  const size_t corners = 3 * s->face_count;
  laves_result result = LAVES_OK;
  s->edges = laves__alloc(context, corners, sizeof *s->edges);
  s->scratch = laves__alloc(context, corners, sizeof *s->scratch);
  s->face_parent = laves__alloc(context, s->face_count, sizeof *s->face_parent);
  s->corner_parent = laves__alloc(context, corners, sizeof *s->corner_parent);
  s->fans = laves__alloc_zeroed(context, s->vertex_count, sizeof *s->fans);
  if (!s->edges || !s->scratch || !s->face_parent || !s->corner_parent || !s->fans) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  size_t edges = 0, fans = 0;
  bool go_on = !laves__cancelled(context, "check", 0.8);
  if (go_on) list_edges(s);
  go_on = go_on && laves__sort_keyed(context, s->edges, s->scratch, corners);
  if (go_on) edges = sew(s, &check->nonmanifold_edges);
  go_on = go_on && !laves__cancelled(context, "check", 0.9);
  if (go_on) fans = count_fans(s, &check->nonmanifold_vertices);
  if (!go_on) {
    result = laves__fail_cancelled(error);
    goto clean_up;
  }
  check->boundary_components = count_roots(s->face_parent, s->face_count);
  check->genus = (2 * (int64_t)check->boundary_components - ((int64_t)fans - (int64_t)edges + (int64_t)s->face_count)) / 2;
clean_up:
  laves__free(context, s->edges, corners, sizeof *s->edges);
  laves__free(context, s->scratch, corners, sizeof *s->scratch);
  laves__free(context, s->face_parent, s->face_count, sizeof *s->face_parent);
  laves__free(context, s->corner_parent, corners, sizeof *s->corner_parent);
  laves__free(context, s->fans, s->vertex_count, sizeof *s->fans);
  return result;
}

/* ---- the faces that the mesh stores ---- */

/* The same triangle with its lowest index first. */
static void rotate(const int32_t face[3], uint32_t rotated[3]) {
  int first = 0;
  for (int i = 1; i < 3; i++)
    if (face[i] < face[first]) first = i;
  for (int i = 0; i < 3; i++) rotated[i] = (uint32_t)face[(first + i) % 3];
}

static bool same_face(const int32_t a[3], const int32_t b[3]) {
  uint32_t x[3], y[3];
  rotate(a, x);
  rotate(b, y);
  return memcmp(x, y, sizeof x) == 0;
}

/* Sorts the numbers of the faces by their rotated corners: last corner first, since the sort keeps the order of equals. */
static void sort_faces(const int32_t (*faces)[3], size_t count, laves__keyed *items, laves__keyed *scratch) {
  uint32_t r[3];
  for (size_t i = 0; i < count; i++) {
    rotate(faces[i], r);
    items[i] = (laves__keyed){r[2], i};
  }
  laves__sort_keyed(NULL, items, scratch, count);
  for (size_t i = 0; i < count; i++) {
    rotate(faces[items[i].value], r);
    items[i].key = (uint64_t)r[0] << 32 | r[1];
  }
  laves__sort_keyed(NULL, items, scratch, count);
}

static int compare_faces(const int32_t a[3], const int32_t b[3]) {
  uint32_t x[3], y[3];
  rotate(a, x);
  rotate(b, y);
  for (int i = 0; i < 3; i++)
    if (x[i] != y[i]) return x[i] < y[i] ? -1 : 1;
  return 0;
}

/* How many triangles of the longer list are missing from the other, both sorted. */
static size_t count_unmatched(const int32_t (*a)[3], const laves__keyed *order_a, size_t count_a, const int32_t (*b)[3],
                              const laves__keyed *order_b, size_t count_b) {
  size_t i = 0, j = 0, matched = 0;
  while (i < count_a && j < count_b) {
    const int order = compare_faces(a[order_a[i].value], b[order_b[j].value]);
    if (order == 0) matched++;
    if (order <= 0) i++;
    if (order >= 0) j++;
  }
  return (count_a > count_b ? count_a : count_b) - matched;
}

static bool all_same(const int32_t (*a)[3], const int32_t (*b)[3], size_t count) {
  for (size_t i = 0; i < count; i++)
    if (!same_face(a[i], b[i])) return false;
  return true;
}

static laves_result compare_stored(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                   size_t *different, laves_error *error) {
  const int32_t(*stored)[3] = (const int32_t(*)[3])mesh->faces, (*found)[3] = (const int32_t(*)[3])boundary->faces;
  *different = 0;
  if (mesh->face_count == boundary->count && all_same(stored, found, boundary->count)) return LAVES_OK;
  const size_t most = mesh->face_count > boundary->count ? mesh->face_count : boundary->count;
  laves_result result = LAVES_OK;
  laves__keyed *stored_order = laves__alloc(context, mesh->face_count, sizeof *stored_order);
  laves__keyed *found_order = laves__alloc(context, boundary->count, sizeof *found_order);
  laves__keyed *scratch = laves__alloc(context, most, sizeof *scratch);
  if (!stored_order || !found_order || !scratch) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  sort_faces(stored, mesh->face_count, stored_order, scratch);
  sort_faces(found, boundary->count, found_order, scratch);
  *different = count_unmatched(stored, stored_order, mesh->face_count, found, found_order, boundary->count);
clean_up:
  laves__free(context, stored_order, mesh->face_count, sizeof *stored_order);
  laves__free(context, found_order, boundary->count, sizeof *found_order);
  laves__free(context, scratch, most, sizeof *scratch);
  return result;
}

laves_result laves__check_boundary(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                   laves_check *check, laves__faults *faults, laves_error *error) {
  seams s = {.faces = (const int32_t(*)[3])boundary->faces,
             .face_count = boundary->count,
             .vertex_count = mesh->vertex_count,
             .faults = faults};
  laves_result result = check_seams(context, &s, check, error);
  if (result != LAVES_OK) return result;
  size_t different;
  result = compare_stored(context, mesh, boundary, &different, error);
  if (result == LAVES_OK) check->nonconforming_faces += different;
  return result;
}
