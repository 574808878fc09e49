/* Patches that lie on both sides of a crease are split along it. */
#ifndef LAVES_DOMAIN_FEATURE_SEAM_H
#define LAVES_DOMAIN_FEATURE_SEAM_H

#include "domain/feature_edges.h"

/* Gives the faces beside creases that have one patch on both sides patches of their own, from *count on, one for each side of
 * each crease, and lists which patches go together (laves__patches_join). False when memory is short. */
bool laves__split_seams(const laves__feature_edges *edges, int32_t *of_face, laves__features *features);

#endif
