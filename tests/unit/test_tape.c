/* Tapes: the three ways to run one agree with plain recursion over the expression, on random expressions. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "domain/tape.h"
#include "fixtures/assert_close.h"
#include "fixtures/random_expression.h"

typedef struct random_tape {
  laves_context *context;
  laves__expression e;
  laves__node root;
  laves__tape tape;
} random_tape;

static random_tape make(uint64_t seed, int size, bool jumps) {
  random_tape r = {.context = laves_context_create(NULL)};
  laves__expression_init(&r.e, r.context);
  r.root = random_expression(&r.e, &seed, size, jumps);
  laves_error error;
  assert_int_equal(laves__tape_build(&r.e, r.root, NULL, &r.tape, &error), LAVES_OK);
  return r;
}

static void drop(random_tape *r) {
  laves__tape_free(r->context, &r->tape);
  laves__expression_free(&r->e);
  assert_int_equal(laves_context_bytes(r->context), 0);
  laves_context_free(r->context);
}

/* What laves__tape_evaluate() promises for a value. */
static double tamed(double v) { return !(v <= LAVES__TAPE_NOWHERE) ? LAVES__TAPE_NOWHERE : fmax(v, -LAVES__TAPE_NOWHERE); }

enum { TREES = 300, POINTS = 300, SIZE = 14 };

static void batches_equal_recursion(void **state) {
  (void)state;
  for (uint64_t seed = 1; seed <= TREES; seed++) {
    random_tape r = make(seed, SIZE, true);
    uint64_t point_seed = seed;
    laves__vec3 points[POINTS];
    double values[POINTS];
    for (int i = 0; i < POINTS; i++) points[i] = random_point(&point_seed, 3);
    laves__tape_evaluate(&r.tape, POINTS, points, values);
    for (int i = 0; i < POINTS; i++) {
      const double wanted = tamed(reference_value(&r.e, r.root, points[i]));
      double single;
      laves__tape_evaluate(&r.tape, 1, &points[i], &single);
      if (values[i] != wanted || single != wanted) print_message("seed %d\n", (int)seed);
      assert_true(values[i] == wanted);
      assert_true(single == wanted);
    }
    drop(&r);
  }
}

static void intervals_contain_samples(void **state) {
  (void)state;
  int decided = 0;
  for (uint64_t seed = 1; seed <= TREES; seed++) {
    random_tape r = make(seed, SIZE, true);
    uint64_t point_seed = seed;
    for (int k = 0; k < 30; k++) {
      const laves__vec3 centre = random_point(&point_seed, 3);
      const double half = exp2(-20 * random_unit(&point_seed));
      const laves__box3 box = {v3_sub(centre, v3(half, half, half)), v3_add(centre, v3(half, half, half))};
      bool may_be_nan;
      const laves__interval range = laves__tape_interval(&r.tape, box, &may_be_nan);
      decided += isfinite(range.lower) && isfinite(range.upper);
      for (int i = 0; i < 20; i++) {
        const laves__vec3 p = v3_add(centre, random_point(&point_seed, half));
        const double value = reference_value(&r.e, r.root, p);
        const bool held = isnan(value) ? may_be_nan : may_be_nan || (value >= range.lower && value <= range.upper);
        if (!held) print_message("seed %d: %.17g not in [%.17g, %.17g]\n", (int)seed, value, range.lower, range.upper);
        assert_true(held);
      }
    }
    drop(&r);
  }
  assert_true(decided > TREES * 30 / 2); /* not everything may be called undecided */
}

