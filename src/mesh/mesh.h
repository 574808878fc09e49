/* The mesh as compact arrays. */
#ifndef LAVES_MESH_MESH_H
#define LAVES_MESH_MESH_H

#include "base/base.h"
#include "base/vec3.h"

typedef struct laves__group {
  int dimension; /* 3: regions, 2: face tags */
  int32_t tag;
  char name[100];
} laves__group;

struct laves_mesh {
  laves_context *context;
  size_t vertex_count, tet_count, face_count;
  laves__vec3 *points;   /* [vertex_count] */
  int32_t (*tets)[4];    /* [tet_count] */
  int32_t (*faces)[3];   /* [face_count] boundary triangles, outwards */
  int32_t *regions;      /* [tet_count] or NULL: all 1 */
  int32_t *face_tags;    /* [face_count] or NULL: all 1 */
  int32_t *face_sources; /* [face_count] or NULL: not asked for */
  size_t lattice_tet_count;
  laves__group *groups;
  size_t group_count;
};

/* An empty mesh with arrays of the given sizes, contents undefined (regions and tags only when asked for).
 * NULL when memory is short. Free with laves_mesh_free(). */
laves_mesh *laves__mesh_create(laves_context *context, size_t vertex_count, size_t tet_count, size_t face_count, bool regions,
                               bool face_tags);
/* Adds a name for a tag; false when memory is short. */
bool laves__mesh_add_group(laves_mesh *mesh, int dimension, int32_t tag, const char *name);

/* The vertices of the face opposite corner i of a positive tet, seen counter-clockwise from outside. */
static const uint8_t laves__tet_face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
/* The corners of edge i: 01 02 03 12 13 23; the opposite edge of i is 5 - i. */
static const uint8_t laves__tet_edge[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

#endif
