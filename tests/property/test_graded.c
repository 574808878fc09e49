/* The graded background: whatever the field, tetrahedra of twelve shapes, conforming, as large as wished. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "background/c15_table.h"
#include "fixtures/stages.h"
#include "graded/graded.h"
#include "mesh/mesh.h"

enum { SPOTS = 8, SHAPES = 12 };

/* Small sizes around a few spots, growing outwards. */
typedef struct spots {
  laves__vec3 centre[SPOTS];
  double size[SPOTS], radius[SPOTS], growth, largest;
} spots;

static double wish(const spots *s, laves__vec3 p) {
  double least = s->largest;
  for (int k = 0; k < SPOTS; k++)
    least = fmin(least, s->size[k] + s->growth * fmax(0, v3_distance(p, s->centre[k]) - s->radius[k]));
  return least;
}

static void wish_all(const void *self, size_t count, const laves__vec3 *points, double *sizes) {
  for (size_t i = 0; i < count; i++) sizes[i] = wish(self, points[i]);
}

static double random_unit(uint64_t *seed) {
  *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (double)(*seed >> 11) / 9007199254740992.0;
}

static spots random_spots(uint64_t seed, double growth) {
  spots s = {.growth = growth, .largest = 2};
  for (int k = 0; k < SPOTS; k++) {
    s.centre[k] = v3(16 * random_unit(&seed) - 8, 16 * random_unit(&seed) - 8, 16 * random_unit(&seed) - 8);
    s.size[k] = exp2(-3 * random_unit(&seed));
    s.radius[k] = s.size[k] * 10 * random_unit(&seed);
  }
  return s;
}

static void make(laves_context *context, const char *solid, const spots *s, laves__graph *graph) {
  laves_domain *domain;
  laves_error error = {.text = ""};
  assert_int_equal(laves_domain_from_expression(context, solid, &domain, &error), LAVES_OK);
  const laves__frame frame = {
      .oracle = &domain->oracle, .rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, .size = 1, .centre = {0, 0, 0}};
  const laves__demand demand = {.self = s, .evaluate = wish_all, .grading = s->growth, .smallest = 0.12, .largest = s->largest};
  laves__octree tree;
  memset(graph, 0, sizeof *graph);
  if (laves__graded_background(&frame, &demand, context, &tree, graph, &error) != LAVES_OK) fail_msg("%s", error.text);
  laves__octree_free(&tree);
  laves_domain_free(domain);
}

/* Squared edge lengths, ascending, up to a power of four: every shape there is. docs/graded.md has the same table. */
static const struct {
  int length2[6];
  laves__tile tile;
  double min_dihedral, max_dihedral, volume_length;
} table[SHAPES] = {
    {{2, 2, 2, 2, 2, 2}, LAVES__TILE_C15, 70.528, 70.529, 1.0},
    {{8, 8, 8, 11, 11, 11}, LAVES__TILE_C15, 67.114, 74.207, 0.966},
    {{8, 11, 11, 11, 11, 12}, LAVES__TILE_C15, 60, 73.222, 0.974},
    {{3, 3, 3, 3, 4, 4}, LAVES__TILE_BCC, 60, 90, 0.930},
    {{3, 3, 3, 4, 4, 8}, LAVES__TILE_OTHER, 45, 120, 0.665},
    {{1, 2, 2, 3, 3, 4}, LAVES__TILE_OTHER, 45, 90, 0.716},
    {{1, 1, 1, 2, 2, 3}, LAVES__TILE_OTHER, 45, 90, 0.657},
    {{8, 19, 19, 19, 19, 32}, LAVES__TILE_OTHER, 50.478, 86.628, 0.799},
    {{11, 16, 16, 19, 19, 32}, LAVES__TILE_OTHER, 61.839, 95.740, 0.831},
    {{8, 11, 11, 16, 19, 19}, LAVES__TILE_OTHER, 53.130, 81.427, 0.864},
    {{11, 11, 12, 12, 16, 19}, LAVES__TILE_OTHER, 58.909, 90, 0.912},
    {{8, 8, 8, 19, 19, 19}, LAVES__TILE_OTHER, 63.821, 78.579, 0.798},
};

static int by_value(const void *left, const void *right) {
  const double a = *(const double *)left, b = *(const double *)right;
  return a < b ? -1 : a > b;
}

/* The row of a tet's shape, or -1. */
static int shape_of(const laves__vec3 p[4]) {
  double length2[6];
  for (int e = 0; e < 6; e++) length2[e] = v3_norm2(v3_sub(p[laves__tet_edge[e][0]], p[laves__tet_edge[e][1]]));
  qsort(length2, 6, sizeof *length2, by_value);
  for (int row = 0; row < SHAPES; row++) {
    bool same = true;
    for (int e = 1; e < 6; e++)
      same &= fabs(length2[e] / length2[0] - (double)table[row].length2[e] / table[row].length2[0]) < 1e-9;
    if (same) return row;
  }
  return -1;
}

