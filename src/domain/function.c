/* A solid given by a function of the caller's.
 *
 * In: a batched callback, a box, perhaps a Lipschitz constant.  Out: an oracle.
 *
 * Nothing is known of the function but its values. A value that is not a number counts as outside, and is counted. `project`
 * takes Newton steps along the gradient, found by central differences; as soon as two points with different signs are known it
 * halves the stretch between them, so that it ends on the surface however the function bends. With a Lipschitz constant L, |phi|
 * > L r says that the ball of radius r holds no surface; without one every ball inside the box is undecided.
 *
 * A call of the callback may cost far more than what it computes, as where it is an interpreter's. So all points that are
 * projected go their ways in step: each says where it must know phi next, the callback is asked for all of them at once, and each
 * goes on with its answer. No way depends on another. A way that goes alone asks for the
 * gradient along with the value, as it is likely to be wanted next. */
#include <stdatomic.h>
#include <string.h>

#include "domain/oracle.h"

/* Step of the differences in parts of the box's diagonal: the cube root of the rounding of a double, where the errors of
 * rounding and of curvature meet. */
static const double difference_step = 6e-6;
/* Where Newton's method stops, in the same unit; a thousand times the rounding of a coordinate. */
static const double close_enough = 1e-13;
/* A step that leaves less than this share of the value gains much. */
static const double much = 0.1;
/* Relative room for the rounding of the caller's values when a ball is judged. */
static const double side_margin = 1e-9;

enum { NEWTON_MAX = 30, BISECTION_MAX = 60, SEARCH_STEPS = 16, BATCH = 512, WAYS = 256, SLOPE_POINTS = 6 };

/* Values that are no numbers. Shared by all threads, so written behind the lock only. */
typedef struct gaps {
  atomic_flag lock;
  size_t count;
  laves__vec3 place; /* the least, so that it does not depend on the threads */
} gaps;

typedef struct solid {
  gaps *gaps;
  laves_function function;
  laves__vec3 origin;
  laves__box3 bounds; /* local */
  double diagonal;
} solid;

static bool is_less(laves__vec3 a, laves__vec3 b) { return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z; }

static void lock_gaps(gaps *g) {
  while (atomic_flag_test_and_set_explicit(&g->lock, memory_order_acquire)) {
  }
}

static void unlock_gaps(gaps *g) { atomic_flag_clear_explicit(&g->lock, memory_order_release); }

/* The values with numbers far outside for what is none. */
static void fill_gaps(const solid *s, size_t count, const laves__vec3 *input, double *phi) {
  size_t found = 0, least = 0;
  for (size_t i = 0; i < count; i++) {
    if (!isnan(phi[i])) continue;
    phi[i] = s->diagonal;
    if (found++ == 0 || is_less(input[i], input[least])) least = i;
  }
  if (found == 0) return;
  lock_gaps(s->gaps);
  if (s->gaps->count == 0 || is_less(input[least], s->gaps->place)) s->gaps->place = input[least];
  s->gaps->count += found;
  unlock_gaps(s->gaps);
}

size_t laves__function_gaps(const laves_domain *domain, laves__vec3 *place) {
  const solid *s = domain->oracle.self;
  if (domain->info.kind != LAVES_DOMAIN_FUNCTION) return 0;
  lock_gaps(s->gaps);
  const size_t count = s->gaps->count;
  *place = s->gaps->place;
  unlock_gaps(s->gaps);
  return count;
}

static void evaluate(const void *self, size_t count, const laves__vec3 *points, double *phi, uint32_t *hints) {
  const solid *s = self;
  laves__vec3 input[BATCH];
  for (size_t begin = 0; begin < count; begin += BATCH) {
    const size_t size = count - begin < BATCH ? count - begin : BATCH;
    for (size_t i = 0; i < size; i++) input[i] = v3_add(points[begin + i], s->origin);
    s->function.evaluate(s->function.user, &input[0].x, size, phi + begin);
    fill_gaps(s, size, input, phi + begin);
    for (size_t i = begin; hints && i < begin + size; i++) hints[i] = LAVES__NO_HINT;
  }
}

