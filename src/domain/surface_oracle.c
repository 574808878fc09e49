/* Sign, distance and projection for surfaces.
 *
 * In: the surface, its tree, normals.  Out: the functions of the oracle.
 *
 * The distance is that to the nearest triangle, and its sign that of the offset from the nearest point along the normal of
 * the feature (face, edge or point) on which this point lies; the normals of edges and points are sums over their faces,
 * weighted by angle [baerentzen2005]. Points of one call start from the triangle of the point before them, the first from the
 * hint that is handed in. A hint is a slot of the tree. */
#include "domain/features.h"
#include "domain/surface.h"

/* A point of a face is on a piece of it that is so near, as a share of the diagonal: more than rounding, less than matters. */
static const double on_piece = 1e-9;

/* Directed outwards, not of length one. */
static laves__vec3 feature_normal(const laves__surface *s, uint32_t slot, int on) {
  if (on == LAVES__ON_FACE) return laves__face_normal(s, slot);
  if (on >= LAVES__ON_CORNER) return s->point_normals[s->faces[slot][on - LAVES__ON_CORNER]];
  const uint32_t half = s->across[3 * (size_t)slot + (size_t)(on - LAVES__ON_EDGE)];
  const laves__vec3 n = laves__face_normal(s, slot);
  return half == LAVES__NONE ? n : v3_add(n, laves__face_normal(s, half / 3));
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

/* The closest point of what counts of a face, and whether it lies amid one of its pieces, so that the face's normal tells the
 * sign. Squared distance; INFINITY when nothing counts. */
static double closest_part(const laves__surface *s, uint32_t slot, laves__vec3 p, laves__vec3 *foot, bool *amid) {
  int on;
  if (!(s->face_flags[slot] & LAVES__PARTIAL)) {
    *foot = laves__triangle_closest(&s->bvh.triangles[slot], p, &on);
    *amid = on == LAVES__ON_FACE;
    return v3_norm2(v3_sub(p, *foot));
  }
  double least = INFINITY;
  for (uint32_t i = s->piece_starts[slot]; i < s->piece_starts[slot + 1]; i++) {
    const laves__vec3 q = laves__triangle_closest(&s->pieces[i], p, &on);
    const double d2 = v3_norm2(v3_sub(p, q));
    if (d2 >= least) continue;
    least = d2;
    *foot = q;
    *amid = on == LAVES__ON_FACE;
  }
  return least;
}

bool laves__surface_bounds_at(const laves__surface *s, uint32_t slot, laves__vec3 q) {
  if (!(s->face_flags[slot] & LAVES__PARTIAL)) return true;
  laves__vec3 foot;
  bool amid;
  return sqrt(closest_part(s, slot, q, &foot, &amid)) <= on_piece * s->diagonal;
}

static double measure_part(void *user, uint32_t slot, double distance2, laves__vec3 p) {
  const laves__surface *s = user;
  if (!s->needs_winding || !(s->face_flags[slot] & LAVES__PARTIAL)) return distance2;
  laves__vec3 foot;
  bool amid;
  return closest_part(s, slot, p, &foot, &amid);
}

/* Like nearest_from, with hidden parts of partial faces left out. */
static laves__nearest nearest_part(const laves__surface *s, laves__vec3 p, double distance2) {
  laves__nearest best = {distance2, LAVES__NONE};
  laves__bvh_nearest_part(&s->bvh, p, measure_part, (void *)s, &best);
  return best;
}

static double signed_distance_by_winding(const laves__surface *s, laves__vec3 p, const laves__nearest *n) {
  laves__nearest part = *n;
  laves__vec3 foot;
  bool amid = false;
  if ((s->face_flags[n->slot] & LAVES__PARTIAL) != 0) {
    part = nearest_part(s, p, INFINITY);
    if (part.slot == LAVES__NONE)
      part = *n;
    else
      closest_part(s, part.slot, p, &foot, &amid);
  }
  const double distance = sqrt(part.distance2);
  const bool inside = amid ? v3_dot(v3_sub(p, foot), laves__face_normal(s, part.slot)) < 0 : is_inside(s, p);
  return inside ? -distance : distance;
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
  bool amid;
  closest_part(s, n.slot, p, foot, &amid);
  *normal = laves__face_normal(s, n.slot);
  return true;
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
  uint32_t start = hints && count > 0 ? hints[0] : LAVES__NO_HINT;
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
  bool amid = true;
  if (s->open) {
    *foot = laves__triangle_closest(&s->bvh.triangles[n.slot], point, &on);
    if (!is_plain(s, point, &n, on)) return open_project(s, point, reach, hint, foot, normal);
  } else if (s->needs_winding && (s->face_flags[n.slot] & LAVES__PARTIAL) != 0) {
    n = nearest_part(s, point, reach * reach);
    if (n.slot == LAVES__NONE) return false;
    closest_part(s, n.slot, point, foot, &amid);
    on = LAVES__ON_FACE;
  } else {
    *foot = laves__triangle_closest(&s->bvh.triangles[n.slot], point, &on);
  }
  *normal = v3_unit(feature_normal(s, n.slot, on));
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
  if (on == LAVES__ON_FACE) return laves__face_normal(s, slot);
  if (on >= LAVES__ON_CORNER)
    return part->on_border[s->faces[slot][on - LAVES__ON_CORNER]] ? laves__face_normal(s, slot) : feature_normal(s, slot, on);
  const uint32_t half = s->across[3 * (size_t)slot + (size_t)(on - LAVES__ON_EDGE)];
  return half != LAVES__NONE && belongs(part, half / 3) ? feature_normal(s, slot, on) : laves__face_normal(s, slot);
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
  int on = LAVES__ON_FACE;
  bool amid;
  if (s->needs_winding && (s->face_flags[n.slot] & LAVES__PARTIAL))
    closest_part(s, n.slot, point, foot, &amid);
  else
    *foot = laves__triangle_closest(&s->bvh.triangles[n.slot], point, &on);
  *normal = v3_unit(part_normal(s, part, n.slot, on));
  *hint = n.slot;
  return true;
}

static laves__side side(const void *self, laves__vec3 centre, double radius, laves__vec3 half) {
  const laves__surface *s = self;
  const double reach = fmin(radius, v3_norm(half));
  if (s->open) return laves__open_side(s, centre, reach);
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
  laves__free(context, s->pieces, s->piece_count, sizeof *s->pieces);
  laves__free(context, s->piece_starts, s->face_capacity + 2, sizeof *s->piece_starts);
  laves__free(context, s->point_normals, s->point_capacity, sizeof *s->point_normals);
  laves__free(context, s, 1, sizeof *s);
}
