/* How sharply a domain's surface bends near a place, as seen at the scale of a mesh.
 *
 * The place and fourteen points around it (along the axes and the diagonals of space) are projected on to the surface.
 * Two feet at distance d on a circle of radius R have unit normals that differ by d / R, so every pair of feet estimates
 * a radius; the smallest is the answer. Pairs closer together than a quarter of the scale are left out: they would see
 * the facets of a finely triangulated surface instead of its shape. A crease gives about a quarter of the scale. */
#include "certify/certify.h"

enum { DIRECTIONS = 14 };

/* Feet further than this from the place, in units of the scale, are no longer near by. */
#define NEAR 1.5
/* The least distance of a pair, in units of the scale. */
#define PAIR_MIN 0.25
/* Normals that differ by less are parallel but for rounding. */
#define PARALLEL 1e-9

typedef struct foot {
  laves__vec3 point, normal;
} foot;

static const int8_t directions[DIRECTIONS][3] = {{1, 0, 0},  {-1, 0, 0},  {0, 1, 0},   {0, -1, 0},  {0, 0, 1},
                                                 {0, 0, -1}, {1, 1, 1},   {1, 1, -1},  {1, -1, 1},  {1, -1, -1},
                                                 {-1, 1, 1}, {-1, 1, -1}, {-1, -1, 1}, {-1, -1, -1}};

static int collect_feet(const laves__oracle *oracle, laves__vec3 local, double scale, foot feet[DIRECTIONS + 1]) {
  int count = 0;
  uint32_t hint = LAVES__NO_HINT;
  for (int i = -1; i < DIRECTIONS; i++) {
    laves__vec3 p = local;
    if (i >= 0) p = v3_mad(p, v3_unit(v3(directions[i][0], directions[i][1], directions[i][2])), scale);
    if (!oracle->project(oracle->self, p, NEAR * scale, &hint, &feet[count].point, &feet[count].normal)) continue;
    if (v3_distance(feet[count].point, local) <= NEAR * scale) count++;
  }
  return count;
}

double laves__curvature_radius(const laves_domain *domain, laves__vec3 point, double reach) {
  foot feet[DIRECTIONS + 1];
  double least = INFINITY;
  if (!v3_finite(point) || !(reach > 0) || !isfinite(reach)) return INFINITY;
  const int count = collect_feet(&domain->oracle, v3_sub(point, domain->oracle.origin), reach, feet);
  for (int i = 0; i < count; i++)
    for (int j = 0; j < i; j++) {
      const double apart = v3_distance(feet[i].point, feet[j].point);
      const double turn = v3_distance(feet[i].normal, feet[j].normal);
      if (apart >= PAIR_MIN * reach && turn > PARALLEL) least = fmin(least, apart / turn);
    }
  return least;
}
