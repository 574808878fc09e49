/* The store of expressions: sharing, folding, lowering. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

#include "domain/elementary.h"
#include "domain/expression_short.h"
#include "fixtures/assert_close.h"
#include "fixtures/random_expression.h"

typedef struct fixture {
  laves_context *context;
  laves__expression e;
} fixture;

static int set_up(void **state) {
  fixture *f = calloc(1, sizeof *f);
  f->context = laves_context_create(NULL);
  laves__expression_init(&f->e, f->context);
  *state = f;
  return 0;
}

static int tear_down(void **state) {
  fixture *f = *state;
  laves__expression_free(&f->e);
  assert_int_equal(laves_context_bytes(f->context), 0);
  laves_context_free(f->context);
  free(f);
  return 0;
}

static void equal_nodes_are_one(void **state) {
  E *e = &((fixture *)*state)->e;
  const N a = add_(e, mul_(e, x_(e), y_(e)), sin_(e, z_(e)));
  const N b = add_(e, sin_(e, z_(e)), mul_(e, y_(e), x_(e)));
  assert_int_equal(a, b);
  assert_int_not_equal(sub_(e, x_(e), y_(e)), sub_(e, y_(e), x_(e)));
}

static void constants_fold(void **state) {
  E *e = &((fixture *)*state)->e;
  double value;
  assert_true(laves__node_is_constant(e, add_(e, k_(e, 2), mul_(e, k_(e, 3), k_(e, 4))), &value));
  assert_true(value == 14);
  assert_int_equal(plus_(e, x_(e), 0), x_(e));
  assert_int_equal(times_(e, x_(e), 1), x_(e));
  assert_int_equal(times_(e, x_(e), 0), k_(e, 0));
  assert_int_equal(neg_(e, neg_(e, x_(e))), x_(e));
  assert_int_equal(mul_(e, x_(e), x_(e)), square_(e, x_(e)));
  assert_int_equal(plus_(e, plus_(e, x_(e), 1), 2), plus_(e, x_(e), 3));
  assert_int_equal(abs_(e, neg_(e, x_(e))), abs_(e, x_(e)));
  assert_int_equal(sub_(e, x_(e), k_(e, 2)), plus_(e, x_(e), -2));
  assert_int_equal(k_(e, -0.0), k_(e, 0.0));
}

static void whole_powers_are_products(void **state) {
  E *e = &((fixture *)*state)->e;
  for (int n = -7; n <= 9; n++) {
    const N power = laves__node_make(e, LAVES__OP_POW, x_(e), k_(e, n), 0);
    for (double x = -1.5; x < 2; x += 0.7)
      assert_close(reference_value(e, power, v3(x, 0, 0)), pow(x, n), 1e-12 * fabs(pow(x, n)));
  }
}

static void failures_pass_through(void **state) {
  E *e = &((fixture *)*state)->e;
  assert_int_equal(add_(e, x_(e), LAVES__NO_NODE), LAVES__NO_NODE);
  assert_int_equal(laves__node_affine(e, LAVES__NO_NODE, &(laves__affine){0}), LAVES__NO_NODE);
  assert_int_equal(laves__expression_lower(e, LAVES__NO_NODE, &(laves__affine){0}), LAVES__NO_NODE);
}

/* A moved, turned and scaled body, each by a node of its own, against the mapping worked out by hand. */
static void lowering_composes_maps(void **state) {
  E *e = &((fixture *)*state)->e;
  laves__affine move = laves__affine_identity(), turn = move, outer = move;
  move.t = v3(1, 2, 3);
  turn.m = (laves__mat3){{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}}; /* (x, y, z) -> (-y, x, z) */
  outer.t = v3(10, 0, 0);
  const N body = add_(e, add_(e, x_(e), times_(e, y_(e), 10)), times_(e, z_(e), 100));
  const N moved = laves__node_affine(e, body, &move), turned = laves__node_affine(e, moved, &turn);
  const N lowered = laves__expression_lower(e, turned, &outer);
  /* p -> turn(p + outer) -> + move -> body */
  const laves__vec3 p = v3(0.25, 0.5, -1), q = v3(-p.y + 1, p.x + 10 + 2, p.z + 3);
  assert_close(reference_value(e, lowered, p), q.x + 10 * q.y + 100 * q.z, 1e-10);
}

static void warps_substitute_coordinates(void **state) {
  E *e = &((fixture *)*state)->e;
  const N to[3] = {mul_(e, y_(e), z_(e)), k_(e, 7), sin_(e, x_(e))};
  const N body = sub_(e, add_(e, x_(e), y_(e)), z_(e));
  const laves__affine identity = laves__affine_identity();
  const N lowered = laves__expression_lower(e, laves__node_warp(e, body, to), &identity);
  assert_close(reference_value(e, lowered, v3(0.3, 2, 5)), 10 + 7 - sin(0.3), 1e-12);
}

