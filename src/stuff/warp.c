/* Warping: which sites snap, and which come back.
 *
 * Every violated site snaps to the nearest of its violating crossings, all at once, so the order does not matter. Then the
 * boundary may touch itself at snapped sites (never at cuts, which have one half of a small ball inside). Around a snapped
 * site the tets form a ball; its surface, the link, is parted in what is kept and what is dropped, and the boundary is one
 * fan exactly when both are connected. In a triangle of the link, with a corner for each of the tet's other three sites:
 *
 *      I         I          I          S         S
 *     /|\       / \        /k\        /k\       / \      k: kept, d: dropped; a triangle without I is dropped whole
 *    / k \     / k \      I---\      I   \     / d \
 *   I-----I   S-----S    /  d  \    / \ d \   S-----O    across a side kept parts meet when it has an I, or two S and
 *                       O-------O  O---\---S             both triangles an I; dropped ones when it has an O, or two S
 *                                                        and neither triangle an I
 *
 * Tets without an inner corner are dropped, so inner sites that all snap take a thin or ragged part away with them. Where
 * nothing would be kept around a snapped inner site, it comes back, the deepest first.
 *
 * A site that pinches, or comes back, is *unsnapped*: it goes back to its place and its violating crossings are moved to just
 * where they no longer violate it. That is a configuration like any other, so what is proved for all of them holds; and a site is
 * unsnapped at most once, so this ends. */
#include <stdlib.h>
#include <string.h>

#include "stuff/stuffing.h"

static double alpha(const laves__stuffing *s, int outer, int site, int other) {
  return s->guarantee->thresholds->alpha[outer][laves__kind_of(site)][laves__kind_of(other)];
}

static bool in_zone(const laves__lattice *lattice, laves__site site) {
  return site.cell >= 0 && lattice->record[site.cell].zone >> site.site & 1;
}

/* ---- snapping ---- */

static laves__snapped nearest_violation(const laves__stuffing *s, laves__site site) {
  laves__snapped best = {.along = UINT8_MAX};
  const laves__record *r = &s->lattice->record[site.cell];
  const int outer = r->label[site.site] == LAVES__LABEL_OUT;
  double nearest = HUGE_VAL;
  for (int k = 0; k < laves__c15_degree[site.site]; k++) {
    int slot;
    const laves__crossings *c = laves__crossing_at(s, site, k, &slot);
    if (!c) continue;
    const double share = outer ? 1 - c->fraction[slot] : c->fraction[slot];
    const double length2 = s->links.length2[site.site][k];
    if (!(share < alpha(s, outer, site.site, laves__c15_neighbour[site.site][k].site)) || !(share * share * length2 < nearest))
      continue;
    nearest = share * share * length2;
    best.share = share;
    best.along = (uint8_t)k;
  }
  return best;
}

static void find_violations(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  laves__stuffing *s = user;
  for (size_t id = begin; id < end; id++) {
    const laves__site site = laves__site_of((uint32_t)id);
    s->snapped[id] = in_zone(s->lattice, site) ? nearest_violation(s, site) : (laves__snapped){.along = UINT8_MAX};
  }
}

laves_result laves__warp(laves__stuffing *s, laves_error *error) {
  laves_context *context = s->lattice->context;
  s->snapped = laves__alloc(context, s->site_count, sizeof *s->snapped);
  if (!s->snapped) return laves__fail_memory(context, error);
  if (!laves__parallel_for(context, "stuff", s->site_count, 512, find_violations, s)) return laves__fail_cancelled(error);
  for (size_t id = 0; id < s->site_count; id++)
    if (s->snapped[id].along != UINT8_MAX)
      s->lattice->record[id / LAVES__C15_SITES].label[id % LAVES__C15_SITES] = LAVES__LABEL_ON;
  return LAVES_OK;
}

/* ---- pinches ---- */

typedef struct link_parts {
  uint32_t kept, dropped; /* bits of star tets that have such a part */
  uint32_t kept_across[LAVES__C15_MAX_STAR], dropped_across[LAVES__C15_MAX_STAR];
} link_parts;

/* Whether a tet of the star is in the mesh though it has no corner IN. */
static bool is_solid(const laves__lattice *lattice, const laves__record *r, laves__c15_star_tet star) {
  const int32_t owner = r->around[star.cell];
  return owner >= 0 && laves__bit(lattice->record[owner].solid, star.tet);
}

