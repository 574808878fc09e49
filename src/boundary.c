/* From the background to a boundary.
 *
 *     background -> classify -> snap, or stuff where snapping loses too much of a thin solid
 *
 * Where a count of tets or vertices was asked for, all of it is done again with a corrected size. */
#include <string.h>

#include "assemble/assemble.h"
#include "classify/classify.h"
#include "run.h"
#include "stuff/zone.h"

static laves_result make_graded_background(laves__run *r) {
  laves__demand demand;
  laves__graph_free(&r->graph);
  laves__octree_free(&r->tree);
  if (!laves__wishes_demand(&r->wishes, &r->frame, &demand)) return laves__fail_memory(r->context, r->error);
  laves_result result = laves__graded_background(&r->frame, &demand, r->context, &r->tree, &r->graph, r->error);
  if (result == LAVES_OK) result = laves__size_status(r->sizes, r->error);
  if (result == LAVES_OK) result = laves__lattice_of_graph(r->context, &r->graph, &r->lattice, r->error);
  return result;
}

static laves_result make_background(laves__run *r) {
  laves__stage_begin(r);
  laves__layer_free(&r->layer);
  laves__lattice_free(&r->lattice);
  const laves_result result = r->sizes ? make_graded_background(r)
                                       : laves__lattice_create(r->context, laves__frame_bounds(&r->frame), &r->lattice, r->error);
  laves__stage_end(r, "background");
  return result;
}

static laves_result classify(laves__run *r) {
  laves__stage_begin(r);
  const laves_result result = laves__classify(&r->frame, &r->lattice, r->error);
  laves__stage_end(r, "classify");
  return result;
}

static laves_result snap(laves__run *r) {
  laves__stage_begin(r);
  laves__layer_free(&r->layer);
  memset(&r->counts, 0, sizeof r->counts);
  memset(&r->stuffed, 0, sizeof r->stuffed);
  const laves_result result = laves__snap(&r->frame, r->options->keep_thin, &r->lattice, &r->layer, &r->counts, r->error);
  laves__stage_end(r, "snap");
  return result;
}

laves_result laves__stuff_zone(laves__run *r) {
  laves__stage_begin(r);
  laves__layer_free(&r->layer);
  const laves_result result = laves__stuff(&r->frame, r->guarantee, &r->lattice, &r->layer, &r->stuffed, r->error);
  if (r->stuffed.left == 0) { /* they tell of a boundary that is gone, but for the places, which are as thin as before */
    r->counts.pinches = 0;
    r->counts.off_surface = 0;
  }
  r->counts.snapped = r->stuffed.left;
  r->counts.specks = r->stuffed.specks;
  laves__stage_end(r, "stuff");
  return result;
}

/* The whole boundary by stuffing. */
laves_result laves__stuff_everything(laves__run *r) {
  laves__zone_everything(&r->lattice);
  return laves__stuff_zone(r);
}

/* Shares of the solid's volume: below the first, snapping is not the way; beyond the others, no mesh is of use. (A site that
 * alone stands for a small part makes a piece as large as an edge.) */
static const double least_snapped = 0.5, least_filled = 0.25, most_filled = 2;

/* Volume of the mesh as it is now, over that of the solid. */
double laves__filled_share(const laves__run *r) {
  const double size = r->frame.size;
  return laves__assemble_volume(&r->lattice, &r->layer) * size * size * size / r->report->volume;
}

/* Whether stuffing may take the place of snapping. */
bool laves__may_mend(const laves__run *r) { return r->guarantee && r->options->method == LAVES_METHOD_AUTO; }

/* Where snapping leaves more than this share, and this many, of the tets outside a window of 25 to 140 degrees, the solid is
 * rougher than the size, and improvement would be long and in vain (models: at most 0.7 %, or a few; noise: 1.4 % and more). */
static const laves__window rough_window = {.min_dihedral = 25, .max_dihedral = 140};
static const double rough_share = 0.012;
static const size_t rough_count = 250;

/* Whether so much is bad after snapping that all is better made by stuffing at once. */
static bool is_rough(const laves__run *r) {
  const size_t bad = laves__improve_outside(&rough_window, &r->layer);
  return bad > rough_count && (double)bad > rough_share * (double)r->layer.tet_count;
}

/* The boundary in the way that was asked for. Snapping needs walls of a size or so; where it loses too much of a thinner solid,
 * stuffing, which keeps every inner site, takes its place. */
static laves_result conform(laves__run *r) {
  if (r->options->method == LAVES_METHOD_STUFF) return laves__stuff_everything(r);
  const laves_result result = snap(r);
  if (result != LAVES_OK || !laves__may_mend(r)) return result;
  r->rough = is_rough(r);
  if (laves__is_cancelled(r->context)) return laves__fail_cancelled(r->error);
  return laves__filled_share(r) < least_snapped ? laves__stuff_everything(r) : result;
}

laves_result laves__nothing_resolved(const laves__run *r) {
  char gaps[160];
  const bool has_gaps = laves__tell_gaps(r, gaps, sizeof gaps);
  return laves__fail(
      r->error, LAVES_ERROR_INPUT,
      "nothing of the solid is resolved at size %g (the box around it has a diagonal of %g); choose a smaller size%s%s",
      r->frame.size, box3_diagonal(r->domain->oracle.bounds), has_gaps ? "; " : "", gaps);
}

static laves_result hardly_resolved(const laves__run *r, double share) {
  return laves__fail(r->error, LAVES_ERROR_INPUT,
                     "a mesh of size %g would have %.2g times the volume of the solid, which is so thin or small; choose a "
                     "smaller size",
                     r->frame.size, share);
}

/* The next size to try for a count. Where sizes vary, counts jump as leaves are halved, all those of a sphere at once: later
 * steps are shorter, so that sizes near by are tried, and the last goes back to the best so far. */
typedef struct count_search {
  int step, steps;
  double best_size, best_factor;
} count_search;

static void correct_size(laves__run *r, count_search *s, double factor) {
  enum { WHOLE_STEPS = 4 };
  if (s->step == 0 || fabs(log(factor)) < fabs(log(s->best_factor))) {
    s->best_factor = factor;
    s->best_size = r->frame.size;
  }
  if (r->sizes && s->step >= WHOLE_STEPS) factor = sqrt(factor);
  r->frame.size = r->sizes && s->step == s->steps - 1 ? s->best_size : r->frame.size * factor;
  s->step++;
}

/* Background to boundary; repeated with a corrected size when a count was asked for and missed. */
laves_result laves__make_boundary(laves__run *r) {
  count_search search = {.steps = r->sizes ? 10 : 4};
  for (;;) {
    laves_result result = make_background(r);
    if (result == LAVES_OK) result = classify(r);
    if (result == LAVES_OK) result = conform(r);
    if (result != LAVES_OK) return result;
    int64_t vertices, tets;
    laves__assemble_estimate(&r->lattice, &r->layer, &vertices, &tets);
    r->counted = r->options->tet_target ? (double)tets : (double)vertices;
    const double factor =
        laves__options_correction(r->options, (int64_t)((double)tets * r->kept), (int64_t)((double)vertices * r->kept));
    if (tets == 0) return laves__nothing_resolved(r);
    if (factor == 1 || search.step == search.steps || r->settled) break;
    correct_size(r, &search, factor);
  }
  const double share = laves__filled_share(r);
  return share < least_filled || share > most_filled ? hardly_resolved(r, share) : LAVES_OK;
}
