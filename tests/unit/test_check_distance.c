/* Distances, windows and curvature against solids known in closed form: balls given by a hand-made oracle. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

#include "certify/boundary_tree.h"
#include "fixtures/meshes.h"

/* ---- a domain of balls apart from one another ---- */

typedef struct balls {
  int count;
  laves__vec3 centre[2]; /* local */
  double radius;
} balls;

static int nearest_ball(const balls *b, laves__vec3 p) {
  return b->count > 1 && v3_distance(p, b->centre[1]) < v3_distance(p, b->centre[0]);
}

static void evaluate(const void *self, size_t count, const laves__vec3 *points, double *phi, uint32_t *hints) {
  const balls *b = self;
  for (size_t i = 0; i < count; i++) {
    phi[i] = v3_distance(points[i], b->centre[nearest_ball(b, points[i])]) - b->radius;
    if (hints) hints[i] = LAVES__NO_HINT;
  }
}

static bool project(const void *self, laves__vec3 point, double reach, uint32_t *hint, laves__vec3 *foot, laves__vec3 *normal) {
  const balls *b = self;
  const laves__vec3 centre = b->centre[nearest_ball(b, point)];
  *hint = 0;
  *normal = v3_unit(v3_sub(point, centre));
  *foot = v3_mad(centre, *normal, b->radius);
  return v3_distance(*foot, point) <= reach;
}

/* A golden spiral on each ball. */
static size_t sample(const void *self, double spacing, laves__vec3 *points, size_t capacity) {
  const balls *b = self;
  const size_t each = (size_t)(4 * M_PI * b->radius * b->radius / (spacing * spacing)) + 1;
  size_t count = 0;
  for (int ball = 0; ball < b->count; ball++)
    for (size_t i = 0; i < each && count < capacity; i++) {
      const double z = 1 - (2 * (double)i + 1) / (double)each, turn = 2.399963229728653 * (double)i;
      const laves__vec3 direction = v3(sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z);
      points[count++] = v3_mad(b->centre[ball], direction, b->radius);
    }
  return count;
}

static laves_domain domain_of(balls *b, laves__vec3 origin) {
  laves_domain domain = {0};
  const laves__vec3 r = v3(b->radius, b->radius, b->radius);
  domain.oracle = (laves__oracle){.self = b,
                                  .origin = origin,
                                  .is_distance = true,
                                  .bounds = box3_empty(),
                                  .volume = b->count * 4.0 / 3 * M_PI * pow(b->radius, 3),
                                  .area = b->count * 4 * M_PI * b->radius * b->radius,
                                  .evaluate = evaluate,
                                  .project = project,
                                  .sample = sample};
  for (int i = 0; i < b->count; i++) {
    domain.oracle.bounds = box3_add(domain.oracle.bounds, v3_add(b->centre[i], r));
    domain.oracle.bounds = box3_add(domain.oracle.bounds, v3_sub(b->centre[i], r));
  }
  return domain;
}

static int set_up(void **state) {
  *state = laves_context_create(NULL);
  return *state == NULL;
}

static int tear_down(void **state) {
  const size_t left = laves_context_bytes(*state);
  laves_context_free(*state);
  return left != 0;
}

static void move(laves_mesh *mesh, laves__vec3 by) {
  for (size_t i = 0; i < mesh->vertex_count; i++) mesh->points[i] = v3_add(mesh->points[i], by);
}

/* How far the deepest boundary triangle of a mesh with its vertices on the unit sphere lies below it. */
static double depth(const laves_mesh *mesh) {
  double least = 1;
  for (size_t i = 0; i < mesh->face_count; i++) {
    const int32_t *f = mesh->faces[i];
    const laves__vec3 a = mesh->points[f[0]], b = mesh->points[f[1]], c = mesh->points[f[2]];
    for (int u = 0; u <= 20; u++)
      for (int v = 0; u + v <= 20; v++)
        least =
            fmin(least, v3_norm(v3_add(v3_scale(a, u / 20.0), v3_add(v3_scale(b, v / 20.0), v3_scale(c, (20 - u - v) / 20.0)))));
  }
  return 1 - least;
}

