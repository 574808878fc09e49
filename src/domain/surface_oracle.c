/* Sign, distance and projection for surfaces.
 *
 * In: the surface, its tree, normals.  Out: the functions of the oracle.
 *
 * The distance is that to the nearest triangle, and its sign that of the offset from the nearest point along the normal of
 * the feature (face, edge or point) on which this point lies; the normals of edges and points are sums over their faces,
 * weighted by angle [baerentzen2005]. Points of one call start from the triangle of the point before them. A hint is a
 * slot of the tree. */
#include "domain/features.h"
#include "domain/surface.h"

/* How far from a face's point towards its middle the winding number is asked, in parts of the way: far more than rounding,
 * far less than what a mesh resolves. */
static const double inwards = 1e-4;

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

/* Distance to a surface so far away that floats cannot tell its triangles apart, nor squares be formed. */
static double far_distance(laves__vec3 p) {
  const double most = fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z)));
  return most * v3_norm(v3_scale(p, 1 / most));
}

/* ---- where the winding number decides ---- */

static uint32_t winding_slot(const laves__surface *s, uint32_t slot) { return s->winding_slot ? s->winding_slot[slot] : slot; }

/* Whether the normal at this feature cannot be trusted with the sign. */
static bool is_doubtful(const laves__surface *s, uint32_t slot, int on) {
  if (!s->needs_winding) return false;
  if ((s->face_flags[slot] & LAVES__PARTIAL) != 0) return true;
  if (on == LAVES__ON_FACE) return false;
  if (on >= LAVES__ON_CORNER) return s->doubtful_points[s->faces[slot][on - LAVES__ON_CORNER]];
  const uint32_t half = s->across[3 * (size_t)slot + (size_t)(on - LAVES__ON_EDGE)];
  return half == LAVES__NONE || (s->face_flags[half / 3] & LAVES__PARTIAL) != 0;
}

static bool is_inside(const laves__surface *s, laves__vec3 p) {
  return laves__winding_number(&s->winding, p, LAVES__NONE, LAVES__NONE) > s->level;
}

/* Whether a partial face bounds the solid at its point q. With the face left out the number is the mean of both sides, so
 * 1/2 says outside before and inside behind. The question is asked a little inwards, off the edges. */
bool laves__surface_bounds_at(const laves__surface *s, uint32_t slot, laves__vec3 q) {
  if (!(s->face_flags[slot] & LAVES__PARTIAL)) return true;
  const laves__triangle *t = &s->bvh.triangles[slot];
  const laves__vec3 middle = v3_scale(v3_add(t->a, v3_add(t->b, t->c)), 1.0 / 3);
  const double mean = laves__winding_number(&s->winding, v3_lerp(q, middle, inwards), winding_slot(s, slot), LAVES__NONE);
  return fabs(mean - s->level) < 0.5;
}

/* The same for a point of the segment where two faces meet; here the mean is that of four sides, of -1 to 1 about it. */
static bool bounds_at_crossing(const laves__surface *s, uint32_t slot, uint32_t other, laves__vec3 q) {
  const double mean = laves__winding_number(&s->winding, q, winding_slot(s, slot), winding_slot(s, other));
  return fabs(mean - s->level) < 1;
}

static laves__vec3 closest_on_segment(const laves__segment *g, laves__vec3 p) {
  const laves__vec3 uv = v3_sub(g->ends[1], g->ends[0]);
  const double t = v3_dot(v3_sub(p, g->ends[0]), uv) / v3_norm2(uv);
  return t > 0 ? v3_lerp(g->ends[0], g->ends[1], t < 1 ? t : 1) : g->ends[0];
}

/* The closest point of what counts of a face: its own closest point, or one where it meets others. `other` receives the
 * face met there, or LAVES__NONE. Squared distance; INFINITY when nothing counts. */
static double closest_part(const laves__surface *s, uint32_t slot, laves__vec3 p, laves__vec3 *foot, int *on, uint32_t *other) {
  *foot = laves__triangle_closest(&s->bvh.triangles[slot], p, on);
  *other = LAVES__NONE;
  if (laves__surface_bounds_at(s, slot, *foot)) return v3_norm2(v3_sub(p, *foot));
  double least = INFINITY;
  for (uint32_t i = s->segment_starts[slot]; i < s->segment_starts[slot + 1]; i++) {
    const laves__segment *g = &s->segments[i];
    const laves__vec3 q = closest_on_segment(g, p);
    const double d2 = v3_norm2(v3_sub(p, q));
    if (d2 >= least || !bounds_at_crossing(s, slot, g->other, q)) continue;
    least = d2;
    *foot = q;
    *other = g->other;
  }
  return least;
}

