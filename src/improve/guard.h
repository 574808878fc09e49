/* What topological operations must not do to features: the borders between patches stay chains of edges along creases. */
#ifndef LAVES_IMPROVE_GUARD_H
#define LAVES_IMPROVE_GUARD_H

#include "domain/held.h"
#include "mesh/layer.h"

/* The patch of a face of boundary vertices, counter-clockwise from outside; LAVES__NO_FEATURE: none, or there are no features. */
int32_t laves__layer_face_patch(const laves__frame *frame, const laves__layer *layer, const int32_t face[3]);

/* Whether a boundary edge lies on a crease: its ends share one, and its two faces belong to different patches (or the same patch
 * is on both sides of the crease). Then it must not go. */
bool laves__is_crease_edge(const laves__frame *frame, const laves__layer *layer, int32_t a, int32_t b);

/* Of a layer whose boundary is given: how many faces of the boundary, or of borders between regions (these are seen from both
 * sides), are at an edge, of whose ends the first moves. *patch: theirs, or LAVES__NO_PATCH where it is not one. */
int laves__given_edge(const laves__layer *layer, int32_t a, int32_t b, int32_t *patch);

/* What is wrong with features around a vertex: illegal faces, edges between patches whose ends share no crease, and the
 * difference between the number of edges between patches and what it should be (none on a patch, two on a crease, as many as
 * creases end at a corner). Zero where there are no features. */
int laves__feature_faults(const laves__frame *frame, const laves__layer *layer, int32_t vertex);

/* Local sizes: how far from a crease the edges along it may come to lie. The vertices of a crease with a radius of r sizes are
 * then at most sqrt(8 r / 25) sizes apart. */
#define LAVES__SAG_LIMIT 0.04

/* How far from their crease the middles of the boundary edges along it are, that leave a vertex on a crease; local sizes. */
double laves__crease_sag(const laves__frame *frame, const laves__layer *layer, int32_t vertex);

/* Whether a vertex may be merged into another along a boundary edge, as far as their holds tell. */
bool laves__may_merge(const laves__frame *frame, const laves__layer *layer, int32_t gone, int32_t into);

/* Edges of a tet on creases sharper than an angle that no other tet shares: the input fixes their dihedral angles. Bit e: edge e
 * of laves__tet_edge. */
unsigned laves__fixed_edges(const laves__features *features, double sharper_than, const laves__layer *layer, int32_t tet);
/* The same where the boundary is given; `sharp_cosine` is the cosine of the angle. */
unsigned laves__given_fixed_edges(double sharp_cosine, const laves__layer *layer, int32_t tet);

#endif
