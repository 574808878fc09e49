/* Nodes of second order: their numbers and places, the least Jacobian, what is refused, and what stays as it was. */
#include "curve/quadratic.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/folders.h"
#include "fixtures/stages.h"
#include "fixtures/tagged_cube.h"

static const laves__vec3 corners[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

static void straighten(laves__vec3 nodes[10]) {
  for (int i = 0; i < 4; i++) nodes[i] = corners[i];
  for (int m = 0; m < 6; m++)
    nodes[4 + m] = v3_scale(v3_add(corners[laves__mid_corners[m][0]], corners[laves__mid_corners[m][1]]), 0.5);
}

/* det(dx/du) at a point, by the derivatives of the shape functions as books print them. */
static double jacobian_at(const laves__vec3 n[10], const double l[4]) {
  laves__vec3 d[4]; /* by each barycentric coordinate */
  for (int i = 0; i < 4; i++) d[i] = v3_scale(n[i], 4 * l[i] - 1);
  for (int m = 0; m < 6; m++) {
    const int a = laves__mid_corners[m][0], b = laves__mid_corners[m][1];
    d[a] = v3_mad(d[a], n[4 + m], 4 * l[b]);
    d[b] = v3_mad(d[b], n[4 + m], 4 * l[a]);
  }
  return v3_dot(v3_sub(d[1], d[0]), v3_cross(v3_sub(d[2], d[0]), v3_sub(d[3], d[0])));
}

static double least_sampled(const laves__vec3 n[10]) {
  enum { STEPS = 12 };
  double least = INFINITY;
  for (int i = 0; i <= STEPS; i++)
    for (int j = 0; i + j <= STEPS; j++)
      for (int k = 0; i + j + k <= STEPS; k++) {
        const double l[4] = {1 - (i + j + k) / (double)STEPS, i / (double)STEPS, j / (double)STEPS, k / (double)STEPS};
        least = fmin(least, jacobian_at(n, l));
      }
  return least;
}

static void the_straight_one_has_all(void **state) {
  (void)state;
  laves__vec3 nodes[10];
  straighten(nodes);
  assert_true(fabs(laves__quadratic_least(nodes) - 1) < 1e-14);
  const laves__vec3 other = nodes[1];
  nodes[1] = nodes[2]; /* turned over */
  nodes[2] = other;
  assert_true(laves__quadratic_least(nodes) <= 0);
}

/* A node that slides along its edge: x(t) = t + 4 s t (1 - t), whose derivative is least at one end, 1 - 4 s. */
static void a_node_that_slides(void **state) {
  (void)state;
  for (double s = 0.05; s < 0.5; s += 0.05) {
    laves__vec3 nodes[10];
    straighten(nodes);
    nodes[4].x += s;
    assert_true(fabs(laves__quadratic_least(nodes) - (1 - 4 * s)) < 1e-12);
  }
}

/* The bound is below every sample, and not far below: it is a value wherever it is taken at a corner. */
static void the_bound_is_below_all_samples(void **state) {
  (void)state;
  uint64_t random = 12345;
  int positive = 0;
  for (int round = 0; round < 2000; round++) {
    laves__vec3 nodes[10];
    straighten(nodes);
    for (int m = 4; m < 10; m++)
      for (int axis = 0; axis < 3; axis++) {
        random = random * UINT64_C(6364136223846793005) + 1442695040888963407u;
        *v3_slot(&nodes[m], axis) += ((double)(random >> 40) / (1 << 24) - 0.5) * 0.2;
      }
    const double bound = laves__quadratic_least(nodes), sampled = least_sampled(nodes);
    assert_true(bound <= sampled + 1e-12);
    assert_true(bound > sampled - 1);
    positive += bound > 0;
  }
  assert_true(positive > 100 && positive < 1999);
}

static laves_mesh *curved_cube(laves_context *context) {
  laves_mesh *mesh = fixture_tagged_cube(context, 4);
  laves_curve_report report;
  assert_int_equal(laves_mesh_curve(context, mesh, NULL, NULL, &report, NULL), LAVES_OK);
  assert_int_equal(report.nodes, 9 * 9 * 9); /* the nodes of a cube of 4^3 are the vertices of one of 8^3 */
  assert_int_equal(report.edges, 9 * 9 * 9 - 5 * 5 * 5);
  assert_int_equal(report.on_surface + report.moved_back + report.straightened, 0);
  assert_int_equal(report.unreached, report.boundary_edges);
  assert_int_equal(report.least_tet, -1);
  assert_true(!report.has_distance);
  return mesh;
}

static void nodes_are_numbered_by_their_edges(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_mesh *mesh = curved_cube(context);
  assert_int_equal(laves_mesh_order(mesh), 2);
  const double(*points)[3] = (const double(*)[3])laves_mesh_node_points(mesh);
  const int32_t(*tets)[10] = (const int32_t(*)[10])laves_mesh_tet_nodes(mesh);
  const int32_t(*faces)[6] = (const int32_t(*)[6])laves_mesh_face_nodes(mesh);
  const size_t vertices = laves_mesh_vertex_count(mesh), nodes = laves_mesh_node_count(mesh);
  int32_t(*ends)[2] = calloc(nodes, sizeof *ends);
  assert_memory_equal(points, laves_mesh_points(mesh), vertices * sizeof *points);
  for (size_t i = 0; i < laves_mesh_tet_count(mesh); i++) {
    assert_memory_equal(tets[i], laves_mesh_tets(mesh) + 4 * i, 4 * sizeof(int32_t));
    for (int m = 0; m < 6; m++) {
      const int32_t a = tets[i][laves__mid_corners[m][0]], b = tets[i][laves__mid_corners[m][1]], node = tets[i][4 + m];
      assert_in_range(node, vertices, nodes - 1);
      for (int axis = 0; axis < 3; axis++) assert_true(points[node][axis] == 0.5 * (points[a][axis] + points[b][axis]));
      const int32_t low = a < b ? a : b, high = a < b ? b : a;
      assert_true(ends[node][1] == 0 || (ends[node][0] == low && ends[node][1] == high));
      ends[node][0] = low;
      ends[node][1] = high;
    }
  }
  for (size_t i = vertices + 1; i < nodes; i++)
    assert_true(ends[i - 1][0] < ends[i][0] || (ends[i - 1][0] == ends[i][0] && ends[i - 1][1] < ends[i][1]));
  for (size_t i = 0; i < laves_mesh_face_count(mesh); i++)
    for (int m = 0; m < 3; m++) {
      const int32_t a = faces[i][laves__mid_corners[m][0]], b = faces[i][laves__mid_corners[m][1]];
      assert_int_equal(ends[faces[i][3 + m]][0], a < b ? a : b);
      assert_int_equal(ends[faces[i][3 + m]][1], a < b ? b : a);
    }
  free(ends);
  laves_mesh_free(mesh);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void a_linear_mesh_answers_too(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_mesh *mesh = fixture_plain_cube(context, 2);
  assert_int_equal(laves_mesh_order(mesh), 1);
  assert_int_equal(laves_mesh_node_count(mesh), laves_mesh_vertex_count(mesh));
  assert_ptr_equal(laves_mesh_node_points(mesh), laves_mesh_points(mesh));
  assert_ptr_equal(laves_mesh_tet_nodes(mesh), laves_mesh_tets(mesh));
  assert_ptr_equal(laves_mesh_face_nodes(mesh), laves_mesh_faces(mesh));
  laves_mesh_free(mesh);
  laves_context_free(context);
}

static void refused(laves_context *context, laves_mesh *mesh, const laves_curve_options *options, const char *text) {
  laves_error error = {.text = ""};
  assert_int_equal(laves_mesh_curve(context, mesh, NULL, options, NULL, &error), LAVES_ERROR_OPTION);
  if (!strstr(error.text, text)) fail_msg("'%s' does not speak of '%s'", error.text, text);
  assert_int_equal(laves_mesh_order(mesh), 1);
}

static void what_cannot_be_is_refused(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_mesh *mesh = fixture_plain_cube(context, 2);
  refused(context, mesh, &(laves_curve_options){.min_jacobian = 0.2}, "laves_curve_options_default");
  laves_curve_options options = laves_curve_options_default();
  options.min_jacobian = 0;
  refused(context, mesh, &options, "min_jacobian is 0");
  options = laves_curve_options_default();
  options.feature_angle = -3;
  refused(context, mesh, &options, "feature_angle is -3");
  options = laves_curve_options_default();
  options.feature_size = NAN;
  refused(context, mesh, &options, "feature_size is nan");
  laves_mesh_free(mesh);
  laves_options streamed = options_of_size(0.4);
  streamed.streamed = true;
  mesh = mesh_of_expression(context, "sphere(1)", &streamed, NULL);
  refused(context, mesh, NULL, "streamed");
  laves_mesh_free(mesh);
  laves_context_free(context);
}

static const char *const file_names[LAVES_FORMAT_COUNT] = {
    [LAVES_FORMAT_VTU] = "a.vtu",      [LAVES_FORMAT_GMSH22] = "a22.msh", [LAVES_FORMAT_GMSH41] = "a41.msh",
    [LAVES_FORMAT_MEDIT] = "a.mesh",   [LAVES_FORMAT_TETGEN] = "a.node",  [LAVES_FORMAT_VTKHDF] = "a.vtkhdf",
    [LAVES_FORMAT_VTK] = "a.vtk",      [LAVES_FORMAT_XDMF] = "a.xdmf",    [LAVES_FORMAT_EXODUS] = "a.exo",
    [LAVES_FORMAT_ABAQUS] = "a.inp",   [LAVES_FORMAT_NASTRAN] = "a.bdf",  [LAVES_FORMAT_NPZ] = "a.npz",
    [LAVES_FORMAT_DMTET] = "grid.npz", [LAVES_FORMAT_STL] = "a.stl",      [LAVES_FORMAT_OBJ] = "a.obj",
    [LAVES_FORMAT_PLY] = "a.ply",      [LAVES_FORMAT_OFF] = "a.off",
};

/* Every format writes the nodes or says that it cannot; what is read again are the corners, as they were. */
static void every_format_writes_or_refuses(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_mesh *mesh = curved_cube(context);
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 40];
  assert_true(fixture_folder_make(folder));
  for (int f = LAVES_FORMAT_VTU; f < LAVES_FORMAT_COUNT; f++) {
    laves_write_options options = laves_write_options_default();
    laves_error error = {.text = ""};
    options.format = (laves_format)f;
    assert_non_null(file_names[f]);
    snprintf(path, sizeof path, "%s/%s", folder, file_names[f]);
    const laves_result result = laves_mesh_write(context, mesh, path, &options, &error);
    assert_int_equal(result, laves_format_is_quadratic((laves_format)f) ? LAVES_OK : LAVES_ERROR_OPTION);
    if (result != LAVES_OK && !strstr(error.text, "second order")) fail_msg("%s", error.text);
    const bool is_read = f == LAVES_FORMAT_VTU || f == LAVES_FORMAT_GMSH22 || f == LAVES_FORMAT_GMSH41 || f == LAVES_FORMAT_VTK ||
                         f == LAVES_FORMAT_MEDIT || f == LAVES_FORMAT_ABAQUS;
    if (!is_read) continue;
    laves_mesh *copy;
    assert_int_equal(laves_mesh_read(context, path, &copy, &error), LAVES_OK);
    assert_int_equal(laves_mesh_vertex_count(copy), laves_mesh_vertex_count(mesh));
    assert_int_equal(laves_mesh_tet_count(copy), laves_mesh_tet_count(mesh));
    assert_true(fabs(fixture_volume(copy) - 1) < 1e-12);
    laves_mesh_free(copy);
  }
  fixture_folder_remove(folder);
  laves_mesh_free(mesh);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_straight_one_has_all),       cmocka_unit_test(a_node_that_slides),
      cmocka_unit_test(the_bound_is_below_all_samples), cmocka_unit_test(nodes_are_numbered_by_their_edges),
      cmocka_unit_test(a_linear_mesh_answers_too),      cmocka_unit_test(what_cannot_be_is_refused),
      cmocka_unit_test(every_format_writes_or_refuses),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
