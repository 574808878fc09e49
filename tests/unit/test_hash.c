/* The hash against published values, and that it sees every array and no threads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

#include "fixtures/meshes.h"
#include "mesh/hash128.h"

static void assert_hash(const char *text, const char *expected) {
  char hash[33];
  laves__hash_text(laves__hash_bytes(text, strlen(text), 1, (laves__hash128){0, 0}), hash);
  assert_string_equal(hash, expected);
}

/* MurmurHash3_x64_128 with seed 0, as other implementations give it. */
static void known_values(void **state) {
  (void)state;
  assert_hash("", "00000000000000000000000000000000");
  assert_hash("hello", "cbd8a7b341bd9b025b1e906a48ae1d19");
  assert_hash("The quick brown fox jumps over the lazy dog", "e34bbc7bbc071b6c7a433ca9c49a9347");
}

static laves_context *context_with_threads(int threads) {
  laves_context_options options = laves_context_options_default();
  options.thread_count = threads;
  return laves_context_create(&options);
}

static void same_for_any_threads(void **state) {
  (void)state;
  char hashes[3][33];
  for (int threads = 1; threads <= 3; threads++) {
    laves_context *context = context_with_threads(threads);
    laves_mesh *mesh = fixture_cubes(context, 24, 24, 24, NULL, NULL);
    laves_mesh_hash(mesh, hashes[threads - 1]);
    laves_mesh_free(mesh);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
  }
  assert_string_equal(hashes[0], hashes[1]);
  assert_string_equal(hashes[0], hashes[2]);
}

static void assert_changes(const laves_mesh *mesh, const char *before) {
  char hash[33];
  laves_mesh_hash(mesh, hash);
  assert_string_not_equal(hash, before);
}

static void sees_every_array(void **state) {
  (void)state;
  laves_context *context = context_with_threads(1);
  laves_mesh *mesh = fixture_ring(context);
  char hash[33];
  laves_mesh_hash(mesh, hash);
  mesh->points[3].y = nextafter(mesh->points[3].y, 9);
  assert_changes(mesh, hash);
  laves_mesh_hash(mesh, hash);
  mesh->tets[5][2] ^= 1;
  assert_changes(mesh, hash);
  laves_mesh_hash(mesh, hash);
  mesh->faces[mesh->face_count - 1][2] ^= 1;
  assert_changes(mesh, hash);
  laves_mesh_hash(mesh, hash);
  mesh->regions = laves__alloc_zeroed(context, mesh->tet_count, sizeof *mesh->regions);
  assert_changes(mesh, hash);
  laves_mesh_hash(mesh, hash);
  mesh->regions[0] = 1;
  assert_changes(mesh, hash);
  laves_mesh_hash(mesh, hash);
  mesh->face_tags = laves__alloc_zeroed(context, mesh->face_count, sizeof *mesh->face_tags);
  assert_changes(mesh, hash);
  laves_mesh_free(mesh);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(known_values),
      cmocka_unit_test(same_for_any_threads),
      cmocka_unit_test(sees_every_array),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
