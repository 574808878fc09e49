/* Fuzzes tapes: bytes become an expression of extreme numbers and shared parts, boxes and points in them. Whichever way the tape
 * is run, it yields what plain evaluation does; intervals hold every value; codes that were cut for a box are the same there. */
#include <math.h>
#include <string.h>

#include "domain/tape_branch.h"
#include "fuzz/fuzz_target.h"

enum { OPERATIONS = 60, NODES = 1000, BOXES = 4, POINTS = 12 };

typedef struct tried {
  laves_context *context;
  laves__expression e;
  laves__node root;
  laves__tape tape;
  laves__code whole, cut;
  laves__branch_room room;
  laves__branches branches;
} tried;

/* ---- from bytes ---- */

static double take_number(fuzz_bytes *b) {
  static const double special[] = {0,    1,     -1,    0.5,    2,      -0.0,   3.14159265358979323846, 1e-9,  1e16, -1e16,
                                   1e99, 1e154, 1e300, -1e300, 1e-300, 5e-324, 1.5707963267948966,     -0.25, 3,    1e6};
  const int kind = fuzz_byte(b);
  if (kind < 128) return special[kind % (int)LAVES__COUNT_OF(special)];
  return ldexp(fuzz_byte(b) - 127.5, fuzz_below(b, 32) - 16);
}

/* Operands are among the nodes so far, the last ones more often. */
static laves__node take_operand(fuzz_bytes *b, tried *t, const laves__node *made, int count) {
  const int choice = fuzz_byte(b);
  if (choice < 50) return laves__node_constant(&t->e, take_number(b));
  return made[choice < 150 ? count - 1 : choice % count];
}

static laves__node take_expression(fuzz_bytes *b, tried *t) {
  laves__node made[OPERATIONS + 4];
  int count = 0;
  for (int i = 0; i < 3; i++) made[count++] = laves__node_make(&t->e, (laves__op)(LAVES__OP_X + i), 0, 0, 0);
  const int operations = 1 + fuzz_below(b, OPERATIONS);
  for (int i = 0; i < operations && b->at < b->end; i++) {
    const laves__op op = (laves__op)(LAVES__OP_NEGATE + fuzz_below(b, LAVES__OP_LEAF - LAVES__OP_NEGATE));
    laves__node operand[3] = {0};
    for (int k = 0; k < laves__op_operands[op]; k++) operand[k] = take_operand(b, t, made, count);
    made[count++] = laves__node_make(&t->e, op, operand[0], operand[1], operand[2]);
  }
  return made[count - 1];
}

static laves__box3 take_box(fuzz_bytes *b) {
  laves__box3 box;
  for (int k = 0; k < 3; k++) {
    const double a = take_number(b), width = fabs(take_number(b)) * fuzz_share(b);
    *v3_slot(&box.lower, k) = a;
    *v3_slot(&box.upper, k) = fmin(a + width, 1e300);
  }
  return box;
}

/* Corners too, and points that share coordinates with them. */
static laves__vec3 take_point(fuzz_bytes *b, laves__box3 box) {
  laves__vec3 p;
  for (int k = 0; k < 3; k++) {
    const double low = v3_at(box.lower, k), high = v3_at(box.upper, k), share = fuzz_share(b);
    *v3_slot(&p, k) = share == 0 ? low : share == 1 ? high : fmin(high, low + share * (high - low));
  }
  return p;
}

/* ---- what holds ---- */

static double tamed(double v) { return !(v <= LAVES__TAPE_NOWHERE) ? LAVES__TAPE_NOWHERE : fmax(v, -LAVES__TAPE_NOWHERE); }

/* By a loop over the nodes, operands first. */
static double plain_value(const tried *t, laves__vec3 p) {
  double value[NODES];
  for (laves__node i = 0; i <= t->root; i++) {
    const laves__node_data *n = &t->e.nodes[i];
    double v[3] = {0};
    for (int k = 0; k < laves__op_operands[n->op]; k++) v[k] = value[n->operand[k]];
    value[i] = n->op == LAVES__OP_CONSTANT ? n->value
               : n->op <= LAVES__OP_Z      ? v3_at(p, (int)n->op - LAVES__OP_X)
                                           : laves__op_value((laves__op)n->op, v[0], v[1], v[2]);
  }
  return value[t->root];
}

