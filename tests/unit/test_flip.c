/* Flips by their promises: what is touched gets better, space stays filled, stars stay right. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/stages.h"
#include "improve/flip.h"

static const laves__window window = {.min_dihedral = 40, .max_dihedral = 125};

/* A layer whose vertices all move, of the given tets; nothing is on the surface. */
static void make_layer(laves_context *context, const laves__vec3 *points, size_t vertices, const int32_t (*tets)[4], size_t count,
                       size_t spare, laves__layer *layer) {
  const laves__measure m = laves__measure_of(&window);
  assert_int_equal(laves__layer_create(context, vertices, count, layer, NULL), LAVES_OK);
  for (size_t v = 0; v < vertices; v++) {
    layer->position[v] = points[v];
    layer->depth[v] = 1;
    layer->origin[v] = LAVES__NO_ORIGIN;
    layer->hint[v] = LAVES__NO_HINT;
  }
  memcpy(layer->tet, tets, count * sizeof *tets);
  assert_int_equal(laves__layer_link(layer, NULL), LAVES_OK);
  assert_true(laves__layer_extend(layer, spare));
  for (size_t t = 0; t < count; t++) layer->quality[t] = laves__layer_quality(&m, layer, (int32_t)t);
}

static double volume_of(const laves__layer *l, size_t *alive) {
  double sum = 0;
  *alive = 0;
  for (size_t t = 0; t < l->tet_count; t++) {
    if (l->tet[t][0] < 0) continue;
    laves__vec3 p[4];
    laves__layer_points(l, (int32_t)t, p);
    const double volume = v3_det(p[0], p[1], p[2], p[3]);
    assert_true(volume > 0);
    sum += volume / 6;
    ++*alive;
  }
  return sum;
}

static void assert_stars_right(const laves__layer *l) {
  for (size_t v = 0; v < l->vertex_count; v++) {
    int count = 0;
    for (size_t t = 0; t < l->tet_count; t++) count += l->tet[t][0] >= 0 && laves__layer_corner(l, (int32_t)t, (int32_t)v) >= 0;
    if (!laves__layer_moves(l, (int32_t)v)) continue;
    assert_int_equal(l->star[v].count, count);
    for (int i = 0; i < l->star[v].count; i++) assert_true(laves__layer_corner(l, l->star[v].tet[i], (int32_t)v) >= 0);
  }
}

/* `count` points on a circle of radius 1 about an edge of the given length. */
static size_t ring_of_tets(int count, double length, laves__vec3 *points, int32_t (*tets)[4]) {
  points[0] = v3(0, 0, -length / 2);
  points[1] = v3(0, 0, length / 2);
  for (int k = 0; k < count; k++) {
    const double angle = 2 * 3.14159265358979 * k / count;
    points[2 + k] = v3(cos(angle), sin(angle), 0);
    tets[k][0] = 0;
    tets[k][1] = 1;
    tets[k][2] = 2 + k;
    tets[k][3] = 2 + (k + 1) % count;
  }
  return (size_t)count;
}

/* Three tets around a long edge are two better ones without it; two flat ones at a face are three around an edge. */
static void edges_and_faces_are_exchanged(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  const laves__measure m = laves__measure_of(&window);
  laves__journal journal = {.context = context};
  for (int round = 0; round < 2; round++) {
    laves__vec3 points[5];
    int32_t tets[3][4];
    laves__layer layer;
    size_t count = ring_of_tets(3, round == 0 ? 2.6 : 0.5, points, tets), alive;
    if (round == 1) { /* the two tets at the face between the ring's points */
      const int32_t two[2][4] = {{0, 2, 3, 4}, {1, 2, 4, 3}};
      memcpy(tets, two, sizeof two);
      count = 2;
      points[0].z = -0.25;
      points[1].z = 0.25;
    }
    make_layer(context, points, 5, (const int32_t(*)[4])tets, count, 2, &layer);
    const double before = volume_of(&layer, &alive);
    const int32_t spare[2] = {(int32_t)count, (int32_t)count + 1};
    laves__slots slots = {spare, 2};
    assert_true(laves__flip_tet(NULL, &m, &layer, 0, &slots, &journal));
    const double after = volume_of(&layer, &alive);
    assert_true(fabs(after - before) < 1e-12);
    assert_int_equal(alive, round == 0 ? 2 : 3);
    assert_stars_right(&layer);
    /* and back */
    laves__journal_undo(&journal, &layer);
    assert_true(fabs(volume_of(&layer, &alive) - before) < 1e-12);
    assert_int_equal(alive, count);
    assert_stars_right(&layer);
    laves__layer_free(&layer);
  }
  laves__journal_free(&journal);
  laves_context_free(context);
}

