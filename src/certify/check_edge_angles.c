/* Dihedral angles of tets at creases, away from them, and how sharp the domain's creases are.
 *
 * In: which vertices touch features, which edges lie on which crease.  Out: the windows of laves_feature_check, the least angle
 * of the tets at each crease, the list of sharp creases. */
#include "certify/check_features.h"
#include "mesh/face_match.h"
#include "mesh/quality.h"

enum { BLOCK_TETS = 1 << 14, PLACES_TRIED = 64 };

static const double degrees = 57.29577951308232;
/* Degrees inside the solid: creases that are sharper are listed. */
static const double listed_angle = 80;

/* ---- windows ---- */

/* Cosines of the least and the greatest angle. */
typedef struct extremes {
  double least, most;
} extremes;

/* Of tets that touch no feature, and of those that touch features but none that is sharp. */
typedef struct block {
  extremes away, touching;
} block;

typedef struct windows {
  const laves__feature_findings *f;
  block *blocks;
} windows;

static const extremes none = {-HUGE_VAL, HUGE_VAL};

/* Comparisons, since what is not a number must not count. */
static void take(extremes *e, double cosine) {
  if (cosine > e->least) e->least = cosine;
  if (cosine < e->most) e->most = cosine;
}

static void join(extremes *e, const extremes *more) {
  if (more->least > e->least) e->least = more->least;
  if (more->most < e->most) e->most = more->most;
}

static uint8_t touch_of(const laves__feature_findings *f, const int32_t tet[4]) {
  return f->touch[tet[0]] | f->touch[tet[1]] | f->touch[tet[2]] | f->touch[tet[3]];
}

static void measure_blocks(void *user, size_t begin, size_t end, int worker) {
  const windows *w = user;
  const laves__feature_findings *f = w->f;
  (void)worker;
  for (size_t b = begin; b < end; b++) {
    block all = {none, none};
    for (size_t t = b * BLOCK_TETS; t < (b + 1) * BLOCK_TETS && t < f->mesh->tet_count; t++) {
      laves__vec3 p[4];
      double cosines[6];
      if (!laves__tet_corners(f->mesh, t, p)) continue;
      const uint8_t touch = touch_of(f, f->mesh->tets[t]);
      if (touch & LAVES__TOUCHES_SHARP) continue;
      laves__tet_dihedral_cosines(p, cosines);
      extremes *into = touch ? &all.touching : &all.away;
      for (int e = 0; e < 6; e++) take(into, cosines[e]);
    }
    w->blocks[b] = all;
  }
}

static double angle_of(double cosine) {
  return cosine < -1 - 1e-9 || cosine > 1 + 1e-9 ? NAN : acos(fmin(1, fmax(-1, cosine))) * degrees;
}

static laves_result measure_windows(laves__feature_findings *f, laves_error *error) {
  const size_t count = (f->mesh->tet_count + BLOCK_TETS - 1) / BLOCK_TETS;
  laves_feature_check *c = f->check;
  block all = {none, none};
  windows w = {f, laves__alloc(f->context, count, sizeof *w.blocks)};
  if (!w.blocks) return laves__fail_memory(f->context, error);
  const bool complete = laves__parallel_for(f->context, "check", count, 1, measure_blocks, &w);
  for (size_t b = 0; complete && b < count; b++) {
    join(&all.away, &w.blocks[b].away);
    join(&all.touching, &w.blocks[b].touching);
  }
  laves__free(f->context, w.blocks, count, sizeof *w.blocks);
  if (!complete) return laves__fail_cancelled(error);
  c->away_min_dihedral = angle_of(all.away.least);
  c->away_max_dihedral = angle_of(all.away.most);
  join(&all.touching, &all.away);
  c->free_min_dihedral = angle_of(all.touching.least);
  c->free_max_dihedral = angle_of(all.touching.most);
  return LAVES_OK;
}

/* ---- tets at creases ---- */

/* The crease on which edge e of a tet lies, or LAVES__NO_FEATURE. */
static int32_t crease_of(const laves__feature_findings *f, const int32_t tet[4], int e) {
  const int32_t a = tet[laves__tet_edge[e][0]], b = tet[laves__tet_edge[e][1]];
  if (!f->touch[a] || !f->touch[b]) return LAVES__NO_FEATURE;
  const uint32_t edge = laves__boundary_edges_between(&f->edges, a, b);
  return edge == LAVES__NONE ? LAVES__NO_FEATURE : f->edge_crease[edge];
}

