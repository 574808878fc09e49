/* What lives from stage to stage of laves_generate(), and the steps that more than one file takes.
 *
 *   pipeline.c   the story
 *   boundary.c   background, classify, snap or stuff, as often as a count of tets asks for
 *   promise.c    features, improve, and stuffing where the promised window is broken
 *   verdict.c    what was reached, and what was not */
#ifndef LAVES_RUN_H
#define LAVES_RUN_H

#include "domain/features.h"
#include "features/keep.h"
#include "graded/graded.h"
#include "graded/wishes.h"
#include "improve/improve.h"
#include "options.h"
#include "regions.h"
#include "snap/snap.h"
#include "stuff/stuff.h"

/* What lives from stage to stage. */
typedef struct laves__run {
  laves_context *context;
  const laves_domain *domain;
  const laves_options *options;
  laves_report *report;
  laves_error *error;
  laves__frame frame;
  laves__size *sizes; /* NULL: the size is the same everywhere, and the next three are not used */
  laves__wishes wishes;
  laves__octree tree;
  laves__features features;
  laves__kept_counts kept_features;
  bool *forced; /* [forced_count] tets whose angles the input fixes below the promise; NULL: none */
  size_t forced_count;
  size_t released; /* vertices that were let go of for the sake of angles */
  laves__graph graph;
  laves__lattice lattice;
  laves__layer layer;
  laves__snap_counts counts;
  laves__stuff_counts stuffed;
  const laves__guarantee *guarantee; /* NULL: nothing is promised */
  double counted, kept;              /* tets or vertices before improvement, whichever are asked for; their share after it */
  int recounts, recounts_max;        /* how often all was made again for a count, and how often it may be */
  double best_size, least_miss;      /* of those: the size that came nearest, and how far that is off, as a logarithm */
  bool settled;                      /* the size is that one, and is no longer corrected */
  int round;                         /* of refinement for the sake of the distance */
  size_t distant;                    /* places still further away than asked */
  laves__vec3 distant_place;         /* the furthest of them */
  bool rough;                        /* the solid is rougher than the size */
  bool noise;                        /* so are its features, which can't be kept */
  size_t gaps_before;                /* values of the caller's function that were no numbers, before this run */
  laves__region_counts regions;
  double wall, cpu; /* at the start of the stage under way */
} laves__run;

/* ---- run.c ---- */

/* Stages are timed between these two; the second adds to the line of that name in the report. */
void laves__stage_begin(laves__run *r);
void laves__stage_end(laves__run *r, const char *name);
/* Half a sentence: how often in this run the caller's function gave what is no number, and where. False where it never did, and
 * then text is empty. */
bool laves__tell_gaps(const laves__run *r, char *text, size_t size);
/* Adds a sentence to the report, while there is room. */
void laves__warn(laves__run *r, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* ---- boundary.c ---- */

/* Background to boundary; repeated with a corrected size when a count was asked for and missed. */
laves_result laves__make_boundary(laves__run *r);
/* The boundary made anew by stuffing: in the lattice's zone, or all of it. */
laves_result laves__stuff_zone(laves__run *r);
laves_result laves__stuff_everything(laves__run *r);
/* Volume of the mesh as it is now, over that of the solid. */
double laves__filled_share(const laves__run *r);
/* Whether stuffing may take the place of snapping. */
bool laves__may_mend(const laves__run *r);
/* The error that nothing is left at this size. */
laves_result laves__nothing_resolved(const laves__run *r);

/* ---- promise.c ---- */

/* Holds the boundary to the features of the solid, as far as it was snapped. */
laves_result laves__hold_boundary(laves__run *r);
/* The layer improved, and inside the promised window. */
laves_result laves__improve_boundary(laves__run *r);
/* The smallest size at the boundary, in units of the input. */
double laves__least_size(const laves__run *r);

/* ---- verdict.c ---- */

/* Fills the report: what was asked, what is there, with a sentence for what is not. LAVES_TARGET_MISSED, or why it can't tell. */
laves_result laves__judge(laves__run *r, const laves_mesh *mesh);
/* How many tetrahedra of the layer are outside the window that was asked for. */
size_t laves__count_outside(const laves__run *r);

#endif
