/* Stage "snap": the boundary without cuts.
 *
 * Every edge of the tiling whose ends differ in sign gets an end ON the surface; the vertices ON move to it; the tetrahedra
 * without an OUT vertex and with at least one IN vertex stay. No tile is cut, so the boundary layer keeps the tiling's good
 * connectivity. The steps are separate files:
 *
 *     cover.c   which vertices go ON: a small vertex cover of the crossing edges, nearest to the surface first
 *     thin.c    walls and gaps that an edge crosses twice: both its ends go ON
 *     sides.c   sites in a wall with the outside on two sides: those on the one side go ON, too
 *     tips.c    tips and ridges beyond the last sites inside: outer sites that reach them go ON
 *     solid.c   tets with four corners ON: part of the mesh where they lie inside
 *     pinch.c   places where the result would touch itself are trimmed or parted, so that the boundary is a manifold
 *     speck.c   parts of a few tets that hang together with nothing are dropped
 *     lost.c    what was trimmed, parted or dropped is named, with its place
 *     depth.c   how many edges each site is from the boundary, which tells what belongs to its layer
 *     place.c   the boundary layer as a mesh of its own, ON vertices moved to the surface
 *
 * All of this works on the tiling and on a graded background alike: background/site.h is where they ask. What is a length in
 * sizes is one in local sizes then, laves__site_scale() times the size.
 */
#ifndef LAVES_SNAP_SNAP_H
#define LAVES_SNAP_SNAP_H

#include "background/site.h"
#include "mesh/layer.h"
#include "snap/feet.h"

typedef struct laves__snap_counts {
  size_t snapped;     /* vertices ON the surface */
  size_t pinches;     /* vertices at which the boundary touched itself */
  size_t specks;      /* parts too small to keep */
  size_t off_surface; /* vertices that stay off the surface to keep their tets positive */
  size_t lost_count;
  laves_thin_place lost[LAVES_LOST_CAPACITY]; /* some of the pinches, in input coordinates */
} laves__snap_counts;

/* Sets labels of the lattice and makes the layer.
 * Promise: the boundary is a closed 2-manifold, every tet is positive (by an exact test), the connectivity is the
 * tiling's. The layer has no tets when nothing is inside at this size.
 * keep_thin: false: thin.c and tips.c are left out, and thin parts are what the first cover makes of them.
 * LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__snap(const laves__frame *frame, bool keep_thin, laves__lattice *lattice, laves__layer *layer,
                         laves__snap_counts *counts, laves_error *error);

/* The first step: labels. */
laves_result laves__cover(const laves__frame *frame, laves__lattice *lattice, laves__feet *feet, laves_error *error);

/* The second step: more labels ON, at thin walls (and forced) and narrow gaps. */
laves_result laves__thin_cover(const laves__frame *frame, laves__lattice *lattice, laves__feet *feet, laves_error *error);

/* Its last part: outer sites go ON (and forced) where a site has the outside on two sides. suspects: [record_count] bit for each
 * site that may be one. */
laves_result laves__side_cover(const laves__frame *frame, const uint32_t *suspects, laves__lattice *lattice, laves__feet *feet,
                               laves_error *error);

/* And at tips and ridges. All ON sites must have been asked for their feet. */
laves_result laves__tip_cover(const laves__frame *frame, laves__lattice *lattice, laves__feet *feet, laves_error *error);

/* Whether a tet with these corners, all on the surface, has a shape that improvement can work with. `scale`: the local size. */
bool laves__solid_shape(const laves__vec3 p[4], double scale);

/* The third step: which tets are LAVES__TET_SOLID and LAVES__TET_ELIGIBLE. All ON sites must have been asked for their feet. */
laves_result laves__find_solid(const laves__frame *frame, laves__lattice *lattice, const laves__feet *feet, laves_error *error);

/* Fans share no edge of the link, each of whose tets has three. */
enum { LAVES__FAN_LIMIT = LAVES__STAR_LIMIT / 2 };

/* A site at which the kept tets form more than one fan; each fan becomes a vertex of its own. */
typedef struct laves__parted_site {
  uint32_t site; /* record * LAVES__C15_SITES + site */
  int fan_count;
  uint64_t fan[LAVES__FAN_LIMIT];   /* bits of the site's star */
  int32_t vertex[LAVES__FAN_LIMIT]; /* in the layer */
} laves__parted_site;

typedef struct laves__parted {
  laves__parted_site *item; /* ascending by site */
  size_t count, capacity;
  uint32_t *trimmed; /* sites at which walls were trimmed, in the order of work */
  size_t trimmed_count, trimmed_capacity;
} laves__parted;

void laves__parted_free(laves_context *context, laves__parted *parted);

/* Lists a site's fans; false when memory is short. */
bool laves__part_site(const laves__lattice *lattice, int32_t record, int site, laves__parted *parted);

/* The fourth step: labels change until every ON site's kept tets form fans that each border on one piece of the outside;
 * sites with several fans are listed. Makes records where labels reach deeper. */
laves_result laves__pinch_repair(laves__lattice *lattice, laves__parted *parted, size_t *pinches, laves_error *error);

/* The length of the chord from a foot on the surface inwards (side -1) or outwards (1); INFINITY when over `longest`. */
double laves__chord(const laves__frame *frame, laves__vec3 foot, laves__vec3 normal, int side, double longest);
/* The shorter of the two chords, where that is below 1.5 local sizes; in input coordinates. */
laves_thin_place laves__thin_place(const laves__frame *frame, laves__vec3 foot, laves__vec3 normal, double scale);
/* Whether a place can be added to a list: there is room, and none in it is within `distance`. */
bool laves__lost_is_new(const laves_thin_place *lost, size_t count, const laves_thin_place *place, double distance);
/* Lists trimmed and parted sites. */
void laves__list_lost(const laves__frame *frame, const laves__lattice *lattice, const laves__parted *parted,
                      laves__snap_counts *counts);

/* The feet of all ON sites that are not known yet. */
laves_result laves__find_surface_feet(const laves__frame *frame, const laves__lattice *lattice, laves__feet *feet,
                                      laves_error *error);

/* What there is beside whole tets where tets are cut: vertices between sites, and the pieces. */
typedef struct laves__cuts {
  laves_context *context;
  laves__foot *vertex; /* [vertex_count] */
  size_t vertex_count;
  uint32_t (*tet)[4]; /* [tet_count] corners: a site's number, or LAVES__CUT_VERTEX with the index of a vertex */
  size_t tet_count, tet_capacity;
} laves__cuts;

#define LAVES__CUT_VERTEX (UINT32_C(1) << 31)

void laves__cuts_free(laves__cuts *cuts);

/* Depths of sites up to LAVES__DEPTH_MAX; no site that has a record may have one yet. Pieces may be NULL. False after a cancel.
 */
bool laves__measure_depths(laves__lattice *lattice, const laves__cuts *cuts);

/* The last step. Pieces may be NULL: no tet is cut. An ON site whose star is whole is an inner vertex of the layer. */
laves_result laves__layer_build(const laves__feet *feet, laves__lattice *lattice, laves__parted *parted, const laves__cuts *cuts,
                                laves__layer *layer, laves_error *error);
/* Removes specks: parts of a few tets without an inner vertex, that hang together with nothing else; returns how many parts
 * went. The last part always stays. */
size_t laves__layer_drop_specks(laves__layer *layer);
/* Draws vertices back from the surface, as little as needed, until every tet is positive; counts them. */
size_t laves__layer_untangle(laves__layer *layer, const laves__vec3 *start);

#endif
