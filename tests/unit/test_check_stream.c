/* The check of a mesh that stays in its file says what the check in memory says, to the last digit, of sound meshes and of every
 * kind of broken one; it refuses what cannot be read; and it takes little memory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

#include "fixtures/folders.h"
#include "fixtures/meshes.h"
#include "fixtures/raw_vtu.h"
#include "fixtures/stride.h"
#include "fixtures/tagged_cube.h"

static char folder[FIXTURE_FOLDER_MAX];
static char path[FIXTURE_FOLDER_MAX + 40];

static laves_context *make_context(int threads) {
  laves_context_options options = laves_context_options_default();
  options.thread_count = threads;
  laves_context *context = laves_context_create(&options);
  assert_non_null(context);
  return context;
}

static int set_up(void **state) {
  *state = make_context(2);
  if (!fixture_folder_make(folder)) return -1;
  snprintf(path, sizeof path, "%s/mesh.vtu", folder);
  return 0;
}

static int tear_down(void **state) {
  const size_t left = laves_context_bytes(*state);
  laves_context_free(*state);
  fixture_folder_remove(folder);
  return left != 0;
}

/* ---- comparing ---- */

static void same_doubles(const char *what, const double *a, const double *b, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (memcmp(&a[i], &b[i], sizeof a[i]) != 0 && !(isnan(a[i]) && isnan(b[i])))
      fail_msg("%s %zu: %.17g by ranges, %.17g in memory", what, i, a[i], b[i]);
}

static void same_statistic(const char *what, const laves_statistic *a, const laves_statistic *b) {
  same_doubles(what, (const double[]){a->min, a->max, a->mean, a->deviation},
               (const double[]){b->min, b->max, b->mean, b->deviation}, 4);
}

static void same_counts(const laves_check *a, const laves_check *b) {
  assert_int_equal(a->vertices, b->vertices);
  assert_int_equal(a->tets, b->tets);
  assert_int_equal(a->faces, b->faces);
  assert_int_equal(a->bad_indices, b->bad_indices);
  assert_int_equal(a->inverted_tets, b->inverted_tets);
  assert_int_equal(a->nonconforming_faces, b->nonconforming_faces);
  assert_int_equal(a->nonmanifold_edges, b->nonmanifold_edges);
  assert_int_equal(a->nonmanifold_vertices, b->nonmanifold_vertices);
  assert_int_equal(a->unused_vertices, b->unused_vertices);
  assert_int_equal(a->components, b->components);
  assert_int_equal(a->boundary_components, b->boundary_components);
  assert_int_equal(a->genus, b->genus);
  assert_int_equal(a->valid, b->valid);
}

static void same_worst(const laves_check *a, const laves_check *b) {
  assert_int_equal(a->min_dihedral_tet, b->min_dihedral_tet);
  assert_int_equal(a->max_dihedral_tet, b->max_dihedral_tet);
  assert_int_equal(a->radius_ratio_tet, b->radius_ratio_tet);
  assert_int_equal(a->radius_edge_tet, b->radius_edge_tet);
  assert_int_equal(a->volume_length_tet, b->volume_length_tet);
  same_doubles("min_dihedral_place", a->min_dihedral_place, b->min_dihedral_place, 3);
  same_doubles("max_dihedral_place", a->max_dihedral_place, b->max_dihedral_place, 3);
  same_doubles("radius_ratio_place", a->radius_ratio_place, b->radius_ratio_place, 3);
  same_doubles("radius_edge_place", a->radius_edge_place, b->radius_edge_place, 3);
  same_doubles("volume_length_place", a->volume_length_place, b->volume_length_place, 3);
}

