/* Regions of the mesh: which closed part of the input surface, or named part of a formula, each tetrahedron is in.
 *
 * The part that holds a tet's centroid is asked by winding numbers, which are not cheap; but tets which the surface (all of it,
 * the walls between parts as well) does not come near need not be asked one by one: if the ball about the centroid that holds a
 * tet's corners touches no triangle, all of the tet is in one part, and so is its neighbour across a face if the same is true of
 * it. So one tet is asked for each set of such tets that hang together, and beside these only tets near the surface.
 *
 * Formulas are cheap, and each tet's centroid is asked.
 *
 * The mesh's boundary is not quite the surface, so the centroid of a flat tet may be just outside of every part. Such a tet takes
 * the least region among its neighbours. */
#include "regions.h"

#include <stdio.h>
#include <string.h>

#include "domain/surface.h"
#include "mesh/face_match.h"

/* No tet across; a tet that was not asked yet; one that is in no part. */
enum { UNKNOWN = -2, OUTSIDE = -1 };

typedef struct labelling {
  laves_context *context;
  laves_mesh *mesh;
  laves__vec3 origin;
  laves__parts *parts;
  uint32_t *across; /* [4 tet_count] the tet behind each face, or LAVES__NONE */
  bool *near;       /* [tet_count] the surface may pass through it */
  int32_t *label;   /* the mesh's regions, while they are found: a part, UNKNOWN or OUTSIDE */
  uint32_t *stack;  /* [tet_count] */
} labelling;

static laves__vec3 centroid(const labelling *g, size_t tet) {
  const int32_t *t = g->mesh->tets[tet];
  const laves__vec3 *p = g->mesh->points;
  const laves__vec3 sum = v3_add(v3_add(p[t[0]], p[t[1]]), v3_add(p[t[2]], p[t[3]]));
  return v3_sub(v3_scale(sum, 0.25), g->origin);
}

/* The ball is larger than it must be by this factor, so that rounding does not matter; a larger one asks a few more tets. */
static const double ball_slack = 1.0005;

static double radius(const labelling *g, size_t tet, laves__vec3 centre) {
  double most = 0;
  for (int k = 0; k < 4; k++) most = fmax(most, v3_distance(v3_sub(g->mesh->points[g->mesh->tets[tet][k]], g->origin), centre));
  return most * ball_slack;
}

/* Tets near the surface are asked at once. Each tet has one writer. */
static void ask_near(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const labelling *g = user;
  for (size_t t = begin; t < end; t++) {
    const laves__vec3 c = centroid(g, t);
    g->near[t] = laves__parts_touch(g->parts, c, radius(g, t, c));
    g->label[t] = g->near[t] ? laves__parts_at(g->parts, c) : UNKNOWN;
  }
}

/* Each pair of slots has one writer. */
static void note_pair(void *user, uint32_t low, const laves__face_use *uses, size_t count, int worker) {
  const labelling *g = user;
  (void)low;
  (void)worker;
  if (count != 2) return;
  g->across[uses[0].slot] = (uint32_t)(uses[1].slot / 4);
  g->across[uses[1].slot] = (uint32_t)(uses[0].slot / 4);
}

/* Gives all that hangs together with a tet far from the surface its part. */
static void flood(labelling *g, uint32_t first) {
  size_t top = 0;
  const int32_t label = laves__parts_at(g->parts, centroid(g, first));
  g->label[first] = label;
  g->stack[top++] = first;
  while (top > 0) {
    const size_t t = g->stack[--top];
    for (int k = 0; k < 4; k++) {
      const uint32_t other = g->across[4 * t + (size_t)k];
      if (other == LAVES__NONE || g->label[other] != UNKNOWN) continue;
      g->label[other] = label;
      g->stack[top++] = other;
    }
  }
}

/* The least part among the neighbours of a tet, or OUTSIDE. */
static int32_t least_neighbour(const labelling *g, size_t tet) {
  int32_t least = OUTSIDE;
  for (int k = 0; k < 4; k++) {
    const uint32_t other = g->across[4 * tet + (size_t)k];
    if (other == LAVES__NONE || g->label[other] < 0) continue;
    if (least == OUTSIDE || g->label[other] < least) least = g->label[other];
  }
  return least;
}

