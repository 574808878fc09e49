/* The schedule of improvement.
 *
 * After a quick Laplace start, passes over the tets below the target. Space is cut in blocks, coloured by the parity of
 * their coordinates; the bad tets of one block are worked on in turn, worst first, and all blocks of a colour at the same
 * time. What an operation reads and changes lies within about six sizes of its tet, and blocks of one colour are fifteen
 * apart, so they can't meet: the result is the same for any number of threads. Where sizes vary, so do blocks: tets whose
 * size is at most a power of two are worked on in blocks of that many times the side, the largest first. (From one leaf of
 * the octree to the next the size at most doubles, and blocks are fifteen to thirty times what lies in them.)
 *
 * First passes only smooth; when that no longer helps, contraction joins in; the few that are still clearly outside are
 * treated once more with more smoothing around each contraction. On a graded background flips join in from the first. A flip,
 * contraction or split is kept when the worst of what it touches rises. Where creases crowd, or are noise, all that it touches
 * must also lack less of what is asked, taken together: one that is bad would else be cured at the cost of many, again and again.
 * (Not for what is far outside in the end; where little is left well outside then, all around it is made better than is asked.
 * Nor for what is worst once features were let go of: the promise is near, and where it is broken all around is made anew. And
 * not where the boundary is given, for which there is a schedule that goes from the worst to the others.)
 *
 * Where the layer has a mask of what is fresh, only tets with such a vertex are worked on; what is known of the others is that
 * nothing helped. */

#include "improve/blocks.h"
#include "improve/contract.h"
#include "improve/flip.h"
#include "improve/patients.h"
#include "improve/peel.h"
#include "improve/relax.h"
#include "improve/smooth.h"
#include "improve/split.h"

enum {
  SWEEPS = 2,
  SMOOTH_PASSES = 5,
  FLIP_PASSES = 10,
  CONTRACT_PASSES = 12,
  CROWD_PASSES = 2,
  THOROUGH_ROUNDS = 3,
  TRIES_MAX = 4
};
/* Where more than this share of the layer is bad after smoothing, walls are a tet thick and the window can't be met there:
 * few passes of contraction, and no more patience. */
static const double crowd = 0.03;
static const size_t crowd_min = 2000; /* tets; fewer never are a crowd */
/* Creases crowd where more than this share, and this many, are bad. Then contraction while vertices are brought to creases is for
 * what is far outside, and steps are weighed. */
static const double crease_crowd = 0.01;
static const double first_crowd = 0.1; /* the same before anything is improved */
static const size_t crease_crowd_min = 250;
static const size_t freed_crowd_min = 500; /* tets; the same once some features were let go of, which leaves few */
/* Where even more than this share is bad after one pass, the solid is noise at this size: smoothing goes on for one more pass
 * only, and only tets far outside get a contraction. */
static const double rough_share = 0.2;
static const double rough_admit = 0.4; /* quality: about 26 degrees */
/* Where that is known beforehand, smoothing leaves those alone, too, that are better than this. */
static const double brief_admit = 0.6;      /* about 32 degrees */
static const double worthwhile = 0.02;      /* see the member of `work` */
static const double worthwhile_again = 0.1; /* the same for what is left once features were let go of, where that is a crowd */
static const double thorough_below = 0.985; /* quality below which the few that remain get more patience */
static const double dire = 0.37;            /* quality: about 25 to 146 degrees */
static const double far_outside = 0.75;     /* quality: about 36 to 131 degrees for the standard window */
static const double well_outside = 0.8;     /* quality: about 37 to 129 degrees */
static const double room_target = 1.2;      /* quality that smoothing aims at where room was made */
static const size_t few = 200;              /* bad ones; so many get all the patience there is */
static const double graded_crowd = 0.1;     /* what `crowd` is on a graded background, after flips */
static const double given_crowd = 0.05;     /* what `crowd` is in the mesh of another program */
static const size_t given_crowd_min = 500;  /* tets */
static const double peel_below = 0.5;       /* quality below which a tet between two surfaces is taken away, if it can be */
static const double settle_floor = 0.2;     /* quality that bringing a vertex back to the surface may cost: about 18 degrees */

laves__measure laves__measure_of(const laves__window *w) {
  static const double radians = 3.14159265358979323846 / 180;
  return (laves__measure){.low_scale = 1 / (1 - cos(w->min_dihedral * radians)),
                          .high_scale = 1 / (1 + cos(w->max_dihedral * radians)),
                          .length_scale = w->volume_length > 0 ? 1 / w->volume_length : 1e30,
                          .weighs_from = HUGE_VAL,
                          .held_low = w->held_min > 0 ? 1 - cos(w->held_min * radians) : -1,
                          .held_high = w->held_min > 0 ? 1 + cos(w->held_max * radians) : -1};
}

