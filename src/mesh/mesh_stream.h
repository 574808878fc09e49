/* A mesh that stays in its file: points by ranges, cells one after the other. Who reads files fills it in, who checks meshes
 * calls it, from one thread. */
#ifndef LAVES_MESH_MESH_STREAM_H
#define LAVES_MESH_MESH_STREAM_H

#include "base/base.h"
#include "base/vec3.h"

typedef struct laves__mesh_stream {
  void *user;       /* the reader's */
  const char *name; /* of the file, for messages */
  size_t point_count;
  /* As far as the cells have been read, since `rewind`. */
  double fraction;
  size_t triangle_count; /* cells that are triangles, counted while the tets are read */
  bool higher_order;     /* some of the tets or triangles have more nodes than corners */
  /* Points [first, first + count), which exist; any of them may be not finite. */
  laves_result (*read_points)(void *user, size_t first, size_t count, laves__vec3 *points, laves_error *error);
  /* Back to the first cell; from here on `next` yields those with so many corners: 4: tets, 3: triangles. */
  void (*rewind)(void *user, int corner_count);
  /* The next cells in the order of the file, at most `capacity`, each of their corners a point; *count 0: that was all. The
   * fourth corner of triangles is -1. */
  laves_result (*next)(void *user, int32_t (*cells)[4], size_t capacity, size_t *count, laves_error *error);
} laves__mesh_stream;

#endif
