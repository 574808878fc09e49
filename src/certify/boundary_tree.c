/* Nearest points on triangles.
 *
 * Triangles are sorted along a Morton curve and cut into leaves of four; above the leaves stands a complete binary tree
 * of boxes in an array, node i over nodes 2i and 2i + 1, leaves padded with empty boxes to a power of two. A query goes
 * down nearest box first and drops boxes that are no nearer than what it has. In a leaf it drops triangles whose own boxes are no
 * nearer: most of them, at a fifth of what the nearest point of one costs.
 *
 * The nearest point of a triangle by Voronoi regions: [ericson2005], section 5.1.5. */
#include "certify/boundary_tree.h"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

enum { LEAF_TRIANGLES = 4, LEAF_PAIRS = LEAF_TRIANGLES / 2, MORTON_BITS = 21, STACK = 64, NO_LEVEL = INT8_MAX };

/* Keeps the nearest triangle below a caller's bound that was rounded, or that it just meets. */
#define BOUND_SLACK 1e-9

/* Two lanes, in the vector notation that GCC and Clang share. */
typedef double double2 __attribute__((vector_size(16), aligned(8), may_alias));
typedef int64_t long2 __attribute__((vector_size(16), aligned(8), may_alias));

/* Two boxes side by side, so that both are asked at once: those of nodes 2i and 2i + 1, or of two triangles. */
typedef struct box_pair {
  double2 lower[3], upper[3]; /* by axis */
} box_pair;

/* A triangle's own box is wider by this share of its diagonal. The square of a distance is rounded by some 1e-16 of the square of
 * the triangle's extent, so one that is dropped for its box would not have come out nearer by rounding either. */
#define BOX_SLACK 1e-6

typedef struct triangle {
  laves__vec3 a, b, c;
  float edge; /* local */
  int level;
} triangle;

struct laves__boundary_tree {
  laves_context *context;
  size_t triangle_capacity, triangle_count, leaf_count; /* leaf_count: a power of two */
  triangle *triangles;
  box_pair *boxes;          /* [leaf_count]: [i] holds nodes 2i and 2i + 1; there is no node 0 */
  box_pair *triangle_boxes; /* [leaf_count][LEAF_PAIRS], a little wider: BOX_SLACK */
  int8_t *levels;           /* [2 leaf_count] the least in each box */
  int greatest;             /* of all levels */
};

/* ---- one triangle, one box ---- */

/* Square of the distance from the origin to triangle abc. */
static double nearest2(laves__vec3 a, laves__vec3 b, laves__vec3 c) {
  const laves__vec3 ab = v3_sub(b, a), ac = v3_sub(c, a);
  const double d1 = -v3_dot(ab, a), d2 = -v3_dot(ac, a);
  if (d1 <= 0 && d2 <= 0) return v3_norm2(a);
  const double d3 = -v3_dot(ab, b), d4 = -v3_dot(ac, b);
  if (d3 >= 0 && d4 <= d3) return v3_norm2(b);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return v3_norm2(v3_mad(a, ab, d1 / (d1 - d3)));
  const double d5 = -v3_dot(ab, c), d6 = -v3_dot(ac, c);
  if (d6 >= 0 && d5 <= d6) return v3_norm2(c);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return v3_norm2(v3_mad(a, ac, d2 / (d2 - d6)));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return v3_norm2(v3_lerp(b, c, (d4 - d3) / ((d4 - d3) + (d5 - d6))));
  const double sum = va + vb + vc;
  return v3_norm2(v3_add(a, v3_add(v3_scale(ab, vb / sum), v3_scale(ac, vc / sum))));
}

/* Zero inside; in a form without jumps, as their way can't be foretold. */
static double outside(double x, double lower, double upper) {
  const double below = lower - x, above = x - upper, most = below > above ? below : above;
  return most > 0 ? most : 0;
}

static double box_distance2(const laves__box3 *b, laves__vec3 p) {
  return v3_norm2(
      v3(outside(p.x, b->lower.x, b->upper.x), outside(p.y, b->lower.y, b->upper.y), outside(p.z, b->lower.z, b->upper.z)));
}

/* Lane by lane a > b ? a : b: one instruction where there is one. */
static inline double2 greater(double2 a, double2 b) {
#ifdef __SSE2__
  return (double2)_mm_max_pd((__m128d)a, (__m128d)b);
#else
  const long2 more = a > b;
  return (double2)(((long2)a & more) | ((long2)b & ~more));
#endif
}

