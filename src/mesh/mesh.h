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

/* What makes the points and tets of a mesh that does not hold them. Any range may be asked for, in any order and from many
 * threads, and has the same bytes each time. False: it could not be made; why, only the maker knows. */
typedef struct laves__maker {
  void *self; /* NULL: the mesh holds them */
  bool (*points)(const void *self, size_t begin, size_t end, laves__vec3 *out);
  bool (*tets)(const void *self, size_t begin, size_t end, int32_t (*out)[4]);
  void (*free)(void *self);
} laves__maker;

/* Nodes of second order; see curve/quadratic.h for their places within an element. */
typedef struct laves__quadratic {
  size_t node_count;
  laves__vec3 *points; /* [node_count] the vertices, then the nodes on edges */
  int32_t (*tets)[10]; /* [tet_count] */
  int32_t (*faces)[6]; /* [face_count] */
} laves__quadratic;

/* The arrays are of a mesh with the counts of `mesh`. */
void laves__quadratic_free(laves_context *context, const laves_mesh *mesh, laves__quadratic *quadratic);

struct laves_mesh {
  laves_context *context;
  size_t vertex_count, tet_count, face_count;
  laves__vec3 *points;   /* [vertex_count]; NULL where there is a maker */
  int32_t (*tets)[4];    /* [tet_count]; likewise */
  int32_t (*faces)[3];   /* [face_count] boundary triangles, outwards */
  int32_t *regions;      /* [tet_count] or NULL: all 1 */
  int32_t *face_tags;    /* [face_count] or NULL: all 1 */
  int32_t *face_sources; /* [face_count] or NULL: not asked for */
  size_t lattice_tet_count;
  laves__group *groups;
  size_t group_count;
  laves__maker maker;
  laves__quadratic *quadratic; /* NULL: the mesh is of first order */
};

/* An empty mesh with arrays of the given sizes, contents undefined (regions and tags only when asked for).
 * NULL when memory is short. Free with laves_mesh_free(). */
laves_mesh *laves__mesh_create(laves_context *context, size_t vertex_count, size_t tet_count, size_t face_count, bool regions,
                               bool face_tags);
/* The same without points and tets, for a maker. */
laves_mesh *laves__mesh_create_hollow(laves_context *context, size_t vertex_count, size_t tet_count, size_t face_count,
                                      bool regions, bool face_tags);
/* Points, or tets, [begin, end), from memory or from the maker; false: they could not be made. */
bool laves__mesh_points(const laves_mesh *mesh, size_t begin, size_t end, laves__vec3 *out);
bool laves__mesh_tets(const laves_mesh *mesh, size_t begin, size_t end, int32_t (*out)[4]);
/* The same by single numbers: coordinates [begin, end) of 3 * vertex_count, corners of 4 * tet_count. */
bool laves__mesh_coordinates(const laves_mesh *mesh, size_t begin, size_t end, double *out);
bool laves__mesh_corners(const laves_mesh *mesh, size_t begin, size_t end, int32_t *out);
/* LAVES_ERROR_OPTION for a mesh that does not hold its points and tets, which `what`, a noun, needs. */
laves_result laves__mesh_require_arrays(const laves_mesh *mesh, const char *what, laves_error *error);
/* Adds a name for a tag; false when memory is short. */
bool laves__mesh_add_group(laves_mesh *mesh, int dimension, int32_t tag, const char *name);

/* The vertices of the face opposite corner i of a positive tet, seen counter-clockwise from outside. */
static const uint8_t laves__tet_face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
/* The corners of edge i: 01 02 03 12 13 23; the opposite edge of i is 5 - i. */
static const uint8_t laves__tet_edge[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/* Nodes of a tet and of a boundary face: 4 and 3, or 10 and 6. */
static inline int laves__tet_width(const laves_mesh *mesh) { return mesh->quadratic ? 10 : 4; }
static inline int laves__face_width(const laves_mesh *mesh) { return mesh->quadratic ? 6 : 3; }
/* All nodes of one; of a mesh in memory. */
static inline const int32_t *laves__tet_nodes(const laves_mesh *mesh, size_t i) {
  return mesh->quadratic ? mesh->quadratic->tets[i] : mesh->tets[i];
}
static inline const int32_t *laves__face_nodes(const laves_mesh *mesh, size_t i) {
  return mesh->quadratic ? mesh->quadratic->faces[i] : mesh->faces[i];
}

#endif
