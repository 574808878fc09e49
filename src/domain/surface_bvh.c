/* The tree over the triangles of a surface, four children a node, and the search for the nearest one.
 *
 * In: points and faces.  Out: nodes, triangles in the order of the leaves, and that order.
 *
 * The tree is made top down: a range of triangles is parted where sixteen bins along the longest axis of its centres make
 * the surface area heuristic least [wald2007], twice over, so that each node has up to four children and their boxes are
 * tested together. Boxes are floats in units of about the surface's width, rounded outwards by more than the rounding of
 * the query point, so that pruning is always on the safe side. The search keeps (squared distance, slot) and takes a
 * candidate only when it is less in that order: the answer is a property of the triangles alone, and a good start value
 * makes it quick but cannot change it.
 *
 * Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007, sec. 3.  Ericson, "Real-time collision
 * detection", 2005, sec. 5.1.5, is the usual closest point; here dual vectors decide the inside and the three edges are
 * tried otherwise, which stays right for slivers. */
#include <float.h>
#include <string.h>

#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include "domain/surface.h"

enum { BIN_COUNT = 16, BALANCED_DEPTH = 24 };

/* In units of the tree: more than what rounding of a coordinate below 2 to float, and of a box's centre and half, can
 * lose together; so far boxes are widened. */
static const float box_slack = 0x1p-21f;
/* More than the relative error of the float distance to a box. */
static const float limit_slack = 1.0f + 0x1p-18f;
static const float far_away = 1e17f;

/* Four lanes, in the vector notation that GCC and Clang share; plain loops are not turned into vector code here. */
typedef float float4 __attribute__((vector_size(16), aligned(4), may_alias));
typedef int32_t int4 __attribute__((vector_size(16), aligned(4), may_alias));

/* Lane by lane a < b ? a : b, and a > b ? a : b: one instruction each where there is one. */
static inline float4 lesser(float4 a, float4 b) {
#ifdef __SSE__
  return (float4)_mm_min_ps((__m128)a, (__m128)b);
#else
  const int4 less = a < b;
  return (float4)(((int4)a & less) | ((int4)b & ~less));
#endif
}

static inline float4 greater(float4 a, float4 b) {
#ifdef __SSE__
  return (float4)_mm_max_ps((__m128)a, (__m128)b);
#else
  const int4 more = a > b;
  return (float4)(((int4)a & more) | ((int4)b & ~more));
#endif
}

/* ---- building ---- */

/* Three floats are read as four, so something must stand behind each. */
typedef struct item {
  float lower[3], upper[3], centre[3];
  uint32_t face;
} item;

/* The fourth lanes mean nothing. */
typedef struct box {
  float4 lower, upper;
} box;

typedef struct range {
  uint32_t begin, end;
  box bounds;
} range;

typedef struct builder {
  laves_context *context;
  laves__bvh *bvh;
  item *items;
} builder;

static inline box box_empty(void) {
  return (box){{FLT_MAX, FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX, -FLT_MAX}};
}

static inline void box_join(box *b, float4 lower, float4 upper) {
  b->lower = lesser(lower, b->lower);
  b->upper = greater(upper, b->upper);
}

/* Three floats of an item, and what stands behind them. */
static inline float4 three(const float x[3]) { return *(const float4 *)x; }

static float half_area(const box *b) {
  const float x = b->upper[0] - b->lower[0], y = b->upper[1] - b->lower[1], z = b->upper[2] - b->lower[2];
  return x * y + y * z + z * x;
}

static box items_box(const item *items, uint32_t begin, uint32_t end) {
  box b = box_empty();
  for (uint32_t i = begin; i < end; i++) box_join(&b, three(items[i].lower), three(items[i].upper));
  return b;
}

static void make_items(laves_context *context, const laves__bvh *bvh, const laves__vec3 *points, const uint32_t (*faces)[3],
                       size_t count, item *items) {
  for (size_t f = 0; f < count; f++) {
    if (laves__cancelled_at(context, "surface", f, count)) return;
    box b = box_empty();
    for (int i = 0; i < 3; i++) {
      const laves__vec3 p = points[faces[f][i]];
      const float4 q = {(float)(p.x * bvh->scale), (float)(p.y * bvh->scale), (float)(p.z * bvh->scale), 0};
      box_join(&b, q, q);
    }
    for (int k = 0; k < 3; k++) {
      items[f].lower[k] = b.lower[k] - box_slack;
      items[f].upper[k] = b.upper[k] + box_slack;
      items[f].centre[k] = 0.5f * (b.lower[k] + b.upper[k]);
    }
    items[f].face = (uint32_t)f;
  }
}

