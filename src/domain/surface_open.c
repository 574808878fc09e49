/* Surfaces that stay open: the solid is where the generalised winding number exceeds one half.
 *
 * In: a mended surface with its tree, winding number and rim (the edges not used as often forwards as backwards).
 * Out: which triangles bound the solid, and distance, projection and side for it.
 *
 * Across a triangle the winding number drops by one, so where the mean of both sides lies between 0 and 1 the triangle bounds the
 * solid; elsewhere it is a wall inside or a sheet outside. Away from triangles the number is smooth; there {w = 1/2} closes the
 * holes. Its gradient is a line integral over the rim alone (the law of Biot and Savart), so
 *
 *   |grad w| <= L / (4 pi rho^2)   at distance rho from a rim of length L,
 *
 * which tells how far a ball without triangles is certain to stay on its side. How far the cap of a hole is, is
 * estimated as |w - 1/2| / |grad w|, and only where the rim is near enough to matter. */
#include <string.h>

#include "domain/surface.h"

static const double four_pi = 12.566370614359172;
/* More than the error of the expansion of far nodes. */
static const double winding_error = 0.01;
/* Steps of the central differences in parts of the distance to the rim; the number changes on that scale. */
static const double difference_step = 0.05;
/* A start this near to one half is on the cap already. */
static const double on_cap = 1e-9;

enum { SAMPLES = 32, BISECTIONS = 50, EXPANSIONS = 6, LONG_RIM = 1024 };

/* ---- building ---- */

/* Counts at how many of four places of a face, its middle and near its corners, the face bounds the solid. */
static int places_that_bound(const laves__surface *s, uint32_t f) {
  const laves__triangle *t = &s->bvh.triangles[f];
  const laves__vec3 middle = v3_scale(v3_add(t->a, v3_add(t->b, t->c)), 1.0 / 3);
  const laves__vec3 places[4] = {middle, v3_lerp(t->a, middle, 0.1), v3_lerp(t->b, middle, 0.1), v3_lerp(t->c, middle, 0.1)};
  int count = 0;
  for (int k = 0; k < 4; k++) {
    const double mean = laves__winding_number(&s->winding, places[k], f, LAVES__NONE);
    count += mean > 0 && mean < 1;
  }
  return count;
}

typedef struct judgement {
  laves__surface *s;
  bool *keep;
} judgement;

static void judge_faces(void *user, size_t begin, size_t end, int worker) {
  judgement *j = user;
  (void)worker;
  for (size_t f = begin; f < end; f++) {
    const int count = places_that_bound(j->s, (uint32_t)f);
    j->keep[f] = count > 0 || (j->s->face_flags[f] & LAVES__PARTIAL);
    if (count < 4) j->s->face_flags[f] |= LAVES__PARTIAL;
  }
}

bool laves__surface_judge_open(laves__surface *s, bool *keep) {
  judgement j = {s, keep};
  return laves__parallel_for(s->context, "surface", s->face_count, 64, judge_faces, &j);
}

bool laves__surface_build_rim(laves__surface *s) {
  bool done = false;
  const size_t count = s->rim_count;
  uint32_t(*edges)[3] = laves__alloc(s->context, count, sizeof *edges);
  uint32_t *order = laves__alloc(s->context, count, sizeof *order);
  if (edges && order) {
    s->rim_length = 0;
    for (size_t i = 0; i < count; i++) {
      const uint32_t half = s->rim[i];
      edges[i][0] = s->faces[half / 3][half % 3];
      edges[i][1] = edges[i][2] = s->faces[half / 3][(half % 3 + 1) % 3];
      s->rim_length += v3_distance(s->points[edges[i][0]], s->points[edges[i][1]]);
    }
    done = laves__bvh_build(s->context, s->points, (const uint32_t(*)[3])edges, count, order, &s->rim_tree);
  }
  laves__free(s->context, edges, count, sizeof *edges);
  laves__free(s->context, order, count, sizeof *order);
  return done;
}

typedef struct sampling {
  const laves__surface *s;
  laves__box3 box;
  uint32_t *inside; /* [SAMPLES] for each layer */
} sampling;

static void sample_layers(void *user, size_t begin, size_t end, int worker) {
  sampling *m = user;
  (void)worker;
  const laves__vec3 width = v3_scale(v3_sub(m->box.upper, m->box.lower), 1.0 / SAMPLES);
  for (size_t k = begin; k < end; k++) {
    m->inside[k] = 0;
    for (int i = 0; i < SAMPLES * SAMPLES; i++) {
      const laves__vec3 at = v3(((double)k + 0.5) * width.x, (i / SAMPLES + 0.5) * width.y, (i % SAMPLES + 0.5) * width.z);
      m->inside[k] += laves__winding_number(&m->s->winding, v3_add(m->box.lower, at), LAVES__NONE, LAVES__NONE) > 0.5;
    }
  }
}

