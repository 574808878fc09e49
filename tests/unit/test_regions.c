/* Regions of meshes, and the faces of the input that boundary faces are nearest to. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "domain/surface.h"
#include "fixtures/folders.h"
#include "fixtures/shapes.h"
#include "fixtures/stages.h"
#include "fixtures/stride.h"

static laves_domain *domain_of(laves_context *context, const shape *s, const int32_t *tags) {
  laves_domain *domain = NULL;
  laves_error error = {0};
  if (laves_domain_from_triangles(context, s->points, s->point_count, s->triangles, s->triangle_count, tags, &domain, &error))
    fail_msg("%s", error.text);
  return domain;
}

static laves_context *context_with_threads(int count) {
  laves_context_options options = laves_context_options_default();
  options.thread_count = count;
  return laves_context_create(&options);
}

static bool warned(const laves_report *report, const char *phrase) {
  for (int i = 0; i < report->warning_count; i++)
    if (strstr(report->warnings[i], phrase)) return true;
  return false;
}

static laves_mesh *generate(laves_context *context, const laves_domain *domain, const laves_options *options,
                            laves_report *report) {
  laves_mesh *mesh = NULL;
  laves_error error = {0};
  if (laves_generate(context, domain, options, &mesh, report, &error) != LAVES_OK) fail_msg("%s", error.text);
  return mesh;
}

/* Volumes of regions 1 .. count; every region is one of them. */
static void region_volumes(const laves_mesh *mesh, double *volumes, int count) {
  for (int i = 0; i < count; i++) volumes[i] = 0;
  for (size_t t = 0; t < mesh->tet_count; t++) {
    const int32_t *v = mesh->tets[t];
    assert_in_range(mesh->regions[t], 1, count);
    volumes[mesh->regions[t] - 1] += v3_det(mesh->points[v[0]], mesh->points[v[1]], mesh->points[v[2]], mesh->points[v[3]]) / 6;
  }
}

/* A ball in a ball, and a box that touches nothing. */
static shape ball_in_ball(void) {
  const double lower[3] = {2, -0.5, -0.5}, upper[3] = {3, 0.5, 0.5};
  shape s = shape_sphere(1.2, 12), inner = shape_sphere(0.6, 12), box = shape_box(lower, upper, 2);
  shape_append(&s, &inner);
  shape_append(&s, &box);
  shape_free(&inner);
  shape_free(&box);
  return s;
}

static void nested_parts_become_regions(void **state) {
  (void)state;
  shape s = ball_in_ball();
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain = domain_of(context, &s, NULL);
  laves_options options = options_of_size(0.1);
  options.regions = LAVES_REGIONS_PARTS;
  laves_report report;
  laves_mesh *mesh = generate(context, domain, &options, &report);
  double volumes[3];
  region_volumes(mesh, volumes, 3);
  const double inner = 0.904, outer = 7.23 - inner; /* of the balls, less what facets lose */
  assert_true(fabs(volumes[0] / outer - 1) < 0.03);
  assert_true(fabs(volumes[1] / inner - 1) < 0.05);
  assert_true(fabs(volumes[2] - 1) < 0.05);
  assert_string_equal(laves_mesh_group_name(mesh, 3, 1), "part 1");
  assert_string_equal(laves_mesh_group_name(mesh, 3, 3), "part 3");
  assert_null(laves_mesh_group_name(mesh, 3, 4));
  assert_true(warned(&report, "interfaces between regions follow the tetrahedra"));
  for (size_t t = 0; t < mesh->tet_count; t++) { /* by centroid, where the balls tell */
    laves__vec3 c = {0, 0, 0};
    for (int k = 0; k < 4; k++) c = v3_mad(c, mesh->points[mesh->tets[t][k]], 0.25);
    if (c.x < 1.5 && fabs(v3_norm(c) - 0.6) > 0.01) assert_int_equal(mesh->regions[t], v3_norm(c) < 0.6 ? 2 : 1);
  }
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
  shape_free(&s);
}

