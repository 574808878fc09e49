/* Compiling tapes and running them over batches of points.
 *
 * Nodes are scheduled depth first, the operand that needs more registers first (Sethi and Ullman, "The generation of optimal
 * code for arithmetic expressions", 1970), and a register is free again after its last reader. A batch is as many
 * points as let all registers fit into a fixed block on the stack, at most BATCH; each instruction is one loop over it. */
#include "domain/tape.h"

#include <stdlib.h>

#include "base/wide.h"
#include "domain/elementary.h"

/* Doubles in the register block of a run: 128 KiB, or 2 KiB for a few points. */
enum { SCRATCH = 4 * LAVES__REGISTER_LIMIT, BATCH = 256, FEW = 256 };

/* ---- compiling ---- */

typedef struct compiler {
  const laves__expression *e;
  uint32_t *uses;     /* [nodes] readers left, 0: not reachable */
  uint16_t *need;     /* [nodes] registers that evaluating it alone takes */
  uint16_t *reg;      /* [nodes] where its value is, or LAVES__OPERAND_CONSTANT: not yet computed */
  uint32_t *stack;    /* [nodes + 1] */
  uint32_t *made;     /* [nodes] instructions up to the one that computes it; undefined before */
  laves__node *plain; /* [nodes] what is named: names stand beside the instructions */
  int32_t *tag;       /* [nodes] the innermost of the names of a surface; LAVES__NO_TAG but for names */
  uint16_t free[LAVES__REGISTER_LIMIT];
  size_t free_count;
  laves__tape *tape;
} compiler;

static bool is_name(const laves__expression *e, laves__node a) {
  return e->nodes[a].op == LAVES__OP_TAG || e->nodes[a].op == LAVES__OP_REGION;
}

/* Sees through chains of names, which may be as long as the expression: in one pass, as operands have smaller numbers. */
static void look_through_names(compiler *c, size_t nodes) {
  for (size_t i = 0; i < nodes; i++) {
    const laves__node_data *n = &c->e->nodes[i];
    c->plain[i] = (laves__node)i;
    c->tag[i] = LAVES__NO_TAG;
    if (!is_name(c->e, (laves__node)i)) continue;
    c->plain[i] = c->plain[n->operand[0]];
    c->tag[i] = c->tag[n->operand[0]];
    if (c->tag[i] == LAVES__NO_TAG && n->op == LAVES__OP_TAG) c->tag[i] = (int32_t)n->value;
  }
}

static bool is_constant(const laves__expression *e, laves__node a) { return e->nodes[a].op == LAVES__OP_CONSTANT; }
static bool is_input(const laves__expression *e, laves__node a) {
  return e->nodes[a].op >= LAVES__OP_X && e->nodes[a].op <= LAVES__OP_Z;
}

/* Operands have smaller numbers than their node, so one pass down counts the readers and one up the need. */
static size_t count_uses(compiler *c, laves__node root) {
  size_t reachable = 0;
  c->uses[root] = 1;
  for (size_t i = (size_t)root + 1; i-- > 0;) {
    if (!c->uses[i]) continue;
    const laves__node_data *n = &c->e->nodes[i];
    const int operands = laves__op_operands[n->op];
    for (int k = 0; k < operands; k++) c->uses[c->plain[n->operand[k]]]++;
    reachable += operands > 0;
  }
  for (size_t i = 0; i <= root; i++) {
    const laves__node_data *n = &c->e->nodes[i];
    uint16_t need = laves__op_operands[n->op] ? 1 : 0;
    for (int k = 0; k < laves__op_operands[n->op]; k++) {
      const uint16_t other = c->need[c->plain[n->operand[k]]];
      need = (uint16_t)(other > need ? other : need + (other == need && other < UINT16_MAX));
    }
    c->need[i] = need;
  }
  return reachable;
}

static bool is_computed(const compiler *c, laves__node a) {
  return is_constant(c->e, a) || is_input(c->e, a) || c->reg[a] != LAVES__OPERAND_CONSTANT;
}

static void release(compiler *c, laves__node a) {
  if (--c->uses[a] == 0 && !is_input(c->e, a) && !is_constant(c->e, a)) c->free[c->free_count++] = c->reg[a];
}

