/* The numbers of rule.h. They were found by a search that raised the worst angle over all configurations; nothing but the
 * proof vouches for them. */
#include "stuff/rule.h"

#include "mesh/quality.h"

#define SHARE(n) ((n) / 8192.0)

/* clang-format off */

/* C15-S: inside and outside alike, every boundary vertex on the surface. */
static const laves__thresholds on_surface = {
    .alpha = {{{SHARE(2747), SHARE(3076)}, {SHARE(2558), SHARE(3178)}},
              {{SHARE(2747), SHARE(3076)}, {SHARE(2558), SHARE(3178)}}},
    .middle = {{0.5, 0.5}, {0.5, 0.5}},
};

/* C15-P: tuned for surfaces that are nearly plane; worse than C15-S until it is relaxed, and then better. */
static const laves__thresholds relaxed = {
    .alpha = {{{SHARE(3822), SHARE(3665)}, {SHARE(3573), SHARE(3932)}},
              {{SHARE(2658), SHARE(3062)}, {SHARE(2534), SHARE(3151)}}},
    .middle = {{SHARE(3645), SHARE(4492)}, {SHARE(3953), SHARE(4525)}},
};

/*   promised      proved         cosines of the proved                        thresholds   relaxation */
const laves__guarantee laves__guarantees[LAVES__GUARANTEES] = {
    {14.4, 149.65, 14.44, 149.60, 0.9684093068110037, -0.8625136692072575, &on_surface, 0},
    {20,   144,    20.01, 143.99, 0.9396329126977826, -0.808914394173963,  &relaxed,    SHARE(2206)},
    {22.5, 140,    22.51, 139.99, 0.9238127275812599, -0.7659322438502232, &relaxed,    SHARE(3245)},
    {24,   138,    24.01, 137.99, 0.9134744547927665, -0.7430280288371761, &relaxed,    SHARE(4185)},
    {28,   135,    28.01, 134.99, 0.8828656411661311, -0.706983357002373,  &relaxed,    1},
};

/* clang-format on */

const laves__guarantee *laves__guarantee_find(double min_dihedral) {
  int i = 0;
  while (i < LAVES__GUARANTEES - 1 && laves__guarantees[i].min_dihedral < min_dihedral) i++;
  return &laves__guarantees[i];
}

double laves__guarantee_margin(const laves__guarantee *g, const laves__vec3 corners[4]) {
  if (!(v3_det(corners[0], corners[1], corners[2], corners[3]) > 0)) return 0;
  double cosine[6], margin = 2;
  laves__tet_dihedral_cosines(corners, cosine);
  for (int e = 0; e < 6; e++) {
    const double low = (1 - cosine[e]) / (1 - g->cos_min), high = (1 + cosine[e]) / (1 + g->cos_max);
    if (!(low > margin)) margin = low;
    if (!(high > margin)) margin = high;
  }
  return margin;
}
