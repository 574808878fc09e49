/* Tetrahedra, face by face of the leaves.
 *
 *   face between two leaves of a side:        four BCC tets around the line between the centres, one for each edge of the
 *                                             face; in halves where the middle of the edge is a corner of smaller leaves
 *   face of a leaf on a larger leaf:          the square is a quarter of the larger face; it is parted along the diagonal
 *                                             from the middle of that face, and each half joined to both centres
 *
 *      c--------.        +---m---+        m: middle of the larger face
 *     / \ edge / \       | \ | / |
 *    '---\----'   c'     +---+---+
 *         \  /           | / | \ |
 *          \/            +---+---+
 *
 * A leaf owns its faces towards larger axes and those on larger leaves, and the tets that take the place of sites at its
 * centre and its lower corner. */
#include "graded/tiles.h"

#include <string.h>

enum {
  TETS_MAX = 96,                  /* that one leaf owns */
  GRAPH_TETS_MAX = (1 << 30) - 1, /* their corners are counted in 32 bits */
};

typedef struct filling {
  const laves__octree *tree;
  const laves__sites *sites;
  laves__key_table table; /* of all vertices */
  int32_t (*corner)[8];   /* [leaf_count] vertices at the corners of each leaf, -1 where the site is gone */
  int32_t *centre;        /* [leaf_count] */
  uint32_t *first;        /* [leaf_count + 1] */
  laves__graph *graph;
} filling;

/* The tets that a leaf owns, as they come. */
typedef struct leaf_tets {
  int count;
  int32_t tet[TETS_MAX][4];
  uint8_t tile[TETS_MAX];
} leaf_tets;

static int32_t vertex_at(const filling *f, int32_t x, int32_t y, int32_t z) {
  return laves__key_find(&f->table, laves__key_of(x, y, z));
}

/* Left away where a site is gone: its own tets take the place. */
static void add(leaf_tets *list, int32_t a, int32_t b, int32_t c, int32_t d, laves__tile tile) {
  if (a < 0 || b < 0 || c < 0 || d < 0) return;
  LAVES_ASSERT(list->count < TETS_MAX);
  int32_t *t = list->tet[list->count];
  t[0] = a;
  t[1] = b;
  t[2] = c;
  t[3] = d;
  list->tile[list->count++] = (uint8_t)tile;
}

/* ---- faces ---- */

/* The corners of a leaf's face in direction `way` (axis, and 3 more for the lower side), counter-clockwise from outside. */
static const uint8_t face_corner[6][4] = {
    {1, 3, 7, 5}, {2, 6, 7, 3}, {4, 5, 7, 6}, {0, 4, 6, 2}, {0, 1, 5, 4}, {0, 2, 3, 1},
};

static void corner_place(const laves__node *n, int k, int32_t at[3]) {
  for (int axis = 0; axis < 3; axis++) at[axis] = n->at[axis] + (k >> axis & 1) * n->side;
}

