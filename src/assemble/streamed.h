/* A mesh that makes its points and tets when they are asked for. */
#ifndef LAVES_ASSEMBLE_STREAMED_H
#define LAVES_ASSEMBLE_STREAMED_H

#include "assemble/layer_part.h"
#include "assemble/stamp.h"
#include "mesh/mesh.h"

/* Gives a hollow mesh its maker. Takes the lattice, which is empty then, the arrays of `stamps`, and of `part` those that
 * stamping reads. LAVES_ERROR_MEMORY: nothing was taken. */
laves_result laves__streamed_make(const laves__stamps *stamps, laves__layer_part *part, laves__lattice *lattice, laves_mesh *mesh,
                                  laves_error *error);

#endif
