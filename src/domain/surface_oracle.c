/* Sign, distance and projection for surfaces.
 *
 * In: the surface, its tree, normals.  Out: the functions of the oracle.
 *
 * The distance is that to the nearest triangle, and its sign that of the offset from the nearest point along the normal of
 * the feature (face, edge or point) on which this point lies; the normals of edges and points are sums over their faces,
 * weighted by angle [baerentzen2005]. Points of one call start from the triangle of the point before them. A hint is a
 * slot of the tree. */
#include "domain/surface.h"

/* Directed outwards, not of length one. */
static laves__vec3 feature_normal(const laves__surface *s, uint32_t slot, int on) {
  if (on == LAVES__ON_FACE) return s->face_normals[slot];
  if (on >= LAVES__ON_CORNER) return s->point_normals[s->faces[slot][on - LAVES__ON_CORNER]];
  const uint32_t half = s->across[3 * (size_t)slot + (size_t)(on - LAVES__ON_EDGE)];
  const laves__vec3 n = s->face_normals[slot];
  return half == LAVES__NONE ? n : v3_add(n, s->face_normals[half / 3]);
}

/* The nearest triangle; `start` may be LAVES__NO_HINT. */
static laves__nearest nearest_from(const laves__surface *s, laves__vec3 p, double distance2, uint32_t start) {
  laves__nearest best = {distance2, LAVES__NONE};
  if (start < s->bvh.count) {
    const double d2 = laves__triangle_distance2(&s->bvh.triangles[start], p);
    if (d2 <= distance2) best = (laves__nearest){d2, start};
  }
  laves__bvh_nearest(&s->bvh, p, &best);
  return best;
}

/* Outside so far away that floats cannot tell triangles apart any triangle will do. */
static laves__nearest nearest(const laves__surface *s, laves__vec3 p, uint32_t start) {
  const laves__nearest best = nearest_from(s, p, INFINITY, start);
  if (best.slot != LAVES__NONE) return best;
  return (laves__nearest){laves__triangle_distance2(&s->bvh.triangles[0], p), 0};
}

static double signed_distance(const laves__surface *s, laves__vec3 p, const laves__nearest *n) {
  int on;
  const laves__vec3 foot = laves__triangle_closest(&s->bvh.triangles[n->slot], p, &on);
  const double distance = sqrt(n->distance2);
  return v3_dot(v3_sub(p, foot), feature_normal(s, n->slot, on)) < 0 ? -distance : distance;
}

static void evaluate(const void *self, size_t count, const laves__vec3 *points, double *phi, uint32_t *hints) {
  const laves__surface *s = self;
  uint32_t start = LAVES__NO_HINT;
  for (size_t i = 0; i < count; i++) {
    const laves__nearest n = nearest(s, points[i], start);
    phi[i] = signed_distance(s, points[i], &n);
    start = n.slot;
    if (hints) hints[i] = n.slot;
  }
}

static bool project(const void *self, laves__vec3 point, double reach, uint32_t *hint, laves__vec3 *foot, laves__vec3 *normal) {
  const laves__surface *s = self;
  const laves__nearest n = nearest_from(s, point, reach * reach, *hint);
  if (n.slot == LAVES__NONE) return false;
  int on;
  *foot = laves__triangle_closest(&s->bvh.triangles[n.slot], point, &on);
  *normal = v3_unit(feature_normal(s, n.slot, on));
  *hint = n.slot;
  return true;
}

static laves__side side(const void *self, laves__vec3 centre, double radius, laves__vec3 half) {
  double phi;
  evaluate(self, 1, &centre, &phi, NULL);
  const double reach = fmin(radius, v3_norm(half));
  /* The margin is for the rounding of distances. */
  if (!(fabs(phi) > reach * (1 + 1e-9))) return LAVES__UNDECIDED;
  return phi < 0 ? LAVES__INSIDE : LAVES__OUTSIDE;
}

static int32_t tag(const void *self, laves__vec3 foot, uint32_t hint) {
  const laves__surface *s = self;
  (void)foot;
  return s->tags && hint < s->face_count ? s->tags[hint] : 0;
}

void laves__surface_oracle(laves__surface *s, laves__oracle *oracle) {
  oracle->self = s;
  oracle->is_distance = true;
  oracle->evaluate = evaluate;
  oracle->project = project;
  oracle->side = side;
  oracle->tag = s->tags ? tag : NULL;
  oracle->free = laves__surface_free;
}

void laves__surface_free(laves_context *context, void *self) {
  laves__surface *s = self;
  if (!s) return;
  laves__bvh_free(context, &s->bvh);
  laves__free(context, s->points, s->point_capacity, sizeof *s->points);
  laves__free(context, s->faces, s->face_capacity, sizeof *s->faces);
  laves__free(context, s->tags, s->face_capacity, sizeof *s->tags);
  laves__free(context, s->across, 3 * s->face_capacity, sizeof *s->across);
  laves__free(context, s->face_normals, s->face_capacity, sizeof *s->face_normals);
  laves__free(context, s->point_normals, s->point_capacity, sizeof *s->point_normals);
  laves__free(context, s, 1, sizeof *s);
}