static double value(const solid *s, laves__vec3 p) {
  double phi;
  evaluate(s, 1, &p, &phi, NULL);
  return phi;
}

/* ---- projection: the ways of points to the surface ---- */

/* What a way waits for: phi at one point, or at the six about a point that tell its gradient. */
typedef enum wait {
  AT_START,       /* phi of the point itself */
  SLOPE_AT_START, /* its gradient */
  NEWTON_STEP,    /* phi where a step of Newton's leads */
  NEWTON_SLOPE,   /* the gradient there, as the last one served no more */
  BETWEEN,        /* phi between two points whose signs differ */
  SEARCH,         /* phi at the next place of the search */
  SLOPE_AT_FOOT,
  ARRIVED,
  LOST
} wait;

typedef struct way {
  wait wait;
  laves__vec3 at; /* the point that is waited for, or about which the gradient is */
  laves__vec3 point;
  double reach, phi;     /* of the point */
  laves__vec3 x, slope;  /* Newton's: where it is, and the gradient that it uses */
  double phi_x;          /* there */
  laves__vec3 direction; /* of the search */
  bool searches;         /* Newton's method has failed */
  laves__vec3 a, b;      /* the stretch that is halved */
  double phi_a, phi_b;   /* at its ends, or less, to move the secant */
  int step;              /* of whichever of these is going on */
  laves__vec3 foot, normal;
} way;

static void go_to(way *w, wait what, laves__vec3 at) {
  w->wait = what;
  w->at = at;
}

static bool waits_for_slope(const way *w) {
  return w->wait == SLOPE_AT_START || w->wait == NEWTON_SLOPE || w->wait == SLOPE_AT_FOOT;
}

static bool has_slope(laves__vec3 gradient) {
  const double slope2 = v3_norm2(gradient);
  return slope2 > 0 && isfinite(slope2);
}

static void arrive(way *w, laves__vec3 foot) {
  w->foot = foot;
  go_to(w, SLOPE_AT_FOOT, foot);
}

/* Steps of growing length from the point along `direction`, until the sign differs from that of phi. */
static void search_on(way *w) {
  if (++w->step > SEARCH_STEPS) {
    w->wait = LOST;
    return;
  }
  const double t = (double)w->step / SEARCH_STEPS;
  go_to(w, SEARCH, v3_mad(w->point, w->direction, w->reach * t * t));
}

static void begin_search(way *w) {
  w->searches = true;
  w->step = 0;
  w->a = w->point;
  w->phi_a = w->phi;
  search_on(w);
}

/* Newton's method has come to x. */
static void end_newton(way *w, laves__vec3 x) {
  if (v3_distance(w->point, x) > w->reach)
    begin_search(w);
  else
    arrive(w, x);
}

static void end_between(way *w, laves__vec3 p) {
  if (w->searches)
    arrive(w, p);
  else
    end_newton(w, p);
}

/* A point of the surface between a and b, whose values differ in sign, by the Illinois variant of false position. */
static void halve(way *w, const solid *s) {
  if (w->step == BISECTION_MAX || !(v3_distance(w->a, w->b) > close_enough * s->diagonal)) {
    end_between(w, v3_lerp(w->a, w->b, 0.5));
    return;
  }
  const double secant = w->phi_a / (w->phi_a - w->phi_b);
  /* Every third step halves, for functions on which the secant creeps. */
  const bool middle = w->step % 3 == 2 || !(secant > 0 && secant < 1);
  go_to(w, BETWEEN, v3_lerp(w->a, w->b, middle ? 0.5 : secant));
}

static void begin_between(way *w, const solid *s, laves__vec3 a, double phi_a, laves__vec3 b, double phi_b) {
  w->a = a;
  w->b = b;
  w->phi_a = phi_a;
  w->phi_b = phi_b;
  w->step = 0;
  halve(w, s);
}