static laves_mesh *mesh_of(laves_context *context, const laves__graph *g) {
  laves_mesh *mesh;
  assert_int_equal(
      laves_mesh_from_arrays(context, &g->position->x, g->vertex_count, &g->tet[0][0], g->tet_count, NULL, &mesh, NULL),
      LAVES_OK);
  return mesh;
}

static void every_tet_has_one_of_twelve_shapes(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  size_t seen[SHAPES] = {0};
  for (uint64_t seed = 1; seed <= 3; seed++) {
    const spots s = random_spots(seed, 0.15 + 0.1 * (double)(seed % 4));
    laves__graph g;
    make(context, "box(16)", &s, &g);
    for (size_t t = 0; t < g.tet_count; t++) {
      laves__vec3 p[4];
      for (int k = 0; k < 4; k++) p[k] = g.position[g.tet[t][k]];
      const int row = shape_of(p);
      if (row < 0) fail_msg("seed %d: tet %zu has none of the shapes", (int)seed, t);
      if (g.tile[t] != table[row].tile) {
        /* Halves of the stars of sites that stay look like tiles, but are not told apart: only tiles may be called so. */
        assert_int_equal(g.tile[t], LAVES__TILE_OTHER);
      }
      seen[row]++;
    }
    laves__graph_free(&g);
  }
  for (int row = 0; row < SHAPES; row++)
    if (seen[row] == 0) fail_msg("shape %d was never seen", row);
  laves_context_free(context);
}

/* The angles of the table, measured, are those that the theorem tells: all within 45 and 120 degrees. */
static void the_table_of_shapes_is_right(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  const spots s = random_spots(3, 0.3);
  laves__graph g;
  make(context, "box(16)", &s, &g);
  double least[SHAPES], most[SHAPES];
  for (int row = 0; row < SHAPES; row++) {
    least[row] = 180;
    most[row] = 0;
  }
  for (size_t t = 0; t < g.tet_count; t++) {
    laves__vec3 p[4];
    for (int k = 0; k < 4; k++) p[k] = g.position[g.tet[t][k]];
    const int row = shape_of(p);
    for (int e = 0; row >= 0 && e < 6; e++) {
      const laves__vec3 a = p[laves__tet_edge[e][0]], ab = v3_sub(p[laves__tet_edge[e][1]], a);
      const laves__vec3 m = v3_cross(ab, v3_sub(p[laves__tet_edge[5 - e][0]], a));
      const laves__vec3 n = v3_cross(ab, v3_sub(p[laves__tet_edge[5 - e][1]], a));
      const double angle = acos(v3_dot(m, n) / (v3_norm(m) * v3_norm(n))) * 180 / M_PI;
      least[row] = fmin(least[row], angle);
      most[row] = fmax(most[row], angle);
    }
  }
  for (int row = 0; row < SHAPES; row++) {
    if (most[row] == 0) continue;
    assert_true(fabs(least[row] - table[row].min_dihedral) < 2e-3);
    assert_true(fabs(most[row] - table[row].max_dihedral) < 2e-3);
    assert_true(least[row] > 45 - 1e-9 && most[row] < 120 + 1e-9);
  }
  laves__graph_free(&g);
  laves_context_free(context);
}

static void meshes_are_conforming(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  for (uint64_t seed = 11; seed <= 12; seed++) {
    const spots s = random_spots(seed, 0.3);
    laves__graph g;
    make(context, seed % 2 ? "box(14)" : "sphere(7)", &s, &g);
    laves_mesh *mesh = mesh_of(context, &g);
    laves_check check;
    assert_int_equal(laves_check_mesh(context, mesh, NULL, &check, NULL), LAVES_OK);
    assert_int_equal(check.inverted_tets, 0);
    assert_int_equal(check.nonconforming_faces, 0);
    assert_true(check.volume > 4.0 / 3 * M_PI * 343); /* the solid is covered */
    laves_mesh_free(mesh);
    laves__graph_free(&g);
  }
  laves_context_free(context);
}

