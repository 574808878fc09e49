/* The background as a whole; graded.h tells its parts. */
#include "graded/graded.h"

#include "graded/tiles.h"

/* Inside, the triangles around a vertex make a sphere: F = 2 V - 4. On the hull there are fewer. */
static bool is_inner(const laves__graph *g, size_t v) {
  const uint32_t tets = g->star_first[v + 1] - g->star_first[v], links = g->link_first[v + 1] - g->link_first[v];
  return tets + 4 == 2 * links;
}

/* The hull, and the local size: the mean length of the edges around. */
static void measure_vertices(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  laves__graph *g = user;
  for (size_t v = begin; v < end; v++) {
    double sum = 0;
    for (uint32_t k = g->link_first[v]; k < g->link_first[v + 1]; k++)
      sum += v3_distance(g->position[v], g->position[g->link[k]]);
    const uint32_t links = g->link_first[v + 1] - g->link_first[v];
    g->scale[v] = links ? (float)(sum / links) : 1;
    g->hull[v] = !is_inner(g, v);
  }
}

laves_result laves__graded_background(const laves__frame *frame, const laves__demand *demand, laves_context *context,
                                      laves__octree *tree, laves__graph *graph, laves_error *error) {
  laves__sites sites = {0};
  laves_result result = laves__octree_build(frame, demand, context, tree, error);
  if (result == LAVES_OK) result = laves__sites_make(tree, &sites, error);
  if (result == LAVES_OK) result = laves__tiles_make(tree, &sites, graph, error);
  laves__sites_free(&sites);
  if (result == LAVES_OK) result = laves__graph_link(graph, error);
  if (result == LAVES_OK && !laves__parallel_for(context, "background", graph->vertex_count, 256, measure_vertices, graph))
    result = laves__fail_cancelled(error);
  return result;
}

/* Tets for each leaf: 136 for eight leaves of C15, 12 for one of BCC. */
static const double c15_tets = 17, bcc_tets = 12, c15_vertices = 3, bcc_vertices = 2;

/* The share of a leaf that lies inside: whole, none, or by its centre and the places around. */
static double inner_share(const laves__frame *frame, const laves__octree *tree, const laves__node *n) {
  const double half = 0.5 * n->side;
  const laves__vec3 centre = laves__octree_point(tree, n->at[0] + half, n->at[1] + half, n->at[2] + half);
  const laves__side side = laves__frame_side(frame, centre, half * tree->unit);
  if (side != LAVES__UNDECIDED) return side == LAVES__INSIDE ? 1 : 0;
  laves__vec3 at[8];
  double phi[8], inside = 0;
  const double reach = 0.5 * half * tree->unit;
  for (int k = 0; k < 8; k++)
    at[k] = v3(centre.x + (k & 1 ? reach : -reach), centre.y + (k & 2 ? reach : -reach), centre.z + (k & 4 ? reach : -reach));
  laves__frame_evaluate(frame, 8, at, phi, NULL);
  for (int k = 0; k < 8; k++) inside += phi[k] < 0;
  return inside / 8;
}

typedef struct estimate {
  const laves__frame *frame;
  const laves__octree *tree;
  double *share; /* [leaf_count] */
} estimate;

static void find_shares(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const estimate *e = user;
  for (size_t i = begin; i < end; i++) e->share[i] = inner_share(e->frame, e->tree, &e->tree->node[e->tree->leaf[i]]);
}

laves_result laves__graded_estimate(const laves__frame *frame, const laves__demand *demand, laves_context *context, double *tets,
                                    double *vertices, size_t *leaves, laves_error *error) {
  laves__octree tree;
  estimate e = {frame, &tree, NULL};
  laves_result result = laves__octree_build(frame, demand, context, &tree, error);
  *tets = *vertices = 0;
  *leaves = tree.leaf_count;
  if (result != LAVES_OK) goto cleanup;
  e.share = laves__alloc(context, tree.leaf_count, sizeof *e.share);
  if (!e.share) {
    result = laves__fail_memory(context, error);
  } else if (!laves__parallel_for(context, "estimate", tree.leaf_count, 64, find_shares, &e)) {
    result = laves__fail_cancelled(error);
  } else {
    for (size_t i = 0; i < tree.leaf_count; i++) {
      const bool even = tree.node[tree.leaf[i]].even;
      *tets += e.share[i] * (even ? c15_tets : bcc_tets);
      *vertices += e.share[i] * (even ? c15_vertices : bcc_vertices);
    }
  }
  laves__free(context, e.share, tree.leaf_count, sizeof *e.share);
cleanup:
  laves__octree_free(&tree);
  return result;
}
