/* ON sites are a vertex cover of the crossing edges, no one of them needless, and near the surface. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/hard_solids.h"
#include "fixtures/stages.h"
#include "snap/snap.h"

/* Whether a site has a neighbour of the other sign that is not ON. */
static bool is_needed(const laves__lattice *l, const laves__record *r, int site) {
  for (int k = 0; k < laves__c15_degree[site]; k++) {
    const laves__site s = laves__neighbour(r, site, k);
    if (laves__site_sign(l, s) != r->sign[site] && laves__site_label(l, s) != LAVES__LABEL_ON) return true;
  }
  return false;
}

static size_t assert_minimal_cover(const laves__lattice *l, const char *name) {
  size_t on = 0;
  for (size_t i = 0; i < l->record_count; i++) {
    const laves__record *r = &l->record[i];
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      if (r->label[site] != LAVES__LABEL_ON) {
        assert_int_equal(r->label[site], r->sign[site]);
        if (is_needed(l, r, site)) fail_msg("%s: a crossing edge is not covered", name);
      } else {
        on++;
        if (!is_needed(l, r, site)) fail_msg("%s: a site is ON for nothing", name);
      }
    }
  }
  return on;
}

static void solids_are_covered(void **state) {
  (void)state;
  static const char *const solids[] = {"sphere(1)", "torus(1, 0.3)", "box(2, 1.5, 1)", "x^4 + y^4 + z^4 - 1",
                                       "gyroid{period=1, thickness=0.3} & sphere(1)"};
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++) {
    stages s;
    stages_begin(&s, solids[i], 0.08, 0);
    stages_cover(&s);
    assert_true(assert_minimal_cover(&s.lattice, solids[i]) > 100);
    stages_end(&s);
  }
}

static void noise_is_covered(void **state) {
  (void)state;
  for (int i = 0; i < hard_solid_count; i++) {
    if (hard_solids[i].scale == 5 || hard_solids[i].scale == -1) continue; /* beyond the bounds */
    const laves_function function = hard_function(&hard_solids[i]);
    stages s;
    stages_begin_function(&s, &function, 0.21);
    stages_cover(&s);
    assert_minimal_cover(&s.lattice, hard_solids[i].name);
    stages_end(&s);
  }
}

/* Where the surface is resolved, no vertex has to go far, and feet are on the surface. */
static void moves_are_short(void **state) {
  (void)state;
  stages s;
  stages_begin(&s, "torus(1, 0.3)", 0.05, 0);
  stages_cover(&s);
  laves_error error;
  assert_int_equal(laves__find_surface_feet(&s.frame, &s.lattice, &s.feet, &error), LAVES_OK);
  double furthest = 0;
  for (size_t i = 0; i < s.lattice.record_count; i++)
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      if (s.lattice.record[i].label[site] != LAVES__LABEL_ON) continue;
      double phi;
      const laves__foot *foot = laves__feet_get(&s.feet, (int32_t)i, site);
      assert_non_null(foot);
      laves__frame_evaluate(&s.frame, 1, &foot->position, &phi, NULL);
      assert_true(fabs(phi) < 1e-9);
      furthest = fmax(furthest, v3_distance(foot->position, laves__site_position(s.lattice.record[i].xyz, site)));
    }
  assert_true(furthest > 0.3 && furthest < 0.65);
  stages_end(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(solids_are_covered),
      cmocka_unit_test(noise_is_covered),
      cmocka_unit_test(moves_are_short),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