/* ---- the tree ---- */

/* The distance to the surface of the box [0, 3]^3. */
static double cube_distance(laves__vec3 p) {
  const double q[3] = {fabs(p.x - 1.5) - 1.5, fabs(p.y - 1.5) - 1.5, fabs(p.z - 1.5) - 1.5};
  const double inside = fmax(q[0], fmax(q[1], q[2]));
  return inside < 0 ? -inside : v3_norm(v3(fmax(q[0], 0), fmax(q[1], 0), fmax(q[2], 0)));
}

static void tree_finds_the_nearest(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 3, 3, 3, NULL, NULL);
  laves__boundary boundary;
  laves__boundary_tree *tree;
  float edge = 0;
  size_t near = LAVES__NO_TRIANGLE;
  const laves__vec3 origin = v3(1, 2, 3);
  assert_int_equal(laves__find_boundary(*state, mesh, &boundary, NULL), LAVES_OK);
  assert_int_equal(boundary.count, mesh->face_count);
  assert_memory_equal(boundary.faces, mesh->faces, boundary.count * sizeof *boundary.faces);
  assert_int_equal(laves__boundary_tree_build(*state, mesh, &boundary, origin, NULL, 0, &tree, NULL), LAVES_OK);
  for (int i = 0; i < 15 * 15 * 15; i++) {
    const laves__vec3 p = v3(i % 15 * 0.47 - 1.7, i / 15 % 15 * 0.49 - 1.9, i / 225 * 0.51 - 2.1);
    const double distance = cube_distance(p);
    size_t none = LAVES__NO_TRIANGLE, any = (size_t)i % mesh->face_count;
    const double found = laves__boundary_tree_distance(tree, v3_sub(p, origin), INFINITY, &edge, &none);
    assert_float_equal(found, distance, 1e-12);
    assert_true(none < mesh->face_count);
    assert_float_equal(laves__boundary_tree_distance(tree, v3_sub(p, origin), distance, &edge, &none), distance, 1e-12);
    /* Wherever the search begins, it ends in the same place. */
    assert_true(laves__boundary_tree_distance(tree, v3_sub(p, origin), INFINITY, &edge, &any) == found);
    assert_true(laves__boundary_tree_distance(tree, v3_sub(p, origin), INFINITY, &edge, &near) == found);
    if (found > 0) assert_int_equal(any, near);
  }
  laves__boundary_tree_free(tree);
  laves__boundary_free(&boundary);
  laves_mesh_free(mesh);
}

/* A point that is no number is near to nothing, and reads nothing beyond the triangles. */
static void tree_of_a_few_triangles(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 1, 1, 1, NULL, NULL);
  laves__boundary boundary;
  laves__boundary_tree *tree;
  float edge = 0;
  assert_int_equal(laves__find_boundary(*state, mesh, &boundary, NULL), LAVES_OK);
  boundary.count = 5; /* a leaf, and one that has room */
  assert_int_equal(laves__boundary_tree_build(*state, mesh, &boundary, v3(0, 0, 0), NULL, 0, &tree, NULL), LAVES_OK);
  size_t near = LAVES__NO_TRIANGLE, none = LAVES__NO_TRIANGLE;
  assert_true(laves__boundary_tree_distance(tree, v3(NAN, NAN, NAN), INFINITY, &edge, &none) == INFINITY);
  assert_int_equal(none, LAVES__NO_TRIANGLE);
  assert_true(laves__boundary_tree_distance(tree, v3(5, 5, 5), INFINITY, &edge, &near) < INFINITY);
  assert_in_range(near, 0, 4);
  laves__boundary_tree_free(tree);
  boundary.count = mesh->face_count;
  laves__boundary_free(&boundary);
  laves_mesh_free(mesh);
}

