/* The store of expression nodes: hash-consing, constant folding, and lowering of coordinate changes.
 *
 * Folding keeps to identities that hold for every number but for rounding: x + 0, x * 1, x * 0, x / c as a product,
 * constants to the right, sums with constants merged, x * x as a square. */
#include "domain/expression.h"

#include <string.h>

#include "domain/elementary.h"
#include "domain/kept.h"

const uint8_t laves__op_operands[LAVES__OP_COUNT] = {
#define LAVES__OP_ROW(name, operands) operands,
    LAVES__OP_LIST(LAVES__OP_ROW)
#undef LAVES__OP_ROW
};

void laves__expression_init(laves__expression *e, laves_context *context) { *e = (laves__expression){.context = context}; }

void laves__expression_free(laves__expression *e) {
  laves__free(e->context, e->nodes, e->node_capacity, sizeof *e->nodes);
  laves__free(e->context, e->table, e->table_size, sizeof *e->table);
  laves__free(e->context, e->affines, e->affine_capacity, sizeof *e->affines);
  laves__free(e->context, e->warps, e->warp_capacity, sizeof *e->warps);
  laves__kept_free(e);
  laves__expression_init(e, e->context);
}

/* ---- hash-consing ---- */

static uint64_t mix(uint64_t h, uint64_t v) {
  h = (h ^ v) * 0x9e3779b97f4a7c15ULL;
  return h ^ (h >> 29);
}

static uint64_t node_hash(const laves__node_data *n) {
  uint64_t bits;
  memcpy(&bits, &n->value, sizeof bits);
  uint64_t h = mix(n->op, bits);
  for (int i = 0; i < 3; i++) h = mix(h, n->operand[i]);
  return h;
}

static bool same_node(const laves__node_data *a, const laves__node_data *b) {
  return a->op == b->op && memcmp(a->operand, b->operand, sizeof a->operand) == 0 &&
         memcmp(&a->value, &b->value, sizeof a->value) == 0; /* NOLINT: by bits, so that 0 and -0 stay apart */
}

static laves__node refuse(laves__expression *e, bool *reason) {
  (void)e;
  *reason = true;
  return LAVES__NO_NODE;
}

static bool table_grow(laves__expression *e) {
  const size_t size = e->table_size ? e->table_size * 2 : 64;
  uint32_t *table = laves__alloc_zeroed(e->context, size, sizeof *table);
  if (!table) return false;
  for (size_t i = 0; i < e->node_count; i++) {
    size_t slot = node_hash(&e->nodes[i]) & (size - 1);
    while (table[slot]) slot = (slot + 1) & (size - 1);
    table[slot] = (uint32_t)i + 1;
  }
  laves__free(e->context, e->table, e->table_size, sizeof *e->table);
  e->table = table;
  e->table_size = size;
  return true;
}

static laves__node intern(laves__expression *e, laves__node_data n) {
  if (2 * (e->node_count + 1) > e->table_size && !table_grow(e)) return refuse(e, &e->out_of_memory);
  size_t slot = node_hash(&n) & (e->table_size - 1);
  for (; e->table[slot]; slot = (slot + 1) & (e->table_size - 1))
    if (same_node(&e->nodes[e->table[slot] - 1], &n)) return e->table[slot] - 1;
  if (e->node_count >= LAVES__NODE_LIMIT) return refuse(e, &e->too_large);
  if (!laves__grow(e->context, &e->nodes, &e->node_capacity, e->node_count + 1, sizeof n)) return refuse(e, &e->out_of_memory);
  e->nodes[e->node_count] = n;
  e->table[slot] = (uint32_t)e->node_count + 1;
  return (laves__node)e->node_count++;
}

/* ---- folding ---- */