/* Near tets in no part take the part of a neighbour, in rounds that go by the labels of the round before. What hangs together
 * with tets outside of all parts which the surface is not near stays outside: it is in a part that is not closed. */
static void adopt(labelling *g) {
  size_t lone = 0;
  uint32_t *list = g->stack;
  for (size_t t = 0; t < g->mesh->tet_count; t++) {
    bool beside_rest = false;
    if (!g->near[t] || g->label[t] != OUTSIDE) continue;
    for (int k = 0; k < 4; k++) {
      const uint32_t other = g->across[4 * t + (size_t)k];
      beside_rest |= other != LAVES__NONE && !g->near[other] && g->label[other] == OUTSIDE;
    }
    if (!beside_rest) list[lone++] = (uint32_t)t;
  }
  for (bool changed = true; changed;) {
    size_t left = 0;
    changed = false;
    /* The round's answers are kept below UNKNOWN until it is over. */
    for (size_t i = 0; i < lone; i++) {
      const int32_t found = least_neighbour(g, list[i]);
      if (found >= 0) g->label[list[i]] = UNKNOWN - 1 - found;
    }
    for (size_t i = 0; i < lone; i++) {
      int32_t *label = &g->label[list[i]];
      if (*label < UNKNOWN) {
        *label = UNKNOWN - 1 - *label;
        changed = true;
      } else {
        list[left++] = list[i];
      }
    }
    lone = left;
  }
}

/* Regions from labels: parts from 1, what is in none behind them. */
static void number_regions(labelling *g, laves__region_counts *counts, bool *used, bool *any_rest) {
  const int32_t rest = (int32_t)counts->parts + 1;
  *any_rest = false;
  for (size_t t = 0; t < g->mesh->tet_count; t++) {
    int32_t *label = &g->label[t];
    *label = *label < 0 ? rest : *label + 1;
    *any_rest |= *label == rest;
    if (*label < rest) used[*label - 1] = true;
  }
  for (size_t p = 0; p < counts->parts; p++) counts->empty += !used[p];
  for (size_t t = 0; t < g->mesh->tet_count; t++)
    for (int k = 0; k < 4; k++) {
      const uint32_t other = g->across[4 * t + (size_t)k];
      counts->interfaces += other != LAVES__NONE && other > t && g->label[other] != g->label[t];
    }
}

static bool add_names(const labelling *g, const laves_domain *domain, size_t count, bool any_rest) {
  for (size_t p = 0; p < count; p++) {
    char name[32];
    const char *known = laves_domain_tag_name(domain, laves__parts_tag(g->parts, p));
    snprintf(name, sizeof name, "part %zu", p + 1);
    if (!laves__mesh_add_group(g->mesh, 3, (int32_t)p + 1, known && known[0] ? known : name)) return false;
  }
  return !any_rest || laves__mesh_add_group(g->mesh, 3, (int32_t)count + 1, "rest");
}

static laves_result label_all(labelling *g, laves_error *error) {
  const size_t tets = g->mesh->tet_count;
  memset(g->across, 0xff, 4 * tets * sizeof *g->across);
  laves_result result = laves__match_faces(g->context, "regions", (const int32_t(*)[4])g->mesh->tets, tets, g->mesh->vertex_count,
                                           note_pair, g, error);
  if (result != LAVES_OK) return result;
  if (!laves__parallel_for(g->context, "regions", tets, 256, ask_near, g)) return laves__fail_cancelled(error);
  for (size_t t = 0; t < tets; t++)
    if (g->label[t] == UNKNOWN) flood(g, (uint32_t)t);
  adopt(g);
  return LAVES_OK;
}

