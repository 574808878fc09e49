/* What the readers of triangle surfaces share: growing arrays, polygons to fans, tags, messages.  A reader makes one from
 * the file's bytes, feeds it points and faces in the order of the file, and ends with laves__build_finish(). */
#ifndef LAVES_IO_SURFACE_BUILD_H
#define LAVES_IO_SURFACE_BUILD_H

#include "domain/surface_input.h"
#include "io/scan.h"
#include "io/tag_list.h"

typedef struct laves__surface_build {
  laves_context *context;
  laves__surface_input *input;
  laves_error *error;
  laves__scan scan;     /* of the whole file; binary readers use `at` as their place too */
  bool binary;          /* messages give bytes instead of lines */
  laves__tag_list tags; /* empty: the file names nothing */

  uint32_t fan[2];        /* first and latest corner of the face that is read now */
  size_t corner_count;    /* how many it has so far */
  uint32_t highest;       /* highest corner index seen */
  const char *highest_at; /* and where, for the message; NULL: no corner yet */
  size_t highest_face;    /* and in which face, from 1 */
  size_t face_count;      /* faces begun, before they became triangles */
  uint32_t *sources; /* [triangle_count] which of them each triangle is a part of; NULL: no face had more than three corners */
  size_t source_capacity;
} laves__surface_build;

/* Appends a point; all three must be finite. */
laves_result laves__build_point(laves__surface_build *build, double x, double y, double z);
/* Starts a face; corners follow, in order, and each from the third makes a triangle of a fan. Points may come later
 * than the faces that use them. */
void laves__build_face(laves__surface_build *build);
laves_result laves__build_corner(laves__surface_build *build, int64_t index);
/* Ends the face: LAVES_ERROR_INPUT when it has less than three corners. */
laves_result laves__build_face_end(laves__surface_build *build);
/* Names the triangles from here on. */
laves_result laves__build_tag(laves__surface_build *build, laves__word name, const char *before);

/* Room for this many more points and triangles, as far as the bytes that are left can hold them, so that a lie in
 * a file costs nothing. The bytes are the fewest that one of them takes in the file. */
laves_result laves__build_reserve(laves__surface_build *build, uint64_t point_count, size_t point_bytes, uint64_t face_count,
                                  size_t face_bytes);

/* Bytes behind the place. */
size_t laves__build_left(const laves__surface_build *build);
/* LAVES_ERROR_INPUT with the name and the place: a line for text, a byte for binary files. */
laves_result laves__build_fail(const laves__surface_build *build, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Checks that there are faces and that all corners exist, hands the tags to the input and frees the rest, on failure the
 * input too. `result` is that of the reader and passed on. */
laves_result laves__build_finish(laves__surface_build *build, laves_result result);

/* The readers; each returns the result and leaves the clean-up to laves__build_finish(). */
laves_result laves__read_stl_ascii(laves__surface_build *build);
laves_result laves__read_stl_binary(laves__surface_build *build);
laves_result laves__read_obj(laves__surface_build *build);
laves_result laves__read_ply(laves__surface_build *build);
laves_result laves__read_off(laves__surface_build *build);
laves_result laves__read_gmsh_surface(laves__surface_build *build);

/* Whether the bytes look like the format, from their beginning (and length) alone. */
bool laves__is_stl_ascii(laves__scan scan);
bool laves__is_stl_binary(laves__scan scan);
bool laves__is_obj(laves__scan scan);
bool laves__is_ply(laves__scan scan);
bool laves__is_off(laves__scan scan);
bool laves__is_gmsh(laves__scan scan);

#endif