double laves__op_value(laves__op op, double a, double b, double c) {
  switch (op) {
    case LAVES__OP_NEGATE:
      return -a;
    case LAVES__OP_ABS:
      return fabs(a);
    case LAVES__OP_SQUARE:
      return a * a;
    case LAVES__OP_SQRT:
      return sqrt_of(a);
    case LAVES__OP_SIN:
      return sin_of(a);
    case LAVES__OP_COS:
      return cos_of(a);
    case LAVES__OP_TAN:
      return tan_of(a);
    case LAVES__OP_ASIN:
      return asin_of(a);
    case LAVES__OP_ACOS:
      return acos_of(a);
    case LAVES__OP_EXP:
      return exp_of(a);
    case LAVES__OP_LOG:
      return log_of(a);
    case LAVES__OP_FLOOR:
      return floor_of(a);
    case LAVES__OP_ADD:
      return a + b;
    case LAVES__OP_SUB:
      return a - b;
    case LAVES__OP_MUL:
      return a * b;
    case LAVES__OP_DIV:
      return a / b;
    case LAVES__OP_MIN:
      return min_of(a, b);
    case LAVES__OP_MAX:
      return max_of(a, b);
    case LAVES__OP_POW:
      return pow_of(a, b);
    case LAVES__OP_ATAN2:
      return atan2(a, b);
    case LAVES__OP_MOD:
      return mod_of(a, b);
    case LAVES__OP_NORM2:
      return norm2_of(a, b);
    case LAVES__OP_NORM3:
      return norm3_of(a, b, c);
    default:
      return NAN;
  }
}

bool laves__node_is_constant(const laves__expression *e, laves__node a, double *value) {
  if (a == LAVES__NO_NODE || e->nodes[a].op != LAVES__OP_CONSTANT) return false;
  *value = e->nodes[a].value;
  return true;
}

laves__node laves__node_constant(laves__expression *e, double value) {
  return intern(e, (laves__node_data){.value = value == 0 ? 0 : value, .op = LAVES__OP_CONSTANT}); /* no -0 */
}

static bool is_op(const laves__expression *e, laves__node a, laves__op op) { return e->nodes[a].op == (uint32_t)op; }

/* a op k for a constant k; LAVES__NO_NODE: no identity applies. */
static laves__node fold_right_constant(laves__expression *e, laves__op op, laves__node a, double k) {
  double inner;
  switch (op) {
    case LAVES__OP_ADD:
      if (k == 0) return a;
      if (is_op(e, a, LAVES__OP_ADD) && laves__node_is_constant(e, e->nodes[a].operand[1], &inner))
        return laves__node_make(e, LAVES__OP_ADD, e->nodes[a].operand[0], laves__node_constant(e, inner + k), 0);
      return LAVES__NO_NODE;
    case LAVES__OP_MUL:
      if (k == 0) return laves__node_constant(e, 0);
      if (k == 1) return a;
      if (k == -1) return laves__node_make(e, LAVES__OP_NEGATE, a, 0, 0);
      if (is_op(e, a, LAVES__OP_MUL) && laves__node_is_constant(e, e->nodes[a].operand[1], &inner))
        return laves__node_make(e, LAVES__OP_MUL, e->nodes[a].operand[0], laves__node_constant(e, inner * k), 0);
      return LAVES__NO_NODE;
    case LAVES__OP_SUB:
      return laves__node_make(e, LAVES__OP_ADD, a, laves__node_constant(e, -k), 0);
    case LAVES__OP_DIV:
      return isnormal(1 / k) ? laves__node_make(e, LAVES__OP_MUL, a, laves__node_constant(e, 1 / k), 0) : LAVES__NO_NODE;
    case LAVES__OP_POW:
      if (k == 0) return laves__node_constant(e, 1);
      if (k == 1) return a;
      if (k == 0.5) return laves__node_make(e, LAVES__OP_SQRT, a, 0, 0);
      return LAVES__NO_NODE;
    default:
      return LAVES__NO_NODE;
  }
}

/* a^n by squaring, for the integers that formulas use. */
static laves__node integer_power(laves__expression *e, laves__node a, int n) {
  laves__node result = LAVES__NO_NODE, square = a;
  for (int left = n < 0 ? -n : n; left; left >>= 1) {
    if (left & 1) result = result == LAVES__NO_NODE ? square : laves__node_make(e, LAVES__OP_MUL, result, square, 0);
    if (left > 1) square = laves__node_make(e, LAVES__OP_SQUARE, square, 0, 0);
  }
  return n < 0 ? laves__node_make(e, LAVES__OP_DIV, laves__node_constant(e, 1), result, 0) : result;
}