static void same_check(const laves_check *a, const laves_check *b) {
  same_counts(a, b);
  same_worst(a, b);
  same_doubles("volume", &a->volume, &b->volume, 1);
  same_doubles("area", &a->area, &b->area, 1);
  same_doubles("edges", (const double[]){a->edge_min, a->edge_max}, (const double[]){b->edge_min, b->edge_max}, 2);
  assert_true(isnan(a->edge_mean));
  same_statistic("min_dihedral", &a->min_dihedral, &b->min_dihedral);
  same_statistic("max_dihedral", &a->max_dihedral, &b->max_dihedral);
  same_statistic("radius_ratio", &a->radius_ratio, &b->radius_ratio);
  same_statistic("radius_edge", &a->radius_edge, &b->radius_edge);
  same_statistic("volume_length", &a->volume_length, &b->volume_length);
  assert_memory_equal(a->histogram, b->histogram, sizeof a->histogram);
  assert_int_equal(a->has_distance, b->has_distance);
  if (!a->has_distance) return;
  same_doubles("to_surface", (const double[]){a->to_surface_max, a->to_surface_mean, a->to_surface_at_most},
               (const double[]){b->to_surface_max, b->to_surface_mean, b->to_surface_at_most}, 3);
  same_doubles("from_surface", (const double[]){a->from_surface_max, a->from_surface_mean, a->from_surface_at_most},
               (const double[]){b->from_surface_max, b->from_surface_mean, b->from_surface_at_most}, 3);
  same_doubles("to_surface_place", a->to_surface_place, b->to_surface_place, 3);
  same_doubles("from_surface_place", a->from_surface_place, b->from_surface_place, 3);
}

enum { PLACES = 7 };

static void same_places(const laves_place *a, const laves_place *b, size_t count) {
  for (size_t i = 0; i < count; i++) {
    assert_int_equal(a[i].tet, b[i].tet);
    same_doubles("place", a[i].place, b[i].place, 3);
    same_doubles("value", &a[i].value, &b[i].value, 1);
    same_doubles("curvature", &a[i].curvature_radius, &b[i].curvature_radius, 1);
  }
}

/* Checks the file both ways, with a window that some tets leave. */
static laves_file_check compare_file(laves_context *context, const laves_domain *domain) {
  laves_mesh *mesh;
  laves_check whole;
  laves_file_check found;
  laves_place places[PLACES], more[PLACES];
  laves_error error = {0};
  size_t outside;
  laves_file_check_options options = laves_file_check_options_default();
  options.domain = domain;
  options.min_dihedral = 46;
  options.places = places;
  options.place_capacity = PLACES;
  options.cache_bytes = 0; /* the least that there is */
  if (laves_check_file(context, path, &options, &found, &error) != LAVES_OK) fail_msg("%s", error.text);
  assert_int_equal(laves_mesh_read(context, path, &mesh, NULL), LAVES_OK);
  assert_int_equal(laves_check_mesh(context, mesh, domain, &whole, NULL), LAVES_OK);
  assert_int_equal(laves_check_window(context, mesh, domain, options.min_dihedral, options.max_dihedral, options.volume_length,
                                      more, PLACES, &outside, NULL),
                   LAVES_OK);
  laves_mesh_free(mesh);
  same_check(&found.check, &whole);
  assert_int_equal(found.outside_window, outside);
  same_places(places, more, outside < PLACES ? outside : PLACES);
  return found;
}

/* Writes a mesh as laves does, compares and frees it. */
static laves_check compare_mesh(laves_context *context, laves_mesh *mesh) {
  laves_file_check found[2];
  for (int compression = 0; compression < 2; compression++) {
    laves_write_options options = laves_write_options_default();
    options.compression = compression;
    assert_int_equal(laves_mesh_write(context, mesh, path, &options, NULL), LAVES_OK);
    found[compression] = compare_file(context, NULL);
  }
  laves_mesh_free(mesh);
  return found[0].check;
}

/* ---- sound meshes ---- */

static bool keep_by_mask(void *user, int x, int y, int z) {
  const unsigned *mask = user;
  return *mask >> (x + 3 * y + 9 * z) & 1;
}

