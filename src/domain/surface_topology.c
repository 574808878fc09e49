/* What meets what: the face across each edge, fans around points, components, normals, and the defects among them.
 *
 * In: welded faces.  Out: `across`, counts of defects with a place for the first, normals of faces and points.
 *
 * Half-edges are laid beside the lesser of their two points, so that the uses of one edge stand in one short list.
 * An edge with exactly two faces joins them, whatever their directions. A point is regular when turning about it from face
 * to face over such edges visits all its faces.
 *
 * The normal of a point is the sum of its faces' normals weighted by their angles, which makes the sign of the distance
 * exact when the nearest feature is a point [baerentzen2005, sec. 3]. */
#include <stdlib.h>
#include <string.h>

#include "domain/defects.h"
#include "domain/surface.h"

/* A use of an edge, beside its lesser point. */
typedef laves__edge_use use;

static int compare_uses(const void *a, const void *b) {
  const use *x = a, *y = b;
  if (x->other != y->other) return x->other < y->other ? -1 : 1;
  return x->half < y->half ? -1 : x->half > y->half;
}

static void sort_uses(use *uses, size_t count) {
  if (count > 24) {
    qsort(uses, count, sizeof *uses, compare_uses);
    return;
  }
  for (size_t i = 1; i < count; i++) {
    const use moved = uses[i];
    size_t j = i;
    for (; j > 0 && compare_uses(&uses[j - 1], &moved) > 0; j--) uses[j] = uses[j - 1];
    uses[j] = moved;
  }
}

static uint32_t edge_start(const laves__surface *s, uint32_t half) { return s->faces[half / 3][half % 3]; }
static uint32_t edge_end(const laves__surface *s, uint32_t half) { return s->faces[half / 3][(half % 3 + 1) % 3]; }

/* ---- components ---- */

static uint32_t find_root(uint32_t *parent, uint32_t f) {
  while (parent[f] != f) {
    parent[f] = parent[parent[f]];
    f = parent[f];
  }
  return f;
}

static void join(uint32_t *parent, uint32_t a, uint32_t b) {
  a = find_root(parent, a);
  b = find_root(parent, b);
  if (a < b)
    parent[b] = a;
  else
    parent[a] = b;
}

/* ---- edges ---- */

typedef struct edges {
  laves__surface *s;
  laves_domain_info *info;
  uint32_t *parent;
  bool closed, short_of_memory;
} edges;

/* Adds an edge whose uses do not balance to the rim, in the direction of which there are too many. */
static void add_to_rim(edges *e, const use *uses, size_t count, size_t forward) {
  laves__surface *s = e->s;
  const bool too_many_forward = 2 * forward > count;
  size_t excess = too_many_forward ? 2 * forward - count : count - 2 * forward;
  for (size_t i = 0; i < count && excess > 0; i++) {
    if ((edge_start(s, uses[i].half) < uses[i].other) != too_many_forward) continue;
    excess--;
    if (!laves__grow(s->context, &s->rim, &s->rim_capacity, s->rim_count + 1, sizeof *s->rim)) {
      e->short_of_memory = true;
      return;
    }
    s->rim[s->rim_count++] = uses[i].half;
  }
}

/* All uses of one edge. */
static void judge_edge(edges *e, const use *uses, size_t count) {
  laves__surface *s = e->s;
  size_t forward = 0;
  for (size_t i = 0; i < count; i++) {
    forward += edge_start(s, uses[i].half) < uses[i].other;
    if (i > 0) join(e->parent, uses[0].half / 3, uses[i].half / 3);
    s->across[uses[i].half] = LAVES__NONE;
  }
  const laves__vec3 ends[2] = {s->points[edge_start(s, uses[0].half)], s->points[edge_end(s, uses[0].half)]};
  if (2 * forward != count) {
    e->closed = false;
    add_to_rim(e, uses, count, forward);
  }
  if (count == 1) laves__note_defect(e->info, s->defects, LAVES_DEFECT_OPEN_EDGE, 2, ends);
  if (count > 2) laves__note_defect(e->info, s->defects, LAVES_DEFECT_NONMANIFOLD_EDGE, 2, ends);
  if (count != 2) return;
  if (forward != 1) laves__note_defect(e->info, s->defects, LAVES_DEFECT_DIRECTION, 2, ends);
  s->across[uses[0].half] = uses[1].half;
  s->across[uses[1].half] = uses[0].half;
}