/* Few tets touch a crease with an edge, so this is done in their order. */
static void measure_tet(const laves__feature_findings *f, size_t t) {
  const int32_t *tet = f->mesh->tets[t];
  laves__vec3 p[4];
  double cosines[6];
  bool measured = false;
  for (int e = 0; e < 6; e++) {
    const int32_t crease = crease_of(f, tet, e);
    if (crease == LAVES__NO_FEATURE) continue;
    if (!measured && !laves__tet_corners(f->mesh, t, p)) return;
    if (!measured) laves__tet_dihedral_cosines(p, cosines);
    measured = true;
    const double angle = angle_of(cosines[e]);
    laves__crease_finding *found = &f->crease[crease];
    if (!(angle < found->least_dihedral)) continue;
    found->least_dihedral = angle;
    found->tet = (int64_t)t;
  }
}

laves_result laves__check_edge_angles(laves__feature_findings *f, laves_error *error) {
  if (f->features->crease_count > 0)
    for (size_t t = 0; t < f->mesh->tet_count; t++) {
      const int32_t *tet = f->mesh->tets[t];
      if (!laves__tet_usable(tet, f->mesh->vertex_count)) continue;
      if ((f->touch[tet[0]] != 0) + (f->touch[tet[1]] != 0) + (f->touch[tet[2]] != 0) + (f->touch[tet[3]] != 0) >= 2)
        measure_tet(f, t);
    }
  return measure_windows(f, error);
}

double laves__feature_angle_at(const laves__feature_findings *f, int64_t tet) {
  double least = NAN;
  if (tet < 0 || !f->touch || !laves__tet_usable(f->mesh->tets[tet], f->mesh->vertex_count)) return NAN;
  for (int e = 0; e < 6; e++) {
    const int32_t crease = crease_of(f, f->mesh->tets[tet], e);
    if (crease != LAVES__NO_FEATURE) least = fmin(least, f->features->crease[crease].least_angle);
  }
  return least;
}

/* ---- sharp creases ---- */

/* The angle inside the solid at a place of a crease, by the normals of the patches on either side; NAN: they are not known there.
 */
static double angle_at(const laves__features *features, const laves__crease *crease, laves__vec3 p, laves__vec3 tangent,
                       double reach) {
  laves__vec3 foot, left, right;
  uint32_t hint = LAVES__NO_HINT;
  if (!features->project_patch || crease->patch[0] == crease->patch[1]) return NAN;
  if (!features->project_patch(features->self, crease->patch[0], p, reach, &hint, &foot, &left)) return NAN;
  hint = LAVES__NO_HINT;
  if (!features->project_patch(features->self, crease->patch[1], p, reach, &hint, &foot, &right)) return NAN;
  const laves__vec3 across = v3_cross(left, right);
  const double between = laves__angle(v3_norm(across), v3_dot(left, right)) * degrees;
  return v3_dot(across, tangent) > 0 ? 180 - between : 180 + between;
}

/* The place of a crease, of a few, where it is sharpest. */
static laves__vec3 sharpest_place(const laves__feature_findings *f, const laves__crease *crease) {
  const laves__vec3 *line = f->features->line + crease->first;
  const uint32_t segments = crease->count - 1, step = segments / PLACES_TRIED + 1;
  laves__vec3 best = v3_lerp(line[segments / 2], line[segments / 2 + 1], 0.5);
  double least = INFINITY;
  for (uint32_t k = 0; k < segments; k += step) {
    const laves__vec3 middle = v3_lerp(line[k], line[k + 1], 0.5);
    const double angle = angle_at(f->features, crease, middle, v3_sub(line[k + 1], line[k]), f->check->tolerance);
    if (!(angle < least)) continue;
    least = angle;
    best = middle;
  }
  return best;
}

laves_result laves__check_sharp_creases(laves__feature_findings *f, laves_error *error) {
  laves_feature_check *c = f->check;
  for (size_t i = 0; i < f->features->crease_count; i++) {
    const laves__crease *crease = &f->features->crease[i];
    c->sharpest = fmin(c->sharpest, crease->least_angle);
    if (!(crease->least_angle < listed_angle)) continue;
    c->sharp++;
    laves_feature_place *place = laves__feature_place_add(f, LAVES_FEATURE_FAULT_SHARP, sharpest_place(f, crease));
    if (!place) return laves__fail_memory(f->context, error);
    place->angle = crease->least_angle;
    place->length = crease->length;
    place->dihedral = isfinite(f->crease[i].least_dihedral) ? f->crease[i].least_dihedral : NAN;
    place->index = f->crease[i].tet;
  }
  return LAVES_OK;
}
