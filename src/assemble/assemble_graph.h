/* Stage "mesh" of a graded background; what assemble.h promises. */
#ifndef LAVES_ASSEMBLE_ASSEMBLE_GRAPH_H
#define LAVES_ASSEMBLE_ASSEMBLE_GRAPH_H

#include "background/lattice.h"
#include "mesh/layer.h"
#include "mesh/mesh.h"

void laves__assemble_graph_estimate(const laves__lattice *lattice, const laves__layer *layer, int64_t *vertices, int64_t *tets);

/* The volume of the tets that are stamped as they are. */
double laves__assemble_graph_volume(const laves__graph *graph);

laves_result laves__assemble_graph(const laves__frame *frame, laves__lattice *lattice, const laves__layer *layer,
                                   laves_mesh **mesh, laves_error *error);

#endif
