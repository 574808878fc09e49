/* The layer of a given mesh: what its vertices may do, and that blocks that shift change nothing but who works where. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/meshes.h"
#include "fixtures/spoilt.h"
#include "fixtures/tagged_cube.h"
#include "improve/blocks.h"
#include "improve/given.h"
#include "improve/improve.h"

static laves_context *context_of(int threads) {
  laves_context_options o = laves_context_options_default();
  o.thread_count = threads;
  return laves_context_create(&o);
}

static void make_layer(laves_context *context, const laves_mesh *mesh, double tolerance, bool fixed, laves__given *given,
                       laves__layer *layer) {
  laves_error error = {0};
  if (laves__given_layer(context, mesh, tolerance, fixed, given, layer, &error) != LAVES_OK) fail_msg("%s", error.text);
}

static void test_freedom_on_a_cube(void **state) {
  (void)state;
  laves_context *context = context_of(1);
  laves_mesh *mesh = fixture_plain_cube(context, 4);
  laves__given given;
  laves__layer layer;
  make_layer(context, mesh, 0, false, &given, &layer);
  assert_int_equal(given.patch_count, 6);
  assert_int_equal(given.held_vertices, 8);
  assert_int_equal(given.crease_vertices, 12 * 3);
  assert_int_equal(given.flat_vertices, 6 * 9);
  assert_float_equal(given.sharpest, 90, 1e-9);
  for (size_t v = 0; v < layer.vertex_count; v++) {
    const laves__vec3 p = mesh->points[v];
    const int outer = (p.x == 0 || p.x == 1) + (p.y == 0 || p.y == 1) + (p.z == 0 || p.z == 1);
    assert_int_equal(layer.depth[v], outer > 0 ? 0 : 1);
    if (outer > 0) assert_int_equal(layer.hold[v].kind, LAVES__HOLD_SURFACE + outer);
  }
  laves__layer_free(&layer);
  laves__given_free(&given);
  make_layer(context, mesh, 0, true, &given, &layer);
  assert_int_equal(given.held_vertices, 98);
  assert_int_equal(given.patch_count, mesh->face_count);
  laves__layer_free(&layer);
  laves__given_free(&given);
  laves_mesh_free(mesh);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

/* Regions meet at z = 1/2: a flat border, whose edge on the outside is a crease, as are those between tags. */
static void test_borders_between_regions_are_held(void **state) {
  (void)state;
  laves_context *context = context_of(1);
  laves_mesh *mesh = fixture_tagged_cube(context, 4);
  laves__given given;
  laves__layer layer;
  make_layer(context, mesh, 0, false, &given, &layer);
  assert_int_equal(given.patch_count, 6 + 4 + 1); /* the sides are cut in two, and the border */
  size_t both = 0;
  for (size_t t = 0; t < layer.tet_count; t++)
    for (int k = 0; k < 4; k++)
      if (layer.patch[t][k] != LAVES__NO_PATCH) {
        const int32_t beyond = laves__layer_across(&layer, (int32_t)t, k);
        both += beyond >= 0;
        if (beyond >= 0) assert_int_not_equal(layer.region[t], layer.region[beyond]);
      }
  assert_int_equal(both, 2 * 2 * 4 * 4); /* 4 x 4 squares of two triangles, from both sides */
  for (size_t v = 0; v < layer.vertex_count; v++) {
    const laves__vec3 p = mesh->points[v];
    const int outer = (p.x == 0 || p.x == 1) + (p.y == 0 || p.y == 1) + (p.z == 0 || p.z == 1);
    if (p.z != 0.5) continue;
    assert_int_equal(layer.depth[v], 0);
    assert_int_equal(layer.hold[v].kind, outer == 0 ? LAVES__HOLD_PATCH : LAVES__HOLD_CORNER); /* three patches meet there */
  }
  laves__layer_free(&layer);
  laves__given_free(&given);
  laves_mesh_free(mesh);
  laves_context_free(context);
}

