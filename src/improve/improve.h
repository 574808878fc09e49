/* Stage "improve": raises the worst elements of the boundary layer.
 *
 *     improve.c    the schedule: which tets are worked on, in which order, in which blocks of space
 *     measure.h    the quality that is raised: dihedral window and volume-length in one number
 *     relax.c      a quick Laplace start for surface vertices
 *     smooth.c     one vertex: max-min ascent by a proximal bundle step, on the surface for surface vertices
 *     contract.c   one edge: contraction, with everything undone when the worst does not rise
 *     flip.c       edges and faces: other tets between the same vertices, on graded backgrounds and where features are kept
 *     fit.c        how boundary faces lie to the surface
 *     release.c    where creases and corners are given up for the sake of angles
 *     guard.c      what must not happen to creases and corners
 *     journal.h    what was changed, so that it can be undone
 *
 * Source: the project's own measurements; max-min smoothing after [freitag1997], contraction after [klingner2007]. */
#ifndef LAVES_IMPROVE_IMPROVE_H
#define LAVES_IMPROVE_IMPROVE_H

#include "domain/frame.h"
#include "mesh/layer.h"
#include "mesh/mesh.h"

/* When a layer is improved. */
typedef enum laves__improve_when {
  LAVES__IMPROVE_FIRST,
  LAVES__IMPROVE_RELEASED, /* after features were let go of: without the Laplace start, what is far outside */
  LAVES__IMPROVE_LAST      /* once no more are let go of: where few are left well outside, these */
} laves__improve_when;

/* What is asked of every tetrahedron. */
typedef struct laves__window {
  double min_dihedral, max_dihedral; /* degrees */
  double volume_length;              /* 0: not asked */
  double held_min, held_max;         /* all tets are inside these angles and stay so; 0 and 180: nothing is held */
  laves__improve_when when;
  size_t passes;         /* at most so many; 0: as many as help */
  double deadline;       /* of laves__wall_seconds(), when to stop; 0: never */
  size_t block_vertices; /* as laves__blocks_begin() takes them; for tests */
  bool noise;            /* after a release: what was let go of was noise, so now all of the window is asked for */
  bool brief;            /* the solid is rougher than the size: few passes, and only the worst get more */
} laves__window;

/* Improves the layer, or what of it is fresh, until every tet is inside the window, or no operation helps.
 * Promise: the worst quality never falls; vertices on the surface stay on it; vertices deeper than LAVES__DEPTH_MOVES stay
 * where they are; tets stay positive (by an exact test); the boundary stays a manifold of the same topology.
 * The result does not depend on the number of threads.
 * LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__improve(const laves__frame *frame, const laves__window *window, laves__layer *layer, laves_error *error);

/* How many tets of the layer are outside a window; too few when cancelled meanwhile. */
size_t laves__improve_outside(const laves__window *window, const laves__layer *layer);

#endif
