/* The mesh of any program as a layer whose boundary is given, and back.
 *
 * The boundary of the mesh, and the borders between its regions, are kept as they are in space: faces in one plane, with one tag
 * and between the same regions, form a patch; edges between patches are creases. A vertex amid a patch may move in its plane, one
 * on a straight crease along it; all others stay.
 *
 *      +-------o-------+          o  a patch's border: moves along it, if it is straight
 *      |       |  .    |          .  amid a patch: moves in its plane
 *      o---+---o       |          +  corner: stays
 *      |   |   |    .  |
 *      +---o---+-------+          On a curved surface each triangle is a patch, and all vertices are corners. */
#ifndef LAVES_IMPROVE_GIVEN_H
#define LAVES_IMPROVE_GIVEN_H

#include "mesh/layer.h"
#include "mesh/mesh.h"

/* What is known of the mesh beside its layer. Zeroed before use. */
typedef struct laves__given {
  laves_context *context;
  const laves_mesh *mesh;
  laves__vec3 centre; /* input coordinates of the layer's zero point */
  double size;        /* of the layer's unit: the mean edge of the mesh */
  int32_t *patch_tag; /* [patch_count] */
  size_t patch_count;
  size_t held_vertices, crease_vertices, flat_vertices; /* of the boundary and borders: that stay, move along lines, in planes */
  double sharpest; /* least angle between patches inside one region, degrees; 180: there is none */
} laves__given;

/* The layer of a mesh that is valid. The boundary keeps its place within `tolerance`, units of the mesh; 0: but for rounding.
 * `fixed`: the vertices and edges of the boundary stay as they are, too.
 * LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED; free both whatever is returned. */
laves_result laves__given_layer(laves_context *context, const laves_mesh *mesh, double tolerance, bool fixed, laves__given *given,
                                laves__layer *layer, laves_error *error);
/* The mesh of a layer: vertices and tets in the layer's order, tags and names as before. Vertices that did not move have the
 * coordinates that they had, bit for bit. LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__given_mesh(const laves__given *given, const laves__layer *layer, laves_mesh **mesh, laves_error *error);
void laves__given_free(laves__given *given);

#endif