static void test_tolerance_makes_curved_faces_flat(void **state) {
  (void)state;
  laves_context *context = context_of(1);
  laves_mesh *mesh = fixture_ball(context, 6, 1);
  laves__given given;
  laves__layer layer;
  size_t patches[3];
  const double tolerance[3] = {0, 0.01, 0.2};
  for (int i = 0; i < 3; i++) {
    make_layer(context, mesh, tolerance[i], false, &given, &layer);
    patches[i] = given.patch_count;
    laves__layer_free(&layer);
    laves__given_free(&given);
  }
  assert_true(patches[0] > patches[1] && patches[1] > patches[2] && patches[2] >= 6);
  laves_mesh_free(mesh);
  laves_context_free(context);
}

static void test_there_and_back(void **state) {
  (void)state;
  laves_context *context = context_of(1);
  laves_mesh *plain = fixture_tagged_cube(context, 4), *mesh = fixture_spoilt(context, plain, 50, 1, 3), *back;
  fixture_tag_cube(mesh);
  assert_true(laves__mesh_add_group(mesh, 2, 10, "x low"));
  laves__given given;
  laves__layer layer;
  make_layer(context, mesh, 0, false, &given, &layer);
  assert_int_equal(laves__given_mesh(&given, &layer, &back, NULL), LAVES_OK);
  char one[33], two[33];
  laves_mesh_hash(mesh, one);
  laves_mesh_hash(back, two);
  assert_string_equal(one, two);
  assert_string_equal(laves_mesh_group_name(back, 2, 10), "x low");
  laves__layer_free(&layer);
  laves__given_free(&given);
  laves_mesh_free(back);
  laves_mesh_free(mesh);
  laves_mesh_free(plain);
  laves_context_free(context);
}