/* Where sizes vary, and where features are kept, the connectivity is not what it is in C15, and flips pay; they need some dead
 * tets. */
static const size_t spare_share = 8, spare_min = 1024;
/* Where features are kept, splits need some dead vertices. */
static const size_t spare_vertex_share = 64, spare_vertex_min = 256;

typedef struct work {
  const laves__frame *frame;
  laves__blocks blocks; /* where the boundary is given */
  laves__measure measure;
  double target;
  laves__layer *layer;
  int32_t *fresh; /* [fresh_count] tets that are fresh at first, and dead ones, ascending; NULL: all */
  size_t fresh_count;
  size_t population;       /* tets, of which those that are bad are a share: all, or the fresh ones that live */
  laves__journal *journal; /* one for each worker */
  laves__patients patients;
  double progress; /* share of the first bad tets that are cured, for the caller's eyes */
  size_t first_count;
  int32_t *spare; /* [spare_count] dead tets that flips may use, shared out among the blocks; NULL: no flips */
  size_t spare_count;
  int32_t *spare_vertex; /* [spare_vertex_count] dead vertices that splits may use, shared out likewise; NULL: no splits */
  size_t spare_vertex_count, first_spare_vertex;
  uint8_t *tries;             /* [tet_count] full treatments so far, at most TRIES_MAX */
  double *stuck;              /* [tet_count] surroundings in which smoothing ended */
  double *given_up;           /* [tet_count] surroundings in which the last full treatment failed */
  laves__admission admission; /* which tets are worked on */
  size_t passes_left;         /* that are allowed */
  double deadline;            /* wall seconds; 0: none */
  double worthwhile;          /* share of them that a pass must cure to be followed by its like */
  int rounds;                 /* of smoothing around a contraction; 0: smoothing only */
} work;

/* What is not fresh keeps the quality that it was left with. */
static void measure_all(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const work *w = user;
  if (!w->fresh) laves__measure_tets(&w->measure, w->layer, begin, end, w->layer->quality + begin);
  for (size_t i = begin; w->fresh && i < end; i++)
    if (w->layer->tet[w->fresh[i]][0] >= 0)
      w->layer->quality[w->fresh[i]] = laves__layer_quality(&w->measure, w->layer, w->fresh[i]);
}

static bool is_bad(const work *w, int32_t t) { return laves__is_bad(w->layer, &w->admission, t); }

/* The tets that may be worked on: how many, and number i. */
static size_t count_tets(const work *w) { return w->fresh ? w->fresh_count : w->layer->tet_count; }
static int32_t tet_at(const work *w, size_t i) { return w->fresh ? w->fresh[i] : (int32_t)i; }

static size_t count_bad(const work *w) { return laves__count_bad(w->layer, &w->admission); }

/* Bad tets that span a wall. */
static double count_thin(const void *user, size_t begin, size_t end) {
  const work *w = user;
  double count = 0;
  for (size_t i = begin; i < end; i++) count += is_bad(w, tet_at(w, i)) && laves__spans_wall(w->layer, tet_at(w, i));
  return count;
}

/* Whether walls a tet thick are more than a place or two: contraction is dear, and there it seldom reaches the asked window. */
static bool has_thin_walls(const work *w) {
  return laves__parallel_sum(w->layer->context, NULL, count_tets(w), count_thin, w) > (double)few;
}

/* A number that changes when any tet around a tet does. */
static double surroundings(const laves__layer *layer, int32_t t) {
  double sum = 0;
  for (int k = 0; k < 4; k++) {
    const laves__star *star = &layer->star[layer->tet[t][k]];
    for (int i = 0; i < star->count; i++) sum += layer->quality[star->tet[i]];
  }
  return sum;
}

/* Smooths the corners of a tet, either those on the surface or the inner ones, until it is good. */
static void smooth_corners(const work *w, int32_t t, bool on_surface) {
  for (int k = 0; k < 4 && is_bad(w, t); k++) {
    const int32_t v = w->layer->tet[t][k];
    if (laves__layer_moves(w->layer, v) && (w->layer->depth[v] == 0) == on_surface)
      laves__smooth_vertex(w->frame, &w->measure, w->target, w->layer, v, NULL);
  }
}

