/* Moves one vertex. */
#ifndef LAVES_IMPROVE_SMOOTH_H
#define LAVES_IMPROVE_SMOOTH_H

#include "improve/journal.h"
#include "improve/measure.h"

/* Raises the worst quality of the tets around a movable vertex, up to `target`. Surface vertices move on the surface.
 * Qualities of the star are kept up to date; true when the vertex moved. */
bool laves__smooth_vertex(const laves__frame *frame, const laves__measure *measure, double target, laves__layer *layer,
                          int32_t vertex, laves__journal *journal);

/* The worst quality around a vertex. */
double laves__star_quality(const laves__layer *layer, int32_t vertex);

/* Brings a boundary vertex that stands off its place (the surface, its patch, its crease, its corner) there, when no tet falls
 * below `floor` or, where they are worse already, none gets worse; else half or a quarter of the way, where that can be. True
 * when it moved; layer->off_surface tells whether it arrived. */
bool laves__settle_vertex(const laves__frame *frame, const laves__measure *measure, double floor, laves__layer *layer,
                          int32_t vertex);

#endif
