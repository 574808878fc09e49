/* The check of a mesh: sound meshes pass with the right figures, and every kind of defect, made on purpose, is caught. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

#include "certify/certify.h"
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

static laves_check check(laves_context *context, const laves_mesh *mesh) {
  laves_check result;
  assert_int_equal(laves_check_mesh(context, mesh, NULL, &result, NULL), LAVES_OK);
  assert_false(result.has_distance);
  return result;
}

/* Checks and frees. */
static laves_check check_once(laves_context *context, laves_mesh *mesh) {
  const laves_check result = check(context, mesh);
  laves_mesh_free(mesh);
  return result;
}

static bool keep_by_mask(void *user, int x, int y, int z) {
  const unsigned *mask = user;
  return *mask >> (x + 3 * y + 9 * z) & 1;
}

/* Cubes of a 3 x 3 x 3 grid whose bit x + 3 y + 9 z is set. */
static laves_mesh *cubes_of_mask(laves_context *context, unsigned mask) {
  return fixture_cubes(context, 3, 3, 3, keep_by_mask, &mask);
}

/* ---- sound meshes ---- */

static void one_block(void **state) {
  const laves_check c = check_once(*state, fixture_cubes(*state, 4, 3, 2, NULL, NULL));
  assert_true(c.valid);
  assert_int_equal(c.vertices, 60);
  assert_int_equal(c.tets, 144);
  assert_int_equal(c.faces, 104);
  assert_int_equal(c.components, 1);
  assert_int_equal(c.boundary_components, 1);
  assert_int_equal(c.genus, 0);
  assert_int_equal(c.unused_vertices, 0);
  assert_float_equal(c.volume, 24, 1e-12);
  assert_float_equal(c.area, 52, 1e-12);
}

/* Kuhn's tet has the angles 45, 45, 60, 90, 90, 90, and R = sqrt(3)/2. */
static void statistics(void **state) {
  const laves_check c = check_once(*state, fixture_cubes(*state, 9, 9, 9, NULL, NULL));
  const size_t tets = 6 * 9 * 9 * 9;
  assert_float_equal(c.min_dihedral.min, 45, 1e-9);
  assert_float_equal(c.min_dihedral.max, 45, 1e-9);
  assert_float_equal(c.min_dihedral.deviation, 0, 1e-6);
  assert_float_equal(c.max_dihedral.mean, 90, 1e-9);
  assert_int_equal(c.histogram[45 / 5], 2 * tets);
  assert_int_equal(c.histogram[60 / 5], tets);
  assert_int_equal(c.histogram[90 / 5], 3 * tets);
  assert_float_equal(c.radius_edge.mean, sqrt(2), 1e-9);
  assert_float_equal(c.volume_length.mean, sqrt(2) / pow(10.0 / 6, 1.5), 1e-9);
  assert_float_equal(c.edge_min, 1, 1e-12);
  assert_float_equal(c.edge_max, sqrt(3), 1e-12);
  const double axis = 3 * 9 * 100, face = 3 * 81 * 10, space = 729; /* edges of each length */
  assert_float_equal(c.edge_mean, (axis + face * sqrt(2) + space * sqrt(3)) / (axis + face + space), 1e-12);
}