static void part_link(const laves__stuffing *s, laves__site site, link_parts *parts) {
  const laves__record *r = &s->lattice->record[site.cell];
  const int size = laves__c15_star_size[site.site];
  int8_t label[LAVES__C15_MAX_DEGREE];
  for (int k = 0; k < laves__c15_degree[site.site]; k++)
    label[k] = (int8_t)laves__site_label(s->lattice, laves__neighbour(r, site.site, k));
  *parts = (link_parts){0};
  for (int t = 0; t < size; t++) {
    const uint8_t *l = s->links.link[site.site][t];
    const bool any_in = label[l[0]] < 0 || label[l[1]] < 0 || label[l[2]] < 0;
    const bool any_out = label[l[0]] > 0 || label[l[1]] > 0 || label[l[2]] > 0;
    const bool kept = any_in || (!any_out && is_solid(s->lattice, r, laves__c15_star[site.site][t]));
    if (kept) parts->kept |= UINT32_C(1) << t;
    if (any_out || !kept) parts->dropped |= UINT32_C(1) << t;
  }
  for (int t = 0; t < size; t++)
    for (int j = 0; j < 3; j++) {
      const uint8_t *l = s->links.link[site.site][t];
      const int a = label[l[(j + 1) % 3]], b = label[l[(j + 2) % 3]];
      const uint32_t other = UINT32_C(1) << s->links.across[site.site][t][j];
      const bool both_on = a == 0 && b == 0;
      if (a < 0 || b < 0 || both_on) parts->kept_across[t] |= other & parts->kept;
      if (a > 0 || b > 0 || both_on) parts->dropped_across[t] |= other & parts->dropped;
    }
}

static bool is_connected(const uint32_t *across, uint32_t set) {
  uint32_t piece = set & -set, front = piece;
  while (front) {
    uint32_t reached = 0;
    for (; front; front &= front - 1) reached |= across[__builtin_ctz(front)];
    front = reached & set & ~piece;
    piece |= front;
  }
  return piece == set;
}

static bool pinches(const laves__stuffing *s, laves__site site) {
  if (s->lattice->record[site.cell].label[site.site] != LAVES__LABEL_ON) return false;
  link_parts parts;
  part_link(s, site, &parts);
  return !is_connected(parts.kept_across, parts.kept) || !is_connected(parts.dropped_across, parts.dropped);
}

/* Moves the crossings that violate a site to its threshold, and the site back to its place. */
static void unsnap(laves__stuffing *s, laves__site site) {
  laves__record *r = &s->lattice->record[site.cell];
  r->label[site.site] = r->sign[site.site];
  s->snapped[laves__site_id(site)].along = UINT8_MAX;
  const int outer = r->sign[site.site] > 0;
  for (int k = 0; k < laves__c15_degree[site.site]; k++) {
    int slot;
    laves__crossings *c = laves__crossing_at(s, site, k, &slot);
    if (!c) continue;
    const double least = alpha(s, outer, site.site, laves__c15_neighbour[site.site][k].site);
    const double share = outer ? 1 - c->fraction[slot] : c->fraction[slot];
    if (share >= least) continue;
    c->fraction[slot] = outer ? 1 - least : least;
  }
}

/* ---- sites that would vanish ---- */

/* A snapped inner site around which nothing is kept, and how deep it lies: the square of its way to the surface. */
typedef struct lone_site {
  double depth;
  uint32_t id;
} lone_site;

static int by_depth(const void *left, const void *right) {
  const lone_site *a = left, *b = right;
  if (a->depth != b->depth) return a->depth > b->depth ? -1 : 1;
  return a->id < b->id ? -1 : a->id > b->id;
}

static bool is_lone(const laves__stuffing *s, laves__site site) {
  const laves__record *r = &s->lattice->record[site.cell];
  if (s->snapped[laves__site_id(site)].along == UINT8_MAX || r->sign[site.site] > 0) return false;
  link_parts parts;
  part_link(s, site, &parts);
  return parts.kept == 0;
}