static double measure_part(void *user, uint32_t slot, double distance2, laves__vec3 p) {
  const laves__surface *s = user;
  if (!s->needs_winding || !(s->face_flags[slot] & LAVES__PARTIAL)) return distance2;
  laves__vec3 foot;
  int on;
  uint32_t other;
  return closest_part(s, slot, p, &foot, &on, &other);
}

/* Like nearest_from, with hidden parts of partial faces left out. */
static laves__nearest nearest_part(const laves__surface *s, laves__vec3 p, double distance2) {
  laves__nearest best = {distance2, LAVES__NONE};
  laves__bvh_nearest_part(&s->bvh, p, measure_part, (void *)s, &best);
  return best;
}

static double signed_distance_by_winding(const laves__surface *s, laves__vec3 p, const laves__nearest *n) {
  laves__nearest part = *n;
  if ((s->face_flags[n->slot] & LAVES__PARTIAL) != 0) part = nearest_part(s, p, INFINITY);
  const double distance = sqrt(part.slot == LAVES__NONE ? n->distance2 : part.distance2);
  return is_inside(s, p) ? -distance : distance;
}

/* ---- open surfaces ---- */

/* Whether the nearest point lies amid plain faces, far from the rim: then the surface is as good as a closed one here. */
static bool is_plain(const laves__surface *s, laves__vec3 p, const laves__nearest *n, int on) {
  if (!(s->face_flags[n->slot] & LAVES__PLAIN)) return false;
  if (on >= LAVES__ON_CORNER && s->doubtful_points[s->faces[n->slot][on - LAVES__ON_CORNER]]) return false;
  if (on >= LAVES__ON_EDGE && on < LAVES__ON_CORNER) {
    const uint32_t half = s->across[3 * (size_t)n->slot + (size_t)(on - LAVES__ON_EDGE)];
    if (half == LAVES__NONE || !(s->face_flags[half / 3] & LAVES__PLAIN)) return false;
  }
  return laves__open_rim_is_far(s, p, sqrt(n->distance2));
}

/* Away from plain faces: the sign of w - 1/2, and the lesser of the distances to triangles (whole ones: hidden parts only make it
 * smaller) and caps. */
static double open_value(const laves__surface *s, laves__vec3 p, const laves__nearest *n) {
  const double e = laves__open_excess(s, p), distance = sqrt(n->distance2);
  const double value = fmin(distance, laves__open_cap_distance(s, p, e, distance));
  return e > 0 ? -value : value;
}

/* Away from plain faces: the nearer of triangles and caps. */
static bool open_project(const laves__surface *s, laves__vec3 p, double reach, uint32_t *hint, laves__vec3 *foot,
                         laves__vec3 *normal) {
  const laves__nearest n = nearest_part(s, p, reach * reach);
  const double e = laves__open_excess(s, p), distance = n.slot == LAVES__NONE ? reach : sqrt(n.distance2);
  laves__vec3 uphill;
  const double guess = laves__open_cap_guess(s, p, e, distance, &uphill);
  *hint = n.slot;
  if (guess < distance && laves__open_project(s, p, e, guess, uphill, distance, foot, normal)) return true;
  if (n.slot == LAVES__NONE) return false;
  int on;
  uint32_t other;
  closest_part(s, n.slot, p, foot, &on, &other);
  *normal = s->face_normals[n.slot];
  return true;
}

static laves__side open_side(const laves__surface *s, laves__vec3 p, double reach) {
  const double e = laves__open_excess(s, p);
  if (!laves__open_ball_is_certain(s, p, e, reach)) return LAVES__UNDECIDED;
  return e > 0 ? LAVES__INSIDE : LAVES__OUTSIDE;
}

/* ---- the oracle ---- */

