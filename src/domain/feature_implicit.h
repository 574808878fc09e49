/* Features of implicit solids: what the files about them share.
 *
 *   feature_implicit.c   the story: cells -> branches and their borders -> creases -> patches; the callbacks
 *   feature_cells.c      the search: cells where branches may meet, feet in them, borders between the feet
 *   feature_trace.c      one crease, followed from a point of it to its ends
 *   feature_solve.c      points where one, two or three functions vanish
 *
 * The branches of tape_branch.h are the smooth pieces. Where two meet smoothly they become one patch; where they meet at an
 * angle above the wished one there is a crease, f = g = 0, known to rounding. */
#ifndef LAVES_DOMAIN_FEATURE_IMPLICIT_H
#define LAVES_DOMAIN_FEATURE_IMPLICIT_H

#include "domain/features.h"
#include "domain/point_grid.h"
#include "domain/tape_branch.h"

typedef struct laves__implicit_solid {
  const laves__tape *tape; /* these are not owned, and must outlive the features */
  laves__box3 bounds;
  double diagonal;
} laves__implicit_solid;

/* As laves__oracle.find_features: sets patches, callbacks and self, and gives the segments. `features` must stay where it is
 * until it is freed, as refine() looks up the patches of creases in it. */
laves_result laves__features_of_implicit(const laves__implicit_solid *solid, const laves__feature_wish *wish,
                                         laves__features *features, laves__feature_lines *lines, laves_error *error);

/* ---- solving ---- */

/* Newton's method to the zero of one function. False when none is found within reach. */
bool laves__tape_foot(const laves__tape *f, double diagonal, laves__vec3 start, double reach, laves__vec3 *foot,
                      laves__dual *there);
/* The point near `p` where `count` functions (1 to 3) vanish, by steps of least length; *p changes only on success. False when
 * none is found within reach, or the functions' gradients are too nearly dependent. */
bool laves__tapes_meet(const laves__tape *const *f, int count, double diagonal, double reach, laves__vec3 *p);

/* ---- what is found ---- */

/* A chord of a crease. The crease turns by little along it, and stays near. */
typedef struct laves__crease_piece {
  laves__vec3 ends[2];
  uint32_t points[2]; /* of the lines */
  int32_t branch[2];  /* left and right */
  double angle;       /* inside, degrees */
} laves__crease_piece;

/* Squared distance from p to the chord. */
double laves__piece_distance2(const laves__crease_piece *piece, laves__vec3 p);

typedef struct laves__implicit_features {
  const laves__features *features;
  laves__implicit_solid solid;
  double size; /* features that are longer are found; bounds the steps along creases */
  laves__code whole;
  laves__branches branches;
  int32_t *patch; /* [branch_capacity] while searching: parent in a forest of branches that are one patch; then the patch */
  bool *seen;     /* [branch_capacity] the branch has a point on the surface */
  size_t branch_capacity, seen_capacity;
  laves__crease_piece *piece;
  size_t piece_capacity;
  laves__point_grid piece_grid; /* their middles; its count is that of the pieces */
  int32_t *site_branch;         /* feet found in cells of several branches, one each */
  size_t site_capacity;
  laves__point_grid site_grid;
  uint32_t *members, *member_end; /* branches of each patch, one after the other: [branches.count], [patch_count] */
} laves__implicit_features;

/* ---- searching ---- */

/* A point between branches that meet at less than the wished angle. */
typedef struct laves__weak_border {
  laves__vec3 p;
  int32_t branch[2];
} laves__weak_border;

/* Where a crease ended without a corner that could be found. */
typedef struct laves__loose_end {
  laves__vec3 p;
  int32_t branch[2];
  uint32_t point;
  double way; /* along the crease, 1 or -1 */
} laves__loose_end;

typedef struct laves__crease_search {
  laves__implicit_features *all;
  laves_context *context;
  const laves__feature_wish *wish;
  laves__feature_lines *lines;
  size_t first_point, first_fixed; /* of the lines: what was there before is others' */
  double probe;                    /* the distance at which sides are looked at */
  double step;                     /* longest step along a crease */
  double sagitta;                  /* by how much a chord may miss its crease */
  laves__point_grid corner_grid;
  uint32_t *corner_point; /* of each corner */
  size_t corner_capacity;
  laves__weak_border *weak;
  size_t weak_count, weak_capacity;
  laves__loose_end *loose;
  size_t loose_count, loose_capacity;
  laves__vec3 *sample; /* [sample_capacity] a foot of each branch */
  size_t sample_capacity;
  laves__code *level; /* codes of the cells on the way down */
  laves__branch_room room;
  laves__code near, wide; /* valid in the boxes, around where the search goes on just now */
  laves__box3 near_box, wide_box;
  size_t cell_count;
  unsigned asked;
  double fraction; /* of the search that is done, roughly */
  double work;     /* instructions run, roughly */
  bool out_of_memory, cancelled, crowded;
} laves__crease_search;

/* Instructions that a search may run, a minute or two; then it ends with what it has found. When the cells alone take the
 * second, wider ones are taken. */
#define LAVES__SEARCH_WORK 1e10
#define LAVES__CELL_WORK 2e9

/* Whether the search goes on; asks the caller now and then. */
bool laves__search_goes_on(laves__crease_search *s);

/* A code that is valid for a size around p, until it is asked for another place. */
const laves__code *laves__local_code(laves__crease_search *s, laves__vec3 p);

/* The root of a branch's tree in the forest; two branches become one patch. */
int32_t laves__branch_root(const laves__implicit_features *all, int32_t branch);
void laves__branches_join(laves__implicit_features *all, int32_t a, int32_t b);

/* Whether a function goes through zero at a foot, along its gradient there; normal receives its direction. */
bool laves__branch_passes(const laves__tape *f, laves__vec3 foot, double depth, laves__vec3 *normal);
/* The branch that makes the surface at a foot, entered if new; LAVES__NO_BRANCH when there is none. normal: the solid's, then the
 * branch's. code: valid around there. depth: how far inside it is looked. */
int32_t laves__branch_of_foot(laves__crease_search *s, const laves__code *code, laves__vec3 foot, laves__vec3 *normal,
                              double depth);

/* Finds branches, smooth borders and creases in all cells. */
void laves__search_cells(laves__crease_search *s);
/* The same from points of all patches found so far, along the surface. */
void laves__search_walks(laves__crease_search *s);

/* Follows the crease of two branches through a point near it, unless that has been done; the pieces go to s->all. */
void laves__crease_trace(laves__crease_search *s, laves__vec3 start, int32_t a, int32_t b);

/* Follows the creases that leave the corners found, and those that they lead to. */
void laves__corners_complete(laves__crease_search *s);
/* Joins branches whose border was too weak for a crease, where no crease has gone on along it. */
void laves__weak_borders_join(laves__crease_search *s);

/* A corner, at a point met before if that is near. */
bool laves__corner_add(laves__crease_search *s, laves__vec3 p, uint32_t *point);

#endif
