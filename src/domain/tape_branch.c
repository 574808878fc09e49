/* Signatures, codes and the store of branches. */
#include "domain/tape_branch.h"

#include <string.h>

#include "domain/elementary.h"

/* ---- codes ---- */

static bool reserve(laves_context *context, laves__code *code, size_t count) {
  if (count <= code->capacity) return true;
  laves__code_free(context, code);
  code->tape.instructions = laves__alloc(context, count, sizeof *code->tape.instructions);
  code->origin = laves__alloc(context, count, sizeof *code->origin);
  code->made = laves__alloc(context, count, sizeof *code->made);
  code->capacity = count;
  if (code->tape.instructions && code->origin && code->made) return true;
  laves__code_free(context, code);
  return false;
}

void laves__code_free(laves_context *context, laves__code *code) {
  laves__free(context, code->tape.instructions, code->capacity, sizeof *code->tape.instructions);
  laves__free(context, code->origin, code->capacity, sizeof *code->origin);
  laves__free(context, code->made, code->capacity, sizeof *code->made);
  *code = (laves__code){0};
}

static bool is_choice(uint16_t op) {
  return op == LAVES__OP_MIN || op == LAVES__OP_MAX || op == LAVES__OP_ABS || op == LAVES__OP_FLOOR || op == LAVES__OP_MOD;
}

static bool is_norm(uint16_t op) { return op == LAVES__OP_NORM2 || op == LAVES__OP_NORM3 || op == LAVES__OP_SQRT; }

bool laves__code_whole(laves_context *context, const laves__tape *tape, laves__code *code) {
  *code = (laves__code){0};
  if (!reserve(context, code, tape->count)) return false;
  code->tape.count = tape->count;
  code->tape.register_count = tape->register_count;
  code->tape.leaves = tape->leaves;
  memcpy(code->tape.instructions, tape->instructions, tape->count * sizeof *tape->instructions);
  for (size_t i = 0; i < tape->count; i++) {
    code->origin[i] = (uint32_t)i;
    code->made[i] = 0;
    code->norm_count += is_norm(tape->instructions[i].op);
    code->open_count += is_choice(tape->instructions[i].op);
  }
  code->open_count += code->norm_count;
  return true;
}

/* Integers as sides of a choice, which is never 0. */
static int32_t side_of_integer(double n) {
  n = min_of(max_of(n, -1e9), 1e9);
  return (int32_t)(n >= 0 ? n + 1 : n);
}
static double integer_of_side(int32_t side) { return side > 0 ? side - 1 : side; }

static int32_t decided_integer(double lower, double upper) {
  return floor_of(lower) == floor_of(upper) ? side_of_integer(floor_of(lower)) : 0;
}

/* The choice that holds for all operands in the intervals, or 0. */
static int32_t decided(uint16_t op, laves__interval a, laves__interval b) {
  switch (op) {
    case LAVES__OP_MIN:
      return a.upper < b.lower ? 1 : b.upper < a.lower ? 2 : 0;
    case LAVES__OP_MAX:
      return a.lower > b.upper ? 1 : b.lower > a.upper ? 2 : 0;
    case LAVES__OP_ABS:
      return a.lower > 0 ? 1 : a.upper < 0 ? 2 : 0;
    case LAVES__OP_FLOOR:
      return decided_integer(a.lower, a.upper);
    case LAVES__OP_MOD:
      return b.lower == b.upper && b.lower > 0 ? decided_integer(a.lower / b.lower, a.upper / b.lower) : 0;
    default:
      return 0;
  }
}

/* Fills made[] of the code's instructions from the intervals; what was made before stays. */
static void decide(const laves__code *code, laves__box3 box, const laves__interval *results, laves__interval *registers,
                   int32_t *made) {
  registers[0] = (laves__interval){box.lower.x, box.upper.x};
  registers[1] = (laves__interval){box.lower.y, box.upper.y};
  registers[2] = (laves__interval){box.lower.z, box.upper.z};
  for (size_t i = 0; i < code->tape.count; i++) {
    const laves__instruction *p = &code->tape.instructions[i];
    made[i] = code->made[i];
    if (!made[i] && is_choice(p->op)) {
      laves__interval operand[2];
      for (int k = 0; k < 2; k++)
        operand[k] =
            p->operand[k] == LAVES__OPERAND_CONSTANT ? (laves__interval){p->constant, p->constant} : registers[p->operand[k]];
      made[i] = decided(p->op, operand[0], operand[1]);
    }
    registers[p->out] = results[i];
  }
}

