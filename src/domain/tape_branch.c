/* Signatures, codes and the store of branches. */
#include "domain/tape_branch.h"

#include <string.h>

#include "domain/elementary.h"

/* ---- room ---- */

/* What a value of the code becomes in the cut one. */
typedef struct laves__cut_value {
  int32_t source; /* as of laves__code_item */
  uint32_t trail;
  double constant;
} cut_value;

/* Cutting may add to an instruction the two that make a constant, for each of three operands. */
static size_t room_count(size_t count) { return 7 * count + 8; }

bool laves__branch_room_make(laves_context *context, const laves__tape *whole, laves__branch_room *room) {
  *room = (laves__branch_room){.count = whole->count};
  const size_t n = room_count(whole->count);
  room->results = laves__alloc(context, n, sizeof *room->results);
  room->value = laves__alloc(context, n, sizeof *room->value);
  room->number = laves__alloc(context, n, sizeof *room->number);
  room->live = laves__alloc(context, n, sizeof *room->live);
  room->side = laves__alloc(context, n, sizeof *room->side);
  room->choices = laves__alloc(context, n, sizeof *room->choices);
  if (room->results && room->value && room->number && room->live && room->side && room->choices) return true;
  laves__branch_room_free(context, room);
  return false;
}

void laves__branch_room_free(laves_context *context, laves__branch_room *room) {
  const size_t n = room_count(room->count);
  laves__free(context, room->results, n, sizeof *room->results);
  laves__free(context, room->value, n, sizeof *room->value);
  laves__free(context, room->number, n, sizeof *room->number);
  laves__free(context, room->live, n, sizeof *room->live);
  laves__free(context, room->side, n, sizeof *room->side);
  laves__free(context, room->choices, n, sizeof *room->choices);
  laves__free(context, room->visited, room->trail_capacity, sizeof *room->visited);
  laves__free(context, room->stack, 2 * room->trail_capacity, sizeof *room->stack);
  *room = (laves__branch_room){0};
}

static bool reserve_trails(laves_context *context, laves__branch_room *room, size_t count) {
  if (count <= room->trail_capacity) return true;
  laves__free(context, room->visited, room->trail_capacity, sizeof *room->visited);
  laves__free(context, room->stack, 2 * room->trail_capacity, sizeof *room->stack);
  room->visited = laves__alloc(context, 2 * count, sizeof *room->visited);
  room->stack = laves__alloc(context, 4 * count, sizeof *room->stack);
  room->trail_capacity = 2 * count;
  if (room->visited && room->stack) return true;
  laves__free(context, room->visited, 2 * count, sizeof *room->visited);
  laves__free(context, room->stack, 4 * count, sizeof *room->stack);
  room->visited = NULL;
  room->stack = NULL;
  room->trail_capacity = 0; /* so that the next call tries again */
  return false;
}

/* ---- choices ---- */

static bool is_choice(uint16_t op) {
  return op == LAVES__OP_MIN || op == LAVES__OP_MAX || op == LAVES__OP_ABS || op == LAVES__OP_FLOOR || op == LAVES__OP_MOD;
}

static bool is_norm(uint16_t op) { return op == LAVES__OP_NORM2 || op == LAVES__OP_NORM3 || op == LAVES__OP_SQRT; }

/* Integers as sides of a choice, which is never 0. */
static const double integer_limit = 1e9;
static int32_t side_of_integer(double n) {
  n = min_of(max_of(n, -integer_limit), integer_limit);
  return (int32_t)(n >= 0 ? n + 1 : n);
}
static double integer_of_side(int32_t side) { return side > 0 ? side - 1 : side; }

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

