/* The rule of stuffing as numbers: when a vertex snaps, how far a boundary vertex may be relaxed, and the window of
 * dihedral angles that is proved for the result. docs/proof.md has the theorem; tests/proof proves these very numbers.
 *
 * An edge from an inner site to an outer one is crossed once, at a fraction of its length. A site is *violated* by the
 * crossing of one of its edges whose fraction, measured from the site, is less than alpha; then it snaps there. A crossing
 * between two sites that do not snap is a cut.
 *
 *     inside  *----------|--------------------|----------*  outside
 *               snaps    :        cut         :   snaps
 *             0 .. alpha_in              1 - alpha_out .. 1
 *
 * Sites are of two kinds: X has 16 neighbours, m has 12 (the bond midpoints of c15_table.h); alpha depends on the kinds of
 * both ends. All numbers are multiples of 2^-13, so that the proof can calculate with them exactly. */
#ifndef LAVES_STUFF_RULE_H
#define LAVES_STUFF_RULE_H

#include "base/vec3.h"

typedef enum laves__kind { LAVES__KIND_X = 0, LAVES__KIND_M = 1 } laves__kind;

static inline laves__kind laves__kind_of(int site) { return site < 8 ? LAVES__KIND_X : LAVES__KIND_M; }

/* Shares of edges. */
typedef struct laves__thresholds {
  double alpha[2][2][2]; /* [0: in, 1: out][kind of the vertex that snaps][kind of the other end] */
  double middle[2][2];   /* relaxed cuts tend to this fraction [kind of the inner end][kind of the outer end] */
} laves__thresholds;

/* One proved window and the numbers that attain it. */
typedef struct laves__guarantee {
  double min_dihedral, max_dihedral; /* promised, degrees */
  double proved_min, proved_max;     /* proved: a little more than promised, which covers rounding */
  double cos_min, cos_max;           /* cosines of the proved angles */
  const laves__thresholds *thresholds;
  double relaxation; /* share of the way to the site, or to `middle`, that a relaxed vertex goes; 0: none */
} laves__guarantee;

enum { LAVES__GUARANTEES = 5 };
/* Ascending by min_dihedral. The first keeps every boundary vertex on the surface. */
extern const laves__guarantee laves__guarantees[LAVES__GUARANTEES];

/* The first whose min_dihedral is at least the asked one (up to the last's). */
const laves__guarantee *laves__guarantee_find(double min_dihedral);

/* At least 1 when all dihedral angles of a tet are inside the proved window; the further inside the larger. At most 0 for a
 * tet that is not positive. */
double laves__guarantee_margin(const laves__guarantee *guarantee, const laves__vec3 corners[4]);

#endif
