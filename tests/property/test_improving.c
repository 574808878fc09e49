/* What laves_improve() promises, on meshes made bad at random: the shape, its regions and its tags stay; angles never get worse;
 * the mesh does not depend on the number of threads. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#include "fixtures/meshes.h"
#include "fixtures/spoilt.h"
#include "fixtures/stride.h"
#include "fixtures/tagged_cube.h"

enum { SEEDS = 3, TAG_MAX = 20 };

static double face_area(const laves_mesh *m, size_t f) {
  const laves__vec3 *p = m->points;
  const int32_t *c = m->faces[f];
  return 0.5 * v3_norm(v3_cross(v3_sub(p[c[1]], p[c[0]]), v3_sub(p[c[2]], p[c[0]])));
}

static void tag_areas(const laves_mesh *m, double area[TAG_MAX]) {
  for (int i = 0; i < TAG_MAX; i++) area[i] = 0;
  for (size_t f = 0; f < m->face_count; f++) area[m->face_tags ? m->face_tags[f] : 1] += face_area(m, f);
}

static void region_volumes(const laves_mesh *m, double volume[TAG_MAX]) {
  for (int i = 0; i < TAG_MAX; i++) volume[i] = 0;
  for (size_t t = 0; t < m->tet_count; t++) {
    const int32_t *c = m->tets[t];
    volume[m->regions ? m->regions[t] : 1] += v3_det(m->points[c[0]], m->points[c[1]], m->points[c[2]], m->points[c[3]]) / 6;
  }
}

/* Whether a point is on a face, or within `slack` of its plane and, in it, of the face. */
static bool on_face(const laves_mesh *m, size_t f, laves__vec3 p, double slack) {
  const laves__vec3 a = m->points[m->faces[f][0]], b = m->points[m->faces[f][1]], c = m->points[m->faces[f][2]];
  const laves__vec3 normal = v3_unit(v3_cross(v3_sub(b, a), v3_sub(c, a)));
  if (fabs(v3_dot(normal, v3_sub(p, a))) > slack) return false;
  const laves__vec3 corner[3] = {a, b, c};
  for (int k = 0; k < 3; k++) {
    const laves__vec3 edge = v3_sub(corner[(k + 1) % 3], corner[k]);
    if (v3_dot(v3_cross(normal, edge), v3_sub(p, corner[k])) < -slack * v3_norm(edge)) return false;
  }
  return true;
}

/* Middles of faces, and so all of them where the old ones are flat, lie on faces that were there. */
static void assert_on_old_boundary(const laves_mesh *now, const laves_mesh *before, double slack) {
  for (size_t f = 0; f < now->face_count; f++) {
    const laves__vec3 p = fixture_centroid(now, now->faces[f], 3);
    bool found = false;
    for (size_t g = 0; g < before->face_count && !found; g++) found = on_face(before, g, p, slack);
    if (!found) fail_msg("the middle (%g, %g, %g) of face %zu is off the boundary", p.x, p.y, p.z, f);
  }
}

static void assert_same_parts(const laves_mesh *now, const laves_mesh *before) {
  double a[TAG_MAX], b[TAG_MAX];
  tag_areas(now, a);
  tag_areas(before, b);
  for (int i = 0; i < TAG_MAX; i++)
    if (fabs(a[i] - b[i]) > 1e-9) fail_msg("tag %d has the area %.12g, not %.12g", i, a[i], b[i]);
  region_volumes(now, a);
  region_volumes(before, b);
  for (int i = 0; i < TAG_MAX; i++)
    if (fabs(a[i] - b[i]) > 1e-9) fail_msg("region %d has the volume %.12g, not %.12g", i, a[i], b[i]);
}

/* Improves a mesh on a number of threads; the hash is kept. */
static laves_improve_report improve(const laves_mesh *mesh, const laves_improve_options *options, int threads, laves_mesh **out,
                                    laves_context **context, char hash[33]) {
  laves_context_options o = laves_context_options_default();
  laves_improve_report report;
  laves_error error = {0};
  o.thread_count = threads;
  *context = laves_context_create(&o);
  const laves_result result = laves_improve(*context, mesh, options, out, &report, &error);
  if (result != LAVES_OK && result != LAVES_TARGET_MISSED) fail_msg("%s", error.text);
  assert_int_equal(result == LAVES_OK, report.outside_after == 0);
  laves_mesh_hash(*out, hash);
  return report;
}

static void check_promises(const laves_mesh *mesh, const laves_improve_options *options) {
  laves_mesh *out, *again;
  laves_context *context, *other;
  char hash[33], second[33];
  const laves_improve_report r = improve(mesh, options, 1, &out, &context, hash);
  improve(mesh, options, 2, &again, &other, second);
  assert_string_equal(hash, second);
  assert_true(r.after.valid);
  assert_false(r.kept_as_it_was);
  assert_true(r.after.min_dihedral.min >= r.before.min_dihedral.min - 1e-9);
  assert_true(r.after.max_dihedral.max <= r.before.max_dihedral.max + 1e-9);
  assert_int_equal(r.after.genus, r.before.genus);
  assert_int_equal(r.after.components, r.before.components);
  if (options->tolerance == 0) {
    assert_same_parts(out, mesh);
    assert_on_old_boundary(out, mesh, 1e-9);
  } else {
    assert_on_old_boundary(out, mesh, 1.001 * options->tolerance);
  }
  if (options->fixed_boundary) assert_int_equal(out->face_count, mesh->face_count);
  laves_mesh_free(out);
  laves_mesh_free(again);
  laves_context_free(context);
  laves_context_free(other);
}