/* uses, in lists by lesser point: starts[p] .. starts[p + 1]; false when cancelled. */
static bool list_uses(const laves__surface *s, uint32_t *starts, use *uses) {
  const uint32_t half_count = (uint32_t)(3 * s->face_count);
  for (uint32_t h = 0; h < half_count; h++) {
    if (laves__cancelled_at(s->context, "surface", h, half_count)) return false;
    const uint32_t u = edge_start(s, h), v = edge_end(s, h);
    starts[u < v ? u : v]++;
  }
  uint32_t sum = 0;
  for (size_t p = 0; p <= s->point_count; p++) {
    sum += starts[p];
    starts[p] = sum;
  }
  for (uint32_t h = half_count; h-- > 0;) {
    if (laves__cancelled_at(s->context, "surface", h, half_count)) return false;
    const uint32_t u = edge_start(s, h), v = edge_end(s, h);
    uses[--starts[u < v ? u : v]] = (use){u < v ? v : u, h};
  }
  return true;
}

/* False when memory is short or it is cancelled. */
static bool judge_edges(edges *e, const uint32_t *starts, use *uses) {
  for (size_t p = 0; p < e->s->point_count; p++) {
    if (laves__cancelled_at(e->s->context, "surface", p, e->s->point_count)) return false;
    use *list = uses + starts[p];
    const size_t count = starts[p + 1] - starts[p];
    sort_uses(list, count);
    for (size_t begin = 0, end; begin < count; begin = end) {
      for (end = begin + 1; end < count && list[end].other == list[begin].other; end++) {
      }
      judge_edge(e, list + begin, end - begin);
    }
  }
  return !e->short_of_memory;
}

/* ---- fans ---- */

/* The corner of `face` at `point`. */
static uint32_t corner_of(const laves__surface *s, uint32_t face, uint32_t point) {
  return s->faces[face][0] == point ? 0 : s->faces[face][1] == point ? 1 : 2;
}

/* Faces met when turning about `point` from `face` over its edge `edge` on; `closes` when it comes back to the start. */
static size_t turn(const laves__surface *s, uint32_t point, uint32_t face, uint32_t edge, size_t limit, bool *closes) {
  const uint32_t start = face;
  size_t met = 0;
  *closes = false;
  while (met < limit) {
    const uint32_t half = s->across[3 * face + edge];
    if (half == LAVES__NONE) break;
    face = half / 3;
    if (face == start) {
      *closes = true;
      break;
    }
    met++;
    const uint32_t corner = corner_of(s, face, point), entered = half % 3;
    edge = entered == corner ? (corner + 2) % 3 : corner;
  }
  return met;
}

/* Whether all `count` faces at the point form one fan, and whether it closes; `face` is any of them. */
static bool one_fan(const laves__surface *s, uint32_t point, uint32_t face, size_t count, bool *closes) {
  const uint32_t corner = corner_of(s, face, point);
  bool back;
  size_t met = 1 + turn(s, point, face, corner, count, closes);
  if (!*closes) met += turn(s, point, face, (corner + 2) % 3, count, &back);
  return met == count;
}

static bool judge_points(laves__surface *s, laves_domain_info *info) {
  const size_t count = s->point_count;
  uint32_t *valence = laves__alloc_zeroed(s->context, count, sizeof *valence);
  uint32_t *any_face = laves__alloc(s->context, count, sizeof *any_face);
  bool done = valence && any_face;
  if (done) {
    for (size_t f = 0; f < s->face_count; f++)
      for (int i = 0; i < 3; i++) {
        valence[s->faces[f][i]]++;
        any_face[s->faces[f][i]] = (uint32_t)f;
      }
    for (uint32_t p = 0; done && p < count; p++) {
      bool closes = false;
      done = !laves__cancelled_at(s->context, "surface", p, count);
      const bool single = valence[p] == 0 || one_fan(s, p, any_face[p], valence[p], &closes);
      if (!single) laves__note_defect(info, s->defects, LAVES_DEFECT_NONMANIFOLD_VERTEX, 1, &s->points[p]);
      s->doubtful_points[p] = !single || !closes;
    }
  }
  laves__free(s->context, valence, count, sizeof *valence);
  laves__free(s->context, any_face, count, sizeof *any_face);
  return done;
}

bool laves__surface_topology(laves__surface *s, laves_domain_info *info) {
  const size_t starts_count = s->point_count + 1, half_count = 3 * s->face_count;
  bool done = false;
  uint32_t *starts = laves__alloc_zeroed(s->context, starts_count, sizeof *starts);
  use *uses = laves__alloc(s->context, half_count, sizeof *uses);
  uint32_t *parent = laves__alloc(s->context, s->face_count, sizeof *parent);
  if (!s->across) s->across = laves__alloc(s->context, 3 * s->face_capacity, sizeof *s->across);
  if (!s->doubtful_points) s->doubtful_points = laves__alloc(s->context, s->point_capacity, sizeof *s->doubtful_points);
  if (!starts || !uses || !parent || !s->across || !s->doubtful_points) goto clean_up;
  for (uint32_t f = 0; f < s->face_count; f++) parent[f] = f;
  if (!list_uses(s, starts, uses)) goto clean_up;
  edges e = {s, info, parent, true, false};
  s->rim_count = 0;
  if (!judge_edges(&e, starts, uses)) goto clean_up;
  info->closed = e.closed;
  info->component_count = 0;
  for (uint32_t f = 0; f < s->face_count; f++) info->component_count += parent[f] == f;
  done = judge_points(s, info);
clean_up:
  laves__free(s->context, starts, starts_count, sizeof *starts);
  laves__free(s->context, uses, half_count, sizeof *uses);
  laves__free(s->context, parent, s->face_count, sizeof *parent);
  return done;
}

