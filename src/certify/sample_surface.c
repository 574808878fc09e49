/* Samples of a surface that only tells signs and projections, such as a function of the caller's.
 *
 * The box of the domain is halved again and again, leaving out cells that the domain knows to lie on one side. A cell of
 * the last level that has both signs among its corners and centre projects its centre; the foot is a sample when it lies
 * in the cell, so there is about one sample for each cell that the surface crosses. A domain that knows nothing of whole
 * cells makes this dense; then the search is given up and may be tried again with a wider spacing. */
#include "certify/certify.h"

enum { DEPTH_MAX = 12, VISITS_MAX = 1 << 21, VISITS_PER_ASKING = 4096 };

typedef struct search {
  laves_context *context;
  const laves__oracle *oracle;
  laves__vec3 *points;
  size_t count, capacity, visits;
} search;

static bool holds(laves__vec3 centre, double half, laves__vec3 p) {
  return fabs(p.x - centre.x) <= half && fabs(p.y - centre.y) <= half && fabs(p.z - centre.z) <= half;
}

static bool has_both_signs(const laves__oracle *oracle, laves__vec3 c, double half) {
  laves__vec3 points[9] = {c};
  double phi[9];
  int inside = 0;
  for (int i = 0; i < 8; i++) points[i + 1] = v3_add(c, v3(i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half));
  oracle->evaluate(oracle->self, 9, points, phi, NULL);
  for (int i = 0; i < 9; i++) inside += phi[i] < 0;
  return inside > 0 && inside < 9;
}

static void sample_leaf(search *s, laves__vec3 c, double half) {
  uint32_t hint = LAVES__NO_HINT;
  laves__vec3 foot, normal;
  if (s->count == s->capacity || (!s->oracle->is_distance && !has_both_signs(s->oracle, c, half))) return;
  if (!s->oracle->project(s->oracle->self, c, 2 * half, &hint, &foot, &normal) || !holds(c, half, foot)) return;
  s->points[s->count++] = foot;
}

/* Which of eight cells the surface may cross. Distances are asked for together: each helps to find the next. */
static void find_crossed(const search *s, const laves__vec3 centres[8], double half, bool crossed[8]) {
  double phi[8];
  const double radius = sqrt(3) * half * (1 + 1e-9); /* room for the rounding of distances */
  if (s->oracle->is_distance) s->oracle->evaluate(s->oracle->self, 8, centres, phi, NULL);
  for (int i = 0; i < 8; i++)
    crossed[i] = s->oracle->is_distance
                     ? fabs(phi[i]) <= radius
                     : s->oracle->side(s->oracle->self, centres[i], radius, v3(half, half, half)) == LAVES__UNDECIDED;
}

/* Goes through the eight parts of a cell. */
static void visit(search *s, laves__vec3 c, double half, int depth) {
  const double h = half / 2;
  laves__vec3 centres[8];
  bool crossed[8];
  if ((s->visits += 8) >= VISITS_MAX) return;
  if (s->visits % VISITS_PER_ASKING == 0 && laves__cancelled(s->context, "distance", (double)s->visits / VISITS_MAX))
    s->visits = VISITS_MAX;
  for (int i = 0; i < 8; i++) centres[i] = v3_add(c, v3(i & 1 ? h : -h, i & 2 ? h : -h, i & 4 ? h : -h));
  find_crossed(s, centres, h, crossed);
  for (int i = 0; i < 8; i++) {
    if (!crossed[i]) continue;
    if (depth > 1)
      visit(s, centres[i], h, depth - 1);
    else
      sample_leaf(s, centres[i], h);
  }
}

size_t laves__sample_surface(laves_context *context, const laves__oracle *oracle, double spacing, laves__vec3 *points,
                             size_t capacity) {
  search s = {.context = context, .oracle = oracle, .points = points, .capacity = capacity};
  const laves__vec3 widths = v3_sub(oracle->bounds.upper, oracle->bounds.lower);
  const double half = fmax(widths.x, fmax(widths.y, widths.z)) / 2;
  int depth = 1;
  while (depth < DEPTH_MAX && 2 * half > ldexp(spacing, depth)) depth++;
  visit(&s, box3_centre(oracle->bounds), half, depth);
  return s.visits < VISITS_MAX ? s.count : 0;
}
