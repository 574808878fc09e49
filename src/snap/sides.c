/* Sites on the surface with the outside on two sides.
 *
 *        OUT        OUT         the tets around such a site that reach outside fall into two pieces: a wall is so thin there,
 *     ---- ON ----- ON ----     mostly near its rim, that one vertex would stand on both of its faces. The outer sites of the
 *        OUT        OUT         smaller piece go ON as well, when the solid is between their feet and the site's.
 *
 * Otherwise the repair of pinches would have to trim the wall. */
#include <string.h>

#include "snap/snap.h"
#include "snap/star_graph.h"

enum { ROUNDS = 3 };
static const double reach = 1.2;      /* local sizes from a site to its foot */
static const double depth_min = 0.03; /* local sizes: how deep the middle between two feet must lie */

typedef struct sides {
  const laves__frame *frame;
  laves__lattice *lattice;
  laves__feet *feet;
  const uint32_t *suspects; /* [record_count] sites to look at */
  uint32_t *two_sided;      /* [record_count] of those, what was found */
  uint32_t *wanted;         /* [record_count] outer sites whose feet are needed */
} sides;

/* The tets around a site that have a corner outside. */
static uint64_t outer_tets(const laves__lattice *lattice, laves__site s) {
  uint64_t set = 0;
  for (int k = 0, size = laves__star_size(lattice, s); k < size; k++) {
    const laves__tet tet = laves__star_at(lattice, s, k).tet;
    bool outer = tet.cell == LAVES__OUT;
    if (tet.cell >= 0) {
      laves__site corner[4];
      laves__corners_of(lattice, tet, corner);
      for (int j = 0; j < 4; j++) outer |= laves__site_label(lattice, corner[j]) == LAVES__LABEL_OUT;
    }
    if (outer) set |= UINT64_C(1) << k;
  }
  return set;
}

/* The smaller piece of the outside at a site, where the rest hangs together and the outside is in two pieces; else none. */
static uint64_t smaller_side(const laves__lattice *lattice, laves__site s) {
  const uint64_t outside = outer_tets(lattice, s);
  if (outside == 0) return 0;
  laves__star_graph graph;
  laves__star_graph_make(lattice, s, &graph);
  const uint64_t first = laves__first_piece(&graph, outside), second = outside & ~first, rest = graph.all & ~outside;
  if (second == 0 || rest == 0) return 0;
  if (laves__first_piece(&graph, second) != second || laves__first_piece(&graph, rest) != rest) return 0;
  return __builtin_popcountll(first) < __builtin_popcountll(second) ? first : second;
}

static void find_two_sided(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const sides *w = user;
  for (size_t i = begin; i < end; i++) {
    w->two_sided[i] = 0;
    for (uint32_t mask = w->suspects[i]; mask; mask &= mask - 1) {
      const laves__site s = {(int32_t)i, (uint8_t)__builtin_ctz(mask)};
      if (laves__site_label(w->lattice, s) == LAVES__LABEL_ON && smaller_side(w->lattice, s)) w->two_sided[i] |= mask & -mask;
    }
  }
}

/* The outer corners of a set of tets of a star; at most LAVES__LINK_LIMIT. */
static int outer_sites(const laves__lattice *lattice, laves__site s, uint64_t set, laves__site sites[LAVES__LINK_LIMIT]) {
  int count = 0;
  for (; set; set &= set - 1) {
    laves__site corner[4];
    const laves__tet tet = laves__star_at(lattice, s, __builtin_ctzll(set)).tet;
    if (tet.cell < 0) continue;
    laves__corners_of(lattice, tet, corner);
    for (int j = 0; j < 4; j++) {
      if (corner[j].cell < 0 || laves__site_label(lattice, corner[j]) != LAVES__LABEL_OUT || laves__is_hull(lattice, corner[j]))
        continue;
      bool known = false;
      for (int i = 0; i < count; i++) known |= laves__site_id(sites[i]) == laves__site_id(corner[j]);
      if (!known && count < LAVES__LINK_LIMIT) sites[count++] = corner[j];
    }
  }
  return count;
}

static void want_feet(const sides *w) {
  for (size_t i = 0; i < w->lattice->record_count; i++)
    for (uint32_t mask = w->two_sided[i]; mask; mask &= mask - 1) {
      const laves__site s = {(int32_t)i, (uint8_t)__builtin_ctz(mask)};
      laves__site outer[LAVES__LINK_LIMIT];
      const int count = outer_sites(w->lattice, s, smaller_side(w->lattice, s), outer);
      for (int k = 0; k < count; k++) w->wanted[outer[k].cell] |= UINT32_C(1) << outer[k].site;
      w->wanted[i] |= mask & -mask;
    }
}

/* Whether the solid lies between the feet of a site and of an outer one. */
static bool has_wall_between(const sides *w, laves__site s, laves__site outer) {
  const laves__foot *a = laves__feet_get(w->feet, s.cell, s.site), *b = laves__feet_get(w->feet, outer.cell, outer.site);
  const double scale = laves__site_scale(w->lattice, outer);
  if (!a || !b || !(v3_distance(laves__site_place(w->lattice, outer), b->position) < reach * scale)) return false;
  return laves__lies_inside(w->frame, v3_lerp(a->position, b->position, 0.5), depth_min * scale);
}

/* One site after the other, each as the labels are then. */
static bool turn_on(const sides *w) {
  bool any = false;
  for (size_t i = 0; i < w->lattice->record_count; i++)
    for (uint32_t mask = w->two_sided[i]; mask; mask &= mask - 1) {
      const laves__site s = {(int32_t)i, (uint8_t)__builtin_ctz(mask)};
      laves__site outer[LAVES__LINK_LIMIT];
      const int count = outer_sites(w->lattice, s, smaller_side(w->lattice, s), outer);
      bool wall = count > 0;
      for (int k = 0; k < count && wall; k++) wall = has_wall_between(w, s, outer[k]);
      for (int k = 0; k < count && wall; k++) {
        w->lattice->record[outer[k].cell].label[outer[k].site] = LAVES__LABEL_ON;
        w->lattice->record[outer[k].cell].forced |= UINT32_C(1) << outer[k].site;
        any = true;
      }
    }
  return any;
}

laves_result laves__side_cover(const laves__frame *frame, const uint32_t *suspects, laves__lattice *lattice, laves__feet *feet,
                               laves_error *error) {
  laves_context *context = lattice->context;
  const size_t records = lattice->record_count;
  laves_result result = LAVES_OK;
  sides w = {frame,
             lattice,
             feet,
             suspects,
             laves__alloc(context, records, sizeof *w.two_sided),
             laves__alloc(context, records, sizeof *w.wanted)};
  if (!w.two_sided || !w.wanted) result = laves__fail_memory(context, error);
  for (int round = 0; result == LAVES_OK && round < ROUNDS; round++) {
    if (!laves__parallel_for(context, "snap", records, 16, find_two_sided, &w)) result = laves__fail_cancelled(error);
    if (result != LAVES_OK) break;
    memset(w.wanted, 0, records * sizeof *w.wanted);
    want_feet(&w);
    result = laves__feet_find(frame, lattice, w.wanted, feet, error);
    if (result == LAVES_OK && !turn_on(&w)) break;
  }
  laves__free(context, w.wanted, records, sizeof *w.wanted);
  laves__free(context, w.two_sided, records, sizeof *w.two_sided);
  return result;
}
