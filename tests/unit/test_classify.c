/* The promise of classify, by brute force: the oracle is asked at every site of a box, and every edge of the tiling whose
 * ends differ in sign must have both in records. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "classify/classify.h"
#include "fixtures/hard_solids.h"
#include "fixtures/random_expression.h"
#include "fixtures/stages.h"

/* The site that a link leads to from a cell, and its cell's coordinates. */
static void follow(const int32_t cell[3], laves__c15_link link, int32_t other[3]) {
  other[0] = cell[0] + link.cell % 3 - 1;
  other[1] = cell[1] + link.cell / 3 % 3 - 1;
  other[2] = cell[2] + link.cell / 9 - 1;
}

static int true_sign(const laves__frame *frame, const int32_t cell[3], int site) {
  const laves__vec3 p = laves__site_position(cell, site);
  double phi;
  laves__frame_evaluate(frame, 1, &p, &phi, NULL);
  return phi < 0 ? -1 : 1;
}

static int lattice_sign(const laves__lattice *l, const int32_t cell[3], int site) {
  return laves__site_sign(l, (laves__site){laves__lattice_cell(l, cell[0], cell[1], cell[2]), (uint8_t)site});
}

/* Whether the surface crosses a tet that the cell owns. */
static bool owns_crossed_tet(const laves__lattice *l, const int32_t cell[3]) {
  for (int tet = 0; tet < LAVES__C15_TETS; tet++) {
    int sum = 0;
    for (int k = 0; k < 4; k++) {
      const laves__c15_corner corner = laves__c15_tet[tet][k];
      const int32_t c[3] = {cell[0] + (corner.shift & 1), cell[1] + (corner.shift >> 1 & 1), cell[2] + (corner.shift >> 2)};
      sum += lattice_sign(l, c, corner.site);
    }
    if (sum != 4 && sum != -4) return true;
  }
  return false;
}

/* Compares signs at every site of the directory; `exact`: the oracle's answers agree with one another. */
static void compare_signs(const stages *s, const char *name, bool exact) {
  const laves__lattice *l = &s->lattice;
  size_t crossings = 0;
  int32_t c[3], o[3];
  for (c[2] = l->lower[2]; c[2] < l->lower[2] + l->bricks[2] * LAVES__BRICK_SIDE; c[2]++)
    for (c[1] = l->lower[1]; c[1] < l->lower[1] + l->bricks[1] * LAVES__BRICK_SIDE; c[1]++)
      for (c[0] = l->lower[0]; c[0] < l->lower[0] + l->bricks[0] * LAVES__BRICK_SIDE; c[0]++) {
        const int32_t own = laves__lattice_cell(l, c[0], c[1], c[2]);
        if (own < 0 && owns_crossed_tet(l, c))
          fail_msg("%s: cell %d %d %d has a crossed tet and no record", name, c[0], c[1], c[2]);
        for (int site = 0; site < LAVES__C15_SITES; site++) {
          const int sign = lattice_sign(l, c, site);
          if (exact && sign != true_sign(&s->frame, c, site)) fail_msg("%s: wrong sign in cell %d %d %d", name, c[0], c[1], c[2]);
          for (int k = 0; k < laves__c15_degree[site]; k++) {
            const laves__c15_link link = laves__c15_neighbour[site][k];
            follow(c, link, o);
            if (lattice_sign(l, o, link.site) == sign) continue;
            crossings++;
            const int32_t other = laves__lattice_cell(l, o[0], o[1], o[2]);
            if (own < 0 || other < 0) fail_msg("%s: an edge crosses unseen at cell %d %d %d", name, c[0], c[1], c[2]);
            assert_true(isfinite(l->record[own].phi[site]) || !exact);
          }
        }
      }
  assert_true(crossings > 0);
}

static void all_crossings_of_solids_are_seen(void **state) {
  (void)state;
  static const char *const solids[] = {
      "sphere(1)",
      "torus(1, 0.3):rotate(20, 'x')",
      "sphere(1) - cylinder{r=0.4}",
      "box(2, 1.5, 1)",
      "gyroid{period=1, thickness=0.3} & sphere(1)",
      "x*x + y*y + z*z - 1",
      "smooth_union(sphere(0.7), sphere(0.5):move(0.8, 0, 0), 0.3)",
  };
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++)
    for (int fine = 0; fine < 2; fine++) {
      stages s;
      stages_begin(&s, solids[i], fine ? 0.1 : 0.37, 0);
      stages_classify(&s);
      compare_signs(&s, solids[i], true);
      stages_end(&s);
    }
}

/* Work grows with the surface: halving the size makes about four times the records, not eight. */
static void records_grow_with_the_surface(void **state) {
  (void)state;
  size_t records[2];
  for (int i = 0; i < 2; i++) {
    stages s;
    stages_begin(&s, "sphere(1)", i ? 0.02 : 0.04, 0);
    stages_classify(&s);
    records[i] = s.lattice.record_count;
    stages_end(&s);
  }
  assert_true((double)records[1] < 4.4 * (double)records[0]);
}