static void tree_of_nothing(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 1, 1, 1, NULL, NULL);
  laves__boundary empty = {0};
  laves__boundary_tree *tree;
  float edge = 0;
  size_t near = LAVES__NO_TRIANGLE;
  assert_int_equal(laves__boundary_tree_build(*state, mesh, &empty, v3(0, 0, 0), NULL, 0, &tree, NULL), LAVES_OK);
  assert_true(laves__boundary_tree_distance(tree, v3(0, 0, 0), INFINITY, &edge, &near) == INFINITY);
  laves__boundary_tree_free(tree);
  laves_mesh_free(mesh);
}

/* ---- distances ---- */

/* Vertices on the sphere: both maxima are the depth of the flattest triangle, wherever the origin is. */
static void inscribed_ball(void **state) {
  laves_mesh *mesh = fixture_ball(*state, 8, 1);
  const double deepest = depth(mesh);
  const laves__vec3 origin = v3(1000, -20, 3);
  balls b = {1, {{0, 0, 0}}, 1};
  laves_domain domain = domain_of(&b, origin);
  laves_check c;
  move(mesh, origin);
  assert_int_equal(laves_check_mesh(*state, mesh, &domain, &c, NULL), LAVES_OK);
  assert_true(c.valid && c.has_distance);
  assert_true(c.to_surface_max > 0.8 * deepest && c.to_surface_max < 1.01 * deepest);
  assert_true(c.from_surface_max > 0.8 * deepest && c.from_surface_max < 1.01 * deepest);
  assert_true(c.to_surface_mean > 0.3 * deepest && c.to_surface_mean < 0.7 * deepest);
  assert_true(fabs(c.from_surface_mean / c.to_surface_mean - 1) < 0.1);
  assert_float_equal(c.domain_volume, 4.0 / 3 * M_PI, 1e-12);
  const laves__vec3 place = v3(c.to_surface_place[0], c.to_surface_place[1], c.to_surface_place[2]);
  assert_float_equal(1 - v3_distance(place, origin), c.to_surface_max, 1e-9);
  laves_mesh_free(mesh);
}

/* Far outside the reach of the first projection. */
static void larger_sphere(void **state) {
  laves_mesh *mesh = fixture_ball(*state, 6, 1);
  balls b = {1, {{0, 0, 0}}, 8};
  laves_domain domain = domain_of(&b, v3(0, 0, 0));
  const double deepest = depth(mesh);
  laves_check c;
  assert_int_equal(laves_check_mesh(*state, mesh, &domain, &c, NULL), LAVES_OK);
  assert_true(c.to_surface_max > 7 && c.to_surface_max < 7 + deepest + 1e-9);
  assert_true(c.from_surface_max > 7 && c.from_surface_max < 7 + deepest + 1e-9);
  laves_mesh_free(mesh);
}

/* A part of the domain that the mesh lacks is seen from the surface only. */
static void missing_part(void **state) {
  laves_mesh *mesh = fixture_ball(*state, 6, 1);
  balls b = {2, {{0, 0, 0}, {5, 0, 0}}, 1};
  laves_domain domain = domain_of(&b, v3(0, 0, 0));
  laves_check c;
  assert_int_equal(laves_check_mesh(*state, mesh, &domain, &c, NULL), LAVES_OK);
  assert_true(c.to_surface_max < 0.2);
  assert_float_equal(c.from_surface_max, 5, 0.1);
  assert_float_equal(c.from_surface_place[0], 6, 0.1);
  laves_mesh_free(mesh);
}

static void ball_of_values(void *user, const double *points, size_t count, double *values) {
  (void)user;
  for (size_t i = 0; i < count; i++) values[i] = v3_norm(v3(points[3 * i], points[3 * i + 1], points[3 * i + 2])) - 1;
}