static bool emit(compiler *c, laves__node a) {
  const laves__node_data *n = &c->e->nodes[a];
  laves__instruction instruction = {.op = (uint16_t)n->op};
  const int operands = laves__op_operands[n->op];
  for (int k = 0; k < operands; k++) {
    const laves__node b = c->plain[n->operand[k]];
    if (c->tape->tags) c->tape->tags[3 * c->tape->count + (size_t)k] = c->tag[n->operand[k]];
    instruction.operand[k] = is_input(c->e, b) ? (uint16_t)(c->e->nodes[b].op - LAVES__OP_X) : c->reg[b];
    if (is_constant(c->e, b)) {
      instruction.operand[k] = LAVES__OPERAND_CONSTANT;
      instruction.constant = c->e->nodes[b].value;
    }
  }
  if (n->op == LAVES__OP_LEAF) instruction.leaf = (uint16_t)n->value;
  for (int k = 0; k < operands; k++) release(c, c->plain[n->operand[k]]);
  if (c->free_count == 0) {
    if (c->tape->register_count == LAVES__REGISTER_LIMIT) return false;
    c->free[c->free_count++] = (uint16_t)c->tape->register_count++;
  }
  c->reg[a] = instruction.out = c->free[--c->free_count];
  c->tape->instructions[c->tape->count++] = instruction;
  c->made[a] = (uint32_t)c->tape->count;
  return true;
}

/* Depth-first; a node is emitted once all of its operands are. */
static bool schedule(compiler *c, laves__node root) {
  size_t depth = 0;
  c->stack[depth++] = root;
  while (depth) {
    const laves__node a = c->stack[depth - 1];
    if (is_computed(c, a)) {
      depth--;
      continue;
    }
    const laves__node_data *n = &c->e->nodes[a];
    laves__node next = LAVES__NO_NODE;
    for (int k = 0; k < laves__op_operands[n->op]; k++) {
      const laves__node b = c->plain[n->operand[k]];
      if (!is_computed(c, b) && (next == LAVES__NO_NODE || c->need[b] > c->need[next])) next = b;
    }
    if (next != LAVES__NO_NODE) {
      c->stack[depth++] = next; /* never deeper than there are nodes, as operands have smaller numbers */
    } else if (!emit(c, a)) {
      return false;
    }
  }
  return true;
}

/* A bare coordinate becomes x + 0, a constant 0 x + c: a tape always has an instruction that yields its value. */
static void emit_trivial(compiler *c, laves__node root) {
  const laves__node_data *n = &c->e->nodes[root];
  laves__tape *tape = c->tape;
  const bool constant = is_constant(c->e, root);
  const uint16_t input = constant ? 0 : (uint16_t)(n->op - LAVES__OP_X);
  tape->register_count = 4;
  laves__instruction *p = tape->instructions;
  p[0] =
      (laves__instruction){.op = LAVES__OP_MUL, .out = 3, .operand = {input, LAVES__OPERAND_CONSTANT, 0}, .constant = !constant};
  p[1] = (laves__instruction){.op = LAVES__OP_ADD, .out = 3, .operand = {3, LAVES__OPERAND_CONSTANT, 0}};
  p[1].constant = constant ? n->value : 0;
  tape->count = 2;
}

static bool any_op(const laves__expression *e, size_t nodes, laves__op op) {
  for (size_t i = 0; i < nodes; i++)
    if (e->nodes[i].op == (uint32_t)op) return true;
  return false;
}

static int compare_regions(const void *a, const void *b) {
  const laves__tape_region *x = a, *y = b;
  if (x->after != y->after) return x->after < y->after ? -1 : 1;
  return (x->region > y->region) - (x->region < y->region);
}

/* Lists the regions that can be reached from `root`, names included, once the tape stands. False when memory is short. */
static bool list_regions(compiler *c, laves__node root) {
  const laves__expression *e = c->e;
  const size_t nodes = (size_t)root + 1;
  laves__tape *tape = c->tape;
  if (!any_op(e, nodes, LAVES__OP_REGION)) return true;
  bool *reached = laves__alloc_zeroed(e->context, nodes, sizeof *reached);
  if (!reached) return false;
  reached[root] = true;
  size_t count = 0;
  for (size_t i = nodes; i-- > 0;) { /* operands have smaller numbers than their node */
    const laves__node_data *n = &e->nodes[i];
    for (int k = 0; reached[i] && k < laves__op_operands[n->op]; k++) reached[n->operand[k]] = true;
    count += reached[i] && n->op == LAVES__OP_REGION;
  }
  if (count > 0) tape->regions = laves__alloc(e->context, count, sizeof *tape->regions);
  const bool done = count == 0 || tape->regions;
  for (size_t i = 0; done && i < nodes; i++) {
    if (!reached[i] || e->nodes[i].op != LAVES__OP_REGION) continue;
    const laves__node a = c->plain[i];
    laves__tape_region r = {.region = (int32_t)e->nodes[i].value};
    if (is_input(e, a)) {
      r.operand = (uint16_t)(e->nodes[a].op - LAVES__OP_X);
    } else {
      r.operand = c->reg[a];
      r.after = c->made[a];
    }
    tape->regions[tape->region_count++] = r;
  }
  if (tape->regions) qsort(tape->regions, tape->region_count, sizeof *tape->regions, compare_regions);
  laves__free(e->context, reached, nodes, sizeof *reached);
  return done;
}