/* A hundred thousand nested moves must neither overflow a stack nor leave more than one shift. */
static void deep_chains_collapse(void **state) {
  E *e = &((fixture *)*state)->e;
  laves__affine step = laves__affine_identity();
  step.t = v3(1, 0, 0);
  N node = square_(e, x_(e));
  for (int i = 0; i < 100000; i++) node = laves__node_affine(e, node, &step);
  const laves__affine identity = laves__affine_identity();
  assert_int_equal(laves__expression_lower(e, node, &identity), square_(e, plus_(e, x_(e), 100000)));
}

/* Doubling thirty times would make 2^30 copies: refused, not tried. */
static void explosions_are_refused(void **state) {
  E *e = &((fixture *)*state)->e;
  laves__affine step = laves__affine_identity();
  N node = laves__node_make(e, LAVES__OP_SIN, x_(e), 0, 0);
  for (int i = 0; i < 30; i++) {
    step.t = v3(ldexp(1, i), 0, 0);
    node = min_(e, node, laves__node_affine(e, node, &step));
  }
  const laves__affine identity = laves__affine_identity();
  assert_int_equal(laves__expression_lower(e, node, &identity), LAVES__NO_NODE);
  assert_true(e->too_large);
  assert_false(e->out_of_memory);
}

static void memory_limits_are_told(void **state) {
  (void)state;
  laves_context_options options = laves_context_options_default();
  options.memory_limit = 20000;
  laves_context *context = laves_context_create(&options);
  laves__expression e;
  laves__expression_init(&e, context);
  N node = x_(&e);
  for (int i = 0; i < 10000; i++) node = sin_(&e, plus_(&e, node, i + 0.5));
  assert_int_equal(node, LAVES__NO_NODE);
  assert_true(e.out_of_memory);
  laves__expression_free(&e);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

/* Against the C library, over ranges and at odd places. */
static void elementary_functions_are_accurate(void **state) {
  (void)state;
  uint64_t seed = 5;
  for (int i = 0; i < 100000; i++) {
    const double scale = exp2(random_unit(&seed) * 40 - 25), x = (2 * random_unit(&seed) - 1) * scale;
    assert_close(sin_of(x), sin(x), 3e-16);
    assert_close(cos_of(x), cos(x), 3e-16);
    if (fabs(x) < 700) assert_close(exp_of(x) / exp(x), 1, 1e-15);
    assert_close(log_of(fabs(x)), log(fabs(x)), 5e-16 * (1 + fabs(log(fabs(x)))));
    assert_close(floor_of(x), floor(x), 0);
    assert_true(mod_of(x, 0.75) >= -1e-12 && mod_of(x, 0.75) <= 0.75 + 1e-9);
  }
  for (int k = -8; k <= 8; k++) { /* quarter turns */
    assert_close(sin_of(k * 1.5707963267948966), sin(k * 1.5707963267948966), 2e-16);
    assert_close(cos_of(k * 1.5707963267948966), cos(k * 1.5707963267948966), 2e-16);
  }
  assert_true(exp_of(1e9) < INFINITY && exp_of(-1e9) > 0);
  assert_close(exp_of(0), 1, 0);
  assert_close(log_of(1), 0, 0);
  assert_true(isfinite(log_of(-1)) && log_of(-1) == log_of(0));
  assert_true(sqrt_of(-1) == 0);
  assert_close(pow_of(8, 1.0 / 3), 2, 1e-14);
  assert_true(pow_of(0, 2.5) == 0 && pow_of(-3, 0.5) == 0);
  assert_true(floor_of(-2) == -2 && floor_of(-0.1) == -1 && floor_of(1e300) == 1e300);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(equal_nodes_are_one, set_up, tear_down),
      cmocka_unit_test_setup_teardown(constants_fold, set_up, tear_down),
      cmocka_unit_test_setup_teardown(whole_powers_are_products, set_up, tear_down),
      cmocka_unit_test_setup_teardown(failures_pass_through, set_up, tear_down),
      cmocka_unit_test_setup_teardown(lowering_composes_maps, set_up, tear_down),
      cmocka_unit_test_setup_teardown(warps_substitute_coordinates, set_up, tear_down),
      cmocka_unit_test_setup_teardown(deep_chains_collapse, set_up, tear_down),
      cmocka_unit_test_setup_teardown(explosions_are_refused, set_up, tear_down),
      cmocka_unit_test(memory_limits_are_told),
      cmocka_unit_test(elementary_functions_are_accurate),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
