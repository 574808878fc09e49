/* The story of a mesh of second order, in one function: laves_mesh_curve().
 *
 *     edges and their middles -> edges of the boundary, with the patches below -> targets on surface and creases ->
 *     all nodes to their targets -> back, step by step, where the Jacobian is too small -> report
 *
 * In each round every tetrahedron that falls short sends back one of its nodes by half: the one whose step helps it most. All
 * look at the same nodes before any moves, so the result does not depend on threads. A tetrahedron whose nodes are all back at
 * the middle is as good as the straight one, so it ends. */
#include <string.h>

#include "curve/quadratic.h"
#include "domain/features.h"

static const uint32_t curve_cookie = 0x63757276;
static const char phase[] = "curve";
enum { BLOCK = 64 };

laves_curve_options laves_curve_options_default(void) {
  return (laves_curve_options){.min_jacobian = 0.2, .distances = true, .feature_angle = 40, .cookie = curve_cookie};
}

static const uint32_t no_bent = UINT32_MAX;

typedef struct curving {
  laves_context *context;
  const laves_mesh *mesh;
  const laves_domain *domain;
  const laves_curve_options *options;
  laves__features features;
  bool has_features;
  laves__quadratic *quadratic;
  laves__bent *bent; /* nodes on edges of the boundary, in the order of their numbers */
  size_t bent_count;
  uint32_t *bent_of; /* [node_count - vertex_count] or no_bent */
  size_t edge_count;
  uint32_t *tets; /* those with a node that has a target */
  size_t tet_count;
  double *least;    /* [tet_count] of tets[i] */
  uint32_t *choice; /* [tet_count] which bent node it sends back; no_bent: none */
  uint8_t *moved;   /* [bent_count] in the last round */
} curving;

/* ---- the edges of the boundary ---- */

static uint32_t bent_of(const curving *c, int32_t node) { return c->bent_of[(size_t)node - c->mesh->vertex_count]; }

static bool list_bent(curving *c) {
  const laves_mesh *mesh = c->mesh;
  c->edge_count = c->quadratic->node_count - mesh->vertex_count;
  c->bent_of = laves__alloc(c->context, c->edge_count, sizeof *c->bent_of);
  if (!c->bent_of) return false;
  for (size_t i = 0; i < c->edge_count; i++) c->bent_of[i] = no_bent;
  for (size_t i = 0; i < mesh->face_count; i++)
    for (int m = 0; m < 3; m++) c->bent_of[(size_t)c->quadratic->faces[i][3 + m] - mesh->vertex_count] = 0;
  for (size_t i = 0; i < c->edge_count; i++)
    if (c->bent_of[i] != no_bent) c->bent_of[i] = (uint32_t)c->bent_count++;
  c->bent = laves__alloc_zeroed(c->context, c->bent_count, sizeof *c->bent);
  c->moved = laves__alloc_zeroed(c->context, c->bent_count, sizeof *c->moved);
  return c->bent && c->moved;
}

/* patch: of each face; NULL: not known. */
static void fill_bent(curving *c, const int32_t *patch) {
  for (size_t i = 0; i < c->bent_count; i++) c->bent[i].patch[0] = c->bent[i].patch[1] = LAVES__NO_FEATURE;
  for (size_t i = 0; i < c->mesh->face_count; i++) {
    const int32_t *face = c->quadratic->faces[i];
    for (int m = 0; m < 3; m++) {
      laves__bent *b = &c->bent[bent_of(c, face[3 + m])];
      const int32_t u = face[laves__mid_corners[m][0]], v = face[laves__mid_corners[m][1]];
      const bool first = b->node == 0; /* no such node is number 0 */
      b->node = face[3 + m];
      b->ends[0] = u < v ? u : v;
      b->ends[1] = u < v ? v : u;
      b->middle = c->quadratic->points[b->node];
      if (patch) b->patch[!first] = patch[i];
    }
  }
}

static double mean_boundary_edge(const curving *c) {
  double sum = 0;
  for (size_t i = 0; i < c->bent_count; i++)
    sum += v3_distance(c->mesh->points[c->bent[i].ends[0]], c->mesh->points[c->bent[i].ends[1]]);
  return c->bent_count ? sum / (double)c->bent_count : 0;
}

static laves_result find_features(curving *c, laves_error *error) {
  const laves_curve_options *o = c->options;
  const laves__feature_wish wish = {.angle = o->feature_angle,
                                    .tags = o->feature_tags,
                                    .drawn = o->features,
                                    .size = o->feature_size > 0 ? o->feature_size : mean_boundary_edge(c)};
  c->has_features = true;
  return laves__features_find(c->context, &c->domain->oracle, &wish, &c->features, error);
}

