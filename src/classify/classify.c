/* Classification of the lattice, top down.
 *
 * Cubes of bricks are asked of the oracle as a whole and halved while it can't decide; then the cells of the undecided
 * bricks are asked, in parallel; the cells that remain get records and the oracle's value at their sites. Every question
 * is about a region widened by the longest edge, so that an edge that starts in a decided cell ends on the same side.
 *
 * Where phi is a distance, a value also speaks for the sites around: if |phi(u)| exceeds |u - v| by more than the longest
 * edge, v has the sign of u and no edge at v crosses. That spares about half of the calls.
 *
 * Departure from the paper (section 4.3): it classifies tiles by their circumspheres on a grid of distances; we ask the
 * domain itself, and only where it matters. */
#include <string.h>

#include "classify/classify.h"

#include "classify/classify_graph.h"

typedef struct undecided {
  int32_t (*brick)[3]; /* brick coordinates in the directory */
  size_t count, capacity;
} undecided;

typedef struct carving {
  const laves__frame *frame;
  laves__lattice *lattice;
  undecided list;
  int8_t *cell_side;   /* [list.count][LAVES__BRICK_CELLS] */
  double *cell_phi;    /* the same for the centres of undecided cells, where phi is a distance; else NULL */
  size_t first_record; /* of those to evaluate */
  bool out_of_memory;
} carving;

/* The side of a cube of cells, widened by the longest edge. */
static laves__side cube_side(const carving *c, const int32_t first_cell[3], int cells) {
  const double half = 0.5 * cells * LAVES__CELL_SIDE;
  const laves__vec3 corner = laves__site_position(first_cell, 0);
  const laves__vec3 centre = v3(corner.x + half, corner.y + half, corner.z + half);
  static const double widen = LAVES__C15_LONGEST_EDGE * (1 + 1e-9);
  return laves__frame_side(c->frame, centre, half + widen);
}

static size_t slot_of(const laves__lattice *l, const int32_t b[3]) {
  return (size_t)b[0] + (size_t)l->bricks[0] * ((size_t)b[1] + (size_t)l->bricks[1] * (size_t)b[2]);
}

/* Decides the bricks [first, first + span) in each axis, as far as they lie in the directory. */
static bool carve_bricks(carving *c, const int32_t first[3], int32_t span) {
  laves__lattice *l = c->lattice;
  int32_t last[3], cell[3];
  for (int axis = 0; axis < 3; axis++) {
    if (first[axis] >= l->bricks[axis]) return true;
    last[axis] = first[axis] + span < l->bricks[axis] ? first[axis] + span : l->bricks[axis];
    cell[axis] = l->lower[axis] + first[axis] * LAVES__BRICK_SIDE;
  }
  if (laves__cancelled(l->context, "classify", 0)) return false;
  const laves__side side = cube_side(c, cell, span * LAVES__BRICK_SIDE);
  if (side == LAVES__OUTSIDE) return true;
  if (side == LAVES__INSIDE) {
    for (int32_t z = first[2]; z < last[2]; z++)
      for (int32_t y = first[1]; y < last[1]; y++)
        for (int32_t x = first[0]; x < last[0]; x++) l->directory[slot_of(l, (int32_t[3]){x, y, z})] = LAVES__IN;
    return true;
  }
  if (span == 1) {
    if (!laves__grow(l->context, &c->list.brick, &c->list.capacity, c->list.count + 1, sizeof *c->list.brick)) {
      c->out_of_memory = true;
      return false;
    }
    for (int axis = 0; axis < 3; axis++) c->list.brick[c->list.count][axis] = first[axis];
    c->list.count++;
    return true;
  }
  const int32_t half = span / 2;
  for (int child = 0; child < 8; child++) {
    const int32_t corner[3] = {first[0] + (child & 1) * half, first[1] + ((child >> 1) & 1) * half,
                               first[2] + (child >> 2) * half};
    if (!carve_bricks(c, corner, half)) return false;
  }
  return true;
}

static void cell_of(const carving *c, size_t brick, int inside, int32_t cell[3]) {
  const int offset[3] = {inside % LAVES__BRICK_SIDE, inside / LAVES__BRICK_SIDE % LAVES__BRICK_SIDE,
                         inside / (LAVES__BRICK_SIDE * LAVES__BRICK_SIDE)};
  for (int axis = 0; axis < 3; axis++)
    cell[axis] = c->lattice->lower[axis] + c->list.brick[brick][axis] * LAVES__BRICK_SIDE + offset[axis];
}

