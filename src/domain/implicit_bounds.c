/* Bounds by elimination: what intervals prove to be outside is cut away until the box no longer shrinks.
 *
 * Each round divides the box into 16^3 cells, top down, and takes the hull of those not proved outside. When a round gains
 * little, a finer one ends the search. An axis that is still infinite is divided in t, with coordinate t / (1 - |t|), so that
 * its last cells reach to infinity; what is left then is proved to hold the solid.
 *
 * Intervals see nothing at infinity where terms of opposite sign grow, as in x^4 - x^2. Such an axis is cut at
 * HORIZON and divided in proportion, in t with coordinate (2^(62 |t|) - 1) / 2^31, once: bounds that
 * come from there are proved up to the horizon only. What still reaches it has no bounds that can be found. */
#include <math.h>

#include "domain/elementary.h"
#include "domain/implicit_bounds.h"
#include "domain/shape.h"

enum { ROUND_DEPTH = 4, LAST_DEPTH = 6, ROUND_LIMIT = 200 };

/* The least part of some width by which a round must shrink the box to be worth another. */
static const double worthwhile = 0.05;
/* Instructions that the search may take, about half a second; what is then undecided counts as solid. */
static const double instruction_limit = 1e8;
/* Between two reports of progress; those of leaves take long. */
static const double instructions_per_report = 1e4;
/* Room for the rounding of the map to t, as a fraction of the box. */
static const double map_slack = 1e-12;

typedef struct search {
  laves_context *context;
  const laves__tape *tape;
  bool divided_in_t[3]; /* the axis has infinite sides, or is cut at the horizon */
  bool in_proportion;   /* which of the two maps applies */
  int depth;
  double instructions, asked; /* so far, and when progress was reported last */
  bool cancelled;
  laves__box3 hull; /* in t where so divided */
} search;

/* The horizon is the coordinate of t = 1: 2147483647.9999999995. */
static const double octaves = 62, finest = 1.0 / 2147483648.0;

static double compact_coordinate(double t) { return t / (1 - fabs(t)); } /* +-1 give +-infinity */
static double compact_parameter(double x) { return isinf(x) ? copysign(1, x) : x / (1 + fabs(x)); }
static double proportional_coordinate(double t) { return copysign((exp2(octaves * fabs(t)) - 1) * finest, t); }
static double proportional_parameter(double x) {
  return isinf(x) ? copysign(1, x) : copysign(min_of(1, log2(fabs(x) / finest + 1) / octaves), x);
}

static laves__box3 mapped(const search *s, laves__box3 cell, double (*map)(double)) {
  for (int i = 0; i < 3; i++) {
    if (!s->divided_in_t[i]) continue;
    *v3_slot(&cell.lower, i) = map(v3_at(cell.lower, i));
    *v3_slot(&cell.upper, i) = map(v3_at(cell.upper, i));
  }
  return cell;
}

static laves__box3 to_coordinates(const search *s, laves__box3 cell) {
  return mapped(s, cell, s->in_proportion ? proportional_coordinate : compact_coordinate);
}

static laves__box3 to_parameters(const search *s, laves__box3 cell) {
  return mapped(s, cell, s->in_proportion ? proportional_parameter : compact_parameter);
}

static bool is_cancelled(search *s) {
  if (s->cancelled || s->instructions - s->asked < instructions_per_report) return s->cancelled;
  s->asked = s->instructions;
  s->cancelled = laves__cancelled(s->context, "bounds", 0);
  return s->cancelled;
}