static laves_result find_targets(curving *c, laves_error *error) {
  fill_bent(c, NULL);
  const laves_result result = find_features(c, error);
  if (result != LAVES_OK) return result;
  const laves__features *features = c->features.crease_count ? &c->features : NULL;
  if (features) {
    int32_t *patch = laves__alloc(c->context, c->mesh->face_count, sizeof *patch);
    const bool known = patch && laves__curve_patches(c->context, c->mesh, c->domain, features, patch);
    memset(c->bent, 0, c->bent_count * sizeof *c->bent);
    if (known) fill_bent(c, patch);
    laves__free(c->context, patch, c->mesh->face_count, sizeof *patch);
    if (!known) return laves__fail_memory(c->context, error);
  }
  return laves__curve_targets(c->context, c->mesh, c->domain, features, c->bent, c->bent_count)
             ? LAVES_OK
             : laves__fail_memory(c->context, error);
}

/* ---- the Jacobian ---- */

static laves__vec3 node_at(const laves__bent *b, int halvings) {
  if (halvings == 0) return b->target;
  if (halvings >= LAVES__BENT_STRAIGHT) return b->middle;
  return v3_lerp(b->middle, b->target, 1.0 / (double)(1 << halvings));
}

static bool is_bent(const laves__bent *b) { return b->found && b->halvings < LAVES__BENT_STRAIGHT; }

/* The node of a tet whose step back helps most, the first of equals; no_bent where none is bent. */
static uint32_t choose(const curving *c, const int32_t *tet, laves__vec3 nodes[LAVES__TET_NODES]) {
  uint32_t best = no_bent;
  double best_least = 0;
  for (int m = 4; m < LAVES__TET_NODES; m++) {
    const uint32_t index = bent_of(c, tet[m]);
    if (index == no_bent || !is_bent(&c->bent[index])) continue;
    const laves__vec3 now = nodes[m];
    nodes[m] = node_at(&c->bent[index], c->bent[index].halvings + 1);
    const double least = laves__quadratic_least(nodes);
    nodes[m] = now;
    if (best != no_bent && (least < best_least || (least == best_least && index > best))) continue;
    best = index;
    best_least = least;
  }
  return best;
}

static bool is_touched(const curving *c, const int32_t *tet) {
  for (int m = 4; m < LAVES__TET_NODES; m++) {
    const uint32_t index = bent_of(c, tet[m]);
    if (index != no_bent && c->moved[index]) return true;
  }
  return false;
}

/* Nodes are only read; each tet has its own entries. */
static void judge(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const curving *c = user;
  for (size_t i = begin; i < end; i++) {
    const int32_t *tet = c->quadratic->tets[c->tets[i]];
    laves__vec3 nodes[LAVES__TET_NODES];
    const bool fine = c->least[i] >= c->options->min_jacobian;
    if (!is_touched(c, tet) && fine) continue;
    for (int m = 0; m < LAVES__TET_NODES; m++) nodes[m] = c->quadratic->points[tet[m]];
    c->least[i] = laves__quadratic_least(nodes);
    c->choice[i] = c->least[i] >= c->options->min_jacobian ? no_bent : choose(c, tet, nodes);
  }
}

static bool list_tets(curving *c) {
  for (int pass = 0; pass < 2; pass++) {
    size_t count = 0;
    for (size_t i = 0; i < c->mesh->tet_count; i++) {
      if (laves__cancelled_at(c->context, phase, i, c->mesh->tet_count)) return false;
      bool bent = false;
      for (int m = 4; m < LAVES__TET_NODES; m++) {
        const uint32_t index = bent_of(c, c->quadratic->tets[i][m]);
        bent |= index != no_bent && c->bent[index].found;
      }
      if (!bent) continue;
      if (pass) c->tets[count] = (uint32_t)i;
      count++;
    }
    if (pass) break;
    c->tet_count = count;
    c->tets = laves__alloc(c->context, count, sizeof *c->tets);
    c->least = laves__alloc_zeroed(c->context, count, sizeof *c->least);
    c->choice = laves__alloc(c->context, count, sizeof *c->choice);
    if (!c->tets || !c->least || !c->choice) return false;
  }
  return true;
}

/* Moves back what was chosen; false when nothing was. */
static bool step_back(curving *c) {
  bool any = false;
  memset(c->moved, 0, c->bent_count * sizeof *c->moved);
  for (size_t i = 0; i < c->tet_count; i++)
    if (c->choice[i] != no_bent) c->moved[c->choice[i]] = 1;
  for (size_t i = 0; i < c->bent_count; i++) {
    if (!c->moved[i]) continue;
    laves__bent *b = &c->bent[i];
    c->quadratic->points[b->node] = node_at(b, ++b->halvings);
    any = true;
  }
  return any;
}

static bool move_nodes(curving *c) {
  if (!list_tets(c)) return false;
  for (size_t i = 0; i < c->bent_count; i++) {
    laves__bent *b = &c->bent[i];
    if (b->found) c->quadratic->points[b->node] = b->target;
    c->moved[i] = 1;
  }
  do {
    if (!laves__parallel_for(c->context, phase, c->tet_count, BLOCK, judge, c)) return false;
  } while (step_back(c));
  return true;
}