static double signed_distance(const laves__surface *s, laves__vec3 p, const laves__nearest *n) {
  int on;
  const laves__vec3 foot = laves__triangle_closest(&s->bvh.triangles[n->slot], p, &on);
  if (s->open) {
    if (!is_plain(s, p, n, on)) return open_value(s, p, n);
  } else if (is_doubtful(s, n->slot, on)) {
    return signed_distance_by_winding(s, p, n);
  }
  const double distance = sqrt(n->distance2);
  return v3_dot(v3_sub(p, foot), feature_normal(s, n->slot, on)) < 0 ? -distance : distance;
}

static void evaluate(const void *self, size_t count, const laves__vec3 *points, double *phi, uint32_t *hints) {
  const laves__surface *s = self;
  uint32_t start = LAVES__NO_HINT;
  for (size_t i = 0; i < count; i++) {
    const laves__nearest n = nearest_from(s, points[i], INFINITY, start);
    phi[i] = n.slot == LAVES__NONE ? far_distance(points[i]) : signed_distance(s, points[i], &n);
    start = n.slot;
    if (hints) hints[i] = n.slot;
  }
}

static bool project(const void *self, laves__vec3 point, double reach, uint32_t *hint, laves__vec3 *foot, laves__vec3 *normal) {
  const laves__surface *s = self;
  laves__nearest n = nearest_from(s, point, reach * reach, *hint);
  if (n.slot == LAVES__NONE) return s->open && open_project(s, point, reach, hint, foot, normal);
  int on;
  uint32_t other = LAVES__NONE;
  if (s->open) {
    *foot = laves__triangle_closest(&s->bvh.triangles[n.slot], point, &on);
    if (!is_plain(s, point, &n, on)) return open_project(s, point, reach, hint, foot, normal);
  } else if (s->needs_winding && (s->face_flags[n.slot] & LAVES__PARTIAL) != 0) {
    n = nearest_part(s, point, reach * reach);
    if (n.slot == LAVES__NONE) return false;
    closest_part(s, n.slot, point, foot, &on, &other);
  } else {
    *foot = laves__triangle_closest(&s->bvh.triangles[n.slot], point, &on);
  }
  const laves__vec3 n0 = feature_normal(s, n.slot, on);
  *normal = v3_unit(other == LAVES__NONE ? n0 : v3_add(s->face_normals[n.slot], s->face_normals[other]));
  *hint = n.slot;
  return true;
}

/* ---- parts ---- */

typedef struct part_search {
  const laves__surface *surface;
  const laves__part *part;
} part_search;

static bool belongs(const laves__part *part, uint32_t slot) {
  return laves__patches_join(part->features, part->label[slot], part->wanted);
}

static double measure_labelled(void *user, uint32_t slot, double distance2, laves__vec3 p) {
  const part_search *search = user;
  if (!belongs(search->part, slot)) return INFINITY;
  return measure_part((void *)search->surface, slot, distance2, p);
}

/* At a point of a face: that of the face, or the mean over an edge or about a point where the part goes on. */
static laves__vec3 part_normal(const laves__surface *s, const laves__part *part, uint32_t slot, int on) {
  if (on == LAVES__ON_FACE) return s->face_normals[slot];
  if (on >= LAVES__ON_CORNER)
    return part->on_border[s->faces[slot][on - LAVES__ON_CORNER]] ? s->face_normals[slot] : feature_normal(s, slot, on);
  const uint32_t half = s->across[3 * (size_t)slot + (size_t)(on - LAVES__ON_EDGE)];
  return half != LAVES__NONE && belongs(part, half / 3) ? feature_normal(s, slot, on) : s->face_normals[slot];
}

/* The nearest face of all is tried first: mostly it is one of the part, and that search is the quicker one. */
bool laves__surface_project_part(const laves__surface *s, const laves__part *part, laves__vec3 point, double reach,
                                 uint32_t *hint, laves__vec3 *foot, laves__vec3 *normal) {
  const part_search search = {s, part};
  laves__nearest n = nearest_from(s, point, reach * reach, *hint);
  if (n.slot == LAVES__NONE) return false;
  if (!belongs(part, n.slot) || (s->needs_winding && (s->face_flags[n.slot] & LAVES__PARTIAL))) {
    n = (laves__nearest){reach * reach, LAVES__NONE};
    laves__bvh_nearest_part(&s->bvh, point, measure_labelled, (void *)&search, &n);
    if (n.slot == LAVES__NONE) return false;
  }
  int on;
  uint32_t other = LAVES__NONE;
  if (s->needs_winding && (s->face_flags[n.slot] & LAVES__PARTIAL))
    closest_part(s, n.slot, point, foot, &on, &other);
  else
    *foot = laves__triangle_closest(&s->bvh.triangles[n.slot], point, &on);
  *normal = v3_unit(other == LAVES__NONE ? part_normal(s, part, n.slot, on) : s->face_normals[n.slot]);
  *hint = n.slot;
  return true;
}