/* Central differences are wrong near kinks; there they differ from one step width to another, and nothing is claimed. */
static void gradients_equal_differences(void **state) {
  (void)state;
  int compared = 0;
  for (uint64_t seed = 1; seed <= TREES; seed++) {
    random_tape r = make(seed, SIZE, false);
    uint64_t point_seed = seed;
    for (int k = 0; k < 20; k++) {
      const laves__vec3 p = random_point(&point_seed, 2);
      const laves__dual d = laves__tape_gradient(&r.tape, p);
      double value;
      laves__tape_evaluate(&r.tape, 1, &p, &value);
      assert_true(tamed(d.value) == value);
      for (int axis = 0; axis < 3; axis++) {
        double slope[3];
        for (int s = 0; s < 3; s++) {
          const double h = 1e-6 * (1 << s);
          laves__vec3 a = p, b = p;
          *v3_slot(&a, axis) -= h;
          *v3_slot(&b, axis) += h;
          slope[s] = (reference_value(&r.e, r.root, b) - reference_value(&r.e, r.root, a)) / (2 * h);
        }
        const double size = 1 + fabs(slope[0]) + fabs(value) + fabs(v3_at(d.gradient, axis));
        if (!(fabs(slope[0] - slope[1]) + fabs(slope[1] - slope[2]) < 1e-5 * size) || !(size < 1e4)) continue;
        const double gradient = v3_at(d.gradient, axis);
        if (!(fabs(gradient - slope[0]) <= 1e-4 * size)) print_message("seed %d: %g, %g\n", (int)seed, gradient, slope[0]);
        assert_close(gradient, slope[0], 1e-4 * size);
        compared++;
      }
    }
    drop(&r);
  }
  assert_true(compared > TREES * 20);
}

/* Gradients of batches have the bits of single ones, whatever the size of the batch. */
static void gradients_of_batches_are_the_same(void **state) {
  (void)state;
  for (uint64_t seed = 1; seed <= TREES; seed++) {
    random_tape r = make(seed, SIZE, false);
    uint64_t point_seed = seed;
    laves__vec3 points[POINTS];
    laves__dual duals[POINTS];
    for (int k = 0; k < POINTS; k++) points[k] = random_point(&point_seed, 2);
    for (size_t count = 1; count <= POINTS; count += 1 + count / 2) {
      laves__tape_gradients(&r.tape, count, points, duals);
      for (size_t k = 0; k < count; k++) {
        const laves__dual one = laves__tape_gradient(&r.tape, points[k]);
        assert_true(one.value == duals[k].value || (isnan(one.value) && isnan(duals[k].value)));
        assert_true(v3_distance(one.gradient, duals[k].gradient) == 0);
      }
    }
    drop(&r);
  }
}

/* The functions whose slopes have no bound, away from where that shows. */
static void steep_functions_have_gradients(void **state) {
  (void)state;
  static const laves__op ops[] = {LAVES__OP_TAN, LAVES__OP_ASIN, LAVES__OP_ACOS, LAVES__OP_ATAN2, LAVES__OP_MOD};
  for (size_t k = 0; k < LAVES__COUNT_OF(ops); k++) {
    random_tape r = {.context = laves_context_create(NULL)};
    laves__expression_init(&r.e, r.context);
    laves__expression *e = &r.e;
    r.root = laves__node_make(e, ops[k], laves__node_make(e, LAVES__OP_X, 0, 0, 0), laves__node_make(e, LAVES__OP_Y, 0, 0, 0), 0);
    assert_int_equal(laves__tape_build(e, r.root, NULL, &r.tape, NULL), LAVES_OK);
    for (double x = -0.9513; x < 1; x += 0.1107) {
      for (double y = -2.0371; y < 2; y += 0.5003) {
        const laves__dual d = laves__tape_gradient(&r.tape, v3(x, y, 0));
        const double h = 1e-6;
        const double dx = reference_value(e, r.root, v3(x + h, y, 0)) - reference_value(e, r.root, v3(x - h, y, 0));
        const double dy = reference_value(e, r.root, v3(x, y + h, 0)) - reference_value(e, r.root, v3(x, y - h, 0));
        assert_close(d.gradient.x, dx / (2 * h), 1e-5 * (1 + fabs(d.gradient.x)));
        assert_close(d.gradient.y, dy / (2 * h), 1e-5 * (1 + fabs(d.gradient.y)));
      }
    }
    drop(&r);
  }
}