/* The instruction with its choice made, where one instruction can say so: min(a, a) is a, and 0 x is zero. */
static laves__instruction simplified(laves__instruction p, int32_t made) {
  if (p.op == LAVES__OP_ABS) {
    p.op = made == 2 ? LAVES__OP_NEGATE : LAVES__OP_MIN;
    p.operand[1] = p.operand[0];
  } else if (p.op == LAVES__OP_MIN || p.op == LAVES__OP_MAX) {
    const uint16_t chosen = p.operand[made - 1];
    if (chosen != LAVES__OPERAND_CONSTANT) {
      p.operand[0] = p.operand[1] = chosen;
    } else if (p.constant == 0) {
      p.op = LAVES__OP_MUL;
      p.operand[0] = 0;
      p.operand[1] = LAVES__OPERAND_CONSTANT;
    }
  }
  return p;
}

static void mark_operands(const laves__instruction *p, bool *live) {
  for (int k = 0; k < laves__op_operands[p->op]; k++)
    if (p->operand[k] != LAVES__OPERAND_CONSTANT) live[p->operand[k]] = true;
}

bool laves__code_cut(laves_context *context, const laves__code *code, laves__box3 box, laves__interval *results,
                     laves__code *cut) {
  bool may_be_nan;
  laves__interval registers[LAVES__REGISTER_LIMIT];
  bool live[LAVES__REGISTER_LIMIT];
  const size_t count = code->tape.count;
  if (!reserve(context, cut, count)) return false;
  laves__tape_intervals(&code->tape, box, &may_be_nan, results);
  decide(code, box, results, registers, cut->made);
  if (may_be_nan) memcpy(cut->made, code->made, count * sizeof *cut->made); /* comparisons with NaN follow no interval */
  memset(live, 0, code->tape.register_count * sizeof *live);
  live[code->tape.instructions[count - 1].out] = true;
  cut->open_count = cut->norm_count = 0;
  size_t first = count; /* filled from the end, then moved to the front */
  for (size_t i = count; i-- > 0;) {
    const laves__instruction *p = &code->tape.instructions[i];
    if (!live[p->out]) continue;
    live[p->out] = false;
    const int32_t made = cut->made[i];
    const bool newly = made && !code->made[i];
    first--;
    cut->tape.instructions[first] = newly ? simplified(*p, made) : *p;
    cut->origin[first] = code->origin[i];
    cut->made[first] = made;
    const bool vanishes = is_norm(p->op) && !(results[i].lower > 0);
    cut->open_count += (!made && is_choice(p->op)) || vanishes;
    cut->norm_count += vanishes;
    mark_operands(&cut->tape.instructions[first], live);
  }
  const size_t left = count - first;
  memmove(cut->tape.instructions, cut->tape.instructions + first, left * sizeof *cut->tape.instructions);
  memmove(cut->origin, cut->origin + first, left * sizeof *cut->origin);
  memmove(cut->made, cut->made + first, left * sizeof *cut->made);
  cut->tape.count = left;
  cut->tape.register_count = code->tape.register_count;
  cut->tape.leaves = code->tape.leaves;
  return true;
}

/* ---- signatures ---- */

static double leaf_value(const laves__oracle *leaf, double x, double y, double z) {
  const laves__vec3 p = v3_sub(v3(x, y, z), leaf->origin);
  double phi;
  leaf->evaluate(leaf->self, 1, &p, &phi, NULL);
  return phi;
}

/* Side of the norm of a vector with one component other than zero: 1 + 2 component, and 1 more if negative; else 0. */
static int32_t lone_component(const double *v, int count) {
  int found = -1;
  for (int k = 0; k < count; k++) {
    if (v[k] == 0) continue;
    if (found >= 0) return 0;
    found = k;
  }
  return found < 0 ? 0 : 1 + 2 * found + (v[found] < 0);
}

