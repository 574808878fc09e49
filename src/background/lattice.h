/* The uniform background: the C15 tiling as sparse bricks of cells.
 *
 * The tiling itself is never stored. A cell is one cubic period (24 sites, 136 tetrahedra, side LAVES__CELL_SIDE in
 * lattice coordinates, where the mean edge is 1); 4 x 4 x 4 cells make a brick. A brick that is wholly outside or inside
 * is one number in the directory; the others hold a number for each cell: outside, inside, or the index of a *record*
 * with what is known of the cell's sites. Only cells near the surface have records.
 *
 *     directory[brick] --> LAVES__OUT | LAVES__IN | brick --> cell[64] --> LAVES__OUT | LAVES__IN | record
 *
 * A graded background (graph.h) has records alone. What both have in common is asked through site.h.
 */
#ifndef LAVES_BACKGROUND_LATTICE_H
#define LAVES_BACKGROUND_LATTICE_H

#include "background/c15_table.h"
#include "background/graph.h"
#include "domain/frame.h"

#define LAVES__CELL_SIDE (LAVES__C15_PERIOD / LAVES__C15_MEAN_EDGE)

enum {
  LAVES__BRICK_SIDE = 4, /* cells */
  LAVES__BRICK_CELLS = 64,
  LAVES__OUT = -1, /* a cell or brick outside the solid */
  LAVES__IN = -2,  /* a cell or brick inside, all of whose sites are kept as they are */
};

/* What a site is to the mesh. The numbers are the signs of phi. */
typedef enum laves__label { LAVES__LABEL_IN = -1, LAVES__LABEL_ON = 0, LAVES__LABEL_OUT = 1 } laves__label;

typedef struct laves__brick {
  int32_t cell[LAVES__BRICK_CELLS]; /* LAVES__OUT, LAVES__IN or a record; x runs fastest */
} laves__brick;

/* A cell near the surface. */
typedef struct laves__record {
  int32_t xyz[3];                   /* the cell */
  int32_t around[27];               /* the cells around as in laves__brick.cell; 13 is the record itself */
  double centre_phi;                /* at the centre of the cell, where phi is a distance; 0: not known */
  double phi[LAVES__C15_SITES];     /* in sizes; HUGE_VAL times the sign where only the sign is known */
  uint32_t hint[LAVES__C15_SITES];  /* for laves__frame_project */
  int8_t sign[LAVES__C15_SITES];    /* of phi: -1 or 1 */
  int8_t label[LAVES__C15_SITES];   /* laves__label */
  uint8_t depth[LAVES__C15_SITES];  /* edges to the nearest ON site, up to LAVES__DEPTH_MAX */
  int32_t vertex[LAVES__C15_SITES]; /* index in the boundary layer, or -1 */
  uint32_t zone;                    /* bit for each site: the boundary there is made by stuffing */
  uint32_t forced;                  /* bit for each site: ON for the sake of a thin part */
  uint64_t solid[3];                /* bit t: tetrahedron t, all four corners ON, is part of the mesh (a thin wall) */
  uint64_t eligible[3];             /* bit t: such a tetrahedron has a good enough shape to be part of it */
  uint64_t stamped[3];              /* bit t: tetrahedron t of the cell is in the mesh as an exact tile */
  uint64_t layer[3];                /* bit t: tetrahedron t of the cell is in the boundary layer */
} laves__record;

typedef struct laves__lattice {
  laves_context *context;
  int32_t lower[3];   /* first cell in each axis, a multiple of LAVES__BRICK_SIDE */
  int32_t bricks[3];  /* extent of the directory in bricks */
  int32_t *directory; /* x runs fastest */
  size_t directory_count;
  laves__brick *brick;
  size_t brick_count, brick_capacity;
  laves__record *record;
  size_t record_count, record_capacity;
  laves__graph *graph; /* a graded background in the place of the tiling, which has no bricks then; NULL: the tiling */
} laves__lattice;

/* A site, wherever it lies: `cell` as in laves__brick.cell. */
typedef struct laves__site {
  int32_t cell;
  uint8_t site;
} laves__site;

