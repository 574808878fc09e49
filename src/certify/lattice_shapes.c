/* Which tets are exact tiles, told by their shape alone.
 *
 * With lengths in quarters of a unit of the lattice, the tiles of C15 have edges whose squares are 8, 11 and 12
 * ([isotropic-tcp], section 3.2), in three ways:
 *
 *   six of 8 (regular);  three of 8 round a face and three of 11 at its apex;  one of 12 opposite one of 8, and four of 11
 *
 * and the tile of the BCC lattice that C15 is made from, whose cubes are four quarters wide, has
 *
 *   two of 16, opposite one another, and four of 12
 *
 * Six lengths determine a tet but for its mirror image, and all tiles are their own. The shortest edge of each is one
 * of 8, or of 12, so a tet names the unit that would make it a tile. Units of a graded mesh differ by powers of two: such votes
 * are alike. What the most name is found by a vote in which unlike votes cancel, first within fixed blocks and then
 * between them, in order; it finds whatever more than half have. Those of that unit, times any power of two, are counted, and the
 * power that has the most tiles gives the size. The unit is nearly always that of the first block, so tets are counted as they
 * vote, and a second time only when another unit won.
 *
 * Tolerance, on squares of edges, relative: LEAST_TOLERANCE, or what the rounding of coordinates far from the origin makes of
 * edges this short, where that is more. */
#include <float.h>
#include <stdlib.h>

#include "certify/certify.h"

enum { BLOCK_TETS = 4096, SHORT = 8, MIDDLE = 11, LONG = 12, BCC_SHORT = 12, BCC_LONG = 16 };

/* Powers of two from -LEVEL_MOST to LEVEL_MOST: more than sizes in one mesh of doubles can differ. */
enum { LEVEL_MOST = 31, LEVELS = 2 * LEVEL_MOST + 1 };

#define LEAST_TOLERANCE 1e-9
/* Roundings that a squared edge may suffer: two coordinates in each of three axes, each half a unit, twice for the square,
 * and as much again for the edge that it is compared with. */
#define ROUNDINGS 16
/* Mean edge of the tiling over its quarter unit: (48 sqrt 8 + 96 sqrt 11 + 16 sqrt 12) / 160. */
#define MEAN_EDGE 3.184913173150872

typedef struct tile {
  double unit2; /* square of the quarter unit for which the tet is a tile; 0: for none */
  bool is_bcc;
} tile;

typedef struct vote {
  double unit2;
  size_t weight;
} vote;

typedef struct tally {
  size_t c15, bcc;
  size_t levels[LEVELS]; /* of both, by their power of two */
} tally;

typedef struct shapes {
  const laves_mesh *mesh;
  double largest; /* of all coordinates */
  vote *votes;    /* [blocks] */
  tally *tallies; /* [blocks] */
  double unit2;   /* that won */
} shapes;

/* For a given size of edges, how much their squares may differ. */
static double tolerance_of(double largest, double edge2) {
  return fmax(LEAST_TOLERANCE, ROUNDINGS * DBL_EPSILON * largest / sqrt(edge2));
}

/* How much the squares of units may differ, for units of about this size. */
static double unit_tolerance(const shapes *s, double unit2) { return 2 * tolerance_of(s->largest, SHORT * unit2); }

static bool close_to(double a, double b, double tolerance) { return fabs(a - b) <= tolerance * b; }

/* 8, 11 or 12 for an edge's square in quarter units, 0 for any other. */
static int kind_of_edge(double square, double tolerance) {
  if (close_to(square, SHORT, tolerance)) return SHORT;
  if (close_to(square, MIDDLE, tolerance)) return MIDDLE;
  return close_to(square, LONG, tolerance) ? LONG : 0;
}

/* Whether the kinds of the edges 01 02 03 12 13 23 make a tile: edge i is opposite 5 - i. */
static bool is_tile(const int kinds[6]) {
  static const uint8_t apex[4][3] = {{0, 1, 2}, {0, 3, 4}, {1, 3, 5}, {2, 4, 5}}; /* the edges of each corner */
  int shorts = 0, longs = 0, at = 0;
  for (int i = 0; i < 6; i++) {
    if (kinds[i] == 0) return false;
    shorts += kinds[i] == SHORT;
    longs += kinds[i] == LONG;
    if (kinds[i] == LONG) at = i;
  }
  if (longs == 1) return shorts == 1 && kinds[5 - at] == SHORT;
  if (longs > 1) return false;
  if (shorts != 3) return shorts == 6;
  for (int c = 0; c < 4; c++) {
    const uint8_t *e = apex[c];
    if (kinds[e[0]] == MIDDLE && kinds[e[1]] == MIDDLE && kinds[e[2]] == MIDDLE) return true;
  }
  return false;
}

static bool is_c15_tile(const double squares[6], double least, double tolerance) {
  int kinds[6];
  for (int i = 0; i < 6; i++) {
    kinds[i] = kind_of_edge(squares[i] * (SHORT / least), tolerance);
    if (kinds[i] == 0) return false;
  }
  return is_tile(kinds);
}

/* Two opposite edges of 16, and all others of 12. */
static bool is_bcc_tile(const double squares[6], double least, double tolerance) {
  int pairs = 0;
  for (int i = 0; i < 3; i++) {
    const double a = squares[i] * (BCC_SHORT / least), b = squares[5 - i] * (BCC_SHORT / least);
    if (close_to(a, BCC_LONG, tolerance) && close_to(b, BCC_LONG, tolerance))
      pairs++;
    else if (!close_to(a, BCC_SHORT, tolerance) || !close_to(b, BCC_SHORT, tolerance))
      return false;
  }
  return pairs == 1;
}

