/* Features of meshes: cubes that keep the creases of their solid, and cubes that lose them in known ways. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

#include "certify/check_features.h"
#include "fixtures/meshes.h"
#include "fixtures/shapes.h"

enum { SIDE = 8, CAPACITY = 40 };

static int set_up(void **state) {
  *state = laves_context_create(NULL);
  return *state == NULL;
}

static int tear_down(void **state) {
  const size_t left = laves_context_bytes(*state);
  laves_context_free(*state);
  return left != 0;
}

static laves_domain *domain_of(laves_context *context, shape s) {
  laves_domain *domain = NULL;
  assert_int_equal(
      laves_domain_from_triangles(context, s.points, s.point_count, s.triangles, s.triangle_count, NULL, &domain, NULL),
      LAVES_OK);
  shape_free(&s);
  return domain;
}

/* The solid that fixture_cubes(SIDE, SIDE, SIDE) fills. */
static laves_domain *cube_domain(laves_context *context) {
  return domain_of(context, shape_box((const double[3]){0, 0, 0}, (const double[3]){SIDE, SIDE, SIDE}, 4));
}

static laves_mesh *cube_mesh(laves_context *context) { return fixture_cubes(context, SIDE, SIDE, SIDE, NULL, NULL); }

typedef struct outcome {
  laves_feature_check check;
  laves_feature_place places[LAVES_FEATURE_FAULT_COUNT * CAPACITY];
  size_t count;
} outcome;

/* Checks against the cube's surface, and frees both. */
static outcome check_and_free(laves_context *context, laves_mesh *mesh, laves_domain *domain) {
  outcome o;
  laves_error error;
  if (laves_check_features(context, mesh, domain, NULL, &o.check, o.places, CAPACITY, &o.count, &error) != LAVES_OK)
    fail_msg("%s", error.text);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  return o;
}

static outcome check_cube(laves_context *context, laves_mesh *mesh) {
  return check_and_free(context, mesh, cube_domain(context));
}

static const laves_feature_place *first_of(const outcome *o, laves_feature_fault fault) {
  for (size_t i = 0; i < o->count; i++)
    if (o->places[i].fault == fault) return &o->places[i];
  fail_msg("no place of fault %s", laves_feature_fault_key(fault));
  return NULL;
}

static size_t count_of(const outcome *o, laves_feature_fault fault) {
  size_t count = 0;
  for (size_t i = 0; i < o->count; i++) count += o->places[i].fault == fault;
  return count;
}

/* ---- features made by hand ---- */

static int32_t side_of(const void *self, laves__vec3 foot, uint32_t hint) {
  (void)self;
  (void)hint;
  const double at[6] = {foot.x, SIDE - foot.x, foot.y, SIDE - foot.y, foot.z, SIDE - foot.z};
  int32_t nearest = 0;
  for (int32_t i = 1; i < 6; i++)
    if (fabs(at[i]) < fabs(at[nearest])) nearest = i;
  return nearest;
}

/* Foot on the cube [0, SIDE]^3 from within or near it. */
static bool project(const void *self, laves__vec3 p, double reach, uint32_t *hint, laves__vec3 *foot, laves__vec3 *normal) {
  const int32_t side = side_of(self, p, 0);
  (void)reach;
  (void)hint;
  *foot = p;
  *normal = v3(0, 0, 0);
  *v3_slot(foot, side / 2) = side % 2 ? SIDE : 0;
  *v3_slot(normal, side / 2) = side % 2 ? 1 : -1;
  return true;
}

/* Point i of a cube has coordinate k where bit k is set; sides are -x +x -y +y -z +z. */
static void add_cube_lines(laves__feature_lines *lines) {
  for (int i = 0; i < 8; i++) {
    uint32_t index;
    assert_true(laves__feature_lines_add_point(lines, v3(i & 1 ? SIDE : 0, i & 2 ? SIDE : 0, i & 4 ? SIDE : 0), &index));
  }
  for (int i = 0; i < 8; i++)
    for (int k = 0; k < 3; k++) {
      if (i >> k & 1) continue;
      const int u = (k + 1) % 3, v = (k + 2) % 3;
      const laves__feature_segment g = {
          .ends = {(uint32_t)i, (uint32_t)(i | 1 << k)}, .patch = {2 * u + (i >> u & 1), 2 * v + (i >> v & 1)}, .angle = 90};
      assert_true(laves__feature_lines_add_segment(lines, &g));
    }
}