static void carve_cells(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  carving *c = user;
  for (size_t brick = begin; brick < end; brick++)
    for (int inside = 0; inside < LAVES__BRICK_CELLS; inside++) {
      int32_t cell[3];
      cell_of(c, brick, inside, cell);
      c->cell_side[brick * LAVES__BRICK_CELLS + (size_t)inside] = (int8_t)cube_side(c, cell, 1);
    }
}

/* The distance from which a cube of cells, widened by the longest edge, lies on one side. */
static double decisive_distance(int cells) {
  static const double half_diagonal = 0.8660254037844387;
  return (cells * LAVES__CELL_SIDE * half_diagonal + LAVES__C15_LONGEST_EDGE) * (1 + 1e-6);
}

/* The same where phi is a distance: blocks of 2 x 2 x 2 cells first, then the cells of those that it leaves open. */
static void carve_cells_by_distance(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  enum { BLOCK = 2, BLOCKS = 8, SIDE = LAVES__BRICK_SIDE };
  carving *c = user;
  const double half = 0.5 * LAVES__CELL_SIDE;
  for (size_t brick = begin; brick < end; brick++) {
    laves__vec3 centre[BLOCKS];
    double phi[BLOCKS];
    uint32_t hint[BLOCKS] = {LAVES__NO_HINT};
    for (int block = 0; block < BLOCKS; block++) {
      int32_t cell[3];
      cell_of(c, brick, BLOCK * ((block & 1) + SIDE * ((block >> 1 & 1) + SIDE * (block >> 2))), cell);
      const laves__vec3 corner = laves__site_position(cell, 0);
      centre[block] = v3(corner.x + BLOCK * half, corner.y + BLOCK * half, corner.z + BLOCK * half);
    }
    laves__frame_evaluate(c->frame, BLOCKS, centre, phi, hint);
    for (int block = 0; block < BLOCKS; block++) {
      const int first = BLOCK * ((block & 1) + SIDE * ((block >> 1 & 1) + SIDE * (block >> 2)));
      const bool open = !(fabs(phi[block]) > decisive_distance(BLOCK));
      laves__vec3 cell_centre[BLOCKS];
      double cell_phi[BLOCKS];
      uint32_t cell_hint[BLOCKS] = {hint[block]};
      for (int i = 0; i < BLOCKS; i++)
        cell_centre[i] = v3(centre[block].x + (i & 1 ? half : -half), centre[block].y + (i >> 1 & 1 ? half : -half),
                            centre[block].z + (i >> 2 ? half : -half));
      if (open) laves__frame_evaluate(c->frame, BLOCKS, cell_centre, cell_phi, cell_hint);
      for (int i = 0; i < BLOCKS; i++) {
        const size_t at = brick * LAVES__BRICK_CELLS + (size_t)(first + (i & 1) + SIDE * ((i >> 1 & 1) + SIDE * (i >> 2)));
        const double value = open ? cell_phi[i] : phi[block];
        c->cell_phi[at] = value;
        c->cell_side[at] = open && !(fabs(value) > decisive_distance(1)) ? LAVES__UNDECIDED
                           : value < 0                                   ? LAVES__INSIDE
                                                                         : LAVES__OUTSIDE;
      }
    }
  }
}

/* Bricks whose records are made between two looks for a cancel. */
enum { BRICKS_PER_LOOK = 64 };

/* Bricks and records for what could not be decided. Serial, so that records have the same numbers in every run. */
static bool make_records(carving *c) {
  laves__lattice *l = c->lattice;
  size_t records = 0;
  for (size_t i = 0; i < c->list.count * LAVES__BRICK_CELLS; i++) records += c->cell_side[i] == LAVES__UNDECIDED;
  if (!laves__grow(l->context, &l->brick, &l->brick_capacity, c->list.count, sizeof *l->brick)) return false;
  l->record = laves__alloc(l->context, records + records / 8 + 64, sizeof *l->record);
  if (!l->record) return false;
  l->record_capacity = records + records / 8 + 64;
  for (size_t brick = 0; brick < c->list.count; brick++) {
    if (brick % BRICKS_PER_LOOK == 0 && laves__cancelled(l->context, "classify", (double)brick / (double)c->list.count))
      return false;
    const int32_t index = (int32_t)l->brick_count++;
    l->directory[slot_of(l, c->list.brick[brick])] = index;
    const int8_t *side = c->cell_side + brick * LAVES__BRICK_CELLS;
    for (int inside = 0; inside < LAVES__BRICK_CELLS; inside++)
      l->brick[index].cell[inside] = side[inside] == LAVES__INSIDE ? LAVES__IN : LAVES__OUT;
    for (int inside = 0; inside < LAVES__BRICK_CELLS; inside++) {
      int32_t cell[3];
      cell_of(c, brick, inside, cell);
      if (side[inside] != LAVES__UNDECIDED) continue;
      const int32_t record = laves__lattice_add_record(l, cell[0], cell[1], cell[2]);
      if (record < 0) return false;
      if (c->cell_phi) l->record[record].centre_phi = c->cell_phi[brick * LAVES__BRICK_CELLS + (size_t)inside];
    }
  }
  return true;
}