static laves_mesh *cubes_of_mask(laves_context *context, unsigned mask) {
  return fixture_cubes(context, 3, 3, 3, keep_by_mask, &mask);
}

static void sound_meshes(void **state) {
  assert_true(compare_mesh(*state, fixture_cubes(*state, 1, 1, 1, NULL, NULL)).valid);
  assert_true(compare_mesh(*state, fixture_cubes(*state, 17, 13, 15, NULL, NULL)).valid);
  assert_int_equal(compare_mesh(*state, fixture_ring(*state)).genus, 1);
  assert_int_equal(compare_mesh(*state, cubes_of_mask(*state, 0x7ffffff & ~(1u << 13))).boundary_components, 2);
  const laves_check two = compare_mesh(*state, cubes_of_mask(*state, 1u << 0 | 1u << 2));
  assert_int_equal(two.components, 2);
  assert_int_equal(two.unused_vertices, 64 - 16);
  assert_true(compare_mesh(*state, fixture_ball(*state, 24, 3.7)).valid);
}

static void mix(size_t *random) { *random = *random * (size_t)6364136223846793005u + (size_t)1442695040888963407u; }

/* Neighbours far from one another in the file: every face has to wait, and points are read again and again. */
static void any_order(void **state) {
  laves_mesh *mesh = fixture_ball(*state, 16, 1);
  size_t random = 5;
  for (size_t i = mesh->tet_count - 1; i > 0; i--) {
    int32_t swapped[4];
    mix(&random);
    const size_t j = (random >> 20) % (i + 1);
    memcpy(swapped, mesh->tets[i], sizeof swapped);
    memcpy(mesh->tets[i], mesh->tets[j], sizeof swapped);
    memcpy(mesh->tets[j], swapped, sizeof swapped);
  }
  assert_true(compare_mesh(*state, mesh).valid);
}

static void with_a_domain(void **state) {
  laves_domain *domain;
  laves_mesh *mesh = fixture_ball(*state, 6, 1);
  assert_int_equal(laves_domain_from_expression(*state, "sphere(1)", &domain, NULL), LAVES_OK);
  assert_int_equal(laves_mesh_write(*state, mesh, path, NULL, NULL), LAVES_OK);
  laves_mesh_free(mesh);
  assert_true(compare_file(*state, domain).check.has_distance);
  laves_domain_free(domain);
}

/* ---- broken meshes ---- */

static laves_mesh *block(laves_context *context) { return fixture_cubes(context, 6, 5, 4, NULL, NULL); }

static void swap_corners(int32_t tet[4]) {
  const int32_t swapped = tet[2];
  tet[2] = tet[3];
  tet[3] = swapped;
}

static void turned_tet(void **state) {
  laves_mesh *mesh = block(*state);
  swap_corners(mesh->tets[300]);
  assert_int_equal(compare_mesh(*state, mesh).inverted_tets, 1);
}

static void flat_tet(void **state) {
  laves_mesh *mesh = block(*state);
  mesh->points[mesh->tets[300][0]] = mesh->points[mesh->tets[300][1]];
  assert_true(compare_mesh(*state, mesh).inverted_tets > 0);
}

static void repeated_corner(void **state) {
  laves_mesh *mesh = block(*state);
  mesh->tets[300][1] = mesh->tets[300][3];
  mesh->tets[301][1] = mesh->tets[301][2] = mesh->tets[301][3];
  assert_int_equal(compare_mesh(*state, mesh).bad_indices, 3);
}

/* Every tet negative is another convention; with one positive tet among them it is a fault of all others. */
static void all_negative(void **state) {
  laves_mesh *mesh = block(*state), *mixed = block(*state);
  for (size_t i = 0; i < mesh->tet_count; i++) swap_corners(mesh->tets[i]);
  for (size_t i = 1; i < mixed->tet_count; i++) swap_corners(mixed->tets[i]);
  const size_t others = mixed->tet_count - 1;
  assert_true(compare_mesh(*state, mesh).valid);
  assert_int_equal(compare_mesh(*state, mixed).inverted_tets, others);
}

