/* Which sites go.
 *
 * Candidates have colour 2 or 3 and nothing but whole tiles of BCC around. Of those, sites with fewer than BONDS_MIN partners
 * that go stay as well, for they would make more walls than tiles, and so on until no more do; what is left does not depend on
 * the order. */
#include "graded/tiles.h"

#include <string.h>

enum { BONDS_MIN = 2 };

const int8_t laves__bond[4][3] = {{-1, -1, -1}, {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}};

/* The corner `k` of a leaf. */
static uint64_t corner_key(const laves__node *n, int k) {
  return laves__key_of(n->at[0] + (k & 1) * n->side, n->at[1] + (k >> 1 & 1) * n->side, n->at[2] + (k >> 2) * n->side);
}

static laves_result list_corners(const laves__octree *tree, laves__sites *sites, laves_error *error) {
  const size_t count = 8 * tree->leaf_count;
  uint64_t *keys = laves__alloc(tree->context, count, sizeof *keys);
  if (!keys) return laves__fail_memory(tree->context, error);
  for (size_t i = 0; i < tree->leaf_count; i++)
    for (int k = 0; k < 8; k++) keys[8 * i + (size_t)k] = corner_key(&tree->node[tree->leaf[i]], k);
  const bool done = laves__key_table_make(tree->context, keys, count, count, &sites->corner);
  return done ? LAVES_OK : laves__fail_memory(tree->context, error);
}

laves__site_view laves__site_look(const laves__sites *sites, size_t site) {
  const laves__octree *tree = sites->tree;
  laves__site_view view;
  if (site < sites->corner.count) {
    laves__key_place(sites->corner.key[site], view.at);
    view.side = tree->node[laves__octree_locate(tree, view.at[0], view.at[1], view.at[2])].side;
  } else {
    const laves__node *n = &tree->node[tree->leaf[site - sites->corner.count]];
    for (int axis = 0; axis < 3; axis++) view.at[axis] = n->at[axis] + n->side / 2;
    view.side = n->side;
  }
  const int32_t half = view.side / 2;
  view.colour = (view.at[0] / half + view.at[1] / half + view.at[2] / half) & 3;
  return view;
}

size_t laves__bond_end(const laves__sites *sites, const laves__site_view *view, size_t site, int bond) {
  const int32_t reach = view->colour == 2 ? view->side / 2 : -view->side / 2;
  int32_t at[3];
  for (int axis = 0; axis < 3; axis++) at[axis] = view->at[axis] + laves__bond[bond][axis] * reach;
  if (site >= sites->corner.count) return (size_t)laves__key_find(&sites->corner, laves__key_of(at[0], at[1], at[2]));
  const int32_t leaf = laves__octree_locate(sites->tree, at[0], at[1], at[2]);
  return sites->corner.count + (size_t)sites->tree->node[leaf].order;
}

/* Candidates: sites whose tets are all whole tiles of BCC. At a centre that needs an even leaf; at a corner, eight leaves of
 * a side, for then no smaller one touches the edges from it. */
static laves_result mark_candidates(laves__sites *sites, laves_error *error) {
  const laves__octree *tree = sites->tree;
  laves_context *context = tree->context;
  const size_t corners = sites->corner.count;
  uint8_t *leaves = laves__alloc_zeroed(context, corners, 1);
  int32_t *side = laves__alloc(context, corners, sizeof *side);
  laves_result result = LAVES_OK;
  if (!leaves || !side) result = laves__fail_memory(context, error);
  for (size_t i = 0; result == LAVES_OK && i < tree->leaf_count; i++) {
    const laves__node *n = &tree->node[tree->leaf[i]];
    if (laves__cancelled_at(context, "background", i, tree->leaf_count)) result = laves__fail_cancelled(error);
    for (int k = 0; k < 8; k++) {
      const int32_t corner = laves__key_find(&sites->corner, corner_key(n, k));
      if (leaves[corner] == 0) side[corner] = n->side;
      if (side[corner] == n->side) leaves[corner]++;
    }
    sites->gone[corners + i] = n->even && laves__site_look(sites, corners + i).colour >= 2;
  }
  for (size_t i = 0; result == LAVES_OK && i < corners; i++) {
    sites->gone[i] = leaves[i] == 8 && laves__site_look(sites, i).colour >= 2;
    if (laves__cancelled_at(context, "background", i, corners)) result = laves__fail_cancelled(error);
  }
  laves__free(context, side, corners, sizeof *side);
  laves__free(context, leaves, corners, 1);
  return result;
}

static bool is_lonely(const laves__sites *sites, size_t site) {
  const laves__site_view view = laves__site_look(sites, site);
  int partners = 0;
  for (int bond = 0; bond < 4; bond++) partners += sites->gone[laves__bond_end(sites, &view, site, bond)];
  return partners < BONDS_MIN;
}

/* Lets lonely sites stay, and looks at the partners of each once more. */
static laves_result keep_lonely(laves__sites *sites, laves_error *error) {
  size_t *list = NULL, capacity = 0, count = 0;
  bool memory = true, cancelled = false;
  for (size_t site = 0; memory && site < sites->site_count; site++) {
    if (!sites->gone[site]) continue;
    memory = laves__grow(sites->context, &list, &capacity, count + 1, sizeof *list);
    if (memory) list[count++] = site;
  }
  for (size_t step = 0; memory && !cancelled && count > 0; step++) {
    cancelled = laves__cancelled_at(sites->context, "background", step, sites->site_count + step);
    const size_t site = list[--count];
    if (!sites->gone[site] || !is_lonely(sites, site)) continue;
    sites->gone[site] = false;
    const laves__site_view view = laves__site_look(sites, site);
    memory = laves__grow(sites->context, &list, &capacity, count + 4, sizeof *list);
    for (int bond = 0; memory && bond < 4; bond++) list[count++] = laves__bond_end(sites, &view, site, bond);
  }
  laves__free(sites->context, list, capacity, sizeof *list);
  return memory && !cancelled ? LAVES_OK : laves__fail_memory(sites->context, error);
}

laves_result laves__sites_make(const laves__octree *tree, laves__sites *sites, laves_error *error) {
  memset(sites, 0, sizeof *sites);
  sites->context = tree->context;
  sites->tree = tree;
  laves_result result = list_corners(tree, sites, error);
  if (result != LAVES_OK) return result;
  sites->site_count = sites->corner.count + tree->leaf_count;
  sites->gone = laves__alloc_zeroed(tree->context, sites->site_count, sizeof *sites->gone);
  if (!sites->gone) return laves__fail_memory(tree->context, error);
  if (laves__cancelled(tree->context, "background", 0)) return laves__fail_cancelled(error);
  result = mark_candidates(sites, error);
  if (result == LAVES_OK && laves__cancelled(tree->context, "background", 0)) result = laves__fail_cancelled(error);
  return result == LAVES_OK ? keep_lonely(sites, error) : result;
}

void laves__sites_free(laves__sites *sites) {
  if (!sites->context) return;
  laves__free(sites->context, sites->gone, sites->site_count, sizeof *sites->gone);
  laves__key_table_free(&sites->corner);
  memset(sites, 0, sizeof *sites);
}