static int32_t choose(uint16_t op, const double *v) {
  switch (op) {
    case LAVES__OP_MIN:
      return v[0] <= v[1] ? 1 : 2;
    case LAVES__OP_MAX:
      return v[0] >= v[1] ? 1 : 2;
    case LAVES__OP_ABS:
      return v[0] >= 0 ? 1 : 2;
    case LAVES__OP_FLOOR:
      return side_of_integer(floor_of(v[0]));
    case LAVES__OP_MOD:
      return side_of_integer(v[1] != 0 ? floor_of(v[0] / v[1]) : 0);
    case LAVES__OP_NORM2:
      return lone_component(v, 2);
    case LAVES__OP_NORM3:
      return lone_component(v, 3);
    default:
      return 0;
  }
}

/* The operand that a choice leaves out, or -1. */
static int left_out(uint16_t op, int32_t side) {
  if (side == 0) return -1;
  return op == LAVES__OP_MIN || op == LAVES__OP_MAX ? 2 - side : op == LAVES__OP_FLOOR ? 0 : -1;
}

/* Marks what an instruction of the whole tape depends on, given its choice. */
static void mark_chosen(const laves__instruction *p, int32_t side, bool *live) {
  const int out = left_out(p->op, side);
  for (int k = 0; k < laves__op_operands[p->op]; k++)
    if (k != out && p->operand[k] != LAVES__OPERAND_CONSTANT) live[p->operand[k]] = true;
}

void laves__signature_at(const laves__tape *whole, const laves__code *code, laves__vec3 point, laves__choice *room,
                         laves__signature *signature) {
  double registers[LAVES__REGISTER_LIMIT];
  bool live[LAVES__REGISTER_LIMIT];
  const size_t count = code->tape.count;
  registers[0] = point.x;
  registers[1] = point.y;
  registers[2] = point.z;
  for (size_t i = 0; i < count; i++) {
    const laves__instruction *p = &code->tape.instructions[i];
    double v[3] = {0, 0, 0};
    for (int k = 0; k < laves__op_operands[p->op]; k++)
      v[k] = p->operand[k] == LAVES__OPERAND_CONSTANT ? p->constant : registers[p->operand[k]];
    room[i].side = code->made[i] ? code->made[i] : choose(p->op, v);
    registers[p->out] = p->op == LAVES__OP_LEAF ? leaf_value(&whole->leaves[p->leaf], v[0], v[1], v[2])
                                                : laves__op_value((laves__op)p->op, v[0], v[1], v[2]);
  }
  /* From the end; the choices found are gathered at the end of `room`, never before those still to be read. */
  memset(live, 0, code->tape.register_count * sizeof *live);
  live[code->tape.instructions[count - 1].out] = true;
  size_t found = count;
  for (size_t i = count; i-- > 0;) {
    const laves__instruction *p = &code->tape.instructions[i];
    const int32_t side = room[i].side;
    if (!live[p->out]) continue;
    live[p->out] = false;
    mark_chosen(p, side, live);
    if (side) room[--found] = (laves__choice){code->origin[i], side};
  }
  *signature = (laves__signature){room + found, count - found};
}

/* ---- from a signature to an expression ---- */

typedef struct resolver {
  laves__expression *e;
  const laves__tape *whole;
  int32_t *side; /* [whole->count] 0: no choice, or not reached */
  bool *reached; /* [whole->count] */
} resolver;

static void mark_reached(const resolver *r) {
  bool live[LAVES__REGISTER_LIMIT] = {false};
  live[r->whole->instructions[r->whole->count - 1].out] = true;
  for (size_t i = r->whole->count; i-- > 0;) {
    const laves__instruction *p = &r->whole->instructions[i];
    r->reached[i] = live[p->out];
    if (!live[p->out]) continue;
    live[p->out] = false;
    mark_chosen(p, r->side[i], live);
  }
}

/* A norm whose other components are zero for good is its lone one, with the sign that it had. */
static laves__node resolved_norm(laves__expression *e, laves__op op, const laves__node *n, int32_t side) {
  const int lone = side ? (side - 1) / 2 : -1;
  bool others_vanish = lone >= 0;
  double value;
  for (int k = 0; k < laves__op_operands[op] && others_vanish; k++)
    others_vanish = k == lone || (laves__node_is_constant(e, n[k], &value) && value == 0);
  if (!others_vanish) return laves__node_make(e, op, n[0], n[1], n[2]);
  return (side - 1) % 2 ? laves__node_make(e, LAVES__OP_NEGATE, n[lone], 0, 0) : n[lone];
}