static void features_made_by_hand(void **state) {
  laves_context *context = *state;
  const laves__oracle oracle = {.bounds = {{0, 0, 0}, {SIDE, SIDE, SIDE}}, .project = project};
  laves__features features = {.context = context, .oracle = &oracle, .patch_count = 6, .patch_at = side_of};
  laves__feature_lines lines = {.context = context};
  const laves__feature_wish wish = {.angle = 40, .size = 1};
  add_cube_lines(&lines);
  assert_int_equal(laves__features_chain(&lines, &wish, &features, NULL), LAVES_OK);
  laves_mesh *mesh = cube_mesh(context);
  laves__boundary boundary;
  assert_int_equal(laves__find_boundary(context, mesh, &boundary, NULL), LAVES_OK);
  const laves_feature_options options = laves_feature_options_default();
  laves_feature_check c;
  laves__feature_findings findings;
  assert_int_equal(laves__check_features_of(context, mesh, &boundary, &features, &options, &c, &findings, NULL), LAVES_OK);
  assert_int_equal(c.creases, 12);
  assert_int_equal(c.creases_kept, 12);
  assert_int_equal(c.corners_kept, 8);
  assert_int_equal(c.straddling, 0);
  assert_float_equal(c.length, 12 * SIDE, 1e-12);
  assert_float_equal(c.kept_share, 1, 1e-12);
  assert_int_equal(findings.edges.count, boundary.count * 3 / 2);
  laves__feature_findings_free(&findings);
  laves__boundary_free(&boundary);
  laves_mesh_free(mesh);
  laves__features_free(&features);
  laves__feature_lines_free(&lines);
}

/* ---- meshes that keep them ---- */

static void cube_is_kept(void **state) {
  const outcome o = check_cube(*state, cube_mesh(*state));
  const laves_feature_check *c = &o.check;
  assert_int_equal(c->creases, 12);
  assert_int_equal(c->short_creases, 0);
  assert_int_equal(c->creases_kept, 12);
  assert_float_equal(c->kept_share, 1, 1e-12);
  assert_float_equal(c->to_mesh_max, 0, 1e-12);
  assert_int_equal(c->corners, 8);
  assert_int_equal(c->corners_kept, 8);
  assert_int_equal(c->mesh_creases, 12 * SIDE);
  assert_float_equal(c->from_mesh_max, 0, 1e-12);
  assert_int_equal(c->spurious + c->mesh_bent + c->straddling + c->sharp, 0);
  assert_float_equal(c->sharpest, 90, 1e-4);
  assert_float_equal(c->away_min_dihedral, 45, 1e-9);
  assert_float_equal(c->free_max_dihedral, 90, 1e-9);
  assert_float_equal(c->tolerance, 1e-3 * c->diagonal, 1e-12);
  assert_int_equal(o.count, 0);
}

/* A kilometre away, and turned inside the file: nothing is lost. */
static void cube_far_away(void **state) {
  laves_mesh *mesh = cube_mesh(*state);
  for (size_t i = 0; i < mesh->vertex_count; i++) mesh->points[i] = v3_add(mesh->points[i], v3(1000, -2000, 500));
  shape box = shape_box((const double[3]){0, 0, 0}, (const double[3]){SIDE, SIDE, SIDE}, 1);
  shape_move(&box, 1000, -2000, 500);
  const outcome o = check_and_free(*state, mesh, domain_of(*state, box));
  assert_int_equal(o.check.creases_kept, 12);
  assert_int_equal(o.check.corners_kept, 8);
  assert_int_equal(o.count, 0);
}