static void endless_boxes_have_ranges(void **state) {
  (void)state;
  random_tape r = {.context = laves_context_create(NULL)};
  laves__expression_init(&r.e, r.context);
  laves__expression *e = &r.e;
  const laves__node x = laves__node_make(e, LAVES__OP_X, 0, 0, 0), y = laves__node_make(e, LAVES__OP_Y, 0, 0, 0);
  const laves__node root = laves__node_make(e, LAVES__OP_ADD, laves__node_make(e, LAVES__OP_MUL, x, x, 0),
                                            laves__node_make(e, LAVES__OP_COS, y, 0, 0), 0);
  assert_int_equal(laves__tape_build(e, root, NULL, &r.tape, NULL), LAVES_OK);
  bool may_be_nan;
  const laves__box3 box = {{2, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
  const laves__interval range = laves__tape_interval(&r.tape, box, &may_be_nan);
  assert_true(range.lower > 2.99 && range.lower <= 3 && range.upper == INFINITY && !may_be_nan);
  drop(&r);
}

static void trivial_expressions_have_tapes(void **state) {
  (void)state;
  random_tape r = {.context = laves_context_create(NULL)};
  laves__expression_init(&r.e, r.context);
  const laves__vec3 p = v3(1, 2, 3);
  double value;
  assert_int_equal(laves__tape_build(&r.e, laves__node_make(&r.e, LAVES__OP_Z, 0, 0, 0), NULL, &r.tape, NULL), LAVES_OK);
  laves__tape_evaluate(&r.tape, 1, &p, &value);
  assert_true(value == 3 && laves__tape_gradient(&r.tape, p).gradient.z == 1);
  laves__tape_free(r.context, &r.tape);
  assert_int_equal(laves__tape_build(&r.e, laves__node_constant(&r.e, -4), NULL, &r.tape, NULL), LAVES_OK);
  laves__tape_evaluate(&r.tape, 1, &p, &value);
  assert_true(value == -4);
  drop(&r);
}

/* Sums of all products of many sines keep every sine alive: more registers than a batch of 256 has room for. */
static void many_registers_shrink_the_batch(void **state) {
  (void)state;
  enum { COUNT = 300 };
  random_tape r = {.context = laves_context_create(NULL)};
  laves__expression_init(&r.e, r.context);
  laves__expression *e = &r.e;
  laves__node sine[COUNT], sum = laves__node_constant(e, 0);
  const laves__node x = laves__node_make(e, LAVES__OP_X, 0, 0, 0);
  for (int i = 0; i < COUNT; i++)
    sine[i] =
        laves__node_make(e, LAVES__OP_SIN, laves__node_make(e, LAVES__OP_ADD, x, laves__node_constant(e, i + 0.5), 0), 0, 0);
  for (int i = 0; i < COUNT; i++)
    for (int k = 1; k < 4; k++)
      sum = laves__node_make(e, LAVES__OP_ADD, sum,
                             laves__node_make(e, LAVES__OP_MUL, sine[i], sine[(i * 7 + k * 31) % COUNT], 0), 0);
  assert_int_equal(laves__tape_build(e, sum, NULL, &r.tape, NULL), LAVES_OK);
  assert_true(r.tape.register_count > 64);
  laves__vec3 points[100];
  double values[100];
  for (int i = 0; i < 100; i++) points[i] = v3(i * 0.1, 0, 0);
  laves__tape_evaluate(&r.tape, 100, points, values);
  for (int i = 0; i < 100; i++) {
    double one;
    laves__tape_evaluate(&r.tape, 1, &points[i], &one);
    assert_true(one == values[i] && one == laves__tape_gradient(&r.tape, points[i]).value);
  }
  drop(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(batches_equal_recursion),           cmocka_unit_test(intervals_contain_samples),
      cmocka_unit_test(gradients_equal_differences),       cmocka_unit_test(steep_functions_have_gradients),
      cmocka_unit_test(gradients_of_batches_are_the_same), cmocka_unit_test(endless_boxes_have_ranges),
      cmocka_unit_test(trivial_expressions_have_tapes),    cmocka_unit_test(many_registers_shrink_the_batch),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
