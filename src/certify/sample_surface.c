/* Samples of a surface that only tells signs and projections: an implicit solid, or a function of the caller's.
 *
 * The box of the domain is halved again and again, leaving out blocks that the domain knows to lie on one side, until blocks
 * are eight samples wide, by the edges of the mesh near by. In each block that remains phi is evaluated on a grid, which is far
 * cheaper than asking about small cells one by one. A cell whose corners have both signs projects its centre; the foot is a
 * sample when it lies in the cell, so there is about one sample for each cell that the surface crosses. A sheet between two grid
 * points has no such cell: so a cell far from any of them is tried too, when phi at a corner is small against its steps in the
 * block.
 *
 * Blocks are done in parallel, a wave at a time, and their samples put together in order. A domain that knows nothing of whole
 * blocks may leave too many; then the search is given up and may be tried again with a wider spacing. */
#include "certify/boundary_tree.h"

enum {
  CELLS = 8,
  NODES = CELLS + 1,
  BLOCK_CELLS = CELLS * CELLS * CELLS,
  BLOCK_NODES = NODES * NODES * NODES,
  BLOCKS_MAX = 1 << 17,
  WAVE_BLOCKS = 128,
  BISECTIONS = 40,
};

/* Halves of a cell's diagonal that |phi| over its steepest step may be, for a sheet to be looked for. */
#define SHEET_NEAR 0.87

/* A cube that the surface may cross. */
typedef struct cube {
  laves__vec3 centre;
  double half;
  int depth; /* how many times the first has been halved */
} cube;

typedef struct search {
  laves_context *context;
  const laves__oracle *oracle;
  const laves__boundary_tree *tree;
  double spacing;
  cube *blocks; /* [count] in hand */
  size_t count, capacity;
  size_t first;       /* block of the wave */
  laves__vec3 *found; /* [WAVE_BLOCKS][BLOCK_CELLS] */
  size_t found_counts[WAVE_BLOCKS];
} search;

/* ---- one block ---- */

typedef enum cell_kind { EMPTY, CROSSED, NEAR_ZERO } cell_kind;

typedef struct block {
  laves__vec3 corner; /* the lowest */
  double width;       /* of a cell */
  double phi[BLOCK_NODES];
  uint8_t kinds[BLOCK_CELLS];
} block;

static int node_at(int x, int y, int z) { return x + NODES * (y + NODES * z); }
static int cell_at(int x, int y, int z) { return x + CELLS * (y + CELLS * z); }

static void evaluate_nodes(const search *s, block *b) {
  laves__vec3 points[BLOCK_NODES];
  for (int z = 0; z < NODES; z++)
    for (int y = 0; y < NODES; y++)
      for (int x = 0; x < NODES; x++) points[node_at(x, y, z)] = v3_mad(b->corner, v3(x, y, z), b->width);
  s->oracle->evaluate(s->oracle->self, BLOCK_NODES, points, b->phi, NULL);
}

/* Raises most[i] to |a[i] - b[i]|. */
static void raise_to_changes(double *most, const double *a, const double *b, int count) {
  for (int i = 0; i < count; i++) {
    const double change = fabs(a[i] - b[i]);
    most[i] = change > most[i] ? change : most[i];
  }
}

/* The largest change of phi along an edge of the grid: for each place of a layer over all layers first, which runs side by side.
 */
static double steepest(const block *b) {
  double most[NODES * NODES] = {0}, all = 0;
  for (int z = 0; z < NODES; z++) {
    const double *layer = b->phi + z * NODES * NODES;
    for (int y = 0; y < NODES; y++) raise_to_changes(most + y * NODES, layer + y * NODES, layer + y * NODES + 1, CELLS);
    raise_to_changes(most, layer, layer + NODES, NODES * CELLS);
    if (z < CELLS) raise_to_changes(most, layer, layer + NODES * NODES, NODES * NODES);
  }
  for (int i = 0; i < NODES * NODES; i++) all = most[i] > all ? most[i] : all;
  return all;
}

/* From the values of nodes to those of cells: the least |phi| of the eight corners, and how many are inside. Two at a time along
 * each axis in turn, a third of the steps that corner by corner takes; what is no cell gets what is not looked at. */
static void join_corners(double least[BLOCK_NODES], uint8_t inside[BLOCK_NODES]) {
  for (int step = 1; step <= NODES * NODES; step *= NODES)
    for (int i = 0; i + step < BLOCK_NODES; i++) {
      least[i] = least[i] < least[i + step] ? least[i] : least[i + step];
      inside[i] = (uint8_t)(inside[i] + inside[i + step]);
    }
}

