/* Improvement by its promises: the worst never falls, what is frozen stays, what is on the surface stays there, and what is
 * undone is exactly as it was. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/predicates.h"
#include "fixtures/stages.h"
#include "improve/contract.h"
#include "improve/smooth.h"

static const laves__window window = {.min_dihedral = 40, .max_dihedral = 125, .volume_length = 0.6};
static const char *const solids[] = {"sphere(1)", "torus(1, 0.4) - box(0.5)", "sphere(1) - sphere(0.8)"};

static void measure_all(const laves__measure *m, laves__layer *l) {
  for (size_t t = 0; t < l->tet_count; t++)
    if (l->tet[t][0] >= 0) l->quality[t] = laves__layer_quality(m, l, (int32_t)t);
}

static double worst_of_layer(const laves__layer *l) {
  double worst = HUGE_VAL;
  for (size_t t = 0; t < l->tet_count; t++)
    if (l->tet[t][0] >= 0) worst = fmin(worst, l->quality[t]);
  return worst;
}

static void assert_on_surface(const stages *s) {
  const laves__layer *l = &s->layer;
  for (size_t v = 0; v < l->vertex_count; v++) {
    if (l->depth[v] != 0 || l->off_surface[v] || l->star[v].count == 0) continue;
    double phi;
    laves__frame_evaluate(&s->frame, 1, &l->position[v], &phi, NULL);
    assert_true(fabs(phi) < 1e-6);
  }
}

static void assert_qualities_current(const laves__measure *m, const laves__layer *l) {
  for (size_t t = 0; t < l->tet_count; t++)
    if (l->tet[t][0] >= 0) assert_true(l->quality[t] == laves__layer_quality(m, l, (int32_t)t));
}

/* Vertices less edges plus faces less tets, of what lives in the layer: contraction must keep it. Boundary faces and their
 * edges give the surface's own number. */
static int64_t surface_euler(const laves__layer *l) {
  int64_t faces = 0, vertices = 0;
  bool *used = calloc(l->vertex_count, 1);
  for (size_t t = 0; t < l->tet_count; t++)
    for (int k = 0; k < 4 && l->tet[t][0] >= 0; k++) {
      if (!laves__layer_is_boundary_face(l, (int32_t)t, k)) continue;
      faces++;
      for (int j = 0; j < 4; j++)
        if (j != k) used[l->tet[t][j]] = true;
    }
  for (size_t v = 0; v < l->vertex_count; v++) vertices += used[v];
  free(used);
  return vertices - faces / 2; /* three edges for two faces */
}

static void smoothing_never_lowers_the_worst(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++) {
    stages s;
    stages_begin(&s, solids[i], 0.13, 0);
    stages_snap(&s);
    const laves__measure m = laves__measure_of(&window);
    measure_all(&m, &s.layer);
    int moved = 0;
    for (size_t v = 0; v < s.layer.vertex_count; v++) {
      if (!laves__layer_moves(&s.layer, (int32_t)v)) continue;
      const double before = laves__star_quality(&s.layer, (int32_t)v);
      const laves__vec3 place = s.layer.position[v];
      if (laves__smooth_vertex(&s.frame, &m, 1, &s.layer, (int32_t)v, NULL)) {
        moved++;
        assert_true(laves__star_quality(&s.layer, (int32_t)v) > before);
      } else {
        assert_memory_equal(&place, &s.layer.position[v], sizeof place);
        assert_true(laves__star_quality(&s.layer, (int32_t)v) == before);
      }
    }
    assert_true(moved > 20);
    assert_qualities_current(&m, &s.layer);
    assert_on_surface(&s);
    stages_end(&s);
  }
}

/* A copy of all that an operation may change. */
typedef struct snapshot {
  laves__vec3 *position, *normal;
  uint32_t *hint;
  bool *off_surface;
  int32_t (*tet)[4];
  double *quality;
  int32_t *stars; /* counts and contents */
  size_t star_words;
} snapshot;

static void *copy_of(const void *block, size_t bytes) { return memcpy(malloc(bytes ? bytes : 1), block, bytes); }

static size_t write_stars(const laves__layer *l, int32_t *words) {
  size_t n = 0;
  for (size_t v = 0; v < l->vertex_count; v++) {
    if (words) words[n] = l->star[v].count;
    n++;
    for (int i = 0; i < l->star[v].count; i++, n++)
      if (words) words[n] = l->star[v].tet[i];
  }
  return n;
}

