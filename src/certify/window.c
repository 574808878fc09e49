/* How far tets leave a window of dihedral angles and volume-length ratio. */
#include "certify/window.h"

#include "mesh/quality.h"

#define DEGREES 57.295779513082323

laves__window laves__window_make(double min_dihedral, double max_dihedral, double volume_length) {
  const double slack = 1e-9; /* of a cosine, far above its rounding and far below anything that matters */
  return (laves__window){min_dihedral, max_dihedral, volume_length, cos(min_dihedral / DEGREES) - slack,
                         cos(max_dihedral / DEGREES) + slack};
}

/* The part of the way from limit to end that value has gone; not positive within the limit. */
static double share(double value, double limit, double end) { return limit == end ? 0 : (value - limit) / (end - limit); }

double laves__window_badness(const laves__window *w, const laves__vec3 p[4], double *value) {
  double cosines[6], most = -INFINITY, least = INFINITY;
  laves__tet_dihedral_cosines(p, cosines);
  *value = 0;
  for (int i = 0; i < 6; i++) {
    if (!isfinite(cosines[i])) return LAVES__UNMEASURABLE;
    most = fmax(most, cosines[i]);
    least = fmin(least, cosines[i]);
  }
  const double ratio = laves__tet_volume_length(p);
  if (most < w->cos_least && least > w->cos_most && ratio >= w->volume_length) return 0;
  const double small = acos(fmin(1, most)) * DEGREES, large = acos(fmax(-1, least)) * DEGREES;
  const double below = share(small, w->min_dihedral, 0), above = share(large, w->max_dihedral, 180);
  const double thin = share(ratio, w->volume_length, 0);
  *value = above > 0 && above >= below ? large : below > 0 ? small : ratio;
  return fmax(fmax(below, above), thin);
}