/* Sites are asked in groups; the first is spread over the cell: the face-centred cubic lattice of colour 0. */
enum { GROUP = 4 };

/* Values known in and around a cell. */
typedef struct speakers {
  laves__vec3 at[LAVES__C15_SITES + 1];
  double value[LAVES__C15_SITES + 1];
  int count;
} speakers;

/* Whether a value already known speaks for the point; then *phi has its sign and infinite size. */
static bool spoken_for(const speakers *s, laves__vec3 point, double *phi) {
  for (int u = 0; u < s->count; u++) {
    const double room = fabs(s->value[u]) - LAVES__C15_LONGEST_EDGE * (1 + 1e-6);
    if (room > 0 && room * room > v3_norm2(v3_sub(s->at[u], point))) {
      *phi = s->value[u] < 0 ? -HUGE_VAL : HUGE_VAL;
      return true;
    }
  }
  return false;
}

static void evaluate_by_distance(const laves__frame *frame, laves__record *r) {
  speakers s = {.count = 0};
  uint32_t latest = LAVES__NO_HINT;
  const double half = 0.5 * LAVES__CELL_SIDE;
  const laves__vec3 corner = laves__site_position(r->xyz, 0);
  if (r->centre_phi != 0) {
    s.at[0] = v3(corner.x + half, corner.y + half, corner.z + half);
    s.value[0] = r->centre_phi;
    s.count = 1;
  }
  for (int first = 0; first < LAVES__C15_SITES; first += GROUP) {
    laves__vec3 at[GROUP];
    double value[GROUP];
    uint32_t hint[GROUP];
    int site_of[GROUP], asked = 0;
    for (int site = first; site < first + GROUP; site++) {
      const laves__vec3 p = laves__site_position(r->xyz, site);
      if (spoken_for(&s, p, &r->phi[site])) continue;
      at[asked] = p;
      site_of[asked++] = site;
    }
    hint[0] = latest;
    if (asked) laves__frame_evaluate(frame, (size_t)asked, at, value, hint);
    for (int i = 0; i < asked; i++) {
      r->phi[site_of[i]] = value[i];
      r->hint[site_of[i]] = hint[i];
      s.at[s.count] = at[i];
      s.value[s.count++] = value[i];
      latest = hint[i];
    }
  }
}

/* Cells whose sites are asked in one call, for oracles that like large ones. */
enum { TOGETHER = 16 };

static void evaluate_together(const laves__frame *frame, laves__record *records, size_t count) {
  laves__vec3 at[TOGETHER * LAVES__C15_SITES];
  double phi[TOGETHER * LAVES__C15_SITES];
  uint32_t hint[TOGETHER * LAVES__C15_SITES] = {LAVES__NO_HINT};
  for (size_t i = 0; i < count; i++)
    for (int site = 0; site < LAVES__C15_SITES; site++)
      at[i * LAVES__C15_SITES + (size_t)site] = laves__site_position(records[i].xyz, site);
  laves__frame_evaluate(frame, count * LAVES__C15_SITES, at, phi, hint);
  for (size_t i = 0; i < count; i++) {
    memcpy(records[i].phi, phi + i * LAVES__C15_SITES, sizeof records[i].phi);
    memcpy(records[i].hint, hint + i * LAVES__C15_SITES, sizeof records[i].hint);
  }
}

static void set_signs(laves__record *r) {
  for (int site = 0; site < LAVES__C15_SITES; site++) {
    if (isnan(r->phi[site])) r->phi[site] = HUGE_VAL; /* what has no value is not inside */
    r->sign[site] = r->label[site] = r->phi[site] < 0 ? -1 : 1;
  }
}

