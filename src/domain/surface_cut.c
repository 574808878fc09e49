/* Pieces of partial faces: which parts of a face that meets others bound the solid.
 *
 * In: the surface, its crossings, its winding number, which faces are partial.  Out: for each partial face the triangles of it
 * that bound the solid; the rest of it is as good as absent.
 *
 *   +-------------+      A face is cut along each segment in which it meets another, and along the edges of faces that lie
 *   |     /       |      upon it. A cut goes on to the border of the piece that the segment passes through, so pieces stay
 *   |    /  out   |      convex; what is cut too much does no harm. No face passes through a piece, so all of it bounds the
 *   | in x........|      solid or nothing does, and one question inside it tells: the winding numbers just before and behind.
 *   |    \        |      On open surfaces the number changes along a piece as well; there, pieces on which the answers differ
 *   +-------------+      are parted in four, a few times.
 *
 * Faces are cut one after another, and the pieces judged in parallel. */
#include <string.h>

#include "domain/surface.h"

/* Lengths below this share of the diagonal are rounding. */
static const double rounding = 1e-13;
/* How far before and behind a piece the winding number is asked, in parts of its inner radius. */
static const double step_off = 1e-3;
/* Pieces of less inner radius, as a share of the diagonal, do not count: such a step would be rounding. */
static const double least_radius = 1e-11;
/* Where near a corner: so far from it towards the middle. */
static const double near_corner = 0.1;

/* A polygon of a face has at most so many corners, a face so many polygons; what would be more stays uncut. */
enum { CORNERS_MAX = 32, POLYGONS_MAX = 4096, HALVINGS_MAX = 3 };
/* Polygons looked at between two reports of progress: some milliseconds. */
enum { WORK_PER_REPORT = 1 << 16 };

typedef struct polygon {
  laves__vec3 corner[CORNERS_MAX];
  int count;
} polygon;

typedef enum verdict { HIDDEN, BOUNDS, MIXED } verdict;

typedef struct piece {
  laves__vec3 corner[3];
  uint32_t slot;
  verdict verdict;
} piece;

typedef struct cutter {
  laves__surface *s;
  uint32_t *starts, *others; /* the faces that face f meets stand in others[starts[f] .. starts[f + 1]) */
  polygon *polygons;         /* of the face at hand */
  size_t polygon_count, polygon_capacity;
  piece *pieces; /* of all faces, face by face */
  size_t piece_count, piece_capacity;
  size_t judged; /* of these: the first so many */
  size_t work;   /* polygons looked at since progress was reported */
  bool ask_around;
  double eps, least_radius;
} cutter;

/* ---- cutting ---- */

/* The length of the segment inside the polygon, whose corners run counter-clockwise about n. */
static double length_inside(const polygon *p, laves__vec3 n, const laves__vec3 ends[2]) {
  const laves__vec3 along = v3_sub(ends[1], ends[0]);
  double low = 0, high = 1;
  for (int i = 0; i < p->count; i++) {
    const laves__vec3 inwards = v3_cross(n, v3_sub(p->corner[(i + 1) % p->count], p->corner[i]));
    const double height = v3_dot(v3_sub(ends[0], p->corner[i]), inwards), slope = v3_dot(along, inwards);
    if (slope == 0) {
      if (height < 0) return 0;
      continue;
    }
    const double at = -height / slope;
    if (slope > 0)
      low = fmax(low, at);
    else
      high = fmin(high, at);
  }
  return (high - low) * v3_norm(along);
}

static void add_corner(polygon *p, laves__vec3 corner) {
  if (p->count < CORNERS_MAX) p->corner[p->count++] = corner;
}

