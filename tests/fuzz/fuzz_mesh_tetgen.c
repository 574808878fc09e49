/* Fuzzes the reader of TetGen's files: .node, .ele and .face behind one another, parted by zero bytes. */
#include "fuzz/fuzz_mesh.h"

/* Narrows the input to what comes before the next zero byte of [*at, end), and moves behind that. */
static void next_part(laves__mesh_input *input, const char **at, const char *end) {
  const char *zero = *at < end ? memchr(*at, 0, (size_t)(end - *at)) : NULL;
  input->begin = *at;
  input->end = zero ? zero : end;
  *at = zero ? zero + 1 : end;
}

static laves_result read_parts(laves__mesh_input *input, laves_error *error) {
  const char *at = input->begin, *end = input->end;
  int64_t base = 0;
  next_part(input, &at, end);
  laves_result result = laves__read_tetgen_node(input, &base, error);
  next_part(input, &at, end);
  if (result == LAVES_OK) result = laves__read_tetgen_ele(input, base, error);
  next_part(input, &at, end);
  if (result == LAVES_OK) result = laves__read_tetgen_face(input, base, error);
  return result;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) { return fuzz_mesh(bytes, length, read_parts, 500); }
