/* What a mesh lacks of the topology of its domain: the last word of laves_generate() on thin parts. */
#ifndef LAVES_LOSSES_H
#define LAVES_LOSSES_H

#include "domain/frame.h"
#include "mesh/mesh.h"

/* Counts pieces and genus of a mesh's boundary, which must be a closed 2-manifold; false when memory is short. */
bool laves__boundary_topology(const laves_mesh *mesh, size_t *pieces, int64_t *genus);

/* Fills the report's members from `topology_known` to `lost`, to which the pinches have been added before, and says in a sentence
 * of at most `capacity` bytes what is lost, or nothing (an empty text) when the topology is right or not known. Where it differs,
 * places are looked for at which mesh and surface are far apart and the solid is thin; this costs as much as
 * laves_check_distance(). LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__find_losses(const laves__frame *frame, const laves_domain *domain, const laves_mesh *mesh,
                                laves_report *report, char *text, size_t capacity, laves_error *error);

#endif