double laves__surface_inside_share(const laves__surface *s, laves__box3 box) {
  uint32_t inside[SAMPLES] = {0}, sum = 0;
  sampling m = {s, box, inside};
  laves__parallel_for(s->context, "surface", SAMPLES, 1, sample_layers, &m);
  for (int k = 0; k < SAMPLES; k++) sum += inside[k];
  return (double)sum / (SAMPLES * SAMPLES * SAMPLES);
}

/* ---- asking ---- */

static double excess(const laves__surface *s, laves__vec3 p) {
  return laves__winding_number(&s->winding, p, LAVES__NONE, LAVES__NONE) - 0.5;
}

static double rim_distance(const laves__surface *s, laves__vec3 p, double reach) {
  laves__nearest n = {reach * reach, LAVES__NONE};
  laves__bvh_nearest(&s->rim_tree, p, &n);
  return n.slot == LAVES__NONE ? reach : sqrt(n.distance2);
}

/* Exact, in time that grows with the rim. With u and v the offsets of the ends of an edge, its part is
 * (u x v) (|u| + |v|) / (|u| |v| (|u| |v| + u.v)) / 4 pi. */
static laves__vec3 gradient_by_rim(const laves__surface *s, laves__vec3 p) {
  laves__vec3 sum = v3(0, 0, 0);
  for (size_t i = 0; i < s->rim_tree.count; i++) {
    const laves__triangle *edge = &s->rim_tree.triangles[i];
    const laves__vec3 u = v3_sub(edge->a, p), v = v3_sub(edge->b, p);
    const double lu = v3_norm(u), lv = v3_norm(v), bottom = lu * lv * (lu * lv + v3_dot(u, v));
    if (bottom > 0) sum = v3_mad(sum, v3_cross(u, v), (lu + lv) / bottom);
  }
  return v3_scale(sum, 1 / four_pi);
}

/* By central differences, for rims so long that this is quicker. */
static laves__vec3 gradient_by_differences(const laves__surface *s, laves__vec3 p, double step) {
  const double h = 0.5 / step;
  return v3(h * (excess(s, v3(p.x + step, p.y, p.z)) - excess(s, v3(p.x - step, p.y, p.z))),
            h * (excess(s, v3(p.x, p.y + step, p.z)) - excess(s, v3(p.x, p.y - step, p.z))),
            h * (excess(s, v3(p.x, p.y, p.z + step)) - excess(s, v3(p.x, p.y, p.z - step))));
}

double laves__open_cap_distance(const laves__surface *s, laves__vec3 p, double e, double distance, laves__vec3 *uphill) {
  const double e_abs = fabs(e);
  if (s->rim_tree.count == 0 || !(e_abs < 0.5)) return INFINITY;
  /* Beside a straight rim the number grows with the angle, so the cap is at most 2 pi e rho away, and nearer nowhere by much. */
  const double enough = distance / (e_abs > 1e-3 ? e_abs : 1e-3);
  const double rim = rim_distance(s, p, enough);
  if (2 * e_abs * rim >= distance) return INFINITY;
  /* Differences must not reach over a triangle, where the number jumps. */
  const laves__vec3 g = s->rim_tree.count <= LONG_RIM ? gradient_by_rim(s, p)
                                                      : gradient_by_differences(s, p, difference_step * fmin(rim, distance));
  const double slope = v3_norm(g);
  if (!(slope > 0)) return INFINITY;
  *uphill = v3_scale(g, 1 / slope);
  return e_abs / slope;
}

double laves__open_excess(const laves__surface *s, laves__vec3 p) { return excess(s, p); }

bool laves__open_project(const laves__surface *s, laves__vec3 p, double e, double guess, laves__vec3 uphill, double reach,
                         laves__vec3 *foot, laves__vec3 *normal) {
  *normal = v3_scale(uphill, -1);
  *foot = p;
  if (fabs(e) < on_cap) return true;
  const laves__vec3 direction = e > 0 ? *normal : uphill;
  double low = 0, high = guess;
  int tries = 0;
  while ((excess(s, v3_mad(p, direction, high)) > 0) == (e > 0)) {
    low = high;
    high *= 1.5;
    if (++tries > EXPANSIONS || low > reach) return false;
  }
  for (int i = 0; i < BISECTIONS && high - low > 1e-12 * s->diagonal; i++) {
    const double middle = 0.5 * (low + high);
    if ((excess(s, v3_mad(p, direction, middle)) > 0) == (e > 0))
      low = middle;
    else
      high = middle;
  }
  *foot = v3_mad(p, direction, 0.5 * (low + high));
  return 0.5 * (low + high) <= reach;
}

bool laves__open_ball_is_certain(const laves__surface *s, laves__vec3 p, double e, double radius) {
  if (s->rim_tree.count == 0) return fabs(e) > winding_error;
  const double rho = rim_distance(s, p, 1e3 * s->diagonal) - radius;
  if (!(rho > 0)) return false;
  return fabs(e) > radius * s->rim_length / (four_pi * rho * rho) + winding_error;
}