static void find_kinds(block *b) {
  const double near = SHEET_NEAR * steepest(b);
  double least[BLOCK_NODES];
  uint8_t inside[BLOCK_NODES];
  for (int i = 0; i < BLOCK_NODES; i++) {
    least[i] = isnan(b->phi[i]) ? INFINITY : fabs(b->phi[i]);
    inside[i] = b->phi[i] < 0;
  }
  join_corners(least, inside);
  for (int z = 0; z < CELLS; z++)
    for (int y = 0; y < CELLS; y++)
      for (int x = 0; x < CELLS; x++) {
        const int i = node_at(x, y, z);
        b->kinds[cell_at(x, y, z)] = inside[i] > 0 && inside[i] < 8 ? CROSSED : least[i] <= near ? NEAR_ZERO : EMPTY;
      }
}

static bool has_crossed_neighbour(const block *b, int x, int y, int z) {
  for (int k = 0; k < 27; k++) {
    const int u = x + k % 3 - 1, v = y + k / 3 % 3 - 1, w = z + k / 9 - 1;
    if (u < 0 || v < 0 || w < 0 || u >= CELLS || v >= CELLS || w >= CELLS) continue;
    if (b->kinds[cell_at(u, v, w)] == CROSSED) return true;
  }
  return false;
}

/* The place between two points of different sign where the sign changes. */
static laves__vec3 bisect(const search *s, laves__vec3 inside, laves__vec3 outside) {
  for (int i = 0; i < BISECTIONS; i++) {
    const laves__vec3 middle = v3_lerp(inside, outside, 0.5);
    double phi;
    s->oracle->evaluate(s->oracle->self, 1, &middle, &phi, NULL);
    if (phi < 0)
      inside = middle;
    else
      outside = middle;
  }
  return v3_lerp(inside, outside, 0.5);
}

/* Where a crossed cell has no foot, as on flat walls whose gradient vanishes: a place on the way from a corner inside to one
 * outside. */
static bool sample_crossing(const search *s, const block *b, int x, int y, int z, laves__vec3 *place) {
  laves__vec3 corners[2]; /* inside, outside */
  bool has[2] = {false, false};
  for (int k = 0; k < 8; k++) {
    const int u = x + (k & 1), v = y + (k >> 1 & 1), w = z + (k >> 2);
    const int side = !(b->phi[node_at(u, v, w)] < 0);
    corners[side] = v3_mad(b->corner, v3(u, v, w), b->width);
    has[side] = true;
  }
  if (!has[0] || !has[1]) return false;
  *place = bisect(s, corners[0], corners[1]);
  return true;
}

/* The cells to look into, in order; returns how many. */
static size_t list_cells(const block *b, uint16_t cells[BLOCK_CELLS]) {
  size_t count = 0;
  for (int i = 0; i < BLOCK_CELLS; i++) {
    if (b->kinds[i] == EMPTY) continue;
    const bool beside = b->kinds[i] == NEAR_ZERO && has_crossed_neighbour(b, i % CELLS, i / CELLS % CELLS, i / (CELLS * CELLS));
    if (!beside) cells[count++] = (uint16_t)i;
  }
  return count;
}

/* Whether a foot lies in the cell of this centre. */
static bool is_in_cell(laves__vec3 foot, laves__vec3 centre, double width) {
  const laves__vec3 away = v3_sub(foot, centre);
  return fmax(fabs(away.x), fmax(fabs(away.y), fabs(away.z))) <= width / 2;
}

/* A place of the surface in each cell where one can be found: the foot of its centre, or a crossing where there is no foot. */
static size_t sample_block(const search *s, const cube *at, laves__vec3 *found) {
  block b = {.width = 2 * at->half / CELLS, .corner = v3_sub(at->centre, v3(at->half, at->half, at->half))};
  uint16_t cells[BLOCK_CELLS];
  laves__vec3 centres[BLOCK_CELLS];
  laves__projection answers[BLOCK_CELLS];
  evaluate_nodes(s, &b);
  find_kinds(&b);
  const size_t listed = list_cells(&b, cells);
  for (size_t k = 0; k < listed; k++) {
    const int i = cells[k];
    const laves__vec3 middle = v3(i % CELLS + 0.5, i / CELLS % CELLS + 0.5, i / (CELLS * CELLS) + 0.5);
    centres[k] = v3_mad(b.corner, middle, b.width);
    answers[k].hint = LAVES__NO_HINT;
  }
  laves__project_many(s->oracle, listed, centres, b.width, answers);
  size_t count = 0;
  for (size_t k = 0; k < listed; k++) {
    const int i = cells[k];
    found[count] = answers[k].foot;
    count += answers[k].found ? is_in_cell(answers[k].foot, centres[k], b.width)
                              : sample_crossing(s, &b, i % CELLS, i / CELLS % CELLS, i / (CELLS * CELLS), &found[count]);
  }
  return count;
}