static void hole(void **state) {
  laves_mesh *mesh = block(*state);
  memcpy(mesh->tets[300], mesh->tets[mesh->tet_count - 1], sizeof mesh->tets[300]);
  mesh->tets[mesh->tet_count - 1][0] = mesh->tets[mesh->tet_count - 1][1]; /* no tet */
  const laves_check c = compare_mesh(*state, mesh);
  assert_true(c.boundary_components > 1 || c.nonmanifold_edges + c.nonmanifold_vertices > 0);
}

/* Copies of tets [begin, end) of a mesh behind all others, `copies` times; the mesh is freed. */
static laves_mesh *with_copies(laves_context *context, laves_mesh *mesh, size_t begin, size_t end, size_t copies) {
  const size_t count = end - begin, all = mesh->tet_count + copies * count;
  laves_mesh *more = laves__mesh_create(context, mesh->vertex_count, all, 0, false, false);
  assert_non_null(more);
  memcpy(more->points, mesh->points, mesh->vertex_count * sizeof *more->points);
  memcpy(more->tets, mesh->tets, mesh->tet_count * sizeof *more->tets);
  for (size_t i = 0; i < copies; i++)
    memcpy(more->tets + mesh->tet_count + i * count, mesh->tets + begin, count * sizeof *more->tets);
  laves_mesh_free(mesh);
  return more;
}

/* Faces of the first of these have been forgotten when the copy comes. */
static void doubled_tets(void **state) {
  assert_int_equal(compare_mesh(*state, with_copies(*state, block(*state), 300, 301, 1)).nonconforming_faces, 4);
  assert_int_equal(compare_mesh(*state, with_copies(*state, block(*state), 719, 720, 2)).nonconforming_faces, 4);
  laves_mesh *large = fixture_cubes(*state, 16, 16, 16, NULL, NULL);
  const size_t middle = large->tet_count / 2 + 6 * 16 * 8 + 50; /* inside */
  assert_int_equal(compare_mesh(*state, with_copies(*state, large, middle, middle + 1, 1)).nonconforming_faces, 4);
  large = fixture_cubes(*state, 16, 16, 16, NULL, NULL);
  const laves_check c = compare_mesh(*state, with_copies(*state, large, 0, 6 * 16 * 16 * 16, 1));
  assert_true(c.nonconforming_faces > 40000);
  assert_int_equal(c.components, 1);
}

/* A second ball beside the first, with vertices of its own, but for those of one tet of the inside, of which `shared` are the
 * first ball's: where these are used again they have long been closed. */
static laves_mesh *joined_balls(laves_context *context, int shared) {
  enum { CUBES = 16 };
  laves_mesh *ball = fixture_ball(context, CUBES, 1);
  laves_mesh *both = laves__mesh_create(context, 2 * ball->vertex_count, 2 * ball->tet_count, 0, false, false);
  const int32_t *inner = ball->tets[6 * (CUBES / 2 + CUBES * (CUBES / 2 + CUBES * (CUBES / 2)))];
  const int32_t n = (int32_t)ball->vertex_count;
  assert_non_null(both);
  for (int32_t i = 0; i < n; i++) {
    both->points[i] = ball->points[i];
    both->points[n + i] = v3_add(ball->points[i], v3(0.01, 0, 0));
  }
  for (size_t i = 0; i < ball->tet_count; i++)
    for (int j = 0; j < 4; j++) {
      const int32_t vertex = ball->tets[i][j];
      bool is_shared = false;
      for (int k = 0; k < shared; k++) is_shared |= vertex == inner[k];
      both->tets[i][j] = vertex;
      both->tets[ball->tet_count + i][j] = is_shared ? vertex : n + vertex;
    }
  laves_mesh_free(ball);
  return both;
}