static void evaluate_records(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  carving *c = user;
  laves__record *records = c->lattice->record + c->first_record;
  const laves__oracle *oracle = c->frame->oracle;
  const size_t together = oracle->batch > 0 && !oracle->is_distance ? TOGETHER : 1;
  for (size_t i = begin; i < end; i += together) {
    const size_t count = end - i < together ? end - i : together;
    if (oracle->is_distance)
      evaluate_by_distance(c->frame, &records[i]);
    else
      evaluate_together(c->frame, &records[i], count);
    for (size_t k = i; k < i + count; k++) set_signs(&records[k]);
  }
}

/* ---- sealing: what an inconsistent oracle may leave open ---- */

/* Whether all bricks around a slot, and itself, are wholly inside. */
static bool is_deep_brick(const laves__lattice *l, const int32_t b[3]) {
  for (int dz = -1; dz <= 1; dz++)
    for (int dy = -1; dy <= 1; dy++)
      for (int dx = -1; dx <= 1; dx++) {
        const int32_t n[3] = {b[0] + dx, b[1] + dy, b[2] + dz};
        for (int axis = 0; axis < 3; axis++)
          if (n[axis] < 0 || n[axis] >= l->bricks[axis]) return false;
        if (l->directory[slot_of(l, n)] != LAVES__IN) return false;
      }
  return true;
}

static bool is_in_directory(const laves__lattice *l, const int32_t cell[3]) {
  for (int axis = 0; axis < 3; axis++)
    if (cell[axis] < l->lower[axis] || cell[axis] >= l->lower[axis] + l->bricks[axis] * LAVES__BRICK_SIDE) return false;
  return true;
}

/* Records for an inside cell and the outside cells that touch it. */
static bool seal_cell(laves__lattice *l, int32_t x, int32_t y, int32_t z) {
  if (laves__lattice_cell(l, x, y, z) != LAVES__IN) return true;
  bool touches = false;
  for (int k = 0; k < 27; k++) {
    const int32_t n[3] = {x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1};
    if (laves__lattice_cell(l, n[0], n[1], n[2]) != LAVES__OUT) continue;
    touches = true;
    if (is_in_directory(l, n) && laves__lattice_add_record(l, n[0], n[1], n[2]) < 0) return false;
  }
  return !touches || laves__lattice_add_record(l, x, y, z) >= 0;
}

/* The cells of a brick and those around it. */
enum { RIM = 1, WITH_RIM = LAVES__BRICK_SIDE + 2 * RIM };
typedef struct neighbourhood {
  int32_t cell[WITH_RIM][WITH_RIM][WITH_RIM]; /* z, y, x */
} neighbourhood;

/* The cells of one brick that lie in the neighbourhood of brick b; `step` leads from b to it. */
static void look_into(const laves__lattice *l, const int32_t b[3], const int step[3], neighbourhood *n) {
  enum { SIDE = LAVES__BRICK_SIDE };
  int first[3], end[3]; /* in the neighbourhood */
  bool exists = true;
  for (int axis = 0; axis < 3; axis++) {
    first[axis] = step[axis] < 0 ? 0 : RIM + step[axis] * SIDE;
    end[axis] = step[axis] < 0 ? RIM : step[axis] > 0 ? WITH_RIM : RIM + SIDE;
    exists &= b[axis] + step[axis] >= 0 && b[axis] + step[axis] < l->bricks[axis];
  }
  const int32_t entry =
      exists ? l->directory[slot_of(l, (int32_t[3]){b[0] + step[0], b[1] + step[1], b[2] + step[2]})] : LAVES__OUT;
  for (int z = first[2]; z < end[2]; z++)
    for (int y = first[1]; y < end[1]; y++)
      for (int x = first[0]; x < end[0]; x++) {
        const int inside = (x - RIM - step[0] * SIDE) + SIDE * ((y - RIM - step[1] * SIDE) + SIDE * (z - RIM - step[2] * SIDE));
        n->cell[z][y][x] = entry < 0 ? entry : l->brick[entry].cell[inside];
      }
}

static void look_around(const laves__lattice *l, const int32_t b[3], neighbourhood *n) {
  for (int k = 0; k < 27; k++) look_into(l, b, (int[3]){k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1}, n);
}

static void place_in_brick(int inside, int at[3]) {
  at[0] = inside % LAVES__BRICK_SIDE;
  at[1] = inside / LAVES__BRICK_SIDE % LAVES__BRICK_SIDE;
  at[2] = inside / (LAVES__BRICK_SIDE * LAVES__BRICK_SIDE);
}