static laves__node fold_unary(laves__expression *e, laves__op op, laves__node a) {
  const laves__node inner = e->nodes[a].operand[0];
  if (op == LAVES__OP_NEGATE && is_op(e, a, LAVES__OP_NEGATE)) return inner;
  if ((op == LAVES__OP_ABS || op == LAVES__OP_SQUARE || op == LAVES__OP_COS) &&
      (is_op(e, a, LAVES__OP_NEGATE) || is_op(e, a, LAVES__OP_ABS)))
    return laves__node_make(e, op, inner, 0, 0);
  if (op == LAVES__OP_ABS && (is_op(e, a, LAVES__OP_SQUARE) || is_op(e, a, LAVES__OP_SQRT))) return a;
  return LAVES__NO_NODE;
}

static laves__node fold_binary(laves__expression *e, laves__op op, laves__node a, laves__node b) {
  double k;
  if (laves__node_is_constant(e, b, &k)) {
    if (op == LAVES__OP_POW && k == floor_of(k) && fabs(k) <= 64 && k != 0 && k != 1) return integer_power(e, a, (int)k);
    return fold_right_constant(e, op, a, k);
  }
  if (op == LAVES__OP_SUB && laves__node_is_constant(e, a, &k) && k == 0) return laves__node_make(e, LAVES__OP_NEGATE, b, 0, 0);
  if (a == b) {
    if (op == LAVES__OP_MUL) return laves__node_make(e, LAVES__OP_SQUARE, a, 0, 0);
    if (op == LAVES__OP_MIN || op == LAVES__OP_MAX) return a;
    if (op == LAVES__OP_SUB) return laves__node_constant(e, 0);
  }
  if (op == LAVES__OP_ADD && is_op(e, b, LAVES__OP_NEGATE))
    return laves__node_make(e, LAVES__OP_SUB, a, e->nodes[b].operand[0], 0);
  if (op == LAVES__OP_SUB && is_op(e, b, LAVES__OP_NEGATE))
    return laves__node_make(e, LAVES__OP_ADD, a, e->nodes[b].operand[0], 0);
  return LAVES__NO_NODE;
}

/* Only one- and two-operand instructions take constants. */
static laves__node spelled_norm3(laves__expression *e, const laves__node operand[3]) {
  laves__node sum = laves__node_constant(e, 0);
  for (int i = 0; i < 3; i++)
    sum = laves__node_make(e, LAVES__OP_ADD, sum, laves__node_make(e, LAVES__OP_SQUARE, operand[i], 0, 0), 0);
  return laves__node_make(e, LAVES__OP_SQRT, sum, 0, 0);
}

static bool commutes(laves__op op) {
  return op == LAVES__OP_ADD || op == LAVES__OP_MUL || op == LAVES__OP_MIN || op == LAVES__OP_MAX || op == LAVES__OP_NORM2;
}

static bool has_failed(const laves__expression *e) { return e->out_of_memory || e->too_large; }

laves__node laves__node_make(laves__expression *e, laves__op op, laves__node a, laves__node b, laves__node c) {
  const int operands = laves__op_operands[op];
  laves__node operand[3] = {operands > 0 ? a : 0, operands > 1 ? b : 0, operands > 2 ? c : 0};
  if (operand[0] == LAVES__NO_NODE || operand[1] == LAVES__NO_NODE || operand[2] == LAVES__NO_NODE) return LAVES__NO_NODE;

  double value[3] = {0, 0, 0};
  int constants = 0;
  for (int i = 0; i < operands; i++) constants += laves__node_is_constant(e, operand[i], &value[i]);
  LAVES_ASSERT(op != LAVES__OP_TAG && op != LAVES__OP_REGION);
  if (operands && constants == operands) return laves__node_constant(e, laves__op_value(op, value[0], value[1], value[2]));
  if (op == LAVES__OP_NORM3 && constants) return spelled_norm3(e, operand);
  if (commutes(op)) { /* constants to the right, then by number */
    const bool left_constant = is_op(e, operand[0], LAVES__OP_CONSTANT),
               right_constant = is_op(e, operand[1], LAVES__OP_CONSTANT);
    if (left_constant != right_constant ? left_constant : operand[0] > operand[1]) {
      const laves__node swap = operand[0];
      operand[0] = operand[1];
      operand[1] = swap;
    }
  }
  laves__node folded = LAVES__NO_NODE;
  if (operands == 1) folded = fold_unary(e, op, operand[0]);
  if (operands == 2) folded = fold_binary(e, op, operand[0], operand[1]);
  if (folded != LAVES__NO_NODE || has_failed(e)) return folded;
  return intern(e, (laves__node_data){.operand = {operand[0], operand[1], operand[2]}, .op = op});
}