static laves__node resolved(laves__expression *e, const laves__instruction *p, int32_t side, const laves__node *n) {
  const laves__op op = (laves__op)p->op;
  switch (op) {
    case LAVES__OP_MIN:
    case LAVES__OP_MAX:
      return n[side == 2];
    case LAVES__OP_ABS:
      return side == 2 ? laves__node_make(e, LAVES__OP_NEGATE, n[0], 0, 0) : n[0];
    case LAVES__OP_FLOOR:
      return laves__node_constant(e, integer_of_side(side));
    case LAVES__OP_MOD: {
      const laves__node whole = laves__node_make(e, LAVES__OP_MUL, n[1], laves__node_constant(e, integer_of_side(side)), 0);
      return laves__node_make(e, LAVES__OP_SUB, n[0], whole, 0);
    }
    case LAVES__OP_NORM2:
    case LAVES__OP_NORM3:
      return resolved_norm(e, op, n, side);
    case LAVES__OP_LEAF:
      return laves__node_leaf_at(e, p->leaf, n);
    default:
      return laves__node_make(e, op, n[0], n[1], n[2]);
  }
}

static laves__node resolve(const resolver *r) {
  laves__expression *e = r->e;
  laves__node registers[LAVES__REGISTER_LIMIT];
  for (size_t k = 0; k < 3; k++) registers[k] = laves__node_make(e, (laves__op)(LAVES__OP_X + k), 0, 0, 0);
  laves__node result = LAVES__NO_NODE;
  for (size_t i = 0; i < r->whole->count; i++) {
    const laves__instruction *p = &r->whole->instructions[i];
    if (!r->reached[i]) continue;
    laves__node n[3] = {0, 0, 0};
    for (int k = 0; k < laves__op_operands[p->op]; k++) {
      if (k == left_out(p->op, r->side[i])) continue; /* its register may hold anything */
      n[k] = p->operand[k] == LAVES__OPERAND_CONSTANT ? laves__node_constant(e, p->constant) : registers[p->operand[k]];
      if (n[k] == LAVES__NO_NODE) return LAVES__NO_NODE;
    }
    result = registers[p->out] = resolved(e, p, r->side[i], n);
  }
  return result;
}

/* ---- the store ---- */

typedef struct laves__known_signature {
  size_t first;
  uint32_t count;
  int32_t branch;
  uint64_t hash;
} known_signature;

void laves__branches_init(laves__branches *b, laves_context *context, const laves__tape *whole) {
  *b = (laves__branches){.context = context, .whole = whole};
  laves__expression_init(&b->expression, context);
}

void laves__branches_free(laves__branches *b) {
  if (!b->context) return;
  for (size_t i = 0; i < b->count; i++) laves__tape_free(b->context, &b->tape[i]);
  laves__free(b->context, b->tape, b->tape_capacity, sizeof *b->tape);
  laves__free(b->context, b->root, b->root_capacity, sizeof *b->root);
  laves__free(b->context, b->known, b->known_capacity, sizeof *b->known);
  laves__free(b->context, b->pool, b->pool_capacity, sizeof *b->pool);
  laves__free(b->context, b->table, b->table_size, sizeof *b->table);
  laves__expression_free(&b->expression);
  *b = (laves__branches){0};
}

static uint64_t signature_hash(const laves__signature *s) {
  uint64_t h = s->count;
  for (size_t i = 0; i < s->count; i++) {
    h = (h ^ ((uint64_t)s->choices[i].instruction << 32 | (uint32_t)s->choices[i].side)) * 0x9e3779b97f4a7c15ULL;
    h ^= h >> 29;
  }
  return h;
}

static bool is_same(const laves__branches *b, const known_signature *k, const laves__signature *s, uint64_t hash) {
  return k->hash == hash && k->count == s->count &&
         (s->count == 0 || memcmp(b->pool + k->first, s->choices, s->count * sizeof *s->choices) == 0);
}

/* The slot of a signature in the table, or a free one. */
static size_t slot_of(const laves__branches *b, const laves__signature *s, uint64_t hash) {
  size_t slot = hash & (b->table_size - 1);
  while (b->table[slot] && !is_same(b, &b->known[b->table[slot] - 1], s, hash)) slot = (slot + 1) & (b->table_size - 1);
  return slot;
}