laves_result laves__tape_build(const laves__expression *e, laves__node root, const laves__oracle *leaves, laves__tape *tape,
                               laves_error *error) {
  laves_context *context = e->context;
  const size_t nodes = (size_t)root + 1;
  *tape = (laves__tape){.leaves = leaves, .register_count = 3};
  const laves__node named_root = root;
  laves_result result = LAVES_OK;
  size_t reachable = 0;
  compiler *c = laves__alloc_zeroed(context, 1, sizeof *c);
  if (!c) return laves__fail_memory(context, error);
  *c = (compiler){.e = e, .tape = tape};
  c->uses = laves__alloc_zeroed(context, nodes, sizeof *c->uses);
  c->need = laves__alloc(context, nodes, sizeof *c->need);
  c->reg = laves__alloc(context, nodes, sizeof *c->reg);
  c->stack = laves__alloc(context, nodes + 1, sizeof *c->stack);
  c->made = laves__alloc(context, nodes, sizeof *c->made);
  c->plain = laves__alloc(context, nodes, sizeof *c->plain);
  c->tag = laves__alloc(context, nodes, sizeof *c->tag);
  if (!c->uses || !c->need || !c->reg || !c->stack || !c->made || !c->plain || !c->tag) {
    result = laves__fail_memory(context, error);
    goto done;
  }
  look_through_names(c, nodes);
  tape->root_tag = c->tag[root];
  root = c->plain[root];
  for (size_t i = 0; i < nodes; i++) c->reg[i] = LAVES__OPERAND_CONSTANT;
  reachable = count_uses(c, root);
  tape->instructions = laves__alloc(context, reachable ? reachable : 2, sizeof *tape->instructions);
  if (tape->instructions && reachable && any_op(e, nodes, LAVES__OP_TAG))
    tape->tags = laves__alloc(context, 3 * reachable, sizeof *tape->tags);
  if (!tape->instructions || (reachable && any_op(e, nodes, LAVES__OP_TAG) && !tape->tags)) {
    laves__free(context, tape->instructions, reachable ? reachable : 2, sizeof *tape->instructions);
    *tape = (laves__tape){.leaves = leaves};
    result = laves__fail_memory(context, error);
    goto done;
  }
  if (!reachable) {
    emit_trivial(c, root);
  } else if (!schedule(c, root)) {
    result = laves__fail(error, LAVES_ERROR_INPUT,
                         "the expression needs more than %d intermediate values at once; split the solid into simpler parts",
                         LAVES__REGISTER_LIMIT);
    laves__free(context, tape->instructions, reachable, sizeof *tape->instructions);
    laves__free(context, tape->tags, 3 * reachable, sizeof *tape->tags);
    *tape = (laves__tape){.leaves = leaves};
  }
  if (result == LAVES_OK && !list_regions(c, named_root)) {
    laves__tape_free(context, tape);
    result = laves__fail_memory(context, error);
  }
done:
  laves__free(context, c->plain, nodes, sizeof *c->plain);
  laves__free(context, c->tag, nodes, sizeof *c->tag);
  laves__free(context, c->made, nodes, sizeof *c->made);
  laves__free(context, c->uses, nodes, sizeof *c->uses);
  laves__free(context, c->need, nodes, sizeof *c->need);
  laves__free(context, c->reg, nodes, sizeof *c->reg);
  laves__free(context, c->stack, nodes + 1, sizeof *c->stack);
  laves__free(context, c, 1, sizeof *c);
  return result;
}

void laves__tape_free(laves_context *context, laves__tape *tape) {
  laves__free(context, tape->instructions, tape->count, sizeof *tape->instructions);
  laves__free(context, tape->tags, 3 * tape->count, sizeof *tape->tags);
  laves__free(context, tape->regions, tape->region_count, sizeof *tape->regions);
  *tape = (laves__tape){0};
}

/* ---- batches ---- */

/* The outputs may overwrite the coordinates, as they are gathered first. */
static void run_leaf(const laves__oracle *leaf, size_t count, const double *x, const double *y, const double *z, double *out) {
  laves__vec3 points[BATCH];
  for (size_t i = 0; i < count; i++) points[i] = v3_sub(v3(x[i], y[i], z[i]), leaf->origin);
  leaf->evaluate(leaf->self, count, points, out, NULL);
}

/* One loop over the batch; out may be one of the operands' registers, which is safe as item i depends on items i only. */
#define LOOP(expression)                                    \
  for (size_t i = 0; i < count; i++) out[i] = (expression); \
  break
