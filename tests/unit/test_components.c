/* Components of the layer, and what is made of a part of them beside what was made before. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/stages.h"
#include "improve/improve.h"
#include "mesh/components.h"

/* Two solids that do not touch, the first in the order of the lattice at the left. */
static const char *const pair_of_solids = "sphere(1):move(-2, 0, 0) | box(1.5, 1.3, 1.7):move(2, 0, 0)";
static const laves__window window = {.min_dihedral = 40, .max_dihedral = 125, .volume_length = 0.6, .held_max = 180};

static void make_pair(stages *s) {
  stages_begin(s, pair_of_solids, 0.13, 0);
  stages_snap(s);
}

static void tets_have_their_corners_in_one_component(void **state) {
  (void)state;
  stages s;
  laves__components c;
  make_pair(&s);
  assert_true(laves__components_find(&s.layer, &c));
  assert_int_equal(c.count, 2);
  assert_int_equal(c.first[0], 0);
  assert_int_equal(c.first[2], s.layer.vertex_count);
  for (size_t t = 0; t < s.layer.tet_count; t++)
    for (int k = 1; k < 4; k++) assert_int_equal(c.of[s.layer.tet[t][k]], c.of[s.layer.tet[t][0]]);
  for (size_t v = 0; v < s.layer.vertex_count; v++) {
    assert_int_equal(c.vertex[c.place[v]], v);
    assert_in_range(c.place[v], c.first[c.of[v]], c.first[c.of[v] + 1] - 1);
    assert_int_equal(s.layer.position[v].x > 0, s.layer.position[c.vertex[c.first[c.of[v]]]].x > 0);
  }
  laves__components_free(&c);
  stages_end(&s);
}

static size_t count_alive(const laves__layer *layer, const int32_t *owner, int32_t component) {
  size_t count = 0;
  for (size_t t = 0; t < layer->tet_count; t++)
    count += layer->tet[t][0] >= 0 && (component < 0 || owner[layer->tet[t][0]] == component);
  return count;
}

/* The tets of one layer that lie at one side, as the sum of their qualities and of the places of their corners. */
static double sum_at_side(const laves__layer *layer, bool right) {
  double sum = 0;
  for (size_t t = 0; t < layer->tet_count; t++) {
    if (layer->tet[t][0] < 0 || (layer->position[layer->tet[t][0]].x > 0) != right) continue;
    sum += layer->quality[t];
    for (int k = 0; k < 4; k++) sum += layer->position[layer->tet[t][k]].y;
  }
  return sum;
}

static void assert_stars_hold_their_tets(const laves__layer *layer) {
  size_t in_stars = 0, corners = 0;
  for (size_t v = 0; v < layer->vertex_count; v++) {
    in_stars += (size_t)layer->star[v].count;
    for (int i = 0; i < layer->star[v].count; i++)
      assert_true(laves__layer_corner(layer, layer->star[v].tet[i], (int32_t)v) >= 0);
  }
  for (size_t t = 0; t < layer->tet_count; t++)
    for (int k = 0; k < 4 && layer->tet[t][0] >= 0; k++) corners += laves__layer_moves(layer, layer->tet[t][k]);
  assert_int_equal(in_stars, corners);
}

/* Two layers of the same solids; one is improved, in the other a vertex of the first component moves a little. */
static void what_did_not_change_comes_back_improved(void **state) {
  (void)state;
  stages old, fresh;
  laves__components before, now;
  laves__twins twins;
  laves_error error;
  make_pair(&old);
  make_pair(&fresh);
  assert_true(laves__components_find(&old.layer, &before));
  fresh.layer.position[before.vertex[before.first[0]]].y += 1e-9;
  assert_true(laves__components_find(&fresh.layer, &now));
  assert_int_equal(laves__improve(&old.frame, &window, &old.layer, &error), LAVES_OK);

  assert_true(laves__twins_find(&old.layer, &before, &now, NULL, &twins));
  assert_int_equal(twins.twin[0], -1);
  assert_int_equal(twins.twin[1], 1);
  const size_t changed = count_alive(&fresh.layer, now.of, 0), kept = count_alive(&old.layer, twins.owner, 1);
  laves__twins_set_aside(&twins, &fresh.layer);
  assert_int_equal(count_alive(&fresh.layer, NULL, -1), changed);
  assert_stars_hold_their_tets(&fresh.layer);

  const bool right = old.layer.position[before.vertex[before.first[1]]].x > 0;
  assert_true(laves__twins_bring_back(&twins, &fresh.layer));
  assert_int_equal(count_alive(&fresh.layer, NULL, -1), changed + kept);
  assert_true(sum_at_side(&fresh.layer, right) == sum_at_side(&old.layer, right));
  assert_stars_hold_their_tets(&fresh.layer);
  for (size_t v = 0; v < now.vertex_count; v++) {
    assert_int_equal(fresh.layer.origin[v], old.layer.origin[v]); /* vertices keep their numbers */
    if (now.of[v] == 1) assert_memory_equal(&fresh.layer.position[v], &old.layer.position[v], sizeof(laves__vec3));
  }
  laves__twins_free(&twins);
  laves__components_free(&before);
  laves__components_free(&now);
  stages_end(&old);
  stages_end(&fresh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(tets_have_their_corners_in_one_component),
      cmocka_unit_test(what_did_not_change_comes_back_improved),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
