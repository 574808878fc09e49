/* How thick the walls of the solid are, and how wide the gaps between them.
 *
 * In: a piece of the surface.  Out: the way to the surface met first along its normal, inwards through the wall or outwards
 * across the gap, where the surface there faces the other way; a blunt wedge does not count.
 *
 * Triangles are met by rays; those that bound nothing at that place are passed. Elsewhere phi is followed: where it is a
 * distance, by steps of its value, which cannot pass the surface; else by steps that grow up to a quarter of the size, within
 * which a wall thinner than a step can be missed. The crossing is then halved down. */
#include "size/size_parts.h"

/* The other side faces back when the cosine between the normals is below this: to within 37 degrees, as for thin places. Wedges
 * are thin at every edge, and only the floor would end their refinement. */
static const double opposed = -0.8;
/* First step, and least of all, in parts of the floor of sizes; largest one where phi is no distance, in sizes. */
static const double least_step = 0.25, largest_step = 0.25;
/* Steps grow by this factor where nothing tells how far the surface is. */
static const double step_growth = 1.5;
enum { STEPS_MAX = 2000, HALVINGS = 30, FACES_PASSED = 16 };

/* ---- rays ---- */

static double shoot(const laves__surface *s, const laves__patch *p, laves__vec3 direction, double reach) {
  double way = 0;
  uint32_t skip = p->face;
  for (int i = 0; i < FACES_PASSED; i++) {
    const laves__vec3 start = v3_mad(p->point, direction, way);
    laves__hit hit = {reach - way, LAVES__NONE};
    laves__bvh_shoot(&s->bvh, start, direction, skip, &hit);
    if (hit.slot == LAVES__NONE) return INFINITY;
    way += hit.distance;
    skip = hit.slot;
    if (!laves__surface_bounds_at(s, hit.slot, v3_mad(start, direction, hit.distance))) continue;
    return way > 0 && v3_dot(laves__face_normal(s, hit.slot), p->normal) < opposed ? way : INFINITY;
  }
  return INFINITY;
}

/* ---- steps ---- */

static double phi_at(const laves__oracle *oracle, laves__vec3 p) {
  double phi;
  oracle->evaluate(oracle->self, 1, &p, &phi, NULL);
  return phi;
}

/* Where phi changes its sign between the ways low and high from the start. */
static double halve(const laves__oracle *oracle, laves__vec3 start, laves__vec3 direction, double low, double high, bool inside) {
  for (int i = 0; i < HALVINGS; i++) {
    const double middle = 0.5 * (low + high);
    if ((phi_at(oracle, v3_mad(start, direction, middle)) < 0) == inside)
      low = middle;
    else
      high = middle;
  }
  return 0.5 * (low + high);
}

/* The way through the inside, or through the outside, to the next surface; INFINITY when there is none within reach. */
static double march(const laves__size *size, laves__vec3 start, laves__vec3 direction, double reach, bool inside) {
  const laves__oracle *oracle = size->oracle;
  const double least = least_step * size->floor;
  double way = least, before = 0, step = least;
  for (int i = 0; i < STEPS_MAX && before < reach; i++) {
    const double phi = phi_at(oracle, v3_mad(start, direction, way));
    if ((phi < 0) != inside) return before > 0 ? halve(oracle, start, direction, before, way, inside) : INFINITY;
    step = oracle->is_distance ? fmax(least, fabs(phi)) : fmin(step_growth * step, largest_step * size->base);
    before = way;
    way += step;
  }
  return INFINITY;
}

static double follow(const laves__size *size, const laves__patch *p, laves__vec3 direction, double reach, bool inside) {
  const laves__oracle *oracle = size->oracle;
  const double way = march(size, p->point, direction, reach, inside);
  if (!(way < reach)) return INFINITY;
  uint32_t hint = LAVES__NO_HINT;
  laves__vec3 foot, normal;
  if (!oracle->project(oracle->self, v3_mad(p->point, direction, way), way, &hint, &foot, &normal)) return INFINITY;
  return v3_dot(normal, p->normal) < opposed ? way : INFINITY;
}

double laves__thickness_at(const laves__size *size, const laves__patch *p, double reach) {
  const laves__surface *s = size->oracle->surface;
  const laves__vec3 inwards = v3_scale(p->normal, -1);
  if (s) return fmin(shoot(s, p, inwards, reach), shoot(s, p, p->normal, reach));
  return fmin(follow(size, p, inwards, reach, true), follow(size, p, p->normal, reach, false));
}