/* Other tets between the same vertices, and their corners smoothed; what is known of the tets touched is forgotten. */
static void flip(work *w, int32_t t, laves__slots *slots, laves__journal *journal) {
  if (!laves__flip_tet(w->frame, &w->measure, w->layer, t, slots, journal)) return;
  for (size_t i = 0; i < journal->tet_count; i++) {
    const int32_t touched = journal->tet[i].tet;
    w->given_up[touched] = w->stuck[touched] = HUGE_VAL;
    w->tries[touched] = 0;
    if (!is_bad(w, touched)) continue;
    smooth_corners(w, touched, false);
    smooth_corners(w, touched, true);
  }
  laves__journal_clear(journal);
}

/* Inner corners first: they are free to move and need no projection; most tets need no more.
 * A tet that withstood a treatment does not get it again until something around it changes. */
static void mend(work *w, int32_t t, laves__slots *slots, laves__spare *vertices, laves__journal *journal) {
  const double before = surroundings(w->layer, t);
  if (before == w->given_up[t]) return;
  if (before != w->stuck[t]) {
    if (w->layer->patch) flip(w, t, slots, journal); /* elsewhere the connectivity is good, and what a tet needs is a move */
    if (w->layer->tet[t][0] < 0 || !is_bad(w, t)) return;
    smooth_corners(w, t, false);
    smooth_corners(w, t, true);
    w->stuck[t] = surroundings(w->layer, t);
    if (w->spare && is_bad(w, t)) flip(w, t, slots, journal);
    if (w->layer->tet[t][0] < 0) return;
  }
  if (w->rounds == 0 || !is_bad(w, t) || w->tries[t] == TRIES_MAX) return;
  w->tries[t]++;
  if (laves__contract_tet(w->frame, &w->measure, w->target, w->layer, t, w->rounds, journal)) return;
  if (w->rounds > 1 && vertices->count > 0 &&
      laves__split_tet(w->frame, &w->measure, w->target, w->layer, t, slots, vertices, journal))
    return;
  w->given_up[t] = surroundings(w->layer, t);
}

/* Dead tets are shared out by the bad tets of each block. */
static laves__slots slots_of(const work *w, size_t block) {
  const laves__patients *p = &w->patients;
  const size_t first = w->spare_count * p->block[block] / p->count, end = w->spare_count * p->block[block + 1] / p->count;
  return (laves__slots){.tet = w->spare ? w->spare + first : NULL, .count = (int32_t)(end - first)};
}

static laves__spare vertices_of(const work *w, size_t block) {
  const laves__patients *p = &w->patients;
  const size_t all = w->spare_vertex_count;
  const size_t first = all * p->block[block] / p->count, end = all * p->block[block + 1] / p->count;
  return (laves__spare){.vertex = w->spare_vertex ? w->spare_vertex + first : NULL, .count = (int32_t)(end - first)};
}

/* Lists the dead tets and vertices anew. */
static void collect_spare(work *w) {
  w->spare_count = 0;
  for (size_t i = 0; w->spare && i < count_tets(w); i++)
    if (w->layer->tet[tet_at(w, i)][0] < 0) w->spare[w->spare_count++] = tet_at(w, i);
  w->spare_vertex_count = 0;
  for (size_t v = w->first_spare_vertex; w->spare_vertex && v < w->layer->vertex_count; v++)
    if (w->layer->star[v].count == 0 && laves__layer_moves(w->layer, (int32_t)v))
      w->spare_vertex[w->spare_vertex_count++] = (int32_t)v;
}

static bool is_late(const work *w) { return w->deadline > 0 && laves__wall_seconds() > w->deadline; }

typedef struct colour_range {
  work *w;
  size_t first_block;
} colour_range;

/* Shared: the layer. Blocks of one colour read and write parts of it that are too far apart to meet. */
static void mend_blocks(void *user, size_t begin, size_t end, int worker) {
  const colour_range *range = user;
  work *w = range->w;
  for (size_t b = range->first_block + begin; b < range->first_block + end; b++) {
    laves__slots slots = slots_of(w, b);
    laves__spare vertices = vertices_of(w, b);
    for (size_t i = w->patients.block[b]; i < w->patients.block[b + 1]; i++) {
      if (laves__is_cancelled(w->layer->context)) return;
      if (worker == 0 && laves__cancelled(w->layer->context, "improve", w->progress)) return;
      if (is_late(w)) return;
      const int32_t t = w->patients.item[i].tet;
      if (is_bad(w, t)) mend(w, t, &slots, &vertices, &w->journal[worker]);
    }
  }
}

