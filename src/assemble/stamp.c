/* Two passes over the bricks, count and stamp, with prefix sums between them, so that no place is written twice and the order
 * depends on nothing but the lattice.
 *
 * Numbers of vertices are as in layer_part.h. Cells without a record are whole: all sites, all tets. */
#include "assemble/stamp.h"

#include <string.h>

enum { ALL_SITES = (1 << LAVES__C15_SITES) - 1 };

static void brick_coordinates(const laves__lattice *l, size_t slot, int32_t first_cell[3]) {
  size_t rest = slot;
  for (int axis = 0; axis < 3; axis++) {
    first_cell[axis] = l->lower[axis] + (int32_t)(rest % (size_t)l->bricks[axis]) * LAVES__BRICK_SIDE;
    rest /= (size_t)l->bricks[axis];
  }
}

/* ---- counting ---- */

static int vertex_count(const laves__stamps *s, int32_t cell) {
  return cell == LAVES__IN ? LAVES__C15_SITES : __builtin_popcount(s->mask[cell]);
}

static int tet_count(const laves__stamps *s, int32_t cell) {
  return cell == LAVES__IN ? LAVES__C15_TETS : laves__stamped_count(&s->lattice->record[cell]);
}

static void count_bricks(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const laves__stamps *s = user;
  for (size_t slot = begin; slot < end; slot++) {
    laves__brick_base count = {0, 0};
    const int32_t entry = s->lattice->directory[slot];
    if (entry == LAVES__IN)
      count = (laves__brick_base){LAVES__BRICK_CELLS * LAVES__C15_SITES, LAVES__BRICK_CELLS * LAVES__C15_TETS};
    for (int inside = 0; entry >= 0 && inside < LAVES__BRICK_CELLS; inside++) {
      const int32_t cell = laves__brick_cell(s->lattice, slot, inside);
      if (cell == LAVES__OUT) continue;
      count.vertex += vertex_count(s, cell);
      count.tet += tet_count(s, cell);
    }
    s->base[slot] = count;
  }
}

static void sum_bricks(const laves__stamps *s) {
  laves__brick_base sum = {0, 0};
  for (size_t slot = 0; slot <= s->lattice->directory_count; slot++) {
    const laves__brick_base count = slot < s->lattice->directory_count ? s->base[slot] : sum;
    s->base[slot] = sum;
    sum.vertex += count.vertex;
    sum.tet += count.tet;
  }
}

/* The first vertex of every record. */
static void number_records(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const laves__stamps *s = user;
  for (size_t slot = begin; slot < end; slot++) {
    if (s->lattice->directory[slot] < 0) continue;
    int64_t first = s->base[slot].vertex;
    for (int inside = 0; inside < LAVES__BRICK_CELLS; inside++) {
      const int32_t cell = laves__brick_cell(s->lattice, slot, inside);
      if (cell == LAVES__OUT) continue;
      if (cell >= 0) s->first[cell] = (int32_t)first;
      first += vertex_count(s, cell);
    }
  }
}

laves_result laves__stamps_count(const laves__stamps *s, laves_error *error) {
  laves_context *context = s->lattice->context;
  const size_t slots = s->lattice->directory_count;
  laves__stamps shared = *s;
  if (!laves__parallel_for(context, "mesh", slots, 16, count_bricks, &shared)) return laves__fail_cancelled(error);
  sum_bricks(s);
  return laves__parallel_for(context, "mesh", slots, 16, number_records, &shared) ? LAVES_OK : laves__fail_cancelled(error);
}

static size_t find_brick(const laves__stamps *s, int64_t i, bool tets) {
  size_t low = 0, high = s->lattice->directory_count;
  while (high - low > 1) {
    const size_t middle = low + (high - low) / 2;
    if ((tets ? s->base[middle].tet : s->base[middle].vertex) <= i)
      low = middle;
    else
      high = middle;
  }
  return low;
}

size_t laves__stamps_vertex_brick(const laves__stamps *s, size_t i) { return find_brick(s, (int64_t)i, false); }
size_t laves__stamps_tet_brick(const laves__stamps *s, size_t i) { return find_brick(s, (int64_t)i, true); }

/* ---- points ---- */