/* ---- the report ---- */

static void count_nodes(const curving *c, laves_curve_report *report) {
  report->nodes = c->quadratic->node_count;
  report->edges = report->nodes - c->mesh->vertex_count;
  report->boundary_edges = c->bent_count;
  for (size_t i = 0; i < c->bent_count; i++) {
    const laves__bent *b = &c->bent[i];
    if (!b->found)
      report->unreached++;
    else if (b->halvings >= LAVES__BENT_STRAIGHT)
      report->straightened++;
    else if (b->halvings > 0)
      report->moved_back++;
    else
      report->on_surface++;
    report->on_crease += b->on_crease && b->halvings == 0;
  }
  report->least_jacobian = 1;
  report->least_tet = -1;
  for (size_t i = 0; i < c->tet_count; i++) {
    if (!(c->least[i] < report->least_jacobian)) continue;
    report->least_jacobian = c->least[i];
    report->least_tet = c->tets[i];
  }
}

static laves_result check_call(const laves_mesh *mesh, const laves_curve_options *o, laves_error *error) {
  if (o->cookie != curve_cookie)
    return laves__fail(error, LAVES_ERROR_OPTION, "the options did not come from laves_curve_options_default()");
  if (!(o->min_jacobian >= 0.01 && o->min_jacobian <= 0.9))
    return laves__fail(error, LAVES_ERROR_OPTION, "min_jacobian is %g but must lie between 0.01 and 0.9", o->min_jacobian);
  if (!(o->feature_angle == 0 || (o->feature_angle >= 1 && o->feature_angle <= 179)))
    return laves__fail(error, LAVES_ERROR_OPTION, "feature_angle is %g degrees; it must be 0 (none) or from 1 to 179",
                       o->feature_angle);
  if (!(o->feature_size >= 0 && isfinite(o->feature_size)))
    return laves__fail(error, LAVES_ERROR_OPTION, "feature_size is %g; it must be 0 (the mean edge) or positive",
                       o->feature_size);
  const laves_result held = laves__mesh_require_arrays(mesh, "second order", error);
  if (held != LAVES_OK) return held;
  for (size_t i = 0; i < mesh->tet_count; i++)
    for (int j = 0; j < 4; j++)
      if (mesh->tets[i][j] < 0 || (size_t)mesh->tets[i][j] >= mesh->vertex_count)
        return laves__fail(error, LAVES_ERROR_INPUT, "tetrahedron %zu uses vertex %ld of %zu", i, (long)mesh->tets[i][j],
                           mesh->vertex_count);
  return LAVES_OK;
}

static void free_curving(curving *c) {
  if (c->has_features) laves__features_free(&c->features);
  laves__free(c->context, c->choice, c->tet_count, sizeof *c->choice);
  laves__free(c->context, c->least, c->tet_count, sizeof *c->least);
  laves__free(c->context, c->tets, c->tet_count, sizeof *c->tets);
  laves__free(c->context, c->moved, c->bent_count, sizeof *c->moved);
  laves__free(c->context, c->bent, c->bent_count, sizeof *c->bent);
  laves__free(c->context, c->bent_of, c->edge_count, sizeof *c->bent_of);
}

laves_result laves_mesh_curve(laves_context *context, laves_mesh *mesh, const laves_domain *domain,
                              const laves_curve_options *options, laves_curve_report *report, laves_error *error) {
  const laves_curve_options defaults = laves_curve_options_default();
  laves_curve_report found = {.least_tet = -1};
  curving c = {.context = context, .mesh = mesh, .domain = domain, .options = options ? options : &defaults};
  laves_result result = check_call(mesh, c.options, error);
  if (result != LAVES_OK) return result;
  laves__progress_reset(context);
  laves_error own = {.result = LAVES_OK};
  c.quadratic = laves__quadratic_create(context, mesh, &own);
  if (!c.quadratic) return laves__fail(error, own.result, "%s", own.text);
  if (!list_bent(&c)) result = laves__fail_memory(context, error);
  if (result == LAVES_OK && domain) result = find_targets(&c, error);
  if (result == LAVES_OK && !move_nodes(&c)) result = laves__fail_memory(context, error);
  if (result == LAVES_OK && domain && c.options->distances && !laves__curve_distances(context, mesh, c.quadratic, domain, &found))
    result = laves__fail_memory(context, error);
  if (result == LAVES_OK) {
    count_nodes(&c, &found);
    if (report) *report = found;
    laves__quadratic_free(context, mesh, mesh->quadratic);
    mesh->quadratic = c.quadratic;
  } else {
    laves__quadratic_free(context, mesh, c.quadratic);
  }
  free_curving(&c);
  return result;
}