/* One pass over the bad tets; how many there were goes to *before. */
static laves_result run_pass(work *w, size_t *before, laves_error *error) {
  const laves__patients *p = &w->patients;
  const laves__blocks *given = w->layer->patch ? &w->blocks : NULL;
  if (given) {
    const laves_result result = laves__blocks_shift(&w->blocks, w->layer, error);
    if (result != LAVES_OK) return result;
  }
  if (!laves__patients_list(w->layer, &w->admission, given, &w->patients)) return laves__fail_memory(w->layer->context, error);
  if (laves__is_cancelled(w->layer->context)) return laves__fail_cancelled(error);
  collect_spare(w);
  *before = p->bad;
  if (w->first_count == 0) w->first_count = p->count;
  if (p->count) w->progress = fmax(w->progress, 1 - (double)p->count / (double)w->first_count);
  for (size_t first = 0; first < p->block_count;) {
    size_t end = first + 1;
    while (end < p->block_count && laves__same_colour(&p->item[p->block[end]], &p->item[p->block[first]])) end++;
    colour_range range = {w, first};
    if (!laves__parallel_for(w->layer->context, NULL, end - first, 0, mend_blocks, &range)) return laves__fail_cancelled(error);
    first = end;
  }
  return LAVES_OK;
}

/* Passes of one kind until `patience` of them in a row found too little cured. (A contraction may leave more bad tets than
 * it found, all of them better than the worst was; the next pass smooths them. Where features crowd it does not: there a pass
 * that leaves more than there were is the last.) */
static laves_result run_passes(work *w, int passes, int patience, laves_error *error) {
  const int turns = w->layer->patch ? laves__blocks_turns(&w->blocks) : 1;
  size_t best = SIZE_MAX;
  const int most = turns > 1 ? (passes + 1) / 2 : passes; /* in four turns most vertices move three times */
  for (int pass = 0, idle = 0; pass < most && idle < patience; pass++) {
    size_t before = 0;
    if (w->passes_left == 0 || is_late(w)) return LAVES_OK;
    if (pass > 0 && w->measure.weighs_from < 0 && count_bad(w) > best) return LAVES_OK;
    w->passes_left--;
    for (int turn = 0; turn < turns; turn++) {
      size_t left = 0;
      const laves_result result = run_pass(w, &left, error);
      if (turn == 0) before = left;
      if (result != LAVES_OK || left == 0) return result;
    }
    idle = (double)before > (1 - w->worthwhile) * (double)best ? idle + 1 : 0;
    if (before < best) best = before;
  }
  return LAVES_OK;
}

/* Whether a boundary vertex that may be worked on is not where it belongs. */
static bool is_off(const laves__layer *layer, size_t v) {
  return layer->off_surface[v] && layer->star[v].count > 0 && (!layer->fresh || layer->fresh[v]);
}

static void settle_all(work *w, double floor) {
  for (size_t v = 0; v < w->layer->vertex_count; v++)
    if (is_off(w->layer, v)) laves__settle_vertex(w->frame, &w->measure, floor, w->layer, (int32_t)v);
}

/* How many boundary vertices are not where they belong. */
static size_t count_off(const work *w) {
  size_t count = 0;
  for (size_t v = 0; v < w->layer->vertex_count; v++) count += is_off(w->layer, v);
  return count;
}

static bool is_flat(const work *w, int32_t t) { return w->layer->tet[t][0] >= 0 && w->layer->quality[t] < peel_below; }

static double count_flat(const void *user, size_t begin, size_t end) {
  const work *w = user;
  double count = 0;
  for (size_t i = begin; i < end; i++) count += is_flat(w, tet_at(w, i));
  return count;
}

/* Takes away the flat tets of thin walls, until none of them can be. */
static void peel_all(work *w) {
  for (bool again = laves__parallel_sum(w->layer->context, NULL, count_tets(w), count_flat, w) > 0; again;) {
    again = false;
    for (size_t i = 0; i < count_tets(w); i++)
      if (is_flat(w, tet_at(w, i)) && laves__peel_tet(w->frame, w->layer, tet_at(w, i))) again = true;
  }
}

/* Whether the bad tets are more than `least`, and more than a share of the layer. */
static bool is_crowded(const work *w, double share, size_t least) {
  const size_t bad = count_bad(w);
  return bad > least && (double)bad > share * (double)w->population;
}

/* Whether so much is bad, since walls are thin or creases crowd, that the window is out of reach. */
static bool is_rough(const work *w) { return is_crowded(w, rough_share, crowd_min); }

static bool creases_crowd(const work *w) { return is_crowded(w, crease_crowd, crease_crowd_min); }

/* Whether more creases were dropped as noise than there are: those that are left are hardly better. */
static bool is_noisy(const work *w) {
  const laves__features *f = w->frame->features;
  return f && f->dropped_count > f->crease_count;
}

/* Whether all that a step touches is weighed is decided anew where vertices come home, and before each kind of work: where many
 * are bad of those that are worked on. On noise it always is. */