static void check_kind(laves_mesh *made(laves_context *context, uint64_t seed)) {
  laves_context *context = laves_context_create(NULL);
  for (uint64_t seed = 1; seed <= SEEDS; seed += (uint64_t)test_stride()) {
    laves_mesh *mesh = made(context, seed);
    laves_improve_options options = laves_improve_options_default();
    print_message("seed %llu\n", (unsigned long long)seed);
    check_promises(mesh, &options);
    options.fixed_boundary = true;
    check_promises(mesh, &options);
    options.fixed_boundary = false;
    options.tolerance = 0.01;
    options.volume_length = 0.3;
    check_promises(mesh, &options);
    laves_mesh_free(mesh);
  }
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static laves_mesh *cube_with_parts(laves_context *context, uint64_t seed) {
  laves_mesh *plain = fixture_tagged_cube(context, 4);
  laves_mesh *spoilt = fixture_spoilt(context, plain, 200, 1, seed);
  fixture_tag_cube(spoilt);
  laves_mesh_free(plain);
  return spoilt;
}

static laves_mesh *plain_cube(laves_context *context, uint64_t seed) {
  laves_mesh *plain = fixture_plain_cube(context, 5);
  laves_mesh *spoilt = fixture_spoilt(context, plain, 300, 1, seed);
  laves_mesh_free(plain);
  return spoilt;
}

static laves_mesh *ball(laves_context *context, uint64_t seed) {
  laves_mesh *plain = fixture_ball(context, 5, 1);
  laves_mesh *spoilt = fixture_spoilt(context, plain, 300, 0, seed);
  laves_mesh_free(plain);
  return spoilt;
}

static laves_mesh *ring(laves_context *context, uint64_t seed) {
  laves_mesh *plain = fixture_ring(context);
  laves_mesh *spoilt = fixture_spoilt(context, plain, 60, 0, seed);
  laves_mesh_free(plain);
  return spoilt;
}

/* Every tet a region or another at random: borders everywhere. */
static laves_mesh *motley_cube(laves_context *context, uint64_t seed) {
  laves_mesh *plain = fixture_plain_cube(context, 4);
  plain->regions = laves__alloc(context, plain->tet_count, sizeof *plain->regions);
  for (size_t t = 0; t < plain->tet_count; t++) plain->regions[t] = 1 + (int32_t)(((t * 2654435761u + seed) >> 7) % 3);
  laves_mesh *spoilt = fixture_spoilt(context, plain, 150, 0, seed);
  laves_mesh_free(plain);
  return spoilt;
}

/* Two cubes that share an edge, and two that share a corner: the boundary touches itself. */
static bool keep_touching(void *user, int x, int y, int z) {
  (void)user;
  return (x < 2 && y < 2 && z < 2) || (x >= 2 && y >= 2 && z < 2) || (x >= 2 && y < 2 && z >= 2);
}

static laves_mesh *touching(laves_context *context, uint64_t seed) {
  laves_mesh *plain = fixture_cubes(context, 4, 4, 4, keep_touching, NULL);
  laves_mesh *spoilt = fixture_spoilt(context, plain, 100, 0, seed);
  laves_mesh_free(plain);
  return spoilt;
}

static void test_cube_with_parts(void **state) {
  (void)state;
  check_kind(cube_with_parts);
}
static void test_plain_cube(void **state) {
  (void)state;
  check_kind(plain_cube);
}
static void test_ball(void **state) {
  (void)state;
  check_kind(ball);
}
static void test_ring(void **state) {
  (void)state;
  check_kind(ring);
}
static void test_motley_cube(void **state) {
  (void)state;
  check_kind(motley_cube);
}

static void test_touching(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL), *other;
  for (uint64_t seed = 1; seed <= SEEDS; seed += (uint64_t)test_stride()) {
    laves_mesh *mesh = touching(context, seed), *out;
    char hash[33];
    const laves_improve_options options = laves_improve_options_default();
    const laves_improve_report r = improve(mesh, &options, 2, &out, &other, hash);
    assert_false(r.kept_as_it_was);
    assert_int_equal(r.after.inverted_tets + r.after.nonconforming_faces, 0);
    assert_true(r.after.nonmanifold_edges <= r.before.nonmanifold_edges);
    assert_true(r.after.min_dihedral.min > r.before.min_dihedral.min);
    assert_same_parts(out, mesh);
    laves_mesh_free(out);
    laves_context_free(other);
    laves_mesh_free(mesh);
  }
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_cube_with_parts),
      cmocka_unit_test(test_plain_cube),
      cmocka_unit_test(test_ball),
      cmocka_unit_test(test_ring),
      cmocka_unit_test(test_motley_cube),
      cmocka_unit_test(test_touching),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