static void went_between(way *w, const solid *s, double phi) {
  if (phi == 0) {
    end_between(w, w->at);
    return;
  }
  if ((phi < 0) == (w->phi_b < 0)) {
    w->b = w->at;
    w->phi_b = phi;
    w->phi_a *= 0.5;
  } else {
    w->a = w->at;
    w->phi_a = phi;
    w->phi_b *= 0.5;
  }
  w->step++;
  halve(w, s);
}

static void searched(way *w, const solid *s, double phi) {
  if ((phi < 0) != (w->phi < 0)) {
    begin_between(w, s, w->a, w->phi_a, w->at, phi);
    return;
  }
  w->a = w->at;
  w->phi_a = phi;
  search_on(w);
}

/* The next step of Newton's method, which gives up where there is no slope and ends where steps are small. */
static void newton_on(way *w, const solid *s) {
  if (w->step == NEWTON_MAX) {
    end_newton(w, w->x);
    return;
  }
  if (!has_slope(w->slope)) {
    begin_search(w);
    return;
  }
  const double slope2 = v3_norm2(w->slope);
  double step = -w->phi_x / slope2;
  const double length = fabs(step) * sqrt(slope2);
  if (length <= close_enough * s->diagonal) {
    end_newton(w, w->x);
    return;
  }
  if (length > w->reach) step *= w->reach / length;
  go_to(w, NEWTON_STEP, v3_mad(w->x, w->slope, step));
}

/* It fails when it leaves the ball. A gradient serves as long as its steps gain much. */
static void newton_went(way *w, const solid *s, double phi) {
  if (phi != 0 && (phi < 0) != (w->phi_x < 0)) {
    begin_between(w, s, w->x, w->phi_x, w->at, phi);
    return;
  }
  if (v3_distance(w->at, w->point) > 2 * w->reach) {
    begin_search(w);
    return;
  }
  const bool gained = fabs(phi) < much * fabs(w->phi_x);
  w->x = w->at;
  w->phi_x = phi;
  w->step++;
  if (phi == 0)
    end_newton(w, w->x);
  else if (gained)
    newton_on(w, s);
  else
    go_to(w, NEWTON_SLOPE, w->x);
}

static void start(way *w, double phi) {
  w->phi = phi;
  if (phi == 0)
    arrive(w, w->point);
  else
    go_to(w, SLOPE_AT_START, w->point);
}

static void begin_newton(way *w, const solid *s, laves__vec3 slope) {
  if (!has_slope(slope)) {
    w->wait = LOST;
    return;
  }
  w->x = w->point;
  w->phi_x = w->phi;
  w->slope = slope;
  w->direction = v3_scale(v3_unit(slope), w->phi < 0 ? 1 : -1);
  newton_on(w, s);
}

static void end_way(way *w, laves__vec3 slope) {
  w->normal = v3_unit(slope);
  w->wait = has_slope(slope) && v3_distance(w->point, w->foot) <= w->reach ? ARRIVED : LOST;
}

/* Goes on with what was waited for: one value, or six. */
static void go_on(way *w, const solid *s, const double *phi) {
  const double per_step = 0.5 / (difference_step * s->diagonal);
  laves__vec3 slope = {0, 0, 0};
  if (waits_for_slope(w)) slope = v3_scale(v3(phi[0] - phi[1], phi[2] - phi[3], phi[4] - phi[5]), per_step);
  switch (w->wait) {
    case AT_START:
      start(w, phi[0]);
      break;
    case SLOPE_AT_START:
      begin_newton(w, s, slope);
      break;
    case NEWTON_STEP:
      newton_went(w, s, phi[0]);
      break;
    case NEWTON_SLOPE:
      w->slope = slope;
      newton_on(w, s);
      break;
    case BETWEEN:
      went_between(w, s, phi[0]);
      break;
    case SEARCH:
      searched(w, s, phi[0]);
      break;
    case SLOPE_AT_FOOT:
      end_way(w, slope);
      break;
    case ARRIVED:
    case LOST:
      break;
  }
}

