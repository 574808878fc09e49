/* Pinches: places where the kept tetrahedra would touch themselves.
 *
 * Around a site the tiling's tets form a ball; their outer faces triangulate a sphere, its link. Let K be the kept tets.
 * A set of triangles on a sphere that is connected across edges, and whose complement is too, is a disk bounded by one
 * simple cycle (a minimal cut of a planar graph is a cycle of its dual). So the boundary at the site is one fan exactly
 * when K and its complement are both connected across faces that contain the site; and when every boundary vertex has
 * one fan, every boundary edge has two faces.
 *
 *     one fan        K in two pieces       complement in two pieces
 *     KKKKK.....     KKK...KKK             KKKKKKKKK
 *     KKKK......     KK.....KK             ..KKKKK..
 *     KKKv......     ...v.....             ...v.....
 *
 * - First, tets with four corners ON are added or taken away where that leaves fewer pieces around their corners; each such
 *   change lowers the sum of all surplus pieces, so this ends.
 * - A piece of K whose complement falls apart is a wall through which the site reaches both sides: the wall is thinner
 *   than the lattice resolves. The site goes OUT, and the IN sites around it go ON: the wall is trimmed there. Labels only
 *   ever go IN -> ON -> OUT, so this ends.
 * - K in several pieces, each with a connected complement: two parts touch at the site. It becomes one vertex for each
 *   piece, all at the same place; nothing else changes.
 * - K is the whole star (an ON site with no OUT neighbour): it is no boundary, and goes IN. */
#include "snap/snap.h"

#include <string.h>

/* The slots of a star that share a face at the site with each slot, as bits. */
typedef struct star_graph {
  uint32_t across[LAVES__C15_MAX_STAR];
  uint32_t all;
} star_graph;

static star_graph graph_of(int site) {
  star_graph g = {.all = (UINT32_C(1) << laves__c15_star_size[site]) - 1};
  for (int k = 0; k < laves__c15_star_size[site]; k++) {
    g.across[k] = 0;
    for (int j = 0; j < 3; j++) g.across[k] |= UINT32_C(1) << laves__c15_star[site][k].across[j];
  }
  return g;
}

/* The connected piece of `set` that holds its lowest bit. */
static uint32_t first_piece(const star_graph *g, uint32_t set) {
  uint32_t piece = set & -set, front = piece;
  while (front) {
    uint32_t reached = 0;
    for (; front; front &= front - 1) reached |= g->across[__builtin_ctz(front)];
    front = reached & set & ~piece;
    piece |= front;
  }
  return piece;
}

typedef enum verdict { FAN, INTERIOR, WALL, PARTS } verdict;

static verdict judge(const star_graph *g, uint32_t kept) {
  if (kept == 0) return FAN;
  if (kept == g->all) return INTERIOR;
  bool parts = false;
  for (uint32_t rest = kept; rest;) {
    const uint32_t piece = first_piece(g, rest);
    const uint32_t outside = g->all & ~piece;
    if (first_piece(g, outside) != outside) return WALL;
    rest &= ~piece;
    parts |= piece != kept;
  }
  return parts ? PARTS : FAN;
}

static int count_pieces(const star_graph *g, uint32_t set) {
  int count = 0;
  for (; set; set &= ~first_piece(g, set)) count++;
  return count;
}

/* Pieces of K and of its complement beyond one of each. */
static int surplus(const star_graph *g, uint32_t kept) {
  if (kept == 0 || kept == g->all) return 0;
  return count_pieces(g, kept) + count_pieces(g, g->all & ~kept) - 2;
}

typedef struct repair {
  laves__lattice *lattice;
  star_graph graph[LAVES__C15_SITES];
  uint8_t slot[LAVES__C15_TETS][4];      /* where a tet is in the star of its corner k */
  uint32_t (*kept)[LAVES__C15_SITES];    /* [capacity] laves__star_kept() of ON sites, always as it is now */
  uint8_t (*verdicts)[LAVES__C15_SITES]; /* [capacity], those of earlier rounds where nothing changed */
  bool *dirty;                           /* [capacity] records to judge again */
  size_t kept_capacity, verdict_capacity, dirty_capacity, known; /* records that have verdicts */
} repair;

static void judge_records(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const repair *w = user;
  for (size_t i = begin; i < end; i++) {
    if (!w->dirty[i]) continue;
    const laves__record *r = &w->lattice->record[i];
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      w->verdicts[i][site] = FAN;
      if (r->label[site] != LAVES__LABEL_ON) continue;
      w->kept[i][site] = laves__star_kept(w->lattice, (int32_t)i, site);
      w->verdicts[i][site] = (uint8_t)judge(&w->graph[site], w->kept[i][site]);
    }
  }
}