static void labels_are_signs_and_records_are_linked(void **state) {
  (void)state;
  stages s;
  stages_begin(&s, "torus(1, 0.3)", 0.1, 0);
  stages_classify(&s);
  for (size_t i = 0; i < s.lattice.record_count; i++) {
    const laves__record *r = &s.lattice.record[i];
    assert_int_equal(r->around[13], i);
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      assert_int_equal(r->label[site], r->sign[site]);
      assert_int_equal(r->sign[site], r->phi[site] < 0 ? -1 : 1);
    }
  }
  stages_end(&s);
}

/* Lattices of callbacks that contradict themselves hold no edge that crosses unseen. */
static void inconsistent_oracles_are_sealed(void **state) {
  (void)state;
  int classified = 0;
  for (int i = 0; i < hard_solid_count; i++) {
    const laves_function function = hard_function(&hard_solids[i]);
    stages s;
    laves_error error;
    stages_begin_function(&s, &function, 0.17);
    assert_int_equal(laves__lattice_create(s.context, laves__frame_bounds(&s.frame), &s.lattice, &error), LAVES_OK);
    const laves_result result = laves__classify(&s.frame, &s.lattice, &error);
    bool any = false;
    for (size_t r = 0; r < s.lattice.record_count; r++)
      for (int site = 0; site < LAVES__C15_SITES; site++) any |= s.lattice.record[r].sign[site] < 0;
    if (result == LAVES_OK && any) {
      compare_signs(&s, hard_solids[i].name, false);
      classified++;
    } else if (result != LAVES_OK) {
      assert_int_equal(result, LAVES_ERROR_INPUT);
    }
    stages_end(&s);
  }
  assert_true(classified > hard_solid_count / 2);
}

/* An oracle whose `side` lies at random while its values are those of a sphere. */
typedef struct liar {
  laves__oracle truth;
} liar;

static void evaluate_truth(const void *self, size_t count, const laves__vec3 *points, double *phi, uint32_t *hints) {
  const liar *l = self;
  l->truth.evaluate(l->truth.self, count, points, phi, hints);
}

static laves__side lie(const void *self, laves__vec3 centre, double radius, laves__vec3 half) {
  const liar *l = self;
  uint64_t seed = (uint64_t)((centre.x * 3 + centre.y * 5 + centre.z * 7 + radius) * 1e6 + 1e9);
  const double draw = random_unit(&seed);
  if (draw < 0.1) return LAVES__INSIDE;
  if (draw < 0.2) return LAVES__OUTSIDE;
  return radius > 0.5 ? LAVES__UNDECIDED : l->truth.side(l->truth.self, centre, radius, half);
}

static void lies_about_boxes_are_sealed(void **state) {
  (void)state;
  stages s;
  stages_begin(&s, "sphere(1)", 0.06, 0);
  liar l = {s.domain->oracle};
  laves__oracle lying = s.domain->oracle;
  lying.self = &l;
  lying.evaluate = evaluate_truth;
  lying.side = lie;
  lying.is_distance = false;
  s.frame.oracle = &lying;
  laves_error error;
  assert_int_equal(laves__lattice_create(s.context, laves__frame_bounds(&s.frame), &s.lattice, &error), LAVES_OK);
  const laves_result result = laves__classify(&s.frame, &s.lattice, &error);
  if (result == LAVES_OK)
    compare_signs(&s, "liar", false);
  else
    assert_int_equal(result, LAVES_ERROR_INPUT); /* it claimed an inside at the edge of the directory */
  stages_end(&s);
}

static void solids_beyond_their_bounds_are_refused(void **state) {
  (void)state;
  const hard_solid ball = {"ball", hard_solids[20].evaluate, 5, 1};
  assert_string_equal(hard_solids[20].name, "ball larger than its box");
  const laves_function function = hard_function(&ball);
  stages s;
  laves_error error;
  stages_begin_function(&s, &function, 0.2);
  assert_int_equal(laves__lattice_create(s.context, laves__frame_bounds(&s.frame), &s.lattice, &error), LAVES_OK);
  assert_int_equal(laves__classify(&s.frame, &s.lattice, &error), LAVES_ERROR_INPUT);
  assert_non_null(strstr(error.text, "beyond its bounds"));
  stages_end(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(all_crossings_of_solids_are_seen),
      cmocka_unit_test(records_grow_with_the_surface),
      cmocka_unit_test(labels_are_signs_and_records_are_linked),
      cmocka_unit_test(inconsistent_oracles_are_sealed),
      cmocka_unit_test(lies_about_boxes_are_sealed),
      cmocka_unit_test(solids_beyond_their_bounds_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
