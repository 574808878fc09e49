/* The graph of what a script keeps, and the list that is made of it in the end. */
#include "domain/kept.h"

#include "domain/features.h"

typedef enum kept_kind { DRAWN, BOTH, MOVED } kept_kind;

typedef struct kept_node {
  kept_kind kind;
  uint32_t a, b;                                           /* of BOTH; a of MOVED, which is not MOVED itself */
  size_t first_point, point_count, first_line, line_count; /* of DRAWN, among those of the store */
  laves__affine map;                                       /* of MOVED */
  size_t size;                                             /* points and vertices that it means */
} kept_node;

struct laves__keeps {
  laves_features drawn; /* all that was drawn */
  size_t taken_points, taken_lines;
  kept_node *node; /* number - 1 */
  size_t node_count, node_capacity;
  bool too_large;
};

static struct laves__keeps *keeps_of(laves__expression *e) {
  if (!e->keeps) e->keeps = laves__alloc_zeroed(e->context, 1, sizeof *e->keeps);
  e->out_of_memory |= !e->keeps;
  return e->keeps;
}

void laves__kept_free(laves__expression *e) {
  struct laves__keeps *k = e->keeps;
  if (!k) return;
  laves__free(e->context, k->drawn.point, k->drawn.point_capacity, sizeof *k->drawn.point);
  laves__free(e->context, k->drawn.vertex, k->drawn.vertex_capacity, sizeof *k->drawn.vertex);
  laves__free(e->context, k->drawn.line_end, k->drawn.line_capacity, sizeof *k->drawn.line_end);
  laves__free(e->context, k->node, k->node_capacity, sizeof *k->node);
  laves__free(e->context, k, 1, sizeof *k);
  e->keeps = NULL;
}

bool laves__kept_is_too_large(const laves__expression *e) { return e->keeps && e->keeps->too_large; }

/* ---- drawing ---- */

static bool has_room(struct laves__keeps *k) {
  k->too_large |= k->drawn.point_count + k->drawn.vertex_count >= LAVES__KEPT_LIMIT;
  return !k->too_large;
}

static bool grow(laves__expression *e, void *block, size_t *capacity, size_t needed, size_t size) {
  if (laves__grow(e->context, block, capacity, needed, size)) return true;
  e->out_of_memory = true;
  return false;
}

bool laves__kept_add_point(laves__expression *e, laves__vec3 point) {
  struct laves__keeps *k = keeps_of(e);
  if (!k || !has_room(k)) return false;
  laves_features *f = &k->drawn;
  if (!grow(e, &f->point, &f->point_capacity, f->point_count + 1, sizeof *f->point)) return false;
  f->point[f->point_count++] = point;
  return true;
}

bool laves__kept_add_vertex(laves__expression *e, laves__vec3 vertex) {
  struct laves__keeps *k = keeps_of(e);
  if (!k || !has_room(k)) return false;
  laves_features *f = &k->drawn;
  if (!grow(e, &f->vertex, &f->vertex_capacity, f->vertex_count + 1, sizeof *f->vertex)) return false;
  f->vertex[f->vertex_count++] = vertex;
  return true;
}

bool laves__kept_end_line(laves__expression *e) {
  struct laves__keeps *k = keeps_of(e);
  if (!k) return false;
  laves_features *f = &k->drawn;
  const size_t first = f->line_count ? f->line_end[f->line_count - 1] : 0;
  if (f->vertex_count - first < 2) {
    f->vertex_count = first;
    return true;
  }
  if (!grow(e, &f->line_end, &f->line_capacity, f->line_count + 1, sizeof *f->line_end)) return false;
  f->line_end[f->line_count++] = f->vertex_count;
  return true;
}

/* ---- nodes ---- */

static uint32_t add_node(laves__expression *e, const kept_node *node) {
  struct laves__keeps *k = keeps_of(e);
  if (!k) return 0;
  k->too_large |= node->size > LAVES__KEPT_LIMIT || k->node_count >= LAVES__KEPT_LIMIT;
  if (k->too_large || !grow(e, &k->node, &k->node_capacity, k->node_count + 1, sizeof *k->node)) return 0;
  k->node[k->node_count++] = *node;
  return (uint32_t)k->node_count;
}

static size_t vertices_before(const laves_features *f, size_t line) { return line ? f->line_end[line - 1] : 0; }

