/* Bounds by elimination: what intervals prove to be outside is cut away until the box no longer shrinks.
 *
 * Each round divides the box into 16^3 cells, top down, and takes the hull of those not proved outside. An axis
 * that is still infinite is divided in t, with coordinate t / (1 - |t|), so that its last cells reach to infinity. When
 * a round gains little, a finer one ends the search. A box that is still infinite then has no bounds that intervals see. */
#include <math.h>

#include "domain/elementary.h"
#include "domain/implicit_bounds.h"
#include "domain/shape.h"

enum { ROUND_DEPTH = 4, LAST_DEPTH = 6, ROUND_LIMIT = 200 };

/* The least part of some width by which a round must shrink the box to be worth another. */
static const double worthwhile = 0.05;
/* Instructions that the search may take, about 2 seconds; what is then undecided counts as solid. */
static const double instruction_limit = 4e8;
/* Room for the rounding of the map to t, as a fraction of the box. */
static const double map_slack = 1e-12;

typedef struct search {
  const laves__tape *tape;
  bool compact[3]; /* the axis is divided in t */
  int depth;
  double instructions;
  laves__box3 hull; /* in t where compact */
} search;

static double coordinate_of(double t) { return t / (1 - fabs(t)); } /* +-1 give +-infinity */
static double parameter_of(double x) { return isinf(x) ? copysign(1, x) : x / (1 + fabs(x)); }

static laves__box3 mapped(const search *s, laves__box3 cell, double (*map)(double)) {
  for (int i = 0; i < 3; i++) {
    if (!s->compact[i]) continue;
    (&cell.lower.x)[i] = map((&cell.lower.x)[i]);
    (&cell.upper.x)[i] = map((&cell.upper.x)[i]);
  }
  return cell;
}

static void visit(search *s, laves__box3 cell, int depth) {
  const laves__vec3 l = cell.lower, u = cell.upper, hl = s->hull.lower, hu = s->hull.upper;
  if (l.x >= hl.x && l.y >= hl.y && l.z >= hl.z && u.x <= hu.x && u.y <= hu.y && u.z <= hu.z) return; /* adds nothing */
  if (s->instructions > instruction_limit) depth = s->depth;
  s->instructions += (double)s->tape->count;
  bool may_be_nan;
  const laves__interval value = laves__tape_interval(s->tape, mapped(s, cell, coordinate_of), &may_be_nan);
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

/* One round: the hull of what is left. */
static laves__box3 shrink(search *s, laves__box3 box) {
  for (int i = 0; i < 3; i++) s->compact[i] = isinf((&box.lower.x)[i]) || isinf((&box.upper.x)[i]);
  s->hull = box3_empty();
  visit(s, mapped(s, box, parameter_of), 0);
  return s->hull;
}

static bool gained(laves__box3 before, laves__box3 after) {
  for (int i = 0; i < 3; i++) {
    const double old = (&before.upper.x)[i] - (&before.lower.x)[i], now = (&after.upper.x)[i] - (&after.lower.x)[i];
    if (now < (1 - worthwhile) * old) return true;
  }
  return false;
}

laves__bounds_result laves__bounds_find(const laves__tape *tape, laves__box3 *box) {
  search s = {.tape = tape, .depth = ROUND_DEPTH};
  const bool was_endless = !laves__box3_is_finite(*box);
  for (int round = 0; round < ROUND_LIMIT; round++) {
    const laves__box3 hull = shrink(&s, *box);
    if (hull.lower.x > hull.upper.x) return LAVES__BOUNDS_EMPTY;
    const laves__box3 before = *box;
    const bool more = gained(mapped(&s, before, parameter_of), hull);
    *box = mapped(&s, hull, coordinate_of);
    if (!more) break;
  }
  if (!laves__box3_is_finite(*box)) return LAVES__BOUNDS_ENDLESS;
  if (s.instructions < instruction_limit / 2) {
    s.depth = LAST_DEPTH;
    const laves__box3 hull = shrink(&s, *box);
    if (hull.lower.x > hull.upper.x) return LAVES__BOUNDS_EMPTY;
    *box = hull;
  }
  if (was_endless) {
    const laves__vec3 room = v3_scale(v3_sub(box->upper, box->lower), map_slack);
    *box = (laves__box3){v3_sub(box->lower, room), v3_add(box->upper, room)};
  }
  return LAVES__BOUNDS_FOUND;
}
