/* The stencil table. Each case shows the tet with its corners sorted: inner corners I first, by their diagonal keys, then
 * corners on the surface S, then outer corners O. A cut on the edge of corners 0 and 3 is written 03.
 *
 *   ISSO          3 = O          one piece           IIIO          3 = O           a prism with the verticals
 *                /|\                                              /|\              0-03, 1-13, 2-23 and the keys
 *              03 | \            0 1 2 03                       03 | 23             0 < 1 < 2: three pieces
 *              / \|  \                                          /  13 \
 *             0---2---1          (ISOO and IOOO                0----|--2           0  1  2 23
 *             I   S   S           likewise: every               \   |  /           0  1 13 23
 *                                 O becomes its cut)              \ | /            0 03 13 23
 *                                                                   1
 *   IISO          3 = O          a pyramid over the
 *                /|\             quad 0 1 13 03,       IIOO     2 = O-----3 = O    a prism with the verticals
 *              03 | 13           apex 2, cut along              /  \     / |       0-1, 02-12, 03-13
 *              /  |  \           the diagonal 0-13:            02   12 03  13
 *             0---2---1                                       /       X     |
 *             I   S   I          2 0  1 13                   0 = I---------1 = I
 *                                2 0 13 03
 *
 * A prism with verticals A-B in the order x < y < z is (Ax Ay Az Bz) (Ax Ay By Bz) (Ax Bx By Bz): each of its quads gets the
 * diagonal from the lesser A to the greater B. In IIOO the quads 0 1 12 02 and 0 1 13 03 lie in faces of the tet, where the
 * keys decide; corner 0 is the lesser in the face with corner 2. If it is so in the face with corner 3, too, the quad 02 12
 * 13 03 on the surface may have either diagonal:
 *
 *     case      order of the verticals     diagonals
 *     IIOO      01 < 02.12 < 03.13         0-12  0-13  02-13
 *     other     01 < 03.13 < 02.12         0-12  0-13  03-12
 *     crossed   03.13 < 01 < 02.12         0-12  1-03  03-12
 *
 * Source: [labelle2007] for stuffing; the power diagonal and this table are the project's own. */
#include "stuff/stencil.h"

#define C(i, o) LAVES__CUT(i, o)

const laves__stencil laves__stencils[LAVES__STENCIL_CASES] = {
    [LAVES__STENCIL_WHOLE] = {1, {{0, 1, 2, 3}}},
    [LAVES__STENCIL_ISSO] = {1, {{0, 1, 2, C(0, 3)}}},
    [LAVES__STENCIL_ISOO] = {1, {{0, 1, C(0, 2), C(0, 3)}}},
    [LAVES__STENCIL_IOOO] = {1, {{0, C(0, 1), C(0, 2), C(0, 3)}}},
    [LAVES__STENCIL_IISO] = {2, {{2, 0, 1, C(1, 3)}, {2, 0, C(1, 3), C(0, 3)}}},
    [LAVES__STENCIL_IIIO] = {3, {{0, 1, 2, C(2, 3)}, {0, 1, C(2, 3), C(1, 3)}, {0, C(0, 3), C(1, 3), C(2, 3)}}},
    [LAVES__STENCIL_IIOO] = {3, {{0, C(0, 2), C(0, 3), C(1, 3)}, {0, C(0, 2), C(1, 3), C(1, 2)}, {0, 1, C(1, 2), C(1, 3)}}},
    [LAVES__STENCIL_IIOO_OTHER] = {3, {{0, C(0, 2), C(0, 3), C(1, 2)}, {0, C(0, 3), C(1, 3), C(1, 2)}, {0, 1, C(1, 2), C(1, 3)}}},
    [LAVES__STENCIL_IIOO_CROSSED] = {3,
                                     {{C(0, 3), 0, C(0, 2), C(1, 2)}, {C(0, 3), 1, 0, C(1, 2)}, {C(0, 3), C(1, 3), 1, C(1, 2)}}},
};

laves__vec3 laves__cut_position(const laves__cut_tet *tet, int i, int o) {
  return v3_lerp(tet->position[i], tet->position[o], tet->fraction[i][o]);
}

laves__vec3 laves__code_position(const laves__cut_tet *tet, int code) {
  return code < 4 ? tet->position[code] : laves__cut_position(tet, code / 4 - 1, code % 4);
}