/* Two different tets, so that minimum, maximum, mean and deviation differ, and the places are known. */
static void extremes(void **state) {
  const double points[8][3] = {{1, 1, 1}, {1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}, {9, 9, 9}, {10, 9, 9}, {9, 10, 9}, {9, 9, 10}};
  const int32_t tets[2][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}};
  const double corner_ratio = 3 / (3 + sqrt(3)) / (sqrt(3) / 2);
  laves_mesh *mesh;
  assert_int_equal(laves_mesh_from_arrays(*state, points[0], 8, tets[0], 2, NULL, &mesh, NULL), LAVES_OK);
  const laves_check c = check_once(*state, mesh);
  assert_true(c.valid);
  assert_int_equal(c.components, 2);
  assert_float_equal(c.radius_ratio.min, corner_ratio, 1e-12);
  assert_float_equal(c.radius_ratio.max, 1, 1e-12);
  assert_float_equal(c.radius_ratio.mean, (1 + corner_ratio) / 2, 1e-12);
  assert_float_equal(c.radius_ratio.deviation, (1 - corner_ratio) / 2, 1e-12);
  for (int k = 0; k < 3; k++) {
    assert_float_equal(c.radius_ratio_place[k], 9.25, 1e-12);
    assert_float_equal(c.min_dihedral_place[k], 9.25, 1e-12);
    assert_float_equal(c.max_dihedral_place[k], 9.25, 1e-12);
  }
}

static void torus(void **state) {
  const laves_check c = check_once(*state, fixture_ring(*state));
  assert_true(c.valid);
  assert_int_equal(c.genus, 1);
  assert_int_equal(c.boundary_components, 1);
}

static void nested_shells(void **state) {
  const laves_check c = check_once(*state, cubes_of_mask(*state, 0x7ffffff & ~(1u << 13)));
  assert_true(c.valid);
  assert_int_equal(c.components, 1);
  assert_int_equal(c.boundary_components, 2);
  assert_int_equal(c.genus, 0);
  assert_float_equal(c.volume, 26, 1e-12);
  assert_float_equal(c.area, 60, 1e-12);
}

static void two_components(void **state) {
  const laves_check c = check_once(*state, cubes_of_mask(*state, 1u << 0 | 1u << 2));
  assert_true(c.valid);
  assert_int_equal(c.components, 2);
  assert_int_equal(c.boundary_components, 2);
  assert_int_equal(c.genus, 0);
  assert_int_equal(c.unused_vertices, 64 - 16);
}

static void nothing(void **state) {
  laves_mesh *mesh = laves__mesh_create(*state, 0, 0, 0, false, false);
  const laves_check c = check_once(*state, mesh);
  assert_true(c.valid);
  assert_int_equal(c.components, 0);
}

/* The stored faces may come in another order and rotation. */
static void order_of_faces_is_free(void **state) {
  laves_mesh *mesh = fixture_ring(*state);
  for (size_t i = 0; i < mesh->face_count / 2; i++) {
    int32_t *a = mesh->faces[i], *b = mesh->faces[mesh->face_count - 1 - i];
    const int32_t old[3] = {a[0], a[1], a[2]}, turned[3] = {b[1], b[2], b[0]};
    memcpy(a, turned, sizeof turned);
    memcpy(b, old, sizeof old);
  }
  assert_true(check_once(*state, mesh).valid);
}

/* ---- defects ---- */

static void inverted_tet(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 2, 2, 2, NULL, NULL);
  const int32_t swap = mesh->tets[7][0];
  mesh->tets[7][0] = mesh->tets[7][1];
  mesh->tets[7][1] = swap;
  const laves_check c = check_once(*state, mesh);
  assert_false(c.valid);
  assert_int_equal(c.inverted_tets, 1);
}

static void flat_tet(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 1, 1, 1, NULL, NULL);
  mesh->points[1] = mesh->points[0]; /* edge 0-1 of two tets */
  const laves_check c = check_once(*state, mesh);
  assert_false(c.valid);
  assert_int_equal(c.inverted_tets, 2);
  assert_true(isfinite(c.radius_edge.max) && isfinite(c.min_dihedral.mean));
}

/* A vertex pulled through its neighbours turns tets over: the sides of their faces tell too. */
static void folded(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 2, 2, 2, NULL, NULL);
  mesh->points[13] = v3(-3, 1, 1);
  const laves_check c = check_once(*state, mesh);
  assert_false(c.valid);
  assert_true(c.inverted_tets > 0);
  assert_true(c.nonconforming_faces > 0);
}

