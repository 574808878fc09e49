/* The boundary of a mesh that stays in its file.
 *
 * The faces that kept a single tet are put in the order of their tets, and their vertices are numbered anew, in the order of the
 * old numbers; the points of those are fetched. What results is small enough to be handled in memory, by the same code as the
 * boundary of any mesh: as a mesh without tets whose faces are all there is.
 *
 * Then the triangles that the file holds are looked up among these faces. */
#include <string.h>

#include "certify/check_stream.h"

enum { TRIANGLES_AT_ONCE = 1 << 12, WORDS_BETWEEN_ASKING = 1 << 8, FACES_BETWEEN_ASKING = 1 << 16 };

/* A set of vertices that knows how many of its members come before another. */
typedef struct ranking {
  uint64_t *bits;   /* [words] */
  uint32_t *before; /* [words] members in earlier words */
  size_t words, count;
} ranking;

typedef struct outline {
  laves_context *context;
  laves__boundary boundary; /* in new numbers */
  ranking ranks;
  laves__vec3 *points; /* [ranks.count] */
  /* For the triangles: */
  uint32_t *table; /* [table_size] 1 + a face of the boundary; 0: none */
  size_t table_size;
  uint8_t *seen; /* [boundary.count] */
} outline;

static void free_outline(outline *o) {
  laves_context *context = o->context;
  laves__free(context, o->seen, o->boundary.count, 1);
  laves__boundary_free(&o->boundary);
  laves__free(context, o->ranks.bits, o->ranks.words, sizeof *o->ranks.bits);
  laves__free(context, o->ranks.before, o->ranks.words, sizeof *o->ranks.before);
  laves__free(context, o->points, o->ranks.count, sizeof *o->points);
  laves__free(context, o->table, o->table_size, sizeof *o->table);
}

/* ---- vertices ---- */

static bool is_member(const ranking *r, int32_t vertex) { return r->bits[vertex / 64] >> vertex % 64 & 1; }

/* The new number of a member. */
static int32_t rank_of(const ranking *r, int32_t vertex) {
  const uint64_t lower = r->bits[vertex / 64] & ((UINT64_C(1) << vertex % 64) - 1);
  return (int32_t)(r->before[vertex / 64] + (uint32_t)__builtin_popcountll(lower));
}

static laves_result rank_vertices(outline *o, size_t vertex_count, laves_error *error) {
  ranking *r = &o->ranks;
  r->words = vertex_count / 64 + 1;
  r->bits = laves__alloc_zeroed(o->context, r->words, sizeof *r->bits);
  r->before = laves__alloc(o->context, r->words, sizeof *r->before);
  if (!r->bits || !r->before) return laves__fail_memory(o->context, error);
  if (laves__cancelled(o->context, "check", 0.8)) return laves__fail_cancelled(error);
  for (size_t i = 0; i < o->boundary.count; i++)
    for (int j = 0; j < 3; j++) {
      const int32_t vertex = o->boundary.faces[i][j];
      r->bits[vertex / 64] |= UINT64_C(1) << vertex % 64;
    }
  size_t count = 0;
  for (size_t i = 0; i < r->words; i++) {
    r->before[i] = (uint32_t)count;
    count += (size_t)__builtin_popcountll(r->bits[i]);
  }
  o->points = laves__alloc(o->context, count, sizeof *o->points);
  if (!o->points) return laves__fail_memory(o->context, error);
  r->count = count;
  if (laves__cancelled(o->context, "check", 0.8)) return laves__fail_cancelled(error);
  for (size_t i = 0; i < o->boundary.count; i++)
    for (int j = 0; j < 3; j++) o->boundary.faces[i][j] = rank_of(r, o->boundary.faces[i][j]);
  return LAVES_OK;
}