/* All that a layer is in the end, as the hash of its mesh. */
static void improve_in_blocks(const laves_mesh *mesh, int threads, size_t block_vertices, char hash[33]) {
  static const laves__frame no_domain;
  laves_context *context = context_of(threads);
  laves__given given;
  laves__layer layer;
  laves_mesh *out;
  laves_error error = {0};
  const laves__window window = {.min_dihedral = 30, .max_dihedral = 140, .block_vertices = block_vertices};
  make_layer(context, mesh, 0, false, &given, &layer);
  if (laves__improve(&no_domain, &window, &layer, &error) != LAVES_OK) fail_msg("%s", error.text);
  for (size_t v = 0; v < layer.vertex_count; v++) {
    int32_t count = 0;
    for (size_t t = 0; t < layer.tet_count; t++)
      count += layer.tet[t][0] >= 0 && laves__layer_corner(&layer, (int32_t)t, (int32_t)v) >= 0;
    assert_int_equal(layer.star[v].count, count);
    assert_true(layer.depth[v] <= 1);
  }
  assert_int_equal(laves__given_mesh(&given, &layer, &out, &error), LAVES_OK);
  laves_mesh_hash(out, hash);
  laves_check check;
  assert_int_equal(laves_check_mesh(context, out, NULL, &check, NULL), LAVES_OK);
  assert_true(check.valid);
  assert_float_equal(check.volume, 1, 1e-12);
  laves_mesh_free(out);
  laves__layer_free(&layer);
  laves__given_free(&given);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void test_blocks_on_any_number_of_threads(void **state) {
  (void)state;
  laves_context *context = context_of(1);
  laves_mesh *plain = fixture_plain_cube(context, 8), *mesh = fixture_spoilt(context, plain, 800, 1, 5);
  char hash[3][33];
  for (int threads = 1; threads <= 3; threads++) improve_in_blocks(mesh, threads, 40, hash[threads - 1]);
  assert_string_equal(hash[0], hash[1]);
  assert_string_equal(hash[0], hash[2]);
  laves_mesh_free(mesh);
  laves_mesh_free(plain);
  laves_context_free(context);
}

/* In four turns each vertex moves; what moves in a block has no neighbour that moves in another. */
static void test_each_vertex_has_its_turn(void **state) {
  (void)state;
  laves_context *context = context_of(1);
  laves_mesh *mesh = fixture_plain_cube(context, 20);
  laves__given given;
  laves__layer layer;
  laves__blocks blocks;
  make_layer(context, mesh, 0, false, &given, &layer);
  assert_true(laves__blocks_begin(&layer, 1100, &blocks));
  assert_int_equal(blocks.per_axis, 2);
  assert_int_equal(laves__blocks_turns(&blocks), 4);
  bool *moved = calloc(layer.vertex_count, 1);
  assert_non_null(moved);
  for (int turn = 0; turn < 4; turn++) {
    assert_int_equal(laves__blocks_shift(&blocks, &layer, NULL), LAVES_OK);
    for (size_t t = 0; t < layer.tet_count; t++) {
      const int32_t block = laves__blocks_of(&blocks, &layer, (int32_t)t);
      for (int k = 0; k < 4; k++) {
        const int32_t v = layer.tet[t][k];
        if (!laves__layer_moves(&layer, v)) continue;
        moved[v] = true;
        assert_int_equal(blocks.block[v], block);
      }
    }
  }
  for (size_t v = 0; v < layer.vertex_count; v++) assert_true(moved[v]);
  assert_int_equal(laves__blocks_end(&blocks, &layer, NULL), LAVES_OK);
  free(moved);
  laves__blocks_free(&blocks);
  laves__layer_free(&layer);
  laves__given_free(&given);
  laves_mesh_free(mesh);
  laves_context_free(context);
}

static void assert_refused(laves_context *context, const laves_mesh *mesh, const laves_improve_options *options,
                           laves_result expected, const char *words) {
  laves_mesh *out = NULL;
  laves_error error = {0};
  assert_int_equal(laves_improve(context, mesh, options, &out, NULL, &error), expected);
  assert_null(out);
  assert_non_null(strstr(error.text, words));
}

static void test_refusals(void **state) {
  (void)state;
  laves_context *context = context_of(1);
  laves_mesh *mesh = fixture_plain_cube(context, 2);
  laves_improve_options options = laves_improve_options_default();
  options.min_dihedral = 70;
  assert_refused(context, mesh, &options, LAVES_ERROR_OPTION, "min_dihedral is 70 but must lie between 0 and 60");
  options = laves_improve_options_default();
  options.tolerance = -1;
  assert_refused(context, mesh, &options, LAVES_ERROR_OPTION, "tolerance");
  options.cookie = 0;
  assert_refused(context, mesh, &options, LAVES_ERROR_OPTION, "laves_improve_options_default()");
  const int32_t swapped = mesh->tets[3][0];
  mesh->tets[3][0] = mesh->tets[3][1];
  mesh->tets[3][1] = swapped;
  assert_refused(context, mesh, NULL, LAVES_ERROR_INPUT, "1 tetrahedra are flat or inside out");
  laves_mesh_free(mesh);
  laves_context_free(context);
}

/* One pass is less than all, and the same each time. */
static void test_passes(void **state) {
  (void)state;
  laves_context *context = context_of(1);
  laves_mesh *plain = fixture_plain_cube(context, 6), *mesh = fixture_spoilt(context, plain, 400, 1, 9), *out[3];
  laves_improve_report report[3];
  laves_improve_options options = laves_improve_options_default();
  char hash[3][33];
  for (int i = 0; i < 3; i++) {
    options.passes = i < 2 ? 1 : 0;
    assert_true(laves_improve(context, mesh, &options, &out[i], &report[i], NULL) <= LAVES_TARGET_MISSED);
    laves_mesh_hash(out[i], hash[i]);
    laves_mesh_free(out[i]);
  }
  assert_string_equal(hash[0], hash[1]);
  assert_true(report[0].outside_after < report[0].outside_before);
  assert_true(report[2].outside_after < report[0].outside_after);
  options.passes = 0;
  options.seconds = 1e-9; /* over at once: all is as it was */
  assert_int_equal(laves_improve(context, mesh, &options, &out[0], &report[0], NULL), LAVES_TARGET_MISSED);
  assert_true(report[0].out_of_time);
  laves_mesh_hash(mesh, hash[0]);
  laves_mesh_hash(out[0], hash[1]);
  assert_string_equal(hash[0], hash[1]);
  laves_mesh_free(out[0]);
  laves_mesh_free(mesh);
  laves_mesh_free(plain);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_freedom_on_a_cube),
      cmocka_unit_test(test_borders_between_regions_are_held),
      cmocka_unit_test(test_tolerance_makes_curved_faces_flat),
      cmocka_unit_test(test_there_and_back),
      cmocka_unit_test(test_each_vertex_has_its_turn),
      cmocka_unit_test(test_blocks_on_any_number_of_threads),
      cmocka_unit_test(test_refusals),
      cmocka_unit_test(test_passes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