typedef struct binning {
  int axis;
  float start, per_length;
} binning;

static int bin_of(const binning *g, const item *i) {
  const int bin = (int)((i->centre[g->axis] - g->start) * g->per_length);
  return bin < BIN_COUNT ? bin : BIN_COUNT - 1;
}

/* How to bin a range: along the longest axis of its centres; false when all centres agree. */
static bool choose_bins(const item *items, uint32_t begin, uint32_t end, binning *g) {
  box c = box_empty();
  for (uint32_t i = begin; i < end; i++) box_join(&c, three(items[i].centre), three(items[i].centre));
  int axis = 0;
  for (int k = 1; k < 3; k++)
    if (c.upper[k] - c.lower[k] > c.upper[axis] - c.lower[axis]) axis = k;
  const float length = c.upper[axis] - c.lower[axis];
  if (!(length > 0)) return false;
  *g = (binning){axis, c.lower[axis], (float)BIN_COUNT / length};
  return isfinite(g->per_length);
}

/* The bin before which to part, by area times count on either side. */
static int best_bin(const item *items, uint32_t begin, uint32_t end, const binning *g) {
  box boxes[BIN_COUNT];
  uint32_t counts[BIN_COUNT] = {0};
  for (int b = 0; b < BIN_COUNT; b++) boxes[b] = box_empty();
  for (uint32_t i = begin; i < end; i++) {
    const int b = bin_of(g, &items[i]);
    counts[b]++;
    box_join(&boxes[b], three(items[i].lower), three(items[i].upper));
  }
  float below[BIN_COUNT];
  box joined = box_empty();
  uint32_t count = 0;
  for (int b = 0; b < BIN_COUNT; b++) {
    below[b] = count ? half_area(&joined) * (float)count : 0;
    count += counts[b];
    box_join(&joined, boxes[b].lower, boxes[b].upper);
  }
  joined = box_empty();
  count = 0;
  int best = 0;
  float least = FLT_MAX;
  for (int b = BIN_COUNT - 1; b > 0; b--) {
    count += counts[b];
    box_join(&joined, boxes[b].lower, boxes[b].upper);
    if (count == 0 || count == end - begin) continue;
    const float cost = below[b] + half_area(&joined) * (float)count;
    if (cost < least) {
      least = cost;
      best = b;
    }
  }
  return best;
}

/* Parts [begin, end) in two, neither empty. Deep down, or where centres agree, by count, which bounds the depth. */
static uint32_t part(item *items, uint32_t begin, uint32_t end, int depth) {
  binning g;
  const uint32_t middle = begin + (end - begin) / 2;
  if (depth > BALANCED_DEPTH || !choose_bins(items, begin, end, &g)) return middle;
  const int bin = best_bin(items, begin, end, &g);
  if (bin == 0) return middle;
  uint32_t low = begin, high = end;
  while (low < high) {
    if (bin_of(&g, &items[low]) < bin) {
      low++;
    } else {
      high--;
      const item swap = items[low];
      items[low] = items[high];
      items[high] = swap;
    }
  }
  return low;
}

static void set_box(laves__bvh_node *node, int i, const box *b) {
  for (int k = 0; k < 3; k++) {
    node->centre[k][i] = 0.5f * (b->lower[k] + b->upper[k]);
    node->half[k][i] = 0.5f * (b->upper[k] - b->lower[k]);
  }
}

/* Ranges of at least so many items take long enough to ask before each step whether to go on. */
enum { LONG_RANGE = 1 << 12 };

/* Parts a range until there are four, or none is worth it. Returns how many; 0 when cancelled. */
static int part_in_four(const builder *b, range ranges[4], int depth) {
  item *items = b->items;
  int count = 1;
  while (count < 4) {
    int largest = -1;
    for (int i = 0; i < count; i++) {
      if (ranges[i].end - ranges[i].begin <= LAVES__LEAF_MAX) continue;
      if (largest < 0 || half_area(&ranges[i].bounds) > half_area(&ranges[largest].bounds)) largest = i;
    }
    if (largest < 0) break;
    range *r = &ranges[largest];
    if (r->end - r->begin >= LONG_RANGE && laves__cancelled(b->context, "surface", 0.2)) return 0;
    const uint32_t middle = part(items, r->begin, r->end, depth);
    ranges[count] = (range){middle, r->end, items_box(items, middle, r->end)};
    *r = (range){r->begin, middle, items_box(items, r->begin, middle)};
    count++;
  }
  return count;
}

