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
  uint8_t *verdicts; /* [record_count][24] for the parallel search */
} repair;

static void judge_records(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const repair *w = user;
  for (size_t i = begin; i < end; i++) {
    const laves__record *r = &w->lattice->record[i];
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      uint8_t *v = &w->verdicts[i * LAVES__C15_SITES + (size_t)site];
      *v = FAN;
      if (r->label[site] == LAVES__LABEL_ON) *v = (uint8_t)judge(&w->graph[site], laves__star_kept(w->lattice, (int32_t)i, site));
    }
  }
}

/* The surplus around the four corners of a tet. */
static int tet_surplus(const repair *w, const laves__site corner[4]) {
  int sum = 0;
  for (int k = 0; k < 4; k++)
    sum += surplus(&w->graph[corner[k].site], laves__star_kept(w->lattice, corner[k].cell, corner[k].site));
  return sum;
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
    const int before = tet_surplus(w, corner);
    laves__flip_bit(owner->solid, star.tet);
    const int gain = before - tet_surplus(w, corner);
    laves__flip_bit(owner->solid, star.tet);
    if (gain <= best_gain) continue;
    best_gain = gain;
    best = owner;
    best_tet = star.tet;
  }
  if (best) laves__flip_bit(best->solid, best_tet);
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

/* One round: judges all ON sites, then acts in the order of their numbers. *again: something changed. */
static laves_result repair_round(repair *w, laves__parted *parted, size_t *pinches, bool *again, laves_error *error) {
  laves__lattice *lattice = w->lattice;
  laves_context *context = lattice->context;
  const size_t records = lattice->record_count;
  laves_result result = LAVES_OK;
  parted->count = 0;
  *again = false;
  w->verdicts = laves__alloc(context, records, LAVES__C15_SITES);
  if (!w->verdicts) return laves__fail_memory(context, error);
  bool memory = true;
  if (!laves__parallel_for(context, "snap", records, 16, judge_records, w)) {
    result = laves__fail_cancelled(error);
    goto cleanup;
  }
  bool grown = false;
  for (size_t i = 0; memory && i < records; i++) {
    bool wall = false;
    for (int site = 0; site < LAVES__C15_SITES; site++) wall |= w->verdicts[i * LAVES__C15_SITES + (size_t)site] == WALL;
    if (!wall) continue;
    memory = make_room(lattice, (int32_t[3]){lattice->record[i].xyz[0], lattice->record[i].xyz[1], lattice->record[i].xyz[2]});
    grown = true;
  }
  if (memory && grown) laves__lattice_link(lattice);
  for (size_t id = 0; memory && id < records * LAVES__C15_SITES; id++) {
    const int32_t record = (int32_t)(id / LAVES__C15_SITES);
    const int site = (int)(id % LAVES__C15_SITES);
    if (w->verdicts[id] == FAN) continue;
    while (w->verdicts[id] != INTERIOR && toggle_one(w, record, site)) *again = true;
    const verdict now = judge(&w->graph[site], laves__star_kept(lattice, record, site)); /* after earlier changes */
    if (now == INTERIOR) {
      lattice->record[record].label[site] = LAVES__LABEL_IN;
      *again = true;
    } else if (now == PARTS) {
      memory = laves__part_site(lattice, record, site, parted);
    } else if (now == WALL && w->verdicts[id] == WALL) { /* only there room was made */
      trim(lattice, record, site);
      ++*pinches;
      *again = true;
    }
  }
  if (!memory) result = laves__fail_memory(context, error);
cleanup:
  laves__free(context, w->verdicts, records, LAVES__C15_SITES);
  w->verdicts = NULL;
  return result;
}

laves_result laves__pinch_repair(laves__lattice *lattice, laves__parted *parted, size_t *pinches, laves_error *error) {
  repair w = {.lattice = lattice};
  for (int site = 0; site < LAVES__C15_SITES; site++) w.graph[site] = graph_of(site);
  for (bool again = true; again;) {
    const laves_result result = repair_round(&w, parted, pinches, &again, error);
    if (result != LAVES_OK) return result;
  }
  *pinches += parted->count;
  return LAVES_OK;
}