/* A domain without samples of its own is sampled by the check, with and without a Lipschitz constant. */
static void callback_domain(void **state) {
  laves_mesh *mesh = fixture_ball(*state, 6, 1);
  const double deepest = depth(mesh);
  for (int lipschitz = 0; lipschitz <= 1; lipschitz++) {
    const laves_function function = {
        .evaluate = ball_of_values, .lower = {-1.1, -1.2, -1.3}, .upper = {1.1, 1.2, 1.3}, .lipschitz = lipschitz};
    laves_domain *domain;
    laves_check c;
    assert_int_equal(laves_domain_from_function(*state, &function, &domain, NULL), LAVES_OK);
    assert_int_equal(laves_check_mesh(*state, mesh, domain, &c, NULL), LAVES_OK);
    assert_true(c.to_surface_max > 0.8 * deepest && c.to_surface_max < 1.01 * deepest);
    assert_true(c.from_surface_max > 0.7 * deepest && c.from_surface_max < 1.01 * deepest);
    assert_true(fabs(c.from_surface_mean / c.to_surface_mean - 1) < 0.2);
    laves_domain_free(domain);
  }
  laves_mesh_free(mesh);
}

/* A vertex pulled out stands alone, however many samples around it are beyond the distance. */
static void places_beyond(void **state) {
  laves_mesh *mesh = fixture_ball(*state, 8, 1);
  balls b = {1, {{0, 0, 0}}, 1};
  laves_domain domain = domain_of(&b, v3(0, 0, 0));
  laves_place places[4];
  size_t count;
  assert_int_equal(laves_check_distance(*state, mesh, &domain, 0.2, places, 4, &count, NULL), LAVES_OK);
  assert_int_equal(count, 0);
  mesh->points[0] = v3_scale(mesh->points[0], 1.4);
  assert_int_equal(laves_check_distance(*state, mesh, &domain, 0.2, places, 4, &count, NULL), LAVES_OK);
  assert_int_equal(count, 1);
  assert_float_equal(places[0].value, 0.4, 1e-9);
  assert_int_equal(places[0].tet, -1);
  assert_memory_equal(places[0].place, &mesh->points[0], sizeof places[0].place);
  const size_t last = mesh->vertex_count - 1;
  mesh->points[last] = v3_scale(mesh->points[last], 1.5);
  assert_int_equal(laves_check_distance(*state, mesh, &domain, 0.2, places, 1, &count, NULL), LAVES_OK);
  assert_int_equal(count, 2);
  assert_float_equal(places[0].value, 0.5, 1e-9);
  laves_error error;
  assert_int_equal(laves_check_distance(*state, mesh, &domain, 0, places, 1, &count, &error), LAVES_ERROR_OPTION);
  assert_int_equal(laves_check_distance(*state, mesh, NULL, 1, places, 1, &count, &error), LAVES_ERROR_OPTION);
  laves_mesh_free(mesh);
}

/* Points that are not finite are passed over. */
static void garbage_points(void **state) {
  laves_mesh *mesh = fixture_ball(*state, 4, 1);
  balls b = {1, {{0, 0, 0}}, 1};
  laves_domain domain = domain_of(&b, v3(0, 0, 0));
  laves_check c;
  mesh->points[0].x = NAN;
  mesh->points[1].y = -INFINITY;
  assert_int_equal(laves_check_mesh(*state, mesh, &domain, &c, NULL), LAVES_OK);
  assert_false(c.valid);
  assert_true(isfinite(c.to_surface_max) && isfinite(c.from_surface_max) && c.to_surface_max < 1);
  for (size_t i = 0; i < mesh->vertex_count; i++) mesh->points[i].z = NAN;
  assert_int_equal(laves_check_mesh(*state, mesh, &domain, &c, NULL), LAVES_OK);
  assert_true(isnan(c.to_surface_max));
  laves_mesh_free(mesh);
}

/* ---- curvature and windows ---- */

static void curvature_of_a_ball(void **state) {
  (void)state;
  balls b = {1, {{0, 0, 0}}, 2};
  const laves_domain domain = domain_of(&b, v3(7, 0, 0));
  assert_float_equal(laves__curvature_radius(&domain, v3(7, 0, 1.9), 0.3), 2, 1e-6);
  assert_true(laves__curvature_radius(&domain, v3(7, 0, 0.1), 0.3) == INFINITY);
  assert_true(laves__curvature_radius(&domain, v3(NAN, 0, 0), 0.3) == INFINITY);
}