laves_result laves__keep_inner(laves__stuffing *s, size_t *unsnapped, laves_error *error) {
  laves_context *context = s->lattice->context;
  lone_site *list = NULL;
  size_t capacity = 0, count = 0;
  for (size_t id = 0; id < s->site_count; id++) {
    const laves__site site = laves__site_of((uint32_t)id);
    if (!is_lone(s, site)) continue;
    if (!laves__grow(context, &list, &capacity, count + 1, sizeof *list)) {
      laves__free(context, list, capacity, sizeof *list);
      return laves__fail_memory(context, error);
    }
    const laves__snapped *snapped = &s->snapped[id];
    list[count++] = (lone_site){snapped->share * snapped->share * s->links.length2[site.site][snapped->along], (uint32_t)id};
  }
  if (count) qsort(list, count, sizeof *list, by_depth);
  for (size_t i = 0; i < count; i++) {
    if (!is_lone(s, laves__site_of(list[i].id))) continue; /* one beside it was kept */
    unsnap(s, laves__site_of(list[i].id));
    ++*unsnapped;
  }
  laves__free(context, list, capacity, sizeof *list);
  return LAVES_OK;
}

/* ---- the search for pinches ---- */

/* Puts the ON neighbours of a site on the list of sites to look at. */
static bool push_neighbours(const laves__stuffing *s, laves__site site, uint32_t **list, size_t *capacity, size_t *count) {
  const laves__record *r = &s->lattice->record[site.cell];
  for (int k = 0; k < laves__c15_degree[site.site]; k++) {
    const laves__site n = laves__neighbour(r, site.site, k);
    if (laves__site_label(s->lattice, n) != LAVES__LABEL_ON) continue;
    if (!laves__grow(s->lattice->context, list, capacity, *count + 1, sizeof **list)) return false;
    (*list)[(*count)++] = laves__site_id(n);
  }
  return true;
}

typedef struct pinch_search {
  const laves__stuffing *s;
  bool *pinched;
} pinch_search;

static void find_pinches(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const pinch_search *search = user;
  for (size_t id = begin; id < end; id++) search->pinched[id] = pinches(search->s, laves__site_of((uint32_t)id));
}

/* The site and its neighbours join the zone. */
static void grow_zone(laves__lattice *lattice, laves__site site) {
  laves__record *r = &lattice->record[site.cell];
  r->zone |= UINT32_C(1) << site.site;
  for (int k = 0; k < laves__c15_degree[site.site]; k++) {
    const laves__site n = laves__neighbour(r, site.site, k);
    if (n.cell >= 0) lattice->record[n.cell].zone |= UINT32_C(1) << n.site;
  }
}

/* Whether a site that did not snap by this rule may have cut tets around it. */
static bool borders_on_zone(const laves__stuffing *s, laves__site site) {
  const laves__record *r = &s->lattice->record[site.cell];
  for (int k = 0; k < laves__c15_degree[site.site]; k++)
    if (in_zone(s->lattice, laves__neighbour(r, site.site, k))) return true;
  return false;
}

laves_result laves__unpinch(laves__stuffing *s, laves__parted *parted, size_t *unsnapped, bool *grown, laves_error *error) {
  laves_context *context = s->lattice->context;
  uint32_t *list = NULL;
  size_t capacity = 0, count = 0;
  laves_result result = LAVES_OK;
  pinch_search search = {s, laves__alloc(context, s->site_count, sizeof *search.pinched)};
  bool memory = search.pinched != NULL;
  if (memory && !laves__parallel_for(context, "stuff", s->site_count, 512, find_pinches, &search)) {
    result = laves__fail_cancelled(error);
    goto cleanup;
  }
  for (size_t id = 0; memory && id < s->site_count; id++) {
    if (!search.pinched[id]) continue;
    memory = laves__grow(context, &list, &capacity, count + 1, sizeof *list);
    if (memory) list[count++] = (uint32_t)id;
  }
  *grown = false;
  parted->count = 0;
  for (size_t head = 0; memory && head < count; head++) {
    const laves__site site = laves__site_of(list[head]);
    if (!pinches(s, site)) continue;
    if (in_zone(s->lattice, site)) {
      unsnap(s, site);
      ++*unsnapped;
      memory = push_neighbours(s, site, &list, &capacity, &count);
    } else if (borders_on_zone(s, site)) {
      grow_zone(s->lattice, site);
      *grown = true;
    } else {
      memory = laves__part_site(s->lattice, (int32_t)site.cell, site.site, parted);
    }
  }
cleanup:
  if (!memory) result = laves__fail_memory(context, error);
  laves__free(context, list, capacity, sizeof *list);
  laves__free(context, search.pinched, s->site_count, sizeof *search.pinched);
  return result;
}
