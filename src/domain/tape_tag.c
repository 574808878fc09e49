/* Which named part of an expression made the surface at a point.
 *
 * The tape is run once more at the point, and with each value goes the name of what decided it: of a minimum or maximum the
 * operand that was taken, of other operations the first operand that has a name. A name given to an operand counts where
 * nothing further in has one, so that the innermost name wins. Surface files with named parts are such names, too; which of their
 * parts it is is asked only where one of them has decided.
 *
 * Where two operands are equal, as where two parts share a face, what has a name goes before what has none, and what was named
 * first before what was named later: rounding must not decide. */
#include "domain/tape.h"

/* The values and names so far. A name below LAVES__NO_TAG stands for a part of the leaf that instruction number
 * from_leaf - name reads. */
typedef struct run {
  double value[LAVES__REGISTER_LIMIT];
  int32_t tag[LAVES__REGISTER_LIMIT];
} run;

static const int32_t from_leaf = LAVES__NO_TAG - 1;

typedef struct operand {
  double value;
  int32_t tag;
} operand;

static operand read_operand(const laves__tape *tape, const run *r, size_t i, int k) {
  const laves__instruction *p = &tape->instructions[i];
  if (p->operand[k] == LAVES__OPERAND_CONSTANT) return (operand){p->constant, LAVES__NO_TAG};
  const operand o = {r->value[p->operand[k]], r->tag[p->operand[k]]};
  return o.tag == LAVES__NO_TAG && tape->tags ? (operand){o.value, tape->tags[3 * i + (size_t)k]} : o;
}

/* Lower goes first where values are equal. */
static uint32_t rank(int32_t tag) {
  if (tag >= 0) return (uint32_t)tag;
  return tag == LAVES__NO_TAG ? UINT32_MAX : UINT32_MAX / 2 + (uint32_t)(from_leaf - tag);
}

static int32_t deciding_tag(laves__op op, const operand o[3], double tolerance) {
  if (op == LAVES__OP_MIN || op == LAVES__OP_MAX) {
    const double ahead = op == LAVES__OP_MIN ? o[1].value - o[0].value : o[0].value - o[1].value;
    if (fabs(ahead) <= tolerance) return rank(o[0].tag) <= rank(o[1].tag) ? o[0].tag : o[1].tag;
    return ahead > 0 ? o[0].tag : o[1].tag;
  }
  for (int k = 0; k < 3; k++) /* operands that the operation lacks have no tag */
    if (o[k].tag != LAVES__NO_TAG) return o[k].tag;
  return LAVES__NO_TAG;
}

static bool has_parts(const laves__leaf_tags *tags, uint32_t leaf) {
  return tags->first && tags->first[leaf + 1] > tags->first[leaf];
}

static laves__vec3 leaf_point(const laves__oracle *leaf, const operand o[3]) {
  return v3_sub(v3(o[0].value, o[1].value, o[2].value), leaf->origin);
}

/* Runs the first `count` instructions. */
static void run_to(const laves__tape *tape, const laves__leaf_tags *leaf_tags, laves__vec3 point, double tolerance, size_t count,
                   run *r) {
  const double xyz[3] = {point.x, point.y, point.z};
  for (int i = 0; i < 3; i++) {
    r->value[i] = xyz[i];
    r->tag[i] = LAVES__NO_TAG;
  }
  for (size_t i = 0; i < count; i++) {
    const laves__instruction *p = &tape->instructions[i];
    const laves__op op = (laves__op)p->op;
    operand o[3] = {{0, LAVES__NO_TAG}, {0, LAVES__NO_TAG}, {0, LAVES__NO_TAG}};
    for (int k = 0; k < laves__op_operands[op]; k++) o[k] = read_operand(tape, r, i, k);
    r->tag[p->out] = deciding_tag(op, o, tolerance);
    if (op != LAVES__OP_LEAF) {
      r->value[p->out] = laves__op_value(op, o[0].value, o[1].value, o[2].value);
      continue;
    }
    const laves__oracle *leaf = &tape->leaves[p->leaf];
    const laves__vec3 at = leaf_point(leaf, o);
    leaf->evaluate(leaf->self, 1, &at, &r->value[p->out], NULL);
    if (has_parts(leaf_tags, p->leaf)) r->tag[p->out] = from_leaf - (int32_t)i;
  }
}

/* The part of the leaf that instruction i reads. */
static int32_t part_of_leaf(const laves__tape *tape, const laves__leaf_tags *leaf_tags, const run *r, size_t i) {
  const laves__instruction *p = &tape->instructions[i];
  const laves__oracle *leaf = &tape->leaves[p->leaf];
  operand o[3];
  for (int k = 0; k < 3; k++) o[k] = read_operand(tape, r, i, k);
  uint32_t hint = LAVES__NO_HINT;
  laves__vec3 foot, normal;
  if (!leaf->tag || !leaf->project(leaf->self, leaf_point(leaf, o), INFINITY, &hint, &foot, &normal)) return LAVES__NO_TAG;
  const int32_t tag = leaf->tag(leaf->self, foot, hint);
  const uint32_t first = leaf_tags->first[p->leaf], count = leaf_tags->first[p->leaf + 1] - first;
  return tag >= 0 && (uint32_t)tag < count ? leaf_tags->number[first + (uint32_t)tag] : LAVES__NO_TAG;
}

int32_t laves__tape_tag(const laves__tape *tape, const laves__leaf_tags *leaf_tags, laves__vec3 point, double tolerance) {
  run r;
  run_to(tape, leaf_tags, point, tolerance, tape->count, &r);
  const int32_t tag = r.tag[tape->instructions[tape->count - 1].out];
  if (tag == LAVES__NO_TAG) return tape->root_tag;
  if (tag >= 0) return tag;
  const size_t reader = (size_t)(from_leaf - tag);
  run_to(tape, leaf_tags, point, tolerance, reader, &r);
  return part_of_leaf(tape, leaf_tags, &r, reader);
}