static void points_about(const solid *s, laves__vec3 p, laves__vec3 points[SLOPE_POINTS]) {
  const double h = difference_step * s->diagonal;
  points[0] = v3(p.x + h, p.y, p.z);
  points[1] = v3(p.x - h, p.y, p.z);
  points[2] = v3(p.x, p.y + h, p.z);
  points[3] = v3(p.x, p.y - h, p.z);
  points[4] = v3(p.x, p.y, p.z + h);
  points[5] = v3(p.x, p.y, p.z - h);
}

static bool has_ended(const way *w) { return w->wait == ARRIVED || w->wait == LOST; }

/* Writes the points that a way waits for; returns how many. */
static size_t points_of(const way *w, const solid *s, laves__vec3 *points) {
  if (has_ended(w)) return 0;
  if (waits_for_slope(w)) {
    points_about(s, w->at, points);
    return SLOPE_POINTS;
  }
  points[0] = w->at;
  return 1;
}

/* All ways to their ends. points, phi: room for SLOPE_POINTS of each. */
static void walk(const solid *s, size_t count, way *ways, laves__vec3 *points, double *phi) {
  for (;;) {
    size_t asked = 0;
    for (size_t i = 0; i < count; i++) asked += points_of(&ways[i], s, points + asked);
    if (asked == 0) return;
    evaluate(s, asked, points, phi, NULL);
    const double *answer = phi;
    for (size_t i = 0; i < count; i++) {
      if (has_ended(&ways[i])) continue;
      const size_t given = waits_for_slope(&ways[i]) ? SLOPE_POINTS : 1;
      go_on(&ways[i], s, answer);
      answer += given;
    }
  }
}

/* Whether the gradient is likely to be wanted at the next point. After a step of Newton's that went a little too far, the first
 * secant mostly ends on the surface. */
static bool may_end_at(const way *w) {
  return w->wait == AT_START || w->wait == NEWTON_STEP || (w->wait == BETWEEN && !w->searches && w->step == 0);
}

/* One way to its end. */
static void walk_alone(const solid *s, way *w) {
  laves__vec3 points[1 + SLOPE_POINTS];
  double phi[1 + SLOPE_POINTS];
  while (!has_ended(w)) {
    size_t asked = points_of(w, s, points);
    const bool ahead = may_end_at(w);
    const laves__vec3 at = w->at;
    if (ahead) {
      points_about(s, at, points + 1);
      asked += SLOPE_POINTS;
    }
    evaluate(s, asked, points, phi, NULL);
    go_on(w, s, phi);
    if (ahead && waits_for_slope(w) && v3_distance(w->at, at) == 0) go_on(w, s, phi + 1);
  }
}

static way way_from(laves__vec3 point, double reach) {
  return (way){.wait = AT_START, .at = point, .point = point, .reach = reach};
}

static bool project(const void *self, laves__vec3 point, double reach, uint32_t *hint, laves__vec3 *foot, laves__vec3 *normal) {
  way w = way_from(point, reach);
  walk_alone(self, &w);
  *hint = LAVES__NO_HINT;
  *foot = w.foot;
  *normal = w.normal;
  return w.wait == ARRIVED;
}

static void project_many(const void *self, size_t count, const laves__vec3 *points, double reach, laves__projection *answers) {
  way ways[WAYS];
  laves__vec3 asked[WAYS * SLOPE_POINTS];
  double phi[WAYS * SLOPE_POINTS];
  for (size_t begin = 0; begin < count; begin += WAYS) {
    const size_t n = count - begin < WAYS ? count - begin : WAYS;
    for (size_t i = 0; i < n; i++) ways[i] = way_from(points[begin + i], reach);
    walk(self, n, ways, asked, phi);
    for (size_t i = 0; i < n; i++)
      answers[begin + i] = (laves__projection){
          .found = ways[i].wait == ARRIVED, .hint = LAVES__NO_HINT, .foot = ways[i].foot, .normal = ways[i].normal};
  }
}