/* Parts a polygon along the line through `at` to whose left, in its plane, `left` points. False where it lies to one side. */
static bool part(const polygon *p, laves__vec3 at, laves__vec3 left, double eps, polygon halves[2]) {
  double height[CORNERS_MAX];
  bool sides[2] = {false, false};
  halves[0].count = halves[1].count = 0;
  for (int i = 0; i < p->count; i++) {
    height[i] = v3_dot(v3_sub(p->corner[i], at), left);
    if (fabs(height[i]) <= eps) height[i] = 0;
    if (height[i] != 0) sides[height[i] < 0] = true;
  }
  if (!sides[0] || !sides[1]) return false;
  for (int i = 0; i < p->count; i++) {
    const int next = (i + 1) % p->count;
    if (height[i] >= 0) add_corner(&halves[0], p->corner[i]);
    if (height[i] <= 0) add_corner(&halves[1], p->corner[i]);
    if (height[i] * height[next] >= 0) continue;
    const laves__vec3 cut = v3_lerp(p->corner[i], p->corner[next], height[i] / (height[i] - height[next]));
    add_corner(&halves[0], cut);
    add_corner(&halves[1], cut);
  }
  return true;
}

static bool is_cancelled(cutter *c) {
  c->work += c->polygon_count;
  if (c->work < WORK_PER_REPORT) return false;
  c->work = 0;
  return laves__cancelled(c->s->context, "surface", 0.7);
}

/* Cuts every polygon that the segment passes through. False when memory is short or it is cancelled. */
static bool cut_along(cutter *c, laves__vec3 n, const laves__vec3 ends[2]) {
  if (is_cancelled(c)) return false;
  const laves__vec3 left = v3_unit(v3_cross(n, v3_sub(ends[1], ends[0])));
  if (!(v3_norm2(left) > 0)) return true;
  const size_t count = c->polygon_count;
  for (size_t i = 0; i < count && c->polygon_count < POLYGONS_MAX; i++) {
    polygon halves[2];
    if (c->polygons[i].count >= CORNERS_MAX - 2) continue;
    if (!(length_inside(&c->polygons[i], n, ends) > c->eps)) continue;
    if (!part(&c->polygons[i], ends[0], left, c->eps, halves)) continue;
    if (!laves__grow(c->s->context, &c->polygons, &c->polygon_capacity, c->polygon_count + 1, sizeof *c->polygons)) return false;
    c->polygons[i] = halves[0];
    c->polygons[c->polygon_count++] = halves[1];
  }
  return true;
}

/* Along the segment in which the face meets another, or the edges of the other where both lie in one plane. */
static bool cut_by(cutter *c, const laves__triangle *t, laves__vec3 n, const laves__triangle *other) {
  laves__vec3 ends[2];
  if (laves__triangles_meet(t, other, ends)) return cut_along(c, n, ends);
  const laves__vec3 corner[4] = {other->a, other->b, other->c, other->a};
  for (int i = 0; i < 3; i++)
    if (fabs(v3_dot(v3_sub(corner[i], t->a), n)) > 1e3 * c->eps) return true; /* they meet in a point at most */
  for (int i = 0; i < 3; i++)
    if (!cut_along(c, n, &corner[i])) return false;
  return true;
}

static bool keep_polygons(cutter *c, uint32_t slot) {
  for (size_t i = 0; i < c->polygon_count; i++) {
    const polygon *p = &c->polygons[i];
    for (int k = 2; k < p->count; k++) {
      if (!laves__grow(c->s->context, &c->pieces, &c->piece_capacity, c->piece_count + 1, sizeof *c->pieces)) return false;
      c->pieces[c->piece_count++] = (piece){{p->corner[0], p->corner[k - 1], p->corner[k]}, slot, HIDDEN};
    }
  }
  return true;
}

