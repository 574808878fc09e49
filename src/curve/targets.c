/* Where the nodes on edges of the boundary shall stand: on the crease where the edge lies along one, else on the patch below its
 * two faces, else on the surface; each the nearest place to the middle of the edge. */
#include "curve/quadratic.h"
#include "domain/features.h"

static const char phase[] = "curve";

/* No target is further from an edge's middle than this share of its length: an arc of more than a half circle is none to follow.
 */
static const double reach_share = 0.5;
/* Ends of an edge along a crease are this near to it, as a share of the edge's length: a vertex on a drawn line is on the
 * surface, from which the line's own stretches are a little off. A vertex that is so near and not on it would have made a sliver.
 */
static const double crease_share = 0.02;

/* Edges that are projected in one call. */
enum { BATCH = 64 };

typedef struct search {
  const laves_mesh *mesh;
  const laves__oracle *oracle;
  const laves__features *features; /* NULL: none */
  laves__bent *bent;
  int32_t *patch; /* [face_count] */
  double reach;   /* for all: an answer must not depend on which edges a thread asks for together */
} search;

static laves__vec3 local(const search *s, laves__vec3 input) { return v3_sub(input, s->oracle->origin); }
static double length_of(const search *s, const laves__bent *b) {
  return v3_distance(s->mesh->points[b->ends[0]], s->mesh->points[b->ends[1]]);
}

static void set_target(const search *s, laves__bent *b, laves__vec3 foot, bool on_crease) {
  b->target = v3_add(foot, s->oracle->origin);
  b->found = v3_finite(b->target);
  b->on_crease = b->found && on_crease;
}

/* A place on a line within one patch, put on the surface. */
static laves__vec3 on_surface(const search *s, laves__vec3 place, double length) {
  uint32_t hint = LAVES__NO_HINT;
  laves__vec3 foot, normal;
  return s->oracle->project(s->oracle->self, place, crease_share * length, &hint, &foot, &normal) ? foot : place;
}

/* Whether both ends of an edge between two patches are on a crease between them, and the foot of its middle there. */
static bool try_crease(const search *s, laves__bent *b, double length) {
  laves__vec3 foot;
  for (int i = 0; i < 2; i++) { /* the reach is to the crease's polyline, the foot is on the crease itself */
    const laves__vec3 end = local(s, s->mesh->points[b->ends[i]]);
    if (laves__crease_between(s->features, b->patch[0], &b->patch[1], 1, end, reach_share * length, &foot) == LAVES__NO_FEATURE ||
        v3_distance(foot, end) > crease_share * length)
      return false;
  }
  if (laves__crease_between(s->features, b->patch[0], &b->patch[1], 1, local(s, b->middle), reach_share * length, &foot) ==
      LAVES__NO_FEATURE)
    return true; /* it keeps to its middle */
  if (laves__patches_join(s->features, b->patch[0], b->patch[1])) foot = on_surface(s, foot, length);
  set_target(s, b, foot, true);
  return true;
}

/* The same for a line within one patch. */
static bool try_seam(const search *s, laves__bent *b, double length) {
  laves__vec3 foot, tangent;
  int32_t crease[2];
  for (int i = 0; i < 2; i++) {
    const laves__vec3 end = local(s, s->mesh->points[b->ends[i]]);
    crease[i] = laves__seam_near(s->features, b->patch[0], end, reach_share * length, &foot, &tangent);
    if (crease[i] != LAVES__NO_FEATURE && v3_distance(foot, end) > crease_share * length) return false;
  }
  if (crease[0] == LAVES__NO_FEATURE || crease[0] != crease[1]) return false;
  /* A chord between two turns of a line is not on it: its middle is further from the line than an arc bulges. */
  if (!laves__crease_project(s->features, crease[0], local(s, b->middle), reach_share / 2 * length, &foot, &tangent))
    return false;
  set_target(s, b, on_surface(s, foot, length), true);
  return true;
}