double laves__diagonal_key(const laves__cut_tet *tet, int i, int o) { return tet->length2[i][o] * (1 - tet->fraction[i][o]); }

/* Whether inner corner a comes before b in their face with outer corner o. */
static bool is_lesser(const laves__cut_tet *tet, int a, int b, int o) {
  const double key_a = laves__diagonal_key(tet, a, o), key_b = laves__diagonal_key(tet, b, o);
  return key_a != key_b ? key_a < key_b : tet->id[a] < tet->id[b];
}

laves__stencil_case laves__stencil_sort(const laves__cut_tet *tet, uint8_t order[4]) {
  static const laves__stencil_case case_of[5][5] = {
      /* [inner][outer] */
      [1] = {[1] = LAVES__STENCIL_ISSO, [2] = LAVES__STENCIL_ISOO, [3] = LAVES__STENCIL_IOOO},
      [2] = {[1] = LAVES__STENCIL_IISO, [2] = LAVES__STENCIL_IIOO},
      [3] = {[1] = LAVES__STENCIL_IIIO},
  };
  int inner = 0, outer = 0, first_outer = -1;
  for (int k = 0; k < 4; k++) {
    order[k] = (uint8_t)k;
    inner += tet->label[k] == LAVES__LABEL_IN;
    if (tet->label[k] != LAVES__LABEL_OUT) continue;
    outer++;
    if (first_outer < 0 || tet->id[k] < tet->id[first_outer]) first_outer = k;
  }
  if (outer == 0) return LAVES__STENCIL_WHOLE;
  for (int k = 1; k < 4; k++)
    for (int at = k; at > 0; at--) {
      const int a = order[at - 1], b = order[at];
      const bool right = tet->label[a] != tet->label[b]     ? tet->label[a] < tet->label[b]
                         : tet->label[a] == LAVES__LABEL_IN ? is_lesser(tet, a, b, first_outer)
                                                            : tet->id[a] < tet->id[b];
      if (right) break;
      order[at - 1] = (uint8_t)b;
      order[at] = (uint8_t)a;
    }
  const laves__stencil_case which = case_of[inner][outer];
  if (which == LAVES__STENCIL_IIOO && !is_lesser(tet, order[0], order[1], order[3])) return LAVES__STENCIL_IIOO_CROSSED;
  return which;
}

static bool is_odd(const uint8_t order[4]) {
  int inversions = 0;
  for (int a = 0; a < 4; a++)
    for (int b = a + 1; b < 4; b++) inversions += order[a] > order[b];
  return inversions & 1;
}

int laves__stencil_apply(laves__stencil_case which, const uint8_t order[4], uint8_t pieces[LAVES__PIECES_MAX][4]) {
  const laves__stencil *s = &laves__stencils[which];
  const bool odd = is_odd(order);
  for (int p = 0; p < s->count; p++)
    for (int k = 0; k < 4; k++) {
      const int code = s->piece[p][odd && k >= 2 ? 5 - k : k];
      pieces[p][k] = code < 4 ? order[code] : (uint8_t)LAVES__CUT(order[code / 4 - 1], order[code % 4]);
    }
  return s->count;
}

static double least_margin(const laves__guarantee *g, const laves__cut_tet *tet, uint8_t pieces[LAVES__PIECES_MAX][4],
                           int count) {
  double least = HUGE_VAL;
  for (int p = 0; p < count; p++) {
    laves__vec3 corner[4];
    for (int k = 0; k < 4; k++) corner[k] = laves__code_position(tet, pieces[p][k]);
    least = fmin(least, laves__guarantee_margin(g, corner));
  }
  return least;
}

int laves__stencil_cut(const laves__guarantee *guarantee, const laves__cut_tet *tet, uint8_t pieces[LAVES__PIECES_MAX][4]) {
  uint8_t order[4];
  const laves__stencil_case which = laves__stencil_sort(tet, order);
  const int count = laves__stencil_apply(which, order, pieces);
  if (which != LAVES__STENCIL_IIOO) return count;
  uint8_t other[LAVES__PIECES_MAX][4];
  laves__stencil_apply(LAVES__STENCIL_IIOO_OTHER, order, other);
  if (least_margin(guarantee, tet, other, count) > least_margin(guarantee, tet, pieces, count))
    for (int p = 0; p < count; p++)
      for (int k = 0; k < 4; k++) pieces[p][k] = other[p][k];
  return count;
}