static bool cut_face(cutter *c, uint32_t slot) {
  const laves__triangle *t = &c->s->bvh.triangles[slot];
  const laves__vec3 n = v3_unit(v3_cross(v3_sub(t->b, t->a), v3_sub(t->c, t->a)));
  if (!laves__grow(c->s->context, &c->polygons, &c->polygon_capacity, 1, sizeof *c->polygons)) return false;
  c->polygons[0] = (polygon){{t->a, t->b, t->c}, 3};
  c->polygon_count = 1;
  for (uint32_t i = c->starts[slot]; i < c->starts[slot + 1]; i++)
    if (!cut_by(c, t, n, &c->s->bvh.triangles[c->others[i]])) return false;
  return keep_polygons(c, slot);
}

/* ---- judging ---- */

static double inner_radius(const laves__vec3 p[3]) {
  const double around = v3_distance(p[0], p[1]) + v3_distance(p[1], p[2]) + v3_distance(p[2], p[0]);
  return around > 0 ? v3_norm(v3_cross(v3_sub(p[1], p[0]), v3_sub(p[2], p[0]))) / around : 0;
}

/* Whether solid lies behind the face and none before it, at p; off: how far from it to ask. */
static bool bounds_at(const laves__surface *s, laves__vec3 p, laves__vec3 n, double off) {
  return laves__winding_number(&s->winding, v3_mad(p, n, off), LAVES__NONE, LAVES__NONE) <= s->level &&
         laves__winding_number(&s->winding, v3_mad(p, n, -off), LAVES__NONE, LAVES__NONE) > s->level;
}

/* Whether a face that comes before this one lies upon it at p and looks the same way: then that one counts. */
static bool is_doubled(const cutter *c, uint32_t slot, laves__vec3 p, laves__vec3 n) {
  for (uint32_t i = c->starts[slot]; i < c->starts[slot + 1]; i++) {
    const uint32_t other = c->others[i];
    const laves__triangle *t = &c->s->bvh.triangles[other];
    if (other > slot || !(v3_dot(v3_cross(v3_sub(t->b, t->a), v3_sub(t->c, t->a)), n) > 0)) continue;
    if (laves__triangle_distance2(t, p) <= c->eps * c->eps) return true;
  }
  return false;
}

/* Asks in the middle and near the corners. */
static verdict ask_around(const laves__surface *s, const laves__vec3 q[3], laves__vec3 middle, laves__vec3 n, double off) {
  int yes = bounds_at(s, middle, n, off);
  for (int k = 0; k < 3; k++) yes += bounds_at(s, v3_lerp(q[k], middle, near_corner), n, off * near_corner);
  return yes == 4 ? BOUNDS : yes == 0 ? HIDDEN : MIXED;
}

static void judge_pieces(void *user, size_t begin, size_t end, int worker) {
  cutter *c = user;
  (void)worker;
  for (size_t i = begin; i < end; i++) {
    piece *p = &c->pieces[c->judged + i];
    const laves__vec3 *q = p->corner, n = v3_unit(v3_cross(v3_sub(q[1], q[0]), v3_sub(q[2], q[0])));
    const laves__vec3 middle = v3_scale(v3_add(q[0], v3_add(q[1], q[2])), 1.0 / 3);
    const double radius = inner_radius(q);
    p->verdict = HIDDEN;
    if (!(radius > c->least_radius) || is_doubled(c, p->slot, middle, n)) continue;
    p->verdict = c->ask_around                                   ? ask_around(c->s, q, middle, n, step_off * radius)
                 : bounds_at(c->s, middle, n, step_off * radius) ? BOUNDS
                                                                 : HIDDEN;
  }
}