static void joined_inside(void **state) {
  const laves_check point = compare_mesh(*state, joined_balls(*state, 1));
  assert_int_equal(point.components, 2);
  assert_int_equal(point.nonconforming_faces, 0);
  const laves_check face = compare_mesh(*state, joined_balls(*state, 3));
  assert_int_equal(face.components, 1);
  assert_int_equal(face.nonconforming_faces, 1);
  assert_int_equal(compare_mesh(*state, joined_balls(*state, 4)).nonconforming_faces, 4);
}

static void touching_sheets(void **state) {
  assert_int_equal(compare_mesh(*state, cubes_of_mask(*state, 1u << 0 | 1u << (1 + 3 + 9))).nonmanifold_vertices, 1);
  assert_int_equal(compare_mesh(*state, cubes_of_mask(*state, 1u << 0 | 1u << (1 + 3))).nonmanifold_edges, 1);
}

/* Many meshes with random faults, of one batch and a few. */
static void random_faults(void **state) {
  size_t random = 1;
  for (int round = 0; round < 30; round++) {
    const int n = round % 10 == 0 ? 15 : 4;
    laves_mesh *mesh = fixture_cubes(*state, n, n, n, NULL, NULL);
    for (int fault = 0; fault < 6; fault++) {
      mix(&random);
      int32_t *tet = mesh->tets[(random >> 20) % mesh->tet_count];
      mix(&random);
      tet[random >> 40 & 3] = (int32_t)((random >> 20) % mesh->vertex_count);
    }
    compare_mesh(*state, mesh);
  }
}

/* ---- kinds of files ---- */

static laves_file_check compare_raw(laves_context *context, const fixture_raw_vtu *file) {
  assert_true(fixture_raw_vtu_write(file, path));
  return compare_file(context, NULL);
}

static void kinds_of_numbers(void **state) {
  laves_mesh *mesh = fixture_ball(*state, 7, 2);
  fixture_raw_vtu file = fixture_raw_vtu_of(mesh);
  file.narrow = true;
  const laves_file_check found = compare_raw(*state, &file);
  assert_true(found.check.valid);
  assert_int_equal(found.file_faces, mesh->face_count);
  laves_mesh_free(mesh);
}

/* Nodes that are no corners are dropped. */
static void quadratic_tets(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 5, 5, 5, NULL, NULL);
  laves__vec3 points[300];
  fixture_raw_vtu file = fixture_raw_vtu_of(mesh);
  for (size_t i = 0; i < 300; i++) points[i] = i < mesh->vertex_count ? mesh->points[i] : v3(1, 2, (double)i);
  file.points = points;
  file.point_count = 300;
  file.quadratic = true;
  const laves_file_check found = compare_raw(*state, &file);
  assert_int_equal(found.check.vertices, 216);
  assert_int_equal(found.check.unused_vertices, 0);
  laves_mesh_free(mesh);
}

static void triangles_of_the_file(void **state) {
  laves_mesh *mesh = fixture_tagged_cube(*state, 5);
  assert_int_equal(laves_mesh_write(*state, mesh, path, NULL, NULL), LAVES_OK);
  laves_file_check found = compare_file(*state, NULL);
  assert_int_equal(found.file_faces, mesh->face_count);
  assert_int_equal(found.file_faces_elsewhere + found.file_faces_turned + found.file_faces_missing, 0);

  fixture_raw_vtu file = fixture_raw_vtu_of(mesh);
  file.triangles_first = true;
  found = compare_raw(*state, &file);
  assert_int_equal(found.file_faces, mesh->face_count);
  assert_int_equal(found.file_faces_elsewhere + found.file_faces_turned + found.file_faces_missing, 0);
  /* One turned, one repeated in the place of another, two inside in the place of others. */
  int32_t *turned = mesh->faces[3], swapped = turned[0];
  turned[0] = turned[1];
  turned[1] = swapped;
  memcpy(mesh->faces[5], mesh->faces[6], sizeof mesh->faces[5]);
  const int32_t inner[2][3] = {{43, 44, 86}, {43, 86, 129}}; /* of 6^3 vertices; the second is none of the mesh at all */
  memcpy(mesh->faces[7], inner[0], sizeof inner[0]);
  memcpy(mesh->faces[9], inner[1], sizeof inner[1]);
  found = compare_raw(*state, &file);
  assert_int_equal(found.file_faces, mesh->face_count);
  assert_int_equal(found.file_faces_turned, 1);
  assert_int_equal(found.file_faces_elsewhere, 3);
  assert_int_equal(found.file_faces_missing, 3);
  assert_true(found.check.valid);
  laves_mesh_free(mesh);
}