/* Whether a cell of the brick is inside and touches one outside. */
static bool is_unsealed(const neighbourhood *n, const int at[3]) {
  if (n->cell[at[2] + RIM][at[1] + RIM][at[0] + RIM] != LAVES__IN) return false;
  for (int k = 0; k < 27; k++)
    if (n->cell[at[2] + k / 9][at[1] + k / 3 % 3][at[0] + k % 3] == LAVES__OUT) return true;
  return false;
}

/* Looked up once for all cells of the brick, and again after a change, which is rare. */
static bool seal_brick(laves__lattice *l, const int32_t b[3]) {
  neighbourhood n;
  look_around(l, b, &n);
  for (int inside = 0; inside < LAVES__BRICK_CELLS; inside++) {
    int at[3];
    place_in_brick(inside, at);
    if (!is_unsealed(&n, at)) continue;
    int32_t cell[3];
    for (int axis = 0; axis < 3; axis++) cell[axis] = l->lower[axis] + b[axis] * LAVES__BRICK_SIDE + at[axis];
    if (!seal_cell(l, cell[0], cell[1], cell[2])) return false;
    look_around(l, b, &n);
  }
  return true;
}

/* Where a brick lies; false for one that is whole, away from the border of the solid. */
static bool find_border_brick(const laves__lattice *l, size_t slot, int32_t b[3]) {
  size_t rest = slot;
  for (int axis = 0; axis < 3; axis++) {
    b[axis] = (int32_t)(rest % (size_t)l->bricks[axis]);
    rest /= (size_t)l->bricks[axis];
  }
  return l->directory[slot] != LAVES__OUT && !is_deep_brick(l, b);
}

static double count_unsealed(const void *user, size_t begin, size_t end) {
  const laves__lattice *l = user;
  double count = 0;
  for (size_t slot = begin; slot < end; slot++) {
    int32_t b[3];
    neighbourhood n;
    if (!find_border_brick(l, slot, b)) continue;
    look_around(l, b, &n);
    for (int inside = 0; inside < LAVES__BRICK_CELLS; inside++) {
      int at[3];
      place_in_brick(inside, at);
      count += is_unsealed(&n, at);
    }
  }
  return count;
}

/* Inside cells never touch outside cells when the oracle's answers about boxes agree with one another, which all threads look
 * for; where they do not, both are looked at site by site. */
static bool seal_cells(laves__lattice *l) {
  if (laves__parallel_sum(l->context, NULL, l->directory_count, count_unsealed, l) == 0) return true;
  for (size_t slot = 0; slot < l->directory_count; slot++) {
    int32_t b[3];
    if (find_border_brick(l, slot, b) && !seal_brick(l, b)) return false;
  }
  return true;
}

/* Likewise, no tet around a site may belong to a cell without a record that lies on the other side. What `around` has may have
 * got a record since. */
static bool seal_owners(laves__lattice *l, size_t index) {
  const int32_t at[3] = {l->record[index].xyz[0], l->record[index].xyz[1], l->record[index].xyz[2]};
  for (int site = 0; site < LAVES__C15_SITES; site++) {
    const int32_t beyond = l->record[index].sign[site] < 0 ? LAVES__OUT : LAVES__IN;
    for (int k = 0; k < laves__c15_star_size[site]; k++) {
      const int cell = laves__c15_star[site][k].cell;
      if (l->record[index].around[cell] != beyond) continue;
      const int32_t n[3] = {at[0] + cell % 3 - 1, at[1] + cell / 3 % 3 - 1, at[2] + cell / 9 - 1};
      if (laves__lattice_cell(l, n[0], n[1], n[2]) == beyond && is_in_directory(l, n) &&
          laves__lattice_add_record(l, n[0], n[1], n[2]) < 0)
        return false;
    }
  }
  return true;
}

/* And no edge from a site may cross into a cell without a record. */
static bool seal_record(laves__lattice *l, size_t index) {
  const laves__record *r = &l->record[index];
  bool has[2] = {false, false}, beside[2] = {false, false}; /* signs within; cells around: 0 inside, 1 outside */
  for (int site = 0; site < LAVES__C15_SITES; site++) has[r->sign[site] > 0] = true;
  for (int k = 0; k < 27; k++)
    if (r->around[k] < 0) beside[r->around[k] == LAVES__OUT] = true;
  if (!(has[0] && beside[1]) && !(has[1] && beside[0])) return true;
  const int32_t at[3] = {r->xyz[0], r->xyz[1], r->xyz[2]};
  if (!seal_owners(l, index)) return false; /* r may have moved */
  for (int site = 0; site < LAVES__C15_SITES; site++)
    for (int k = 0; k < laves__c15_degree[site]; k++) {
      r = &l->record[index];
      const laves__site s = laves__neighbour(r, site, k);
      if (s.cell >= 0 || laves__site_sign(l, s) == r->sign[site]) continue;
      const int cell = laves__c15_neighbour[site][k].cell;
      const int32_t n[3] = {at[0] + cell % 3 - 1, at[1] + cell / 3 % 3 - 1, at[2] + cell / 9 - 1};
      if (!is_in_directory(l, n)) return true;
      if (laves__lattice_add_record(l, n[0], n[1], n[2]) < 0) return false;
    }
  return true;
}