static void find_on_features(const search *s, laves__bent *b) {
  const double length = length_of(s, b);
  const bool known = b->patch[0] != LAVES__NO_FEATURE && b->patch[1] != LAVES__NO_FEATURE;
  if (known && b->patch[0] != b->patch[1] && try_crease(s, b, length)) return;
  if (known && b->patch[0] == b->patch[1] && s->features->has_seams && try_seam(s, b, length)) return;
  uint32_t hint = LAVES__NO_HINT;
  laves__vec3 foot, normal;
  if (known && b->patch[0] == b->patch[1] && s->features->project_patch &&
      s->features->project_patch(s->features->self, b->patch[0], local(s, b->middle), reach_share * length, &hint, &foot,
                                 &normal)) {
    set_target(s, b, foot, false);
    return;
  }
  hint = LAVES__NO_HINT;
  if (s->oracle->project(s->oracle->self, local(s, b->middle), reach_share * length, &hint, &foot, &normal))
    set_target(s, b, foot, false);
}

static void find_on_surface(const search *s, laves__bent *b, size_t count) {
  laves__vec3 points[BATCH] = {{0}};
  laves__projection answers[BATCH];
  for (size_t i = 0; i < count; i++) {
    points[i] = local(s, b[i].middle);
    answers[i] = (laves__projection){.hint = LAVES__NO_HINT};
  }
  laves__project_many(s->oracle, count, points, s->reach, answers);
  for (size_t i = 0; i < count; i++)
    if (answers[i].found && v3_distance(answers[i].foot, points[i]) <= reach_share * length_of(s, &b[i]))
      set_target(s, &b[i], answers[i].foot, false);
}

/* Every edge's entry has one writer. */
static void find_range(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const search *s = user;
  if (s->features) {
    for (size_t i = begin; i < end; i++) find_on_features(s, &s->bent[i]);
    return;
  }
  for (size_t i = begin; i < end; i += BATCH) find_on_surface(s, &s->bent[i], end - i < BATCH ? end - i : BATCH);
}

bool laves__curve_targets(laves_context *context, const laves_mesh *mesh, const laves_domain *domain,
                          const laves__features *features, laves__bent *bent, size_t count) {
  search s = {.mesh = mesh, .oracle = &domain->oracle, .features = features, .bent = bent};
  for (size_t i = 0; i < count; i++) s.reach = fmax(s.reach, reach_share * length_of(&s, &bent[i]));
  return laves__parallel_for(context, phase, count, BATCH, find_range, &s);
}

static void patch_range(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const search *s = user;
  for (size_t i = begin; i < end; i++) {
    const int32_t *face = s->mesh->faces[i];
    const laves__vec3 a = s->mesh->points[face[0]], b = s->mesh->points[face[1]], c = s->mesh->points[face[2]];
    const double reach = fmax(v3_distance(a, b), v3_distance(a, c));
    uint32_t hint = LAVES__NO_HINT;
    laves__vec3 foot, normal;
    const bool found =
        s->oracle->project(s->oracle->self, local(s, v3_scale(v3_add(v3_add(a, b), c), 1.0 / 3)), reach, &hint, &foot, &normal);
    s->patch[i] = found && s->features->patch_at ? s->features->patch_at(s->features->self, foot, hint) : LAVES__NO_FEATURE;
  }
}

bool laves__curve_patches(laves_context *context, const laves_mesh *mesh, const laves_domain *domain,
                          const laves__features *features, int32_t *patch) {
  search s = {.mesh = mesh, .oracle = &domain->oracle, .features = features, .patch = patch};
  return laves__parallel_for(context, phase, mesh->face_count, BATCH, patch_range, &s);
}

/* ---- distances ---- */

enum { SAMPLES = 4, FACES = 16 };
/* Barycentric coordinates of the samples: the centroid, and points between it and the corners. */
static const double samples[SAMPLES][3] = {
    {1.0 / 3, 1.0 / 3, 1.0 / 3}, {2.0 / 3, 1.0 / 6, 1.0 / 6}, {1.0 / 6, 2.0 / 3, 1.0 / 6}, {1.0 / 6, 1.0 / 6, 2.0 / 3}};

