/* Stage "mesh": the compact arrays, from bricks and boundary layer. */
#ifndef LAVES_ASSEMBLE_ASSEMBLE_H
#define LAVES_ASSEMBLE_ASSEMBLE_H

#include "background/lattice.h"
#include "mesh/layer.h"
#include "mesh/mesh.h"

/* How many vertices and tets the mesh of a labelled lattice will have, before improvement. */
void laves__assemble_estimate(const laves__lattice *lattice, const laves__layer *layer, int64_t *vertices, int64_t *tets);

/* The volume of the mesh as it is now, in cubes of the size. */
double laves__assemble_volume(const laves__lattice *lattice, const laves__layer *layer);

/* Builds the mesh. Tets [0, lattice_tet_count) are exact tiles, stamped from the table in the order of the cells; those of
 * the layer follow. Vertices are in the order of the cells, too. Boundary faces carry the tags of the surface, where it has
 * any. Of a graded background, other tets that were not touched stand between the two, and the order is the graph's.
 * Promise: indices in range, orientation positive, the same order for any number of threads.
 * `streamed`, only of the tiling: points and tets are not stored, but made when they are asked for (laves__mesh_points()); the
 * mesh takes the lattice then, which is empty afterwards.
 * LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED, LAVES_ERROR_OPTION when vertices exceed 2^31. */
laves_result laves__assemble(const laves__frame *frame, laves__lattice *lattice, const laves__layer *layer, bool streamed,
                             laves_mesh **mesh, laves_error *error);

#endif
