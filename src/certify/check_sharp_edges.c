/* From the mesh to the domain: sharp edges of the boundary where the domain has no crease, and faces that lie across one.
 *
 * A boundary edge is sharp when the normal turns by more than the feature angle. Where the domain's own normal turns by much
 * below the two faces, and these stand on one patch, that is the doing of its bend, which no crease is: such edges are only
 * counted.
 *
 * Faces are looked at by three points, a tenth of the way from each corner to the centroid. Only a face that a crease comes near
 * can lie across it, so most are left alone. Every edge and face has its own slot, which one thread writes. */
#include <string.h>

#include "certify/check_features.h"

/* Of the feature angle: by how much the domain's normal must turn for its bend to be the cause. */
static const double bent_share = 0.5;
static const double degrees = 57.29577951308232;
/* How far from the corners a face is looked at, of the way to its centroid. */
static const double inset = 0.1;
/* Within how many radii of a face, round its centroid, a crease must come. */
static const double crease_reach = 2;

/* ---- sharp edges ---- */

typedef struct sharp_edge {
  uint32_t edge;
  bool bent;
  double distance;
  laves__vec3 place;
} sharp_edge;

typedef struct sharp_edges {
  const laves__feature_findings *f;
  sharp_edge *items;
  size_t count;
} sharp_edges;

static double crease_distance(const laves__features *features, laves__vec3 p, double reach) {
  laves__vec3 foot, tangent;
  return laves__crease_near(features, p, reach, &foot, &tangent) == LAVES__NO_FEATURE ? INFINITY : v3_distance(p, foot);
}

/* Parts of one patch that only the end of a crease has split go together. */
static bool are_apart(const laves__features *features, int32_t a, int32_t b) {
  return a != LAVES__NO_FEATURE && b != LAVES__NO_FEATURE && !laves__patches_join(features, a, b);
}

/* The domain's normal and patch below a face of the boundary; false: there is none. */
static bool look_below(const laves__feature_findings *f, uint32_t face, laves__vec3 *normal, int32_t *patch) {
  const int32_t *v = f->boundary->faces[face];
  const laves__vec3 *p = f->edges.point;
  const laves__vec3 centroid = v3_scale(v3_add(p[v[0]], v3_add(p[v[1]], p[v[2]])), 1.0 / 3);
  uint32_t hint = LAVES__NO_HINT;
  laves__vec3 foot;
  if (!v3_finite(centroid) || !f->oracle->project(f->oracle->self, centroid, f->check->diagonal, &hint, &foot, normal))
    return false;
  *patch = f->features->patch_at ? f->features->patch_at(f->features->self, foot, hint) : LAVES__NO_FEATURE;
  return true;
}

static bool is_bent(const laves__feature_findings *f, uint32_t edge) {
  laves__vec3 n, m;
  int32_t a, b;
  if (!look_below(f, f->edges.faces[edge][0], &n, &a) || !look_below(f, f->edges.faces[edge][1], &m, &b)) return false;
  if (are_apart(f->features, a, b)) return false;
  return laves__angle(v3_norm(v3_cross(n, m)), v3_dot(n, m)) * degrees > bent_share * f->check->angle;
}

static void measure_edges(void *user, size_t begin, size_t end, int worker) {
  const sharp_edges *all = user;
  const laves__feature_findings *f = all->f;
  (void)worker;
  for (size_t i = begin; i < end; i++) {
    sharp_edge *s = &all->items[i];
    const int32_t *ends = f->edges.ends[s->edge];
    const laves__vec3 a = f->edges.point[ends[0]], b = f->edges.point[ends[1]], middle = v3_lerp(a, b, 0.5);
    const laves__vec3 at[3] = {middle, a, b};
    s->distance = -1;
    for (int k = 0; k < 3; k++) {
      const double distance = crease_distance(f->features, at[k], INFINITY);
      if (!(distance > s->distance)) continue;
      s->distance = distance;
      s->place = at[k];
    }
    s->bent = s->distance > f->check->tolerance && is_bent(f, s->edge);
  }
}

static bool sum_edges(const sharp_edges *all, laves__feature_findings *f) {
  laves_feature_check *c = f->check;
  laves__vec3 worst = v3(0, 0, 0);
  c->mesh_creases = all->count;
  for (size_t i = 0; i < all->count; i++) {
    const sharp_edge *s = &all->items[i];
    if (s->bent) {
      c->mesh_bent++;
      continue;
    }
    if (s->distance > c->from_mesh_max) {
      c->from_mesh_max = s->distance;
      worst = s->place;
    }
    if (!(s->distance > c->tolerance)) continue;
    c->spurious++;
    laves_feature_place *place = laves__feature_place_add(f, LAVES_FEATURE_FAULT_SPURIOUS, s->place);
    if (!place) return false;
    place->distance = s->distance;
    place->angle = (double)f->edges.turn[s->edge];
    place->index = f->edges.ends[s->edge][0];
  }
  worst = v3_add(worst, f->oracle->origin);
  memcpy(c->from_mesh_place, &worst, sizeof c->from_mesh_place);
  return true;
}

