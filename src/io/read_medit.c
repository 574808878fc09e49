/* Medit's .mesh (text) and .meshb (binary, versions 1 to 4, either byte order): vertices, tetrahedra and triangles with
 * their references, straight or of second order; everything else is skipped. Source: see write_medit.c. */
#include "io/binary.h"
#include "io/mesh_input.h"
#include "io/scan.h"

static int32_t clamp(int64_t value) { return value < INT32_MIN ? INT32_MIN : value > INT32_MAX ? INT32_MAX : (int32_t)value; }

/* Numbers from 1 become indices from 0; what does not fit becomes -1 and is refused later. */
static int32_t index_of(int64_t number) { return number >= 1 && number <= INT32_MAX ? (int32_t)(number - 1) : -1; }

/* Elements by their nodes, of which the corners come first. */
typedef struct shape {
  const char *keyword; /* of the text form */
  int32_t key;         /* of the binary form */
  int corner_count, node_count;
} shape;
static const shape shapes[] = {
    {"Tetrahedra", 8, 4, 4}, {"Triangles", 6, 3, 3}, {"TetrahedraP2", 30, 4, 10}, {"TrianglesP2", 24, 3, 6}};
enum { NODES_MAX = 10 };

/* row: the nodes, then the reference. */
static laves_result add_element(laves__mesh_input *input, const shape *s, const int64_t row[NODES_MAX + 1], laves_error *error) {
  int32_t corners[4];
  const int corner_count = s->corner_count;
  for (int j = 0; j < corner_count; j++) corners[j] = index_of(row[j]);
  const int32_t reference = clamp(row[s->node_count]);
  input->higher_order |= s->node_count > corner_count;
  const bool enough = corner_count == 4 ? laves__mesh_input_add_tet(input, corners, reference)
                                        : laves__mesh_input_add_face(input, corners, reference);
  return enough ? LAVES_OK : laves__fail_memory(input->context, error);
}

static bool pause_due(size_t i) { return i % 65536 == 65535; }

/* ---- text ---- */

static laves_result read_count(laves__scan *scan, size_t *count, laves_error *error) {
  /* No item takes less than two bytes, so a larger count can't be true. */
  if (laves__scan_space(scan) && laves__scan_count(scan, (size_t)(scan->end - scan->begin), count)) return LAVES_OK;
  return laves__scan_fail_expected(scan, error, "a count that the file has room for");
}

static laves_result read_vertices(laves__mesh_input *input, laves__scan *scan, laves_error *error) {
  size_t count = 0;
  const laves_result result = read_count(scan, &count, error);
  for (size_t i = 0; i < count && result == LAVES_OK; i++) {
    double xyzr[4];
    for (int j = 0; j < 4; j++)
      if (!laves__scan_space(scan) || !laves__scan_double(scan, &xyzr[j]))
        return laves__scan_fail_expected(scan, error, j < 3 ? "a coordinate" : "a vertex's reference");
    if (!laves__mesh_input_add_point(input, v3(xyzr[0], xyzr[1], xyzr[2]))) return laves__fail_memory(input->context, error);
    if (pause_due(i) && laves__mesh_input_cancelled(input, scan->at)) return laves__fail_cancelled(error);
  }
  return result;
}

static laves_result read_elements(laves__mesh_input *input, laves__scan *scan, const shape *s, laves_error *error) {
  size_t count = 0;
  laves_result result = read_count(scan, &count, error);
  for (size_t i = 0; i < count && result == LAVES_OK; i++) {
    int64_t row[NODES_MAX + 1] = {0};
    for (int j = 0; j <= s->node_count; j++)
      if (!laves__scan_space(scan) || !laves__scan_int(scan, &row[j]))
        return laves__scan_fail_expected(scan, error, j < s->node_count ? "a vertex number" : "an element's reference");
    result = add_element(input, s, row, error);
    if (pause_due(i) && laves__mesh_input_cancelled(input, scan->at)) return laves__fail_cancelled(error);
  }
  return result;
}

static laves_result check_dimension(laves__scan *scan, laves_error *error) {
  int64_t dimension;
  if (!laves__scan_space(scan) || !laves__scan_int(scan, &dimension))
    return laves__scan_fail_expected(scan, error, "a dimension");
  return dimension == 3 ? LAVES_OK : laves__scan_fail(scan, error, "the dimension is %lld; it must be 3", (long long)dimension);
}

laves_result laves__read_medit_text(laves__mesh_input *input, laves_error *error) {
  laves__scan scan = laves__scan_begin(input->name, input->begin, (size_t)(input->end - input->begin));
  scan.comment = '#';
  laves_result result = LAVES_OK;
  while (result == LAVES_OK && laves__scan_space(&scan)) {
    laves__word word;
    laves__scan_word(&scan, &word);
    if (laves__word_is(word, "Dimension"))
      result = check_dimension(&scan, error);
    else if (laves__word_is(word, "Vertices"))
      result = read_vertices(input, &scan, error);
    else if (laves__word_is(word, "End"))
      break;
    else
      for (size_t i = 0; i < LAVES__COUNT_OF(shapes); i++)
        if (laves__word_is(word, shapes[i].keyword)) result = read_elements(input, &scan, &shapes[i], error);
    /* Other keywords and their numbers pass word by word. */
  }
  return result;
}

