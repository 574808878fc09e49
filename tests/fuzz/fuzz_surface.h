/* What the targets of the surface readers share. */
#ifndef LAVES_FUZZ_SURFACE_H
#define LAVES_FUZZ_SURFACE_H

#include <stdlib.h>
#include <string.h>

#include "domain/surface_input.h"
#include "fuzz/fuzz_target.h"

/* Memory that a file of this many bytes may take. The densest content is a PLY of single bytes: a point of three bytes
 * takes 24 in memory, a triangle of one byte (a further corner of a polygon) 12 and a tag of 4; arrays grow by doubling
 * and hold old and new at once. Tag names take as many bytes again, and a table. */
static size_t fuzz_memory_limit(size_t length) { return 100000 + 200 * length; }

/* Parses the bytes and checks what surface_input.h promises; `name` has the extension that helps the reader be chosen. */
static int fuzz_surface(const uint8_t *bytes, size_t length, const char *name) {
  laves_context_options options = laves_context_options_default();
  options.thread_count = 1;
  options.memory_limit = fuzz_memory_limit(length);
  laves_context *context = laves_context_create(&options);
  FUZZ_REQUIRE(context != NULL);
  laves__surface_input input;
  laves_error error = {0};
  const laves_result result = laves__surface_parse(context, bytes, length, name, &input, &error);
  FUZZ_REQUIRE(result == LAVES_OK || (result == LAVES_ERROR_INPUT && error.result == result && strlen(error.text) > 10));
  FUZZ_REQUIRE((result == LAVES_OK) == (input.triangle_count > 0));
  for (size_t i = 0; i < input.point_count; ++i) {
    FUZZ_REQUIRE(v3_finite(input.points[i]));
  }
  for (size_t i = 0; i < input.triangle_count; ++i) {
    for (int j = 0; j < 3; ++j) FUZZ_REQUIRE(input.triangles[i][j] < input.point_count);
    FUZZ_REQUIRE(input.sources == NULL || input.sources[i] <= i);
    FUZZ_REQUIRE(input.tags == NULL || (input.tags[i] >= 0 && input.tags[i] < input.tag_count));
  }
  laves__surface_input_free(context, &input);
  FUZZ_REQUIRE(laves_context_bytes(context) == 0);
  laves_context_free(context);
  return 0;
}

#endif