/* Of one face: largest distance, and the sum over its samples, of the straight and of the curved one; samples that have no foot
 * within reach are counted apart. */
typedef struct face_distance {
  double max[2], sum[2];
  uint8_t found[2];
} face_distance;

typedef struct measuring {
  const laves__oracle *oracle;
  const laves__quadratic *quadratic;
  face_distance *faces;
  double reach;
} measuring;

static void sample_face(const measuring *m, size_t face, bool curved, laves__vec3 out[SAMPLES]) {
  laves__vec3 nodes[LAVES__FACE_NODES];
  for (int i = 0; i < LAVES__FACE_NODES; i++) nodes[i] = m->quadratic->points[m->quadratic->faces[face][i]];
  for (int i = 0; i < 3 && !curved; i++)
    nodes[3 + i] = v3_scale(v3_add(nodes[laves__mid_corners[i][0]], nodes[laves__mid_corners[i][1]]), 0.5);
  for (int i = 0; i < SAMPLES; i++)
    out[i] = v3_sub(laves__quadratic_point(nodes, samples[i][0], samples[i][1], samples[i][2]), m->oracle->origin);
}

static void measure_faces(const measuring *m, size_t first, size_t count, int curved) {
  laves__vec3 points[FACES * SAMPLES];
  laves__projection answers[FACES * SAMPLES];
  for (size_t i = 0; i < count; i++) sample_face(m, first + i, curved, points + SAMPLES * i);
  for (size_t i = 0; i < SAMPLES * count; i++) answers[i] = (laves__projection){.hint = LAVES__NO_HINT};
  laves__project_many(m->oracle, SAMPLES * count, points, m->reach, answers);
  for (size_t i = 0; i < SAMPLES * count; i++) {
    if (!answers[i].found) continue;
    face_distance *f = &m->faces[first + i / SAMPLES];
    const double distance = v3_distance(answers[i].foot, points[i]);
    if (distance > f->max[curved]) f->max[curved] = distance;
    f->sum[curved] += distance;
    f->found[curved]++;
  }
}

static void measure_range(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  for (size_t i = begin; i < end; i += FACES)
    for (int curved = 0; curved < 2; curved++) measure_faces(user, i, end - i < FACES ? end - i : FACES, curved);
}

bool laves__curve_distances(laves_context *context, const laves_mesh *mesh, const laves__quadratic *quadratic,
                            const laves_domain *domain, laves_curve_report *report) {
  const size_t count = mesh->face_count;
  measuring m = {&domain->oracle, quadratic, laves__alloc_zeroed(context, count, sizeof *m.faces), 0};
  for (size_t i = 0; i < count; i++) {
    const int32_t *face = mesh->faces[i];
    for (int k = 0; k < 3; k++) m.reach = fmax(m.reach, v3_distance(mesh->points[face[k]], mesh->points[face[(k + 1) % 3]]));
  }
  const bool done = m.faces && laves__parallel_for(context, phase, count, FACES, measure_range, &m);
  double max[2] = {0}, sum[2] = {0}, found[2] = {0};
  for (size_t i = 0; i < count && done; i++)
    for (int k = 0; k < 2; k++) {
      if (m.faces[i].max[k] > max[k]) max[k] = m.faces[i].max[k];
      sum[k] += m.faces[i].sum[k];
      found[k] += m.faces[i].found[k];
    }
  laves__free(context, m.faces, count, sizeof *m.faces);
  if (!done) return false;
  report->has_distance = found[0] > 0 && found[1] > 0;
  if (!report->has_distance) return true;
  report->straight_max = max[0];
  report->straight_mean = sum[0] / found[0];
  report->curved_max = max[1];
  report->curved_mean = sum[1] / found[1];
  return true;
}
