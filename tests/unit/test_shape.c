/* Solids: what their makers claim about boxes, slopes and distances, checked by samples. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "domain/shape.h"
#include "domain/tape.h"
#include "fixtures/assert_close.h"
#include "fixtures/random_expression.h"

typedef laves__expression E;
typedef laves__shape S;

static laves__tape compile(E *e, const S *s) {
  const laves__affine identity = laves__affine_identity();
  laves__tape tape;
  laves_error error;
  if (laves__tape_build(e, laves__expression_lower(e, s->node, &identity), NULL, &tape, &error) != LAVES_OK)
    fail_msg("%s", error.text);
  return tape;
}

static S random_primitive(E *e, uint64_t *seed) {
  const double a = 0.2 + random_unit(seed), b = 0.2 + random_unit(seed), c = 0.2 + random_unit(seed);
  switch ((int)(random_unit(seed) * 8)) {
    case 0:
      return laves__shape_sphere(e, a);
    case 1:
      return laves__shape_box(e, (double[]){a, b, c}, 0.09);
    case 2:
      return laves__shape_cylinder(e, a, b);
    case 3:
      return laves__shape_capsule(e, a, b);
    case 4:
      return laves__shape_cone(e, a, b, c);
    case 5:
      return laves__shape_torus(e, a + b, b);
    case 6:
      return laves__shape_ellipsoid(e, (double[]){a, b, c});
    default:
      return laves__shape_halfspace(e, v3(0, 0, a - 0.7), b);
  }
}

static S random_solid(E *e, uint64_t *seed, int depth) {
  if (depth == 0) return random_primitive(e, seed);
  const S a = random_solid(e, seed, depth - 1);
  const double t = random_unit(seed);
  switch ((int)(random_unit(seed) * 9)) {
    case 0:
      return laves__shape_move(e, &a, random_point(seed, 1));
    case 1:
      return laves__shape_rotate(e, &a, random_point(seed, 1), 7 * t);
    case 2:
      return laves__shape_scale(e, &a, v3(0.5 + t, -0.5 - random_unit(seed), 1));
    case 3:
      return laves__shape_mirror(e, &a, random_point(seed, 1));
    case 4:
      return laves__shape_offset(e, &a, t - 0.3);
    case 5:
      return laves__shape_shell(e, &a, t);
    default:
      break;
  }
  const S b = random_solid(e, seed, depth - 1);
  const laves__boolean kind = (laves__boolean)(random_unit(seed) * 3);
  return random_unit(seed) < 0.5 ? laves__shape_boolean(e, kind, &a, &b) : laves__shape_blend(e, kind, &a, &b, t);
}

/* Largest coordinate difference to the box. */
static double box_distance(laves__box3 box, laves__vec3 p) {
  double d = 0;
  for (int i = 0; i < 3; i++) d = fmax(d, fmax(v3_at(box.lower, i) - v3_at(p, i), v3_at(p, i) - v3_at(box.upper, i)));
  return d;
}

static void values_grow_outside_of_boxes(void **state) {
  (void)state;
  int outside = 0;
  for (uint64_t number = 1; number <= 400; number++) {
    uint64_t seed = number;
    laves_context *context = laves_context_create(NULL);
    E e;
    laves__expression_init(&e, context);
    const S s = random_solid(&e, &seed, 4);
    laves__tape tape = compile(&e, &s);
    for (int i = 0; i < 200; i++) {
      const laves__vec3 p = random_point(&seed, i % 2 ? 3 : 30);
      const double distance = box_distance(s.box, p);
      if (distance == 0) continue;
      double value;
      laves__tape_evaluate(&tape, 1, &p, &value);
      if (!(value >= s.slope * distance - 1e-9)) print_message("seed %d\n", (int)number);
      assert_true(value >= s.slope * distance - 1e-9);
      outside++;
    }
    laves__tape_free(context, &tape);
    laves__expression_free(&e);
    laves_context_free(context);
  }
  assert_true(outside > 400 * 50);
}

/* An exact distance has slope one everywhere but on its ridges, and what it claims as volume is what sampling finds. */
static void distances_and_volumes_are_exact(void **state) {
  (void)state;
  int exact = 0;
  for (uint64_t number = 1; number <= 60; number++) {
    uint64_t seed = number;
    laves_context *context = laves_context_create(NULL);
    E e;
    laves__expression_init(&e, context);
    const S s = random_solid(&e, &seed, (int)(number % 2));
    laves__tape tape = compile(&e, &s);
    int inside = 0;
    enum { SAMPLES = 4000 };
    const laves__vec3 widths = v3_sub(s.box.upper, s.box.lower);
    for (int i = 0; i < SAMPLES && laves__box3_is_finite(s.box); i++) {
      laves__vec3 p;
      for (int k = 0; k < 3; k++) *v3_slot(&p, k) = v3_at(s.box.lower, k) + v3_at(widths, k) * random_unit(&seed);
      const laves__dual d = laves__tape_gradient(&tape, p);
      inside += d.value < 0;
      if (!s.exact) continue;
      if (!(fabs(v3_norm(d.gradient) - 1) < 1e-9)) print_message("seed %d\n", (int)number);
      assert_close(v3_norm(d.gradient), 1, 1e-9);
      exact++;
    }
    if (laves__box3_is_finite(s.box) && !isnan(s.volume))
      assert_close(s.volume / (widths.x * widths.y * widths.z), (double)inside / SAMPLES, 0.04);
    laves__tape_free(context, &tape);
    laves__expression_free(&e);
    laves_context_free(context);
  }
  assert_true(exact > 4000 * 5);
}

/* The slopes in shape_primitive.c: over the surface of each, the mean length of the gradient is one. */
static void periodic_surfaces_have_slope_one(void **state) {
  (void)state;
  for (int kind = 0; kind < LAVES__TPMS_COUNT; kind++) {
    laves_context *context = laves_context_create(NULL);
    E e;
    laves__expression_init(&e, context);
    const S s = laves__shape_tpms(&e, (laves__tpms)kind, 2, 0, 0);
    laves__tape tape = compile(&e, &s);
    double sum = 0, count = 0;
    enum { N = 40 };
    for (int i = 0; i < N * N * N; i++) {
      const laves__vec3 p = v3_scale(v3(i % N + 0.5, i / N % N + 0.5, i / N / N + 0.5), 2.0 / N);
      const laves__dual d = laves__tape_gradient(&tape, p);
      const double slope = v3_norm(d.gradient);
      if (fabs(d.value) > 0.03 * slope) continue; /* a band of even width */
      sum += slope;
      count++;
    }
    assert_close(sum / count, 1, 0.03);
    laves__tape_free(context, &tape);
    laves__expression_free(&e);
    laves_context_free(context);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(values_grow_outside_of_boxes),
      cmocka_unit_test(distances_and_volumes_are_exact),
      cmocka_unit_test(periodic_surfaces_have_slope_one),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