static bool same(double a, double b) { return a == b || (isnan(a) && isnan(b)); }

static void check_point(tried *t, laves__vec3 p, double batch, laves__dual dual, laves__interval range, bool may_be_nan) {
  const double plain = plain_value(t, p);
  double single, cut;
  laves__tape_evaluate(&t->tape, 1, &p, &single);
  laves__tape_evaluate(&t->cut.tape, 1, &p, &cut);
  FUZZ_REQUIRE(batch == tamed(plain) && single == batch);
  /* Zeros may differ in their signs, which shows where they divide. */
  if (!may_be_nan) FUZZ_REQUIRE(tamed(dual.value) == batch);
  if (!may_be_nan) FUZZ_REQUIRE(!isnan(plain) && plain >= range.lower && plain <= range.upper);
  if (!may_be_nan) FUZZ_REQUIRE(cut == batch);
  const laves__dual one = laves__tape_gradient(&t->tape, p);
  FUZZ_REQUIRE(same(one.value, dual.value) && same(one.gradient.x, dual.gradient.x) && same(one.gradient.y, dual.gradient.y) &&
               same(one.gradient.z, dual.gradient.z));
}

static void check_branch(tried *t, laves__vec3 p) {
  laves__signature s;
  FUZZ_REQUIRE(laves__signature_at(t->context, &t->tape, &t->whole, p, &t->room, &s));
  const int32_t known = laves__branches_find(&t->branches, &s), added = laves__branches_add(&t->branches, &s);
  FUZZ_REQUIRE(!t->branches.out_of_memory && (known == LAVES__NO_BRANCH || known == added));
  FUZZ_REQUIRE(added == LAVES__NO_BRANCH || (size_t)added < t->branches.count);
}

static void check_box(tried *t, laves__box3 box, fuzz_bytes *b) {
  laves__vec3 points[POINTS];
  double values[POINTS];
  laves__dual duals[POINTS];
  bool may_be_nan;
  const laves__interval range = laves__tape_interval(&t->tape, box, &may_be_nan);
  FUZZ_REQUIRE(may_be_nan || range.lower <= range.upper);
  FUZZ_REQUIRE(laves__code_cut(t->context, &t->whole, box, &t->room, &t->cut));
  for (int i = 0; i < POINTS; i++) points[i] = take_point(b, box);
  laves__tape_evaluate(&t->tape, POINTS, points, values);
  laves__tape_gradients(&t->tape, POINTS, points, duals);
  for (int i = 0; i < POINTS; i++) {
    check_point(t, points[i], values[i], duals[i], range, may_be_nan);
    check_branch(t, points[i]);
  }
}

static void check_tape(tried *t, fuzz_bytes *b) {
  FUZZ_REQUIRE(laves__code_whole(t->context, &t->tape, &t->whole));
  FUZZ_REQUIRE(laves__branch_room_make(t->context, &t->tape, &t->room));
  laves__branches_init(&t->branches, t->context, &t->tape);
  for (int i = 0; i < BOXES; i++) check_box(t, take_box(b), b);
  laves__branches_free(&t->branches);
  laves__branch_room_free(t->context, &t->room);
  laves__code_free(t->context, &t->cut);
  laves__code_free(t->context, &t->whole);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
  fuzz_bytes b = {bytes, bytes + length};
  laves_context_options options = laves_context_options_default();
  options.thread_count = 1;
  tried t = {.context = laves_context_create(&options)};
  laves_error error = {0};
  FUZZ_REQUIRE(t.context != NULL);
  laves__expression_init(&t.e, t.context);
  t.root = take_expression(&b, &t);
  FUZZ_REQUIRE(t.root != LAVES__NO_NODE && t.e.node_count < NODES);
  FUZZ_REQUIRE(laves__tape_build(&t.e, t.root, NULL, &t.tape, &error) == LAVES_OK);
  check_tape(&t, &b);
  laves__tape_free(t.context, &t.tape);
  laves__expression_free(&t.e);
  FUZZ_REQUIRE(laves_context_bytes(t.context) == 0);
  laves_context_free(t.context);
  return 0;
}