/* ---- what cannot be read ---- */

static void refuse_as(laves_context *context, const char *sentence) {
  laves_file_check found;
  laves_error error = {0};
  const laves_result result = laves_check_file(context, path, NULL, &found, &error);
  if (result != LAVES_ERROR_INPUT || !strstr(error.text, sentence))
    fail_msg("%s, '%s' instead of '%s'", laves_result_name(result), error.text, sentence);
  assert_false(found.check.valid);
}

static void refused_content(void **state) {
  laves_mesh *mesh = block(*state);
  fixture_raw_vtu file = fixture_raw_vtu_of(mesh);
  mesh->tets[300][2] = 210; /* of 210 */
  assert_true(fixture_raw_vtu_write(&file, path));
  refuse_as(*state, "cell 300 uses point 210, but the points are 0 to 209");
  mesh->tets[300][2] = -1;
  assert_true(fixture_raw_vtu_write(&file, path));
  refuse_as(*state, "cell 300 uses point -1, but the points are 0 to 209");
  mesh->tets[300][2] = 4;
  mesh->faces[0][1] = 1000;
  assert_true(fixture_raw_vtu_write(&file, path));
  refuse_as(*state, "cell 720 uses point 1000, but the points are 0 to 209");
  mesh->faces[0][1] = 5;
  file.last_offset_plus = -9;
  assert_true(fixture_raw_vtu_write(&file, path));
  refuse_as(*state, "connectivity is shorter than announced or damaged");
  file.last_offset_plus = 0;
  mesh->points[17].y = NAN;
  assert_true(fixture_raw_vtu_write(&file, path));
  refuse_as(*state, "vertex 18 (counted from 1) has a coordinate that is not finite");
  mesh->points[17].y = 0;
  file.tet_count = 0;
  assert_true(fixture_raw_vtu_write(&file, path));
  refuse_as(*state, "there are no tetrahedra in it");
  laves_mesh_free(mesh);
}

/* The last vertex is in no tet, and nobody would see that it is no point. */
static void unused_point_that_is_none(void **state) {
  laves_mesh *mesh = block(*state);
  laves__vec3 points[3000] = {{0, 0, 0}};
  fixture_raw_vtu file = fixture_raw_vtu_of(mesh);
  memcpy(points, mesh->points, mesh->vertex_count * sizeof *points);
  points[2999].z = INFINITY;
  file.points = points;
  file.point_count = 3000;
  assert_true(fixture_raw_vtu_write(&file, path));
  refuse_as(*state, "vertex 3000 (counted from 1) has a coordinate that is not finite");
  laves_mesh_free(mesh);
}