/* The same of two boxes, lane by lane. */
static inline double2 pair_distances2(const box_pair *b, laves__vec3 p) {
  const double2 none = {0, 0}, x = {p.x, p.x}, y = {p.y, p.y}, z = {p.z, p.z};
  const double2 away_x = greater(greater(b->lower[0] - x, x - b->upper[0]), none);
  const double2 away_y = greater(greater(b->lower[1] - y, y - b->upper[1]), none);
  const double2 away_z = greater(greater(b->lower[2] - z, z - b->upper[2]), none);
  return away_x * away_x + away_y * away_y + away_z * away_z;
}

static void set_box(box_pair *b, size_t i, const laves__box3 *box) {
  const double lower[3] = {box->lower.x, box->lower.y, box->lower.z}, upper[3] = {box->upper.x, box->upper.y, box->upper.z};
  for (int axis = 0; axis < 3; axis++) {
    b[i / 2].lower[axis][i % 2] = lower[axis];
    b[i / 2].upper[axis][i % 2] = upper[axis];
  }
}

static laves__box3 get_box(const box_pair *b, size_t i) {
  const box_pair *p = &b[i / 2];
  const size_t k = i % 2;
  return (laves__box3){v3(p->lower[0][k], p->lower[1][k], p->lower[2][k]), v3(p->upper[0][k], p->upper[1][k], p->upper[2][k])};
}

/* ---- building ---- */