/* Integers that a side can't hold stay undecided. */
static int32_t decided_integer(double lower, double upper) {
  const double n = floor_of(lower);
  return n == floor_of(upper) && fabs(n) < integer_limit ? side_of_integer(n) : 0;
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

/* ---- codes ---- */

static bool reserve(laves_context *context, laves__code *code, size_t count) {
  if (count <= code->capacity) return true;
  laves__free(context, code->tape.instructions, code->capacity, sizeof *code->tape.instructions);
  laves__free(context, code->item, code->capacity, sizeof *code->item);
  code->tape.instructions = laves__alloc(context, count, sizeof *code->tape.instructions);
  code->item = laves__alloc(context, count, sizeof *code->item);
  code->capacity = count;
  if (code->tape.instructions && code->item) return true;
  laves__free(context, code->tape.instructions, count, sizeof *code->tape.instructions);
  laves__free(context, code->item, count, sizeof *code->item);
  code->tape.instructions = NULL;
  code->item = NULL;
  code->capacity = 0; /* so that the next call tries again */
  return false;
}

void laves__code_free(laves_context *context, laves__code *code) {
  laves__free(context, code->tape.instructions, code->capacity, sizeof *code->tape.instructions);
  laves__free(context, code->item, code->capacity, sizeof *code->item);
  laves__free(context, code->trail, code->trail_capacity, sizeof *code->trail);
  *code = (laves__code){0};
}

bool laves__code_whole(laves_context *context, const laves__tape *tape, laves__code *code) {
  int32_t writer[LAVES__REGISTER_LIMIT] = {LAVES__FROM_X, LAVES__FROM_Y, LAVES__FROM_Z};
  *code = (laves__code){0};
  if (!reserve(context, code, tape->count)) return false;
  code->tape.count = tape->count;
  code->tape.register_count = tape->register_count;
  code->tape.leaves = tape->leaves;
  for (size_t i = 0; i < tape->count; i++) {
    const laves__instruction *p = &tape->instructions[i];
    code->tape.instructions[i] = *p;
    code->item[i] = (laves__code_item){.origin = (uint32_t)i, .may_vanish = is_norm(p->op)};
    for (int k = 0; k < laves__op_operands[p->op]; k++)
      code->item[i].source[k] = p->operand[k] == LAVES__OPERAND_CONSTANT ? LAVES__FROM_CONSTANT : writer[p->operand[k]];
    writer[p->out] = (int32_t)i;
    code->norm_count += is_norm(p->op);
    code->open_count += is_norm(p->op) || is_choice(p->op);
  }
  return true;
}

typedef struct cutter {
  laves_context *context;
  const laves__code *code;
  laves__branch_room *room;
  laves__code *cut;
  size_t count; /* of items in `cut` so far */
  bool failed;
} cutter;

static uint32_t add_trail(cutter *c, uint32_t instruction, int32_t side, uint32_t a, uint32_t b) {
  if (side == 0 && (a == 0 || b == 0 || a == b)) return a ? a : b;
  laves__code *cut = c->cut;
  if (!laves__grow(c->context, &cut->trail, &cut->trail_capacity, cut->trail_count + 1, sizeof *cut->trail)) {
    c->failed = true;
    return 0;
  }
  cut->trail[cut->trail_count++] = (laves__trail){instruction, side, {a, b}};
  return (uint32_t)cut->trail_count;
}

static cut_value constant_value(double constant, uint32_t trail) { return (cut_value){LAVES__FROM_CONSTANT, trail, constant}; }

static cut_value emit(cutter *c, laves__instruction p, uint32_t origin, const cut_value *v);

/* Norms of three and leaves take registers only: a constant is made as 0 x + c. */
static cut_value as_register(cutter *c, uint32_t origin, cut_value v) {
  if (v.source != LAVES__FROM_CONSTANT) return v;
  const cut_value x = {.source = LAVES__FROM_X}, zero = constant_value(0, v.trail);
  cut_value made = emit(c, (laves__instruction){.op = LAVES__OP_MUL}, origin, (cut_value[]){x, zero, x});
  if (v.constant == 0) return made;
  return emit(c, (laves__instruction){.op = LAVES__OP_ADD}, origin, (cut_value[]){made, constant_value(v.constant, 0), x});
}

static cut_value emit(cutter *c, laves__instruction p, uint32_t origin, const cut_value *v) {
  laves__code_item item = {.origin = origin};
  for (int k = 0; k < laves__op_operands[p.op]; k++) {
    const cut_value w = laves__op_operands[p.op] == 3 ? as_register(c, origin, v[k]) : v[k];
    item.source[k] = w.source;
    item.trail[k] = w.trail;
    if (w.source == LAVES__FROM_CONSTANT) p.constant = w.constant;
  }
  c->cut->item[c->count] = item;
  c->cut->tape.instructions[c->count] = p;
  return (cut_value){.source = (int32_t)c->count++};
}

/* An instruction whose choice is made. */
static cut_value made_choice(cutter *c, laves__instruction p, uint32_t origin, const cut_value *v, int32_t side) {
  switch (p.op) {
    case LAVES__OP_MIN:
    case LAVES__OP_MAX: {
      cut_value chosen = v[side - 1];
      chosen.trail = add_trail(c, origin, side, chosen.trail, 0);
      return chosen;
    }
    case LAVES__OP_FLOOR:
      return constant_value(integer_of_side(side), add_trail(c, origin, side, 0, 0));
    case LAVES__OP_MOD: {
      const cut_value a = {v[0].source, add_trail(c, origin, side, v[0].trail, v[1].trail), v[0].constant};
      const cut_value shift = constant_value(-v[1].constant * integer_of_side(side), 0);
      if (a.source == LAVES__FROM_CONSTANT) return constant_value(a.constant + shift.constant, a.trail);
      return emit(c, (laves__instruction){.op = LAVES__OP_ADD}, origin, (cut_value[]){a, shift, a});
    }
    default: { /* ABS */
      cut_value a = v[0];
      a.trail = add_trail(c, origin, side, a.trail, 0);
      if (a.source == LAVES__FROM_CONSTANT) return constant_value(fabs(a.constant), a.trail);
      return side == 1 ? a : emit(c, (laves__instruction){.op = LAVES__OP_NEGATE}, origin, &a);
    }
  }
}

/* All operands are constants. */
static cut_value folded(cutter *c, laves__instruction p, uint32_t origin, const cut_value *v) {
  const double x[3] = {v[0].constant, v[1].constant, v[2].constant};
  const int32_t side = choose(p.op, x);
  const double value = laves__op_value((laves__op)p.op, x[0], x[1], x[2]);
  if (is_choice(p.op)) return constant_value(value, made_choice(c, p, origin, v, side).trail);
  uint32_t trail = v[0].trail;
  for (int k = 1; k < laves__op_operands[p.op]; k++) trail = add_trail(c, origin, 0, trail, v[k].trail);
  if (side) trail = add_trail(c, origin, side, trail, 0);
  return constant_value(value, trail);
}

static cut_value cut_instruction(cutter *c, size_t i, int32_t side) {
  const laves__code_item *item = &c->code->item[i];
  const laves__instruction p = c->code->tape.instructions[i];
  const int operands = laves__op_operands[p.op];
  cut_value v[3] = {{0}};
  bool constant = p.op != LAVES__OP_LEAF;
  for (int k = 0; k < operands; k++) {
    const int32_t source = item->source[k];
    v[k] = source >= 0 ? c->room->value[source] : (cut_value){source, 0, p.constant};
    v[k].trail = add_trail(c, 0, 0, item->trail[k], v[k].trail);
    constant = constant && v[k].source == LAVES__FROM_CONSTANT;
  }
  if (constant) return folded(c, p, item->origin, v);
  if (side && (p.op != LAVES__OP_MOD || v[1].source == LAVES__FROM_CONSTANT)) return made_choice(c, p, item->origin, v, side);
  if ((p.op == LAVES__OP_ADD || p.op == LAVES__OP_SUB) && v[1].source == LAVES__FROM_CONSTANT && v[1].constant == 0) {
    v[0].trail = add_trail(c, 0, 0, v[0].trail, v[1].trail);
    return v[0];
  }
  const cut_value made = emit(c, p, item->origin, v);
  c->cut->item[made.source].may_vanish = is_norm(p.op) && !(c->room->results[i].lower > 0);
  return made;
}

static laves__interval operand_range(const laves__code *code, size_t i, int k, laves__box3 box, const laves__interval *results) {
  const int32_t source = code->item[i].source[k];
  if (source >= 0) return results[source];
  if (source == LAVES__FROM_CONSTANT)
    return (laves__interval){code->tape.instructions[i].constant, code->tape.instructions[i].constant};
  const int axis = source - LAVES__FROM_X;
  return (laves__interval){v3_at(box.lower, axis), v3_at(box.upper, axis)};
}

/* Drops what the root does not depend on, and moves the rest together. */
static void drop_dead(cutter *c) {
  laves__code *cut = c->cut;
  bool *live = c->room->live;
  int32_t *number = c->room->number;
  memset(live, 0, c->count * sizeof *live);
  live[c->count - 1] = true;
  for (size_t i = c->count; i-- > 0;)
    for (int k = 0; live[i] && k < laves__op_operands[cut->tape.instructions[i].op]; k++)
      if (cut->item[i].source[k] >= 0) live[cut->item[i].source[k]] = true;
  size_t left = 0;
  for (size_t i = 0; i < c->count; i++) {
    if (!live[i]) continue;
    laves__code_item item = cut->item[i];
    for (int k = 0; k < laves__op_operands[cut->tape.instructions[i].op]; k++)
      if (item.source[k] >= 0) item.source[k] = number[item.source[k]];
    cut->item[left] = item;
    cut->tape.instructions[left] = cut->tape.instructions[i];
    number[i] = (int32_t)left++;
  }
  cut->tape.count = left;
}

/* A register is free again after its last reader. False when there are too few: constants that leaves read take some. */
static bool give_registers(cutter *c) {
  laves__code *cut = c->cut;
  uint16_t free[LAVES__REGISTER_LIMIT];
  size_t free_count = 0;
  uint32_t used = 3;
  int32_t *last = c->room->number, *reg = c->room->side;
  for (size_t i = 0; i < cut->tape.count; i++) {
    last[i] = -1;
    for (int k = 0; k < laves__op_operands[cut->tape.instructions[i].op]; k++)
      if (cut->item[i].source[k] >= 0) last[cut->item[i].source[k]] = (int32_t)i;
  }
  for (size_t i = 0; i < cut->tape.count; i++) {
    laves__instruction *p = &cut->tape.instructions[i];
    const int operands = laves__op_operands[p->op];
    for (int k = 0; k < 3; k++) {
      const int32_t source = k < operands ? cut->item[i].source[k] : LAVES__FROM_X;
      p->operand[k] = source == LAVES__FROM_CONSTANT ? LAVES__OPERAND_CONSTANT
                      : source < 0                   ? (uint16_t)(source - LAVES__FROM_X)
                                                     : (uint16_t)reg[source];
      if (source >= 0 && last[source] == (int32_t)i) {
        free[free_count++] = (uint16_t)reg[source];
        last[source] = -1;
      }
    }
    if (free_count == 0 && used == LAVES__REGISTER_LIMIT) return false;
    p->out = free_count > 0 ? free[--free_count] : (uint16_t)used++;
    reg[i] = p->out;
  }
  cut->tape.register_count = used > 3 ? used : 4;
  return true;
}

static void copy_uncut(const laves__code *code, laves__code *cut) {
  memcpy(cut->tape.instructions, code->tape.instructions, code->tape.count * sizeof *code->tape.instructions);
  memcpy(cut->item, code->item, code->tape.count * sizeof *code->item);
  cut->tape.count = code->tape.count;
  cut->tape.register_count = code->tape.register_count;
  cut->root_trail = code->root_trail;
}

bool laves__code_cut(laves_context *context, const laves__code *code, laves__box3 box, laves__branch_room *room,
                     laves__code *cut) {
  bool may_be_nan;
  const size_t count = code->tape.count;
  if (!reserve(context, cut, room_count(count))) return false;
  cutter c = {.context = context, .code = code, .room = room, .cut = cut};
  cut->open_count = cut->norm_count = 0;
  cut->trail_count = code->trail_count;
  cut->tape.leaves = code->tape.leaves;
  if (code->trail_count > 0) {
    if (!laves__grow(context, &cut->trail, &cut->trail_capacity, code->trail_count, sizeof *cut->trail)) return false;
    memcpy(cut->trail, code->trail, code->trail_count * sizeof *cut->trail);
  }
  laves__tape_intervals(&code->tape, box, &may_be_nan, room->results);
  for (size_t i = 0; i < count; i++) {
    const uint16_t op = code->tape.instructions[i].op;
    int32_t side = 0; /* comparisons with NaN follow no interval */
    if (!may_be_nan && is_choice(op))
      side = decided(op, operand_range(code, i, 0, box, room->results),
                     laves__op_operands[op] > 1 ? operand_range(code, i, 1, box, room->results) : (laves__interval){0, 0});
    room->value[i] = cut_instruction(&c, i, side);
  }
  cut_value root = room->value[count - 1];
  root.trail = add_trail(&c, 0, 0, root.trail, code->root_trail);
  if (root.source == LAVES__FROM_CONSTANT) {
    root = as_register(&c, code->item[count - 1].origin, root);
  } else if (root.source < 0) { /* a bare coordinate */
    root = emit(&c, (laves__instruction){.op = LAVES__OP_ADD}, code->item[count - 1].origin,
                (cut_value[]){root, constant_value(0, 0), root});
  }
  if (c.failed) return false;
  cut->root_trail = root.trail;
  c.count = (size_t)root.source + 1; /* what comes later nobody needs */
  drop_dead(&c);
  if (!give_registers(&c)) copy_uncut(code, cut);
  for (size_t i = 0; i < cut->tape.count; i++) {
    cut->norm_count += cut->item[i].may_vanish;
    cut->open_count += cut->item[i].may_vanish || is_choice(cut->tape.instructions[i].op);
  }
  return true;
}

/* ---- signatures ---- */

static double leaf_value(const laves__oracle *leaf, double x, double y, double z) {
  const laves__vec3 p = v3_sub(v3(x, y, z), leaf->origin);
  double phi;
  leaf->evaluate(leaf->self, 1, &p, &phi, NULL);
  return phi;
}

/* Notes the choices of a trail and of those before it, each once. */
static void follow_trail(const laves__code *code, uint32_t trail, laves__branch_room *room, bool *visited, uint32_t *stack) {
  size_t depth = 0;
  if (trail) stack[depth++] = trail;
  while (depth > 0) {
    const uint32_t t = stack[--depth];
    if (visited[t - 1]) continue;
    visited[t - 1] = true;
    const laves__trail *at = &code->trail[t - 1];
    if (at->side) room->side[at->instruction] = at->side;
    for (int k = 0; k < 2; k++)
      if (at->before[k] && !visited[at->before[k] - 1]) stack[depth++] = at->before[k];
  }
}

bool laves__signature_at(laves_context *context, const laves__tape *whole, const laves__code *code, laves__vec3 point,
                         laves__branch_room *room, laves__signature *signature) {
  double registers[LAVES__REGISTER_LIMIT];
  const size_t count = code->tape.count;
  if (!reserve_trails(context, room, code->trail_count)) return false;
  int32_t *own = room->number; /* the choice of each item */
  registers[0] = point.x;
  registers[1] = point.y;
  registers[2] = point.z;
  for (size_t i = 0; i < count; i++) {
    const laves__instruction *p = &code->tape.instructions[i];
    double v[3] = {0, 0, 0};
    for (int k = 0; k < laves__op_operands[p->op]; k++)
      v[k] = p->operand[k] == LAVES__OPERAND_CONSTANT ? p->constant : registers[p->operand[k]];
    own[i] = choose(p->op, v);
    registers[p->out] = p->op == LAVES__OP_LEAF ? leaf_value(&whole->leaves[p->leaf], v[0], v[1], v[2])
                                                : laves__op_value((laves__op)p->op, v[0], v[1], v[2]);
  }
  memset(room->live, 0, count * sizeof *room->live);
  memset(room->side, 0, whole->count * sizeof *room->side);
  if (code->trail_count > 0) memset(room->visited, 0, code->trail_count * sizeof *room->visited);
  room->live[count - 1] = true;
  follow_trail(code, code->root_trail, room, room->visited, room->stack);
  for (size_t i = count; i-- > 0;) {
    if (!room->live[i]) continue;
    const laves__instruction *p = &code->tape.instructions[i];
    const laves__code_item *item = &code->item[i];
    if (own[i]) room->side[item->origin] = own[i];
    const int out = left_out(p->op, own[i]);
    for (int k = 0; k < laves__op_operands[p->op]; k++) {
      if (k == out) continue;
      if (item->source[k] >= 0) room->live[item->source[k]] = true;
      follow_trail(code, item->trail[k], room, room->visited, room->stack);
    }
  }
  size_t found = 0;
  for (size_t i = whole->count; i-- > 0;)
    if (room->side[i]) room->choices[found++] = (laves__choice){(uint32_t)i, room->side[i]};
  *signature = (laves__signature){room->choices, found};
  return true;
}

/* Marks what an instruction of the whole tape depends on, given its choice. */
static void mark_chosen(const laves__instruction *p, int32_t side, bool *live) {
  const int out = left_out(p->op, side);
  for (int k = 0; k < laves__op_operands[p->op]; k++)
    if (k != out && p->operand[k] != LAVES__OPERAND_CONSTANT) live[p->operand[k]] = true;
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
      double divisor;
      if (laves__node_is_constant(e, n[1], &divisor) && divisor == 0) return laves__node_constant(e, 0);
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
  if (b->known_count == LAVES__SIGNATURE_LIMIT || b->pool_count + signature->count > LAVES__CHOICE_LIMIT) return LAVES__NO_BRANCH;
  if (!laves__grow(b->context, &b->pool, &b->pool_capacity, b->pool_count + signature->count + 1, sizeof *b->pool) ||
      !laves__grow(b->context, &b->known, &b->known_capacity, b->known_count + 1, sizeof *b->known)) {
    b->out_of_memory = true;
    return LAVES__NO_BRANCH;
  }
  for (size_t i = 0; i < signature->count; i++) b->pool[b->pool_count + i] = signature->choices[i];
  b->known[b->known_count] = (known_signature){b->pool_count, (uint32_t)signature->count, make_branch(b, signature), hash};
  b->pool_count += signature->count;
  b->table[slot] = (uint32_t)++b->known_count;
  return b->known[b->known_count - 1].branch;
}