#define UNARY(name, expression) \
  case LAVES__OP_##name:        \
    LOOP(expression)
/* Loops for both operands in registers, and for a constant on either side. */
#define BINARY(name, function)                                          \
  case LAVES__OP_##name:                                                \
    if (p->operand[1] == LAVES__OPERAND_CONSTANT) {                     \
      for (size_t i = 0; i < count; i++) out[i] = function(a[i], k);    \
    } else if (p->operand[0] == LAVES__OPERAND_CONSTANT) {              \
      for (size_t i = 0; i < count; i++) out[i] = function(k, b[i]);    \
    } else {                                                            \
      for (size_t i = 0; i < count; i++) out[i] = function(a[i], b[i]); \
    }                                                                   \
    break

static inline double add_of(double a, double b) { return a + b; }
static inline double sub_of(double a, double b) { return a - b; }
static inline double mul_of(double a, double b) { return a * b; }
static inline double div_of(double a, double b) { return a / b; }

/* The block holds register r at block + r * count. */
LAVES__WIDE static void run_batch(const laves__tape *tape, size_t count, double *block) {
  const laves__instruction *end = tape->instructions + tape->count;
  for (const laves__instruction *p = tape->instructions; p < end; p++) {
    const double k = p->constant;
    const double *a = block + (p->operand[0] == LAVES__OPERAND_CONSTANT ? 0 : p->operand[0]) * count;
    const double *b = block + (p->operand[1] == LAVES__OPERAND_CONSTANT ? 0 : p->operand[1]) * count;
    const double *c = block + (p->operand[2] == LAVES__OPERAND_CONSTANT ? 0 : p->operand[2]) * count;
    double *out = block + p->out * count;
    switch ((laves__op)p->op) {
      UNARY(NEGATE, -a[i]);
      UNARY(ABS, fabs(a[i]));
      UNARY(SQUARE, a[i] * a[i]);
      UNARY(SQRT, sqrt_of(a[i]));
      UNARY(SIN, sin_of(a[i]));
      UNARY(COS, cos_of(a[i]));
      UNARY(TAN, tan_of(a[i]));
      UNARY(ASIN, asin_of(a[i]));
      UNARY(ACOS, acos_of(a[i]));
      UNARY(EXP, exp_of(a[i]));
      UNARY(LOG, log_of(a[i]));
      UNARY(FLOOR, floor_of(a[i]));
      BINARY(ADD, add_of);
      BINARY(SUB, sub_of);
      BINARY(MUL, mul_of);
      BINARY(DIV, div_of);
      BINARY(MIN, min_of);
      BINARY(MAX, max_of);
      BINARY(POW, pow_of);
      BINARY(ATAN2, atan2);
      BINARY(MOD, mod_of);
      BINARY(NORM2, norm2_of);
      UNARY(NORM3, norm3_of(a[i], b[i], c[i]));
      case LAVES__OP_LEAF:
        run_leaf(&tape->leaves[p->leaf], count, a, b, c, out);
        break;
      default:
        break;
    }
  }
}

static double tamed(double value) {
  if (!(value <= LAVES__TAPE_NOWHERE)) return LAVES__TAPE_NOWHERE; /* NaN as well */
  return value >= -LAVES__TAPE_NOWHERE ? value : -LAVES__TAPE_NOWHERE;
}

/* `block` has room for `batch` points at a time. */
static void run_batches(const laves__tape *tape, size_t count, const laves__vec3 *points, double *values, double *block,
                        size_t batch) {
  const size_t last = tape->instructions[tape->count - 1].out;
  for (size_t begin = 0; begin < count; begin += batch) {
    const size_t n = count - begin < batch ? count - begin : batch;
    for (size_t i = 0; i < n; i++) {
      block[i] = points[begin + i].x;
      block[n + i] = points[begin + i].y;
      block[2 * n + i] = points[begin + i].z;
    }
    run_batch(tape, n, block);
    for (size_t i = 0; i < n; i++) values[begin + i] = tamed(block[last * n + i]);
  }
}

static void run_many(const laves__tape *tape, size_t count, const laves__vec3 *points, double *values) {
  _Alignas(64) double block[SCRATCH];
  const size_t fits = SCRATCH / tape->register_count;
  run_batches(tape, count, points, values, block, fits < BATCH ? fits : BATCH);
}

static void run_few(const laves__tape *tape, size_t count, const laves__vec3 *points, double *values) {
  double block[FEW];
  run_batches(tape, count, points, values, block, count);
}

void laves__tape_evaluate(const laves__tape *tape, size_t count, const laves__vec3 *points, double *values) {
  if (count <= BATCH && count * tape->register_count <= FEW)
    run_few(tape, count, points, values);
  else
    run_many(tape, count, points, values);
}