static laves__side side(const void *self, laves__vec3 centre, double radius, laves__vec3 half) {
  const laves__surface *s = self;
  const double reach = fmin(radius, v3_norm(half));
  if (s->open) return open_side(s, centre, reach);
  double phi;
  evaluate(self, 1, &centre, &phi, NULL);
  /* The margin is for the rounding of distances. */
  if (!(fabs(phi) > reach * (1 + 1e-9))) return LAVES__UNDECIDED;
  return phi < 0 ? LAVES__INSIDE : LAVES__OUTSIDE;
}

static int32_t tag(const void *self, laves__vec3 foot, uint32_t hint) {
  const laves__surface *s = self;
  (void)foot;
  return s->tags && hint < s->face_count ? s->tags[hint] : 0;
}

static int32_t source(const void *self, laves__vec3 foot, uint32_t hint) {
  const laves__surface *s = self;
  (void)foot;
  return hint < s->face_count ? (int32_t)s->sources[hint] : -1;
}

static void flat_face(const void *self, size_t face, laves__vec3 corners[3]) {
  const laves__triangle *t = &((const laves__surface *)self)->bvh.triangles[face];
  corners[0] = t->a;
  corners[1] = t->b;
  corners[2] = t->c;
}

void laves__surface_oracle(laves__surface *s, laves__oracle *oracle) {
  oracle->self = s;
  oracle->is_distance = !s->open;
  oracle->evaluate = evaluate;
  oracle->project = project;
  oracle->side = side;
  oracle->tag = s->tags ? tag : NULL;
  oracle->source = source;
  oracle->sample = laves__surface_sample;
  oracle->surface = s;
  if (!s->open) oracle->find_features = laves__features_of_surface;
  if (!s->open && !s->needs_winding) {
    oracle->flat_face_count = s->face_count;
    oracle->flat_face = flat_face;
  }
  oracle->thin_places = laves__surface_thin_places;
  oracle->free = laves__surface_free;
}

void laves__surface_free(laves_context *context, void *self) {
  laves__surface *s = self;
  if (!s) return;
  laves__bvh_free(context, &s->bvh);
  laves__free(context, s->points, s->point_capacity, sizeof *s->points);
  laves__free(context, s->faces, s->face_capacity, sizeof *s->faces);
  laves__free(context, s->tags, s->face_capacity, sizeof *s->tags);
  laves__free(context, s->sources, s->face_capacity, sizeof *s->sources);
  laves__free(context, s->part, s->part_capacity, sizeof *s->part);
  laves__free(context, s->part_tag, s->part_count, sizeof *s->part_tag);
  laves__free(context, s->part_closed, s->part_count, sizeof *s->part_closed);
  laves__free(context, s->across, 3 * s->face_capacity, sizeof *s->across);
  laves__winding_free(context, &s->winding);
  laves__free(context, s->rim_lengths, s->rim_tree.node_capacity, sizeof *s->rim_lengths);
  laves__bvh_free(context, &s->rim_tree);
  laves__free(context, s->rim, s->rim_capacity, sizeof *s->rim);
  laves__bvh_free(context, &s->all);
  laves__free(context, s->face_flags, s->face_capacity, sizeof *s->face_flags);
  laves__free(context, s->doubtful_points, s->point_capacity, sizeof *s->doubtful_points);
  laves__free(context, s->winding_slot, s->face_capacity, sizeof *s->winding_slot);
  laves__free(context, s->segments, s->segment_count, sizeof *s->segments);
  laves__free(context, s->segment_starts, s->face_capacity + 1, sizeof *s->segment_starts);
  laves__free(context, s->face_normals, s->face_capacity, sizeof *s->face_normals);
  laves__free(context, s->point_normals, s->point_capacity, sizeof *s->point_normals);
  laves__free(context, s, 1, sizeof *s);
}
