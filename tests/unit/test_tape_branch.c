/* Branches of tapes: at every point the branch's function is the solid's, and cut codes tell the same branches. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "domain/tape_branch.h"
#include "fixtures/assert_close.h"
#include "fixtures/random_expression.h"

typedef struct random_tape {
  laves_context *context;
  laves__expression e;
  laves__tape tape;
  laves__code whole;
  laves__branch_room room;
  laves__branches branches;
} random_tape;

static void begin(random_tape *r) {
  *r = (random_tape){.context = laves_context_create(NULL)};
  laves__expression_init(&r->e, r->context);
}

static void build(random_tape *r, laves__node root) {
  laves_error error;
  assert_int_equal(laves__tape_build(&r->e, root, NULL, &r->tape, &error), LAVES_OK);
  assert_true(laves__code_whole(r->context, &r->tape, &r->whole));
  assert_true(laves__branch_room_make(r->context, &r->tape, &r->room));
  laves__branches_init(&r->branches, r->context, &r->tape);
}

static void drop(random_tape *r) {
  laves__branches_free(&r->branches);
  laves__branch_room_free(r->context, &r->room);
  laves__code_free(r->context, &r->whole);
  laves__tape_free(r->context, &r->tape);
  laves__expression_free(&r->e);
  assert_int_equal(laves_context_bytes(r->context), 0);
  laves_context_free(r->context);
}

static int32_t branch_at(random_tape *r, const laves__code *code, laves__vec3 p) {
  laves__signature s;
  assert_true(laves__signature_at(r->context, &r->tape, code, p, &r->room, &s));
  for (size_t i = 1; i < s.count; i++) assert_true(s.choices[i].instruction < s.choices[i - 1].instruction);
  const int32_t known = laves__branches_find(&r->branches, &s), b = laves__branches_add(&r->branches, &s);
  assert_true(known == LAVES__NO_BRANCH || known == b);
  return b;
}

enum { TREES = 300, POINTS = 40, SIZE = 24 };

static void branches_yield_the_value(void **state) {
  (void)state;
  for (uint64_t seed = 1; seed <= TREES; seed++) {
    random_tape r;
    uint64_t tree_seed = seed, point_seed = seed;
    begin(&r);
    build(&r, random_expression(&r.e, &tree_seed, SIZE, false));
    for (int i = 0; i < POINTS; i++) {
      const laves__vec3 p = random_point(&point_seed, 3);
      double wanted, value;
      laves__tape_evaluate(&r.tape, 1, &p, &wanted);
      const int32_t b = branch_at(&r, &r.whole, p);
      assert_true(b != LAVES__NO_BRANCH);
      laves__tape_evaluate(&r.branches.tape[b], 1, &p, &value);
      bool may_be_nan; /* dividing by a constant zero, folding loses its sign */
      laves__tape_interval(&r.tape, (laves__box3){p, p}, &may_be_nan);
      if (!may_be_nan && fabs(value - wanted) > 1e-9 * (1 + fabs(wanted)))
        fail_msg("seed %d: branch %d is %.17g, the solid %.17g", (int)seed, b, value, wanted);
      for (size_t k = 0; k < r.branches.tape[b].count; k++) { /* nothing is left to choose */
        const uint16_t op = r.branches.tape[b].instructions[k].op;
        assert_true(op != LAVES__OP_MIN && op != LAVES__OP_MAX && op != LAVES__OP_ABS && op != LAVES__OP_FLOOR);
      }
    }
    drop(&r);
  }
}