static void place_sites(const laves__stamps *s, const int32_t cell[3], int32_t entry, laves__vec3 *points) {
  const laves__record *r = entry < 0 ? NULL : &s->lattice->record[entry];
  const uint32_t mask = r ? s->mask[entry] : ALL_SITES;
  for (int site = 0; site < LAVES__C15_SITES; site++) {
    if (!(mask >> site & 1)) continue;
    *points++ = r && r->vertex[site] >= 0 ? s->placed[r->vertex[site]]
                                          : laves__frame_to_input(&s->frame, laves__site_position(cell, site));
  }
}

void laves__stamp_points(const laves__stamps *s, size_t brick, size_t begin, size_t end, laves__vec3 *out) {
  size_t next = (size_t)s->base[brick].vertex;
  int32_t origin[3];
  brick_coordinates(s->lattice, brick, origin);
  for (int inside = 0; inside < LAVES__BRICK_CELLS && next < end; inside++) {
    const int32_t entry = laves__brick_cell(s->lattice, brick, inside);
    if (entry == LAVES__OUT) continue;
    const size_t first = next, last = next + (size_t)vertex_count(s, entry);
    next = last;
    if (last <= begin) continue;
    const int32_t cell[3] = {origin[0] + inside % LAVES__BRICK_SIDE, origin[1] + inside / LAVES__BRICK_SIDE % LAVES__BRICK_SIDE,
                             origin[2] + inside / (LAVES__BRICK_SIDE * LAVES__BRICK_SIDE)};
    if (first >= begin && last <= end) {
      place_sites(s, cell, entry, out + (first - begin));
      continue;
    }
    laves__vec3 some[LAVES__C15_SITES];
    place_sites(s, cell, entry, some);
    const size_t from = first > begin ? first : begin, to = last < end ? last : end;
    memcpy(out + (from - begin), some + (from - first), (to - from) * sizeof *out);
  }
}

/* ---- tets ---- */

/* First vertices of the cells of a 5 x 5 x 5 block: the brick and its forward neighbours. */
enum { BLOCK = LAVES__BRICK_SIDE + 1 };

typedef struct block {
  int32_t first[BLOCK * BLOCK * BLOCK]; /* first vertex; undefined for cells outside */
  int32_t entry[BLOCK * BLOCK * BLOCK];
} block;

/* First vertices of the cells of one brick into the part of the block where the brick lies. */
static void load_brick(const laves__stamps *s, const int32_t brick[3], const int offset[3], block *b) {
  const laves__lattice *l = s->lattice;
  for (int axis = 0; axis < 3; axis++)
    if (brick[axis] >= l->bricks[axis]) return; /* beyond the directory all is outside, and no kept tet reaches there */
  const size_t slot = (size_t)brick[0] + (size_t)l->bricks[0] * ((size_t)brick[1] + (size_t)l->bricks[1] * (size_t)brick[2]);
  if (l->directory[slot] == LAVES__OUT) return;
  int64_t first = s->base[slot].vertex;
  for (int inside = 0; inside < LAVES__BRICK_CELLS; inside++) {
    const int32_t entry = laves__brick_cell(l, slot, inside);
    if (entry == LAVES__OUT) continue;
    const int at[3] = {offset[0] + inside % LAVES__BRICK_SIDE, offset[1] + inside / LAVES__BRICK_SIDE % LAVES__BRICK_SIDE,
                       offset[2] + inside / (LAVES__BRICK_SIDE * LAVES__BRICK_SIDE)};
    if (at[0] < BLOCK && at[1] < BLOCK && at[2] < BLOCK) {
      const int index = at[0] + BLOCK * (at[1] + BLOCK * at[2]);
      b->first[index] = (int32_t)first;
      b->entry[index] = entry;
    }
    first += vertex_count(s, entry);
  }
}

static void load_block(const laves__stamps *s, size_t slot, block *b) {
  const laves__lattice *l = s->lattice;
  const int32_t at[3] = {(int32_t)(slot % (size_t)l->bricks[0]), (int32_t)(slot / (size_t)l->bricks[0] % (size_t)l->bricks[1]),
                         (int32_t)(slot / (size_t)l->bricks[0] / (size_t)l->bricks[1])};
  for (int forward = 0; forward < 8; forward++) {
    const int f[3] = {forward & 1, forward >> 1 & 1, forward >> 2};
    load_brick(s, (int32_t[3]){at[0] + f[0], at[1] + f[1], at[2] + f[2]},
               (int[3]){f[0] * LAVES__BRICK_SIDE, f[1] * LAVES__BRICK_SIDE, f[2] * LAVES__BRICK_SIDE}, b);
  }
}

