/* What the targets of the mesh readers share. */
#ifndef LAVES_FUZZ_MESH_H
#define LAVES_FUZZ_MESH_H

#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz_target.h"
#include "io/mesh_input.h"

typedef laves_result fuzz_read_fn(laves__mesh_input *input, laves_error *error);

/* Indices are in range, as everything that works on meshes relies on. */
static void fuzz_check_mesh(const laves_mesh *mesh) {
  FUZZ_REQUIRE(mesh->tet_count > 0);
  for (size_t i = 0; i < mesh->vertex_count; i++) FUZZ_REQUIRE(v3_finite(mesh->points[i]));
  for (size_t i = 0; i < mesh->tet_count; i++)
    for (int j = 0; j < 4; j++) FUZZ_REQUIRE(mesh->tets[i][j] >= 0 && (size_t)mesh->tets[i][j] < mesh->vertex_count);
  for (size_t i = 0; i < mesh->face_count; i++)
    for (int j = 0; j < 3; j++) FUZZ_REQUIRE(mesh->faces[i][j] >= 0 && (size_t)mesh->faces[i][j] < mesh->vertex_count);
}

/* Reads the bytes and checks what laves_mesh_read() promises. Memory may take `memory_per_byte` of the file. */
static int fuzz_mesh(const uint8_t *bytes, size_t length, fuzz_read_fn *read, size_t memory_per_byte) {
  laves_context_options options = laves_context_options_default();
  options.thread_count = 1;
  options.memory_limit = 200000 + memory_per_byte * length;
  laves_context *context = laves_context_create(&options);
  FUZZ_REQUIRE(context != NULL);
  laves__mesh_input input = {
      .context = context, .name = "input", .begin = (const char *)bytes, .end = (const char *)bytes + length};
  laves_mesh *mesh = NULL;
  laves_error error = {0};
  laves_result result = read(&input, &error);
  if (result == LAVES_OK) result = laves__mesh_input_finish(&input, &mesh, &error);
  FUZZ_REQUIRE(result == LAVES_OK || (result == LAVES_ERROR_INPUT && error.result == result && strlen(error.text) > 10));
  FUZZ_REQUIRE((result == LAVES_OK) == (mesh != NULL));
  if (mesh) fuzz_check_mesh(mesh);
  laves_mesh_free(mesh);
  laves__mesh_input_free(&input);
  FUZZ_REQUIRE(laves_context_bytes(context) == 0);
  laves_context_free(context);
  return 0;
}

#endif