static laves_result fetch_points(outline *o, laves__point_cache *cache, laves_error *error) {
  size_t next = 0;
  for (size_t w = 0; w < o->ranks.words; w++) {
    if (w % WORDS_BETWEEN_ASKING == 0 && laves__cancelled(o->context, "check", 0.8)) return laves__fail_cancelled(error);
    for (uint64_t bits = o->ranks.bits[w]; bits; bits &= bits - 1) {
      const int32_t vertex = (int32_t)(64 * w + (size_t)__builtin_ctzll(bits));
      const laves_result result = laves__point_cache_get(cache, vertex, &o->points[next++], error);
      if (result != LAVES_OK) return result;
    }
  }
  return LAVES_OK;
}

/* ---- faces ---- */

/* Puts the entries in the order of their slots, as triangles outwards. */
static laves_result order_faces(outline *o, const laves__face_entry *entries, size_t count, laves_error *error) {
  laves_context *context = o->context;
  laves_result result = LAVES_OK;
  laves__keyed *order = laves__alloc(context, count, sizeof *order);
  laves__keyed *scratch = laves__alloc(context, count, sizeof *scratch);
  int32_t(*faces)[3] = laves__alloc(context, count, sizeof *faces);
  if (!order || !scratch || !faces) {
    laves__free(context, faces, count, sizeof *faces);
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  o->boundary = (laves__boundary){context, count, faces};
  for (size_t i = 0; i < count; i++) order[i] = (laves__keyed){laves__face_slot(&entries[i]), i};
  if (!laves__sort_keyed(context, order, scratch, count)) {
    result = laves__fail_cancelled(error);
    goto clean_up;
  }
  for (size_t i = 0; i < count; i++) laves__face_outwards_of(&entries[order[i].value], faces[i]);
clean_up:
  laves__free(context, order, count, sizeof *order);
  laves__free(context, scratch, count, sizeof *scratch);
  return result;
}

/* Takes what is needed of the table and frees it. */
static laves_result take_faces(outline *o, laves__face_table *table, laves_error *error) {
  const size_t count = laves__face_table_count(table, LAVES__FACE_OPEN), vertex_count = table->vertex_count;
  laves__face_entry *entries = laves__alloc(o->context, count, sizeof *entries);
  if (!entries) return laves__fail_memory(o->context, error);
  laves__face_table_copy(table, LAVES__FACE_OPEN, entries);
  laves__face_table_free(table);
  laves_result result = order_faces(o, entries, count, error);
  laves__free(o->context, entries, count, sizeof *entries);
  if (result == LAVES_OK) result = rank_vertices(o, vertex_count, error);
  return result;
}

/* ---- the triangles of the file ---- */

static void sorted(const int32_t face[3], int32_t out[3]) {
  const int32_t a = face[0], b = face[1], c = face[2];
  const int32_t low = a < b ? a : b, high = a < b ? b : a;
  out[0] = low < c ? low : c;
  out[2] = high > c ? high : c;
  out[1] = low < c ? (high < c ? high : c) : low;
}

static size_t place_of(const outline *o, const int32_t corners[3]) {
  uint64_t h = (uint64_t)(uint32_t)corners[0] * UINT64_C(0x9e3779b97f4a7c15);
  h = (h ^ h >> 32 ^ (uint32_t)corners[1]) * UINT64_C(0xc2b2ae3d27d4eb4f);
  h = (h ^ h >> 32 ^ (uint32_t)corners[2]) * UINT64_C(0xd6e8feb86659fd93);
  return (size_t)((h ^ h >> 32) % o->table_size);
}

/* The place in the table where the face with these corners, ascending, is or would be. */
static size_t find_place(const outline *o, const int32_t corners[3]) {
  for (size_t i = place_of(o, corners);; i = i + 1 < o->table_size ? i + 1 : 0) {
    int32_t other[3];
    if (o->table[i] == 0) return i;
    sorted(o->boundary.faces[o->table[i] - 1], other);
    if (memcmp(other, corners, sizeof other) == 0) return i;
  }
}

static laves_result make_lookup(outline *o, laves_error *error) {
  const size_t size = 2 * o->boundary.count + 1;
  o->table = laves__alloc_zeroed(o->context, size, sizeof *o->table);
  o->table_size = o->table ? size : 0;
  o->seen = laves__alloc_zeroed(o->context, o->boundary.count, 1);
  if (!o->table || !o->seen) return laves__fail_memory(o->context, error);
  for (size_t i = 0; i < o->boundary.count; i++) {
    int32_t corners[3];
    if (i % FACES_BETWEEN_ASKING == 0 && laves__cancelled(o->context, "check", 0.8)) return laves__fail_cancelled(error);
    sorted(o->boundary.faces[i], corners);
    o->table[find_place(o, corners)] = (uint32_t)i + 1;
  }
  return LAVES_OK;
}

/* Whether two triangles with the same corners go round the same way. */
static bool same_turn(const int32_t a[3], const int32_t b[3]) {
  for (int i = 0; i < 3; i++)
    if (a[i] == b[0]) return a[(i + 1) % 3] == b[1];
  return false;
}

static void look_up(outline *o, const int32_t triangle[4], laves_file_check *check) {
  int32_t renamed[3], corners[3];
  check->file_faces++;
  for (int j = 0; j < 3; j++) {
    if (!is_member(&o->ranks, triangle[j])) {
      check->file_faces_elsewhere++;
      return;
    }
    renamed[j] = rank_of(&o->ranks, triangle[j]);
  }
  sorted(renamed, corners);
  const uint32_t face = o->table[find_place(o, corners)];
  if (face == 0 || o->seen[face - 1]) {
    check->file_faces_elsewhere++;
    return;
  }
  o->seen[face - 1] = 1;
  if (!same_turn(o->boundary.faces[face - 1], renamed)) check->file_faces_turned++;
}

static laves_result compare_triangles(outline *o, laves__mesh_stream *stream, laves_file_check *check, laves_error *error) {
  int32_t triangles[TRIANGLES_AT_ONCE][4];
  size_t count = 0;
  if (stream->triangle_count == 0) return LAVES_OK;
  laves_result result = make_lookup(o, error);
  stream->rewind(stream->user, 3);
  do {
    if (result == LAVES_OK) result = stream->next(stream->user, triangles, TRIANGLES_AT_ONCE, &count, error);
    if (result == LAVES_OK && laves__cancelled(o->context, "check", 0.8)) result = laves__fail_cancelled(error);
    for (size_t i = 0; i < count && result == LAVES_OK; i++) look_up(o, triangles[i], check);
  } while (result == LAVES_OK && count > 0);
  for (size_t i = 0; i < o->boundary.count && result == LAVES_OK; i++) check->file_faces_missing += !o->seen[i];
  return result;
}

/* ---- all ---- */

laves_result laves__check_stream_boundary(laves_context *context, laves__face_table *table, laves__point_cache *cache,
                                          const laves_domain *domain, laves_file_check *check, laves_error *error) {
  outline o = {.context = context};
  laves__faults faults;
  laves__samples samples = {0};
  laves_result result = take_faces(&o, table, error);
  if (result == LAVES_OK) result = fetch_points(&o, cache, error);
  if (result == LAVES_OK) result = compare_triangles(&o, cache->stream, check, error);
  laves__point_cache_free(cache);
  laves__free(context, o.table, o.table_size, sizeof *o.table);
  o.table = NULL;
  const laves_mesh surface = {.context = context,
                              .vertex_count = o.ranks.count,
                              .points = o.points,
                              .face_count = o.boundary.count,
                              .faces = o.boundary.faces};
  check->check.faces = o.boundary.count;
  if (result == LAVES_OK) result = laves__check_boundary(context, &surface, &o.boundary, &check->check, &faults, error);
  if (result == LAVES_OK) result = laves__check_area(context, &surface, &o.boundary, &check->check, error);
  if (result == LAVES_OK && domain)
    result = laves__check_distances(context, &surface, &o.boundary, domain, &check->check, &samples, error);
  laves__samples_free(&samples);
  free_outline(&o);
  return result;
}
