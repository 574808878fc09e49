/* Vertices held to features: which patches, creases and faces fit together, and where a held vertex may stand.
 *
 * A vertex on a patch belongs to it alone, one on a crease to the patches on its two sides, one at a corner to all around. An
 * edge of the boundary is legal when its ends have a patch in common, a face when its three corners have; then the borders
 * between the faces of different patches are chains of edges whose ends are held to creases, without gaps.
 *
 * All positions are those of the lattice. Read only, safe from many threads. */
#ifndef LAVES_DOMAIN_HELD_H
#define LAVES_DOMAIN_HELD_H

#include "domain/features.h"
#include "domain/frame.h"
#include "mesh/hold.h"

/* The patches of a vertex, ascending but for a crease's two; `room` holds them where no list does. Returns how many. */
int laves__hold_patches(const laves__features *features, laves__hold hold, int32_t room[2], const int32_t **patches);
/* Whether a vertex goes with a patch: one of its own joins it, or it is held to nothing. */
bool laves__hold_has_patch(const laves__features *features, laves__hold hold, int32_t patch);
/* Whether two vertices have a patch in common; those that are held to nothing go with all. */
bool laves__holds_meet(const laves__features *features, laves__hold a, laves__hold b);
/* Whether a vertex is on a crease, or a corner at its end. */
bool laves__hold_on_crease(const laves__features *features, laves__hold hold, int32_t crease);
/* A crease that both are on; LAVES__NO_FEATURE: none. */
int32_t laves__holds_crease(const laves__features *features, laves__hold a, laves__hold b);

/* The patch of a face: the one that its corners have in common, of several the one it lies nearest to and best along.
 * LAVES__NO_FEATURE: none, the face is not legal. */
int32_t laves__face_patch(const laves__frame *frame, const laves__hold hold[3], const laves__vec3 p[3], uint32_t hint);
/* The same without a choice: whether there is one. */
bool laves__face_is_legal(const laves__features *features, const laves__hold hold[3]);

/* Where a vertex may stand, near a point: on the surface, its patch or its crease within `reach`; at its corner wherever that is.
 * `direction` receives the normal of the surface or the tangent of the crease; zero for corners. */
bool laves__frame_project_held(const laves__frame *frame, laves__hold hold, laves__vec3 point, double reach, uint32_t *hint,
                               laves__vec3 *foot, laves__vec3 *direction);

/* Whether the way from a to b, both on a patch with the given normals there, passes a crease that has this patch on both sides,
 * or a line drawn on it. *crease: which. */
bool laves__way_crosses_seam(const laves__frame *frame, laves__vec3 a, laves__vec3 b, int32_t patch, laves__vec3 normal_a,
                             laves__vec3 normal_b, int32_t *crease);

#endif