int32_t laves__branches_find(const laves__branches *b, const laves__signature *signature) {
  if (!b->table_size) return LAVES__NO_BRANCH;
  const size_t slot = slot_of(b, signature, signature_hash(signature));
  return b->table[slot] ? b->known[b->table[slot] - 1].branch : LAVES__NO_BRANCH;
}

static bool grow_table(laves__branches *b) {
  const size_t size = b->table_size ? 2 * b->table_size : 64;
  uint32_t *table = laves__alloc_zeroed(b->context, size, sizeof *table);
  if (!table) return false;
  for (size_t i = 0; i < b->known_count; i++) {
    size_t slot = b->known[i].hash & (size - 1);
    while (table[slot]) slot = (slot + 1) & (size - 1);
    table[slot] = (uint32_t)i + 1;
  }
  laves__free(b->context, b->table, b->table_size, sizeof *b->table);
  b->table = table;
  b->table_size = size;
  return true;
}

/* Compiles a node that no branch has yet. */
static int32_t add_branch(laves__branches *b, laves__node root) {
  for (size_t i = 0; i < b->count; i++)
    if (b->root[i] == root) return (int32_t)i;
  if (b->count == LAVES__BRANCH_LIMIT || b->code_total > LAVES__BRANCH_CODE_LIMIT) return LAVES__NO_BRANCH;
  laves__tape tape;
  const laves_result result = laves__tape_build(&b->expression, root, b->whole->leaves, &tape, NULL);
  if (result == LAVES_OK && laves__grow(b->context, &b->tape, &b->tape_capacity, b->count + 1, sizeof tape) &&
      laves__grow(b->context, &b->root, &b->root_capacity, b->count + 1, sizeof root)) {
    b->tape[b->count] = tape;
    b->root[b->count] = root;
    b->code_total += tape.count;
    return (int32_t)b->count++;
  }
  if (result == LAVES_OK) laves__tape_free(b->context, &tape);
  b->out_of_memory = b->out_of_memory || result == LAVES_OK || result == LAVES_ERROR_MEMORY;
  return LAVES__NO_BRANCH;
}

static int32_t make_branch(laves__branches *b, const laves__signature *s) {
  const size_t count = b->whole->count;
  resolver r = {.e = &b->expression, .whole = b->whole};
  r.side = laves__alloc_zeroed(b->context, count, sizeof *r.side);
  r.reached = laves__alloc_zeroed(b->context, count, sizeof *r.reached);
  laves__node root = LAVES__NO_NODE;
  if (r.side && r.reached) {
    for (size_t i = 0; i < s->count; i++) r.side[s->choices[i].instruction] = s->choices[i].side;
    mark_reached(&r);
    root = resolve(&r);
  } else {
    b->out_of_memory = true;
  }
  laves__free(b->context, r.side, count, sizeof *r.side);
  laves__free(b->context, r.reached, count, sizeof *r.reached);
  b->out_of_memory = b->out_of_memory || b->expression.out_of_memory;
  return root == LAVES__NO_NODE ? LAVES__NO_BRANCH : add_branch(b, root);
}

int32_t laves__branches_add(laves__branches *b, const laves__signature *signature) {
  const uint64_t hash = signature_hash(signature);
  if (2 * (b->known_count + 1) > b->table_size && !grow_table(b)) {
    b->out_of_memory = true;
    return LAVES__NO_BRANCH;
  }
  const size_t slot = slot_of(b, signature, hash);
  if (b->table[slot]) return b->known[b->table[slot] - 1].branch;
  if (b->known_count == LAVES__SIGNATURE_LIMIT || b->pool_count + signature->count > LAVES__CHOICE_LIMIT)
    return LAVES__NO_BRANCH;
  if (!laves__grow(b->context, &b->pool, &b->pool_capacity, b->pool_count + signature->count + 1, sizeof *b->pool) ||
      !laves__grow(b->context, &b->known, &b->known_capacity, b->known_count + 1, sizeof *b->known)) {
    b->out_of_memory = true;
    return LAVES__NO_BRANCH;
  }
  for (size_t i = 0; i < signature->count; i++) b->pool[b->pool_count + i] = signature->choices[i];
  b->known[b->known_count] =
      (known_signature){b->pool_count, (uint32_t)signature->count, make_branch(b, signature), hash};
  b->pool_count += signature->count;
  b->table[slot] = (uint32_t)++b->known_count;
  return b->known[b->known_count - 1].branch;
}