static bool is_sharp(const laves__feature_findings *f, size_t edge) {
  return f->check->angle > 0 && (double)f->edges.turn[edge] > f->check->angle;
}

laves_result laves__check_sharp_edges(laves__feature_findings *f, laves_error *error) {
  sharp_edges all = {.f = f};
  size_t next = 0;
  laves_result result = LAVES_OK;
  for (size_t i = 0; i < f->edges.count; i++) all.count += is_sharp(f, i);
  all.items = laves__alloc(f->context, all.count, sizeof *all.items);
  if (!all.items) return laves__fail_memory(f->context, error);
  for (size_t i = 0; i < f->edges.count; i++)
    if (is_sharp(f, i)) all.items[next++] = (sharp_edge){.edge = (uint32_t)i};
  if (!laves__parallel_for(f->context, "check", all.count, 64, measure_edges, &all))
    result = laves__fail_cancelled(error);
  else if (!sum_edges(&all, f))
    result = laves__fail_memory(f->context, error);
  laves__free(f->context, all.items, all.count, sizeof *all.items);
  return result;
}

/* ---- faces across creases ---- */

typedef struct faces {
  const laves__feature_findings *f;
  bool *across; /* [boundary->count] */
} faces;

/* The patch below a point of the mesh; LAVES__NO_FEATURE where it is too near to a crease to tell. */
static int32_t patch_below(const laves__feature_findings *f, laves__vec3 p, uint32_t *hint) {
  laves__vec3 foot, normal;
  if (!f->oracle->project(f->oracle->self, p, f->check->diagonal, hint, &foot, &normal)) return LAVES__NO_FEATURE;
  if (crease_distance(f->features, foot, f->check->tolerance) <= f->check->tolerance) return LAVES__NO_FEATURE;
  return f->features->patch_at(f->features->self, foot, *hint);
}

static bool lies_across(const laves__feature_findings *f, const int32_t face[3]) {
  laves__vec3 corner[3];
  double radius = 0;
  uint32_t hint = LAVES__NO_HINT;
  int32_t patch[3];
  for (int k = 0; k < 3; k++) corner[k] = f->edges.point[face[k]];
  if (!v3_finite(corner[0]) || !v3_finite(corner[1]) || !v3_finite(corner[2])) return false;
  const laves__vec3 centroid = v3_scale(v3_add(corner[0], v3_add(corner[1], corner[2])), 1.0 / 3);
  for (int k = 0; k < 3; k++) radius = fmax(radius, v3_distance(corner[k], centroid));
  if (crease_distance(f->features, centroid, crease_reach * radius) > crease_reach * radius) return false;
  for (int k = 0; k < 3; k++) {
    patch[k] = patch_below(f, v3_lerp(corner[k], centroid, inset), &hint);
    for (int i = 0; i < k; i++)
      if (are_apart(f->features, patch[i], patch[k])) return true;
  }
  return false;
}

static void judge_faces(void *user, size_t begin, size_t end, int worker) {
  const faces *all = user;
  (void)worker;
  for (size_t i = begin; i < end; i++) all->across[i] = lies_across(all->f, all->f->boundary->faces[i]);
}

static bool list_faces(const faces *all, laves__feature_findings *f) {
  for (size_t i = 0; i < f->boundary->count; i++) {
    const int32_t *face = f->boundary->faces[i];
    const laves__vec3 *p = f->edges.point;
    if (!all->across[i]) continue;
    f->check->straddling++;
    const laves__vec3 centroid = v3_scale(v3_add(p[face[0]], v3_add(p[face[1]], p[face[2]])), 1.0 / 3);
    laves_feature_place *place = laves__feature_place_add(f, LAVES_FEATURE_FAULT_STRADDLING, centroid);
    if (!place) return false;
    place->index = face[0];
  }
  return true;
}

laves_result laves__check_straddling(laves__feature_findings *f, laves_error *error) {
  const size_t count = f->boundary->count;
  laves_result result = LAVES_OK;
  if (f->features->crease_count == 0 || f->features->patch_count < 2 || !f->features->patch_at) return LAVES_OK;
  const faces all = {f, laves__alloc_zeroed(f->context, count, sizeof *all.across)};
  if (!all.across) return laves__fail_memory(f->context, error);
  if (!laves__parallel_for(f->context, "check", count, 64, judge_faces, (void *)&all))
    result = laves__fail_cancelled(error);
  else if (!list_faces(&all, f))
    result = laves__fail_memory(f->context, error);
  laves__free(f->context, all.across, count, sizeof *all.across);
  return result;
}