uint32_t laves__kept_take(laves__expression *e) {
  struct laves__keeps *k = e->keeps;
  if (!k) return 0;
  const laves_features *f = &k->drawn;
  const size_t vertices = vertices_before(f, f->line_count) - vertices_before(f, k->taken_lines);
  const kept_node node = {.kind = DRAWN,
                          .first_point = k->taken_points,
                          .point_count = f->point_count - k->taken_points,
                          .first_line = k->taken_lines,
                          .line_count = f->line_count - k->taken_lines,
                          .size = f->point_count - k->taken_points + vertices};
  k->taken_points = f->point_count;
  k->taken_lines = f->line_count;
  return node.size ? add_node(e, &node) : 0;
}

uint32_t laves__kept_both(laves__expression *e, uint32_t a, uint32_t b) {
  if (!a || !b || a == b) return a ? a : b;
  const kept_node node = {.kind = BOTH, .a = a, .b = b, .size = e->keeps->node[a - 1].size + e->keeps->node[b - 1].size};
  return add_node(e, &node);
}

uint32_t laves__kept_moved(laves__expression *e, uint32_t a, const laves__affine *map) {
  if (!a) return 0;
  const kept_node *from = &e->keeps->node[a - 1];
  kept_node node = {.kind = MOVED, .a = a, .map = *map, .size = from->size};
  if (from->kind == MOVED) {
    node.a = from->a;
    node.map = laves__affine_compose(map, &from->map);
  }
  return add_node(e, &node);
}

/* ---- the list ---- */

typedef struct visit {
  uint32_t kept;
  laves__affine map;
} visit;

static laves_result fail_far(laves_error *error) {
  return laves__fail(error, LAVES_ERROR_INPUT,
                     "keep: a point has coordinates beyond all numbers once its solid is moved or scaled");
}

static laves__vec3 image(const laves__affine *map, laves__vec3 p) { return v3_add(m3_mul(&map->m, p), map->t); }

static laves_result list_drawn(const laves_features *drawn, const kept_node *node, const laves__affine *map,
                               laves_features *features, laves_error *error) {
  laves_result result = LAVES_OK;
  for (size_t i = 0; i < node->point_count && result == LAVES_OK; i++) {
    const laves__vec3 p = image(map, drawn->point[node->first_point + i]);
    result = v3_finite(p) ? laves_features_add_points(features, (double[3]){p.x, p.y, p.z}, 1, error) : fail_far(error);
  }
  for (size_t i = node->first_line; i < node->first_line + node->line_count && result == LAVES_OK; i++) {
    const size_t first = vertices_before(drawn, i), count = drawn->line_end[i] - first;
    laves__vec3 *line = laves__alloc(features->context, count, sizeof *line);
    if (!line) return laves__fail_memory(features->context, error);
    for (size_t k = 0; k < count && result == LAVES_OK; k++) {
      line[k] = image(map, drawn->vertex[first + k]);
      if (!v3_finite(line[k])) result = fail_far(error);
    }
    if (result == LAVES_OK) result = laves_features_add_line(features, &line->x, count, error);
    laves__free(features->context, line, count, sizeof *line);
  }
  return result;
}

/* Walks the graph below a node, first operands first; as many steps as there are points to list, about. */
laves_result laves__kept_list(laves__expression *e, uint32_t kept, laves_features **features, laves_error *error) {
  visit *stack = NULL;
  size_t count = 0, capacity = 0;
  *features = NULL;
  if (!kept) return LAVES_OK;
  laves_result result = laves_features_create(e->context, features, error);
  if (result == LAVES_OK && !laves__grow(e->context, &stack, &capacity, 1, sizeof *stack))
    result = laves__fail_memory(e->context, error);
  if (result == LAVES_OK) stack[count++] = (visit){kept, laves__affine_identity()};
  for (size_t step = 0; count > 0 && result == LAVES_OK; step++) {
    if (laves__cancelled_at(e->context, "script", step, SIZE_MAX)) {
      result = laves__fail_cancelled(error);
      break;
    }
    const visit v = stack[--count];
    const kept_node *node = &e->keeps->node[v.kept - 1];
    if (!laves__grow(e->context, &stack, &capacity, count + 2, sizeof *stack)) {
      result = laves__fail_memory(e->context, error);
    } else if (node->kind == DRAWN) {
      result = list_drawn(&e->keeps->drawn, node, &v.map, *features, error);
    } else if (node->kind == MOVED) {
      stack[count++] = (visit){node->a, laves__affine_compose(&v.map, &node->map)};
    } else {
      stack[count++] = (visit){node->b, v.map};
      stack[count++] = (visit){node->a, v.map};
    }
  }
  laves__free(e->context, stack, capacity, sizeof *stack);
  if (result != LAVES_OK) {
    laves_features_free(*features);
    *features = NULL;
  }
  return result;
}