static void weigh_crowds(work *w, double share) {
  if (w->layer->hold) w->measure.weighs_from = is_noisy(w) || is_crowded(w, share, crease_crowd_min) ? -HUGE_VAL : HUGE_VAL;
}

/* Patience is new for all that remains. */
static void forget(work *w) {
  for (size_t t = 0; t < w->layer->tet_count; t++) {
    w->given_up[t] = HUGE_VAL;
    w->tries[t] = 0;
  }
}

/* Marks what shares a vertex with a tet below a quality. */
static void mark_near(const work *w, double below, uint8_t *near) {
  for (size_t t = 0; t < w->layer->tet_count; t++) {
    const int32_t *v = w->layer->tet[t];
    if (v[0] < 0 || w->layer->quality[t] >= below) continue;
    for (int k = 0; k < 4; k++)
      for (int i = 0; i < w->layer->star[v[k]].count; i++) near[w->layer->star[v[k]].tet[i]] = 1;
  }
}

/* What is around the worst is made better than is asked, which leaves them more to move in. */
static laves_result make_room(work *w, double below, laves_error *error) {
  enum { ROOM_PASSES = 2 };
  static const double ample = 1.5; /* quality */
  laves_context *context = w->layer->context;
  uint8_t *near = laves__alloc_zeroed(context, w->layer->tet_count, 1);
  if (!near) return laves__fail_memory(context, error);
  mark_near(w, below, near);
  w->admission.near = near;
  w->admission.below = w->target = ample;
  w->rounds = 1;
  forget(w);
  const laves_result result = run_passes(w, ROOM_PASSES, ROOM_PASSES, error);
  laves__free(context, near, w->layer->tet_count, 1);
  w->admission.near = NULL;
  return result;
}

/* What is below a quality, as if nothing had been tried: it was, but weighed, or without room. */
static laves_result start_over(work *w, double below, double target, laves_error *error) {
  enum { WORST_PASSES = 4 };
  w->admission.below = below;
  w->target = target;
  w->rounds = THOROUGH_ROUNDS;
  forget(w);
  for (size_t t = 0; t < w->layer->tet_count; t++) w->stuck[t] = HUGE_VAL;
  return run_passes(w, WORST_PASSES, 1, error);
}

/* Where few are left outside by more than a little, room is made for them. */
static laves_result mend_last(work *w, laves_error *error) {
  w->admission.below = well_outside;
  const size_t count = count_bad(w);
  if (count == 0 || count > few) return LAVES_OK;
  laves_result result = make_room(w, well_outside, error);
  if (result == LAVES_OK) result = start_over(w, well_outside, room_target, error);
  w->target = 1;
  return result;
}

/* What is still far outside is cured at any cost: the worst angle counts for more than how many are outside by little. */
static laves_result mend_worst(work *w, laves_error *error) {
  w->measure.weighs_from = HUGE_VAL;
  const laves_result result = start_over(w, far_outside, 1, error);
  return result == LAVES_OK ? mend_last(w, error) : result;
}

/* The lattice's connectivity is good: smoothing does nearly all, contraction the rest. */
static laves_result mend_tiling(work *w, bool brief, laves_error *error) {
  brief = brief || (w->layer->hold && is_rough(w)); /* its vertices were smoothed while they were brought home */
  if (brief) w->admission.below = brief_admit;
  laves_result result = run_passes(w, 1, 1, error);
  const bool rough = brief || is_rough(w);
  if (result == LAVES_OK) result = run_passes(w, rough ? 1 : SMOOTH_PASSES - 1, 1, error);
  if (result == LAVES_OK) settle_all(w, settle_floor);
  const bool crowded = is_crowded(w, crowd, crowd_min);
  w->admission.thin = has_thin_walls(w);
  w->rounds = 1;
  if (rough) w->admission.below = rough_admit;
  if (result == LAVES_OK) result = run_passes(w, rough ? 1 : crowded ? CROWD_PASSES : CONTRACT_PASSES, 2, error);
  if (result == LAVES_OK) peel_all(w);
  w->rounds = THOROUGH_ROUNDS;
  w->admission.below = thorough_below;
  forget(w);
  weigh_crowds(w, crease_crowd);
  const int patience = is_crowded(w, 0, crowd_min) ? 1 : 2;
  if (result == LAVES_OK && !crowded && !rough) result = run_passes(w, CONTRACT_PASSES, patience, error);
  if (result == LAVES_OK && w->layer->hold && !rough && !is_noisy(w)) result = mend_worst(w, error);
  if (result == LAVES_OK) peel_all(w);
  return result;
}