laves_result laves__regions_of_parts(laves_context *context, const laves_domain *domain, laves_mesh *mesh,
                                     laves__region_counts *counts, laves_error *error) {
  const size_t tets = mesh->tet_count;
  memset(counts, 0, sizeof *counts);
  if (!domain->oracle.surface) return LAVES_OK;
  if (tets >= UINT32_MAX)
    return laves__fail(error, LAVES_ERROR_OPTION, "regions can be told apart in meshes of less than 2^32 tetrahedra, not of %zu",
                       tets);
  labelling g = {.context = context, .mesh = mesh, .origin = domain->oracle.origin};
  laves_result result = LAVES_OK;
  bool any_rest = false, *used = NULL;
  g.parts = laves__parts_create(domain->oracle.surface, false);
  if (!g.parts) return laves__fail_memory(context, error);
  counts->parts = laves__parts_count(g.parts);
  if (counts->parts < 2) {
    laves__parts_free(g.parts);
    return LAVES_OK;
  }
  used = laves__alloc_zeroed(context, counts->parts, sizeof *used);
  g.across = laves__alloc(context, 4 * tets, sizeof *g.across);
  g.near = laves__alloc(context, tets, sizeof *g.near);
  g.label = laves__alloc(context, tets, sizeof *g.label);
  g.stack = laves__alloc(context, tets, sizeof *g.stack);
  result = used && g.across && g.near && g.label && g.stack ? label_all(&g, error) : laves__fail_memory(context, error);
  if (result == LAVES_OK) {
    number_regions(&g, counts, used, &any_rest);
    if (!add_names(&g, domain, counts->parts, any_rest)) result = laves__fail_memory(context, error);
  }
  if (result == LAVES_OK) {
    mesh->regions = g.label;
    g.label = NULL;
  }
  laves__free(context, used, counts->parts, sizeof *used);
  laves__free(context, g.across, 4 * tets, sizeof *g.across);
  laves__free(context, g.near, tets, sizeof *g.near);
  laves__free(context, g.label, tets, sizeof *g.label);
  laves__free(context, g.stack, tets, sizeof *g.stack);
  laves__parts_free(g.parts);
  return result;
}

/* ---- regions of formulas ---- */

typedef struct naming {
  const laves__oracle *oracle;
  const laves_mesh *mesh;
  int32_t *region;
  size_t *interfaces; /* [workers] */
} naming;

static void ask_all(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const naming *n = user;
  const laves__vec3 *p = n->mesh->points;
  for (size_t t = begin; t < end; t++) {
    const int32_t *v = n->mesh->tets[t];
    const laves__vec3 sum = v3_add(v3_add(p[v[0]], p[v[1]]), v3_add(p[v[2]], p[v[3]]));
    n->region[t] = 1 + n->oracle->region(n->oracle->self, v3_sub(v3_scale(sum, 0.25), n->oracle->origin));
  }
}

static void count_interface(void *user, uint32_t low, const laves__face_use *uses, size_t count, int worker) {
  const naming *n = user;
  (void)low;
  if (count == 2) n->interfaces[worker] += n->region[uses[0].slot / 4] != n->region[uses[1].slot / 4];
}

laves_result laves__regions_of_names(laves_context *context, const laves_domain *domain, laves_mesh *mesh,
                                     laves__region_counts *counts, laves_error *error) {
  const size_t tets = mesh->tet_count, workers = (size_t)laves__workers(context);
  naming n = {.oracle = &domain->oracle, .mesh = mesh};
  memset(counts, 0, sizeof *counts);
  counts->parts = (size_t)domain->region_count;
  n.region = laves__alloc(context, tets, sizeof *n.region);
  n.interfaces = laves__alloc_zeroed(context, workers, sizeof *n.interfaces);
  laves_result result = n.region && n.interfaces ? LAVES_OK : laves__fail_memory(context, error);
  if (result == LAVES_OK && !laves__parallel_for(context, "regions", tets, 256, ask_all, &n))
    result = laves__fail_cancelled(error);
  if (result == LAVES_OK)
    result = laves__match_faces(context, "regions", (const int32_t(*)[4])mesh->tets, tets, mesh->vertex_count, count_interface,
                                &n, error);
  for (size_t w = 0; w < workers && result == LAVES_OK; w++) counts->interfaces += n.interfaces[w];
  for (int i = 0; i < domain->region_count && result == LAVES_OK; i++)
    if (!laves__mesh_add_group(mesh, 3, i + 1, domain->region_names[i])) result = laves__fail_memory(context, error);
  if (result == LAVES_OK) {
    mesh->regions = n.region;
    n.region = NULL;
  }
  laves__free(context, n.region, tets, sizeof *n.region);
  laves__free(context, n.interfaces, workers, sizeof *n.interfaces);
  return result;
}
