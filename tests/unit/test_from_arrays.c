/* Meshes from arrays: copies, boundary faces and their order, refusals, and the search for equal faces. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

#include "base/predicates.h"
#include "fixtures/meshes.h"
#include "mesh/face_match.h"

static const double points[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};

static int set_up(void **state) {
  *state = laves_context_create(NULL);
  return *state == NULL;
}

static int tear_down(void **state) {
  const size_t left = laves_context_bytes(*state);
  laves_context_free(*state);
  return left != 0;
}

static void two_tets(void **state) {
  const int32_t tets[2][4] = {{0, 1, 2, 3}, {1, 2, 3, 4}}, regions[2] = {7, 8};
  const int32_t expected[6][3] = {{0, 3, 2}, {0, 1, 3}, {0, 2, 1}, {2, 3, 4}, {1, 4, 3}, {1, 2, 4}};
  laves_mesh *mesh;
  assert_int_equal(laves_mesh_from_arrays(*state, points[0], 5, tets[0], 2, regions, &mesh, NULL), LAVES_OK);
  assert_int_equal(laves_mesh_vertex_count(mesh), 5);
  assert_int_equal(laves_mesh_tet_count(mesh), 2);
  assert_int_equal(laves_mesh_face_count(mesh), 6);
  assert_memory_equal(laves_mesh_points(mesh), points, sizeof points);
  assert_memory_equal(laves_mesh_tets(mesh), tets, sizeof tets);
  assert_memory_equal(laves_mesh_regions(mesh), regions, sizeof regions);
  assert_memory_equal(laves_mesh_faces(mesh), expected, sizeof expected);
  laves_mesh_free(mesh);
}

/* The second tet given inverted: its faces still look outwards. */
static void outwards_even_when_inverted(void **state) {
  const int32_t tets[2][4] = {{0, 1, 2, 3}, {1, 3, 2, 4}};
  const laves__vec3 inside = {0.3, 0.3, 0.3};
  laves_mesh *mesh;
  assert_int_equal(laves_mesh_from_arrays(*state, points[0], 5, tets[0], 2, NULL, &mesh, NULL), LAVES_OK);
  assert_int_equal(mesh->face_count, 6);
  for (size_t i = 0; i < 6; i++) {
    const int32_t *f = mesh->faces[i];
    assert_int_equal(laves__orient3d(inside, mesh->points[f[0]], mesh->points[f[1]], mesh->points[f[2]]), 1);
  }
  assert_null(laves_mesh_regions(mesh));
  laves_mesh_free(mesh);
}

static void empty(void **state) {
  laves_mesh *mesh;
  assert_int_equal(laves_mesh_from_arrays(*state, NULL, 0, NULL, 0, NULL, &mesh, NULL), LAVES_OK);
  assert_int_equal(laves_mesh_face_count(mesh), 0);
  laves_mesh_free(mesh);
}

static void refuses_indices(void **state) {
  const int32_t tets[2][4] = {{0, 1, 2, 3}, {1, 2, 3, 5}};
  laves_error error = {0};
  laves_mesh *mesh;
  assert_int_equal(laves_mesh_from_arrays(*state, points[0], 5, tets[0], 2, NULL, &mesh, &error), LAVES_ERROR_INPUT);
  assert_null(mesh);
  assert_string_equal(error.text, "tetrahedron 1 uses vertex 5, but the vertices are 0 to 4");
  const int32_t negative[1][4] = {{0, 1, -2, 3}};
  assert_int_equal(laves_mesh_from_arrays(*state, points[0], 5, negative[0], 1, NULL, &mesh, NULL), LAVES_ERROR_INPUT);
}

static void cube_grid(void **state) {
  const int n = 12;
  laves_mesh *mesh = fixture_cubes(*state, n, n, n, NULL, NULL);
  assert_int_equal(mesh->tet_count, 6 * n * n * n);
  assert_int_equal(mesh->face_count, 12 * n * n);
  double volume = 0; /* of the cones from the origin over the boundary */
  for (size_t i = 0; i < mesh->face_count; i++) {
    const int32_t *f = mesh->faces[i];
    volume += v3_det(v3(0, 0, 0), mesh->points[f[0]], mesh->points[f[1]], mesh->points[f[2]]) / 6;
  }
  assert_float_equal(volume, n * n * n, 1e-9);
  laves_mesh_free(mesh);
}

typedef struct uses {
  size_t groups, faces, disorder;
} uses;

static void count_uses(void *user, uint32_t low, const laves__face_use *face, size_t count, int worker) {
  uses *u = (uses *)user + worker;
  u->groups++;
  u->faces += count;
  for (size_t i = 0; i < count; i++)
    if (low >= face[i].middle || face[i].middle >= face[i].high || (i > 0 && face[i].slot <= face[i - 1].slot)) u->disorder++;
}

/* A fan of many tets around one vertex fills one long bucket; the last tet, 0 0 0 0, is passed over. */
static void long_bucket(void **state) {
  enum { COUNT = 2000 };
  static int32_t tets[COUNT][4];
  for (int32_t i = 0; i < COUNT - 1; i++) {
    const int32_t tet[4] = {0, 1 + i, 2 + i, 3 + i};
    memcpy(tets[(7 * i) % (COUNT - 1)], tet, sizeof tet);
  }
  uses total[256] = {{0}};
  assert_int_equal(laves__match_faces(*state, NULL, (const int32_t(*)[4])tets, COUNT, COUNT + 3, count_uses, total, NULL),
                   LAVES_OK);
  for (int i = 1; i < 256; i++) {
    total[0].groups += total[i].groups;
    total[0].faces += total[i].faces;
    total[0].disorder += total[i].disorder;
  }
  assert_int_equal(total[0].disorder, 0);
  assert_int_equal(total[0].faces, 4 * (COUNT - 1));
  assert_int_equal(total[0].groups, 4 * (COUNT - 1) - (COUNT - 2));
}

/* Every place where memory can run out is answered with an error and leaves nothing behind. */
static void short_of_memory(void **state) {
  (void)state;
  const int32_t tets[2][4] = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  bool enough = false;
  for (size_t limit = 1; !enough; limit += limit < 2000 ? 8 : 100000) {
    laves_context_options options = laves_context_options_default();
    options.memory_limit = limit;
    laves_context *context = laves_context_create(&options);
    laves_mesh *mesh;
    const laves_result result = laves_mesh_from_arrays(context, points[0], 5, tets[0], 2, NULL, &mesh, NULL);
    enough = result == LAVES_OK;
    if (!enough) assert_int_equal(result, LAVES_ERROR_MEMORY);
    laves_mesh_free(mesh);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(two_tets, set_up, tear_down),
      cmocka_unit_test_setup_teardown(outwards_even_when_inverted, set_up, tear_down),
      cmocka_unit_test_setup_teardown(empty, set_up, tear_down),
      cmocka_unit_test_setup_teardown(refuses_indices, set_up, tear_down),
      cmocka_unit_test_setup_teardown(cube_grid, set_up, tear_down),
      cmocka_unit_test_setup_teardown(long_bucket, set_up, tear_down),
      cmocka_unit_test(short_of_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
