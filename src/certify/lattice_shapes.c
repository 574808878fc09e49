/* Which tets are exact tiles, told by their shape alone.
 *
 * With lengths in quarters of a unit of the lattice, the tiles of C15 have edges whose squares are 8, 11 and 12
 * ([isotropic-tcp], section 3.2), in three ways:
 *
 *   six of 8 (regular);  three of 8 round a face and three of 11 at its apex;  one of 12 opposite one of 8, and four of 11
 *
 * Six lengths determine a tet but for its mirror image, and all three tiles are their own. The shortest edge of each is one
 * of 8, so a tet names the size that would make it a tile. The size that the most name is found by a vote in which unlike
 * votes cancel, first within fixed blocks and then between them, in order; it finds whatever more than half have. Then those
 * of that size are counted.
 *
 * Tolerance, on squares of edges, relative: LEAST_TOLERANCE, or what the rounding of coordinates far from the origin makes of
 * edges this short, where that is more. */
#include <float.h>

#include "certify/certify.h"

enum { BLOCK_TETS = 4096, SHORT = 8, MIDDLE = 11, LONG = 12 };

#define LEAST_TOLERANCE 1e-9
/* Roundings that a squared edge may suffer: two coordinates in each of three axes, each half a unit, twice for the square,
 * and as much again for the edge that it is compared with. */
#define ROUNDINGS 16
/* Mean edge of the tiling over its quarter unit: (48 sqrt 8 + 96 sqrt 11 + 16 sqrt 12) / 160. */
#define MEAN_EDGE 3.184913173150872

typedef struct vote {
  double unit2; /* square of the quarter unit */
  size_t weight;
} vote;

typedef struct shapes {
  const laves_mesh *mesh;
  double largest; /* of all coordinates */
  vote *votes;    /* [blocks] */
  size_t *counts; /* [blocks] */
  double unit2, tolerance;
} shapes;

/* For a given size of edges, how much their squares may differ. */
static double tolerance_of(double largest, double edge2) {
  return fmax(LEAST_TOLERANCE, ROUNDINGS * DBL_EPSILON * largest / sqrt(edge2));
}

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

/* The square of the quarter unit for which the tet is a tile, 0 when there is none. */
static double unit2_of(const shapes *s, size_t tet) {
  laves__vec3 p[4];
  double squares[6], least = INFINITY;
  int kinds[6];
  if (!laves__tet_corners(s->mesh, tet, p)) return 0;
  for (int i = 0; i < 6; i++) {
    squares[i] = v3_norm2(v3_sub(p[laves__tet_edge[i][1]], p[laves__tet_edge[i][0]]));
    least = fmin(least, squares[i]);
  }
  if (!(least > 0) || !isfinite(least)) return 0;
  const double tolerance = 2 * tolerance_of(s->largest, least);
  for (int i = 0; i < 6; i++) {
    kinds[i] = kind_of_edge(squares[i] * (SHORT / least), tolerance);
    if (kinds[i] == 0) return 0;
  }
  return is_tile(kinds) ? least / SHORT : 0;
}

/* Like votes add, unlike ones cancel. */
static void cast(const shapes *s, vote *into, vote more) {
  if (more.weight == 0) return;
  if (into->weight > 0 && close_to(more.unit2, into->unit2, 2 * tolerance_of(s->largest, SHORT * into->unit2)))
    into->weight += more.weight;
  else if (into->weight >= more.weight)
    into->weight -= more.weight;
  else
    *into = (vote){more.unit2, more.weight - into->weight};
}

static void vote_blocks(void *user, size_t begin, size_t end, int worker) {
  const shapes *s = user;
  (void)worker;
  for (size_t b = begin; b < end; b++) {
    s->votes[b] = (vote){0};
    for (size_t t = b * BLOCK_TETS; t < (b + 1) * BLOCK_TETS && t < s->mesh->tet_count; t++) {
      const double unit2 = unit2_of(s, t);
      if (unit2 > 0) cast(s, &s->votes[b], (vote){unit2, 1});
    }
  }
}

static void count_blocks(void *user, size_t begin, size_t end, int worker) {
  const shapes *s = user;
  (void)worker;
  for (size_t b = begin; b < end; b++) {
    s->counts[b] = 0;
    for (size_t t = b * BLOCK_TETS; t < (b + 1) * BLOCK_TETS && t < s->mesh->tet_count; t++) {
      const double unit2 = unit2_of(s, t);
      s->counts[b] += unit2 > 0 && close_to(unit2, s->unit2, s->tolerance);
    }
  }
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
  s.counts = laves__alloc(context, blocks, sizeof *s.counts);
  if (!s.votes || !s.counts) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  bool complete = laves__parallel_for(context, "certify", blocks, 1, vote_blocks, &s);
  for (size_t b = 0; complete && b < blocks; b++) cast(&s, &winner, s.votes[b]);
  certificate->lattice_tolerance = LEAST_TOLERANCE;
  if (winner.weight > 0) {
    s.unit2 = winner.unit2;
    s.tolerance = 2 * tolerance_of(s.largest, SHORT * winner.unit2);
    complete = complete && laves__parallel_for(context, "certify", blocks, 1, count_blocks, &s);
    for (size_t b = 0; complete && b < blocks; b++) certificate->lattice_tets += s.counts[b];
    certificate->lattice_size = MEAN_EDGE * sqrt(winner.unit2);
    certificate->lattice_tolerance = s.tolerance;
  }
  if (!complete) result = laves__fail_cancelled(error);
clean_up:
  laves__free(context, s.votes, blocks, sizeof *s.votes);
  laves__free(context, s.counts, blocks, sizeof *s.counts);
  return result;
}