/* Rings of all lengths: what comes fills the same space, and needs the dead tets that it says. */
static void rings_are_filled_anew(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  const laves__measure m = laves__measure_of(&window);
  laves__journal journal = {.context = context};
  for (int length = 3; length <= 8; length++) {
    laves__vec3 points[10];
    int32_t tets[8][4];
    laves__layer layer;
    const size_t count = ring_of_tets(length, 0.2, points, tets);
    points[0].z = -1.3; /* so that no ring is good with its edge, and all are better without */
    points[1].z = 1.1;
    for (int k = 0; k < length; k++) points[2 + k].z = 0.05 * (k % 2);
    make_layer(context, points, 2 + (size_t)length, (const int32_t(*)[4])tets, count, 8, &layer);
    size_t alive;
    const double volume = volume_of(&layer, &alive);
    double worst = HUGE_VAL, now = HUGE_VAL;
    for (size_t t = 0; t < count; t++) worst = fmin(worst, layer.quality[t]);
    int32_t spare[8];
    for (int i = 0; i < 8; i++) spare[i] = (int32_t)count + i;
    laves__slots slots = {spare, 8};
    if (laves__flip_tet(NULL, &m, &layer, 0, &slots, &journal)) {
      for (size_t t = 0; t < layer.tet_count; t++) {
        if (layer.tet[t][0] < 0) continue;
        assert_true(layer.quality[t] == laves__layer_quality(&m, &layer, (int32_t)t));
        now = fmin(now, layer.quality[t]);
      }
      assert_true(now > worst);
    }
    assert_true(fabs(volume_of(&layer, &alive) - volume) < 1e-12);
    assert_int_equal(8 - slots.count, alive > count ? alive - count : 0);
    assert_stars_right(&layer);
    laves__layer_free(&layer);
  }
  laves__journal_free(&journal);
  laves_context_free(context);
}

/* All of a real layer: the worst never falls, the boundary stays closed. */
static void layers_get_better(void **state) {
  (void)state;
  stages s;
  stages_begin(&s, "torus(1, 0.4)", 0.15, 0);
  stages_snap(&s);
  laves__layer *l = &s.layer;
  const laves__measure m = laves__measure_of(&window);
  laves__journal journal = {.context = s.context};
  size_t alive;
  const size_t count = l->tet_count;
  assert_true(laves__layer_extend(l, 4000));
  int32_t *spare = malloc(4000 * sizeof *spare);
  for (int32_t i = 0; i < 4000; i++) spare[i] = (int32_t)count + i;
  laves__slots slots = {spare, 4000};
  double worst = HUGE_VAL, volume = volume_of(l, &alive);
  for (size_t t = 0; t < count; t++) {
    l->quality[t] = laves__layer_quality(&m, l, (int32_t)t);
    worst = fmin(worst, l->quality[t]);
  }
  size_t flips = 0;
  for (int32_t t = 0; t < (int32_t)l->tet_count; t++)
    if (l->tet[t][0] >= 0 && l->quality[t] < 1) flips += laves__flip_tet(&s.frame, &m, l, t, &slots, &journal);
  assert_true(flips > 0);
  for (size_t t = 0; t < l->tet_count; t++) {
    if (l->tet[t][0] < 0) continue;
    assert_true(l->quality[t] == laves__layer_quality(&m, l, (int32_t)t));
    assert_true(l->quality[t] >= worst);
  }
  assert_true(fabs(volume_of(l, &alive) / volume - 1) < 0.01); /* boundary edges that were exchanged change a little */
  free(spare);
  laves__journal_free(&journal);
  stages_end(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(edges_and_faces_are_exchanged),
      cmocka_unit_test(rings_are_filled_anew),
      cmocka_unit_test(layers_get_better),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
