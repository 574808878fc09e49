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
#include <string.h>

#include "snap/snap.h"
#include "snap/star_graph.h"

typedef enum verdict { FAN, INTERIOR, WALL, PARTS } verdict;

static verdict judge(const laves__star_graph *g, uint64_t kept) {
  if (kept == 0) return FAN;
  if (kept == g->all) return INTERIOR;
  bool parts = false;
  for (uint64_t rest = kept; rest;) {
    const uint64_t piece = laves__first_piece(g, rest);
    const uint64_t outside = g->all & ~piece;
    if (laves__first_piece(g, outside) != outside) return WALL;
    rest &= ~piece;
    parts |= piece != kept;
  }
  return parts ? PARTS : FAN;
}

static int count_pieces(const laves__star_graph *g, uint64_t set) {
  int count = 0;
  for (; set; set &= ~laves__first_piece(g, set)) count++;
  return count;
}

/* Pieces of K and of its complement beyond one of each. */
static int surplus(const laves__star_graph *g, uint64_t kept) {
  if (kept == 0 || kept == g->all) return 0;
  return count_pieces(g, kept) + count_pieces(g, g->all & ~kept) - 2;
}

typedef struct repair {
  laves__lattice *lattice;
  laves__star_graph graph[LAVES__C15_SITES]; /* of the tiling */
  uint8_t slot[LAVES__C15_TETS][4];          /* of the tiling: where a tet is in the star of its corner k */
  uint64_t (*kept)[LAVES__C15_SITES];        /* [capacity] laves__star_kept() of ON sites, always as it is now */
  uint8_t (*verdicts)[LAVES__C15_SITES];     /* [capacity], those of earlier rounds where nothing changed */
  bool *dirty;                               /* [capacity] records to judge again */
  size_t kept_capacity, verdict_capacity, dirty_capacity, known; /* records that have verdicts */
} repair;

/* A site's graph: the tiling's is known, another is made in `room`. */
static const laves__star_graph *graph_at(const repair *w, laves__site s, laves__star_graph *room) {
  if (!w->lattice->graph) return &w->graph[s.site];
  laves__star_graph_make(w->lattice, s, room);
  return room;
}

static int slot_at(const repair *w, laves__site s, laves__tet tet, int corner) {
  return w->lattice->graph ? laves__star_slot(w->lattice, s, tet) : w->slot[tet.tet][corner];
}