/* A round bar 8 high: squares of a grid moved on to a disc, so that its rims are closed creases without a corner. */
static laves_mesh *bar_mesh(laves_context *context) {
  laves_mesh *mesh = cube_mesh(context);
  for (size_t i = 0; i < mesh->vertex_count; i++) {
    laves__vec3 *p = &mesh->points[i];
    const double x = p->x - SIDE / 2.0, y = p->y - SIDE / 2.0, norm = sqrt(x * x + y * y);
    const double share = norm > 0 ? fmax(fabs(x), fabs(y)) / norm : 0;
    *p = v3(x * share, y * share, p->z);
  }
  return mesh;
}

/* The solid within the boundary of a mesh. */
static laves_domain *domain_within(laves_context *context, const laves_mesh *mesh) {
  laves_domain *domain = NULL;
  assert_int_equal(laves_domain_from_triangles(context, &mesh->points->x, mesh->vertex_count, (const uint32_t *)mesh->faces,
                                               mesh->face_count, NULL, &domain, NULL),
                   LAVES_OK);
  return domain;
}

static void closed_creases(void **state) {
  laves_mesh *mesh = bar_mesh(*state);
  outcome o = check_and_free(*state, mesh, domain_within(*state, mesh));
  assert_int_equal(o.check.creases, 2);
  assert_int_equal(o.check.creases_kept, 2);
  assert_int_equal(o.check.corners, 0);
  assert_int_equal(o.check.mesh_creases, 2 * 4 * SIDE);
  assert_int_equal(o.count, 0);
  assert_true(o.check.length > 2 * 2 * 3.1 * SIDE / 2 && o.check.length < 2 * 2 * 3.15 * SIDE / 2);
  /* One rim drawn in by a tenth. */
  mesh = bar_mesh(*state);
  laves_domain *domain = domain_within(*state, mesh);
  for (size_t i = 0; i < mesh->vertex_count; i++) {
    laves__vec3 *p = &mesh->points[i];
    if (p->z == SIDE) *p = v3(0.9 * p->x, 0.9 * p->y, p->z);
  }
  o = check_and_free(*state, mesh, domain);
  assert_int_equal(o.check.creases_kept, 1);
  const laves_feature_place *rim = first_of(&o, LAVES_FEATURE_FAULT_CREASE);
  assert_float_equal(rim->place[2], SIDE, 1e-12);
  assert_true(rim->distance > 0.3 && rim->distance <= 0.4 + 1e-9);
  assert_float_equal(o.check.kept_share, 0.5, 0.01);
}

/* ---- meshes that do not ---- */

static void moved_corner(void **state) {
  laves_mesh *mesh = cube_mesh(*state);
  mesh->points[0] = v3(0.5, 0.5, 0.5);
  const outcome o = check_cube(*state, mesh);
  assert_int_equal(o.check.corners_kept, 7);
  assert_int_equal(o.check.corners_near, 0);
  const laves_feature_place *corner = first_of(&o, LAVES_FEATURE_FAULT_CORNER);
  for (int k = 0; k < 3; k++) assert_float_equal(corner->place[k], 0, 1e-12);
  /* The nearest edges are now those from (1, 0, 0) and its like to (0.5, 0.5, 0.5). */
  assert_float_equal(corner->distance, sqrt(2.0 / 3), 1e-12);
  assert_int_equal(o.check.creases_kept, 9);
  assert_int_equal(count_of(&o, LAVES_FEATURE_FAULT_CREASE), 3);
  assert_float_equal(o.check.to_mesh_max, corner->distance, 1e-12);
  assert_true(o.check.kept_share > 0.95 && o.check.kept_share < 0.99);
}

/* An edge still passes by the corner, though no vertex stands there. */
static void near_corner(void **state) {
  laves_mesh *mesh = cube_mesh(*state);
  mesh->points[0] = v3(0, 0, 5e-4);
  const outcome o = check_cube(*state, mesh);
  assert_int_equal(o.check.corners_kept, 7);
  assert_int_equal(o.check.corners_near, 1);
  assert_int_equal(o.check.creases_kept, 12);
}

/* The crease along x = y = 0 slides over the side y = 0, so that faces lie across it; the four creases at its ends lose a piece.
 */