/* The corner in the middle of an edge between two corners of a leaf, or -1. */
static int32_t middle_vertex(const filling *f, const laves__node *n, int a, int b) {
  int32_t p[3], q[3];
  corner_place(n, a, p);
  corner_place(n, b, q);
  return vertex_at(f, (p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2);
}

static void add_equal_face(const filling *f, size_t leaf, size_t other, int way, leaf_tets *list) {
  const laves__node *n = &f->tree->node[f->tree->leaf[leaf]];
  const int32_t c = f->centre[leaf], d = f->centre[other];
  const bool whole = n->even; /* no smaller leaf touches an edge */
  for (int k = 0; k < 4; k++) {
    const int a = face_corner[way][k], b = face_corner[way][(k + 1) & 3];
    const int32_t p = f->corner[leaf][a], q = f->corner[leaf][b];
    const int32_t m = whole ? -1 : middle_vertex(f, n, a, b);
    if (m < 0) {
      add(list, c, p, q, d, LAVES__TILE_BCC);
    } else {
      add(list, c, p, m, d, LAVES__TILE_OTHER);
      add(list, c, m, q, d, LAVES__TILE_OTHER);
    }
  }
}

/* The face of a leaf on the larger leaf `other`. */
static void add_quarter_face(const filling *f, size_t leaf, size_t other, int way, leaf_tets *list) {
  const laves__node *n = &f->tree->node[f->tree->leaf[leaf]], *large = &f->tree->node[f->tree->leaf[other]];
  int middle = 0;
  for (int k = 0; k < 4; k++) {
    int32_t at[3];
    corner_place(n, face_corner[way][k], at);
    bool inner = true; /* in the middle of the larger face along both its axes */
    for (int axis = 0; axis < 3; axis++) inner &= axis == way % 3 || at[axis] == large->at[axis] + large->side / 2;
    if (inner) middle = k;
  }
  int32_t v[4];
  for (int k = 0; k < 4; k++) v[k] = f->corner[leaf][face_corner[way][(middle + k) & 3]];
  for (int k = 1; k < 3; k++) {
    add(list, f->centre[leaf], v[0], v[k], v[k + 1], LAVES__TILE_OTHER);
    add(list, f->centre[other], v[0], v[k + 1], v[k], LAVES__TILE_OTHER);
  }
}

static void add_faces(const filling *f, size_t leaf, leaf_tets *list) {
  const laves__octree *tree = f->tree;
  const laves__node *n = &tree->node[tree->leaf[leaf]];
  for (int way = 0; way < 6; way++) {
    int32_t beyond[3] = {n->at[0] + n->side / 2, n->at[1] + n->side / 2, n->at[2] + n->side / 2};
    beyond[way % 3] += way < 3 ? n->side : -n->side;
    const int32_t index = laves__octree_locate(tree, beyond[0], beyond[1], beyond[2]);
    if (index < 0 || tree->node[index].outside) continue;
    const laves__node *other = &tree->node[index];
    if (other->side > n->side)
      add_quarter_face(f, leaf, (size_t)other->order, way, list);
    else if (other->side == n->side && way < 3)
      add_equal_face(f, leaf, (size_t)other->order, way, list);
  }
}

/* ---- sites that are gone ---- */

/* The vertices around a site: at the ends of its bonds or midway, opposite them, and straight along the axes. */
typedef struct surroundings {
  int32_t bond[4], opposite[4];
  int32_t axis[4][4]; /* [i][j]: straight between bonds i and j */
  bool midway[4];
} surroundings;

static surroundings look_around(const filling *f, size_t site) {
  const laves__site_view view = laves__site_look(f->sites, site);
  const int32_t quarter = view.colour == 2 ? view.side / 4 : -view.side / 4;
  const int32_t *at = view.at;
  surroundings s;
  for (int i = 0; i < 4; i++) {
    const int8_t *b = laves__bond[i];
    s.midway[i] = f->sites->gone[laves__bond_end(f->sites, &view, site, i)];
    const int32_t reach = s.midway[i] ? quarter : 2 * quarter;
    s.bond[i] = vertex_at(f, at[0] + b[0] * reach, at[1] + b[1] * reach, at[2] + b[2] * reach);
    s.opposite[i] = vertex_at(f, at[0] - b[0] * 2 * quarter, at[1] - b[1] * 2 * quarter, at[2] - b[2] * 2 * quarter);
    for (int j = 0; j < i; j++) {
      const int8_t *c = laves__bond[j];
      s.axis[i][j] = s.axis[j][i] = vertex_at(f, at[0] + (b[0] + c[0]) * 2 * quarter, at[1] + (b[1] + c[1]) * 2 * quarter,
                                              at[2] + (b[2] + c[2]) * 2 * quarter);
    }
  }
  return s;
}

/* A tile of C15 when all its bonds end midway. Coordinates are whole, in effect: the sign is exact. */
static void add_oriented(leaf_tets *list, const filling *f, int32_t a, int32_t b, int32_t c, int32_t d, bool whole) {
  const laves__vec3 *p = f->graph->position;
  const laves__tile tile = whole ? LAVES__TILE_C15 : LAVES__TILE_OTHER;
  if (a < 0 || b < 0 || c < 0 || d < 0) return;
  if (v3_det(p[a], p[b], p[c], p[d]) > 0)
    add(list, a, b, c, d, tile);
  else
    add(list, b, a, c, d, tile);
}

static void add_site(const filling *f, size_t site, leaf_tets *list) {
  const surroundings s = look_around(f, site);
  const int32_t *b = s.bond;
  const bool *m = s.midway;
  add_oriented(list, f, b[0], b[1], b[2], b[3], m[0] && m[1] && m[2] && m[3]);
  for (int i = 0; i < 4; i++) {
    const int j = (i + 1) & 3, k = (i + 2) & 3, l = (i + 3) & 3;
    add_oriented(list, f, b[j], b[k], b[l], s.opposite[i], m[j] && m[k] && m[l]);
  }
  for (int i = 0; i < 4; i++)
    for (int j = i + 1; j < 4; j++)
      for (int k = 0; k < 4; k++)
        if (k != i && k != j) add_oriented(list, f, b[i], b[j], s.axis[i][j], s.opposite[k], m[i] && m[j]);
}

static void collect(const filling *f, size_t leaf, leaf_tets *list) {
  const laves__node *n = &f->tree->node[f->tree->leaf[leaf]];
  list->count = 0;
  add_faces(f, leaf, list);
  const size_t centre = f->sites->corner.count + leaf;
  if (f->sites->gone[centre]) add_site(f, centre, list);
  const int32_t corner = laves__key_find(&f->sites->corner, laves__key_of(n->at[0], n->at[1], n->at[2]));
  if (f->sites->gone[corner]) add_site(f, (size_t)corner, list);
}

/* ---- vertices ---- */

static size_t count_midpoints(const laves__sites *sites, uint64_t *keys) {
  size_t count = 0;
  for (size_t site = 0; site < sites->site_count; site++) {
    if (laves__cancelled_at(sites->context, "background", site, sites->site_count)) return 0;
    if (!sites->gone[site]) continue;
    const laves__site_view view = laves__site_look(sites, site);
    if (view.colour != 2) continue;
    for (int bond = 0; bond < 4; bond++) {
      if (!sites->gone[laves__bond_end(sites, &view, site, bond)]) continue;
      int32_t at[3];
      for (int axis = 0; axis < 3; axis++) at[axis] = view.at[axis] + laves__bond[bond][axis] * (view.side / 4);
      if (keys) keys[count] = laves__key_of(at[0], at[1], at[2]);
      count++;
    }
  }
  return count;
}

static uint64_t centre_key(const laves__node *n) {
  return laves__key_of(n->at[0] + n->side / 2, n->at[1] + n->side / 2, n->at[2] + n->side / 2);
}

/* All places that hold a vertex. */
static bool list_vertices(filling *f) {
  const laves__sites *sites = f->sites;
  const size_t capacity = sites->site_count + count_midpoints(sites, NULL);
  uint64_t *keys = laves__alloc(sites->context, capacity, sizeof *keys);
  if (!keys) return false;
  size_t count = 0;
  for (size_t i = 0; i < sites->corner.count; i++)
    if (!sites->gone[i]) keys[count++] = sites->corner.key[i];
  for (size_t i = 0; i < f->tree->leaf_count; i++)
    if (!sites->gone[sites->corner.count + i]) keys[count++] = centre_key(&f->tree->node[f->tree->leaf[i]]);
  count += count_midpoints(sites, keys + count);
  return laves__key_table_make(sites->context, keys, count, capacity, &f->table);
}

static void find_leaf_vertices(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const filling *f = user;
  for (size_t i = begin; i < end; i++) {
    const laves__node *n = &f->tree->node[f->tree->leaf[i]];
    for (int k = 0; k < 8; k++) {
      int32_t at[3];
      corner_place(n, k, at);
      f->corner[i][k] = vertex_at(f, at[0], at[1], at[2]);
    }
    f->centre[i] = laves__key_find(&f->table, centre_key(n));
  }
}

static void place_vertices(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const filling *f = user;
  for (size_t v = begin; v < end; v++) {
    int32_t at[3];
    laves__key_place(f->table.key[v], at);
    f->graph->position[v] = laves__octree_point(f->tree, at[0], at[1], at[2]);
  }
}

/* ---- counting and filling ---- */

static void count_tets(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const filling *f = user;
  for (size_t i = begin; i < end; i++) {
    leaf_tets list;
    collect(f, i, &list);
    f->first[i + 1] = (uint32_t)list.count;
  }
}

static void fill_tets(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const filling *f = user;
  for (size_t i = begin; i < end; i++) {
    leaf_tets list;
    collect(f, i, &list);
    memcpy(f->graph->tet + f->first[i], list.tet, (size_t)list.count * sizeof list.tet[0]);
    memcpy(f->graph->tile + f->first[i], list.tile, (size_t)list.count);
  }
}

static laves_result make_vertices(filling *f, laves_error *error) {
  laves__graph *g = f->graph;
  laves_context *context = f->tree->context;
  const size_t leaves = f->tree->leaf_count;
  f->corner = laves__alloc(context, leaves, sizeof *f->corner);
  f->centre = laves__alloc(context, leaves, sizeof *f->centre);
  f->first = laves__alloc_zeroed(context, leaves + 1, sizeof *f->first);
  if (!f->corner || !f->centre || !f->first || !list_vertices(f)) return laves__fail_memory(context, error);
  g->context = context;
  g->vertex_count = f->table.count;
  g->position = laves__alloc(context, g->vertex_count, sizeof *g->position);
  g->scale = laves__alloc(context, g->vertex_count, sizeof *g->scale);
  g->hull = laves__alloc_zeroed(context, g->vertex_count, sizeof *g->hull);
  if (!g->position || !g->scale || !g->hull) return laves__fail_memory(context, error);
  if (!laves__parallel_for(context, "background", leaves, 64, find_leaf_vertices, f) ||
      !laves__parallel_for(context, "background", g->vertex_count, 256, place_vertices, f))
    return laves__fail_cancelled(error);
  return LAVES_OK;
}

static laves_result make_tets(filling *f, laves_error *error) {
  laves__graph *g = f->graph;
  laves_context *context = f->tree->context;
  const size_t leaves = f->tree->leaf_count;
  if (!laves__parallel_for(context, "background", leaves, 64, count_tets, f)) return laves__fail_cancelled(error);
  size_t total = 0;
  for (size_t i = 0; i < leaves; i++) {
    const uint32_t count = f->first[i + 1];
    f->first[i] = (uint32_t)total;
    total += count;
    f->first[i + 1] = count;
  }
  if (total > GRAPH_TETS_MAX)
    return laves__fail(error, LAVES_ERROR_OPTION, "the sizes ask for %zu tetrahedra, more than %d; choose larger ones", total,
                       GRAPH_TETS_MAX);
  g->tet_count = total;
  g->tet = laves__alloc(context, total, sizeof *g->tet);
  g->tile = laves__alloc(context, total, 1);
  if (!g->tet || !g->tile) return laves__fail_memory(context, error);
  if (!laves__parallel_for(context, "background", leaves, 64, fill_tets, f)) return laves__fail_cancelled(error);
  return LAVES_OK;
}

laves_result laves__tiles_make(const laves__octree *tree, const laves__sites *sites, laves__graph *graph, laves_error *error) {
  laves_context *context = tree->context;
  filling f = {.tree = tree, .sites = sites, .graph = graph};
  memset(graph, 0, sizeof *graph);
  laves_result result = make_vertices(&f, error);
  if (result == LAVES_OK) result = make_tets(&f, error);
  laves__key_table_free(&f.table);
  laves__free(context, f.corner, tree->leaf_count, sizeof *f.corner);
  laves__free(context, f.centre, tree->leaf_count, sizeof *f.centre);
  laves__free(context, f.first, tree->leaf_count + 1, sizeof *f.first);
  return result;
}