/* Makes the node for [begin, end) and all below it; its index, or NONE when memory is short or it is cancelled. */
static uint32_t make_node(builder *b, range whole, int depth) {
  laves__bvh *bvh = b->bvh;
  if (!laves__grow(b->context, &bvh->nodes, &bvh->node_capacity, bvh->node_count + 1, sizeof *bvh->nodes)) return LAVES__NONE;
  const uint32_t index = (uint32_t)bvh->node_count++;
  range ranges[4] = {whole};
  const int count = part_in_four(b, ranges, depth);
  if (count == 0) return LAVES__NONE;
  laves__bvh_node node;
  const box nowhere = {{far_away, far_away, far_away, far_away}, {far_away, far_away, far_away, far_away}};
  for (int i = 0; i < 4; i++) {
    set_box(&node, i, i < count ? &ranges[i].bounds : &nowhere);
    node.child[i] = LAVES__LEAF_BIT;
    if (i >= count) continue;
    const uint32_t size = ranges[i].end - ranges[i].begin;
    if (size <= LAVES__LEAF_MAX) {
      node.child[i] = LAVES__LEAF_BIT | (size - 1) << 28 | ranges[i].begin;
    } else {
      node.child[i] = make_node(b, ranges[i], depth + 1);
      if (node.child[i] == LAVES__NONE) return LAVES__NONE;
    }
  }
  bvh->nodes[index] = node;
  return index;
}

laves__triangle laves__triangle_of(laves__vec3 a, laves__vec3 b, laves__vec3 c) {
  const laves__vec3 ab = v3_sub(b, a), ac = v3_sub(c, a);
  const laves__vec3 n = v3_cross(ab, ac);
  const double longest2 = fmax(v3_norm2(ab), v3_norm2(ac));
  /* Below this the direction of the normal is rounding alone, and the edges are all there is. */
  const bool flat = !(v3_norm2(n) > 1e-26 * longest2 * longest2);
  const double s = flat ? NAN : 1 / v3_norm2(n);
  return (laves__triangle){a, b, c, v3_scale(v3_cross(ac, n), s), v3_scale(v3_cross(n, ab), s)};
}

/* The power of two that brings the farthest coordinate into [0.5, 1]. */
static double tree_scale(laves_context *context, const laves__vec3 *points, const uint32_t (*faces)[3], size_t count) {
  double farthest = 0;
  for (size_t f = 0; f < count && !laves__cancelled_at(context, "surface", f, count); f++)
    for (int i = 0; i < 3; i++) {
      const laves__vec3 p = points[faces[f][i]];
      farthest = fmax(farthest, fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))));
    }
  int exponent = 0;
  frexp(farthest, &exponent);
  return ldexp(1, -exponent);
}

/* Gives back what the nodes' array has to spare; false when memory is short. */
static bool fit_nodes(laves_context *context, laves__bvh *bvh) {
  void *fitted = laves__realloc(context, bvh->nodes, bvh->node_capacity, bvh->node_count, sizeof *bvh->nodes);
  if (!fitted) return false;
  bvh->nodes = fitted;
  bvh->node_capacity = bvh->node_count;
  return true;
}

/* The nodes, and the order of the faces. */
static bool build_nodes(laves_context *context, const laves__vec3 *points, const uint32_t (*faces)[3], size_t face_count,
                        uint32_t *order, laves__bvh *bvh) {
  bool done = false;
  item *items = laves__alloc(context, face_count, sizeof *items);
  if (!items) return false;
  make_items(context, bvh, points, faces, face_count, items);
  if (laves__is_cancelled(context)) goto clean_up;
  builder b = {context, bvh, items};
  const range whole = {0, (uint32_t)face_count, items_box(items, 0, (uint32_t)face_count)};
  if (make_node(&b, whole, 0) == LAVES__NONE) goto clean_up;
  if (!fit_nodes(context, bvh)) goto clean_up;
  for (size_t slot = 0; slot < face_count; slot++) order[slot] = items[slot].face;
  done = true;
clean_up:
  laves__free(context, items, face_count, sizeof *items);
  return done;
}