/* Cut off anywhere, the file is refused. */
static void cut_off(void **state) {
  laves_mesh *mesh = fixture_tagged_cube(*state, 3);
  for (int compression = 0; compression < 2; compression++) {
    laves_write_options options = laves_write_options_default();
    options.compression = compression;
    assert_int_equal(laves_mesh_write(*state, mesh, path, &options, NULL), LAVES_OK);
    struct stat status;
    assert_int_equal(stat(path, &status), 0);
    for (off_t length = status.st_size * 3 / 5; length >= 0; length -= 1 + length / 50) {
      laves_file_check found;
      laves_error error = {0};
      assert_int_equal(truncate(path, length), 0);
      assert_int_equal(laves_check_file(*state, path, NULL, &found, &error), LAVES_ERROR_INPUT);
      assert_true(strlen(error.text) > 10);
    }
  }
  laves_mesh_free(mesh);
}

static bool shorten(void *user, const char *phase, double fraction) {
  (void)phase;
  return fraction < 0.4 || truncate(user, 30000) == 0;
}

/* A file that becomes shorter while it is read is an error like any other. */
static void shortened_meanwhile(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 20, 20, 20, NULL, NULL);
  laves_write_options options = laves_write_options_default();
  options.compression = 0;
  assert_int_equal(laves_mesh_write(*state, mesh, path, &options, NULL), LAVES_OK);
  laves_mesh_free(mesh);
  laves_context_options with = laves_context_options_default();
  with.progress = shorten;
  with.progress_user = path;
  laves_context *context = laves_context_create(&with);
  assert_non_null(context);
  refuse_as(context, "the file became shorter while it was read");
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void put_text(const char *text) {
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

static void refused_kinds(void **state) {
  laves_mesh *mesh = block(*state);
  laves_write_options options = laves_write_options_default();
  options.ascii = true;
  assert_int_equal(laves_mesh_write(*state, mesh, path, &options, NULL), LAVES_OK);
  laves_mesh_free(mesh);
  refuse_as(*state, "appended");
  put_text("");
  refuse_as(*state, "it does not begin as a VTU file does");
  put_text("solid x\nendsolid x\n");
  refuse_as(*state, "it does not begin as a VTU file does");
  put_text("<vtkfile type=\"UnstructuredGrid\"><AppendedData encoding=\"raw\">_AAAA"); /* names in XML have a case */
  refuse_as(*state, "it does not begin as a VTU file does");
  put_text("<VTKFile type=\"UnstructuredGrid\"><AppendedData encoding=\"base64\">_AAAA");
  refuse_as(*state, "base64");
  put_text(
      "<VTKFile type=\"UnstructuredGrid\"><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"></Piece>"
      "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"></Piece><AppendedData encoding=\"raw\">_AAAA");
  refuse_as(*state, "it has several pieces");
  put_text(
      "<VTKFile type=\"UnstructuredGrid\"><Piece NumberOfPoints=\"4000000000\" NumberOfCells=\"1\"></Piece>"
      "<AppendedData encoding=\"raw\">_AAAA");
  refuse_as(*state, "it has more than 2147483647 points");
  remove(path);
  refuse_as(*state, "cannot open the file");
  snprintf(path, sizeof path, "%s", folder);
  refuse_as(*state, "is a directory");
  snprintf(path, sizeof path, "%s/mesh.vtu", folder);
}

static void refused_options(void **state) {
  laves_file_check found;
  laves_error error = {0};
  laves_file_check_options options = laves_file_check_options_default();
  options.cookie = 0;
  assert_int_equal(laves_check_file(*state, path, &options, &found, &error), LAVES_ERROR_OPTION);
  options = laves_file_check_options_default();
  options.place_capacity = 1;
  assert_int_equal(laves_check_file(*state, path, &options, &found, &error), LAVES_ERROR_OPTION);
  options = laves_file_check_options_default();
  options.min_dihedral = 130;
  assert_int_equal(laves_check_file(*state, path, &options, &found, &error), LAVES_ERROR_OPTION);
}

/* ---- cancel, threads, memory ---- */

static bool stop(void *user, const char *phase, double fraction) {
  (void)phase;
  return fraction < *(const double *)user;
}

static void cancelled(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 20, 20, 20, NULL, NULL);
  assert_int_equal(laves_mesh_write(*state, mesh, path, NULL, NULL), LAVES_OK);
  laves_mesh_free(mesh);
  for (double at = 0; at < 0.9; at += 0.2) {
    laves_context_options options = laves_context_options_default();
    laves_file_check found;
    options.progress = stop;
    options.progress_user = &at;
    laves_context *context = laves_context_create(&options);
    assert_non_null(context);
    assert_int_equal(laves_check_file(context, path, NULL, &found, NULL), LAVES_ERROR_CANCELLED);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
  }
}