/* Parts the mixed ones among the pieces just judged in four, behind all others. */
static bool part_mixed(cutter *c) {
  const size_t count = c->piece_count;
  for (size_t i = c->judged; i < count; i++) {
    if (c->pieces[i].verdict != MIXED) continue;
    c->pieces[i].verdict = HIDDEN;
    if (!laves__grow(c->s->context, &c->pieces, &c->piece_capacity, c->piece_count + 4, sizeof *c->pieces)) return false;
    const laves__vec3 *q = c->pieces[i].corner, ab = v3_lerp(q[0], q[1], 0.5), bc = v3_lerp(q[1], q[2], 0.5),
                      ca = v3_lerp(q[2], q[0], 0.5);
    const laves__vec3 quarter[4][3] = {{q[0], ab, ca}, {ab, q[1], bc}, {ca, bc, q[2]}, {ab, bc, ca}};
    for (int k = 0; k < 4; k++) {
      piece *p = &c->pieces[c->piece_count++];
      p->slot = c->pieces[i].slot;
      memcpy(p->corner, quarter[k], sizeof p->corner);
    }
  }
  c->judged = count;
  return true;
}

static bool judge(cutter *c) {
  for (int round = 0; c->judged < c->piece_count; round++) {
    c->ask_around = c->s->open && round < HALVINGS_MAX;
    if (!laves__parallel_for(c->s->context, "surface", c->piece_count - c->judged, 16, judge_pieces, c)) return false;
    if (!part_mixed(c)) return false;
  }
  return true;
}

/* ---- keeping ---- */

/* The pieces that bound the solid, by face. */
static bool keep(cutter *c) {
  laves__surface *s = c->s;
  s->piece_starts = laves__alloc_zeroed(s->context, s->face_capacity + 2, sizeof *s->piece_starts);
  if (!s->piece_starts) return false;
  for (size_t i = 0; i < c->piece_count; i++) s->piece_count += c->pieces[i].verdict == BOUNDS;
  s->pieces = laves__alloc(s->context, s->piece_count, sizeof *s->pieces);
  if (!s->pieces) return false;
  for (size_t i = 0; i < c->piece_count; i++) s->piece_starts[c->pieces[i].slot + 2] += c->pieces[i].verdict == BOUNDS;
  for (size_t f = 0; f < s->face_count; f++) s->piece_starts[f + 2] += s->piece_starts[f + 1];
  for (size_t i = 0; i < c->piece_count; i++) {
    const piece *p = &c->pieces[i];
    if (p->verdict == BOUNDS)
      s->pieces[s->piece_starts[p->slot + 1]++] = laves__triangle_of(p->corner[0], p->corner[1], p->corner[2]);
  }
  return true;
}

static bool list_others(cutter *c, const laves__crossings *crossings) {
  const laves__surface *s = c->s;
  c->starts = laves__alloc_zeroed(s->context, s->face_count + 2, sizeof *c->starts);
  c->others = laves__alloc(s->context, 2 * crossings->count, sizeof *c->others);
  if (!c->starts || !c->others) return false;
  /* starts[f + 1] runs from the start of f to its end. */
  for (size_t i = 0; i < 2 * crossings->count; i++) c->starts[crossings->pairs[i / 2][i % 2] + 2]++;
  for (size_t f = 0; f < s->face_count; f++) c->starts[f + 2] += c->starts[f + 1];
  for (size_t i = 0; i < 2 * crossings->count; i++)
    c->others[c->starts[crossings->pairs[i / 2][i % 2] + 1]++] = crossings->pairs[i / 2][1 - i % 2];
  return true;
}

bool laves__surface_cut(laves__surface *s, const laves__crossings *crossings) {
  cutter c = {.s = s, .eps = rounding * s->diagonal, .least_radius = least_radius * s->diagonal};
  bool done = list_others(&c, crossings);
  for (uint32_t f = 0; done && f < s->face_count; f++)
    if (s->face_flags[f] & LAVES__PARTIAL) done = cut_face(&c, f);
  done = done && judge(&c) && keep(&c);
  laves__free(s->context, c.starts, s->face_count + 2, sizeof *c.starts);
  laves__free(s->context, c.others, 2 * crossings->count, sizeof *c.others);
  laves__free(s->context, c.polygons, c.polygon_capacity, sizeof *c.polygons);
  laves__free(s->context, c.pieces, c.piece_capacity, sizeof *c.pieces);
  return done;
}