/* The items are given back before the triangles, which are larger than all else, are made. */
bool laves__bvh_build(laves_context *context, const laves__vec3 *points, const uint32_t (*faces)[3], size_t face_count,
                      uint32_t *order, laves__bvh *bvh) {
  *bvh = (laves__bvh){.scale = tree_scale(context, points, faces, face_count)};
  bool done = build_nodes(context, points, faces, face_count, order, bvh);
  if (done) bvh->triangles = laves__alloc(context, face_count, sizeof *bvh->triangles);
  done = bvh->triangles != NULL;
  if (done) bvh->count = face_count;
  for (size_t slot = 0; done && slot < face_count; slot++) {
    done = !laves__cancelled_at(context, "surface", slot, face_count);
    const uint32_t *f = faces[order[slot]];
    bvh->triangles[slot] = laves__triangle_of(points[f[0]], points[f[1]], points[f[2]]);
  }
  if (!done) laves__bvh_free(context, bvh);
  return done;
}

void laves__bvh_free(laves_context *context, laves__bvh *bvh) {
  laves__free(context, bvh->nodes, bvh->node_capacity, sizeof *bvh->nodes);
  laves__free(context, bvh->triangles, bvh->count, sizeof *bvh->triangles);
  *bvh = (laves__bvh){0};
}

/* ---- the nearest triangle ---- */

/* The closest point of the segment uv; *end receives 0 between its ends, else 1 for u and 2 for v. */
static inline laves__vec3 closest_on_segment(laves__vec3 u, laves__vec3 v, laves__vec3 p, int *end) {
  const laves__vec3 uv = v3_sub(v, u);
  const double along = v3_dot(v3_sub(p, u), uv), length2 = v3_norm2(uv);
  if (!(along > 0)) {
    *end = 1;
    return u;
  }
  if (along >= length2) {
    *end = 2;
    return v;
  }
  *end = 0;
  return v3_mad(u, uv, along / length2);
}

/* What is closest lies on an edge beyond which p stands, so only those are tried; all three where the dual is NAN. */
static inline laves__vec3 closest(const laves__triangle *t, laves__vec3 p, int *on) {
  const laves__vec3 ap = v3_sub(p, t->a);
  const double v = v3_dot(ap, t->dual_b), w = v3_dot(ap, t->dual_c);
  const bool beyond[3] = {!(w >= 0), !(v + w <= 1), !(v >= 0)};
  if (!beyond[0] && !beyond[1] && !beyond[2]) {
    *on = LAVES__ON_FACE;
    return v3_add(t->a, v3_add(v3_scale(v3_sub(t->b, t->a), v), v3_scale(v3_sub(t->c, t->a), w)));
  }
  const laves__vec3 *corners[4] = {&t->a, &t->b, &t->c, &t->a};
  /* What holds for a point so far away that squares overflow. */
  laves__vec3 best = t->a;
  *on = LAVES__ON_CORNER;
  double least = INFINITY;
  for (int i = 0; i < 3; i++) {
    if (!beyond[i]) continue;
    int end;
    const laves__vec3 foot = closest_on_segment(*corners[i], *corners[i + 1], p, &end);
    const double d2 = v3_norm2(v3_sub(p, foot));
    if (d2 < least) {
      least = d2;
      best = foot;
      *on = end == 0 ? LAVES__ON_EDGE + i : LAVES__ON_CORNER + (i + end - 1) % 3;
    }
  }
  return best;
}

laves__vec3 laves__triangle_closest(const laves__triangle *t, laves__vec3 p, int *on) { return closest(t, p, on); }

static inline double distance2_to(const laves__triangle *t, laves__vec3 p) {
  int on;
  return v3_norm2(v3_sub(p, closest(t, p, &on)));
}

double laves__triangle_distance2(const laves__triangle *t, laves__vec3 p) { return distance2_to(t, p); }

/* How far x lies outside [centre - half, centre + half], lane by lane. */
static inline float4 outside(float x, const float4 *centre, const float4 *half) {
  const int4 no_sign = {INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX};
  const float4 offset = x - *centre;
  const float4 d = (float4)((int4)offset & no_sign) - *half;
  return (float4)((int4)d & (d > 0));
}

