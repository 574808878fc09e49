/* The stage "features" by its promises: creases are chains of edges, corners are vertices, tets stay positive. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/predicates.h"
#include "features/keep.h"
#include "features/tally.h"
#include "fixtures/assert_close.h"
#include "fixtures/stages.h"

/* The stages up to this one, on a surface. Do not copy. */
typedef struct kept {
  stages s;
  laves__features features;
  laves__kept_counts counts;
} kept;

static void begin(kept *k, shape surface, double size, int threads, const bool *free_vertices) {
  stages_begin_shape(&k->s, &surface, size, threads);
  shape_free(&surface);
  stages_snap(&k->s);
  const laves__feature_wish wish = {.angle = 40, .size = size};
  assert_int_equal(laves__features_find(k->s.context, &k->s.domain->oracle, &wish, &k->features, NULL), LAVES_OK);
  k->s.frame.features = &k->features;
  assert_int_equal(laves__keep_features(&k->s.frame, free_vertices, false, &k->s.layer, &k->counts, NULL), LAVES_OK);
}

static void end(kept *k) {
  laves__features_free(&k->features);
  stages_end(&k->s);
}

static shape cube(void) { return shape_box((const double[]){-1, -1, -1}, (const double[]){1, 1, 1}, 2); }

static void assert_positive(const laves__layer *layer) {
  for (size_t t = 0; t < layer->tet_count; t++) {
    laves__vec3 p[4];
    laves__layer_points(layer, (int32_t)t, p);
    assert_true(laves__orient3d(p[0], p[1], p[2], p[3]) > 0);
  }
}

/* Every boundary face has a patch, and every held vertex that is not marked stands where it belongs. */
static void assert_legal(const kept *k) {
  const laves__layer *layer = &k->s.layer;
  laves__rim rim;
  assert_int_equal(laves__rim_make(layer, &rim, NULL), LAVES_OK);
  for (size_t f = 0; f < rim.face_count; f++) {
    laves__hold hold[3];
    for (int j = 0; j < 3; j++) hold[j] = layer->hold[rim.face[f][j]];
    assert_true(laves__face_is_legal(&k->features, hold));
  }
  laves__rim_free(&rim);
  for (size_t v = 0; v < layer->vertex_count; v++) {
    if (layer->depth[v] != 0 || layer->off_surface[v]) continue;
    laves__vec3 place, direction;
    uint32_t hint = layer->hint[v];
    assert_true(laves__frame_project_held(&k->s.frame, layer->hold[v], layer->position[v], 1, &hint, &place, &direction));
    assert_close(v3_distance(place, layer->position[v]), 0, 1e-9);
  }
}

static void a_cube_is_kept(void **state) {
  (void)state;
  kept k;
  begin(&k, cube(), 0.17, 1, NULL);
  assert_int_equal(k.counts.corners_lost, 0);
  assert_int_equal(k.counts.illegal_faces, 0);
  assert_true(k.counts.crease_vertices > 12 * 2 / 0.17 * 0.6);
  assert_positive(&k.s.layer);
  assert_legal(&k);
  end(&k);
}

static void closed_creases_are_kept(void **state) {
  (void)state;
  kept k;
  begin(&k, shape_cylinder(1, 1.6, 120), 0.15, 1, NULL);
  assert_int_equal(k.features.corner_count, 0);
  assert_int_equal(k.counts.illegal_faces, 0);
  assert_positive(&k.s.layer);
  assert_legal(&k);
  laves__feature_tally tally;
  assert_int_equal(laves__tally_features(&k.s.frame, &k.s.layer, &tally, NULL), LAVES_OK);
  /* Some vertices come home only while angles are improved. */
  assert_true(tally.kept_length > 0.8 * tally.length);
  end(&k);
}

static void notches_are_kept(void **state) {
  (void)state;
  kept k;
  begin(&k, shape_ell(), 0.13, 1, NULL);
  assert_int_equal(k.counts.corners_lost, 0);
  assert_int_equal(k.counts.illegal_faces, 0);
  assert_positive(&k.s.layer);
  assert_legal(&k);
  end(&k);
}

static void a_smooth_solid_is_left_alone(void **state) {
  (void)state;
  stages plain;
  kept k;
  shape ball = shape_sphere(1, 8);
  stages_begin_shape(&plain, &ball, 0.2, 1);
  stages_snap(&plain);
  begin(&k, ball, 0.2, 1, NULL);
  assert_int_equal(k.features.crease_count, 0);
  assert_int_equal(k.counts.crease_vertices, 0);
  assert_int_equal(k.s.layer.vertex_count, plain.layer.vertex_count);
  assert_memory_equal(k.s.layer.position, plain.layer.position, plain.layer.vertex_count * sizeof *plain.layer.position);
  end(&k);
  stages_end(&plain);
}

static void free_vertices_are_held_to_nothing(void **state) {
  (void)state;
  stages plain;
  kept k;
  shape s = cube();
  stages_begin_shape(&plain, &s, 0.2, 1);
  stages_snap(&plain);
  bool *all = malloc(plain.layer.vertex_count);
  memset(all, true, plain.layer.vertex_count);
  begin(&k, s, 0.2, 1, all);
  assert_int_equal(k.counts.corners_lost, 8);
  assert_int_equal(k.counts.crease_vertices, 0);
  assert_memory_equal(k.s.layer.position, plain.layer.position, plain.layer.vertex_count * sizeof *plain.layer.position);
  free(all);
  end(&k);
  stages_end(&plain);
}

static void threads_make_no_difference(void **state) {
  (void)state;
  kept one, three;
  begin(&one, shape_ell(), 0.12, 1, NULL);
  begin(&three, shape_ell(), 0.12, 3, NULL);
  const size_t count = one.s.layer.vertex_count;
  assert_int_equal(count, three.s.layer.vertex_count);
  assert_memory_equal(one.s.layer.position, three.s.layer.position, count * sizeof *one.s.layer.position);
  for (size_t v = 0; v < count; v++) {
    if (one.s.layer.depth[v] != 0) continue;
    assert_int_equal(one.s.layer.hold[v].kind, three.s.layer.hold[v].kind);
    assert_int_equal(one.s.layer.hold[v].id, three.s.layer.hold[v].id);
  }
  end(&one);
  end(&three);
}

/* Ten times too coarse for its letters: nothing breaks, and what is lost is counted. */
static void crowded_features_are_counted(void **state) {
  (void)state;
  kept k;
  shape s = shape_box((const double[]){0, 0, 0}, (const double[]){1, 1, 1}, 2);
  for (int i = 0; i < 3; i++) { /* small boxes beside one another, on top */
    shape tooth = shape_box((const double[]){0.2 + 0.06 * i, 0.2, 0.9}, (const double[]){0.23 + 0.06 * i, 0.8, 1.03}, 1);
    shape_append(&s, &tooth);
    shape_free(&tooth);
  }
  begin(&k, s, 0.15, 1, NULL);
  assert_positive(&k.s.layer);
  laves__feature_tally tally;
  assert_int_equal(laves__tally_features(&k.s.frame, &k.s.layer, &tally, NULL), LAVES_OK);
  assert_true(tally.has_lost);
  assert_true(tally.kept_length < tally.length);
  end(&k);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_cube_is_kept),
      cmocka_unit_test(closed_creases_are_kept),
      cmocka_unit_test(notches_are_kept),
      cmocka_unit_test(a_smooth_solid_is_left_alone),
      cmocka_unit_test(free_vertices_are_held_to_nothing),
      cmocka_unit_test(threads_make_no_difference),
      cmocka_unit_test(crowded_features_are_counted),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
