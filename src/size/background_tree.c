/* Sizes in tets or at points: the nearest item is found in a tree of boxes, and its corners' values blended.
 *
 * The tree is binary and made top down: a range of items is parted at the middle of the box of its centres, along the longest
 * side, so that it follows the grading of the mesh; deep down, and where one side would stay empty, it is parted in halves.
 * So the depth is bounded whatever the file holds. A search goes to the nearer child first and leaves out boxes that are
 * not nearer than the best item so far; a place inside a tet has the distance 0, which ends it. Outside, the nearest point of
 * a tet is on one of the faces that the place is beyond [ericson2005]; where tets overlap the first found counts, which
 * depends on the file alone. The weights of the corners are never negative, so values stay between those of the file.
 *
 * C. Ericson, "Real-time collision detection", 2005, sec. 5.1.6. */
#include <string.h>

#include "size/background_parts.h"

/* Items of a leaf; tets are dearer to look at than boxes. Levels parted at the middle: enough to reach details 2^-13 of the
 * whole along three axes; at most 32 levels of halves follow. */
enum { LEAF_ITEMS = 4, MIDDLE_LEVELS = 40, STACK_SIZE = MIDDLE_LEVELS + 34 };

enum { ITEMS_PER_QUESTION = 1 << 17 }; /* looked at between two questions whether to cancel */

/* ---- building ---- */

typedef struct range {
  uint32_t node, begin, end;
  int level;
} range;

static const uint32_t *item_corners(const laves__background_tree *tree, size_t item) {
  return tree->items + item * (size_t)tree->corners;
}

static laves__box3 item_box(const laves__background_tree *tree, size_t item) {
  laves__box3 box = box3_empty();
  for (int c = 0; c < tree->corners; c++) box = box3_add(box, tree->points[item_corners(tree, item)[c]]);
  return box;
}

static laves__vec3 item_centre(const laves__background_tree *tree, size_t item) { return box3_centre(item_box(tree, item)); }

static void swap_items(laves__background_tree *tree, size_t a, size_t b) {
  uint32_t *x = tree->items + a * (size_t)tree->corners, *y = tree->items + b * (size_t)tree->corners;
  for (int c = 0; c < tree->corners; c++) {
    const uint32_t held = x[c];
    x[c] = y[c];
    y[c] = held;
  }
  if (!tree->per_item) return;
  const double held = tree->values[a];
  tree->values[a] = tree->values[b];
  tree->values[b] = held;
}

