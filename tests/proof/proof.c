/* The proof of docs/proof.md, as a test: for each guarantee of src/stuff/rule.c, every dihedral angle of every piece of every
 * reachable configuration is inside the proved window, and every radius ratio above a bound.
 *
 *     reachable.c   how a tet can meet the surface: boxes of configurations, from the mesher's tables
 *     symmetry.c    three tets stand for all 136
 *     pieces.c      the pieces in a box, from the mesher's stencils and diagonal keys
 *     bound.c       bounds on angles and ratios in a box, with outward rounding
 *     proof.c       branch and bound
 *     sample.c      the mesher's own functions at the corners of the boxes, which show how sharp the bounds are
 *     draw.c        the worst ones as meshes
 *     resolved.c    measured, not proved: planes and spheres
 *
 * `proof` proves and prints a line per guarantee. `proof --draw FOLDER` writes the worst configurations as meshes;
 * `proof --resolved` prints what resolved surfaces come to, in a minute or two. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "draw.h"
#include "pieces.h"
#include "resolved.h"
#include "sample.h"
#include "symmetry.h"

/* How often a range may be halved: more where no order of keys is open, which only halving the cuts' ranges can settle. After
 * that, or after so many boxes, the claim counts as not proved. */
enum { DEPTH = 12, DEPTH_WITH_CHOICES = 2, CUT_DEPTH = 40, BOXES_MAX = 2000000 };

/* 3 r / R, proved for each guarantee whichever diagonals are chosen. Raised by RATIO_STEP it is wrong. */
static const double proved_ratio[LAVES__GUARANTEES] = {0.187, 0.265, 0.288, 0.326, 0.41};
#define RATIO_STEP 0.01
/* The angles of the first guarantee are wrong if raised by this. */
#define ANGLE_STEP 0.05

/* What has to be shown. */
typedef struct claim {
  const laves__guarantee *guarantee;
  window window;
  double ratio; /* 0: angles, else the ratio */
  effort effort;
  long configurations, limit;
  configuration failed;
} claim;

static bool piece_fits(const configuration *c, const uint8_t piece[4], int depth, claim *goal) {
  segment corner[4];
  segments_of(c, piece, corner);
  if (goal->ratio > 0) return ratio_above(corner, goal->ratio, 4 * depth, &goal->effort);
  return angles_inside(corner, &goal->window, depth, &goal->effort);
}

static bool pieces_fit(const configuration *c, const piece_list *list, int depth, claim *goal) {
  for (int p = 0; p < list->count; p++)
    if (!piece_fits(c, list->piece[p], depth, goal)) return false;
  return true;
}

/* Where the mesher chooses it takes the pieces with the better angles, so one choice is enough for those; ratios must do for
 * all. */
static bool outcome_fits(const configuration *c, const outcome *o, int depth, claim *goal) {
  for (int k = 0; k < o->count; k++)
    if (pieces_fit(c, &o->choice[k], depth, goal) == (goal->ratio == 0)) return goal->ratio == 0;
  return goal->ratio > 0;
}

/* Every possible order of the keys must fit in the box, or in both its halves. */
static bool box_fits(const configuration *c, int cut_depth, claim *goal) {
  outcome outcomes[OUTCOMES_MAX];
  const int count = possible_outcomes(c, outcomes);
  const bool certain = count == 1 && outcomes[0].count == 1;
  int fitting = 0;
  while (fitting < count && outcome_fits(c, &outcomes[fitting], certain ? DEPTH : DEPTH_WITH_CHOICES, goal)) fitting++;
  if (fitting == count) return true;
  configuration half[2];
  if (certain || cut_depth == 0 || goal->effort.boxes > goal->limit || !halve_cuts(c, half)) return false;
  return box_fits(&half[0], cut_depth - 1, goal) && box_fits(&half[1], cut_depth - 1, goal);
}

static bool visit_claim(const configuration *c, void *user) {
  claim *goal = user;
  goal->configurations++;
  goal->limit = goal->effort.boxes + BOXES_MAX;
  if (box_fits(c, CUT_DEPTH, goal)) return true;
  goal->failed = *c;
  return false;
}

/* ---- the claims ---- */

static int failures;

static void check(bool holds, const char *what, int guarantee) {
  if (holds) return;
  printf("FAILED: guarantee %d: %s\n", guarantee, what);
  failures++;
}

typedef struct tet_set {
  int count, representative[LAVES__C15_TETS];
} tet_set;

static tet_set load_tets(void) {
  tet_set t;
  int orbit[LAVES__C15_TETS], isometries, sum = 0;
  t.count = find_representatives(t.representative, orbit, &isometries);
  for (int i = 0; i < t.count; i++) sum += orbit[i];
  printf("%d isometries carry %d tets to all %d\n", isometries, t.count, sum);
  check(sum == LAVES__C15_TETS, "the representatives stand for all tets", 0);
  return t;
}

static bool is_dyadic(double x) { return x * 8192 == floor(x * 8192); }

/* The numbers of the rule fit together. */
static void check_rule(int number) {
  const laves__guarantee *g = &laves__guarantees[number];
  const laves__thresholds *t = g->thresholds;
  bool dyadic = is_dyadic(g->relaxation);
  for (int i = 0; i < 8; i++) dyadic &= is_dyadic(t->alpha[i / 4][i / 2 % 2][i % 2]) && is_dyadic(t->middle[i / 2 % 2][i % 2]);
  check(dyadic, "the thresholds are multiples of 2^-13", number);
  check(largest_alpha(t) < 0.5, "a crossing violates one end at most", number);
  check(g->proved_min > g->min_dihedral && g->proved_max < g->max_dihedral, "the proved window is inside the promised", number);
  const range low = cosine_range(g->proved_min), high = cosine_range(g->proved_max);
  check(fabs(g->cos_min - low.low) < 1e-14 && fabs(g->cos_max - high.high) < 1e-14, "the cosines are those of the angles",
        number);
  check(low.high - low.low < 1e-14 && high.high - high.low < 1e-14, "the cosines are known", number);
}