/* ---- binary ---- */

enum { KEY_DIMENSION = 3, KEY_VERTICES = 4, KEY_END = 54 };

typedef struct binary_file {
  laves__mesh_input *input;
  laves__binary b;
  uint32_t version;
} binary_file;

/* Integers have 64 bits in version 4, positions from version 3 on; reals are float in version 1. */
static bool next_integer(binary_file *f, int64_t *value) {
  int32_t narrow;
  uint64_t wide;
  if (f->version >= 4) {
    if (!laves__binary_u64(&f->b, &wide)) return false;
    *value = (int64_t)wide;
    return true;
  }
  if (!laves__binary_i32(&f->b, &narrow)) return false;
  *value = narrow;
  return true;
}

static bool next_position(binary_file *f, uint64_t *value) {
  uint32_t narrow;
  if (f->version >= 3) return laves__binary_u64(&f->b, value);
  if (!laves__binary_u32(&f->b, &narrow)) return false;
  *value = narrow;
  return true;
}

static bool next_real(binary_file *f, double *value) {
  return f->version == 1 ? laves__binary_float(&f->b, value) : laves__binary_double(&f->b, value);
}

static laves_result fail_short(binary_file *f, laves_error *error, const char *what) {
  return laves__mesh_input_fail(f->input, error, "the file ends at byte %zu where %s should be",
                                (size_t)(f->b.end - f->input->begin), what);
}

static laves_result read_binary_vertices(binary_file *f, laves_error *error) {
  int64_t count, reference;
  if (!next_integer(f, &count)) return fail_short(f, error, "the number of vertices");
  for (int64_t i = 0; i < count; i++) {
    laves__vec3 p;
    if (!next_real(f, &p.x) || !next_real(f, &p.y) || !next_real(f, &p.z) || !next_integer(f, &reference))
      return fail_short(f, error, "a vertex");
    if (!laves__mesh_input_add_point(f->input, p)) return laves__fail_memory(f->input->context, error);
    if (pause_due((size_t)i) && laves__mesh_input_cancelled(f->input, f->b.at)) return laves__fail_cancelled(error);
  }
  return LAVES_OK;
}

static laves_result read_binary_elements(binary_file *f, const shape *s, laves_error *error) {
  int64_t count, row[NODES_MAX + 1] = {0};
  if (!next_integer(f, &count)) return fail_short(f, error, "the number of elements");
  laves_result result = LAVES_OK;
  for (int64_t i = 0; i < count && result == LAVES_OK; i++) {
    for (int j = 0; j <= s->node_count; j++)
      if (!next_integer(f, &row[j])) return fail_short(f, error, "an element");
    result = add_element(f->input, s, row, error);
    if (pause_due((size_t)i) && laves__mesh_input_cancelled(f->input, f->b.at)) return laves__fail_cancelled(error);
  }
  return result;
}

static laves_result check_binary_dimension(binary_file *f, laves_error *error) {
  int32_t dimension;
  if (!laves__binary_i32(&f->b, &dimension)) return fail_short(f, error, "the dimension");
  if (dimension == 3) return LAVES_OK;
  return laves__mesh_input_fail(f->input, error, "the dimension is %ld; it must be 3", (long)dimension);
}

static laves_result read_block(binary_file *f, int32_t key, laves_error *error) {
  if (key == KEY_DIMENSION) return check_binary_dimension(f, error);
  if (key == KEY_VERTICES) return read_binary_vertices(f, error);
  for (size_t i = 0; i < LAVES__COUNT_OF(shapes); i++)
    if (key == shapes[i].key) return read_binary_elements(f, &shapes[i], error);
  return LAVES_OK;
}

laves_result laves__read_medit_binary(laves__mesh_input *input, laves_error *error) {
  binary_file f = {.input = input, .b = {input->begin, input->end, false}};
  int32_t mark = 0, key;
  laves__binary_i32(&f.b, &mark);
  f.b.swapped = mark != 1;
  if (!laves__binary_u32(&f.b, &f.version) || f.version < 1 || f.version > 4)
    return laves__mesh_input_fail(input, error, "the version of the .meshb format must be 1 to 4");
  laves_result result = LAVES_OK;
  while (result == LAVES_OK) {
    const size_t start = (size_t)(f.b.at - input->begin);
    uint64_t next;
    if (!laves__binary_i32(&f.b, &key) || !next_position(&f, &next)) return fail_short(&f, error, "a keyword");
    if (key == KEY_END) break;
    result = read_block(&f, key, error);
    if (result != LAVES_OK || next == 0) break;
    /* Blocks only ever lead onwards, so a file can't lead in circles. */
    if (next <= start || next > (uint64_t)(input->end - input->begin))
      return laves__mesh_input_fail(input, error, "the block at byte %zu points to byte %llu; the file is damaged", start,
                                    (unsigned long long)next);
    f.b.at = input->begin + next;
  }
  return result;
}