static void regions_do_not_depend_on_threads(void **state) {
  (void)state;
  shape s = ball_in_ball();
  char digits[2][33];
  for (int i = 0; i < 2; i++) {
    laves_context *context = context_with_threads(i == 0 ? 1 : 4);
    laves_domain *domain = domain_of(context, &s, NULL);
    laves_options options = options_of_size(0.15);
    options.regions = LAVES_REGIONS_PARTS;
    laves_mesh *mesh = generate(context, domain, &options, NULL);
    uint64_t sum = 0;
    for (size_t t = 0; t < mesh->tet_count; t++) sum = sum * 31 + (uint64_t)mesh->regions[t];
    snprintf(digits[i], sizeof digits[i], "%016llx", (unsigned long long)sum);
    laves_mesh_free(mesh);
    laves_domain_free(domain);
    laves_context_free(context);
  }
  assert_string_equal(digits[0], digits[1]);
  shape_free(&s);
}

static void one_part_is_no_region(void **state) {
  (void)state;
  static const char *const expressions[] = {"sphere(1)"};
  laves_context *context = laves_context_create(NULL);
  shape s = shape_sphere(1, 6);
  laves_domain *domains[2] = {domain_of(context, &s, NULL), NULL};
  assert_int_equal(laves_domain_from_expression(context, expressions[0], &domains[1], NULL), LAVES_OK);
  for (int i = 0; i < 2; i++) {
    laves_options options = options_of_size(0.3);
    options.regions = LAVES_REGIONS_PARTS;
    laves_report report;
    laves_mesh *mesh = generate(context, domains[i], &options, &report);
    assert_null(laves_mesh_regions(mesh));
    assert_string_equal(laves_mesh_group_name(mesh, 3, 1), "solid");
    assert_true(warned(&report, "does not have two closed parts"));
    laves_mesh_free(mesh);
    laves_domain_free(domains[i]);
  }
  laves_context_free(context);
  shape_free(&s);
}