/* Each block of the wave writes to a place of its own. */
static void sample_blocks(void *user, size_t begin, size_t end, int worker) {
  search *s = user;
  (void)worker;
  for (size_t i = begin; i < end; i++) s->found_counts[i] = sample_block(s, &s->blocks[s->first + i], s->found + i * BLOCK_CELLS);
}

/* ---- all blocks ---- */

static bool may_hold_surface(const search *s, laves__vec3 centre, double half) {
  const double radius = sqrt(3) * half * (1 + 1e-9); /* room for the rounding of distances */
  return s->oracle->side(s->oracle->self, centre, radius, v3(half, half, half)) == LAVES__UNDECIDED;
}

/* Whether a block has more cells than the edges near by ask for. */
static bool is_wide(const search *s, const cube *at) {
  const int level = laves__boundary_tree_level(s->tree, at->centre, sqrt(3) * at->half);
  return 2 * at->half > CELLS * ldexp(s->spacing, level);
}

/* Halves the blocks in hand that are too wide; false when memory is short, or there are too many. */
static bool halve(search *s, bool *done) {
  cube *parts = NULL;
  size_t capacity = 0, count = 0;
  if (s->count > BLOCKS_MAX || !laves__grow(s->context, &parts, &capacity, 8 * s->count, sizeof *parts)) return false;
  *done = true;
  for (size_t i = 0; i < s->count; i++) {
    const cube *at = &s->blocks[i];
    if (i % 512 == 0 && laves__cancelled(s->context, "distance", 0)) break;
    if (!is_wide(s, at)) {
      parts[count++] = *at;
      continue;
    }
    *done = false;
    const double h = at->half / 2;
    for (int k = 0; k < 8; k++) {
      const laves__vec3 c = v3_add(at->centre, v3(k & 1 ? h : -h, k & 2 ? h : -h, k & 4 ? h : -h));
      if (may_hold_surface(s, c, h)) parts[count++] = (cube){c, h, at->depth + 1};
    }
  }
  laves__free(s->context, s->blocks, s->capacity, sizeof *s->blocks);
  s->blocks = parts;
  s->capacity = capacity;
  s->count = count;
  return true;
}

static bool list_blocks(search *s) {
  const laves__vec3 widths = v3_sub(s->oracle->bounds.upper, s->oracle->bounds.lower);
  if (!laves__grow(s->context, &s->blocks, &s->capacity, 1, sizeof *s->blocks)) return false;
  s->blocks[0] = (cube){box3_centre(s->oracle->bounds), fmax(widths.x, fmax(widths.y, widths.z)) / 2 * (1 + 1e-3), 0};
  s->count = 1;
  for (bool done = false; !done && s->count > 0 && !laves__is_cancelled(s->context);)
    if (!halve(s, &done)) return false;
  return s->count <= BLOCKS_MAX;
}

/* Appends what a block has found; a sample stands for the area of a cell's side. */
static size_t append(const search *s, size_t in_wave, laves__domain_sample *samples, size_t count, size_t capacity) {
  const double weight = ldexp(1, -2 * s->blocks[s->first + in_wave].depth);
  for (size_t k = 0; k < s->found_counts[in_wave] && count < capacity; k++)
    samples[count++] = (laves__domain_sample){s->found[in_wave * BLOCK_CELLS + k], weight};
  return count;
}

size_t laves__sample_surface(laves_context *context, const laves__oracle *oracle, const laves__boundary_tree *tree,
                             double spacing, laves__domain_sample *samples, size_t capacity) {
  search s = {.context = context, .oracle = oracle, .tree = tree, .spacing = spacing};
  size_t count = 0;
  const bool listed = list_blocks(&s);
  s.found = listed ? laves__alloc(context, (size_t)WAVE_BLOCKS * BLOCK_CELLS, sizeof *s.found) : NULL;
  for (; s.found && s.first < s.count && count < capacity; s.first += WAVE_BLOCKS) {
    const size_t wave = s.count - s.first < WAVE_BLOCKS ? s.count - s.first : WAVE_BLOCKS;
    if (!laves__parallel_for(context, "distance", wave, 1, sample_blocks, &s)) break;
    for (size_t i = 0; i < wave; i++) count = append(&s, i, samples, count, capacity);
  }
  if (s.found) laves__free(context, s.found, (size_t)WAVE_BLOCKS * BLOCK_CELLS, sizeof *s.found);
  laves__free(context, s.blocks, s.capacity, sizeof *s.blocks);
  return count;
}
