/* The compact arrays: numbering, order, faces and exact tiles. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "assemble/assemble.h"
#include "fixtures/stages.h"

static laves_mesh *assemble(stages *s, const char *expression, double size) {
  laves_mesh *mesh;
  laves_error error;
  stages_begin(s, expression, size, 0);
  stages_snap(s);
  assert_int_equal(laves__assemble(&s->frame, &s->lattice, &s->layer, false, &mesh, &error), LAVES_OK);
  return mesh;
}

static const char *const solids[] = {"sphere(1)", "torus(1, 0.4) - box(0.5)", "sphere(1) | sphere(1):move(2.1, 0, 0)"};

static void estimate_is_the_count(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++) {
    stages s;
    int64_t vertices, tets;
    laves_mesh *mesh = assemble(&s, solids[i], 0.1);
    laves__assemble_estimate(&s.lattice, &s.layer, &vertices, &tets);
    assert_int_equal(tets, mesh->tet_count);
    assert_true(llabs(vertices - (int64_t)mesh->vertex_count) <= (int64_t)s.pinches * 4);
    laves_mesh_free(mesh);
    stages_end(&s);
  }
}

/* Faces are those that the tets have on one side only, outwards. */
static void faces_are_the_boundary(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++) {
    stages s;
    laves_mesh *mesh = assemble(&s, solids[i], 0.12);
    const laves_check check = check_valid(s.context, mesh, solids[i]);
    assert_int_equal(check.faces, mesh->face_count);
    double volume = 0, by_faces = 0;
    for (size_t t = 0; t < mesh->tet_count; t++) {
      const int32_t *c = mesh->tets[t];
      volume += v3_det(mesh->points[c[0]], mesh->points[c[1]], mesh->points[c[2]], mesh->points[c[3]]);
    }
    for (size_t f = 0; f < mesh->face_count; f++) {
      const int32_t *c = mesh->faces[f];
      by_faces += v3_dot(mesh->points[c[0]], v3_cross(mesh->points[c[1]], mesh->points[c[2]]));
    }
    assert_true(volume > 0 && fabs(volume - by_faces) < 1e-9 * volume);
    laves_mesh_free(mesh);
    stages_end(&s);
  }
}

/* The first tets are tiles as the table has them: volumes of one of three kinds, edges of one of three lengths. */
static void first_tets_are_exact_tiles(void **state) {
  (void)state;
  stages s;
  const double size = 0.08;
  laves_mesh *mesh = assemble(&s, "sphere(1)", size);
  assert_true(mesh->lattice_tet_count > mesh->tet_count / 4);
  const double unit = size / LAVES__C15_MEAN_EDGE, squares[3] = {8, 11, 12};
  for (size_t t = 0; t < mesh->lattice_tet_count; t++)
    for (int e = 0; e < 6; e++) {
      const laves__vec3 a = mesh->points[mesh->tets[t][laves__tet_edge[e][0]]],
                        b = mesh->points[mesh->tets[t][laves__tet_edge[e][1]]];
      const double square = v3_norm2(v3_sub(a, b)) / (unit * unit);
      assert_true(fabs(square - squares[0]) < 1e-9 || fabs(square - squares[1]) < 1e-9 || fabs(square - squares[2]) < 1e-9);
    }
  laves_mesh_free(mesh);
  stages_end(&s);
}

/* Vertices follow the cells, so that neighbours in space are neighbours in memory. */
static void vertices_are_in_the_order_of_the_cells(void **state) {
  (void)state;
  stages s;
  laves_mesh *mesh = assemble(&s, "sphere(1)", 0.05);
  double sum = 0;
  for (size_t v = 1; v < mesh->vertex_count; v++) sum += v3_distance(mesh->points[v - 1], mesh->points[v]);
  assert_true(sum / (double)mesh->vertex_count < 4 * 0.05);
  laves_mesh_free(mesh);
  stages_end(&s);
}

static void every_number_of_threads_gives_the_same_bytes(void **state) {
  (void)state;
  char hash[3][33];
  static const int threads[3] = {1, 2, 5};
  for (int i = 0; i < 3; i++) {
    stages s;
    laves_mesh *mesh;
    stages_begin(&s, "torus(1, 0.4) - box(0.5)", 0.08, threads[i]);
    stages_snap(&s);
    assert_int_equal(laves__assemble(&s.frame, &s.lattice, &s.layer, false, &mesh, NULL), LAVES_OK);
    laves_mesh_hash(mesh, hash[i]);
    laves_mesh_free(mesh);
    stages_end(&s);
  }
  assert_string_equal(hash[0], hash[1]);
  assert_string_equal(hash[0], hash[2]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(estimate_is_the_count),
      cmocka_unit_test(faces_are_the_boundary),
      cmocka_unit_test(first_tets_are_exact_tiles),
      cmocka_unit_test(vertices_are_in_the_order_of_the_cells),
      cmocka_unit_test(every_number_of_threads_gives_the_same_bytes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