/* The bytes, edges left out of account where they are not compared, for any number of threads. */
static void any_number_of_threads(void **state) {
  laves_mesh *mesh = joined_balls(*state, 3);
  assert_int_equal(laves_mesh_write(*state, mesh, path, NULL, NULL), LAVES_OK);
  laves_mesh_free(mesh);
  laves_file_check first = {0};
  for (int threads = 1; threads <= 7; threads += 3) {
    laves_context *context = make_context(threads);
    laves_file_check found;
    memset(&found, 0, sizeof found);
    assert_int_equal(laves_check_file(context, path, NULL, &found, NULL), LAVES_OK);
    if (threads == 1)
      first = found;
    else
      assert_memory_equal(&found, &first, sizeof found);
    laves_context_free(context);
  }
}

/* A million tets in 30 MB: half of that is enough, most of which are a few points and a few thousand tets at hand; and where
 * only few points are held, a third. */
static void little_memory(void **state) {
  if (test_stride() > 1) return; /* a million tets; what is counted is the same under slow tools */
  laves_domain *domain;
  laves_mesh *mesh;
  laves_options options = laves_options_default();
  options.tet_target = 1000000;
  assert_int_equal(laves_domain_from_expression(*state, "sphere(1)", &domain, NULL), LAVES_OK);
  assert_int_equal(laves_generate(*state, domain, &options, &mesh, NULL, NULL), LAVES_OK);
  laves_write_options plain = laves_write_options_default();
  plain.compression = 0;
  assert_int_equal(laves_mesh_write(*state, mesh, path, &plain, NULL), LAVES_OK);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  struct stat status;
  assert_int_equal(stat(path, &status), 0);
  assert_true(status.st_size > 30000000);
  static const size_t caches[2] = {(size_t)256 << 20, 200000}, peaks[2] = {16000000, 11500000};
  for (int i = 0; i < 2; i++) {
    laves_context *context = make_context(2);
    laves_file_check found;
    laves_file_check_options check = laves_file_check_options_default();
    check.cache_bytes = caches[i];
    assert_int_equal(laves_check_file(context, path, &check, &found, NULL), LAVES_OK);
    assert_true(found.check.valid);
    assert_in_range(laves_context_peak_bytes(context), 1, peaks[i]);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sound_meshes),
      cmocka_unit_test(any_order),
      cmocka_unit_test(with_a_domain),
      cmocka_unit_test(turned_tet),
      cmocka_unit_test(flat_tet),
      cmocka_unit_test(repeated_corner),
      cmocka_unit_test(all_negative),
      cmocka_unit_test(hole),
      cmocka_unit_test(doubled_tets),
      cmocka_unit_test(joined_inside),
      cmocka_unit_test(touching_sheets),
      cmocka_unit_test(random_faults),
      cmocka_unit_test(kinds_of_numbers),
      cmocka_unit_test(quadratic_tets),
      cmocka_unit_test(triangles_of_the_file),
      cmocka_unit_test(refused_content),
      cmocka_unit_test(unused_point_that_is_none),
      cmocka_unit_test(cut_off),
      cmocka_unit_test(shortened_meanwhile),
      cmocka_unit_test(refused_kinds),
      cmocka_unit_test(refused_options),
      cmocka_unit_test(cancelled),
      cmocka_unit_test(any_number_of_threads),
      cmocka_unit_test(little_memory),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