static void straddled_crease(void **state) {
  laves_mesh *mesh = cube_mesh(*state);
  for (size_t i = 0; i < mesh->vertex_count; i++)
    if (mesh->points[i].x == 0 && mesh->points[i].y == 0) mesh->points[i].x = 0.4;
  const outcome o = check_cube(*state, mesh);
  assert_true(o.check.straddling >= SIDE);
  assert_true(o.check.spurious >= SIDE);
  assert_int_equal(o.check.creases_kept, 12 - 1 - 4);
  assert_int_equal(o.check.corners_kept, 6);
  const laves_feature_place *crease = first_of(&o, LAVES_FEATURE_FAULT_CREASE);
  assert_float_equal(crease->length, SIDE, 1e-12);
  assert_float_equal(crease->angle, 90, 1e-4);
  const laves_feature_place *across = first_of(&o, LAVES_FEATURE_FAULT_STRADDLING);
  assert_true(across->place[0] < 0.4 && across->place[1] < 1 && across->index >= 0);
}

/* A dent in the middle of a side: sharp edges where the solid is flat. */
static bool keep_but_one(void *user, int x, int y, int z) {
  (void)user;
  return !(x == 4 && y == 4 && z == SIDE - 1);
}

static void dent(void **state) {
  const outcome o = check_cube(*state, fixture_cubes(*state, SIDE, SIDE, SIDE, keep_but_one, NULL));
  assert_int_equal(o.check.creases_kept, 12);
  assert_int_equal(o.check.mesh_creases, 12 * SIDE + 12);
  assert_int_equal(o.check.spurious, 12);
  assert_int_equal(o.check.mesh_bent, 0);
  assert_float_equal(o.check.from_mesh_max, 3 * sqrt(2), 1.0);
  const laves_feature_place *edge = first_of(&o, LAVES_FEATURE_FAULT_SPURIOUS);
  assert_float_equal(edge->angle, 90, 1e-4);
  assert_float_equal(edge->distance, o.check.from_mesh_max, 0);
  for (size_t i = 1; i < o.count; i++) assert_true(o.places[i].distance <= o.places[i - 1].distance);
}

/* A ball in place of a cube keeps nothing, and all that it is judged by is finite. */
static void ball_in_a_cube(void **state) {
  laves_mesh *mesh = fixture_ball(*state, SIDE, SIDE / 2.0);
  for (size_t i = 0; i < mesh->vertex_count; i++)
    mesh->points[i] = v3_add(mesh->points[i], v3(SIDE / 2.0, SIDE / 2.0, SIDE / 2.0));
  const outcome o = check_cube(*state, mesh);
  assert_int_equal(o.check.creases_kept, 0);
  assert_int_equal(o.check.corners_kept + o.check.corners_near, 0);
  assert_float_equal(o.check.kept_share, 0, 1e-12);
  assert_float_equal(o.check.to_mesh_max, SIDE / 2.0 * (sqrt(3) - 1), 0.1);
  assert_int_equal(count_of(&o, LAVES_FEATURE_FAULT_CREASE), 12);
  assert_int_equal(count_of(&o, LAVES_FEATURE_FAULT_CORNER), 8);
}

/* ---- solids without creases, and with sharp ones ---- */

static void smooth_solid(void **state) {
  const outcome o = check_and_free(*state, fixture_ball(*state, SIDE, 1), domain_of(*state, shape_sphere(1, 12)));
  assert_int_equal(o.check.creases, 0);
  assert_int_equal(o.check.corners, 0);
  assert_float_equal(o.check.kept_share, 1, 0);
  assert_true(isnan(o.check.sharpest));
  assert_int_equal(o.check.sharp, 0);
}

/* A coarse ball bends by more than 40 degrees at its edges: the doing of the size, not sharp edges that should not be. */
static void bend_is_no_crease(void **state) {
  const outcome o = check_and_free(*state, fixture_ball(*state, 2, 1), domain_of(*state, shape_sphere(1, 12)));
  assert_true(o.check.mesh_creases > 0);
  assert_int_equal(o.check.mesh_bent, o.check.mesh_creases);
  assert_int_equal(o.check.spurious, 0);
}