/* Cut twice, as on the way down an octree. */
static void codes_agree_with_the_whole(void **state) {
  (void)state;
  size_t instructions = 0, left = 0;
  for (uint64_t seed = 1; seed <= TREES; seed++) {
    random_tape r;
    uint64_t tree_seed = seed, point_seed = seed;
    laves__code cut[2];
    memset(cut, 0, sizeof cut);
    begin(&r);
    build(&r, random_expression(&r.e, &tree_seed, SIZE, seed % 2 == 0));
    for (int i = 0; i < POINTS; i++) {
      const laves__vec3 c = random_point(&point_seed, 3), p = v3_add(c, random_point(&point_seed, 0.05));
      const laves__vec3 wide = v3(0.5, 0.5, 0.5), narrow = v3(0.05, 0.05, 0.05);
      assert_true(laves__code_cut(r.context, &r.whole, (laves__box3){v3_sub(c, wide), v3_add(c, wide)}, &r.room, &cut[0]));
      assert_true(laves__code_cut(r.context, &cut[0], (laves__box3){v3_sub(c, narrow), v3_add(c, narrow)}, &r.room, &cut[1]));
      const int32_t b = branch_at(&r, &r.whole, p);
      double wanted, value;
      laves__tape_evaluate(&r.tape, 1, &p, &wanted);
      for (int k = 0; k < 2; k++) {
        laves__tape_evaluate(&cut[k].tape, 1, &p, &value);
        if (value != wanted) fail_msg("seed %d: cut %d times: %.17g instead of %.17g", (int)seed, k + 1, value, wanted);
        if (branch_at(&r, &cut[k], p) != b) fail_msg("seed %d: cut %d times: another branch", (int)seed, k + 1);
      }
      instructions += r.whole.tape.count;
      left += cut[1].tape.count;
    }
    laves__code_free(r.context, &cut[0]);
    laves__code_free(r.context, &cut[1]);
    drop(&r);
  }
  assert_true(left < instructions);
}

static laves__node op(random_tape *r, laves__op o, laves__node a, laves__node b, laves__node c) {
  return laves__node_make(&r->e, o, a, b, c);
}

/* max(x, max(y, x)): two ways to x, one branch. */
static void ways_to_one_function_are_one_branch(void **state) {
  (void)state;
  random_tape r;
  begin(&r);
  const laves__node x = op(&r, LAVES__OP_X, 0, 0, 0), y = op(&r, LAVES__OP_Y, 0, 0, 0), z = op(&r, LAVES__OP_Z, 0, 0, 0);
  const laves__node inner = op(&r, LAVES__OP_MAX, y, x, 0);
  build(&r, op(&r, LAVES__OP_MIN, op(&r, LAVES__OP_MAX, inner, z, 0), op(&r, LAVES__OP_MAX, x, z, 0), 0));
  assert_int_equal(branch_at(&r, &r.whole, v3(2, 1, 0)), branch_at(&r, &r.whole, v3(1, 2, 0)));
  assert_int_not_equal(branch_at(&r, &r.whole, v3(2, 1, 0)), branch_at(&r, &r.whole, v3(1, 2, 3)));
  assert_int_equal(r.branches.count, 2);
  drop(&r);
}

/* Outside a box near a face the distance is the norm of (q, 0, 0), whose branch is q, on both sides of q = 0. */
static void lone_components_have_no_kink(void **state) {
  (void)state;
  random_tape r;
  begin(&r);
  const laves__node zero = laves__node_constant(&r.e, 0);
  const laves__node x = op(&r, LAVES__OP_MAX, op(&r, LAVES__OP_X, 0, 0, 0), zero, 0);
  const laves__node y = op(&r, LAVES__OP_MAX, op(&r, LAVES__OP_Y, 0, 0, 0), zero, 0);
  const laves__node z = op(&r, LAVES__OP_MAX, op(&r, LAVES__OP_Z, 0, 0, 0), zero, 0);
  build(&r, op(&r, LAVES__OP_NORM3, x, y, z));
  const int32_t b = branch_at(&r, &r.whole, v3(0.5, -1, -2));
  const laves__vec3 p = v3(-3, 0, 0);
  double value;
  laves__tape_evaluate(&r.branches.tape[b], 1, &p, &value);
  assert_close(value, -3, 0);
  drop(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(branches_yield_the_value),
      cmocka_unit_test(codes_agree_with_the_whole),
      cmocka_unit_test(ways_to_one_function_are_one_branch),
      cmocka_unit_test(lone_components_have_no_kink),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
