/* Colours of a scene by the distance of the boundary from a solid's surface. */
#ifndef LAVES_CLI_SCENE_DISTANCE_H
#define LAVES_CLI_SCENE_DISTANCE_H

#include "scene.h"

/* Measures each boundary face of the scene at its corners, the middles of its edges and its centroid, and colours it by the
 * furthest of these.
 * @param info      of the domain: for surfaces distances are exact, else phi over the length of its gradient
 * @param furthest  out: the largest distance of all faces that are seen
 * @return false when memory is short or the work is to stop */
bool scene_measure_distances(const laves_domain *domain, const laves_domain_info *info, scene *subject, double *furthest);

#endif