/* A leaf takes registers only, so a constant coordinate is dressed up as 0 x + c, past the folding. */
static laves__node as_variable(laves__expression *e, laves__node a) {
  if (has_failed(e) || !is_op(e, a, LAVES__OP_CONSTANT)) return a;
  const laves__node x = laves__node_make(e, LAVES__OP_X, 0, 0, 0), zero = laves__node_constant(e, 0);
  if (has_failed(e)) return LAVES__NO_NODE;
  const laves__node nothing = intern(e, (laves__node_data){.operand = {x, zero, 0}, .op = LAVES__OP_MUL});
  if (has_failed(e)) return LAVES__NO_NODE;
  return intern(e, (laves__node_data){.operand = {nothing, a, 0}, .op = LAVES__OP_ADD});
}

laves__node laves__node_leaf(laves__expression *e, uint32_t index) {
  const laves__node x = laves__node_make(e, LAVES__OP_X, 0, 0, 0), y = laves__node_make(e, LAVES__OP_Y, 0, 0, 0),
                    z = laves__node_make(e, LAVES__OP_Z, 0, 0, 0);
  if (has_failed(e)) return LAVES__NO_NODE;
  return intern(e, (laves__node_data){.value = index, .operand = {x, y, z}, .op = LAVES__OP_LEAF});
}

/* ---- changes of coordinates ---- */