/* Where sizes vary many tets are bad at first; smoothing and flips make most of them good. Contraction, which is dear, is for
 * those that are far outside, and for the others when they are few; where even the first are many, the solid is noise. */
static laves_result mend_graded(work *w, laves_error *error) {
  laves_result result = run_passes(w, FLIP_PASSES, 2, error);
  if (result == LAVES_OK) settle_all(w, settle_floor);
  const bool crowded = is_crowded(w, graded_crowd, crowd_min);
  w->rounds = 1;
  w->admission.below = far_outside;
  const bool rough = is_crowded(w, graded_crowd, crowd_min);
  w->admission.thin = has_thin_walls(w);
  if (result == LAVES_OK) result = run_passes(w, rough ? 1 : CONTRACT_PASSES, 2, error);
  if (result == LAVES_OK) peel_all(w);
  w->admission.below = 1;
  if (result == LAVES_OK && !crowded) result = run_passes(w, CROWD_PASSES, 2, error);
  w->rounds = THOROUGH_ROUNDS;
  weigh_crowds(w, crease_crowd);
  w->admission.below = crowded ? far_outside : thorough_below;
  forget(w);
  if (result == LAVES_OK && !rough) result = run_passes(w, CONTRACT_PASSES, 2, error);
  if (result == LAVES_OK) peel_all(w);
  return result;
}

/* The mesh of another program: a quarter of it may be bad, by its connectivity. Flips and smoothing cure most of that at little
 * cost; contraction and splits are for the worst first, and while these get better smoothing aims beyond what is asked, so that
 * there is room for the next. Where few are left in the end, all of them are treated so. Measured on meshes of TetGen and Gmsh:
 * the worst angles come out better, and in a fifth of the time, than when all that is bad is treated alike. */
static laves_result mend_given(work *w, laves_error *error) {
  static const struct {
    int rounds, passes;
    double admit, target;
    bool room; /* is made first */
  } steps[] = {{0, 2, 1, 1, false},     {3, 4, 0.6, 1, false},   {3, 3, 0.7, 1.2, false},
               {3, 4, 0.8, 1.2, false}, {3, 3, 0.8, 1.6, false}, {3, 3, 0.74, 1.2, true}};
  laves_result result = LAVES_OK;
  for (size_t i = 0; i < LAVES__COUNT_OF(steps) && result == LAVES_OK; i++) {
    if (steps[i].room) result = laves__blocks_end(&w->blocks, w->layer, error);
    if (result == LAVES_OK && steps[i].room) result = make_room(w, steps[i].admit, error);
    if (result != LAVES_OK) break;
    w->rounds = steps[i].rounds;
    w->admission.below = steps[i].admit;
    w->target = steps[i].target;
    forget(w);
    result = run_passes(w, steps[i].passes, 1, error);
  }
  w->admission.below = w->target = 1;
  if (result != LAVES_OK || is_crowded(w, given_crowd, given_crowd_min)) return result;
  forget(w);
  return run_passes(w, CONTRACT_PASSES, 1, error);
}

/* The same where the boundary is given: looked for in each tet once, so that where there are none nobody asks again. */
static void leave_out_given(work *w) {
  const double cosine = cos(w->measure.sharper_than * (3.14159265358979323846 / 180));
  for (size_t t = 0; t < w->layer->tet_count; t++)
    if (w->layer->tet[t][0] >= 0 && laves__given_fixed_edges(cosine, w->layer, (int32_t)t)) {
      w->measure.sharp_cosine = cosine;
      return;
    }
}

/* Creases sharper than the window, and a little more, fix the angle of a tet that fills them alone. */
static void leave_out_sharp(work *w, const laves__window *window) {
  static const double margin = 2; /* degrees */
  const laves__features *f = w->layer->hold && !w->layer->patch ? w->frame->features : NULL;
  w->measure.sharper_than = window->min_dihedral + margin;
  if (w->layer->patch) leave_out_given(w);
  for (size_t i = 0; f && i < f->crease_count; i++)
    if (f->crease[i].least_angle < w->measure.sharper_than) w->measure.sharp = f;
}

/* Creases and corners come first: their vertices go where they belong, as far as tets allow, and smoothing and contraction make
 * room for the rest of the way. Where creases crowd, contraction is for tets far outside only: the others can't all be cured
 * before everything is in its place, and what is tried spoils their neighbours. Where nearly all is bad even less is tried. */