static void doubled_tet(void **state) {
  laves_mesh *ring = fixture_ring(*state), *mesh;
  const size_t count = ring->tet_count;
  int32_t(*tets)[4] = laves__alloc(*state, count + 1, sizeof *tets);
  memcpy(tets, ring->tets, count * sizeof *tets);
  memcpy(tets[count], tets[3], sizeof *tets);
  assert_int_equal(laves_mesh_from_arrays(*state, &ring->points->x, ring->vertex_count, tets[0], count + 1, NULL, &mesh, NULL),
                   LAVES_OK);
  const laves_check c = check_once(*state, mesh);
  assert_false(c.valid);
  assert_int_equal(c.inverted_tets, 0);
  assert_true(c.nonconforming_faces >= 4);
  laves__free(*state, tets, count + 1, sizeof *tets);
  laves_mesh_free(ring);
}

/* Two tets on one side of their common face. */
static void overlapping_tets(void **state) {
  const double points[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 2}};
  const int32_t tets[2][4] = {{0, 1, 2, 3}, {0, 1, 2, 4}};
  laves_mesh *mesh;
  assert_int_equal(laves_mesh_from_arrays(*state, points[0], 5, tets[0], 2, NULL, &mesh, NULL), LAVES_OK);
  const laves_check c = check_once(*state, mesh);
  assert_false(c.valid);
  assert_int_equal(c.inverted_tets, 0);
  assert_int_equal(c.nonconforming_faces, 1);
}

static void edge_contact(void **state) {
  const laves_check c = check_once(*state, cubes_of_mask(*state, 1u << 0 | 1u << 4)); /* (0,0,0) and (1,1,0) */
  assert_false(c.valid);
  assert_int_equal(c.nonmanifold_edges, 1);
  assert_int_equal(c.components, 2);
}

static void vertex_contact(void **state) {
  const laves_check c = check_once(*state, cubes_of_mask(*state, 1u << 0 | 1u << 13)); /* (0,0,0) and (1,1,1) */
  assert_false(c.valid);
  assert_int_equal(c.nonmanifold_edges, 0);
  assert_int_equal(c.nonmanifold_vertices, 1);
  assert_int_equal(c.components, 2);
}

static void stored_faces_differ(void **state) {
  laves_mesh *mesh = fixture_ring(*state);
  const int32_t swap = mesh->faces[5][0];
  mesh->faces[5][0] = mesh->faces[5][1];
  mesh->faces[5][1] = swap;
  laves_check c = check(*state, mesh);
  assert_false(c.valid);
  assert_int_equal(c.nonconforming_faces, 1);
  memcpy(mesh->faces[5], mesh->faces[6], sizeof *mesh->faces); /* a hole, and a face twice */
  c = check_once(*state, mesh);
  assert_false(c.valid);
  assert_int_equal(c.nonconforming_faces, 1);
}

static void bad_indices(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 2, 2, 2, NULL, NULL);
  mesh->tets[0][1] = 27;
  mesh->tets[1][2] = -1;
  mesh->tets[2][3] = mesh->tets[2][0];
  mesh->tets[3][0] = INT32_MIN;
  mesh->tets[3][3] = INT32_MAX;
  mesh->faces[0][0] = -7; /* of the stored faces no index is trusted either */
  const laves_check c = check_once(*state, mesh);
  assert_false(c.valid);
  assert_int_equal(c.bad_indices, 5);
}

static void points_not_finite(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 2, 2, 2, NULL, NULL);
  mesh->points[0].x = NAN; /* lowest corner of six tets */
  mesh->points[2].y = INFINITY;
  const laves_check c = check_once(*state, mesh);
  assert_false(c.valid);
  assert_true(c.inverted_tets >= 6);
  assert_true(isfinite(c.volume) && isfinite(c.area) && isfinite(c.edge_mean) && isfinite(c.radius_ratio.mean));
}

/* ---- behaviour ---- */

