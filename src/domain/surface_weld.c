/* From the triangles of a file to a surface whose equal points are one point.
 *
 * In: points and triangles as read.  Out: local points that faces use, each once, faces without repeated corners, each
 * once, and the counts and places of what was dropped.
 *
 * Points are equal when all bits of their local coordinates are (-0 counts as 0); a hash table finds them in one pass.
 * Faces are equal when they have the same three points in the same direction; they are found beside their least point.
 * A face and its opposite both stay: they are a wall without thickness, and cancel. */
#include <stdlib.h>
#include <string.h>

#include "domain/defects.h"
#include "domain/surface.h"

static uint64_t mix(uint64_t h, double x) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  h = (h ^ bits) * 0x9e3779b97f4a7c15u;
  return h ^ h >> 32;
}

static uint64_t hash_point(laves__vec3 p) { return mix(mix(mix(0x51ed270b, p.x), p.y), p.z) * 0xff51afd7ed558ccdu >> 20; }

static bool same_point(laves__vec3 a, laves__vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

/* first[i] receives the least index of a point equal to i among those that faces use (used[i]); told: repeats are noted. */
static bool find_equal_points(laves__surface *s, const laves__vec3 *points, const bool *used, size_t count, bool told,
                              uint32_t *first, laves_domain_info *info) {
  size_t slots = 16;
  while (slots < 2 * count) slots *= 2;
  uint32_t *table = laves__alloc(s->context, slots, sizeof *table);
  if (!table) return false;
  memset(table, 0xff, slots * sizeof *table);
  bool cancelled = false;
  for (size_t i = 0; i < count && !cancelled; i++) {
    cancelled = laves__cancelled_at(s->context, "surface", i, count);
    first[i] = (uint32_t)i;
    if (!used[i]) continue;
    size_t slot = hash_point(points[i]) & (slots - 1);
    while (table[slot] != LAVES__NONE && !same_point(points[table[slot]], points[i])) slot = (slot + 1) & (slots - 1);
    if (table[slot] == LAVES__NONE) {
      table[slot] = (uint32_t)i;
    } else {
      first[i] = table[slot];
      if (told) laves__note_defect(info, s->defects, LAVES_DEFECT_REPEATED_POINT, 1, &points[i]);
    }
  }
  laves__free(s->context, table, slots, sizeof *table);
  return !cancelled;
}

/* False when cancelled. */
static bool mark_used(laves_context *context, const laves__surface_input *input, bool *used) {
  memset(used, 0, input->point_count * sizeof *used);
  for (size_t f = 0; f < input->triangle_count; f++) {
    if (laves__cancelled_at(context, "surface", f, input->triangle_count)) return false;
    for (int i = 0; i < 3; i++) used[input->triangles[f][i]] = true;
  }
  return true;
}

/* Gives the points that are kept their new numbers, in `first` itself, and stores them. */
static void number_points(laves__surface *s, const laves__vec3 *points, const bool *used, size_t count, uint32_t *first,
                          laves_domain_info *info) {
  s->point_count = 0;
  for (size_t i = 0; i < count; i++) {
    if (laves__cancelled_at(s->context, "surface", i, count)) return;
    if (!used[i]) {
      laves__note_defect(info, s->defects, LAVES_DEFECT_UNUSED_POINT, 1, &points[i]);
    } else if (first[i] == i) {
      s->points[s->point_count] = points[i];
      first[i] = (uint32_t)s->point_count++;
    } else {
      first[i] = first[first[i]]; /* the earlier point has its number already */
    }
  }
}

static void copy_faces(laves__surface *s, const laves__surface_input *input, const uint32_t *number, laves_domain_info *info) {
  LAVES_ASSERT(!s->tags || input->tags);
  s->face_count = 0;
  for (size_t f = 0; f < input->triangle_count; f++) {
    if (laves__cancelled_at(s->context, "surface", f, input->triangle_count)) return;
    const uint32_t *t = input->triangles[f];
    const uint32_t a = number[t[0]], b = number[t[1]], c = number[t[2]];
    if (a == b || b == c || c == a) {
      laves__note_defect(info, s->defects, LAVES_DEFECT_DEGENERATE_FACE, 3,
                         (laves__vec3[3]){s->points[a], s->points[b], s->points[c]});
      continue;
    }
    uint32_t *face = s->faces[s->face_count];
    face[0] = a;
    face[1] = b;
    face[2] = c;
    if (s->tags) s->tags[s->face_count] = input->tags[f];
    s->sources[s->face_count] = input->sources ? input->sources[f] : (uint32_t)f;
    s->face_count++;
  }
}

typedef struct key {
  uint32_t low, middle, high;
  bool odd; /* runs low, high, middle */
  uint32_t face;
} key;

static key face_key(const uint32_t f[3], uint32_t face) {
  const uint32_t low = f[0] < f[1] ? (f[0] < f[2] ? f[0] : f[2]) : (f[1] < f[2] ? f[1] : f[2]);
  const uint32_t high = f[0] > f[1] ? (f[0] > f[2] ? f[0] : f[2]) : (f[1] > f[2] ? f[1] : f[2]);
  const uint32_t after_low = f[0] == low ? f[1] : f[1] == low ? f[2] : f[0];
  return (key){low, f[0] ^ f[1] ^ f[2] ^ low ^ high, high, after_low == high, face};
}

static int compare_keys(const void *a, const void *b) {
  const key *x = a, *y = b;
  if (x->middle != y->middle) return x->middle < y->middle ? -1 : 1;
  if (x->high != y->high) return x->high < y->high ? -1 : 1;
  if (x->odd != y->odd) return x->odd < y->odd ? -1 : 1;
  return x->face < y->face ? -1 : x->face > y->face;
}

/* Whether the face repeats one of the `count` keys at `keys` that come before it; insertion keeps short lists simple. */
static void mark_repeats(key *keys, size_t count, bool *repeats) {
  if (count > 12) qsort(keys, count, sizeof *keys, compare_keys);
  for (size_t i = 1; i < count; i++)
    for (size_t j = i; j-- > 0;) {
      const bool equal = keys[i].middle == keys[j].middle && keys[i].high == keys[j].high && keys[i].odd == keys[j].odd;
      if (equal) repeats[keys[i].face] = true;
      if (equal || count > 12) break;
    }
}

/* Faces are laid beside their least point, so that repeats stand in the same short list. False when memory is short or it is
 * cancelled. */
static bool find_repeats(laves__surface *s, bool any_direction, bool *repeats) {
  const size_t starts_count = s->point_count + 1;
  uint32_t *starts = laves__alloc_zeroed(s->context, starts_count, sizeof *starts);
  key *keys = laves__alloc(s->context, s->face_count, sizeof *keys);
  bool done = starts && keys;
  if (done) {
    memset(repeats, 0, s->face_count * sizeof *repeats);
    for (size_t f = 0; f < s->face_count; f++) starts[face_key(s->faces[f], 0).low]++;
    uint32_t sum = 0;
    for (size_t p = 0; p < starts_count; p++) {
      sum += starts[p];
      starts[p] = sum;
    }
    for (size_t f = s->face_count; f-- > 0;) {
      key k = face_key(s->faces[f], (uint32_t)f);
      if (any_direction) k.odd = false;
      keys[--starts[k.low]] = k;
    }
    done = !laves__cancelled(s->context, "surface", 0.1);
    for (size_t p = 0; done && p < s->point_count; p++) mark_repeats(&keys[starts[p]], starts[p + 1] - starts[p], repeats);
  }
  laves__free(s->context, starts, starts_count, sizeof *starts);
  laves__free(s->context, keys, s->face_count, sizeof *keys);
  return done;
}

static void note_face(const laves__surface *s, laves_domain_info *info, laves_defect kind, size_t face) {
  const uint32_t *f = s->faces[face];
  laves__note_defect(info, s->defects, kind, 3, (laves__vec3[3]){s->points[f[0]], s->points[f[1]], s->points[f[2]]});
}

bool laves__surface_drop_repeats(laves__surface *s, bool any_direction, laves_domain_info *info) {
  const size_t count = s->face_count;
  bool *repeats = laves__alloc(s->context, count, sizeof *repeats);
  const bool done = repeats && find_repeats(s, any_direction, repeats);
  if (done) {
    size_t kept = 0;
    for (size_t f = 0; f < count; f++) {
      if (repeats[f]) {
        note_face(s, info, LAVES_DEFECT_DUPLICATE_FACE, f);
        continue;
      }
      memmove(s->faces[kept], s->faces[f], sizeof *s->faces);
      if (s->tags) s->tags[kept] = s->tags[f];
      s->sources[kept] = s->sources[f];
      kept++;
    }
    s->face_count = kept;
  }
  laves__free(s->context, repeats, count, sizeof *repeats);
  return done;
}

bool laves__surface_weld(laves__surface *s, const laves__surface_input *input, laves__vec3 origin, laves_domain_info *info) {
  laves_context *context = s->context;
  const size_t count = input->point_count;
  bool done = false;
  laves__vec3 *points = laves__alloc(context, count, sizeof *points);
  bool *used = laves__alloc(context, count, sizeof *used);
  uint32_t *first = laves__alloc(context, count, sizeof *first);
  s->points = laves__alloc(context, count, sizeof *s->points);
  if (s->points) s->point_capacity = count;
  s->faces = laves__alloc(context, input->triangle_count, sizeof *s->faces);
  if (s->faces) s->face_capacity = input->triangle_count;
  s->sources = laves__alloc(context, s->face_capacity, sizeof *s->sources);
  if (!points || !used || !first || !s->points || !s->faces || !s->sources) goto clean_up;
  if (input->tags) {
    s->tags = laves__alloc(context, input->triangle_count, sizeof *s->tags);
    if (!s->tags) goto clean_up;
  }
  for (size_t i = 0; i < count; i++) {
    if (laves__cancelled_at(context, "surface", i, count)) goto clean_up;
    points[i] = v3_add(v3_sub(input->points[i], origin), v3(0, 0, 0)); /* adding zero turns -0 into 0 */
  }
  if (!mark_used(context, input, used)) goto clean_up;
  /* Files in which every face has points of its own, as STL's are, repeat them by their nature. */
  const bool told = count != 3 * input->triangle_count;
  if (!find_equal_points(s, points, used, count, told, first, info)) goto clean_up;
  number_points(s, points, used, count, first, info);
  copy_faces(s, input, first, info);
  done = !laves__cancelled(context, "surface", 0.1) && laves__surface_drop_repeats(s, false, info);
clean_up:
  laves__free(context, points, count, sizeof *points);
  laves__free(context, used, count, sizeof *used);
  laves__free(context, first, count, sizeof *first);
  return done;
}