bool laves__surface_each_edge(const laves__surface *s, laves__edge_fn *fn, void *user) {
  const size_t starts_count = s->point_count + 1, half_count = 3 * s->face_count;
  uint32_t *starts = laves__alloc_zeroed(s->context, starts_count, sizeof *starts);
  use *uses = laves__alloc(s->context, half_count, sizeof *uses);
  const bool done = starts && uses && list_uses(s, starts, uses);
  for (size_t p = 0; done && p < s->point_count; p++) {
    use *list = uses + starts[p];
    const size_t count = starts[p + 1] - starts[p];
    sort_uses(list, count);
    for (size_t begin = 0, end; begin < count; begin = end) {
      for (end = begin + 1; end < count && list[end].other == list[begin].other; end++) {
      }
      fn(user, list + begin, end - begin);
    }
  }
  laves__free(s->context, starts, starts_count, sizeof *starts);
  laves__free(s->context, uses, half_count, sizeof *uses);
  return done;
}

bool laves__surface_genus(const laves__surface *s, laves_domain_info *info) {
  static const laves_defect against[] = {LAVES_DEFECT_OPEN_EDGE, LAVES_DEFECT_NONMANIFOLD_EDGE, LAVES_DEFECT_DIRECTION,
                                         LAVES_DEFECT_NONMANIFOLD_VERTEX, LAVES_DEFECT_CROSSING};
  if (!info->closed || info->winding) return true;
  for (size_t f = 0; f < s->face_count; f++)
    if (s->face_flags[f] & LAVES__PARTIAL) return true; /* it does not bound the solid, or not all of it does */
  for (size_t i = 0; i < LAVES__COUNT_OF(against); i++)
    if (info->defects[against[i]]) return true;
  uint8_t *used = laves__alloc_zeroed(s->context, s->point_count, sizeof *used);
  if (!used) return false;
  int64_t points = 0;
  for (size_t f = 0; f < s->face_count; f++)
    for (int i = 0; i < 3; i++) {
      points += !used[s->faces[f][i]];
      used[s->faces[f][i]] = 1;
    }
  laves__free(s->context, used, s->point_count, sizeof *used);
  /* Euler: points - edges + faces = 2 components - 2 genus, with three edges for every two faces. */
  info->topology_known = true;
  info->genus = (int64_t)info->component_count - (points - (int64_t)s->face_count / 2) / 2;
  return true;
}

/* ---- normals and measures ---- */

bool laves__surface_normals(laves__surface *s) {
  if (!s->point_normals) s->point_normals = laves__alloc(s->context, s->point_capacity, sizeof *s->point_normals);
  if (!s->point_normals) return false;
  memset(s->point_normals, 0, s->point_count * sizeof *s->point_normals);
  for (size_t f = 0; f < s->face_count; f++) {
    if (laves__cancelled_at(s->context, "surface", f, s->face_count)) return false;
    const uint32_t *face = s->faces[f];
    const laves__vec3 p[3] = {s->points[face[0]], s->points[face[1]], s->points[face[2]]};
    const laves__vec3 cross = v3_cross(v3_sub(p[1], p[0]), v3_sub(p[2], p[0]));
    const laves__vec3 normal = v3_unit(cross);
    const double sine = v3_norm(cross);
    for (int i = 0; i < 3; i++) {
      const laves__vec3 u = v3_sub(p[(i + 1) % 3], p[i]), v = v3_sub(p[(i + 2) % 3], p[i]);
      const double angle = laves__angle(sine, v3_dot(u, v));
      s->point_normals[face[i]] = v3_mad(s->point_normals[face[i]], normal, angle);
    }
  }
  return true;
}

void laves__surface_measure(const laves__surface *s, double *volume, double *area) {
  double volume6 = 0, area2 = 0;
  for (size_t f = 0; f < s->face_count; f++) {
    const uint32_t *face = s->faces[f];
    const laves__vec3 a = s->points[face[0]], b = s->points[face[1]], c = s->points[face[2]];
    volume6 += v3_dot(a, v3_cross(b, c));
    area2 += v3_norm(v3_cross(v3_sub(b, a), v3_sub(c, a)));
  }
  *volume = volume6 / 6;
  *area = area2 / 2;
}
