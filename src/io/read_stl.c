/* STL, the triangles of 3D Systems' stereolithography files (1989), in both forms.
 *
 *   ASCII:   solid NAME / facet normal i j k / outer loop / vertex x y z (three times) / endloop / endfacet / endsolid NAME
 *   binary:  80 bytes of header, uint32 n, then n times 12 floats (normal, three corners) and 16 bits of attributes;
 *            all little-endian
 *
 * Out: three points for each triangle, in the order of the file (whoever uses them welds). Normals and attributes are
 * ignored: the order of the corners says which side is outside. Each solid of an ASCII file is a tag. Loops of more than
 * three vertices, which some programs write, become fans. */
#include <string.h>

#include "io/surface_build.h"

/* ---- ASCII ---- */

bool laves__is_stl_ascii(laves__scan scan) {
  if (!laves__scan_space(&scan) || !laves__scan_keyword(&scan, "solid")) return false;
  // The header of a binary file may begin so too, but no facet follows the first line.
  laves__scan_next_line(&scan);
  laves__scan_space(&scan);
  return laves__scan_keyword(&scan, "facet") || laves__scan_keyword(&scan, "endsolid");
}

/* The next word must be this one, on this line or a later one. */
static laves_result expect(laves__scan *scan, laves_error *error, const char *keyword) {
  laves__scan_space(scan);
  if (laves__scan_keyword(scan, keyword)) return LAVES_OK;
  char what[32] = "'";
  strncat(strncat(what, keyword, sizeof what - 3), "'", 2);
  return laves__scan_fail_expected(scan, error, what);
}

static laves_result read_vertex(laves__surface_build *build) {
  double x[3];
  for (int i = 0; i < 3; ++i) {
    laves__scan_space(&build->scan);
    if (!laves__scan_double(&build->scan, &x[i])) {
      return laves__scan_fail_expected(&build->scan, build->error, "a coordinate (a finite number)");
    }
  }
  const laves_result result = laves__build_point(build, x[0], x[1], x[2]);
  return result != LAVES_OK ? result : laves__build_corner(build, (int64_t)build->input->point_count - 1);
}

/* What follows "facet". */
static laves_result read_facet(laves__surface_build *build) {
  laves__scan *scan = &build->scan;
  laves__word ignored;
  if (laves__scan_keyword(scan, "normal")) {
    // Some programs write nan here; the normal is not used, so that does no harm.
    for (int i = 0; i < 3; ++i) laves__scan_word(scan, &ignored);
  }
  laves_result result = expect(scan, build->error, "outer");
  if (result == LAVES_OK) result = expect(scan, build->error, "loop");
  laves__build_face(build);
  while (result == LAVES_OK && laves__scan_space(scan) && laves__scan_keyword(scan, "vertex")) {
    result = read_vertex(build);
  }
  if (result == LAVES_OK) result = expect(scan, build->error, build->corner_count < 3 ? "vertex" : "endloop");
  if (result == LAVES_OK) result = expect(scan, build->error, "endfacet");
  return result == LAVES_OK ? laves__build_face_end(build) : result;
}

laves_result laves__read_stl_ascii(laves__surface_build *build) {
  laves__scan *scan = &build->scan;
  laves_result result = LAVES_OK;
  strcpy(build->input->format, "STL (ASCII)");
  while (result == LAVES_OK && laves__scan_space(scan)) {
    result = expect(scan, build->error, "solid");
    if (result != LAVES_OK) break;
    const laves__word name = laves__scan_rest(scan);
    result = laves__build_tag(build, name.length > 0 ? name : (laves__word){"solid", 5}, "");
    while (result == LAVES_OK && laves__scan_space(scan) && laves__scan_keyword(scan, "facet")) {
      result = read_facet(build);
    }
    if (result == LAVES_OK) result = expect(scan, build->error, "endsolid");
    laves__scan_rest(scan);
  }
  return result;
}

/* ---- binary ---- */

enum { HEADER_SIZE = 84, FACET_SIZE = 50, CORNERS_OFFSET = 12 };

static uint32_t little_u32(const char *at) {
  const unsigned char *byte = (const unsigned char *)at;
  return (uint32_t)byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
}

static float little_float(const char *at) {
  const uint32_t bits = little_u32(at);
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

/* The header begins at the first byte, even if that looks like a byte order mark. */
bool laves__is_stl_binary(laves__scan scan) {
  const size_t length = (size_t)(scan.end - scan.begin);
  return length >= HEADER_SIZE && (length - HEADER_SIZE) % FACET_SIZE == 0 &&
         little_u32(scan.begin + HEADER_SIZE - 4) == (length - HEADER_SIZE) / FACET_SIZE;
}

/* The facet at the place becomes the next triangle of the input, which has room for it. */
static laves_result take_facet(laves__surface_build *build) {
  laves__surface_input *input = build->input;
  const char *corners = build->scan.at + CORNERS_OFFSET;
  const uint32_t first = (uint32_t)input->point_count;
  for (int i = 0; i < 3; ++i, corners += 12) {
    const laves__vec3 point = v3(little_float(corners), little_float(corners + 4), little_float(corners + 8));
    if (!v3_finite(point)) {
      return laves__build_fail(build, "facet %zu has a coordinate that is not a finite number", input->triangle_count + 1);
    }
    input->points[first + i] = point;
    input->triangles[input->triangle_count][i] = first + (uint32_t)i;
  }
  input->point_count += 3;
  ++input->triangle_count;
  build->scan.at += FACET_SIZE;
  return LAVES_OK;
}

laves_result laves__read_stl_binary(laves__surface_build *build) {
  laves__scan *scan = &build->scan;
  const size_t length = (size_t)(scan->end - scan->begin);
  build->binary = true;
  strcpy(build->input->format, "STL (binary)");
  scan->at = scan->begin;
  if (length < HEADER_SIZE) {
    return laves__build_fail(build,
                             "neither ASCII STL (no 'solid' with facets) nor binary: the file has %zu bytes, a header alone %d",
                             length, HEADER_SIZE);
  }
  const uint32_t facet_count = little_u32(scan->begin + HEADER_SIZE - 4);
  if (length - HEADER_SIZE != (uint64_t)facet_count * FACET_SIZE) {
    scan->at += HEADER_SIZE - 4;
    return laves__build_fail(build,
                             "the file promises %u facets, which take %llu bytes, but it has %zu; it is no STL, or was cut",
                             facet_count, (unsigned long long)facet_count * FACET_SIZE + HEADER_SIZE, length);
  }
  if (facet_count > UINT32_MAX / 3) {
    return laves__build_fail(build, "%u facets are more than can be read (%u)", facet_count, UINT32_MAX / 3);
  }
  scan->at += HEADER_SIZE;
  laves_result result = laves__build_reserve(build, (uint64_t)facet_count * 3, FACET_SIZE / 3, facet_count, FACET_SIZE);
  for (uint32_t i = 0; i < facet_count && result == LAVES_OK; ++i) {
    result = take_facet(build);
    if ((i & 0xFFFF) == 0 && laves__cancelled(build->context, "read", (double)i / facet_count)) {
      result = laves__fail_cancelled(build->error);
    }
  }
  return result;
}