/* Spreads the low 21 bits so that two zeros stand between them. */
static uint64_t spread(uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

static uint64_t cell(double x, double lower, double upper) {
  const double fraction = upper > lower ? (x - lower) / (upper - lower) : 0;
  return spread((uint64_t)(fraction * ((1 << MORTON_BITS) - 1)));
}

static uint64_t morton(laves__vec3 p, const laves__box3 *b) {
  return cell(p.x, b->lower.x, b->upper.x) | cell(p.y, b->lower.y, b->upper.y) << 1 | cell(p.z, b->lower.z, b->upper.z) << 2;
}

static triangle triangle_of(const laves_mesh *mesh, const int32_t face[3], laves__vec3 origin) {
  const laves__vec3 *p = mesh->points;
  return (triangle){.a = v3_sub(p[face[0]], origin), .b = v3_sub(p[face[1]], origin), .c = v3_sub(p[face[2]], origin)};
}

static laves__vec3 middle(const triangle *t) { return v3_scale(v3_add(t->a, v3_add(t->b, t->c)), 1.0 / 3); }

static bool is_finite(const triangle *t) { return v3_finite(t->a) && v3_finite(t->b) && v3_finite(t->c); }

/* Whether all is to end: asked by every loop over triangles while the tree is built. */
static bool stopped(const laves__boundary_tree *tree, size_t i, size_t count) {
  return laves__cancelled_at(tree->context, "distance", i, count);
}

/* Fills `order` with the finite triangles along the curve; returns how many. */
static size_t sort_triangles(const laves__boundary_tree *tree, const laves_mesh *mesh, const laves__boundary *boundary,
                             laves__vec3 origin, laves__keyed *order, laves__keyed *scratch) {
  laves__box3 box = box3_empty();
  size_t count = 0;
  for (size_t i = 0; i < boundary->count && !stopped(tree, i, boundary->count); i++) {
    const triangle t = triangle_of(mesh, boundary->faces[i], origin);
    if (!is_finite(&t)) continue;
    box = box3_add(box, middle(&t));
    order[count++].value = i;
  }
  for (size_t i = 0; i < count && !stopped(tree, i, count); i++) {
    const triangle t = triangle_of(mesh, boundary->faces[order[i].value], origin);
    order[i].key = morton(middle(&t), &box);
  }
  laves__sort_keyed(NULL, order, scratch, count);
  return count;
}

static laves__box3 triangle_box(const triangle *t) {
  return (laves__box3){v3_min(t->a, v3_min(t->b, t->c)), v3_max(t->a, v3_max(t->b, t->c))};
}

static laves__box3 wider(const laves__box3 *box) {
  const double slack = BOX_SLACK * box3_diagonal(*box);
  const laves__vec3 around = v3(slack, slack, slack);
  return (laves__box3){v3_sub(box->lower, around), v3_add(box->upper, around)};
}

static laves__box3 join(const laves__box3 *a, const laves__box3 *b) {
  return (laves__box3){v3_min(a->lower, b->lower), v3_max(a->upper, b->upper)};
}

/* The boxes of a leaf and of its triangles; what has no triangle is empty. */
static void fill_leaf(laves__boundary_tree *tree, size_t leaf) {
  const size_t node = tree->leaf_count + leaf;
  laves__box3 all = box3_empty();
  tree->levels[node] = NO_LEVEL;
  for (size_t i = leaf * LEAF_TRIANGLES; i < (leaf + 1) * LEAF_TRIANGLES; i++) {
    const triangle *t = i < tree->triangle_count ? &tree->triangles[i] : NULL;
    const laves__box3 own = t ? triangle_box(t) : box3_empty(), wide = t ? wider(&own) : own;
    set_box(tree->triangle_boxes, i, &wide);
    all = join(&all, &own);
    if (t && t->level < tree->levels[node]) tree->levels[node] = (int8_t)t->level;
  }
  set_box(tree->boxes, node, &all);
}

static void fill_boxes(laves__boundary_tree *tree) {
  const laves__box3 none = box3_empty();
  set_box(tree->boxes, 0, &none);
  for (size_t leaf = 0; leaf < tree->leaf_count && !stopped(tree, leaf, tree->leaf_count); leaf++) fill_leaf(tree, leaf);
  for (size_t i = tree->leaf_count - 1; i >= 1 && !stopped(tree, i, tree->leaf_count); i--) {
    const laves__box3 low = get_box(tree->boxes, 2 * i), high = get_box(tree->boxes, 2 * i + 1), both = join(&low, &high);
    set_box(tree->boxes, i, &both);
    const int8_t a = tree->levels[2 * i], b = tree->levels[2 * i + 1];
    tree->levels[i] = a < b ? a : b;
  }
}

/* The triangles in their order, with what is known of their edges. */
static void fill_triangles(const laves_mesh *mesh, const laves__boundary *boundary, laves__vec3 origin, const float *edges,
                           double base, const laves__keyed *order, laves__boundary_tree *tree) {
  tree->greatest = -NO_LEVEL;
  for (size_t i = 0; i < tree->triangle_count && !stopped(tree, i, tree->triangle_count); i++) {
    const int32_t *face = boundary->faces[order[i].value];
    triangle *t = &tree->triangles[i];
    *t = triangle_of(mesh, face, origin);
    if (edges) t->edge = (float)laves__local_edge(edges, face);
    t->level = laves__edge_level((double)t->edge, base);
    if (t->level > tree->greatest) tree->greatest = t->level;
  }
}

laves_result laves__boundary_tree_build(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                        laves__vec3 origin, const float *edges, double base, laves__boundary_tree **tree,
                                        laves_error *error) {
  const size_t count = boundary->count;
  laves_result result = LAVES_OK;
  laves__boundary_tree *made = laves__alloc_zeroed(context, 1, sizeof *made);
  laves__keyed *order = laves__alloc(context, count, sizeof *order), *scratch = laves__alloc(context, count, sizeof *scratch);
  *tree = NULL;
  if (!made || !order || !scratch) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  made->context = context;
  made->triangle_capacity = count;
  made->leaf_count = 1;
  while (made->leaf_count * LEAF_TRIANGLES < count) made->leaf_count *= 2;
  made->triangles = laves__alloc(context, count, sizeof *made->triangles);
  made->boxes = laves__alloc(context, made->leaf_count, sizeof *made->boxes);
  made->triangle_boxes = laves__alloc(context, LEAF_PAIRS * made->leaf_count, sizeof *made->triangle_boxes);
  made->levels = laves__alloc(context, 2 * made->leaf_count, sizeof *made->levels);
  if (!made->triangles || !made->boxes || !made->triangle_boxes || !made->levels) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  made->triangle_count = sort_triangles(made, mesh, boundary, origin, order, scratch);
  fill_triangles(mesh, boundary, origin, edges, base, order, made);
  fill_boxes(made);
  if (laves__is_cancelled(context)) {
    result = laves__fail_cancelled(error);
    goto clean_up;
  }
  *tree = made;
  made = NULL;
clean_up:
  laves__free(context, order, count, sizeof *order);
  laves__free(context, scratch, count, sizeof *scratch);
  if (made) {
    made->context = context;
    laves__boundary_tree_free(made);
  }
  return result;
}

void laves__boundary_tree_free(laves__boundary_tree *tree) {
  if (!tree) return;
  laves_context *context = tree->context;
  laves__free(context, tree->triangles, tree->triangle_capacity, sizeof *tree->triangles);
  laves__free(context, tree->boxes, tree->leaf_count, sizeof *tree->boxes);
  laves__free(context, tree->triangle_boxes, LEAF_PAIRS * tree->leaf_count, sizeof *tree->triangle_boxes);
  laves__free(context, tree->levels, 2 * tree->leaf_count, sizeof *tree->levels);
  laves__free(context, tree, 1, sizeof *tree);
}

/* ---- queries ---- */

static double distance2_to(const triangle *t, laves__vec3 p) {
  return nearest2(v3_sub(t->a, p), v3_sub(t->b, p), v3_sub(t->c, p));
}

static double leaf_nearest2(const laves__boundary_tree *tree, size_t leaf, laves__vec3 p, double best, float *edge,
                            size_t *near) {
  double2 box2[LEAF_PAIRS];
  for (size_t k = 0; k < LEAF_PAIRS; k++) box2[k] = pair_distances2(&tree->triangle_boxes[leaf * LEAF_PAIRS + k], p);
  for (size_t i = leaf * LEAF_TRIANGLES; i < (leaf + 1) * LEAF_TRIANGLES && i < tree->triangle_count; i++) {
    if (box2[i % LEAF_TRIANGLES / 2][i % 2] >= best) continue;
    const double distance2 = distance2_to(&tree->triangles[i], p);
    if (!(distance2 < best)) continue;
    best = distance2;
    *edge = tree->triangles[i].edge;
    *near = i;
  }
  return best;
}

/* A node that is still to be seen, and the square of the distance of its box. */
typedef struct step {
  size_t node;
  double distance2;
} step;

/* The latest node on the stack that is near enough; 0 when there is none. */
static size_t take_next(const step *stack, int *depth, double best) {
  while (*depth > 0)
    if (stack[--*depth].distance2 < best) return stack[*depth].node;
  return 0;
}

/* A bound, from wherever it is, only leaves boxes out: the order in which the others are seen, and so which of several triangles
 * as near is the one, stays the same. */
double laves__boundary_tree_distance(const laves__boundary_tree *tree, laves__vec3 point, double bound, float *edge,
                                     size_t *near) {
  step stack[STACK];
  int depth = 0;
  double best = bound * bound;
  if (tree->triangle_count == 0) return INFINITY;
  if (*near < tree->triangle_count) {
    const double known = distance2_to(&tree->triangles[*near], point);
    if (known > 0 && known < best) best = known; /* nothing is below zero */
  }
  best *= 1 + BOUND_SLACK;
  for (size_t node = 1; node != 0; node = take_next(stack, &depth, best)) {
    while (node != 0 && node < tree->leaf_count) {
      const double2 distance2 = pair_distances2(&tree->boxes[node], point);
      const bool low_first = distance2[0] <= distance2[1];
      const double near_by = low_first ? distance2[0] : distance2[1], further = low_first ? distance2[1] : distance2[0];
      stack[depth] = (step){2 * node + low_first, further};
      depth += further < best;
      node = near_by < best ? 2 * node + !low_first : 0;
    }
    if (node != 0) best = leaf_nearest2(tree, node - tree->leaf_count, point, best, edge, near);
  }
  return sqrt(best);
}

void laves__boundary_tree_levels(const laves__boundary_tree *tree, int *least, int *greatest) {
  *least = tree->triangle_count ? tree->levels[1] : 0;
  *greatest = tree->triangle_count ? tree->greatest : 0;
}

/* By the triangles' boxes: a leaf may hold triangles far from one another. */
static int8_t leaf_level(const laves__boundary_tree *tree, size_t leaf, laves__vec3 p, double radius, int8_t least) {
  for (size_t i = leaf * LEAF_TRIANGLES; i < (leaf + 1) * LEAF_TRIANGLES && i < tree->triangle_count; i++) {
    const triangle *t = &tree->triangles[i];
    const laves__box3 box = triangle_box(t);
    if (t->level < least && box_distance2(&box, p) <= radius * radius) least = (int8_t)t->level;
  }
  return least;
}

int laves__boundary_tree_level(const laves__boundary_tree *tree, laves__vec3 point, double radius) {
  size_t stack[STACK] = {1};
  int depth = 1;
  int8_t least = NO_LEVEL;
  while (depth > 0) {
    const size_t node = stack[--depth];
    const laves__box3 box = get_box(tree->boxes, node);
    if (tree->levels[node] >= least || box_distance2(&box, point) > radius * radius) continue;
    if (node >= tree->leaf_count) {
      least = leaf_level(tree, node - tree->leaf_count, point, radius, least);
      continue;
    }
    stack[depth++] = 2 * node + 1;
    stack[depth++] = 2 * node;
  }
  return least == NO_LEVEL ? 0 : least;
}
