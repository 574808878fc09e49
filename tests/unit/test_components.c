/* Components of the layer: what hangs together by tets. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/stages.h"
#include "mesh/components.h"

static void tets_have_their_corners_in_one_component(void **state) {
  (void)state;
  stages s;
  laves__components c;
  stages_begin(&s, "sphere(1):move(-2, 0, 0) | box(1.5, 1.3, 1.7):move(2, 0, 0)", 0.13, 0);
  stages_snap(&s);
  assert_true(laves__components_find(&s.layer, &c));
  assert_int_equal(c.count, 2);
  assert_int_equal(c.of[s.layer.tet[0][0]], c.of[s.layer.tet[0][1]]);
  for (size_t t = 0; t < s.layer.tet_count; t++)
    for (int k = 0; k < 4; k++) {
      const int32_t v = s.layer.tet[t][k];
      assert_int_equal(c.of[v], c.of[s.layer.tet[t][0]]);
      assert_int_equal(s.layer.position[v].x > 0, c.of[v] != c.of[0] || s.layer.position[0].x > 0);
    }
  laves__components_free(&c);
  stages_end(&s);
}

/* Dead tets join nothing, and vertices of no tet are in no component. */
static void what_has_no_tets_is_in_none(void **state) {
  (void)state;
  stages s;
  laves__components c;
  stages_begin(&s, "sphere(1)", 0.4, 0);
  stages_snap(&s);
  for (size_t t = 1; t < s.layer.tet_count; t++) s.layer.tet[t][0] = -1;
  assert_true(laves__components_find(&s.layer, &c));
  assert_int_equal(c.count, 1);
  size_t in = 0;
  for (size_t v = 0; v < c.vertex_count; v++) in += c.of[v] == 0;
  assert_int_equal(in, 4);
  laves__components_free(&c);
  stages_end(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(tets_have_their_corners_in_one_component),
      cmocka_unit_test(what_has_no_tets_is_in_none),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