static void judge_records(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const repair *w = user;
  for (size_t i = begin; i < end; i++) {
    if (!w->dirty[i]) continue;
    const laves__record *r = &w->lattice->record[i];
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      w->verdicts[i][site] = FAN;
      if (r->label[site] != LAVES__LABEL_ON) continue;
      laves__star_graph room;
      w->kept[i][site] = laves__star_kept(w->lattice, (int32_t)i, site);
      w->verdicts[i][site] = (uint8_t)judge(graph_at(w, (laves__site){(int32_t)i, (uint8_t)site}, &room), w->kept[i][site]);
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

/* What changes in a record of the tiling changes stars in it and in those around. */
static void soil_cell(const repair *w, int32_t record) {
  for (int k = 0; k < 27; k++) {
    const int32_t around = w->lattice->record[record].around[k];
    if (around >= 0 && (size_t)around < w->known) w->dirty[around] = true;
  }
}

/* After a change of the labels of a site and, perhaps, of its neighbours: their stars, and those of the neighbours' neighbours.
 */
static void soil_around(const repair *w, laves__site s) {
  if (!w->lattice->graph) {
    soil_cell(w, s.cell);
    return;
  }
  const laves__ring ring = laves__ring_of(w->lattice, s);
  for (int k = 0; k < ring.count; k++) {
    const laves__ring next = laves__ring_of(w->lattice, laves__ring_at(&ring, k));
    for (int j = 0; j < next.count; j++) w->dirty[laves__ring_at(&next, j).cell] = true;
  }
}

static void renew_kept(const repair *w, laves__site s) {
  if (s.cell >= 0 && (size_t)s.cell < w->known && laves__site_label(w->lattice, s) == LAVES__LABEL_ON)
    w->kept[s.cell][s.site] = laves__star_kept(w->lattice, s.cell, s.site);
}

/* After a change of the labels of a site and, perhaps, of its neighbours. */
static void renew_around(const repair *w, laves__site s) {
  const laves__ring ring = laves__ring_of(w->lattice, s);
  for (int k = 0; k < ring.count; k++) {
    const laves__site n = laves__ring_at(&ring, k);
    if (n.cell < 0) continue;
    renew_kept(w, n);
    const laves__ring next = laves__ring_of(w->lattice, n);
    for (int j = 0; j < next.count; j++) renew_kept(w, laves__ring_at(&next, j));
  }
}

/* How much adding a tet, or taking it away, lowers the surplus around its four corners. */
static int toggle_gain(const repair *w, laves__tet tet, const laves__site corner[4]) {
  int gain = 0;
  for (int k = 0; k < 4; k++) {
    laves__star_graph room;
    const laves__star_graph *g = graph_at(w, corner[k], &room);
    const uint64_t kept = w->kept[corner[k].cell][corner[k].site];
    gain += surplus(g, kept) - surplus(g, kept ^ UINT64_C(1) << slot_at(w, corner[k], tet, k));
  }
  return gain;
}

static void toggle(const repair *w, laves__tet tet) {
  laves__site corner[4];
  laves__corners_of(w->lattice, tet, corner);
  laves__toggle_tet(w->lattice, tet, LAVES__TET_SOLID);
  for (int k = 0; k < 4; k++) {
    w->kept[corner[k].cell][corner[k].site] ^= UINT64_C(1) << slot_at(w, corner[k], tet, k);
    w->dirty[corner[k].cell] = true;
  }
  if (!w->lattice->graph) soil_cell(w, tet.cell);
}

/* Adds or takes away the one tet with four corners ON around a site that lowers the surplus most; false when none does. */
static bool toggle_one(const repair *w, laves__site s) {
  laves__tet best = {-1, 0};
  int best_gain = 0;
  for (int k = 0; k < laves__star_size(w->lattice, s); k++) {
    const laves__tet tet = laves__star_at(w->lattice, s, k).tet;
    if (tet.cell < 0) continue;
    if (!laves__tet_is(w->lattice, tet, LAVES__TET_SOLID) && !laves__tet_is(w->lattice, tet, LAVES__TET_ELIGIBLE)) continue;
    laves__site corner[4];
    laves__corners_of(w->lattice, tet, corner);
    bool on = true;
    for (int j = 0; j < 4; j++) on &= corner[j].cell >= 0 && laves__site_label(w->lattice, corner[j]) == LAVES__LABEL_ON;
    if (!on) continue;
    const int gain = toggle_gain(w, tet, corner);
    if (gain <= best_gain) continue;
    best_gain = gain;
    best = tet;
  }
  if (best.cell >= 0) toggle(w, best);
  return best.cell >= 0;
}

/* Gives every cell around a record of the tiling one of its own, so that labels can be changed there. */
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
static void trim(laves__lattice *lattice, laves__site s) {
  lattice->record[s.cell].label[s.site] = LAVES__LABEL_OUT;
  const laves__ring ring = laves__ring_of(lattice, s);
  for (int k = 0; k < ring.count; k++) {
    const laves__site n = laves__ring_at(&ring, k);
    if (laves__site_label(lattice, n) == LAVES__LABEL_IN) lattice->record[n.cell].label[n.site] = LAVES__LABEL_ON;
  }
}

bool laves__part_site(const laves__lattice *lattice, int32_t record, int site, laves__parted *parted) {
  const laves__site s = {record, (uint8_t)site};
  laves__star_graph graph;
  laves__star_graph_make(lattice, s, &graph);
  if (!laves__grow(lattice->context, &parted->item, &parted->capacity, parted->count + 1, sizeof *parted->item)) return false;
  laves__parted_site *item = &parted->item[parted->count++];
  memset(item, 0, sizeof *item);
  item->site = laves__site_id(s);
  for (uint64_t rest = laves__star_kept(lattice, record, site); rest;) {
    const uint64_t piece = laves__first_piece(&graph, rest);
    LAVES_ASSERT(item->fan_count < LAVES__FAN_LIMIT);
    item->fan[item->fan_count++] = piece;
    rest &= ~piece;
  }
  return true;
}

void laves__parted_free(laves_context *context, laves__parted *parted) {
  laves__free(context, parted->item, parted->capacity, sizeof *parted->item);
  laves__free(context, parted->trimmed, parted->trimmed_capacity, sizeof *parted->trimmed);
  memset(parted, 0, sizeof *parted);
}

static bool note_trimmed(laves_context *context, laves__parted *parted, uint32_t id) {
  if (!laves__grow(context, &parted->trimmed, &parted->trimmed_capacity, parted->trimmed_count + 1, sizeof *parted->trimmed))
    return false;
  parted->trimmed[parted->trimmed_count++] = id;
  return true;
}

/* Room around the walls, so that they can be trimmed; false when memory is short. */
static bool make_room_at_walls(repair *w) {
  laves__lattice *lattice = w->lattice;
  const size_t records = w->known;
  for (size_t i = 0; i < records && !lattice->graph; i++) {
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
static bool mend_site(const repair *w, laves__site s, laves__parted *parted, size_t *pinches, bool *again) {
  laves__lattice *lattice = w->lattice;
  const verdict found = (verdict)w->verdicts[s.cell][s.site];
  while (found != INTERIOR && toggle_one(w, s)) *again = true;
  const bool on = laves__site_label(lattice, s) == LAVES__LABEL_ON; /* earlier changes may have ended that */
  laves__star_graph room;
  const verdict now = on ? judge(graph_at(w, s, &room), w->kept[s.cell][s.site]) : FAN;
  if (now == INTERIOR) {
    lattice->record[s.cell].label[s.site] = LAVES__LABEL_IN;
  } else if (now == WALL && found == WALL) { /* only there room was made */
    if (!note_trimmed(lattice->context, parted, laves__site_id(s))) return false;
    trim(lattice, s);
    ++*pinches;
  } else {
    return now != PARTS || laves__part_site(lattice, s.cell, s.site, parted);
  }
  renew_around(w, s);
  soil_around(w, s);
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
    const laves__site s = laves__site_of((uint32_t)id);
    if (w->verdicts[s.cell][s.site] != FAN && !mend_site(w, s, parted, pinches, again)) return laves__fail_memory(context, error);
  }
  return LAVES_OK;
}

laves_result laves__pinch_repair(laves__lattice *lattice, laves__parted *parted, size_t *pinches, laves_error *error) {
  repair w = {.lattice = lattice};
  for (int site = 0; site < LAVES__C15_SITES; site++) {
    if (!lattice->graph) laves__star_graph_make(lattice, (laves__site){0, (uint8_t)site}, &w.graph[site]);
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