/* Named insides of formulas: the first named counts, names move with their solid, and what has none is "solid". */
static void named_solids_become_regions(void **state) {
  (void)state;
  static const char text[] =
      "union(region('core', sphere(0.5)), region('shell', sphere(1))):move(10, 0, 0)"
      " + (region('half', x - 13) & box{1, 1, 1}:move(13, 0, 0)) + box{1, 1, 1}:move(13, 0, 0)";
  laves_context *context = laves_context_create(NULL);
  laves_options options = options_of_size(0.09);
  laves_report report;
  laves_mesh *mesh = mesh_of_expression(context, text, &options, &report);
  assert_non_null(mesh->regions);
  double volumes[4];
  region_volumes(mesh, volumes, 4);
  static const double expected[4] = {0.5, 0.5236, 4.18879 - 0.5236, 0.5};
  for (int i = 0; i < 4; i++)
    if (fabs(volumes[i] / expected[i] - 1) > 0.06) fail_msg("region %d: volume %g, not %g", i + 1, volumes[i], expected[i]);
  static const char *const names[4] = {"solid", "core", "shell", "half"};
  for (int i = 0; i < 4; i++) assert_string_equal(laves_mesh_group_name(mesh, 3, i + 1), names[i]);
  assert_true(warned(&report, "interfaces between regions follow the tetrahedra"));
  laves_mesh_free(mesh);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

/* Of three boxes one is open, and one smaller than any tet. */
static void what_is_in_no_part_is_the_rest(void **state) {
  (void)state;
  const double l[3][3] = {{0, 0, 0}, {2, 0, 0}, {0.2, 0.2, 0.2}}, u[3][3] = {{1, 1, 1}, {3, 1, 1}, {0.201, 0.201, 0.201}};
  shape s = shape_box(l[0], u[0], 2), tiny = shape_box(l[2], u[2], 1), open = shape_box(l[1], u[1], 2);
  shape_append(&s, &tiny);
  shape_append(&s, &open);
  s.triangle_count--;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain = domain_of(context, &s, NULL);
  laves_options options = options_of_size(0.13);
  options.regions = LAVES_REGIONS_PARTS;
  laves_report report;
  laves_mesh *mesh = generate(context, domain, &options, &report);
  double volumes[3];
  region_volumes(mesh, volumes, 3);
  assert_true(volumes[1] == 0);
  assert_true(volumes[0] > 0.9 && volumes[2] > 0.8);
  assert_string_equal(laves_mesh_group_name(mesh, 3, 3), "rest");
  assert_true(warned(&report, "1 of the 2 parts of the input hold no tetrahedron"));
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  laves_context_free(context);
  shape_free(&s);
  shape_free(&tiny);
  shape_free(&open);
}

/* Gives memory so many times, then none. */
static void *reallocate_a_few_times(void *user, void *pointer, size_t old_bytes, size_t new_bytes) {
  int *left = user;
  (void)old_bytes;
  if (new_bytes == 0) {
    free(pointer);
    return NULL;
  }
  return __atomic_fetch_sub(left, 1, __ATOMIC_RELAXED) > 0 ? realloc(pointer, new_bytes) : NULL;
}

/* From the first allocation of the domain to the last of the mesh, in growing steps. */
static void short_memory_anywhere_leaves_nothing(void **state) {
  (void)state;
  shape s = ball_in_ball();
  bool made = false;
  for (int allowed = 0, step = 1; !made; allowed += step * test_stride(), step += allowed > 200) {
    int left = allowed;
    laves_context_options context_options = laves_context_options_default();
    context_options.reallocate = reallocate_a_few_times;
    context_options.reallocate_user = &left;
    context_options.thread_count = 1;
    laves_context *context = laves_context_create(&context_options);
    if (!context) continue;
    laves_domain *domain = NULL;
    laves_mesh *mesh = NULL;
    laves_options options = options_of_size(0.4);
    options.regions = LAVES_REGIONS_PARTS;
    options.face_sources = true;
    options.improve = false;
    laves_result result =
        laves_domain_from_triangles(context, s.points, s.point_count, s.triangles, s.triangle_count, NULL, &domain, NULL);
    if (result == LAVES_OK) result = laves_generate(context, domain, &options, &mesh, NULL, NULL);
    made = result == LAVES_OK;
    assert_true(made || result == LAVES_ERROR_MEMORY);
    assert_true(made == (mesh != NULL));
    laves_mesh_free(mesh);
    laves_domain_free(domain);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
  }
  shape_free(&s);
}

/* ---- sources ---- */

/* The input's triangles in a tree of their own; slot[t] is where triangle t stands. */
typedef struct tree {
  laves__bvh bvh;
  uint32_t slot[1000];
} tree;

static void make_tree(laves_context *context, const shape *s, tree *made) {
  uint32_t order[1000];
  const laves__vec3 *points = (const laves__vec3 *)s->points;
  const uint32_t(*faces)[3] = (const uint32_t(*)[3])s->triangles;
  assert_true(s->triangle_count < 1000);
  *made = (tree){0};
  assert_true(laves__bvh_build(context, points, faces, s->triangle_count, order, &made->bvh));
  for (uint32_t i = 0; i < s->triangle_count; i++) made->slot[order[i]] = i;
}

static laves__vec3 face_centroid(const laves_mesh *mesh, size_t f) {
  const int32_t *v = mesh->faces[f];
  return v3_scale(v3_add(mesh->points[v[0]], v3_add(mesh->points[v[1]], mesh->points[v[2]])), 1.0 / 3);
}

/* Through welding, repeated and degenerate triangles, walls that are left out: the number is the input's. */
static void faces_know_the_triangle_they_lie_on(void **state) {
  (void)state;
  const double lower[3] = {0.2, 0.1, 0}, upper[3] = {1.5, 0.9, 0.7}, lower2[3] = {1, 0.3, 0.2}, upper2[3] = {2, 0.5, 0.4};
  shape s = shape_box(lower, upper, 3), again = shape_box(lower, upper, 3), bar = shape_box(lower2, upper2, 1);
  again.triangle_count = 5;
  again.triangles[3] = again.triangles[4]; /* without area */
  shape_append(&again, &s);
  shape_append(&again, &bar);
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain = domain_of(context, &again, NULL);
  laves_options options = options_of_size(0.08);
  options.face_sources = true;
  laves_mesh *mesh = generate(context, domain, &options, NULL);
  const int32_t *sources = laves_mesh_face_sources(mesh);
  assert_non_null(sources);
  tree all;
  make_tree(context, &again, &all);
  for (size_t f = 0; f < mesh->face_count; f++) {
    assert_in_range(sources[f], 0, again.triangle_count - 1);
    const laves__vec3 c = face_centroid(mesh, f);
    if (c.x > 0.9) continue; /* there the nearest may be a part of the bar within the box, which is none of the surface */
    laves__nearest best = {INFINITY, LAVES__NONE};
    laves__bvh_nearest(&all.bvh, c, &best);
    const double distance2 = laves__triangle_distance2(&all.bvh.triangles[all.slot[sources[f]]], c);
    assert_true(sqrt(distance2) <= sqrt(best.distance2) + 1e-12);
  }
  laves__bvh_free(context, &all.bvh);
  laves_mesh_free(mesh);
  options.face_sources = false;
  mesh = generate(context, domain, &options, NULL);
  assert_null(laves_mesh_face_sources(mesh));
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
  shape_free(&s);
  shape_free(&again);
  shape_free(&bar);
}

/* A cube of quadrangles: six faces, however they are cut. */
static void polygons_count_once(void **state) {
  (void)state;
  static const char cube[] =
      "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
      "4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 20];
  assert_true(fixture_folder_make(folder));
  snprintf(path, sizeof path, "%s/cube.off", folder);
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  fputs(cube, file);
  fclose(file);
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain;
  assert_int_equal(laves_domain_from_file(context, path, &domain, NULL), LAVES_OK);
  laves_options options = options_of_size(0.15);
  options.face_sources = true;
  laves_mesh *mesh = generate(context, domain, &options, NULL);
  size_t seen[6] = {0};
  for (size_t f = 0; f < mesh->face_count; f++) {
    const laves__vec3 c = face_centroid(mesh, f);
    const double off[6] = {c.z, 1 - c.z, c.y, 1 - c.x, 1 - c.y, c.x};
    const int32_t source = mesh->face_sources[f];
    assert_in_range(source, 0, 5);
    seen[source]++;
    for (int i = 0; i < 6; i++) assert_true(fabs(off[source]) <= fabs(off[i]) + 1e-9);
  }
  for (int i = 0; i < 6; i++) assert_true(seen[i] > 20);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  laves_context_free(context);
  fixture_folder_remove(folder);
}

static void implicit_solids_have_no_sources(void **state) {
  (void)state;
  laves_options options = options_of_size(0.3);
  options.face_sources = true;
  laves_context *context = laves_context_create(NULL);
  laves_report report;
  laves_mesh *mesh = mesh_of_expression(context, "sphere(1)", &options, &report);
  assert_null(laves_mesh_face_sources(mesh));
  assert_true(warned(&report, "the input is not made of faces"));
  laves_mesh_free(mesh);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(nested_parts_become_regions),
      cmocka_unit_test(regions_do_not_depend_on_threads),
      cmocka_unit_test(one_part_is_no_region),
      cmocka_unit_test(named_solids_become_regions),
      cmocka_unit_test(what_is_in_no_part_is_the_rest),
      cmocka_unit_test(short_memory_anywhere_leaves_nothing),
      cmocka_unit_test(faces_know_the_triangle_they_lie_on),
      cmocka_unit_test(polygons_count_once),
      cmocka_unit_test(implicit_solids_have_no_sources),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
