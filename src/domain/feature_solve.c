/* Points where one, two or three functions vanish.
 *
 * Gauss and Newton's method: each function is divided by the length of its gradient, so that values are distances, and
 * the step is the shortest that makes all linear models vanish. */
#include "domain/elementary.h"
#include "domain/feature_implicit.h"

/* A foot is within this fraction of the diagonal: near the rounding of coordinates. Where functions round worse, the
 * second is accepted. */
static const double solved = 1e-14, solved_worst = 1e-11;
enum { STEP_LIMIT = 24, HALVING_LIMIT = 12 };
/* How much of the promised decrease a step must keep. */
static const double sufficient_decrease = 1e-3;
/* The least volume (of the unit gradients) at which a meeting counts as one: planes at 0.006 degrees. */
static const double least_volume = 1e-4;

bool laves__tape_foot(const laves__tape *f, double diagonal, laves__vec3 start, double reach, laves__vec3 *foot,
                      laves__dual *there) {
  laves__vec3 p = start;
  laves__dual here = laves__tape_gradient(f, p);
  for (int steps = 0; steps < STEP_LIMIT; steps++) {
    const double slope2 = v3_norm2(here.gradient), distance = fabs(here.value) / sqrt(slope2);
    if (!(slope2 > 0) || !isfinite(distance)) return false;
    if (distance <= solved * diagonal) break;
    double share = distance > reach ? reach / distance : 1;
    const laves__vec3 step = v3_scale(here.gradient, -here.value / slope2);
    bool better = false;
    for (int halvings = 0; halvings < HALVING_LIMIT && !better; halvings++, share *= 0.5) {
      const laves__vec3 trial = v3_mad(p, step, share);
      const laves__dual at = laves__tape_gradient(f, trial);
      better = fabs(at.value) <= (1 - sufficient_decrease * share) * fabs(here.value);
      if (!better) continue;
      p = trial;
      here = at;
    }
    if (!better) break;
    if (v3_distance(p, start) > 2 * reach) return false;
  }
  *foot = p;
  *there = here;
  const double slope = v3_norm(here.gradient);
  return slope > 0 && fabs(here.value) <= solved_worst * diagonal * slope && v3_distance(p, start) <= reach;
}

/* The shortest step to where the planes n.x = -d meet; false when they are nearly parallel. */
static bool meet_planes(const laves__vec3 *n, const double *d, int count, laves__vec3 *step) {
  if (count == 1) {
    *step = v3_scale(n[0], -d[0]);
    return true;
  }
  const laves__vec3 along = v3_cross(n[0], n[1]);
  const double sine2 = v3_norm2(along);
  if (count == 2) {
    if (!(sine2 > least_volume * least_volume)) return false;
    /* -(d0 (n1 x along) + d1 (along x n0)) / |along|^2 */
    *step = v3_scale(v3_add(v3_scale(v3_cross(n[1], along), d[0]), v3_scale(v3_cross(along, n[0]), d[1])), -1 / sine2);
    return true;
  }
  const double volume = v3_dot(along, n[2]);
  if (!(fabs(volume) > least_volume)) return false;
  const laves__vec3 sum =
      v3_add(v3_add(v3_scale(v3_cross(n[1], n[2]), d[0]), v3_scale(v3_cross(n[2], n[0]), d[1])), v3_scale(along, d[2]));
  *step = v3_scale(sum, -1 / volume);
  return true;
}

/* Unit gradients and distances; false where one has no slope. The largest distance is returned in *most. */
static bool linearise(const laves__tape *const *f, int count, laves__vec3 p, laves__vec3 *n, double *d, double *most) {
  LAVES_ASSERT(count >= 1 && count <= 3);
  *most = 0;
  for (int i = 0; i < count; i++) {
    const laves__dual at = laves__tape_gradient(f[i], p);
    const double slope = v3_norm(at.gradient);
    n[i] = at.gradient;
    d[i] = at.value;
    if (at.value == 0 && slope == 0) continue; /* the tip of a root */
    if (!(slope > 0) || !isfinite(slope)) return false;
    n[i] = v3_scale(at.gradient, 1 / slope);
    d[i] = at.value / slope;
    *most = max_of(*most, fabs(d[i]));
  }
  return isfinite(*most);
}

bool laves__tapes_meet(const laves__tape *const *f, int count, double diagonal, double reach, laves__vec3 *p) {
  laves__vec3 n[3], step, here = *p, best = *p;
  double d[3], most, least = INFINITY;
  for (int steps = 0; steps < STEP_LIMIT; steps++) {
    if (!linearise(f, count, here, n, d, &most)) break;
    if (most < least) {
      least = most;
      best = here;
    } else if (steps > 2 && least <= solved_worst * diagonal) {
      break; /* only rounding is left */
    }
    if (most <= solved * diagonal) break;
    if (!meet_planes(n, d, count, &step)) break;
    const double length = v3_norm(step);
    here = v3_mad(here, step, length > reach ? reach / length : 1);
    if (!(v3_distance(here, *p) <= 2 * reach)) break;
  }
  if (!(least <= solved_worst * diagonal) || v3_distance(best, *p) > reach) return false;
  *p = best;
  return true;
}