static void visit(search *s, laves__box3 cell, int depth) {
  if (is_cancelled(s)) return;
  const laves__vec3 l = cell.lower, u = cell.upper, hl = s->hull.lower, hu = s->hull.upper;
  if (l.x >= hl.x && l.y >= hl.y && l.z >= hl.z && u.x <= hu.x && u.y <= hu.y && u.z <= hu.z) return; /* adds nothing */
  if (s->instructions > instruction_limit) depth = s->depth;
  s->instructions += (double)s->tape->count;
  bool may_be_nan;
  const laves__interval value = laves__tape_interval(s->tape, to_coordinates(s, cell), &may_be_nan);
  if (value.lower > 0 && !may_be_nan) return;
  if (depth == s->depth || value.upper < 0) {
    s->hull = box3_add(box3_add(s->hull, l), u);
    return;
  }
  const laves__vec3 c = box3_centre(cell);
  for (int i = 0; i < 8; i++) {
    const laves__box3 part = {{i & 1 ? c.x : l.x, i & 2 ? c.y : l.y, i & 4 ? c.z : l.z},
                              {i & 1 ? u.x : c.x, i & 2 ? u.y : c.y, i & 4 ? u.z : c.z}};
    visit(s, part, depth + 1);
  }
}

/* One round: the hull of what is left, in coordinates. *gain: whether it pays to go on. False when nothing is left. */
static bool shrink(search *s, laves__box3 *box, bool *gain) {
  const laves__box3 before = to_parameters(s, *box);
  s->hull = box3_empty();
  visit(s, before, 0);
  *gain = false;
  for (int i = 0; i < 3; i++) {
    const double old = v3_at(before.upper, i) - v3_at(before.lower, i), now = v3_at(s->hull.upper, i) - v3_at(s->hull.lower, i);
    if (now < (1 - worthwhile) * old) *gain = true;
  }
  *box = to_coordinates(s, s->hull);
  return s->hull.lower.x <= s->hull.upper.x;
}

/* Marks the axes that are infinite; whether there are any. */
static bool mark_endless(search *s, laves__box3 box) {
  bool any = false;
  for (int i = 0; i < 3; i++) any |= s->divided_in_t[i] = isinf(v3_at(box.lower, i)) || isinf(v3_at(box.upper, i));
  return any;
}

/* Rounds until they gain nothing. False when nothing is left. */
static bool shrink_on(search *s, laves__box3 *box) {
  bool gain = true;
  for (int round = 0; gain && round < ROUND_LIMIT; round++) {
    mark_endless(s, *box);
    if (!shrink(s, box, &gain)) return false;
  }
  return true;
}

/* One fine round up to the horizon. False when nothing is left. */
static bool shrink_from_horizon(search *s, laves__box3 *box) {
  bool gain;
  s->in_proportion = true;
  s->depth = LAST_DEPTH;
  const bool some = shrink(s, box, &gain);
  const double horizon = proportional_coordinate(1);
  for (int i = 0; i < 3; i++)
    if (s->divided_in_t[i] && (v3_at(box->lower, i) <= -horizon || v3_at(box->upper, i) >= horizon))
      *v3_slot(&box->upper, i) = INFINITY;
  s->in_proportion = false;
  s->depth = ROUND_DEPTH;
  return some;
}

static laves__bounds_result find(search *s, laves__box3 *box) {
  const bool was_endless = mark_endless(s, *box);
  if (!shrink_on(s, box)) return LAVES__BOUNDS_EMPTY;
  if (mark_endless(s, *box)) {
    if (!shrink_from_horizon(s, box)) return LAVES__BOUNDS_EMPTY;
    if (!laves__box3_is_finite(*box)) return LAVES__BOUNDS_ENDLESS;
    if (!shrink_on(s, box)) return LAVES__BOUNDS_EMPTY;
  }
  if (s->instructions < instruction_limit / 2) {
    bool gain;
    mark_endless(s, *box);
    s->depth = LAST_DEPTH;
    if (!shrink(s, box, &gain)) return LAVES__BOUNDS_EMPTY;
  }
  if (was_endless) {
    const laves__vec3 room = v3_scale(v3_sub(box->upper, box->lower), map_slack);
    *box = (laves__box3){v3_sub(box->lower, room), v3_add(box->upper, room)};
  }
  return LAVES__BOUNDS_FOUND;
}

laves__bounds_result laves__bounds_find(laves_context *context, const laves__tape *tape, laves__box3 *box) {
  search s = {.context = context, .tape = tape, .depth = ROUND_DEPTH};
  const laves__bounds_result result = find(&s, box);
  return s.cancelled ? LAVES__BOUNDS_CANCELLED : result;
}