/* The same digits for any number of threads. */
static void threads_agree(void **state) {
  (void)state;
  laves_check results[3];
  for (int i = 0; i < 3; i++) {
    laves_context_options options = laves_context_options_default();
    options.thread_count = i + 1;
    laves_context *context = laves_context_create(&options);
    memset(&results[i], 0, sizeof results[i]);
    laves_mesh *mesh = fixture_ball(context, 14, 3);
    assert_int_equal(laves_check_mesh(context, mesh, NULL, &results[i], NULL), LAVES_OK);
    laves_mesh_free(mesh);
    laves_context_free(context);
  }
  assert_memory_equal(&results[0], &results[1], sizeof results[0]);
  assert_memory_equal(&results[0], &results[2], sizeof results[0]);
}

static bool refuse(void *user, const char *phase, double fraction) {
  (void)user;
  (void)phase;
  (void)fraction;
  return false;
}

static void cancelled(void **state) {
  (void)state;
  laves_context_options options = laves_context_options_default();
  options.progress = refuse;
  laves_context *context = laves_context_create(&options);
  int32_t tet[4] = {0, 1, 2, 3};
  laves_mesh *mesh = laves__mesh_create(context, 4, 1, 0, false, false);
  memset(mesh->points, 0, 4 * sizeof *mesh->points);
  memcpy(mesh->tets[0], tet, sizeof tet);
  laves_check c;
  assert_int_equal(laves_check_mesh(context, mesh, NULL, &c, NULL), LAVES_ERROR_CANCELLED);
  assert_false(c.valid);
  laves_mesh_free(mesh);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

/* Each allocation that may fail does, once: the answer is an error and nothing is left behind. */
static void short_of_memory(void **state) {
  (void)state;
  bool enough = false;
  laves_context *builder = laves_context_create(NULL);
  laves_mesh *mesh = fixture_ring(builder);
  mesh->faces[0][0] ^= 1; /* so that the comparison of faces runs in full */
  for (size_t limit = 1; !enough; limit += limit < 40000 ? 300 : 4000000) {
    laves_context_options options = laves_context_options_default();
    options.memory_limit = limit;
    laves_context *context = laves_context_create(&options);
    laves_check c;
    const laves_result result = laves_check_mesh(context, mesh, NULL, &c, NULL);
    enough = result == LAVES_OK;
    if (!enough) assert_int_equal(result, LAVES_ERROR_MEMORY);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
  }
  laves_mesh_free(mesh);
  laves_context_free(builder);
}

static void sorts(void **state) {
  (void)state;
  enum { COUNT = 1000 };
  static laves__keyed items[COUNT], scratch[COUNT];
  uint64_t key = 1;
  for (size_t i = 0; i < COUNT; i++) {
    key = key * 6364136223846793005u + 1442695040888963407u;
    items[i] = (laves__keyed){(key >> 60) << 40 | (key >> 40 & 3), i};
  }
  assert_true(laves__sort_keyed(NULL, items, scratch, COUNT));
  for (size_t i = 1; i < COUNT; i++)
    assert_true(items[i - 1].key < items[i].key || (items[i - 1].key == items[i].key && items[i - 1].value < items[i].value));
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(one_block),
      TEST(statistics),
      TEST(extremes),
      TEST(torus),
      TEST(nested_shells),
      TEST(two_components),
      TEST(nothing),
      TEST(order_of_faces_is_free),
      TEST(inverted_tet),
      TEST(flat_tet),
      TEST(folded),
      TEST(doubled_tet),
      TEST(overlapping_tets),
      TEST(edge_contact),
      TEST(vertex_contact),
      TEST(stored_faces_differ),
      TEST(bad_indices),
      TEST(points_not_finite),
      cmocka_unit_test(threads_agree),
      cmocka_unit_test(cancelled),
      cmocka_unit_test(short_of_memory),
      cmocka_unit_test(sorts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