static void edges_are_as_long_as_wished(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  for (uint64_t seed = 21; seed <= 22; seed++) {
    const spots s = random_spots(seed, 0.3);
    laves__graph g;
    make(context, "box(16)", &s, &g);
    double *ratio = malloc(6 * g.tet_count * sizeof *ratio);
    size_t count = 0;
    for (size_t t = 0; t < g.tet_count; t++)
      for (int e = 0; e < 6; e++) {
        const laves__vec3 a = g.position[g.tet[t][laves__tet_edge[e][0]]], b = g.position[g.tet[t][laves__tet_edge[e][1]]];
        const laves__vec3 middle = v3_lerp(a, b, 0.5);
        if (fabs(middle.x) > 8 || fabs(middle.y) > 8 || fabs(middle.z) > 8) continue;
        ratio[count++] = v3_distance(a, b) / fmax(0.12, wish(&s, middle));
      }
    qsort(ratio, count, sizeof *ratio, by_value);
    if (ratio[count / 20] < 0.6 || ratio[count - count / 20] > 1.5)
      fail_msg("seed %d: 5 to 95 %% of the edges are %.2f to %.2f of what was wished", (int)seed, ratio[count / 20],
               ratio[count - count / 20]);
    free(ratio);
    laves__graph_free(&g);
  }
  laves_context_free(context);
}

static void a_uniform_wish_gives_the_uniform_tiling(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  spots s = {.growth = 0.3, .largest = 1};
  for (int k = 0; k < SPOTS; k++) s.size[k] = 1;
  laves__graph g;
  make(context, "box(20)", &s, &g);
  size_t tiles = 0, inside = 0;
  for (size_t t = 0; t < g.tet_count; t++) {
    const laves__vec3 p = g.position[g.tet[t][0]];
    if (fabs(p.x) > 8 || fabs(p.y) > 8 || fabs(p.z) > 8) continue;
    inside++;
    tiles += g.tile[t] == LAVES__TILE_C15;
    for (int k = 0; k < 4; k++) { /* the vertices are sites of the tiling */
      const laves__vec3 q = g.position[g.tet[t][k]];
      const double quarter[3] = {q.x * LAVES__C15_MEAN_EDGE, q.y * LAVES__C15_MEAN_EDGE, q.z * LAVES__C15_MEAN_EDGE};
      bool found = false;
      for (int site = 0; site < LAVES__C15_SITES && !found; site++) {
        found = true;
        for (int axis = 0; axis < 3; axis++) {
          const double from = (quarter[axis] - laves__c15_site[site][axis]) / LAVES__C15_PERIOD;
          found &= fabs(from - round(from)) < 1e-9;
        }
      }
      assert_true(found);
    }
  }
  assert_true(inside > 10000);
  assert_int_equal(tiles, inside);
  laves__graph_free(&g);
  laves_context_free(context);
}

static void threads_do_not_matter(void **state) {
  (void)state;
  const spots s = random_spots(31, 0.3);
  laves__graph g[2];
  laves_context *context[2];
  for (int i = 0; i < 2; i++) {
    laves_context_options options = laves_context_options_default();
    options.thread_count = i == 0 ? 1 : 3;
    context[i] = laves_context_create(&options);
    make(context[i], "sphere(7)", &s, &g[i]);
  }
  assert_int_equal(g[0].vertex_count, g[1].vertex_count);
  assert_int_equal(g[0].tet_count, g[1].tet_count);
  assert_memory_equal(g[0].tet, g[1].tet, g[0].tet_count * sizeof *g[0].tet);
  assert_memory_equal(g[0].position, g[1].position, g[0].vertex_count * sizeof *g[0].position);
  for (int i = 0; i < 2; i++) {
    laves__graph_free(&g[i]);
    laves_context_free(context[i]);
  }
}

static void sizes_beyond_measure_are_refused(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain;
  laves_error error;
  assert_int_equal(laves_domain_from_expression(context, "sphere(100)", &domain, &error), LAVES_OK);
  const laves__frame frame = {.oracle = &domain->oracle, .rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, .size = 1};
  const spots s = random_spots(1, 0.3);
  const laves__demand demand = {.self = &s, .evaluate = wish_all, .grading = 0.3, .smallest = 1e-9, .largest = 1};
  laves__graph g = {0};
  laves__octree tree;
  assert_int_equal(laves__graded_background(&frame, &demand, context, &tree, &g, &error), LAVES_ERROR_OPTION);
  laves__octree_free(&tree);
  laves__graph_free(&g);
  laves_domain_free(domain);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_tet_has_one_of_twelve_shapes),
      cmocka_unit_test(the_table_of_shapes_is_right),
      cmocka_unit_test(meshes_are_conforming),
      cmocka_unit_test(edges_are_as_long_as_wished),
      cmocka_unit_test(a_uniform_wish_gives_the_uniform_tiling),
      cmocka_unit_test(threads_do_not_matter),
      cmocka_unit_test(sizes_beyond_measure_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