/* Verdicts for records that are new; false when memory is short. */
static bool admit_records(repair *w) {
  const size_t records = w->lattice->record_count;
  laves_context *context = w->lattice->context;
  if (!laves__grow(context, &w->kept, &w->kept_capacity, records, sizeof *w->kept) ||
      !laves__grow(context, &w->verdicts, &w->verdict_capacity, records, sizeof *w->verdicts) ||
      !laves__grow(context, &w->dirty, &w->dirty_capacity, records, sizeof *w->dirty))
    return false;
  for (; w->known < records; w->known++) w->dirty[w->known] = true;
  return true;
}

/* What changes in a record changes stars in it and in those around. */
static void soil(const repair *w, int32_t record) {
  for (int k = 0; k < 27; k++) {
    const int32_t around = w->lattice->record[record].around[k];
    if (around >= 0 && (size_t)around < w->known) w->dirty[around] = true;
  }
}

static void renew_kept(const repair *w, laves__site s) {
  if (s.cell >= 0 && (size_t)s.cell < w->known && laves__site_label(w->lattice, s) == LAVES__LABEL_ON)
    w->kept[s.cell][s.site] = laves__star_kept(w->lattice, s.cell, s.site);
}

/* After a change of the labels of a site and, perhaps, of its neighbours. */
static void renew_around(const repair *w, int32_t record, int site) {
  const laves__record *r = &w->lattice->record[record];
  for (int k = 0; k < laves__c15_degree[site]; k++) {
    const laves__site s = laves__neighbour(r, site, k);
    renew_kept(w, s);
    for (int j = 0; s.cell >= 0 && j < laves__c15_degree[s.site]; j++)
      renew_kept(w, laves__neighbour(&w->lattice->record[s.cell], s.site, j));
  }
}

/* How much adding a tet, or taking it away, lowers the surplus around its four corners. */
static int toggle_gain(const repair *w, int tet, const laves__site corner[4]) {
  int gain = 0;
  for (int k = 0; k < 4; k++) {
    const star_graph *g = &w->graph[corner[k].site];
    const uint32_t kept = w->kept[corner[k].cell][corner[k].site];
    gain += surplus(g, kept) - surplus(g, kept ^ UINT32_C(1) << w->slot[tet][k]);
  }
  return gain;
}

static void toggle(const repair *w, laves__record *owner, int tet) {
  laves__site corner[4];
  laves__tet_sites(owner, tet, corner);
  laves__flip_bit(owner->solid, tet);
  for (int k = 0; k < 4; k++) w->kept[corner[k].cell][corner[k].site] ^= UINT32_C(1) << w->slot[tet][k];
  soil(w, (int32_t)(owner - w->lattice->record));
}

/* Adds or takes away the one tet with four corners ON around a site that lowers the surplus most; false when none does. */
static bool toggle_one(const repair *w, int32_t record, int site) {
  const laves__record *r = &w->lattice->record[record];
  laves__record *best = NULL;
  int best_gain = 0, best_tet = 0;
  for (int k = 0; k < laves__c15_star_size[site]; k++) {
    const laves__c15_star_tet star = laves__c15_star[site][k];
    if (r->around[star.cell] < 0) continue;
    laves__record *owner = &w->lattice->record[r->around[star.cell]];
    if (!laves__bit(owner->solid, star.tet) && !laves__bit(owner->eligible, star.tet)) continue;
    laves__site corner[4];
    laves__tet_sites(owner, star.tet, corner);
    bool on = true;
    for (int j = 0; j < 4; j++) on &= corner[j].cell >= 0 && laves__site_label(w->lattice, corner[j]) == LAVES__LABEL_ON;
    if (!on) continue;
    const int gain = toggle_gain(w, star.tet, corner);
    if (gain <= best_gain) continue;
    best_gain = gain;
    best = owner;
    best_tet = star.tet;
  }
  if (best) toggle(w, best, best_tet);
  return best != NULL;
}

/* Gives every cell around a record one of its own, so that labels can be changed there. */
static bool make_room(laves__lattice *lattice, const int32_t centre[3]) {
  for (int dz = -1; dz <= 1; dz++)
    for (int dy = -1; dy <= 1; dy++)
      for (int dx = -1; dx <= 1; dx++)
        if (laves__lattice_cell(lattice, centre[0] + dx, centre[1] + dy, centre[2] + dz) == LAVES__IN &&
            laves__lattice_add_record(lattice, centre[0] + dx, centre[1] + dy, centre[2] + dz) < 0)
          return false;
  return true;
}