/* A prism with edges of 45, 45 and 90 degrees: half a cube, made of the cubes below a diagonal plane. */
static void sharp_prism(void **state) {
  static const double points[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  static const uint32_t triangles[8][3] = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                                           {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  static const int32_t tets[3][4] = {{0, 1, 2, 3}, {1, 2, 3, 4}, {2, 5, 3, 4}};
  laves_domain *domain = NULL;
  laves_mesh *mesh = NULL;
  assert_int_equal(laves_domain_from_triangles(*state, points[0], 6, triangles[0], 8, NULL, &domain, NULL), LAVES_OK);
  assert_int_equal(laves_mesh_from_arrays(*state, points[0], 6, tets[0], 3, NULL, &mesh, NULL), LAVES_OK);
  const outcome o = check_and_free(*state, mesh, domain);
  assert_int_equal(o.check.creases, 9);
  /* Edges of 1 beside some of sqrt(2) are short, and so are the two corners at which only such end. */
  assert_int_equal(o.check.short_creases, 7);
  assert_int_equal(o.check.short_corners, 2);
  assert_int_equal(o.check.corners_kept, 4);
  assert_int_equal(o.check.sharp, 2);
  assert_float_equal(o.check.sharpest, 45, 1e-4);
  const laves_feature_place *sharp = first_of(&o, LAVES_FEATURE_FAULT_SHARP);
  assert_float_equal(sharp->angle, 45, 1e-4);
  assert_float_equal(sharp->length, 1, 1e-12);
  assert_float_equal(sharp->place[2], 0.5, 1e-12);
  assert_true(sharp->dihedral > 0 && sharp->dihedral < 45 + 1e-9);
  assert_in_range(sharp->index, 0, 2);
  assert_true(isnan(o.check.away_min_dihedral));
  assert_true(isnan(o.check.free_min_dihedral));
}

/* ---- arguments, and hostile meshes ---- */

static void options_are_checked(void **state) {
  laves_mesh *mesh = cube_mesh(*state);
  laves_domain *domain = cube_domain(*state);
  laves_feature_options options = laves_feature_options_default();
  laves_feature_check check;
  size_t count;
  laves_error error;
  options.angle = 180;
  assert_int_equal(laves_check_features(*state, mesh, domain, &options, &check, NULL, 0, &count, &error), LAVES_ERROR_OPTION);
  assert_non_null(strstr(error.text, "180"));
  options = (laves_feature_options){.angle = 40};
  assert_int_equal(laves_check_features(*state, mesh, domain, &options, &check, NULL, 0, &count, &error), LAVES_ERROR_OPTION);
  options = laves_feature_options_default();
  options.angle = 0;
  assert_int_equal(laves_check_features(*state, mesh, domain, &options, &check, NULL, 0, &count, &error), LAVES_OK);
  assert_int_equal(check.creases + check.mesh_creases, 0);
  options.angle = 100;
  assert_int_equal(laves_check_features(*state, mesh, domain, &options, &check, NULL, 0, &count, &error), LAVES_OK);
  assert_int_equal(check.creases, 0);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
}

static void hostile_meshes(void **state) {
  laves_mesh *mesh = cube_mesh(*state);
  for (size_t i = 0; i < mesh->vertex_count; i += 7) mesh->points[i].x = i % 2 ? NAN : INFINITY;
  for (size_t t = 0; t < mesh->tet_count; t += 11) mesh->tets[t][1] = t % 2 ? -5 : (int32_t)mesh->vertex_count;
  const outcome o = check_cube(*state, mesh);
  assert_int_equal(o.check.creases, 12);
  assert_true(o.check.kept_share < 1);
}

static void mesh_without_tets(void **state) {
  const double point[3] = {0, 0, 0};
  laves_mesh *mesh = NULL;
  laves_domain *domain = cube_domain(*state);
  laves_feature_check check;
  size_t count;
  laves_error error;
  assert_int_equal(laves_mesh_from_arrays(*state, point, 1, NULL, 0, NULL, &mesh, NULL), LAVES_OK);
  assert_int_equal(laves_check_features(*state, mesh, domain, NULL, &check, NULL, 0, &count, &error), LAVES_ERROR_INPUT);
  assert_non_null(strstr(error.text, "no boundary"));
  laves_mesh_free(mesh);
  laves_domain_free(domain);
}

/* ---- promises ---- */

/* Member by member: what fills up the struct behind the first is anything. */
static void assert_same_place(const laves_feature_place *a, const laves_feature_place *b) {
  assert_int_equal(a->fault, b->fault);
  assert_memory_equal(a->place, b->place, sizeof a->place);
  assert_memory_equal(&a->distance, &b->distance, sizeof a->distance);
  assert_memory_equal(&a->length, &b->length, sizeof a->length);
  assert_memory_equal(&a->angle, &b->angle, sizeof a->angle);
  assert_memory_equal(&a->dihedral, &b->dihedral, sizeof a->dihedral);
  assert_int_equal(a->index, b->index);
}

static void same_for_any_threads(void **state) {
  outcome first = {0};
  (void)state;
  for (int threads = 1; threads <= 3; threads++) {
    laves_context_options options = laves_context_options_default();
    options.thread_count = threads;
    laves_context *context = laves_context_create(&options);
    laves_mesh *mesh = cube_mesh(context);
    for (size_t i = 0; i < mesh->vertex_count; i++)
      if (mesh->points[i].x == 0 && mesh->points[i].y == 0) mesh->points[i].x = 0.3;
    const outcome o = check_cube(context, mesh);
    if (threads == 1) first = o;
    assert_memory_equal(&o.check, &first.check, sizeof o.check);
    assert_int_equal(o.count, first.count);
    for (size_t i = 0; i < o.count; i++) assert_same_place(&o.places[i], &first.places[i]);
    laves_context_free(context);
  }
}

/* With memory running out at any point, it says so and leaves nothing behind. */
static void short_memory(void **state) {
  laves_mesh *mesh = cube_mesh(*state);
  laves_domain *domain = cube_domain(*state);
  const size_t needed = laves_context_bytes(*state);
  bool done = false;
  for (size_t more = 1000; !done && more < 4000000; more += more / 4) {
    laves_context_options limited = laves_context_options_default();
    limited.memory_limit = more;
    laves_context *context = laves_context_create(&limited);
    laves_feature_check check;
    size_t count;
    const laves_result result = laves_check_features(context, mesh, domain, NULL, &check, NULL, 0, &count, NULL);
    done = result == LAVES_OK;
    if (!done) assert_int_equal(result, LAVES_ERROR_MEMORY);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
  }
  assert_true(done);
  assert_int_equal(laves_context_bytes(*state), needed);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(features_made_by_hand, set_up, tear_down),
      cmocka_unit_test_setup_teardown(cube_is_kept, set_up, tear_down),
      cmocka_unit_test_setup_teardown(cube_far_away, set_up, tear_down),
      cmocka_unit_test_setup_teardown(closed_creases, set_up, tear_down),
      cmocka_unit_test_setup_teardown(moved_corner, set_up, tear_down),
      cmocka_unit_test_setup_teardown(near_corner, set_up, tear_down),
      cmocka_unit_test_setup_teardown(straddled_crease, set_up, tear_down),
      cmocka_unit_test_setup_teardown(dent, set_up, tear_down),
      cmocka_unit_test_setup_teardown(ball_in_a_cube, set_up, tear_down),
      cmocka_unit_test_setup_teardown(smooth_solid, set_up, tear_down),
      cmocka_unit_test_setup_teardown(bend_is_no_crease, set_up, tear_down),
      cmocka_unit_test_setup_teardown(sharp_prism, set_up, tear_down),
      cmocka_unit_test_setup_teardown(options_are_checked, set_up, tear_down),
      cmocka_unit_test_setup_teardown(hostile_meshes, set_up, tear_down),
      cmocka_unit_test_setup_teardown(mesh_without_tets, set_up, tear_down),
      cmocka_unit_test(same_for_any_threads),
      cmocka_unit_test_setup_teardown(short_memory, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
