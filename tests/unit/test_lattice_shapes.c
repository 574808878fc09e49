/* Exact tiles told by their shape: all of a tiling, at any size, turned and far away; and none that was moved. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

#include "background/graph.h"
#include "certify/certify.h"
#include "fixtures/graded.h"
#include "fixtures/meshes.h"

static int set_up(void **state) {
  *state = laves_context_create(NULL);
  return *state == NULL;
}

static int tear_down(void **state) {
  const size_t left = laves_context_bytes(*state);
  laves_context_free(*state);
  return left != 0;
}

static laves_mesh *tiling(laves_context *context, double size) {
  laves_mesh *mesh = NULL;
  assert_int_equal(laves_generate_tiling(context, (const int[3]){3, 3, 3}, size, &mesh, NULL), LAVES_OK);
  return mesh;
}

static laves_certificate tiles_of(laves_context *context, const laves_mesh *mesh) {
  laves_certificate c = {0};
  assert_int_equal(laves__find_tiles(context, mesh, &c, NULL), LAVES_OK);
  return c;
}

static void all_of_a_tiling(void **state) {
  static const double sizes[] = {1, 1e-7, 12345.678};
  for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
    laves_mesh *mesh = tiling(*state, sizes[i]);
    const laves_certificate c = tiles_of(*state, mesh);
    assert_int_equal(c.lattice_tets, mesh->tet_count);
    assert_float_equal(c.lattice_size / sizes[i], 1, 1e-12);
    laves_mesh_free(mesh);
  }
}

/* Turned by a rotation that no axis keeps, and moved to where a coordinate has six digits less. */
static void turned_and_far(void **state) {
  laves_mesh *mesh = tiling(*state, 0.5);
  const laves__mat3 m = {{{2.0 / 3, -1.0 / 3, 2.0 / 3}, {2.0 / 3, 2.0 / 3, -1.0 / 3}, {-1.0 / 3, 2.0 / 3, 2.0 / 3}}};
  for (size_t v = 0; v < mesh->vertex_count; v++) mesh->points[v] = v3_add(m3_mul(&m, mesh->points[v]), v3(1e6, -2e6, 3e5));
  const laves_certificate c = tiles_of(*state, mesh);
  assert_int_equal(c.lattice_tets, mesh->tet_count);
  assert_true(c.lattice_tolerance > 1e-9 && c.lattice_tolerance < 1e-6);
  laves_mesh_free(mesh);
}

/* One vertex moved by a millionth takes exactly its star away. */
static void one_moved_vertex(void **state) {
  laves_mesh *mesh = tiling(*state, 1);
  const int32_t vertex = mesh->tets[mesh->tet_count / 2][0];
  size_t star = 0;
  for (size_t t = 0; t < 4 * mesh->tet_count; t++) star += mesh->tets[t / 4][t % 4] == vertex;
  mesh->points[vertex].x += 1e-6;
  assert_int_equal(tiles_of(*state, mesh).lattice_tets, mesh->tet_count - star);
  laves_mesh_free(mesh);
}

/* Two sizes in one mesh: the common one is the one that more tets have. */
static void two_sizes(void **state) {
  laves_mesh *mesh = tiling(*state, 1);
  laves_mesh *both = laves__mesh_create(*state, 2 * mesh->vertex_count, mesh->tet_count + mesh->tet_count / 3, 0, false, false);
  assert_non_null(both);
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    both->points[v] = v3_scale(mesh->points[v], 1.5);
    both->points[mesh->vertex_count + v] = mesh->points[v];
  }
  for (size_t t = 0; t < both->tet_count; t++)
    for (int i = 0; i < 4; i++) {
      const bool large = t < mesh->tet_count / 3;
      both->tets[t][i] = mesh->tets[large ? t : t - mesh->tet_count / 3][i] + (large ? 0 : (int32_t)mesh->vertex_count);
    }
  const laves_certificate c = tiles_of(*state, both);
  assert_int_equal(c.lattice_tets, mesh->tet_count);
  assert_float_equal(c.lattice_size, 1, 1e-12);
  laves_mesh_free(both);
  laves_mesh_free(mesh);
}

/* ---- several sizes and two lattices ---- */

/* An edge of a face, and the centres of the cubes on both sides of it. */
static laves_mesh *one_bcc_tile(laves_context *context, double quarter) {
  static const double corner[4][3] = {{0, 0, 0}, {4, 0, 0}, {2, 2, -2}, {2, 2, 2}};
  laves_mesh *mesh = laves__mesh_create(context, 4, 1, 0, false, false);
  assert_non_null(mesh);
  for (int i = 0; i < 4; i++) {
    mesh->points[i] = v3(quarter * corner[i][0], quarter * corner[i][1], quarter * corner[i][2]);
    mesh->tets[0][i] = i;
  }
  return mesh;
}