/* The corner of a tet in a block: how far its cell lies behind the owner's. */
static const int shift_in_block[8] = {
    0, 1, BLOCK, BLOCK + 1, BLOCK *BLOCK, BLOCK *BLOCK + 1, BLOCK *BLOCK + BLOCK, BLOCK *BLOCK + BLOCK + 1};

static int32_t block_vertex(const laves__stamps *s, const block *b, int cell, int site) {
  if (b->entry[cell] < 0) return b->first[cell] + site;
  return b->first[cell] + __builtin_popcount(s->mask[b->entry[cell]] & ((UINT32_C(1) << site) - 1));
}

/* The common case: a cell whose forward neighbours are whole, too, so a vertex is a sum. */
static void stamp_whole(const block *b, int owner, int32_t (*tets)[4]) {
  int32_t first[8];
  for (int shift = 0; shift < 8; shift++) first[shift] = b->first[owner + shift_in_block[shift]];
  for (int tet = 0; tet < LAVES__C15_TETS; tet++)
    for (int k = 0; k < 4; k++) {
      const laves__c15_corner corner = laves__c15_tet[tet][k];
      tets[tet][k] = first[corner.shift] + corner.site;
    }
}

static void stamp_some(const laves__stamps *s, const block *b, int owner, const uint64_t set[3], int32_t (*tets)[4]) {
  for (int word = 0; word < 3; word++)
    for (uint64_t rest = set[word]; rest; rest &= rest - 1) {
      const int tet = 64 * word + __builtin_ctzll(rest);
      for (int k = 0; k < 4; k++) {
        const laves__c15_corner corner = laves__c15_tet[tet][k];
        (*tets)[k] = block_vertex(s, b, owner + shift_in_block[corner.shift], corner.site);
      }
      tets++;
    }
}

static bool is_whole(const block *b, int owner) {
  for (int shift = 0; shift < 8; shift++)
    if (b->entry[owner + shift_in_block[shift]] != LAVES__IN) return false;
  return true;
}

static void stamp_cell(const laves__stamps *s, const block *b, int owner, int32_t entry, int32_t (*tets)[4]) {
  static const uint64_t all_tets[3] = {UINT64_MAX, UINT64_MAX, (UINT64_C(1) << (LAVES__C15_TETS - 128)) - 1};
  if (entry == LAVES__IN && is_whole(b, owner))
    stamp_whole(b, owner, tets);
  else
    stamp_some(s, b, owner, entry < 0 ? all_tets : s->lattice->record[entry].stamped, tets);
}

void laves__stamp_tets(const laves__stamps *s, size_t brick, size_t begin, size_t end, int32_t (*out)[4]) {
  if (s->base[brick + 1].tet == s->base[brick].tet) return;
  block b;
  load_block(s, brick, &b);
  size_t next = (size_t)s->base[brick].tet;
  for (int inside = 0; inside < LAVES__BRICK_CELLS && next < end; inside++) {
    const int32_t entry = laves__brick_cell(s->lattice, brick, inside);
    if (entry == LAVES__OUT) continue;
    const size_t first = next, last = next + (size_t)tet_count(s, entry);
    next = last;
    if (last <= begin) continue;
    const int owner = inside % LAVES__BRICK_SIDE + BLOCK * (inside / LAVES__BRICK_SIDE % LAVES__BRICK_SIDE +
                                                            BLOCK * (inside / (LAVES__BRICK_SIDE * LAVES__BRICK_SIDE)));
    if (first >= begin && last <= end) {
      stamp_cell(s, &b, owner, entry, out + (first - begin));
      continue;
    }
    int32_t some[LAVES__C15_TETS][4];
    stamp_cell(s, &b, owner, entry, some);
    const size_t from = first > begin ? first : begin, to = last < end ? last : end;
    memcpy(out + (from - begin), some + (from - first), (to - from) * sizeof *out);
  }
}