static bool apart(laves__box3 b, laves__vec3 c, laves__vec3 h) {
  return c.x + h.x < b.lower.x || c.x - h.x > b.upper.x || c.y + h.y < b.lower.y || c.y - h.y > b.upper.y ||
         c.z + h.z < b.lower.z || c.z - h.z > b.upper.z;
}

static laves__side side(const void *self, laves__vec3 centre, double radius, laves__vec3 half) {
  const solid *s = self;
  if (apart(s->bounds, centre, half) || apart(s->bounds, centre, v3(radius, radius, radius))) return LAVES__OUTSIDE;
  if (!(s->function.lipschitz > 0)) return LAVES__UNDECIDED;
  const double phi = value(s, centre);
  const double reach = fmin(radius, v3_norm(half)) * s->function.lipschitz;
  if (!(fabs(phi) > reach * (1 + side_margin))) return LAVES__UNDECIDED;
  return phi < 0 ? LAVES__INSIDE : LAVES__OUTSIDE;
}

static void solid_free(laves_context *context, void *self) {
  solid *s = self;
  laves__free(context, s->gaps, 1, sizeof *s->gaps);
  laves__free(context, s, 1, sizeof *s);
}

static bool box_is_good(const laves_function *f) {
  for (int k = 0; k < 3; k++)
    if (!isfinite(f->lower[k]) || !isfinite(f->upper[k]) || !(f->lower[k] < f->upper[k])) return false;
  return true;
}

laves_result laves__function_build(laves_context *context, const laves_function *function, laves_domain *domain,
                                   laves_error *error) {
  if (!function || !function->evaluate) return laves__fail(error, LAVES_ERROR_OPTION, "the function has no evaluate callback");
  if (!box_is_good(function))
    return laves__fail(error, LAVES_ERROR_OPTION,
                       "the box of the function must be finite, with lower less than upper on each axis");
  if (!(function->lipschitz >= 0) || !isfinite(function->lipschitz))
    return laves__fail(error, LAVES_ERROR_OPTION, "the Lipschitz constant %g must be finite and at least 0", function->lipschitz);
  solid *s = laves__alloc_zeroed(context, 1, sizeof *s);
  if (s) s->gaps = laves__alloc_zeroed(context, 1, sizeof *s->gaps);
  if (!s || !s->gaps) {
    laves__free(context, s, 1, sizeof *s);
    return laves__fail_memory(context, error);
  }
  unlock_gaps(s->gaps);
  const laves__box3 box = {v3(function->lower[0], function->lower[1], function->lower[2]),
                           v3(function->upper[0], function->upper[1], function->upper[2])};
  s->function = *function;
  s->origin = box3_centre(box);
  s->bounds = (laves__box3){v3_sub(box.lower, s->origin), v3_sub(box.upper, s->origin)};
  s->diagonal = box3_diagonal(box);
  domain->oracle = (laves__oracle){.self = s,
                                   .origin = s->origin,
                                   .bounds = s->bounds,
                                   .volume = NAN,
                                   .area = NAN,
                                   .evaluate = evaluate,
                                   .project = project,
                                   .project_many = project_many,
                                   .batch = BATCH,
                                   .side = side,
                                   .free = solid_free};
  domain->info.kind = LAVES_DOMAIN_FUNCTION;
  domain->info.volume = domain->info.area = NAN;
  for (int k = 0; k < 3; k++) {
    domain->info.lower[k] = function->lower[k];
    domain->info.upper[k] = function->upper[k];
  }
  memcpy(domain->format, "function", sizeof "function");
  return LAVES_OK;
}
