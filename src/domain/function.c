/* A solid given by a function of the caller's.
 *
 * In: a batched callback, a box, perhaps a Lipschitz constant.  Out: an oracle.
 *
 * Nothing is known of the function but its values. A value that is not a number counts as outside. `project` takes Newton steps
 * along the gradient, found by central differences; as soon as two points with different signs are known it halves the stretch
 * between them, so that it ends on the surface however the function bends. With a Lipschitz constant L, |phi| > L r says that the
 * ball of radius r holds no surface; without one every ball inside the box is undecided. */
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

enum { NEWTON_MAX = 30, BISECTION_MAX = 60, SEARCH_STEPS = 16, BATCH = 64 };

typedef struct solid {
  laves_function function;
  laves__vec3 origin;
  laves__box3 bounds; /* local */
  double diagonal;
} solid;

static void evaluate(const void *self, size_t count, const laves__vec3 *points, double *phi, uint32_t *hints) {
  const solid *s = self;
  laves__vec3 input[BATCH];
  for (size_t begin = 0; begin < count; begin += BATCH) {
    const size_t size = count - begin < BATCH ? count - begin : BATCH;
    for (size_t i = 0; i < size; i++) input[i] = v3_add(points[begin + i], s->origin);
    s->function.evaluate(s->function.user, &input[0].x, size, phi + begin);
    for (size_t i = begin; i < begin + size; i++) {
      if (isnan(phi[i])) phi[i] = s->diagonal;
      if (hints) hints[i] = LAVES__NO_HINT;
    }
  }
}

static double value(const solid *s, laves__vec3 p) {
  double phi;
  evaluate(s, 1, &p, &phi, NULL);
  return phi;
}

static laves__vec3 gradient(const solid *s, laves__vec3 p) {
  const double h = difference_step * s->diagonal;
  laves__vec3 points[6];
  double phi[6];
  for (int i = 0; i < 6; i++) {
    const double d = i % 2 == 0 ? h : -h;
    points[i] = v3_add(p, v3(i / 2 == 0 ? d : 0, i / 2 == 1 ? d : 0, i / 2 == 2 ? d : 0));
  }
  evaluate(s, 6, points, phi, NULL);
  return v3_scale(v3(phi[0] - phi[1], phi[2] - phi[3], phi[4] - phi[5]), 0.5 / h);
}

static bool has_slope(laves__vec3 gradient) {
  const double slope2 = v3_norm2(gradient);
  return slope2 > 0 && isfinite(slope2);
}

/* A point of the surface between a and b, whose values differ in sign, by the Illinois variant of false position. */
static laves__vec3 between(const solid *s, laves__vec3 a, double phi_a, laves__vec3 b, double phi_b) {
  for (int i = 0; i < BISECTION_MAX && v3_distance(a, b) > close_enough * s->diagonal; i++) {
    const double secant = phi_a / (phi_a - phi_b);
    /* Every third step halves, for functions on which the secant creeps. */
    const bool halve = i % 3 == 2 || !(secant > 0 && secant < 1);
    const laves__vec3 m = v3_lerp(a, b, halve ? 0.5 : secant);
    const double phi = value(s, m);
    if (phi == 0) return m;
    if ((phi < 0) == (phi_b < 0)) {
      b = m;
      phi_b = phi;
      phi_a *= 0.5;
    } else {
      a = m;
      phi_a = phi;
      phi_b *= 0.5;
    }
  }
  return v3_lerp(a, b, 0.5);
}

/* Steps of growing length from p along `direction`, until the sign differs from that of phi. */
static bool search(const solid *s, laves__vec3 p, double phi, laves__vec3 direction, double reach, laves__vec3 *foot) {
  laves__vec3 before = p;
  double phi_before = phi;
  for (int i = 1; i <= SEARCH_STEPS; i++) {
    const double t = (double)i / SEARCH_STEPS;
    const laves__vec3 q = v3_mad(p, direction, reach * t * t);
    const double phi_q = value(s, q);
    if ((phi_q < 0) != (phi < 0)) {
      *foot = between(s, before, phi_before, q, phi_q);
      return true;
    }
    before = q;
    phi_before = phi_q;
  }
  return false;
}

/* Newton's method from p, where the gradient is g; false when it leaves the ball or finds no slope. A gradient serves as long as
 * its steps gain much. */
static bool newton(const solid *s, laves__vec3 p, double phi, laves__vec3 g, double reach, laves__vec3 *foot) {
  laves__vec3 x = p;
  for (int i = 0; i < NEWTON_MAX; i++) {
    if (!has_slope(g)) return false;
    const double slope2 = v3_norm2(g);
    double step = -phi / slope2;
    const double length = fabs(step) * sqrt(slope2);
    if (length <= close_enough * s->diagonal) break;
    if (length > reach) step *= reach / length;
    const laves__vec3 next = v3_mad(x, g, step);
    const double phi_next = value(s, next);
    if (phi_next != 0 && (phi_next < 0) != (phi < 0)) {
      x = between(s, x, phi, next, phi_next);
      break;
    }
    if (v3_distance(next, p) > 2 * reach) return false;
    const bool gained = fabs(phi_next) < much * fabs(phi);
    x = next;
    phi = phi_next;
    if (phi == 0) break;
    if (!gained) g = gradient(s, x);
  }
  *foot = x;
  return true;
}

static bool project(const void *self, laves__vec3 point, double reach, uint32_t *hint, laves__vec3 *foot, laves__vec3 *normal) {
  const solid *s = self;
  *hint = LAVES__NO_HINT;
  const double phi = value(s, point);
  if (phi == 0) {
    *foot = point;
  } else {
    const laves__vec3 g = gradient(s, point);
    if (!has_slope(g)) return false;
    if ((!newton(s, point, phi, g, reach, foot) || v3_distance(point, *foot) > reach) &&
        !search(s, point, phi, v3_scale(v3_unit(g), phi < 0 ? 1 : -1), reach, foot))
      return false;
  }
  const laves__vec3 slope = gradient(s, *foot);
  *normal = v3_unit(slope);
  return has_slope(slope) && v3_distance(point, *foot) <= reach;
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

static void solid_free(laves_context *context, void *self) { laves__free(context, self, 1, sizeof(solid)); }

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
  if (!s) return laves__fail_memory(context, error);
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