static laves_result bring_home(work *w, laves_error *error) {
  enum { ROUNDS = 6, SMOOTH_ROUNDS = 2 };
  static const double home_floor = 0.05; /* quality that coming home may cost: about 9 degrees */
  weigh_crowds(w, first_crowd);
  laves_result result = run_passes(w, 1, 1, error);
  for (int round = 0; result == LAVES_OK && round < ROUNDS && count_off(w) > 0; round++) {
    settle_all(w, home_floor);
    w->admission.below = 1;
    w->rounds = round >= SMOOTH_ROUNDS;
    if (is_rough(w))
      w->admission.below = w->rounds > 0 ? rough_admit : brief_admit;
    else if (w->rounds > 0 && creases_crowd(w))
      w->admission.below = far_outside;
    weigh_crowds(w, crease_crowd);
    result = run_passes(w, 1, 1, error);
  }
  w->admission.below = 1;
  w->rounds = 0;
  weigh_crowds(w, crease_crowd);
  return result;
}

/* After features were let go of: only what is far outside (where nearly all is bad, very far), and what was freed, which is off
 * the surface. Where that was noise, nothing else kept the others from the window: then all that is bad. */
static laves_result mend_released(work *w, bool noise, laves_error *error) {
  settle_all(w, settle_floor);
  w->admission.below = is_rough(w) && !noise ? rough_admit : far_outside;
  laves_result result = run_passes(w, SMOOTH_PASSES, 1, error);
  w->rounds = THOROUGH_ROUNDS;
  if (is_crowded(w, 0, freed_crowd_min)) w->worthwhile = worthwhile_again;
  if (result == LAVES_OK) result = run_passes(w, CONTRACT_PASSES, 1, error);
  if (result == LAVES_OK) peel_all(w);
  if (!noise) return result;
  w->admission.below = 1;
  w->rounds = 1;
  forget(w);
  if (result == LAVES_OK) result = run_passes(w, CONTRACT_PASSES, 1, error);
  if (result == LAVES_OK) peel_all(w);
  return result;
}

/* The schedule for what the layer is. */
static laves_result mend_all(work *w, const laves__window *window, laves_error *error) {
  if (w->layer->patch) return mend_given(w, error);
  if (window->when == LAVES__IMPROVE_RELEASED) return mend_released(w, window->noise, error);
  if (window->when == LAVES__IMPROVE_LAST) return mend_last(w, error);
  const laves_result result = w->layer->hold ? bring_home(w, error) : LAVES_OK;
  if (result != LAVES_OK) return result;
  return w->layer->scale ? mend_graded(w, error) : mend_tiling(w, window->brief, error);
}

/* An operation without room for its journal was left out, and the mesh would be another one than with more memory. */
static bool short_of_memory(const work *w, int workers) {
  for (int i = 0; i < workers; i++)
    if (w->journal[i].short_of_memory) return true;
  return false;
}

/* Tets that live and are fresh; where all are, dead ones count, too. */
static size_t count_population(const laves__layer *layer) {
  size_t count = 0;
  if (!layer->fresh) return layer->tet_count;
  for (size_t t = 0; t < layer->tet_count; t++) count += layer->tet[t][0] >= 0 && laves__layer_is_fresh(layer, (int32_t)t);
  return count;
}

static size_t count_dead(const laves__layer *layer) {
  size_t count = 0;
  for (size_t t = 0; t < layer->tet_count; t++) count += layer->tet[t][0] < 0;
  return count;
}

/* Room for flips: as many dead tets as they may want, those of earlier work among them; false when memory is short. */
static bool make_spare(laves__layer *layer, size_t population) {
  const size_t wanted = population / spare_share + spare_min, dead = count_dead(layer);
  return dead >= wanted || laves__layer_extend(layer, wanted - dead);
}

static size_t count_fresh_vertices(const laves__layer *layer) {
  size_t count = 0;
  for (size_t v = 0; v < layer->vertex_count; v++) count += !layer->fresh || layer->fresh[v];
  return count;
}

static bool may_be_worked_on(const laves__layer *layer, size_t t) {
  return layer->tet[t][0] < 0 || laves__layer_is_fresh(layer, (int32_t)t);
}

/* Lists what is fresh; false when memory is short. */
static bool list_fresh(work *w) {
  const laves__layer *layer = w->layer;
  if (!layer->fresh) return true;
  for (size_t t = 0; t < layer->tet_count; t++) w->fresh_count += may_be_worked_on(layer, t);
  w->fresh = laves__alloc(layer->context, w->fresh_count, sizeof *w->fresh);
  if (!w->fresh) return false;
  for (size_t t = 0, next = 0; t < layer->tet_count; t++)
    if (may_be_worked_on(layer, t)) w->fresh[next++] = (int32_t)t;
  return true;
}

