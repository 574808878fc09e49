/* The mesher sorts the inner corners of each face with an outer corner by their keys. In a box the keys have ranges, so some
 * orders may be impossible. Each one that is possible is handed to laves__stencil_sort() as a tet with keys that stand for it,
 * and what laves__stencil_apply() makes of that are the pieces. */
#include "pieces.h"

#include <string.h>

/* The key is length2 * (1 - t): an integer times a multiple of FINE_GRID, exact. */
static range key_range(const configuration *c, int i, int o) {
  const range t = c->fraction[i][o];
  return (range){c->length2[i][o] * (1 - t.high), c->length2[i][o] * (1 - t.low)};
}

static bool may_be_lesser(const configuration *c, int a, int b, int o) {
  return key_range(c, a, o).low <= key_range(c, b, o).high;
}

/* The orders of up to three inner corners as ranks. */
static const uint8_t rank_of[6][3] = {{0, 1, 2}, {1, 0, 2}, {0, 2, 1}, {2, 0, 1}, {1, 2, 0}, {2, 1, 0}};

/* Whether the inner corners can have this order in the faces with outer corner o. */
static bool is_possible(const configuration *c, const int *inner, int count, int o, const uint8_t *rank) {
  for (int a = 0; a < count; a++)
    for (int b = 0; b < count; b++)
      if (rank[a] < rank[b] && !may_be_lesser(c, inner[a], inner[b], o)) return false;
  return true;
}

static outcome outcome_of(const laves__cut_tet *t) {
  outcome result = {.count = 1};
  uint8_t order[4];
  const laves__stencil_case which = laves__stencil_sort(t, order);
  result.choice[0].count = laves__stencil_apply(which, order, result.choice[0].piece);
  if (which == LAVES__STENCIL_IIOO) {
    result.choice[1].count = laves__stencil_apply(LAVES__STENCIL_IIOO_OTHER, order, result.choice[1].piece);
    result.count = 2;
  }
  return result;
}

int possible_outcomes(const configuration *c, outcome outcomes[OUTCOMES_MAX]) {
  static const int orders[5] = {1, 1, 2, 6, 1};
  int inner[4], outer[4], inner_count = 0, outer_count = 0, found = 0;
  for (int k = 0; k < 4; k++) {
    if (c->label[k] == LAVES__LABEL_IN) inner[inner_count++] = k;
    if (c->label[k] == LAVES__LABEL_OUT) outer[outer_count++] = k;
  }
  /* Two faces, of two outer corners, are ordered independently. */
  const int first_orders = outer_count > 0 ? orders[inner_count] : 1, second_orders = outer_count > 1 ? orders[inner_count] : 1;
  for (int n = 0; n < first_orders * second_orders; n++) {
    const int order[2] = {n % first_orders, n / first_orders};
    laves__cut_tet stand_in = {.id = {0, 1, 2, 3}};
    memcpy(stand_in.label, c->label, sizeof stand_in.label);
    bool possible = true;
    for (int o = 0; o < outer_count && inner_count > 1; o++) {
      const uint8_t *rank = rank_of[order[o]];
      possible &= is_possible(c, inner, inner_count, outer[o], rank);
      for (int i = 0; i < inner_count; i++) {
        stand_in.length2[inner[i]][outer[o]] = 4;
        stand_in.fraction[inner[i]][outer[o]] = 0.75 - 0.25 * rank[i];
      }
    }
    if (possible) outcomes[found++] = outcome_of(&stand_in);
  }
  return found;
}

segment segment_of(const configuration *c, int code) {
  if (code < 4) return (segment){c->site[code], c->along[code], c->share[code]};
  const int i = code / 4 - 1, o = code % 4;
  return (segment){c->site[i], v3_sub(c->site[o], c->site[i]), c->fraction[i][o]};
}

void segments_of(const configuration *c, const uint8_t piece[4], segment corner[4]) {
  for (int k = 0; k < 4; k++) corner[k] = segment_of(c, piece[k]);
}

bool halve_cuts(const configuration *c, configuration half[2]) {
  int in = -1, out = -1;
  double widest = 0, middle;
  for (int i = 0; i < 4; i++)
    for (int o = 0; o < 4; o++) {
      const double width = c->fraction[i][o].high - c->fraction[i][o].low;
      if (c->label[i] != LAVES__LABEL_IN || c->label[o] != LAVES__LABEL_OUT || !(width > widest)) continue;
      widest = width;
      in = i;
      out = o;
    }
  if (in < 0 || !middle_of(c->fraction[in][out], &middle)) return false;
  half[0] = half[1] = *c;
  half[0].fraction[in][out].high = half[1].fraction[in][out].low = middle;
  return true;
}