static snapshot take(const laves__layer *l) {
  snapshot s = {copy_of(l->position, l->vertex_count * sizeof *l->position),
                copy_of(l->normal, l->vertex_count * sizeof *l->normal),
                copy_of(l->hint, l->vertex_count * sizeof *l->hint),
                copy_of(l->off_surface, l->vertex_count * sizeof *l->off_surface),
                copy_of(l->tet, l->tet_count * sizeof *l->tet),
                copy_of(l->quality, l->tet_count * sizeof *l->quality),
                NULL,
                write_stars(l, NULL)};
  s.stars = malloc(s.star_words * sizeof *s.stars);
  write_stars(l, s.stars);
  return s;
}

static bool is_unchanged(const snapshot *s, const laves__layer *l) {
  if (memcmp(s->position, l->position, l->vertex_count * sizeof *l->position) != 0 ||
      memcmp(s->normal, l->normal, l->vertex_count * sizeof *l->normal) != 0 ||
      memcmp(s->hint, l->hint, l->vertex_count * sizeof *l->hint) != 0 ||
      memcmp(s->off_surface, l->off_surface, l->vertex_count * sizeof *l->off_surface) != 0 ||
      memcmp(s->tet, l->tet, l->tet_count * sizeof *l->tet) != 0 ||
      memcmp(s->quality, l->quality, l->tet_count * sizeof *l->quality) != 0 || write_stars(l, NULL) != s->star_words)
    return false;
  int32_t *now = malloc(s->star_words * sizeof *now);
  write_stars(l, now);
  const bool same = memcmp(now, s->stars, s->star_words * sizeof *now) == 0;
  free(now);
  return same;
}

static void forget(snapshot *s) {
  free(s->position);
  free(s->normal);
  free(s->hint);
  free(s->off_surface);
  free(s->tet);
  free(s->quality);
  free(s->stars);
}

static void undone_smoothing_leaves_no_trace(void **state) {
  (void)state;
  stages s;
  stages_begin(&s, "torus(1, 0.4)", 0.2, 0);
  stages_snap(&s);
  const laves__measure m = laves__measure_of(&window);
  measure_all(&m, &s.layer);
  snapshot before = take(&s.layer);
  laves__journal journal = {.context = s.context};
  int moved = 0;
  for (size_t v = 0; v < s.layer.vertex_count; v++)
    if (laves__layer_moves(&s.layer, (int32_t)v))
      moved += laves__smooth_vertex(&s.frame, &m, 1.2, &s.layer, (int32_t)v, &journal);
  assert_true(moved > 50);
  assert_false(is_unchanged(&before, &s.layer));
  laves__journal_undo(&journal, &s.layer);
  assert_true(is_unchanged(&before, &s.layer));
  laves__journal_free(&journal);
  forget(&before);
  stages_end(&s);
}

/* Every tet is offered: what is refused leaves no trace, what is done raises the worst and keeps the surface closed. */
static void contraction_helps_or_leaves_no_trace(void **state) {
  (void)state;
  stages s;
  stages_begin(&s, "torus(1, 0.4)", 0.21, 0);
  stages_snap(&s);
  const laves__measure m = laves__measure_of(&window);
  laves__layer *l = &s.layer;
  measure_all(&m, l);
  laves__journal journal = {.context = s.context};
  snapshot before = take(l);
  int done = 0, refused = 0;
  assert_int_equal(surface_euler(l), 0);
  for (size_t t = 0; t < l->tet_count; t++) {
    if (l->tet[t][0] < 0 || l->quality[t] > 0.9) continue;
    const double worst = worst_of_layer(l);
    if (laves__contract_tet(&s.frame, &m, 1, l, (int32_t)t, 1, &journal)) {
      done++;
      assert_true(worst_of_layer(l) >= worst);
      assert_int_equal(surface_euler(l), 0);
      forget(&before);
      before = take(l);
    } else {
      refused++;
      assert_true(is_unchanged(&before, l));
    }
  }
  assert_true(done > 3 && refused > 3);
  assert_qualities_current(&m, l);
  assert_on_surface(&s);
  for (size_t t = 0; t < l->tet_count; t++) {
    if (l->tet[t][0] < 0) continue;
    laves__vec3 p[4];
    laves__layer_points(l, (int32_t)t, p);
    assert_true(laves__orient3d(p[0], p[1], p[2], p[3]) > 0);
  }
  forget(&before);
  laves__journal_free(&journal);
  stages_end(&s);
}