static bool proves(const tet_set *tets, claim *goal) {
  for (int i = 0; i < tets->count; i++)
    if (!visit_reachable(goal->guarantee, tets->representative[i], visit_claim, goal)) return false;
  return true;
}

/* ---- the warped tiling ---- */

/* A background tet whose ON corners have moved, kept or dropped, before any cut. */
static bool visit_warped(const configuration *c, void *user) {
  static const uint8_t whole[4] = {0, 1, 2, 3};
  segment corner[4];
  segments_of(c, whole, corner);
  ++*(long *)user;
  return is_positive(corner);
}

static bool visit_warped_but_four(const configuration *c, void *user) {
  const bool four = c->label[0] == 0 && c->label[1] == 0 && c->label[2] == 0 && c->label[3] == 0;
  return four || visit_warped(c, user);
}

/* No background tet is inverted, so pieces cannot overlap: none at all when all is relaxed, and none but those with four
 * corners ON, which are dropped, when nothing is. Returns how many configurations were looked at. */
static long check_warped(const tet_set *tets, const laves__guarantee *g, int number) {
  laves__guarantee unrelaxed = *g;
  unrelaxed.relaxation = 0;
  bool all = true, but_four = true;
  long configurations = 0;
  for (int i = 0; i < tets->count; i++) {
    all &= visit_all(g, tets->representative[i], visit_warped, &configurations);
    but_four &= visit_all(&unrelaxed, tets->representative[i], visit_warped_but_four, &configurations);
  }
  check(all, "no relaxed background tet is inverted", number);
  check(but_four, "no background tet with fewer than four corners on the surface is inverted", number);
  return configurations;
}

/* ---- what is printed and refused ---- */

static void check_proved(const tet_set *tets, claim *goal, const char *what, int number) {
  const bool proved = proves(tets, goal);
  check(proved, what, number);
  if (proved) return;
  printf("  not proved for tet %d with corners", goal->failed.tet);
  for (int k = 0; k < 4; k++) printf(" %s", goal->failed.label[k] < 0 ? "IN" : goal->failed.label[k] ? "OUT" : "ON");
  printf("\n");
}

/* The proof must refuse what is not so: a sharper claim about the worst configuration of its own. */
static void check_refusals(const sample *s, const laves__guarantee *g, int number) {
  claim more = {.guarantee = g, .window = window_of(g->proved_min + ANGLE_STEP, g->max_dihedral)};
  claim less = {.guarantee = g, .window = window_of(g->min_dihedral, g->proved_max - ANGLE_STEP)};
  claim rounder = {.guarantee = g, .ratio = proved_ratio[number] + RATIO_STEP};
  if (number == 0) {
    check(s->least.value < g->proved_min + ANGLE_STEP, "the smallest angle is sharp", number);
    check(s->most.value > g->proved_max - ANGLE_STEP, "the largest angle is sharp", number);
    check(!visit_claim(&s->least.configuration, &more), "a larger smallest angle is refused", number);
    check(!visit_claim(&s->most.configuration, &less), "a smaller largest angle is refused", number);
  }
  check(s->ratio.value < proved_ratio[number] + RATIO_STEP, "the radius ratio is sharp", number);
  check(!visit_claim(&s->ratio.configuration, &rounder), "a larger radius ratio is refused", number);
}

static void prove(const tet_set *tets, int number) {
  const laves__guarantee *g = &laves__guarantees[number];
  const clock_t start = clock();
  sample s = sample_start(g);
  for (int i = 0; i < tets->count; i++) visit_reachable(g, tets->representative[i], visit_sample, &s);
  check(round_upward(), "the machine rounds upward when asked to", number);
  check_rule(number);
  claim angles = {.guarantee = g, .window = window_of(g->proved_min, g->proved_max)};
  claim ratio = {.guarantee = g, .ratio = proved_ratio[number]};
  check_proved(tets, &angles, "the angles are inside the window", number);
  check_proved(tets, &ratio, "the radius ratios are above the bound", number);
  check_refusals(&s, g, number);
  const long warped = check_warped(tets, g, number);
  round_to_nearest();
  printf("guarantee %d: %ld configurations, %ld boxes for angles, %ld for ratios, %ld warped tets, %.2f s\n", number,
         angles.configurations, angles.effort.boxes, ratio.effort.boxes, warped, (double)(clock() - start) / CLOCKS_PER_SEC);
  printf("  dihedral angles %.2f to %.2f degrees, attained %.4f and %.4f; radius ratio %.3f, attained %.4f\n", g->proved_min,
         g->proved_max, s.least.value, s.most.value, proved_ratio[number], s.ratio.value);
}

int main(int count, char **arguments) {
  if (count == 2 && strcmp(arguments[1], "--resolved") == 0) {
    print_resolved(&laves__guarantees[0]);
    return 0;
  }
  const tet_set tets = load_tets();
  if (count == 3 && strcmp(arguments[1], "--draw") == 0) {
    sample s = sample_start(&laves__guarantees[0]);
    for (int i = 0; i < tets.count; i++) visit_reachable(s.guarantee, tets.representative[i], visit_sample, &s);
    return draw_extreme(&s.least, arguments[2], "smallest-angle") && draw_extreme(&s.most, arguments[2], "largest-angle") ? 0 : 1;
  }
  for (int number = 0; number < LAVES__GUARANTEES; number++) prove(&tets, number);
  return failures > 0;
}