/* Evaluates all records, and those that sealing adds, until no edge crosses unseen. */
static laves_result evaluate_all(carving *c, laves_error *error) {
  laves__lattice *l = c->lattice;
  if (!seal_cells(l)) return laves__fail_memory(l->context, error);
  for (c->first_record = 0; c->first_record < l->record_count;) {
    const size_t count = l->record_count - c->first_record;
    if (!laves__parallel_for(l->context, "classify", count, 4, evaluate_records, c)) return laves__fail_cancelled(error);
    laves__lattice_link(l);
    c->first_record += count;
    for (size_t i = 0, known = l->record_count; i < known; i++) {
      if (laves__cancelled_at(l->context, "classify", i, known)) return laves__fail_cancelled(error);
      if (!seal_record(l, i)) return laves__fail_memory(l->context, error);
    }
  }
  return LAVES_OK;
}

/* A solid that reaches the edge of the directory is larger than its bounds say. */
static const laves__record *find_overflow(const laves__lattice *l) {
  for (size_t i = 0; i < l->record_count; i++) {
    const laves__record *r = &l->record[i];
    bool at_edge = false;
    for (int axis = 0; axis < 3; axis++)
      at_edge |= r->xyz[axis] == l->lower[axis] || r->xyz[axis] == l->lower[axis] + l->bricks[axis] * LAVES__BRICK_SIDE - 1;
    for (int site = 0; at_edge && site < LAVES__C15_SITES; site++)
      if (r->sign[site] < 0) return r;
  }
  return NULL;
}

laves_result laves__classify(const laves__frame *frame, laves__lattice *lattice, laves_error *error) {
  if (lattice->graph) return laves__classify_graph(frame, lattice, error);
  laves_context *context = lattice->context;
  carving c = {.frame = frame, .lattice = lattice};
  laves_result result = LAVES_OK;
  int32_t span = 1;
  while (span < lattice->bricks[0] || span < lattice->bricks[1] || span < lattice->bricks[2]) span *= 2;
  bool done = carve_bricks(&c, (int32_t[3]){0, 0, 0}, span);
  if (done) {
    c.cell_side = laves__alloc(context, c.list.count, LAVES__BRICK_CELLS);
    const bool by_distance = frame->oracle->is_distance;
    if (by_distance) c.cell_phi = laves__alloc(context, c.list.count * LAVES__BRICK_CELLS, sizeof *c.cell_phi);
    c.out_of_memory = !c.cell_side || (by_distance && !c.cell_phi);
    done = !c.out_of_memory &&
           laves__parallel_for(context, "classify", c.list.count, 1, by_distance ? carve_cells_by_distance : carve_cells, &c);
    if (done && !make_records(&c)) {
      c.out_of_memory = !laves__is_cancelled(context);
      done = false;
    }
  }
  if (done)
    result = evaluate_all(&c, error);
  else
    result = c.out_of_memory ? laves__fail_memory(context, error) : laves__fail_cancelled(error);
  const laves__record *overflow = result == LAVES_OK ? find_overflow(lattice) : NULL;
  if (overflow) {
    const laves__vec3 at = laves__frame_to_input(frame, laves__site_position(overflow->xyz, 0));
    result =
        laves__fail(error, LAVES_ERROR_INPUT,
                    frame->oracle->source ? "the surface is so open that its inside reaches far beyond it, as near (%g, %g, %g); "
                                            "close its holes, or raise the winding number that counts as inside"
                                          : "the solid reaches beyond its bounds near (%g, %g, %g); give bounds that contain it",
                    at.x, at.y, at.z);
  }
  laves__free(context, c.cell_phi, c.list.count * LAVES__BRICK_CELLS, sizeof *c.cell_phi);
  laves__free(context, c.cell_side, c.list.count, LAVES__BRICK_CELLS);
  laves__free(context, c.list.brick, c.list.capacity, sizeof *c.list.brick);
  return result;
}