static tile tile_of(const shapes *s, size_t tet) {
  laves__vec3 p[4];
  double squares[6], least = INFINITY;
  if (!laves__tet_corners(s->mesh, tet, p)) return (tile){0, false};
  for (int i = 0; i < 6; i++) {
    squares[i] = v3_norm2(v3_sub(p[laves__tet_edge[i][1]], p[laves__tet_edge[i][0]]));
    if (squares[i] < least) least = squares[i];
  }
  if (!(least > 0) || !isfinite(least)) return (tile){0, false};
  const double tolerance = 2 * tolerance_of(s->largest, least);
  if (is_c15_tile(squares, least, tolerance)) return (tile){least / SHORT, false};
  if (is_bcc_tile(squares, least, tolerance)) return (tile){least / BCC_SHORT, true};
  return (tile){0, false};
}

/* Whether one unit is the other times a power of two, the nearest: *level. */
static bool is_alike(const shapes *s, double unit2, double base2, int *level) {
  const double ratio = unit2 / base2;
  int exponent;
  *level = 0;
  if (ratio >= 0.5 && ratio < 2) return close_to(unit2, base2, unit_tolerance(s, base2)); /* mostly; what follows is dear */
  if (!(ratio > 0) || !isfinite(2 * ratio)) return false;
  frexp(2 * ratio, &exponent); /* in [2^(e-1), 2^e): a power of four between its half and its double */
  *level = (exponent - 1) >> 1;
  const double there = ldexp(base2, 2 * *level);
  return close_to(unit2, there, unit_tolerance(s, there));
}

/* Like votes add, unlike ones cancel. */
static void cast(const shapes *s, vote *into, vote more) {
  if (more.weight == 0) return;
  int level;
  if (into->weight > 0 && is_alike(s, more.unit2, into->unit2, &level))
    into->weight += more.weight;
  else if (into->weight >= more.weight)
    into->weight -= more.weight;
  else
    *into = (vote){more.unit2, more.weight - into->weight};
}

static void count(const shapes *s, tile it, tally *into) {
  int level;
  if (!is_alike(s, it.unit2, s->unit2, &level) || abs(level) > LEVEL_MOST) return;
  into->c15 += !it.is_bcc;
  into->bcc += it.is_bcc;
  into->levels[LEVEL_MOST + level]++;
}

/* Votes, and counts those of the unit that is likely to win, where one is known. */
static void look_at_block(const shapes *s, size_t b) {
  s->votes[b] = (vote){0};
  s->tallies[b] = (tally){0};
  for (size_t t = b * BLOCK_TETS; t < (b + 1) * BLOCK_TETS && t < s->mesh->tet_count; t++) {
    const tile it = tile_of(s, t);
    if (!(it.unit2 > 0)) continue;
    cast(s, &s->votes[b], (vote){it.unit2, 1});
    if (s->unit2 > 0) count(s, it, &s->tallies[b]);
  }
}

static void look_at_blocks(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  for (size_t b = begin; b < end; b++) look_at_block(user, b);
}

/* Adds up; the size is that of the most tiles, the smaller of two that have as many. */
static void state_tiles(const shapes *s, size_t blocks, laves_certificate *certificate) {
  tally sum = {0};
  int most = 0;
  for (size_t b = 0; b < blocks; b++) {
    sum.c15 += s->tallies[b].c15;
    sum.bcc += s->tallies[b].bcc;
    for (int i = 0; i < LEVELS; i++) sum.levels[i] += s->tallies[b].levels[i];
  }
  for (int i = 1; i < LEVELS; i++)
    if (sum.levels[i] > sum.levels[most]) most = i;
  const double unit2 = ldexp(s->unit2, 2 * (most - LEVEL_MOST));
  certificate->lattice_tets = sum.c15;
  certificate->bcc_tets = sum.bcc;
  certificate->lattice_size = MEAN_EDGE * sqrt(unit2);
  certificate->lattice_tolerance = unit_tolerance(s, unit2);
}

static double largest_coordinate(const laves_mesh *mesh) {
  double largest = 0;
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    const laves__vec3 p = mesh->points[v];
    const double here = fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z)));
    if (isfinite(here) && here > largest) largest = here;
  }
  return largest;
}

laves_result laves__find_tiles(laves_context *context, const laves_mesh *mesh, laves_certificate *certificate,
                               laves_error *error) {
  const size_t blocks = (mesh->tet_count + BLOCK_TETS - 1) / BLOCK_TETS;
  laves_result result = LAVES_OK;
  vote winner = {0};
  shapes s = {.mesh = mesh, .largest = largest_coordinate(mesh)};
  s.votes = laves__alloc(context, blocks, sizeof *s.votes);
  s.tallies = laves__alloc(context, blocks, sizeof *s.tallies);
  if (!s.votes || !s.tallies) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  if (blocks > 0) look_at_block(&s, 0);
  s.unit2 = blocks > 0 ? s.votes[0].unit2 : 0;
  bool complete = laves__parallel_for(context, "certify", blocks, 1, look_at_blocks, &s);
  for (size_t b = 0; complete && b < blocks; b++) cast(&s, &winner, s.votes[b]);
  certificate->lattice_tolerance = LEAST_TOLERANCE;
  if (winner.weight > 0) {
    const bool foreseen = winner.unit2 == s.unit2;
    s.unit2 = winner.unit2;
    if (!foreseen) complete = complete && laves__parallel_for(context, "certify", blocks, 1, look_at_blocks, &s);
    if (complete) state_tiles(&s, blocks, certificate);
  }
  if (!complete) result = laves__fail_cancelled(error);
clean_up:
  laves__free(context, s.votes, blocks, sizeof *s.votes);
  laves__free(context, s.tallies, blocks, sizeof *s.tallies);
  return result;
}