laves_result laves__improve(const laves__frame *frame, const laves__window *window, laves__layer *layer, laves_error *error) {
  laves_context *context = layer->context;
  work w = {.frame = frame,
            .measure = laves__measure_of(window),
            .target = 1,
            .admission.below = 1,
            .worthwhile = worthwhile,
            .passes_left = window->passes > 0 ? window->passes : SIZE_MAX,
            .deadline = window->deadline,
            .layer = layer};
  w.population = count_population(layer);
  leave_out_sharp(&w, window);
  if (layer->hold && !layer->patch && window->when == LAVES__IMPROVE_RELEASED) w.measure.weighs_from = dire;
  const int workers = laves__workers(context);
  laves_result result = LAVES_OK;
  const bool flips = layer->scale || layer->hold;
  if (flips && !make_spare(layer, w.population)) return laves__fail_memory(context, error);
  if (!layer->fresh) w.population = layer->tet_count; /* the spare ones, too */
  const size_t extra = layer->hold ? count_fresh_vertices(layer) / spare_vertex_share + spare_vertex_min : 0;
  w.first_spare_vertex = layer->vertex_count;
  if (extra && !laves__layer_extend_vertices(layer, extra)) return laves__fail_memory(context, error);
  if (extra) w.spare_vertex = laves__alloc(context, extra, sizeof *w.spare_vertex);
  if (flips) w.spare = laves__alloc(context, layer->tet_count, sizeof *w.spare);
  w.journal = laves__alloc_zeroed(context, (size_t)workers, sizeof *w.journal);
  w.given_up = laves__alloc(context, layer->tet_count, sizeof *w.given_up);
  w.stuck = laves__alloc(context, layer->tet_count, sizeof *w.stuck);
  w.tries = laves__alloc_zeroed(context, layer->tet_count, 1);
  if (!w.journal || !w.given_up || !w.stuck || !w.tries || (flips && !w.spare) || (extra && !w.spare_vertex) || !list_fresh(&w)) {
    result = laves__fail_memory(context, error);
    goto cleanup;
  }
  w.admission.list = w.fresh;
  w.admission.list_count = w.fresh_count;
  for (size_t t = 0; t < layer->tet_count; t++) w.given_up[t] = w.stuck[t] = HUGE_VAL;
  for (int i = 0; i < workers; i++) w.journal[i].context = context;
  if (!laves__parallel_for(context, NULL, count_tets(&w), 1024, measure_all, &w)) result = laves__fail_cancelled(error);
  if (layer->patch && !laves__blocks_begin(layer, window->block_vertices, &w.blocks)) result = laves__fail_memory(context, error);
  if (result == LAVES_OK && !layer->patch && window->when == LAVES__IMPROVE_FIRST)
    result = laves__relax_surface(frame, &w.measure, SWEEPS, layer, error);
  if (result == LAVES_OK) result = mend_all(&w, window, error);
  if (result == LAVES_OK && !layer->patch) settle_all(&w, settle_floor);
  if (result == LAVES_OK && layer->patch) result = laves__blocks_end(&w.blocks, layer, error);
  if (result == LAVES_OK && short_of_memory(&w, workers)) result = laves__fail_memory(context, error);
cleanup:
  laves__blocks_free(&w.blocks);
  for (int i = 0; w.journal && i < workers; i++) laves__journal_free(&w.journal[i]);
  laves__free(context, w.spare_vertex, extra, sizeof *w.spare_vertex);
  laves__free(context, w.spare, layer->tet_count, sizeof *w.spare);
  laves__free(context, w.fresh, w.fresh_count, sizeof *w.fresh);
  laves__free(context, w.tries, layer->tet_count, 1);
  laves__free(context, w.stuck, layer->tet_count, sizeof *w.stuck);
  laves__free(context, w.given_up, layer->tet_count, sizeof *w.given_up);
  laves__free(context, w.journal, (size_t)workers, sizeof *w.journal);
  laves__patients_free(context, &w.patients);
  return result;
}

typedef struct outside_count {
  laves__measure measure;
  const laves__layer *layer;
} outside_count;

static double count_outside(const void *user, size_t begin, size_t end) {
  enum { PART = 256 };
  const outside_count *c = user;
  double quality[PART], count = 0;
  for (size_t first = begin; first < end; first += PART) {
    const size_t last = end - first < PART ? end : first + PART;
    laves__measure_tets(&c->measure, c->layer, first, last, quality);
    for (size_t t = first; t < last; t++) count += c->layer->tet[t][0] >= 0 && quality[t - first] < 1;
  }
  return count;
}

size_t laves__improve_outside(const laves__window *window, const laves__layer *layer) {
  const outside_count c = {laves__measure_of(window), layer};
  return (size_t)laves__parallel_sum(layer->context, "improve", layer->tet_count, count_outside, &c);
}
