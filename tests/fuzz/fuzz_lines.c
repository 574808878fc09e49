/* Fuzzes the readers of points and lines: any bytes must be read or refused, with nothing left behind, and indices are in range.
 * A compressed byte may become 1032, each a number of eight bytes and an index of four in two lists. */
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz_target.h"
#include "io/read_lines.h"

enum { MEMORY_PER_BYTE = 60000 };

static void require_point(const laves__lines *lines, int32_t point) {
  FUZZ_REQUIRE(point >= 0 && (size_t)point < lines->point_count);
  FUZZ_REQUIRE(v3_finite(lines->points[point]));
}

static void check_lines(const laves__lines *lines) {
  const laves__line_list *l = &lines->list;
  for (size_t i = 0; i < l->single_count; i++) require_point(lines, l->single[i]);
  for (size_t i = 0; i < l->node_count; i++) require_point(lines, l->node[i]);
  for (size_t i = 0; i < l->line_count; i++) FUZZ_REQUIRE(l->line_end[i] >= laves__line_list_first(l, i) + 2);
  FUZZ_REQUIRE(l->line_count == 0 ? l->node_count == 0 : l->line_end[l->line_count - 1] == l->node_count);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
  laves_context_options options = laves_context_options_default();
  options.thread_count = 1;
  options.memory_limit = 200000 + (size_t)MEMORY_PER_BYTE * length;
  laves_context *context = laves_context_create(&options);
  FUZZ_REQUIRE(context != NULL);
  laves__lines lines;
  laves_error error = {0};
  const laves_result result = laves__lines_parse(context, "input", (const char *)bytes, length, &lines, &error);
  FUZZ_REQUIRE(result == LAVES_OK || (result == LAVES_ERROR_INPUT && error.result == result && strlen(error.text) > 10));
  if (result == LAVES_OK) check_lines(&lines);
  laves__lines_free(&lines);
  FUZZ_REQUIRE(laves_context_bytes(context) == 0);
  laves_context_free(context);
  return 0;
}