static void window_of_kuhn(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 9, 9, 9, NULL, NULL);
  laves_place places[3];
  size_t count;
  assert_int_equal(laves_check_window(*state, mesh, NULL, 44.9, 90.1, 0.6, places, 3, &count, NULL), LAVES_OK);
  assert_int_equal(count, 0);
  assert_int_equal(laves_check_window(*state, mesh, NULL, 46, 125, 0.6, places, 3, &count, NULL), LAVES_OK);
  assert_int_equal(count, mesh->tet_count);
  assert_float_equal(places[0].value, 45, 1e-9);
  assert_true(isnan(places[0].curvature_radius));
  assert_int_equal(laves_check_window(*state, mesh, NULL, 40, 80, 0.6, places, 0, &count, NULL), LAVES_OK);
  assert_int_equal(count, mesh->tet_count);
  assert_int_equal(laves_check_window(*state, mesh, NULL, 40, 125, 0.9, places, 3, &count, NULL), LAVES_OK);
  assert_int_equal(count, mesh->tet_count);
  assert_float_equal(places[0].value, sqrt(2) / pow(10.0 / 6, 1.5), 1e-9);
  laves_mesh_free(mesh);
}

/* One vertex pushed towards its neighbour spoils the tets around it; the worst come first. */
static void worst_first(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 3, 3, 3, NULL, NULL);
  balls b = {1, {{1.5, 1.5, 1.5}}, 1.5};
  const laves_domain domain = domain_of(&b, v3(0, 0, 0));
  laves_place places[24];
  size_t count;
  mesh->points[21].x += 0.9; /* the vertex (1, 1, 1) */
  assert_int_equal(laves_check_window(*state, mesh, &domain, 40, 125, 0, places, 24, &count, NULL), LAVES_OK);
  assert_true(count > 4 && count <= 24);
  double before = INFINITY;
  for (size_t i = 0; i < count; i++) {
    const double v = places[i].value, bad = v < 40 ? (40 - v) / 40 : (v - 125) / 55;
    assert_true(bad > 0 && bad <= before + 1e-12);
    assert_true(places[i].tet >= 0 && (size_t)places[i].tet < mesh->tet_count);
    assert_float_equal(places[i].curvature_radius, 1.5, 1e-6);
    before = bad;
  }
  mesh->points[21] = mesh->points[22]; /* and flat */
  assert_int_equal(laves_check_window(*state, mesh, &domain, 40, 125, 0.6, places, 1, &count, NULL), LAVES_OK);
  assert_true(count >= 6);
  assert_float_equal(places[0].value, 0, 1e-12);
  laves_mesh_free(mesh);
}

/* ---- behaviour ---- */