/* A lattice that covers `bounds` (lattice coordinates) with at least one cell to spare, all of it outside.
 * LAVES_ERROR_OPTION when the box needs more bricks than can be indexed. Free with laves__lattice_free(). */
laves_result laves__lattice_create(laves_context *context, laves__box3 bounds, laves__lattice *lattice, laves_error *error);
void laves__lattice_free(laves__lattice *lattice);

/* A graded background as a lattice without cells: links the graph where it is not linked yet, and gives all its vertices records,
 * outside as yet. The graph must outlive the lattice, whose freeing leaves it alone.
 * LAVES_ERROR_MEMORY; LAVES_ERROR_OPTION when there are more vertices or tets than can be indexed. */
laves_result laves__lattice_of_graph(laves_context *context, laves__graph *graph, laves__lattice *lattice, laves_error *error);

/* LAVES__OUT, LAVES__IN or a record, for any cell, also beyond the directory. */
int32_t laves__lattice_cell(const laves__lattice *lattice, int32_t x, int32_t y, int32_t z);
/* Gives the cell a record, with all its sites of the sign that it had; its index, or -1 when memory is short. The cell
 * must lie in the directory. laves__lattice_link() makes `around` right. */
int32_t laves__lattice_add_record(laves__lattice *lattice, int32_t x, int32_t y, int32_t z);
/* Recomputes `around` of all records. */
void laves__lattice_link(laves__lattice *lattice);

static inline laves__vec3 laves__site_position(const int32_t cell[3], int site) {
  const double unit = 1 / LAVES__C15_MEAN_EDGE;
  const int8_t *p = laves__c15_site[site];
  return v3(((double)cell[0] * LAVES__C15_PERIOD + p[0]) * unit, ((double)cell[1] * LAVES__C15_PERIOD + p[1]) * unit,
            ((double)cell[2] * LAVES__C15_PERIOD + p[2]) * unit);
}

/* The neighbour k of a site of a record. */
static inline laves__site laves__neighbour(const laves__record *record, int site, int k) {
  const laves__c15_link link = laves__c15_neighbour[site][k];
  return (laves__site){record->around[link.cell], link.site};
}

/* The label of a site: its record's, or that of the whole cell. */
static inline laves__label laves__site_label(const laves__lattice *lattice, laves__site s) {
  if (s.cell >= 0) return (laves__label)lattice->record[s.cell].label[s.site];
  return s.cell == LAVES__OUT ? LAVES__LABEL_OUT : LAVES__LABEL_IN;
}
static inline int laves__site_sign(const laves__lattice *lattice, laves__site s) {
  if (s.cell >= 0) return lattice->record[s.cell].sign[s.site];
  return s.cell == LAVES__OUT ? 1 : -1;
}

/* The corners of tetrahedron `tet` owned by a record. */
static inline void laves__tet_sites(const laves__record *record, int tet, laves__site corners[4]) {
  for (int k = 0; k < 4; k++) {
    const laves__c15_corner corner = laves__c15_tet[tet][k];
    const int cell = 13 + (corner.shift & 1) + 3 * ((corner.shift >> 1) & 1) + 9 * (corner.shift >> 2);
    corners[k] = (laves__site){record->around[cell], corner.site};
  }
}

/* A tetrahedron is part of the mesh when none of its corners is OUT and at least one is IN; and where all four are ON, when
 * its cell's `solid` says so, which this function does not look at. */
bool laves__tet_kept(const laves__lattice *lattice, const laves__site corners[4]);

/* Which of the tetrahedra around a site are part of the mesh: bit k for laves__c15_star[site][k], or the graph's star. */
uint64_t laves__star_kept(const laves__lattice *lattice, int32_t record, int site);

/* Bits of tetrahedra. */
static inline bool laves__bit(const uint64_t set[3], int tet) { return set[tet >> 6] >> (tet & 63) & 1; }
static inline void laves__flip_bit(uint64_t set[3], int tet) { set[tet >> 6] ^= UINT64_C(1) << (tet & 63); }

#endif
