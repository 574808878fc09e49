/* The graded background: tetrahedra whose size follows a field.
 *
 *     octree.c     cubes from wishes: refined, limited in gradient, balanced
 *     decorate.c   where the cubes' lattice becomes C15
 *     tiles.c      vertices and tetrahedra
 *     keys.c       places as keys
 *
 * Promise: conforming; every dihedral angle between 45 and 120 degrees, whatever the field. There are finitely many shapes:
 * the tiles of C15 and of BCC; halves and quarters of the latter and half pyramids, where sizes change; and what fills the
 * place of a site at a wall between the lattices. docs/graded.md tells them all.
 *
 * Nothing is triangulated by distances, moved or flipped; docs/decisions/008-graded-background.md tells what else there was. */
#ifndef LAVES_GRADED_GRADED_H
#define LAVES_GRADED_GRADED_H

#include "background/graph.h"
#include "graded/octree.h"

/* Fills an empty graph, with its lists, and the octree from which it comes; both to be freed by the caller, also after an
 * error. LAVES_ERROR_OPTION when the field asks for too much, LAVES_ERROR_MEMORY (before more than the octree is made, where what
 * comes of it can't be within the limit), LAVES_ERROR_CANCELLED. */
laves_result laves__graded_background(const laves__frame *frame, const laves__demand *demand, laves_context *context,
                                      laves__octree *tree, laves__graph *graph, laves_error *error);

/* About how many tets and vertices the mesh will have, from the leaves alone, and how many those are. */
laves_result laves__graded_estimate(const laves__frame *frame, const laves__demand *demand, laves_context *context, double *tets,
                                    double *vertices, size_t *leaves, laves_error *error);

#endif