/* Takes an ON site out; the IN sites around go ON. */
static void trim(laves__lattice *lattice, int32_t record, int site) {
  laves__record *r = &lattice->record[record];
  r->label[site] = LAVES__LABEL_OUT;
  for (int k = 0; k < laves__c15_degree[site]; k++) {
    const laves__site s = laves__neighbour(r, site, k);
    if (laves__site_label(lattice, s) == LAVES__LABEL_IN) lattice->record[s.cell].label[s.site] = LAVES__LABEL_ON;
  }
}

bool laves__part_site(const laves__lattice *lattice, int32_t record, int site, laves__parted *parted) {
  const uint32_t kept = laves__star_kept(lattice, record, site);
  const star_graph graph = graph_of(site);
  if (!laves__grow(lattice->context, &parted->item, &parted->capacity, parted->count + 1, sizeof *parted->item)) return false;
  laves__parted_site *item = &parted->item[parted->count++];
  memset(item, 0, sizeof *item);
  item->site = (uint32_t)record * LAVES__C15_SITES + (uint32_t)site;
  for (uint32_t rest = kept; rest;) {
    const uint32_t piece = first_piece(&graph, rest);
    item->fan[item->fan_count++] = piece;
    rest &= ~piece;
  }
  return true;
}

/* Room around the walls, so that they can be trimmed; false when memory is short. */
static bool make_room_at_walls(repair *w) {
  laves__lattice *lattice = w->lattice;
  const size_t records = w->known;
  for (size_t i = 0; i < records; i++) {
    bool wall = false;
    for (int site = 0; site < LAVES__C15_SITES; site++) wall |= w->verdicts[i][site] == WALL;
    if (wall &&
        !make_room(lattice, (int32_t[3]){lattice->record[i].xyz[0], lattice->record[i].xyz[1], lattice->record[i].xyz[2]}))
      return false;
  }
  if (lattice->record_count > records) laves__lattice_link(lattice);
  return admit_records(w);
}

/* Acts at one site; *again: something changed. False when memory is short. */
static bool mend_site(const repair *w, int32_t record, int site, laves__parted *parted, size_t *pinches, bool *again) {
  laves__lattice *lattice = w->lattice;
  const verdict found = (verdict)w->verdicts[record][site];
  while (found != INTERIOR && toggle_one(w, record, site)) *again = true;
  const bool on = lattice->record[record].label[site] == LAVES__LABEL_ON; /* earlier changes may have ended that */
  const verdict now = on ? judge(&w->graph[site], w->kept[record][site]) : FAN;
  if (now == INTERIOR) {
    lattice->record[record].label[site] = LAVES__LABEL_IN;
  } else if (now == WALL && found == WALL) { /* only there room was made */
    trim(lattice, record, site);
    ++*pinches;
  } else {
    return now != PARTS || laves__part_site(lattice, record, site, parted);
  }
  renew_around(w, record, site);
  soil(w, record);
  *again = true;
  return true;
}

/* One round: judges the ON sites around which something changed, then acts in the order of their numbers. */
static laves_result repair_round(repair *w, laves__parted *parted, size_t *pinches, bool *again, laves_error *error) {
  laves_context *context = w->lattice->context;
  parted->count = 0;
  *again = false;
  if (!admit_records(w)) return laves__fail_memory(context, error);
  if (!laves__parallel_for(context, "snap", w->known, 16, judge_records, w)) return laves__fail_cancelled(error);
  memset(w->dirty, 0, w->known * sizeof *w->dirty);
  const size_t records = w->known;
  if (!make_room_at_walls(w)) return laves__fail_memory(context, error);
  for (size_t id = 0; id < records * LAVES__C15_SITES; id++) {
    const size_t record = id / LAVES__C15_SITES;
    const int site = (int)(id % LAVES__C15_SITES);
    if (w->verdicts[record][site] != FAN && !mend_site(w, (int32_t)record, site, parted, pinches, again))
      return laves__fail_memory(context, error);
  }
  return LAVES_OK;
}

laves_result laves__pinch_repair(laves__lattice *lattice, laves__parted *parted, size_t *pinches, laves_error *error) {
  repair w = {.lattice = lattice};
  for (int site = 0; site < LAVES__C15_SITES; site++) {
    w.graph[site] = graph_of(site);
    for (int k = 0; k < laves__c15_star_size[site]; k++)
      w.slot[laves__c15_star[site][k].tet][laves__c15_star[site][k].corner] = (uint8_t)k;
  }
  laves_result result = LAVES_OK;
  for (bool again = true; again && result == LAVES_OK;) result = repair_round(&w, parted, pinches, &again, error);
  if (result == LAVES_OK) *pinches += parted->count;
  laves__free(lattice->context, w.kept, w.kept_capacity, sizeof *w.kept);
  laves__free(lattice->context, w.verdicts, w.verdict_capacity, sizeof *w.verdicts);
  laves__free(lattice->context, w.dirty, w.dirty_capacity, sizeof *w.dirty);
  return result;
}