/* The size of a BCC tile is that of the C15 tiles that its cubes would be decorated with. */
static void tile_of_bcc(void **state) {
  laves_mesh *mesh = one_bcc_tile(*state, 1);
  laves_certificate c = tiles_of(*state, mesh);
  assert_int_equal(c.bcc_tets, 1);
  assert_int_equal(c.lattice_tets, 0);
  assert_float_equal(c.lattice_size, 3.184913173150872, 1e-12);
  mesh->points[3].z += 1e-6;
  c = tiles_of(*state, mesh);
  assert_int_equal(c.bcc_tets, 0);
  assert_true(c.lattice_size == 0);
  laves_mesh_free(mesh);
}

/* Copies of a tiling at 1/8, 1/2 and 4 of its size count together, and the size is that of the most. */
static void powers_of_two(void **state) {
  static const double scales[] = {0.125, 0.5, 4};
  laves_mesh *mesh = tiling(*state, 1);
  const size_t n = mesh->vertex_count, all = mesh->tet_count, counts[] = {all / 3, all, all / 2};
  laves_mesh *many = laves__mesh_create(*state, 3 * n, counts[0] + counts[1] + counts[2], 0, false, false);
  assert_non_null(many);
  size_t tet = 0;
  for (size_t copy = 0; copy < 3; copy++) {
    for (size_t v = 0; v < n; v++) many->points[copy * n + v] = v3_scale(mesh->points[v], scales[copy]);
    for (size_t t = 0; t < counts[copy]; t++, tet++)
      for (int i = 0; i < 4; i++) many->tets[tet][i] = mesh->tets[t][i] + (int32_t)(copy * n);
  }
  const laves_certificate c = tiles_of(*state, many);
  assert_int_equal(c.lattice_tets, many->tet_count);
  assert_int_equal(c.bcc_tets, 0);
  assert_float_equal(c.lattice_size, 0.5, 1e-12);
  laves_mesh_free(many);
  laves_mesh_free(mesh);
}

/* No fewer than their maker made; some parts of transitions are shaped like tiles and counted, too. */
static void graded_background(void **state) {
  size_t tiles[3];
  laves_mesh *mesh = fixture_graded(*state, tiles);
  const laves_certificate c = tiles_of(*state, mesh);
  assert_true(tiles[LAVES__TILE_C15] > 0 && tiles[LAVES__TILE_BCC] > 0 && tiles[LAVES__TILE_OTHER] > 0);
  assert_in_range(c.lattice_tets, tiles[LAVES__TILE_C15], tiles[LAVES__TILE_C15] + tiles[LAVES__TILE_OTHER] / 4);
  assert_in_range(c.bcc_tets, tiles[LAVES__TILE_BCC], tiles[LAVES__TILE_BCC] + tiles[LAVES__TILE_OTHER] / 4);
  laves_mesh_free(mesh);
}

/* Kuhn's tets are no tiles; nor is anything that cannot be measured. */
static void none(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 3, 3, 3, NULL, NULL);
  laves_certificate c = tiles_of(*state, mesh);
  assert_int_equal(c.lattice_tets, 0);
  assert_true(c.lattice_size == 0);
  for (size_t v = 0; v < mesh->vertex_count; v++) mesh->points[v] = v3(v % 2 ? NAN : 0, 0, 0);
  c = tiles_of(*state, mesh);
  assert_int_equal(c.lattice_tets, 0);
  laves_mesh_free(mesh);
}

/* Every edge has a right length, but four edges of 11 and one of 12 and 8 stand in wrong places. */
static void right_lengths_in_wrong_places(void **state) {
  laves_mesh *mesh = laves__mesh_create(*state, 4, 1, 0, false, false);
  assert_non_null(mesh);
  /* A face of 8, 12, 11 and an apex with 11, 11, 11: 12 and 8 share a vertex. */
  const double ab = 8, ac = 12, bc = 11, side = sqrt(ab), x = (ab + ac - bc) / (2 * side), y = sqrt(ac - x * x);
  const double u = side / 2, v = (x * x + y * y - 2 * x * u) / (2 * y);
  mesh->points[0] = v3(0, 0, 0);
  mesh->points[1] = v3(side, 0, 0);
  mesh->points[2] = v3(x, y, 0);
  mesh->points[3] = v3(u, v, sqrt(11 - u * u - v * v));
  for (int i = 0; i < 4; i++) mesh->tets[0][i] = i;
  assert_float_equal(v3_distance(mesh->points[3], mesh->points[2]), sqrt(11), 1e-12);
  assert_int_equal(tiles_of(*state, mesh).lattice_tets, 0);
  laves_mesh_free(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(all_of_a_tiling, set_up, tear_down),
      cmocka_unit_test_setup_teardown(turned_and_far, set_up, tear_down),
      cmocka_unit_test_setup_teardown(one_moved_vertex, set_up, tear_down),
      cmocka_unit_test_setup_teardown(two_sizes, set_up, tear_down),
      cmocka_unit_test_setup_teardown(tile_of_bcc, set_up, tear_down),
      cmocka_unit_test_setup_teardown(powers_of_two, set_up, tear_down),
      cmocka_unit_test_setup_teardown(graded_background, set_up, tear_down),
      cmocka_unit_test_setup_teardown(none, set_up, tear_down),
      cmocka_unit_test_setup_teardown(right_lengths_in_wrong_places, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