laves__affine laves__affine_identity(void) { return (laves__affine){{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {0, 0, 0}}; }

laves__affine laves__affine_compose(const laves__affine *a, const laves__affine *b) {
  laves__affine r;
  for (int i = 0; i < 3; i++) r.m.row[i] = m3_mul_transposed(&b->m, a->m.row[i]);
  r.t = v3_add(m3_mul(&a->m, b->t), a->t);
  return r;
}

laves__node laves__node_affine(laves__expression *e, laves__node body, const laves__affine *map) {
  if (body == LAVES__NO_NODE) return LAVES__NO_NODE;
  if (!laves__grow(e->context, &e->affines, &e->affine_capacity, e->affine_count + 1, sizeof *map))
    return refuse(e, &e->out_of_memory);
  e->affines[e->affine_count] = *map;
  return intern(e, (laves__node_data){.value = (double)e->affine_count++, .operand = {body, 0, 0}, .op = LAVES__OP_AFFINE});
}

laves__node laves__node_warp(laves__expression *e, laves__node body, const laves__node coordinate[3]) {
  for (int i = 0; i < 3; i++)
    if (coordinate[i] == LAVES__NO_NODE) return LAVES__NO_NODE;
  if (body == LAVES__NO_NODE) return LAVES__NO_NODE;
  if (!laves__grow(e->context, &e->warps, &e->warp_capacity, e->warp_count + 1, sizeof *e->warps))
    return refuse(e, &e->out_of_memory);
  e->warps[e->warp_count] = (laves__warp){{coordinate[0], coordinate[1], coordinate[2]}};
  return intern(e, (laves__node_data){.value = (double)e->warp_count++, .operand = {body, 0, 0}, .op = LAVES__OP_WARP});
}

laves__node laves__node_tag(laves__expression *e, laves__node a, uint32_t tag) {
  if (a == LAVES__NO_NODE || is_op(e, a, LAVES__OP_CONSTANT) || is_op(e, a, LAVES__OP_TAG)) return a;
  return intern(e, (laves__node_data){.value = tag, .operand = {a, 0, 0}, .op = LAVES__OP_TAG});
}

laves__node laves__node_region(laves__expression *e, laves__node a, uint32_t region) {
  if (a == LAVES__NO_NODE || is_op(e, a, LAVES__OP_CONSTANT)) return a;
  return intern(e, (laves__node_data){.value = region, .operand = {a, 0, 0}, .op = LAVES__OP_REGION});
}

/* ---- lowering: a depth-first walk with its own stack over pairs (node, frame) ---- */

/* Coordinates that a body sees: the matrix applied to three lowered nodes. */
typedef struct frame {
  laves__node base[3];
  laves__affine map;
} frame;

typedef struct memo_entry {
  uint64_t key; /* node << 32 | frame, plus 1; 0 is free */
  laves__node lowered;
} memo_entry;

typedef struct visit {
  laves__node node;
  uint32_t frame, inner_frame, stage;
} visit;

typedef struct lowering {
  laves__expression *e;
  frame *frames;
  size_t frame_count, frame_capacity;
  memo_entry *memo;
  size_t memo_count, memo_size;
  visit *stack;
  size_t stack_count, stack_capacity;
} lowering;

static memo_entry *memo_slot(memo_entry *memo, size_t size, uint64_t key) {
  size_t slot = mix(1, key) & (size - 1);
  while (memo[slot].key && memo[slot].key != key) slot = (slot + 1) & (size - 1);
  return &memo[slot];
}

static uint64_t memo_key(laves__node node, uint32_t frame_index) { return ((uint64_t)node << 32 | frame_index) + 1; }

static bool memo_grow(lowering *w) {
  const size_t size = w->memo_size ? 2 * w->memo_size : 256;
  memo_entry *memo = laves__alloc_zeroed(w->e->context, size, sizeof *memo);
  if (!memo) return false;
  for (size_t i = 0; i < w->memo_size; i++)
    if (w->memo[i].key) *memo_slot(memo, size, w->memo[i].key) = w->memo[i];
  laves__free(w->e->context, w->memo, w->memo_size, sizeof *memo);
  w->memo = memo;
  w->memo_size = size;
  return true;
}

static bool memo_set(lowering *w, laves__node node, uint32_t frame_index, laves__node lowered) {
  if (2 * (w->memo_count + 1) > w->memo_size && !memo_grow(w)) return false;
  memo_entry *entry = memo_slot(w->memo, w->memo_size, memo_key(node, frame_index));
  w->memo_count += entry->key == 0;
  *entry = (memo_entry){memo_key(node, frame_index), lowered};
  return true;
}

static laves__node memo_get(const lowering *w, laves__node node, uint32_t frame_index) {
  if (!w->memo_size) return LAVES__NO_NODE;
  const memo_entry *entry = memo_slot(w->memo, w->memo_size, memo_key(node, frame_index));
  return entry->key ? entry->lowered : LAVES__NO_NODE;
}

static bool push(lowering *w, laves__node node, uint32_t frame_index) {
  if (memo_get(w, node, frame_index) != LAVES__NO_NODE) return true;
  if (!laves__grow(w->e->context, &w->stack, &w->stack_capacity, w->stack_count + 1, sizeof *w->stack)) return false;
  w->stack[w->stack_count++] = (visit){.node = node, .frame = frame_index};
  return true;
}

static bool add_frame(lowering *w, const frame *f) {
  if (!laves__grow(w->e->context, &w->frames, &w->frame_capacity, w->frame_count + 1, sizeof *f)) return false;
  w->frames[w->frame_count++] = *f;
  return true;
}

/* Coordinate `axis` of a frame as a sum of scaled base nodes. */
static laves__node frame_coordinate(laves__expression *e, const frame *f, int axis) {
  const laves__vec3 row = f->map.m.row[axis];
  laves__node sum = laves__node_constant(e, 0);
  for (int i = 0; i < 3; i++) {
    const laves__node term = laves__node_make(e, LAVES__OP_MUL, f->base[i], laves__node_constant(e, v3_at(row, i)), 0);
    sum = laves__node_make(e, LAVES__OP_ADD, sum, term, 0);
  }
  return laves__node_make(e, LAVES__OP_ADD, sum, laves__node_constant(e, v3_at(f->map.t, axis)), 0);
}

laves__node laves__node_leaf_at(laves__expression *e, uint32_t index, const laves__node coordinate[3]) {
  laves__node_data n = {.value = index, .op = LAVES__OP_LEAF};
  for (int i = 0; i < 3; i++) n.operand[i] = as_variable(e, coordinate[i]);
  return has_failed(e) ? LAVES__NO_NODE : intern(e, n);
}

/* Handles the top of the stack once: either pushes what it waits for, or finishes it. False when memory is short. */
static bool lower_step(lowering *w) {
  laves__expression *e = w->e;
  const size_t top = w->stack_count - 1;
  const visit v = w->stack[top];
  if (memo_get(w, v.node, v.frame) != LAVES__NO_NODE) { /* met twice before it was finished */
    w->stack_count = top;
    return true;
  }
  const laves__node_data n = e->nodes[v.node];
  w->stack[top].stage++;
  if (n.op == LAVES__OP_WARP && v.stage == 0) {
    const laves__warp warp = e->warps[(size_t)n.value];
    return push(w, warp.coordinate[0], v.frame) && push(w, warp.coordinate[1], v.frame) && push(w, warp.coordinate[2], v.frame);
  }
  if ((n.op == LAVES__OP_AFFINE && v.stage == 0) || (n.op == LAVES__OP_WARP && v.stage == 1)) {
    frame inner = w->frames[v.frame];
    if (n.op == LAVES__OP_AFFINE) {
      inner.map = laves__affine_compose(&e->affines[(size_t)n.value], &inner.map);
    } else {
      const laves__warp warp = e->warps[(size_t)n.value];
      for (int i = 0; i < 3; i++) inner.base[i] = memo_get(w, warp.coordinate[i], v.frame);
      inner.map = laves__affine_identity();
    }
    w->stack[top].inner_frame = (uint32_t)w->frame_count;
    return add_frame(w, &inner) && push(w, n.operand[0], (uint32_t)w->frame_count - 1);
  }
  if (n.op != LAVES__OP_AFFINE && n.op != LAVES__OP_WARP && v.stage == 0 && laves__op_operands[n.op]) {
    for (int i = 0; i < laves__op_operands[n.op]; i++)
      if (!push(w, n.operand[i], v.frame)) return false;
    return true;
  }

  laves__node lowered;
  laves__node operand[3] = {0, 0, 0};
  if (n.op == LAVES__OP_AFFINE || n.op == LAVES__OP_WARP) {
    lowered = memo_get(w, n.operand[0], v.inner_frame);
  } else {
    for (int i = 0; i < laves__op_operands[n.op]; i++) operand[i] = memo_get(w, n.operand[i], v.frame);
    if (n.op >= LAVES__OP_X && n.op <= LAVES__OP_Z)
      lowered = frame_coordinate(e, &w->frames[v.frame], (int)(n.op - LAVES__OP_X));
    else if (n.op == LAVES__OP_LEAF)
      lowered = laves__node_leaf_at(e, (uint32_t)n.value, operand);
    else if (n.op == LAVES__OP_CONSTANT)
      lowered = v.node;
    else if (n.op == LAVES__OP_TAG)
      lowered = laves__node_tag(e, operand[0], (uint32_t)n.value);
    else if (n.op == LAVES__OP_REGION)
      lowered = laves__node_region(e, operand[0], (uint32_t)n.value);
    else
      lowered = laves__node_make(e, (laves__op)n.op, operand[0], operand[1], operand[2]);
  }
  w->stack_count = top;
  return lowered != LAVES__NO_NODE && memo_set(w, v.node, v.frame, lowered);
}

laves__node laves__expression_lower(laves__expression *e, laves__node root, const laves__affine *outer) {
  if (root == LAVES__NO_NODE) return LAVES__NO_NODE;
  lowering w = {.e = e};
  laves__node result = LAVES__NO_NODE;
  const frame first = {{laves__node_make(e, LAVES__OP_X, 0, 0, 0), laves__node_make(e, LAVES__OP_Y, 0, 0, 0),
                        laves__node_make(e, LAVES__OP_Z, 0, 0, 0)},
                       *outer};
  bool ok = !has_failed(e) && add_frame(&w, &first) && push(&w, root, 0);
  for (size_t step = 0; ok && w.stack_count; step++) {
    ok = !laves__cancelled_at(e->context, "script", step, SIZE_MAX) && lower_step(&w);
    if (w.memo_count > 4 * (size_t)LAVES__NODE_LIMIT || w.frame_count > LAVES__NODE_LIMIT) { /* even if they fold to few nodes */
      e->too_large = true;
      ok = false;
    }
  }
  if (ok) result = memo_get(&w, root, 0);
  if (!ok && !e->too_large) e->out_of_memory = true;
  laves__free(e->context, w.frames, w.frame_capacity, sizeof *w.frames);
  laves__free(e->context, w.memo, w.memo_size, sizeof *w.memo);
  laves__free(e->context, w.stack, w.stack_capacity, sizeof *w.stack);
  return result;
}
