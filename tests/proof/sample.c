/* Every corner of every box is cut as the mesher does it: laves__stencil_cut(), laves__code_position() and the measures of
 * mesh/quality.h, in ordinary rounding. The diagonals change where two keys are equal, so the points of the boxes' edges
 * just beside such places are tried, too. */
#include "sample.h"

#include "mesh/quality.h"

#define DEGREES (180 / 3.14159265358979323846)
/* How far from equal keys. */
#define BESIDE 1e-9

sample sample_start(const laves__guarantee *guarantee) { return (sample){guarantee, {.value = 180}, {.value = 0}, {.value = 1}}; }

static void note(extreme *e, double value, const configuration *c, const laves__cut_tet *tet, const piece_list *pieces) {
  *e = (extreme){value, *c, *tet, *pieces};
}

static void piece_corners(const laves__cut_tet *tet, const uint8_t piece[4], laves__vec3 corner[4]) {
  for (int k = 0; k < 4; k++) corner[k] = laves__code_position(tet, piece[k]);
}

static void note_angles(sample *s, const configuration *c, const laves__cut_tet *tet, const piece_list *pieces) {
  for (int p = 0; p < pieces->count; p++) {
    laves__vec3 x[4];
    double cosine[6];
    piece_corners(tet, pieces->piece[p], x);
    laves__tet_dihedral_cosines(x, cosine);
    for (int k = 0; k < 6; k++) {
      const double angle = acos(fmax(-1, fmin(1, cosine[k]))) * DEGREES;
      if (angle < s->least.value) note(&s->least, angle, c, tet, pieces);
      if (angle > s->most.value) note(&s->most, angle, c, tet, pieces);
    }
  }
}

static void note_ratios(sample *s, const configuration *c, const laves__cut_tet *tet, const piece_list *pieces) {
  for (int p = 0; p < pieces->count; p++) {
    laves__vec3 x[4];
    piece_corners(tet, pieces->piece[p], x);
    const double ratio = laves__tet_radius_ratio(x);
    if (ratio < s->ratio.value) note(&s->ratio, ratio, c, tet, pieces);
  }
}

static void note_tet(sample *s, const configuration *c, const laves__cut_tet *tet) {
  piece_list pieces;
  uint8_t order[4];
  pieces.count = laves__stencil_cut(s->guarantee, tet, pieces.piece);
  note_angles(s, c, tet, &pieces);
  note_ratios(s, c, tet, &pieces);
  if (laves__stencil_sort(tet, order) != LAVES__STENCIL_IIOO) return;
  for (int which = LAVES__STENCIL_IIOO; which <= LAVES__STENCIL_IIOO_OTHER; which++) {
    pieces.count = laves__stencil_apply((laves__stencil_case)which, order, pieces.piece);
    note_ratios(s, c, tet, &pieces);
  }
}

/* Moves the cut from a to o so that its key is nearly that of b; false when the box does not allow it. */
static bool equal_keys(const configuration *c, laves__cut_tet *tet, int a, int b, int o, double beside) {
  const double t = 1 - laves__diagonal_key(tet, b, o) / tet->length2[a][o] + beside;
  tet->fraction[a][o] = t;
  return t >= c->fraction[a][o].low && t <= c->fraction[a][o].high;
}

/* The tet, and with keys made equal in any of the faces with outer corners from o on. */
static void note_ties(sample *s, const configuration *c, const laves__cut_tet *tet, int o) {
  while (o < 4 && c->label[o] != LAVES__LABEL_OUT) o++;
  if (o == 4) {
    note_tet(s, c, tet);
    return;
  }
  note_ties(s, c, tet, o + 1);
  for (int a = 0; a < 4; a++)
    for (int b = 0; b < 4; b++)
      for (int side = -1; side <= 1; side += 2) {
        if (a == b || c->label[a] != LAVES__LABEL_IN || c->label[b] != LAVES__LABEL_IN) continue;
        laves__cut_tet tied = *tet;
        if (equal_keys(c, &tied, a, b, o, side * BESIDE)) note_ties(s, c, &tied, o + 1);
      }
}

bool visit_sample(const configuration *c, void *user) {
  sample *s = user;
  for (unsigned corner = 0; corner < 1U << range_count(c); corner++) {
    const laves__cut_tet tet = cut_tet_at(c, corner);
    note_ties(s, c, &tet, 0);
  }
  return true;
}
