/* The boundary layer as a mesh: stars, faces, and what it is made of. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/predicates.h"
#include "fixtures/stages.h"

static const char *const solids[] = {"sphere(1)", "torus(1, 0.3)", "box(2, 1.5, 1)", "sphere(1) - sphere(1):move(0.9, 0, 0)"};

static void stars_hold_just_their_tets(void **state) {
  (void)state;
  for (size_t k = 0; k < LAVES__COUNT_OF(solids); k++) {
    stages s;
    stages_begin(&s, solids[k], 0.13, 0);
    stages_snap(&s);
    const laves__layer *l = &s.layer;
    int *count = calloc(l->vertex_count, sizeof *count);
    for (size_t t = 0; t < l->tet_count; t++)
      for (int c = 0; c < 4; c++) count[l->tet[t][c]]++;
    for (size_t v = 0; v < l->vertex_count; v++) {
      const laves__star *star = &l->star[v];
      assert_true(count[v] > 0);
      assert_int_equal(star->count, laves__layer_moves(l, (int32_t)v) ? count[v] : 0);
      for (int i = 0; i < star->count; i++) {
        assert_true(laves__layer_corner(l, star->tet[i], (int32_t)v) >= 0);
        if (i) assert_true(star->tet[i - 1] < star->tet[i]);
      }
    }
    free(count);
    stages_end(&s);
  }
}

/* Faces as sorted triples, to count how many tets hold each. */
typedef struct face {
  int32_t v[3];
  int32_t tet;
  int8_t corner;
} face;

static int compare_faces(const void *left, const void *right) {
  const face *a = left, *b = right;
  for (int i = 0; i < 3; i++)
    if (a->v[i] != b->v[i]) return a->v[i] < b->v[i] ? -1 : 1;
  return 0;
}

static face face_of(const laves__layer *l, int32_t tet, int corner) {
  face f = {.tet = tet, .corner = (int8_t)corner};
  for (int k = 0, n = 0; k < 4; k++)
    if (k != corner) f.v[n++] = l->tet[tet][k];
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2 - i; j++)
      if (f.v[j] > f.v[j + 1]) {
        const int32_t swap = f.v[j];
        f.v[j] = f.v[j + 1];
        f.v[j + 1] = swap;
      }
  return f;
}

static void faces_are_shared_as_a_sort_says(void **state) {
  (void)state;
  for (size_t k = 0; k < LAVES__COUNT_OF(solids); k++) {
    stages s;
    stages_begin(&s, solids[k], 0.17, 0);
    stages_snap(&s);
    const laves__layer *l = &s.layer;
    face *faces = malloc(4 * l->tet_count * sizeof *faces);
    size_t boundary = 0;
    for (size_t t = 0; t < l->tet_count; t++)
      for (int c = 0; c < 4; c++) faces[4 * t + (size_t)c] = face_of(l, (int32_t)t, c);
    qsort(faces, 4 * l->tet_count, sizeof *faces, compare_faces);
    for (size_t i = 0; i < 4 * l->tet_count;) {
      size_t end = i + 1;
      while (end < 4 * l->tet_count && compare_faces(&faces[i], &faces[end]) == 0) end++;
      assert_in_range(end - i, 1, 2);
      bool moves = false, on = true;
      for (int n = 0; n < 3; n++) {
        moves |= laves__layer_moves(l, faces[i].v[n]);
        on &= l->depth[faces[i].v[n]] == 0;
      }
      if (moves) {
        for (size_t f = i; f < end; f++) {
          const int32_t other = end - i == 2 ? faces[f == i ? i + 1 : i].tet : -1;
          assert_int_equal(laves__layer_across(l, faces[f].tet, faces[f].corner), other);
          assert_int_equal(laves__layer_is_boundary_face(l, faces[f].tet, faces[f].corner), other < 0);
        }
        /* A face that moves and has one side is the boundary, and stands on the surface. */
        if (end - i == 1) {
          assert_true(on);
          boundary++;
        }
      }
      i = end;
    }
    assert_true(boundary > 50 && boundary % 2 == 0);
    free(faces);
    stages_end(&s);
  }
}

static void snapped_layers_are_positive_and_on_the_surface(void **state) {
  (void)state;
  for (size_t k = 0; k < LAVES__COUNT_OF(solids); k++) {
    stages s;
    stages_begin(&s, solids[k], 0.11, 0);
    stages_snap(&s);
    const laves__layer *l = &s.layer;
    for (size_t t = 0; t < l->tet_count; t++) {
      laves__vec3 p[4];
      laves__layer_points(l, (int32_t)t, p);
      assert_true(laves__orient3d(p[0], p[1], p[2], p[3]) > 0);
    }
    for (size_t v = 0; v < l->vertex_count; v++) {
      if (l->depth[v] == 0 && !l->off_surface[v]) {
        double phi;
        laves__frame_evaluate(&s.frame, 1, &l->position[v], &phi, NULL);
        assert_true(fabs(phi) < 1e-9);
        assert_true(fabs(v3_norm(l->normal[v]) - 1) < 1e-6);
      } else if (l->depth[v] != 0 && l->origin[v] != LAVES__NO_ORIGIN) {
        const laves__vec3 site =
            laves__site_position(s.lattice.record[l->origin[v] / LAVES__C15_SITES].xyz, (int)(l->origin[v] % LAVES__C15_SITES));
        assert_true(v3_distance(site, l->position[v]) == 0);
      }
    }
    stages_end(&s);
  }
}

/* Every neighbour is at most one deeper, and every depth but 0 has a neighbour one nearer. */
static void depths_count_edges(void **state) {
  (void)state;
  stages s;
  stages_begin(&s, "torus(1, 0.3)", 0.06, 0);
  stages_snap(&s);
  const laves__layer *l = &s.layer;
  uint8_t *nearest = malloc(l->vertex_count);
  memset(nearest, 255, l->vertex_count);
  for (size_t t = 0; t < l->tet_count; t++)
    for (int a = 0; a < 4; a++)
      for (int b = 0; b < 4; b++) {
        const uint8_t depth = l->depth[l->tet[t][b]];
        if (a != b && depth < nearest[l->tet[t][a]]) nearest[l->tet[t][a]] = depth;
      }
  for (size_t v = 0; v < l->vertex_count; v++)
    if (l->depth[v] != 0) assert_int_equal(nearest[v], l->depth[v] - 1);
  free(nearest);
  stages_end(&s);
}

static void stars_grow_and_shrink(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves__star star = {laves__alloc(context, 2, sizeof *star.tet), 0, 2, true};
  for (int32_t t = 0; t < 40; t++) assert_true(laves__star_add(context, &star, t));
  assert_true(star.own_block);
  for (int32_t t = 0; t < 40; t += 2) laves__star_remove(&star, t);
  assert_int_equal(star.count, 20);
  for (int i = 0; i < 20; i++) assert_int_equal(star.tet[i], 2 * i + 1);
  laves__free(context, star.tet, (size_t)star.capacity, sizeof *star.tet);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(stars_hold_just_their_tets),
      cmocka_unit_test(faces_are_shared_as_a_sort_says),
      cmocka_unit_test(snapped_layers_are_positive_and_on_the_surface),
      cmocka_unit_test(depths_count_edges),
      cmocka_unit_test(stars_grow_and_shrink),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
