/* Pairs of triangles of one surface that cross, overlap or touch where they should not.
 *
 * In: the surface and its tree.  Out: the pairs, in the order of their slots.
 *
 * Each triangle asks the tree for those whose leaves its box meets. Two triangles without a common point meet when
 * an edge of one passes through the other, or when they lie in one plane and overlap there. With one common point the
 * opposite edges are what can pass; with two, they can only lie folded upon each other. Sides are decided exactly
 * [shewchuk1997]; in a plane, in double precision after projection along the largest coordinate of the normal. */
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/predicates.h"
#include "domain/defects.h"
#include "domain/surface.h"

/* ---- two triangles ---- */

static laves__vec3 flatten(laves__vec3 p, int axis) {
  return axis == 0 ? v3(p.y, p.z, 0) : axis == 1 ? v3(p.z, p.x, 0) : v3(p.x, p.y, 0);
}

static int largest_axis(laves__vec3 n) {
  const double x = fabs(n.x), y = fabs(n.y), z = fabs(n.z);
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

static double area2d(laves__vec3 a, laves__vec3 b, laves__vec3 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/* Whether a line along some edge of the first triangle parts the two. Both run counter-clockwise. */
static bool parted_by_edge(const laves__vec3 t[3], const laves__vec3 u[3]) {
  for (int i = 0; i < 3; i++) {
    const laves__vec3 a = t[i], b = t[(i + 1) % 3];
    /* Less than this in area is rounding, and sharing an edge is not overlapping. */
    const double slack =
        1e-14 * (fabs(b.x - a.x) + fabs(b.y - a.y)) * (fabs(t[(i + 2) % 3].x - a.x) + fabs(t[(i + 2) % 3].y - a.y));
    if (area2d(a, b, u[0]) <= slack && area2d(a, b, u[1]) <= slack && area2d(a, b, u[2]) <= slack) return true;
  }
  return false;
}

static bool overlap_in_plane(const laves__vec3 t[3], const laves__vec3 u[3]) {
  const laves__vec3 n = v3_cross(v3_sub(t[1], t[0]), v3_sub(t[2], t[0]));
  const int axis = largest_axis(n);
  laves__vec3 flat[2][3];
  for (int i = 0; i < 3; i++) {
    flat[0][i] = flatten(t[i], axis);
    flat[1][i] = flatten(u[i], axis);
  }
  for (int k = 0; k < 2; k++)
    if (area2d(flat[k][0], flat[k][1], flat[k][2]) < 0) {
      const laves__vec3 swap = flat[k][1];
      flat[k][1] = flat[k][2];
      flat[k][2] = swap;
    }
  return !parted_by_edge(flat[0], flat[1]) && !parted_by_edge(flat[1], flat[0]);
}

/* Whether the segment pq, whose ends lie on different sides of t (or one of them on its plane), meets t. */
static bool passes(laves__vec3 p, laves__vec3 q, const laves__vec3 t[3]) {
  const int a = laves__orient3d(p, q, t[0], t[1]), b = laves__orient3d(p, q, t[1], t[2]), c = laves__orient3d(p, q, t[2], t[0]);
  if (a == 0 && b == 0 && c == 0) return false; /* in the plane, which is another case */
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

static void sides_of(const laves__vec3 t[3], const laves__vec3 u[3], int sides[3]) {
  for (int i = 0; i < 3; i++) sides[i] = laves__orient3d(t[0], t[1], t[2], u[i]);
}

static bool one_side(const int s[3]) { return (s[0] > 0 && s[1] > 0 && s[2] > 0) || (s[0] < 0 && s[1] < 0 && s[2] < 0); }

static bool edges_pass(const laves__vec3 u[3], const int sides[3], const laves__vec3 t[3]) {
  for (int i = 0; i < 3; i++)
    if (sides[i] * sides[(i + 1) % 3] <= 0 && passes(u[i], u[(i + 1) % 3], t)) return true;
  return false;
}

static bool meet_apart(const laves__vec3 t[3], const laves__vec3 u[3]) {
  int s[3], r[3];
  sides_of(t, u, s);
  if (one_side(s)) return false;
  sides_of(u, t, r);
  if (one_side(r)) return false;
  if (s[0] == 0 && s[1] == 0 && s[2] == 0) return overlap_in_plane(t, u);
  return edges_pass(u, s, t) || edges_pass(t, r, u);
}

/* t[0] equals u[0]. */
static bool meet_at_point(const laves__vec3 t[3], const laves__vec3 u[3]) {
  const int s1 = laves__orient3d(t[0], t[1], t[2], u[1]), s2 = laves__orient3d(t[0], t[1], t[2], u[2]);
  if (s1 * s2 > 0) return false;
  if (s1 == 0 && s2 == 0) return overlap_in_plane(t, u);
  if (s1 * s2 < 0 && passes(u[1], u[2], t)) return true;
  const int r1 = laves__orient3d(u[0], u[1], u[2], t[1]), r2 = laves__orient3d(u[0], u[1], u[2], t[2]);
  return r1 * r2 < 0 && passes(t[1], t[2], u);
}

/* How many points the faces share; brings them to the front of both. */
static int align_shared(const uint32_t f[3], const uint32_t g[3], int at_f[3], int at_g[3]) {
  int shared = 0;
  bool used_f[3] = {false}, used_g[3] = {false};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      if (f[i] == g[j]) {
        used_f[i] = used_g[j] = true;
        at_f[shared] = i;
        at_g[shared++] = j;
      }
  int next_f = shared, next_g = shared;
  for (int i = 0; i < 3; i++) {
    if (!used_f[i]) at_f[next_f++] = i;
    if (!used_g[i]) at_g[next_g++] = i;
  }
  return shared;
}

static bool faces_meet(const laves__surface *s, uint32_t a, uint32_t b) {
  const uint32_t *f = s->faces[a], *g = s->faces[b];
  int at_f[3], at_g[3];
  const int shared = align_shared(f, g, at_f, at_g);
  laves__vec3 t[3], u[3];
  for (int i = 0; i < 3; i++) {
    t[i] = s->points[f[at_f[i]]];
    u[i] = s->points[g[at_g[i]]];
  }
  if (shared == 0) return meet_apart(t, u);
  if (shared == 1) return meet_at_point(t, u);
  if (shared == 3) return true;
  return laves__orient3d(t[0], t[1], t[2], u[2]) == 0 && overlap_in_plane(t, u);
}

/* ---- all pairs ---- */

/* More pairs than these and so many for each face are not looked at, or not listed: time and memory would grow with the square of
 * the faces. Real models compare some tens for each face. */
static const size_t asked_max = 300000000, asked_per_face = 200, found_max = 10000000, found_per_face = 50;

typedef struct finder {
  const laves__surface *s;
  laves__crossings *found; /* one for each worker */
  bool *short_of_memory;
  atomic_size_t asked, crossing; /* pairs, of all workers; whether they pass the limits does not depend on who counts */
} finder;

typedef struct question {
  finder *f;
  uint32_t first, last; /* the triangles that ask */
  laves__box3 box[LAVES__LEAF_MAX];
  laves__plane plane[LAVES__LEAF_MAX];
  size_t asked, crossing;
  int worker;
} question;

static bool boxes_apart(laves__box3 a, laves__box3 b) {
  return a.lower.x > b.upper.x || b.lower.x > a.upper.x || a.lower.y > b.upper.y || b.lower.y > a.upper.y ||
         a.lower.z > b.upper.z || b.lower.z > a.upper.z;
}

static laves__box3 face_box(const laves__surface *s, uint32_t slot) {
  const laves__triangle *t = &s->bvh.triangles[slot];
  return (laves__box3){v3_min(t->a, v3_min(t->b, t->c)), v3_max(t->a, v3_max(t->b, t->c))};
}

static bool is_crowded(finder *f) {
  const size_t faces = f->s->face_count;
  return atomic_load(&f->asked) > asked_max + asked_per_face * faces ||
         atomic_load(&f->crossing) > found_max + found_per_face * faces;
}

static void add_pair(question *q, uint32_t a, uint32_t b) {
  laves__crossings *c = &q->f->found[q->worker];
  if (!laves__grow(q->f->s->context, &c->pairs, &c->capacity, c->count + 1, sizeof *c->pairs)) {
    q->f->short_of_memory[q->worker] = true;
    return;
  }
  q->crossing++;
  c->pairs[c->count][0] = a;
  c->pairs[c->count++][1] = b;
}

/* Which side of zero a product of vectors lies on, as far as rounding leaves no doubt; else 0. */
static int certain_side(laves__vec3 a, laves__vec3 b) {
  static const double doubt = 1e-14; /* ten times what rounding of the factors and of the sum can make */
  const double x = a.x * b.x, y = a.y * b.y, z = a.z * b.z, sum = x + y + z, bound = doubt * (fabs(x) + fabs(y) + fabs(z));
  return sum > bound ? 1 : -sum > bound ? -1 : 0;
}

/* Whether a plane through the one point that two triangles share parts them: t and u are the ways from it to their other corners.
 */
static bool parted_at_point(const laves__vec3 t[2], const laves__vec3 u[2]) {
  const laves__vec3 way = v3_sub(v3_add(t[0], t[1]), v3_add(u[0], u[1]));
  return certain_side(way, t[0]) > 0 && certain_side(way, t[1]) > 0 && certain_side(way, u[0]) < 0 && certain_side(way, u[1]) < 0;
}

/* Corner i of a triangle. */
static laves__vec3 corner(const laves__triangle *t, int i) { return i == 0 ? t->a : i == 1 ? t->b : t->c; }

/* Whether two faces can't meet but in the points that they share, which is soon seen of nearly all pairs of a smooth surface:
 * what one does not share lies on one side of the other's plane, or a plane through the one shared point parts them. plane: that
 * of `other`. */
static bool surely_apart(const laves__surface *s, uint32_t slot, uint32_t other, const laves__plane *plane) {
  const uint32_t *f = s->faces[slot], *g = s->faces[other];
  const laves__triangle *t = &s->bvh.triangles[slot];
  int sum = 0, alone = 0, zeros = 0, at = 0;
  for (int i = 0; i < 3; i++) {
    if (f[i] == g[0] || f[i] == g[1] || f[i] == g[2]) {
      at = i;
      continue;
    }
    const int side = laves__plane_side(plane, corner(t, i));
    sum += side;
    zeros += side == 0;
    alone++;
  }
  if (alone > 0 && (sum == alone || sum == -alone)) return true;
  if (alone != 2 || zeros == 2) return false;
  const int own = g[0] == f[at] ? 0 : g[1] == f[at] ? 1 : 2;
  const laves__triangle *u = &s->bvh.triangles[other];
  const laves__vec3 point = corner(t, at);
  const laves__vec3 of_t[2] = {v3_sub(corner(t, (at + 1) % 3), point), v3_sub(corner(t, (at + 2) % 3), point)};
  const laves__vec3 of_u[2] = {v3_sub(corner(u, (own + 1) % 3), point), v3_sub(corner(u, (own + 2) % 3), point)};
  return parted_at_point(of_t, of_u);
}

static void ask(void *user, uint32_t slot) {
  question *q = user;
  const laves__surface *s = q->f->s;
  if (slot <= q->first || q->f->short_of_memory[q->worker]) return;
  q->asked++;
  const laves__box3 box = face_box(s, slot);
  for (uint32_t mine = q->first; mine <= q->last && mine < slot; mine++)
    if (!boxes_apart(q->box[mine - q->first], box) && !surely_apart(s, slot, mine, &q->plane[mine - q->first]) &&
        faces_meet(s, mine, slot))
      add_pair(q, mine, slot);
}

/* The leaves of a range of nodes; all triangles of a leaf ask together. */
static void find_in_range(void *user, size_t begin, size_t end, int worker) {
  finder *f = user;
  const laves__bvh *bvh = &f->s->bvh;
  for (size_t k = begin; k < end && !is_crowded(f) && !laves__is_cancelled(f->s->context); k++)
    for (int i = 0; i < 4; i++) {
      const uint32_t child = bvh->nodes[k].child[i];
      if (!(child & LAVES__LEAF_BIT) || !laves__bvh_is_used(&bvh->nodes[k], i)) continue;
      question q = {.f = f, .first = laves__leaf_first(child), .last = laves__leaf_last(child), .worker = worker};
      laves__box3 whole = box3_empty();
      for (uint32_t slot = q.first; slot <= q.last; slot++) {
        const laves__triangle *t = &bvh->triangles[slot];
        const laves__box3 b = q.box[slot - q.first] = face_box(f->s, slot);
        q.plane[slot - q.first] = laves__plane_of(t->a, t->b, t->c);
        whole = box3_add(box3_add(whole, b.lower), b.upper);
      }
      laves__bvh_overlaps(bvh, whole, ask, &q);
      atomic_fetch_add(&f->asked, q.asked);
      atomic_fetch_add(&f->crossing, q.crossing);
    }
}

static int compare_pairs(const void *a, const void *b) {
  const uint32_t *x = a, *y = b;
  if (x[0] != y[0]) return x[0] < y[0] ? -1 : 1;
  return x[1] < y[1] ? -1 : x[1] > y[1];
}

/* All workers' pairs in one list; which worker found which must not show. */
static bool gather(laves_context *context, const laves__crossings *found, int workers, laves__crossings *all) {
  size_t count = 0;
  for (int w = 0; w < workers; w++) count += found[w].count;
  *all = (laves__crossings){0};
  if (!laves__grow(context, &all->pairs, &all->capacity, count, sizeof *all->pairs)) return false;
  for (int w = 0; w < workers; w++) {
    if (found[w].count) memcpy(all->pairs + all->count, found[w].pairs, found[w].count * sizeof *all->pairs);
    all->count += found[w].count;
  }
  if (count) qsort(all->pairs, count, sizeof *all->pairs, compare_pairs);
  return true;
}

bool laves__surface_crossings(laves__surface *s, laves__crossings *all) {
  laves_context *context = s->context;
  const int workers = laves__workers(context);
  const size_t count = (size_t)workers;
  laves__crossings *found = laves__alloc_zeroed(context, count, sizeof *found);
  bool *short_of_memory = laves__alloc_zeroed(context, count, sizeof *short_of_memory);
  bool done = found && short_of_memory;
  if (done) {
    finder f = {.s = s, .found = found, .short_of_memory = short_of_memory};
    done = laves__parallel_for(context, "surface", s->bvh.node_count, 64, find_in_range, &f);
    for (int w = 0; w < workers; w++) done = done && !short_of_memory[w];
    s->crowded = is_crowded(&f);
    done = done && !s->crowded && gather(context, found, workers, all);
  }
  for (int w = 0; found && w < workers; w++) laves__crossings_free(context, &found[w]);
  laves__free(context, found, count, sizeof *found);
  laves__free(context, short_of_memory, count, sizeof *short_of_memory);
  return done;
}

void laves__crossings_free(laves_context *context, laves__crossings *c) {
  laves__free(context, c->pairs, c->capacity, sizeof *c->pairs);
  *c = (laves__crossings){0};
}

/* ---- where two triangles meet ---- */

/* Where the line point + s direction leaves t, as the range of s; false when it misses. */
static bool clip(const laves__triangle *t, laves__vec3 point, laves__vec3 direction, double range[2]) {
  const laves__vec3 c[3] = {t->a, t->b, t->c};
  const laves__vec3 n = v3_cross(v3_sub(t->b, t->a), v3_sub(t->c, t->a));
  range[0] = -INFINITY;
  range[1] = INFINITY;
  for (int i = 0; i < 3; i++) {
    const laves__vec3 inwards = v3_cross(n, v3_sub(c[(i + 1) % 3], c[i]));
    const double height = v3_dot(v3_sub(point, c[i]), inwards), slope = v3_dot(direction, inwards);
    if (slope == 0) continue;
    const double at = -height / slope;
    if (slope > 0)
      range[0] = fmax(range[0], at);
    else
      range[1] = fmin(range[1], at);
  }
  return range[0] <= range[1] && isfinite(range[0]) && isfinite(range[1]);
}

bool laves__triangles_meet(const laves__triangle *t, const laves__triangle *u, laves__vec3 ends[2]) {
  const laves__vec3 n = v3_unit(v3_cross(v3_sub(t->b, t->a), v3_sub(t->c, t->a)));
  const laves__vec3 m = v3_unit(v3_cross(v3_sub(u->b, u->a), v3_sub(u->c, u->a)));
  const laves__vec3 direction = v3_cross(n, m);
  const double sine2 = v3_norm2(direction);
  if (!(sine2 > 1e-20)) return false; /* nearly in one plane */
  /* The point of both planes nearest to t's corner a. */
  const double height = v3_dot(v3_sub(u->a, t->a), m);
  const laves__vec3 point = v3_mad(t->a, v3_cross(direction, n), height / sine2);
  double a[2], b[2];
  if (!clip(t, point, direction, a) || !clip(u, point, direction, b)) return false;
  const double low = fmax(a[0], b[0]), high = fmin(a[1], b[1]);
  if (!(low < high)) return false;
  ends[0] = v3_mad(point, direction, low);
  ends[1] = v3_mad(point, direction, high);
  return true;
}

/* ---- telling ---- */

/* Each pair with the segment in which it meets (an edge of the first where both lie in one plane). */
static void note_segments(const laves__surface *s, const laves__crossings *c, laves_domain_info *info) {
  for (size_t i = 0; i < c->count; i++) {
    const laves__triangle *t = &s->bvh.triangles[c->pairs[i][0]];
    laves__vec3 ends[2] = {t->a, t->b};
    if (i == 0 || s->defects) laves__triangles_meet(t, &s->bvh.triangles[c->pairs[i][1]], ends);
    laves__note_defect(info, s->defects, LAVES_DEFECT_CROSSING, 2, ends);
  }
}

/* The faces of all crossings, each once. */
static bool note_faces(const laves__surface *s, const laves__crossings *c) {
  if (!s->defects || c->count == 0) return true;
  bool *noted = laves__alloc_zeroed(s->context, s->face_count, sizeof *noted);
  if (!noted) return false;
  for (size_t i = 0; i < 2 * c->count; i++) {
    const uint32_t f = c->pairs[i / 2][i % 2];
    const laves__triangle *t = &s->bvh.triangles[f];
    if (!noted[f]) laves__defects_add(s->defects, LAVES_DEFECT_CROSSING, 3, (laves__vec3[3]){t->a, t->b, t->c});
    noted[f] = true;
  }
  laves__free(s->context, noted, s->face_count, sizeof *noted);
  return true;
}

bool laves__surface_note_crossings(const laves__surface *s, const laves__crossings *c, laves_domain_info *info) {
  note_segments(s, c, info);
  return note_faces(s, c);
}