/* Squared distances of p to the four boxes, in units of the tree. */
static inline float4 box_distances(const laves__bvh_node *n, const float p[3]) {
  const float4 *centre = (const float4 *)n->centre, *half = (const float4 *)n->half;
  const float4 x = outside(p[0], &centre[0], &half[0]);
  const float4 y = outside(p[1], &centre[1], &half[1]);
  const float4 z = outside(p[2], &centre[2], &half[2]);
  return x * x + y * y + z * z;
}

typedef struct visit {
  float d2;
  uint32_t child;
} visit;

/* Pushes the children within limit, the nearest on top. */
static inline int push_children(const laves__bvh_node *n, const float p[3], float limit, visit *stack, int top) {
  const float4 d2 = box_distances(n, p);
  const int bottom = top;
  for (int i = 0; i < 4; i++) {
    if (d2[i] > limit) continue;
    int at = top++;
    for (; at > bottom && stack[at - 1].d2 < d2[i]; at--) stack[at] = stack[at - 1];
    stack[at] = (visit){d2[i], n->child[i]};
  }
  return top;
}

static inline float search_limit(const laves__bvh *bvh, double distance2) {
  const double limit = distance2 * bvh->scale * bvh->scale;
  return limit < 1e30 ? (float)limit * limit_slack + FLT_MIN : 1e30f;
}

void laves__bvh_nearest(const laves__bvh *bvh, laves__vec3 point, laves__nearest *best) {
  const float p[3] = {(float)(point.x * bvh->scale), (float)(point.y * bvh->scale), (float)(point.z * bvh->scale)};
  visit stack[LAVES__BVH_STACK];
  float limit = search_limit(bvh, best->distance2);
  int top = push_children(&bvh->nodes[0], p, limit, stack, 0);
  while (top > 0) {
    const visit next = stack[--top];
    if (next.d2 > limit) continue;
    if (!(next.child & LAVES__LEAF_BIT)) {
      top = push_children(&bvh->nodes[next.child], p, limit, stack, top);
      continue;
    }
    const uint32_t first = laves__leaf_first(next.child), last = laves__leaf_last(next.child);
    for (uint32_t slot = first; slot <= last; slot++) {
      const double d2 = distance2_to(&bvh->triangles[slot], point);
      if (d2 > best->distance2 || (d2 == best->distance2 && slot >= best->slot)) continue;
      *best = (laves__nearest){d2, slot};
      limit = search_limit(bvh, d2);
    }
  }
}

void laves__bvh_nearest_part(const laves__bvh *bvh, laves__vec3 point, laves__measure_fn *measure, void *user,
                             laves__nearest *best) {
  const float p[3] = {(float)(point.x * bvh->scale), (float)(point.y * bvh->scale), (float)(point.z * bvh->scale)};
  visit stack[LAVES__BVH_STACK];
  float limit = search_limit(bvh, best->distance2);
  int top = push_children(&bvh->nodes[0], p, limit, stack, 0);
  while (top > 0) {
    const visit next = stack[--top];
    if (next.d2 > limit) continue;
    if (!(next.child & LAVES__LEAF_BIT)) {
      top = push_children(&bvh->nodes[next.child], p, limit, stack, top);
      continue;
    }
    const uint32_t first = laves__leaf_first(next.child), last = laves__leaf_last(next.child);
    for (uint32_t slot = first; slot <= last; slot++) {
      const double whole = laves__triangle_distance2(&bvh->triangles[slot], point);
      if (whole > best->distance2) continue;
      const double d2 = measure(user, slot, whole, point);
      if (d2 > best->distance2 || (d2 == best->distance2 && slot >= best->slot)) continue;
      *best = (laves__nearest){d2, slot};
      limit = search_limit(bvh, d2);
    }
  }
}

/* ---- boxes ---- */