static void short_of_memory(void **state) {
  (void)state;
  bool enough = false;
  laves_context *builder = laves_context_create(NULL);
  laves_mesh *mesh = fixture_ball(builder, 3, 1);
  balls b = {1, {{0, 0, 0}}, 1.3};
  laves_domain domain = domain_of(&b, v3(0, 0, 0));
  for (size_t limit = 1; !enough; limit += limit < 300000 ? 8000 : 40000000) {
    laves_context_options options = laves_context_options_default();
    options.memory_limit = limit;
    laves_context *context = laves_context_create(&options);
    laves_check c;
    laves_place places[8];
    size_t count;
    laves_result result = laves_check_mesh(context, mesh, &domain, &c, NULL);
    enough = result == LAVES_OK;
    if (!enough) assert_int_equal(result, LAVES_ERROR_MEMORY);
    result = laves_check_window(context, mesh, &domain, 46, 125, 0.6, places, 8, &count, NULL);
    assert_true(result == LAVES_OK || result == LAVES_ERROR_MEMORY);
    result = laves_check_distance(context, mesh, &domain, 0.1, places, 8, &count, NULL);
    assert_true(result == LAVES_OK || result == LAVES_ERROR_MEMORY);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
  }
  laves_mesh_free(mesh);
  laves_context_free(builder);
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

/* ---- edges of several sizes ---- */

/* The unit ball moved by a Moebius transformation: vertices stay on the sphere, and edges are nine times as long at its lower end
 * in x as at its upper. */
static laves_mesh *graded_ball(laves_context *context) {
  const laves__vec3 a = v3(-0.5, 0, 0);
  laves_mesh *mesh = fixture_ball(context, 10, 1);
  for (size_t i = 0; i < mesh->vertex_count; i++) {
    const laves__vec3 x = mesh->points[i];
    const double x2 = v3_norm2(x), xa = v3_dot(x, a), a2 = v3_norm2(a);
    mesh->points[i] = v3_scale(v3_mad(v3_scale(x, 1 - a2), a, -(1 - 2 * xa + x2)), 1 / (1 - 2 * xa + x2 * a2));
  }
  return mesh;
}

static laves_domain *ball_domain(laves_context *context, bool implicit) {
  laves_domain *domain;
  if (implicit) {
    assert_int_equal(laves_domain_from_expression(context, "sphere(1)", &domain, NULL), LAVES_OK);
    return domain;
  }
  laves_mesh *ball = fixture_ball(context, 10, 1);
  assert_int_equal(laves_domain_from_triangles(context, &ball->points->x, ball->vertex_count,
                                               (const uint32_t *)&ball->faces[0][0], ball->face_count, NULL, &domain, NULL),
                   LAVES_OK);
  laves_mesh_free(ball);
  return domain;
}

static void levels_of_edges(void **state) {
  (void)state;
  assert_int_equal(laves__edge_level(1, 1), 0);
  assert_int_equal(laves__edge_level(1.41, 1), 0);
  assert_int_equal(laves__edge_level(1.42, 1), 1);
  assert_int_equal(laves__edge_level(0.71, 1), 0);
  assert_int_equal(laves__edge_level(0.70, 1), -1);
  assert_int_equal(laves__edge_level(3, 24), -3);
  assert_int_equal(laves__edge_level(0, 1), 0);
  assert_int_equal(laves__edge_level(1, 0), 0);
  assert_int_equal(laves__edge_level(1e300, 1e-300), 0);
}

/* A tree tells the least level near by: all of a ball of one size has none, a graded one has small edges at one end. */
static void levels_of_a_tree(void **state) {
  for (int graded = 0; graded < 2; graded++) {
    laves_mesh *mesh = graded ? graded_ball(*state) : fixture_ball(*state, 10, 1);
    laves__boundary boundary;
    laves__boundary_tree *tree;
    int least, greatest;
    assert_int_equal(laves__find_boundary(*state, mesh, &boundary, NULL), LAVES_OK);
    float *edges = laves__local_edges(*state, mesh, &boundary);
    assert_non_null(edges);
    assert_int_equal(laves__boundary_tree_build(*state, mesh, &boundary, v3(0, 0, 0), edges, graded ? 0.12 : 0.2, &tree, NULL),
                     LAVES_OK);
    laves__boundary_tree_levels(tree, &least, &greatest);
    if (graded) {
      assert_true(least <= -1 && greatest >= 1);
      assert_int_equal(laves__boundary_tree_level(tree, v3(1, 0, 0), 0.05), least);
      assert_true(laves__boundary_tree_level(tree, v3(-1, 0, 0), 0.05) > 0);
      assert_int_equal(laves__boundary_tree_level(tree, v3(-1, 0, 0), 3), least);
    }
    assert_int_equal(laves__boundary_tree_level(tree, v3(0, 0, 0), 0.1), 0);
    laves__boundary_tree_free(tree);
    laves__free(*state, edges, mesh->vertex_count, sizeof *edges);
    laves__boundary_free(&boundary);
    laves_mesh_free(mesh);
  }
}

/* Small edges have more samples of the surface, and all have the weight of their share of it. */
static void samples_follow_the_edges(void **state) {
  for (int implicit = 0; implicit < 2; implicit++) {
    laves_mesh *mesh = graded_ball(*state);
    laves_domain *domain = ball_domain(*state, implicit);
    laves__boundary boundary;
    laves__samples samples;
    size_t count[2] = {0, 0}; /* on the half of the small edges, and the other */
    double weight[2] = {0, 0};
    assert_int_equal(laves__find_boundary(*state, mesh, &boundary, NULL), LAVES_OK);
    assert_int_equal(laves__measure_distances(*state, mesh, &boundary, domain, &samples, NULL), LAVES_OK);
    for (size_t i = samples.boundary_count; i < samples.count; i++) {
      const laves__sample *s = &samples.items[i];
      const int half = s->point.x < 0;
      count[half]++;
      weight[half] += s->weight;
      if (fabs(s->point.x) > 0.9) assert_true(half ? s->edge > 0.2F : s->edge < 0.1F);
    }
    assert_true(count[1] > 100 && count[0] > 2 * count[1]);
    assert_float_equal(weight[0] / weight[1], 1, 0.1);
    assert_true(count[0] < 20 * mesh->face_count);
    laves__samples_free(&samples);
    laves__boundary_free(&boundary);
    laves_domain_free(domain);
    laves_mesh_free(mesh);
  }
}

/* Places are far apart by the edges near by: what flat triangles make of a sphere where they are large is none, and a dent among
 * the small ones is one, though it is shallower. */
static void distances_by_the_edges(void **state) {
  laves_mesh *mesh = graded_ball(*state);
  laves_domain *domain = ball_domain(*state, true);
  laves_certify_options options = laves_certify_options_default();
  laves_certificate c;
  options.domain = domain;
  assert_int_equal(laves_certify(*state, mesh, &options, &c, NULL), LAVES_OK);
  assert_int_equal(c.exception_counts[LAVES_EXCEPTION_DISTANT], 0);
  assert_int_equal(c.exception_counts[LAVES_EXCEPTION_OFF_SURFACE], 0);
  const double usual = c.check.to_surface_max;
  size_t tip = 0;
  for (size_t v = 0; v < mesh->vertex_count; v++)
    if (mesh->points[v].x > mesh->points[tip].x) tip = v;
  const double dent = 0.03;
  assert_true(dent < usual && dent < c.distance_asked);
  mesh->points[tip] = v3_scale(mesh->points[tip], 1 - dent);
  assert_int_equal(laves_certify(*state, mesh, &options, &c, NULL), LAVES_OK);
  assert_true(c.exception_counts[LAVES_EXCEPTION_DISTANT] >= 1);
  assert_int_equal(c.exception_counts[LAVES_EXCEPTION_OFF_SURFACE], 1);
  for (size_t i = 0; i < c.exception_count; i++) {
    const laves_exception *e = &c.exceptions[i];
    if (e->kind != LAVES_EXCEPTION_DISTANT && e->kind != LAVES_EXCEPTION_OFF_SURFACE) continue;
    const double base = e->kind == LAVES_EXCEPTION_DISTANT ? c.distance_asked : c.off_surface_asked;
    assert_true(e->value > e->limit && e->limit <= base / 2);
    assert_true(e->place[0] > 0.8);
  }
  laves_difference differences[4];
  size_t count;
  assert_int_equal(laves_certificate_verify(*state, mesh, domain, NULL, &c, differences, 4, &count, NULL), LAVES_OK);
  if (count) fail_msg("%s", differences[0].text);
  laves_domain_free(domain);
  laves_mesh_free(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(tree_finds_the_nearest),
      TEST(tree_of_a_few_triangles),
      TEST(tree_of_nothing),
      TEST(inscribed_ball),
      TEST(larger_sphere),
      TEST(missing_part),
      TEST(callback_domain),
      TEST(places_beyond),
      TEST(garbage_points),
      cmocka_unit_test(curvature_of_a_ball),
      TEST(window_of_kuhn),
      TEST(worst_first),
      cmocka_unit_test(short_of_memory),
      cmocka_unit_test_setup_teardown(levels_of_edges, set_up, tear_down),
      cmocka_unit_test_setup_teardown(levels_of_a_tree, set_up, tear_down),
      cmocka_unit_test_setup_teardown(samples_follow_the_edges, set_up, tear_down),
      cmocka_unit_test_setup_teardown(distances_by_the_edges, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
