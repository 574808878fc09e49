/* Fuzzes the reader of certificates, and holds what it reads against a mesh of one tetrahedron: any bytes must be read or
 * refused, and compared to an end. */
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz_target.h"
#include "io/certificate_table.h"

static void require_ranges(const laves_certificate *c) {
  FUZZ_REQUIRE(strlen(c->mesh_hash) < sizeof c->mesh_hash && strlen(c->input_name) < sizeof c->input_name);
  FUZZ_REQUIRE(c->options.align >= LAVES_ALIGN_NONE && c->options.align <= LAVES_ALIGN_ROTATION);
  FUZZ_REQUIRE(c->options.method >= LAVES_METHOD_AUTO && c->options.method <= LAVES_METHOD_STUFF);
  FUZZ_REQUIRE(c->exception_count <= LAVES_EXCEPTION_CAPACITY);
  for (size_t i = 0; i < c->exception_count; i++) {
    FUZZ_REQUIRE((int)c->exceptions[i].kind >= 0 && c->exceptions[i].kind < LAVES_EXCEPTION_COUNT);
    FUZZ_REQUIRE((int)c->exceptions[i].cause >= 0 && c->exceptions[i].cause < LAVES_CAUSE_COUNT);
    FUZZ_REQUIRE(c->exceptions[i].index >= -1);
  }
}

static void compare_with_mesh(laves_context *context, const laves_certificate *c) {
  static const double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  static const int32_t tet[4] = {0, 1, 2, 3};
  laves_difference differences[4];
  laves_mesh *mesh;
  size_t count;
  FUZZ_REQUIRE(laves_mesh_from_arrays(context, points, 4, tet, 1, NULL, &mesh, NULL) == LAVES_OK);
  FUZZ_REQUIRE(laves_certificate_verify(context, mesh, NULL, NULL, c, differences, 4, &count, NULL) == LAVES_OK);
  for (size_t i = 0; i < count && i < 4; i++) FUZZ_REQUIRE(strlen(differences[i].text) > 10);
  laves_mesh_free(mesh);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
  laves_context_options options = laves_context_options_default();
  options.thread_count = 1;
  laves_context *context = laves_context_create(&options);
  laves_certificate certificate;
  laves_error error = {0};
  FUZZ_REQUIRE(context != NULL);
  const laves_result result = laves__certificate_parse(context, (const char *)bytes, length, "input", &certificate, &error);
  FUZZ_REQUIRE(result == LAVES_OK || (result == LAVES_ERROR_INPUT && error.result == result && strlen(error.text) > 10));
  if (result == LAVES_OK) {
    require_ranges(&certificate);
    compare_with_mesh(context, &certificate);
  }
  FUZZ_REQUIRE(laves_context_bytes(context) == 0);
  laves_context_free(context);
  return 0;
}
