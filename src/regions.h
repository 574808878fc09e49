/* Regions of the mesh: which closed part of the input surface, or named part of a formula, each tetrahedron is in. */
#ifndef LAVES_REGIONS_H
#define LAVES_REGIONS_H

#include "domain/oracle.h"
#include "mesh/mesh.h"

typedef struct laves__region_counts {
  size_t parts;      /* closed parts with an inside; below two the mesh has no regions */
  size_t empty;      /* of them those that no tetrahedron's centroid is in */
  size_t interfaces; /* faces between tetrahedra of different regions */
} laves__region_counts;

/* Gives the tets of a mesh of this domain their regions: 1 for the first part of the file, and so on, and one more for what is in
 * no closed part ("rest"); and adds the names. Domains that are no surface have no parts. LAVES_ERROR_MEMORY,
 * LAVES_ERROR_CANCELLED, LAVES_ERROR_OPTION when there are more tets than can be handled (2^32). */
laves_result laves__regions_of_parts(laves_context *context, const laves_domain *domain, laves_mesh *mesh,
                                     laves__region_counts *counts, laves_error *error);

/* The same for domains with named regions (oracle.region): 1 for what has no name, and so on in the order of the names.
 * LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__regions_of_names(laves_context *context, const laves_domain *domain, laves_mesh *mesh,
                                     laves__region_counts *counts, laves_error *error);

#endif