static double coordinate(laves__vec3 p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

/* For loops over the items of a range, of which the first ones are long. */
static bool is_cancelled_at(const laves__background_tree *tree, const range *r, uint32_t i) {
  return laves__cancelled_at(tree->context, "read", i - r->begin + 1, tree->item_count + 1);
}

/* Moves items whose centre is below the middle of all centres to the front; returns the first of the others. */
static uint32_t part_at_middle(laves__background_tree *tree, const range *r) {
  laves__box3 centres = box3_empty();
  for (uint32_t i = r->begin; i < r->end && !is_cancelled_at(tree, r, i); i++) centres = box3_add(centres, item_centre(tree, i));
  const laves__vec3 sides = v3_sub(centres.upper, centres.lower);
  const int axis = sides.x >= sides.y && sides.x >= sides.z ? 0 : sides.y >= sides.z ? 1 : 2;
  const double middle = coordinate(box3_centre(centres), axis);
  uint32_t parting = r->begin;
  for (uint32_t i = r->begin; i < r->end && !is_cancelled_at(tree, r, i); i++)
    if (coordinate(item_centre(tree, i), axis) < middle) swap_items(tree, i, parting++);
  return parting;
}

static laves__box3 range_box(const laves__background_tree *tree, const range *r) {
  laves__box3 box = box3_empty();
  for (uint32_t i = r->begin; i < r->end && !is_cancelled_at(tree, r, i); i++) {
    const laves__box3 item = item_box(tree, i);
    box = box3_add(box3_add(box, item.lower), item.upper);
  }
  return box;
}

static bool add_nodes(laves__background_tree *tree, size_t count) {
  if (!laves__grow(tree->context, &tree->nodes, &tree->node_capacity, tree->node_count + count, sizeof *tree->nodes))
    return false;
  tree->node_count += count;
  return true;
}

static laves_result build(laves__background_tree *tree, laves_error *error) {
  range stack[STACK_SIZE] = {{.end = (uint32_t)tree->item_count}};
  int height = 1;
  if (!add_nodes(tree, 1)) return laves__fail_memory(tree->context, error);
  for (size_t looked_at = ITEMS_PER_QUESTION; height > 0;) {
    const range r = stack[--height];
    looked_at += r.end - r.begin;
    if (looked_at > ITEMS_PER_QUESTION) {
      if (laves__cancelled(tree->context, "read", 1)) return laves__fail_cancelled(error);
      looked_at = 0;
    }
    laves__background_node *node = &tree->nodes[r.node];
    *node = (laves__background_node){range_box(tree, &r), r.begin, r.end - r.begin};
    if (node->count <= LEAF_ITEMS) continue;
    uint32_t parting = r.level < MIDDLE_LEVELS ? part_at_middle(tree, &r) : r.begin;
    if (parting == r.begin || parting == r.end) parting = r.begin + (r.end - r.begin) / 2;
    const uint32_t children = (uint32_t)tree->node_count;
    node->first = children;
    node->count = 0;
    if (!add_nodes(tree, 2)) return laves__fail_memory(tree->context, error);
    stack[height++] = (range){children, r.begin, parting, r.level + 1};
    stack[height++] = (range){children + 1, parting, r.end, r.level + 1};
  }
  return LAVES_OK;
}

static laves_result copy_input(const laves__mesh_input *input, laves__background_tree *tree, laves_error *error) {
  const size_t corners = (size_t)tree->corners;
  tree->points = laves__alloc(tree->context, tree->point_count, sizeof *tree->points);
  tree->values = laves__alloc(tree->context, tree->value_count, sizeof *tree->values);
  tree->items = laves__alloc(tree->context, tree->item_count, corners * sizeof *tree->items);
  if (!tree->points || !tree->values || !tree->items) return laves__fail_memory(tree->context, error);
  for (size_t i = 0; i < tree->point_count && !laves__cancelled_at(tree->context, "read", i, tree->point_count); i++)
    tree->points[i] = input->points[i];
  for (size_t i = 0; i < tree->value_count && !laves__cancelled_at(tree->context, "read", i, tree->value_count); i++)
    tree->values[i] = input->values.items[i];
  const size_t numbers = tree->item_count * corners;
  for (size_t i = 0; i < numbers && !laves__cancelled_at(tree->context, "read", i, numbers); i++)
    tree->items[i] = corners == 4 ? (uint32_t)input->tets[i / 4][i % 4] : (uint32_t)i;
  return laves__is_cancelled(tree->context) ? laves__fail_cancelled(error) : LAVES_OK;
}

laves_result laves__background_tree_make(const laves__mesh_input *input, laves__background_tree *tree, laves_error *error) {
  *tree = (laves__background_tree){.context = input->context,
                                   .per_item = input->values.per_tet,
                                   .corners = input->tet_count > 0 ? 4 : 1,
                                   .item_count = input->tet_count > 0 ? input->tet_count : input->point_count,
                                   .point_count = input->point_count,
                                   .value_count = input->values.count};
  if (tree->item_count > INT32_MAX)
    return laves__mesh_input_fail(input, error, "it has more than 2147483647 tetrahedra; a coarser background will do");
  laves_result result = copy_input(input, tree, error);
  if (result == LAVES_OK) result = build(tree, error);
  if (result != LAVES_OK) laves__background_tree_free(tree);
  return result;
}

void laves__background_tree_free(laves__background_tree *tree) {
  laves__free(tree->context, tree->points, tree->point_count, sizeof *tree->points);
  laves__free(tree->context, tree->values, tree->value_count, sizeof *tree->values);
  laves__free(tree->context, tree->items, tree->item_count, (size_t)tree->corners * sizeof *tree->items);
  laves__free(tree->context, tree->nodes, tree->node_capacity, sizeof *tree->nodes);
  memset(tree, 0, sizeof *tree);
}

/* ---- nearest points ---- */

/* A place as a blend of corners: weights sum to 1 and are not negative. */
typedef struct blend {
  double weights[4];
  double distance2; /* from the place asked for */
} blend;

static void keep_nearer(blend *best, blend candidate) {
  if (candidate.distance2 < best->distance2) *best = candidate;
}

static blend nearest_on_edge(const laves__vec3 corners[4], laves__vec3 p, int a, int b) {
  const laves__vec3 along = v3_sub(corners[b], corners[a]);
  const double length2 = v3_norm2(along), t = v3_dot(v3_sub(p, corners[a]), along);
  const double share = length2 > 0 && t > 0 ? (t < length2 ? t / length2 : 1) : 0;
  blend result = {.distance2 = v3_norm2(v3_sub(v3_mad(corners[a], along, share), p))};
  result.weights[a] = 1 - share;
  result.weights[b] = share;
  return result;
}

/* On the face without corner `apex`: within it, else on one of its edges. Faces without area have edges still. */
static blend nearest_on_face(const laves__vec3 corners[4], laves__vec3 p, int apex) {
  const int a = apex == 0, b = apex <= 1 ? 2 : 1, c = apex == 3 ? 2 : 3;
  const laves__vec3 u = v3_sub(corners[b], corners[a]), v = v3_sub(corners[c], corners[a]), w = v3_sub(p, corners[a]);
  const laves__vec3 normal = v3_cross(u, v);
  const double area2 = v3_norm2(normal);
  const double at_b = v3_dot(v3_cross(w, v), normal) / area2, at_c = v3_dot(v3_cross(u, w), normal) / area2;
  if (area2 > 0 && at_b >= 0 && at_c >= 0 && at_b + at_c <= 1) {
    blend inside = {.distance2 = v3_norm2(v3_sub(v3_add(v3_scale(u, at_b), v3_scale(v, at_c)), w))};
    inside.weights[a] = 1 - at_b - at_c;
    inside.weights[b] = at_b;
    inside.weights[c] = at_c;
    return inside;
  }
  blend best = nearest_on_edge(corners, p, a, b);
  keep_nearer(&best, nearest_on_edge(corners, p, b, c));
  keep_nearer(&best, nearest_on_edge(corners, p, c, a));
  return best;
}

static blend nearest_in_tet(const laves__vec3 corners[4], laves__vec3 p) {
  const laves__vec3 u = v3_sub(corners[1], corners[0]), v = v3_sub(corners[2], corners[0]), w = v3_sub(corners[3], corners[0]);
  const laves__vec3 q = v3_sub(p, corners[0]);
  const double volume = v3_dot(u, v3_cross(v, w));
  blend inside = {
      .weights = {0, v3_dot(q, v3_cross(v, w)) / volume, v3_dot(q, v3_cross(w, u)) / volume, v3_dot(q, v3_cross(u, v)) / volume}};
  inside.weights[0] = 1 - inside.weights[1] - inside.weights[2] - inside.weights[3];
  const double *s = inside.weights;
  if (s[0] >= 0 && s[1] >= 0 && s[2] >= 0 && s[3] >= 0) return inside;
  blend best = {.weights = {1}, .distance2 = INFINITY};
  for (int apex = 0; apex < 4; apex++)
    if (!(s[apex] >= 0)) keep_nearer(&best, nearest_on_face(corners, p, apex)); /* flat tets have no number there: all faces */
  return best;
}

static blend nearest_in_item(const laves__background_tree *tree, size_t item, laves__vec3 p) {
  const uint32_t *indices = item_corners(tree, item);
  if (tree->corners == 1) return (blend){.weights = {1}, .distance2 = v3_norm2(v3_sub(p, tree->points[indices[0]]))};
  laves__vec3 corners[4];
  for (int c = 0; c < 4; c++) corners[c] = tree->points[indices[c]];
  return nearest_in_tet(corners, p);
}

/* ---- searching ---- */

static double box_distance2(const laves__box3 *box, laves__vec3 p) {
  return v3_norm2(v3_sub(p, v3_max(box->lower, v3_min(p, box->upper))));
}

typedef struct found {
  size_t item;
  blend blend;
} found;

static void search_leaf(const laves__background_tree *tree, const laves__background_node *node, laves__vec3 p, found *best) {
  for (uint32_t i = 0; i < node->count && best->blend.distance2 > 0; i++) {
    const blend candidate = nearest_in_item(tree, node->first + i, p);
    if (candidate.distance2 < best->blend.distance2) *best = (found){node->first + i, candidate};
  }
}

typedef struct visit {
  uint32_t node;
  double distance2;
} visit;

static found search(const laves__background_tree *tree, laves__vec3 p) {
  visit stack[STACK_SIZE] = {{0, 0}};
  int height = 1;
  found best = {0, {.weights = {1}, .distance2 = INFINITY}};
  while (height > 0) {
    const visit here = stack[--height];
    const laves__background_node *node = &tree->nodes[here.node];
    if (!(here.distance2 < best.blend.distance2)) continue;
    if (node->count > 0) {
      search_leaf(tree, node, p, &best);
      continue;
    }
    const visit left = {node->first, box_distance2(&tree->nodes[node->first].box, p)};
    const visit right = {node->first + 1, box_distance2(&tree->nodes[node->first + 1].box, p)};
    const bool left_first = left.distance2 <= right.distance2;
    stack[height++] = left_first ? right : left;
    stack[height++] = left_first ? left : right;
  }
  return best;
}

double laves__background_tree_at(const laves__background_tree *tree, laves__vec3 p) {
  const found best = search(tree, p);
  if (tree->per_item) return tree->values[best.item];
  const uint32_t *indices = item_corners(tree, best.item);
  double value = 0, low = INFINITY, high = 0;
  for (int c = 0; c < tree->corners; c++) {
    const double v = tree->values[indices[c]];
    value += best.blend.weights[c] * v;
    low = v < low ? v : low;
    high = v > high ? v : high;
  }
  return value < low ? low : value > high ? high : value;
}