static void the_stage_keeps_its_promises(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++) {
    stages s;
    laves_error error;
    stages_begin(&s, solids[i], 0.11, 2);
    stages_snap(&s);
    laves__layer *l = &s.layer;
    const laves__measure m = laves__measure_of(&window);
    measure_all(&m, l);
    const double worst = worst_of_layer(l);
    const size_t outside = laves__improve_outside(&window, l);
    laves__vec3 *start = copy_of(l->position, l->vertex_count * sizeof *start);
    assert_int_equal(laves__improve(&s.frame, &window, l, &error), LAVES_OK);
    assert_true(worst_of_layer(l) >= worst);
    assert_true(laves__improve_outside(&window, l) < outside);
    for (size_t v = 0; v < l->vertex_count; v++)
      if (!laves__layer_moves(l, (int32_t)v)) assert_memory_equal(&start[v], &l->position[v], sizeof *start);
    assert_qualities_current(&m, l);
    assert_on_surface(&s);
    free(start);
    stages_end(&s);
  }
}

/* 1 on the border of the window, monotone beyond. */
static void quality_is_one_on_the_border(void **state) {
  (void)state;
  const laves__measure m = laves__measure_of(&(laves__window){.min_dihedral = 40, .max_dihedral = 125});
  /* A wedge: dihedral angle `angle` at the edge along z, the others between. */
  double before = 0;
  for (int angle = 20; angle <= 60; angle += 5) {
    const double a = angle * M_PI / 180;
    const laves__vec3 p[4] = {v3(0, 0, -0.6), v3(0, 0, 0.6), v3(1, 0, 0), v3(cos(a), sin(a), 0)};
    const double q = laves__quality(&m, p, 1, 0);
    assert_true(q > before);
    if (angle == 40) assert_true(fabs(q - 1) < 1e-9);
    before = q;
  }
  const laves__vec3 flat[4] = {v3(0, 0, 0), v3(1, 0, 0), v3(0, 1, 0), v3(1, 1, 0)};
  assert_true(laves__quality(&m, flat, 1, 0) <= 0);
  const laves__vec3 inverted[4] = {v3(0, 0, 0), v3(0, 1, 0), v3(1, 0, 0), v3(0, 0, 1)};
  assert_true(laves__quality(&m, inverted, 1, 0) < 0);
}

/* Many at once have the digits of each alone, whatever the window, and of tets that are squeezed and turned over, too. */
static void batches_have_the_same_digits(void **state) {
  (void)state;
  static const laves__window windows[] = {{.min_dihedral = 40, .max_dihedral = 125, .volume_length = 0.6},
                                          {.min_dihedral = 25, .max_dihedral = 140},
                                          {.min_dihedral = 40, .max_dihedral = 125, .held_min = 30, .held_max = 120}};
  stages s;
  stages_begin(&s, solids[1], 0.2, 0);
  stages_snap(&s);
  laves__layer *l = &s.layer;
  double *together = calloc(l->tet_count, sizeof *together);
  assert_non_null(together);
  assert_true(l->tet_count > 200);
  for (size_t v = 0; v < l->vertex_count; v++)
    if (v % 7 == 0) l->position[v].x += (double)(v % 5) * 0.3 - 0.6;
  l->tet[17][0] = -1;
  for (size_t i = 0; i < LAVES__COUNT_OF(windows); i++) {
    const laves__measure m = laves__measure_of(&windows[i]);
    int flat = 0, standing = 0;
    for (size_t begin = 0; begin < l->tet_count; begin += 150) { /* whole batches and a rest */
      const size_t end = begin + 150 < l->tet_count ? begin + 150 : l->tet_count;
      laves__measure_tets(&m, l, begin, end, together + begin);
    }
    for (size_t t = 0; t < l->tet_count; t++) {
      if (l->tet[t][0] < 0) continue;
      const double alone = laves__layer_quality(&m, l, (int32_t)t);
      assert_true(together[t] == alone);
      flat += alone <= LAVES__FLAT;
      standing += alone > LAVES__FLAT;
    }
    assert_true(flat > 0 && standing > 0);
  }
  free(together);
  stages_end(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(smoothing_never_lowers_the_worst),     cmocka_unit_test(undone_smoothing_leaves_no_trace),
      cmocka_unit_test(contraction_helps_or_leaves_no_trace), cmocka_unit_test(the_stage_keeps_its_promises),
      cmocka_unit_test(quality_is_one_on_the_border),         cmocka_unit_test(batches_have_the_same_digits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
