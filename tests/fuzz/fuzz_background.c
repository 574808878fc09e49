/* Fuzzes the readers of size files: any bytes must be read or refused, with nothing left behind, and what was read has a size
 * everywhere. A compressed byte may become 1032, and a number of one byte a corner of a tet in the tree. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz_target.h"
#include "size/background.h"

enum { MEMORY_PER_BYTE = 150000 };

static void check_sizes(const laves__background_sizes *sizes) {
  static const laves__vec3 places[] = {{0, 0, 0},          {0.3, 0.4, 0.5},     {1, 1, 1},         {-7, 8, 9},
                                       {1e9, -1e9, 1e-12}, {1e200, 1e200, 0.5}, {NAN, INFINITY, 0}};
  double found[LAVES__COUNT_OF(places)];
  laves__background_evaluate(sizes, LAVES__COUNT_OF(places), places, found);
  for (size_t i = 0; i < LAVES__COUNT_OF(places); i++) FUZZ_REQUIRE(found[i] > 0 && isfinite(found[i]));
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
  laves_context_options options = laves_context_options_default();
  options.thread_count = 1;
  options.memory_limit = 300000 + (size_t)MEMORY_PER_BYTE * length;
  laves_context *context = laves_context_create(&options);
  FUZZ_REQUIRE(context != NULL);
  laves__background_sizes *sizes;
  laves_error error = {0};
  const laves_result result = laves__background_parse(context, "input", (const char *)bytes, length, NULL, &sizes, &error);
  FUZZ_REQUIRE(result == LAVES_OK || (result == LAVES_ERROR_INPUT && error.result == result && strlen(error.text) > 10));
  FUZZ_REQUIRE((result == LAVES_OK) == (sizes != NULL));
  if (sizes) check_sizes(sizes);
  laves__background_free(sizes);
  FUZZ_REQUIRE(laves_context_bytes(context) == 0);
  laves_context_free(context);
  return 0;
}
