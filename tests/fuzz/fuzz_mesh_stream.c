/* Fuzzes the check of a VTU that stays in its file: any bytes must be checked or refused, with nothing left behind, and where
 * they are checked, the check in memory must say the same. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "fuzz/fuzz_target.h"
#include "laves/laves.h"

/* A context whose memory is in proportion to the file; what is held for tets in work comes on top. */
static laves_context *make_context(size_t length) {
  laves_context_options options = laves_context_options_default();
  options.thread_count = 1;
  options.memory_limit = 12000000 + 60000 * length;
  laves_context *context = laves_context_create(&options);
  FUZZ_REQUIRE(context != NULL);
  return context;
}

static bool same(double a, double b) { return memcmp(&a, &b, sizeof a) == 0; }

/* The file must be readable, but for the content of its regions, which the check does not read, and both checks must agree. */
static void compare(laves_context *context, const char *path, const laves_check *found) {
  laves_mesh *mesh;
  laves_check whole;
  laves_error error = {0};
  if (laves_mesh_read(context, path, &mesh, &error) != LAVES_OK) {
    FUZZ_REQUIRE(strstr(error.text, "the regions") != NULL);
    return;
  }
  FUZZ_REQUIRE(laves_check_mesh(context, mesh, NULL, &whole, NULL) == LAVES_OK);
  FUZZ_REQUIRE(found->valid == whole.valid && found->tets == whole.tets);
  /* A whole file is read without the points that only cells of other kinds use; here they stay, and count as unused. */
  FUZZ_REQUIRE(found->vertices - found->unused_vertices == whole.vertices - whole.unused_vertices);
  FUZZ_REQUIRE(found->bad_indices == whole.bad_indices && found->inverted_tets == whole.inverted_tets);
  FUZZ_REQUIRE(found->nonconforming_faces == whole.nonconforming_faces && found->faces == whole.faces);
  FUZZ_REQUIRE(found->nonmanifold_edges == whole.nonmanifold_edges);
  FUZZ_REQUIRE(found->nonmanifold_vertices == whole.nonmanifold_vertices);
  FUZZ_REQUIRE(found->components == whole.components && found->boundary_components == whole.boundary_components);
  FUZZ_REQUIRE(found->genus == whole.genus);
  FUZZ_REQUIRE(same(found->volume, whole.volume) || (found->volume != found->volume && whole.volume != whole.volume));
  FUZZ_REQUIRE(same(found->min_dihedral.min, whole.min_dihedral.min) && same(found->edge_max, whole.edge_max));
  laves_mesh_free(mesh);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
  char path[] = "/tmp/laves-fuzz-XXXXXX";
  const int file = mkstemp(path);
  FUZZ_REQUIRE(file >= 0);
  FUZZ_REQUIRE(length == 0 || write(file, bytes, length) == (ssize_t)length);
  close(file);
  laves_context *context = make_context(length);
  laves_file_check found;
  laves_error error = {0};
  const laves_result result = laves_check_file(context, path, NULL, &found, &error);
  FUZZ_REQUIRE(result == LAVES_OK || (result == LAVES_ERROR_INPUT && error.result == result && strlen(error.text) > 10));
  if (result == LAVES_OK) compare(context, path, &found.check);
  FUZZ_REQUIRE(laves_context_bytes(context) == 0);
  laves_context_free(context);
  unlink(path);
  return 0;
}
