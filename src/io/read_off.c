/* OFF, the polygons of Geomview (its manual, "OFF: polyhedra").
 *
 *   [ST][C][N]OFF / nv nf [ne] / nv lines: x y z and whatever / nf lines: n i1 .. in and whatever
 *
 * Normals, colours and texture coordinates are the rest of the line and ignored; "#" begins a comment. The first word may
 * be missing, and the counts may stand beside it. Not read: "4OFF", "nOFF" (not three coordinates), "OFF BINARY". */
#include <stdio.h>
#include <string.h>

#include "io/surface_build.h"

/* The word that OFF files begin with. */
static bool is_off_word(laves__word word) {
  static const char *const PREFIXES[] = {"ST", "C", "N", "4", "n"};
  for (size_t i = 0; i < LAVES__COUNT_OF(PREFIXES); ++i) {
    const size_t length = strlen(PREFIXES[i]);
    if (word.length > 3 && memcmp(word.at, PREFIXES[i], length) == 0) {
      word.at += length;
      word.length -= length;
    }
  }
  return word.length == 3 && memcmp(word.at, "OFF", 3) == 0;
}

bool laves__is_off(laves__scan scan) {
  laves__word word;
  scan.comment = '#';
  return laves__scan_space(&scan) && laves__scan_word(&scan, &word) && is_off_word(word);
}

/* The first word, if it is there, and the counts of vertices and faces. */
static laves_result read_header(laves__surface_build *build, size_t *point_count, size_t *face_count) {
  laves__scan *scan = &build->scan;
  laves__word word;
  size_t edge_count;
  if (laves__is_off(*scan)) {
    laves__scan_space(scan);
    laves__scan_word(scan, &word);
    if (memchr(word.at, '4', word.length) || memchr(word.at, 'n', word.length) || laves__scan_keyword(scan, "BINARY")) {
      return laves__build_fail(build, "only OFF files in text with three coordinates are read, not 4OFF, nOFF or OFF BINARY");
    }
  }
  laves__scan_space(scan);
  if (!laves__scan_count(scan, UINT32_MAX, point_count)) {
    return laves__scan_fail_expected(scan, build->error, "the number of vertices");
  }
  laves__scan_space(scan);
  if (!laves__scan_count(scan, SIZE_MAX / 2, face_count)) {
    return laves__scan_fail_expected(scan, build->error, "the number of faces");
  }
  laves__scan_count(scan, SIZE_MAX / 2, &edge_count);
  if (laves__scan_blanks(scan)) {
    return laves__scan_fail_expected(scan, build->error, "the end of the line behind the counts of vertices, faces and edges");
  }
  return LAVES_OK;
}

static laves_result read_vertex(laves__surface_build *build, size_t index, size_t count) {
  laves__scan *scan = &build->scan;
  double x[3];
  for (int i = 0; i < 3; ++i) {
    laves__scan_space(scan);
    if (!laves__scan_double(scan, &x[i])) {
      char what[100];
      snprintf(what, sizeof what, "a coordinate (a finite number) of vertex %zu of %zu", index + 1, count);
      return laves__scan_fail_expected(scan, build->error, what);
    }
  }
  laves__scan_next_line(scan);
  return laves__build_point(build, x[0], x[1], x[2]);
}

static laves_result read_face(laves__surface_build *build, size_t index, size_t count) {
  laves__scan *scan = &build->scan;
  size_t corner_count;
  char what[100];
  laves__scan_space(scan);
  if (!laves__scan_count(scan, SIZE_MAX / 2, &corner_count)) {
    snprintf(what, sizeof what, "the number of corners of face %zu of %zu", index + 1, count);
    return laves__scan_fail_expected(scan, build->error, what);
  }
  laves__build_face(build);
  for (size_t i = 0; i < corner_count; ++i) {
    int64_t corner;
    laves__scan_space(scan);
    if (!laves__scan_int(scan, &corner)) {
      snprintf(what, sizeof what, "corner %zu of %zu of face %zu", i + 1, corner_count, index + 1);
      return laves__scan_fail_expected(scan, build->error, what);
    }
    const laves_result result = laves__build_corner(build, corner);
    if (result != LAVES_OK) return result;
  }
  const laves_result result = laves__build_face_end(build);
  laves__scan_next_line(scan);
  return result;
}

laves_result laves__read_off(laves__surface_build *build) {
  size_t point_count = 0, face_count = 0;
  strcpy(build->input->format, "OFF");
  build->scan.comment = '#';
  laves_result result = read_header(build, &point_count, &face_count);
  // The shortest vertex is "0 0 0" and the shortest face "3 0 1 2", each with a line end.
  if (result == LAVES_OK) result = laves__build_reserve(build, point_count, 6, face_count, 8);
  for (size_t i = 0; i < point_count && result == LAVES_OK; ++i) {
    result = read_vertex(build, i, point_count);
  }
  for (size_t i = 0; i < face_count && result == LAVES_OK; ++i) {
    result = read_face(build, i, face_count);
  }
  return result;
}