void laves__bvh_overlaps(const laves__bvh *bvh, laves__box3 region, laves__slot_fn *fn, void *user) {
  const laves__vec3 c = v3_scale(box3_centre(region), bvh->scale);
  const laves__vec3 h = v3_scale(v3_sub(region.upper, region.lower), 0.5 * bvh->scale);
  const float centre[3] = {(float)c.x, (float)c.y, (float)c.z};
  const float half[3] = {(float)h.x + box_slack, (float)h.y + box_slack, (float)h.z + box_slack};
  uint32_t stack[LAVES__BVH_STACK];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const laves__bvh_node *n = &bvh->nodes[stack[--top]];
    const float4 *node_centre = (const float4 *)n->centre, *node_half = (const float4 *)n->half;
    const int4 apart = (outside(centre[0], &node_centre[0], &node_half[0]) > half[0]) |
                       (outside(centre[1], &node_centre[1], &node_half[1]) > half[1]) |
                       (outside(centre[2], &node_centre[2], &node_half[2]) > half[2]);
    for (int i = 0; i < 4; i++) {
      if (apart[i]) continue;
      const uint32_t child = n->child[i];
      if (!(child & LAVES__LEAF_BIT)) {
        stack[top++] = child;
        continue;
      }
      const uint32_t first = laves__leaf_first(child), last = laves__leaf_last(child);
      for (uint32_t slot = first; slot <= last; slot++) fn(user, slot);
    }
  }
}

/* ---- rays ---- */

typedef struct ray {
  laves__vec3 origin, direction;
  float start[3], per_step[3]; /* in units of the tree; per_step is one over the direction */
} ray;

/* A step nearly along a side of boxes must not divide by zero; boxes are wider than what this bends the ray by. */
static float inverse(double x) {
  const float tiny = 1e-12f;
  return 1 / (fabs(x) > (double)tiny ? (float)x : x < 0 ? -tiny : tiny);
}

/* Which of the four boxes the ray meets before `farthest`. */
static inline int4 boxes_met(const laves__bvh_node *n, const ray *r, float farthest) {
  const float4 *centre = (const float4 *)n->centre, *half = (const float4 *)n->half;
  float4 enter = {0, 0, 0, 0}, leave = {farthest, farthest, farthest, farthest};
  for (int k = 0; k < 3; k++) {
    const float4 a = (centre[k] - half[k] - r->start[k]) * r->per_step[k];
    const float4 b = (centre[k] + half[k] - r->start[k]) * r->per_step[k];
    enter = greater(enter, lesser(a, b));
    leave = lesser(leave, greater(a, b));
  }
  return enter <= leave * limit_slack;
}

/* Where the ray passes through t: the distance, or INFINITY.  Moeller and Trumbore, "Fast, minimum storage ray-triangle
 * intersection", 1997. */
static double pass(const laves__triangle *t, const ray *r) {
  const laves__vec3 ab = v3_sub(t->b, t->a), ac = v3_sub(t->c, t->a), h = v3_cross(r->direction, ac);
  const double det = v3_dot(ab, h);
  if (det == 0) return INFINITY;
  const laves__vec3 at = v3_sub(r->origin, t->a), q = v3_cross(at, ab);
  const double u = v3_dot(at, h) / det, v = v3_dot(r->direction, q) / det, distance = v3_dot(ac, q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && distance > 0 ? distance : INFINITY;
}

static void pass_leaf(const laves__bvh *bvh, uint32_t child, const ray *r, uint32_t skip, laves__hit *hit) {
  const uint32_t first = laves__leaf_first(child), last = laves__leaf_last(child);
  for (uint32_t slot = first; slot <= last; slot++) {
    const double distance = slot == skip ? INFINITY : pass(&bvh->triangles[slot], r);
    if (distance < hit->distance || (distance == hit->distance && slot < hit->slot && isfinite(distance)))
      *hit = (laves__hit){distance, slot};
  }
}

void laves__bvh_shoot(const laves__bvh *bvh, laves__vec3 origin, laves__vec3 direction, uint32_t skip, laves__hit *hit) {
  const laves__vec3 start = v3_scale(origin, bvh->scale);
  const ray r = {origin,
                 direction,
                 {(float)start.x, (float)start.y, (float)start.z},
                 {inverse(direction.x), inverse(direction.y), inverse(direction.z)}};
  uint32_t stack[LAVES__BVH_STACK];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const laves__bvh_node *n = &bvh->nodes[stack[--top]];
    const double farthest = hit->distance * bvh->scale;
    const int4 met = boxes_met(n, &r, farthest < 1e6 ? (float)farthest * limit_slack : 1e6f);
    for (int i = 0; i < 4; i++) {
      if (!met[i] || !laves__bvh_is_used(n, i)) continue;
      if (n->child[i] & LAVES__LEAF_BIT)
        pass_leaf(bvh, n->child[i], &r, skip, hit);
      else
        stack[top++] = n->child[i];
    }
  }
}
