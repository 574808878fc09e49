/* The stencil table: volumes, conformity and independence of how corners are numbered, on random tets. */
#include "stuff/stencil.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

#include "fixtures/assert_close.h"
#include "mesh/mesh.h"

enum { PATTERNS = 81, ROUNDS = 200 };

static const laves__guarantee *const guarantee = &laves__guarantees[0];

static uint32_t next(uint32_t *random) { return (*random = *random * 1664525U + 1013904223U) >> 8; }
static double uniform(uint32_t *random, double low, double high) { return low + (high - low) * (next(random) / 0x1p24); }

static void set_labels(laves__cut_tet *t, int pattern) {
  for (int k = 0; k < 4; k++, pattern /= 3) t->label[k] = (int8_t)(pattern % 3 - 1);
}

static int count_label(const laves__cut_tet *t, int label) {
  int count = 0;
  for (int k = 0; k < 4; k++) count += t->label[k] == label;
  return count;
}

/* A positive tet not far from a regular one, with ids in random order and cuts anywhere; coarse numbers make equal keys. */
static laves__cut_tet random_tet(int pattern, uint32_t *random, bool coarse) {
  laves__cut_tet t = {.position = {{0, 0, 0}, {1, 0, 0}, {0.5, 0.85, 0}, {0.5, 0.3, 0.8}}};
  set_labels(&t, pattern);
  for (int k = 0; k < 4; k++) {
    t.position[k] = v3_add(t.position[k], v3(uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1)));
    t.id[k] = next(random) * 4 + (uint32_t)k;
  }
  for (int i = 0; i < 4; i++)
    for (int o = 0; o < 4; o++) {
      t.length2[i][o] = coarse ? 1 : v3_norm2(v3_sub(t.position[i], t.position[o]));
      t.fraction[i][o] = coarse ? 0.25 + 0.25 * (next(random) % 3) : uniform(random, 0.3, 0.7);
    }
  return t;
}

/* Positive pieces only; returns six times their volume. */
static double volume_of(const laves__cut_tet *t, uint8_t pieces[LAVES__PIECES_MAX][4], int count) {
  double sum = 0;
  for (int p = 0; p < count; p++) {
    laves__vec3 x[4];
    for (int k = 0; k < 4; k++) {
      assert_true(pieces[p][k] < LAVES__CODES);
      x[k] = laves__code_position(t, pieces[p][k]);
    }
    const double volume = v3_det(x[0], x[1], x[2], x[3]);
    assert_true(volume > 0);
    sum += volume;
  }
  return sum;
}

static double tet_volume(const laves__cut_tet *t) {
  return v3_det(t->position[0], t->position[1], t->position[2], t->position[3]);
}

/* ---- volumes ---- */

/* What is left of a tet with one inner corner, or one outer corner, is known: cuts take their fractions of the edges. */
static double known_share(const laves__cut_tet *t) {
  const int inner = count_label(t, LAVES__LABEL_IN), outer = count_label(t, LAVES__LABEL_OUT);
  double kept = 1, lost = 1;
  for (int i = 0; i < 4; i++)
    for (int o = 0; o < 4; o++) {
      if (t->label[i] != LAVES__LABEL_IN || t->label[o] != LAVES__LABEL_OUT) continue;
      kept *= t->fraction[i][o];
      lost *= 1 - t->fraction[i][o];
    }
  return outer == 0 ? 1 : inner == 1 ? kept : outer == 1 ? 1 - lost : NAN;
}

static void all_patterns_are_positive_and_full(void **state) {
  (void)state;
  uint32_t random = 1;
  for (int pattern = 0; pattern < PATTERNS; pattern++)
    for (int round = 0; round < ROUNDS; round++) {
      const laves__cut_tet t = random_tet(pattern, &random, round % 2);
      uint8_t pieces[LAVES__PIECES_MAX][4];
      if (count_label(&t, LAVES__LABEL_IN) == 0) continue;
      const double volume = volume_of(&t, pieces, laves__stencil_cut(guarantee, &t, pieces)), share = known_share(&t);
      if (share == share) assert_close(volume, share * tet_volume(&t), 1e-12);
      assert_true(volume < (1 + 1e-12) * tet_volume(&t));
    }
}

/* Where a plane cuts off two corners, both sides together are the tet. */
static void two_sides_of_a_plane_fill_the_tet(void **state) {
  (void)state;
  uint32_t random = 2;
  for (int pattern = 0; pattern < PATTERNS; pattern++)
    for (int round = 0; round < ROUNDS; round++) {
      laves__cut_tet side = random_tet(pattern, &random, false), other = side;
      uint8_t pieces[LAVES__PIECES_MAX][4];
      double height[4], sum;
      if (count_label(&side, LAVES__LABEL_IN) != 2 || count_label(&side, LAVES__LABEL_OUT) != 2) continue;
      for (int k = 0; k < 4; k++) {
        height[k] = uniform(&random, 0.4, 0.6);
        other.label[k] = (int8_t)-side.label[k];
      }
      for (int i = 0; i < 4; i++)
        for (int o = 0; o < 4; o++) side.fraction[i][o] = other.fraction[i][o] = height[i] / (height[i] + height[o]);
      sum = volume_of(&side, pieces, laves__stencil_cut(guarantee, &side, pieces));
      sum += volume_of(&other, pieces, laves__stencil_cut(guarantee, &other, pieces));
      assert_close(sum, tet_volume(&side), 1e-12);
    }
}

/* Both of the free diagonal's choices are whole prisms with the same four faces on the tet's own. */
static void both_choices_are_positive(void **state) {
  (void)state;
  uint32_t random = 3;
  int met = 0;
  for (int pattern = 0; pattern < PATTERNS; pattern++)
    for (int round = 0; round < ROUNDS; round++) {
      const laves__cut_tet t = random_tet(pattern, &random, round % 2);
      uint8_t order[4], pieces[2][LAVES__PIECES_MAX][4];
      if (count_label(&t, LAVES__LABEL_IN) == 0 || laves__stencil_sort(&t, order) != LAVES__STENCIL_IIOO) continue;
      for (int k = 0; k < 2; k++) {
        const int count = laves__stencil_apply(k ? LAVES__STENCIL_IIOO_OTHER : LAVES__STENCIL_IIOO, order, pieces[k]);
        assert_int_equal(count, 3);
        volume_of(&t, pieces[k], count);
      }
      assert_memory_not_equal(pieces[0], pieces[1], sizeof pieces[0]);
      met++;
    }
  assert_true(met > 6 * ROUNDS / 4);
}

/* ---- what the choice takes ---- */

static double least_margin(const laves__cut_tet *t, uint8_t pieces[LAVES__PIECES_MAX][4], int count) {
  double least = HUGE_VAL;
  for (int p = 0; p < count; p++) {
    laves__vec3 x[4];
    for (int k = 0; k < 4; k++) x[k] = laves__code_position(t, pieces[p][k]);
    least = fmin(least, laves__guarantee_margin(guarantee, x));
  }
  return least;
}

static void takes_the_better_diagonal(void **state) {
  (void)state;
  uint32_t random = 4;
  int others = 0;
  for (int round = 0; round < 20 * ROUNDS; round++) {
    const laves__cut_tet t = random_tet(8 * 9, &random, false); /* IN, IN, OUT, OUT */
    uint8_t order[4], first[LAVES__PIECES_MAX][4], other[LAVES__PIECES_MAX][4], taken[LAVES__PIECES_MAX][4];
    if (laves__stencil_sort(&t, order) != LAVES__STENCIL_IIOO) continue;
    laves__stencil_apply(LAVES__STENCIL_IIOO, order, first);
    laves__stencil_apply(LAVES__STENCIL_IIOO_OTHER, order, other);
    const double margin = least_margin(&t, taken, laves__stencil_cut(guarantee, &t, taken));
    assert_true(margin >= least_margin(&t, first, 3) && margin >= least_margin(&t, other, 3));
    others += memcmp(taken, other, sizeof taken) == 0;
  }
  assert_true(others > ROUNDS);
}

/* ---- names that do not depend on the numbering of corners ---- */

/* A vertex of a piece by the ids of its edge's ends, or of its corner twice. */
static uint64_t name_of(const laves__cut_tet *t, int code) {
  const uint64_t a = t->id[code < 4 ? code : code / 4 - 1], b = t->id[code % 4];
  return code < 4 ? a << 32 | a : a << 32 | b;
}

static int compare_names(const void *a, const void *b) {
  const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return (x > y) - (x < y);
}

typedef struct names {
  int count;
  uint64_t name[12][4]; /* sorted each, and all together */
} names;

static int compare_rows(const void *a, const void *b) {
  const uint64_t *x = a, *y = b;
  for (int k = 0; k < 4; k++)
    if (x[k] != y[k]) return x[k] > y[k] ? 1 : -1;
  return 0;
}

static void add_name(names *n, const laves__cut_tet *t, const uint8_t *codes, int width) {
  uint64_t *name = n->name[n->count++];
  for (int k = 0; k < width; k++) name[k] = name_of(t, codes[k]);
  qsort(name, (size_t)width, sizeof *name, compare_names);
}

static void assert_same_names(names *a, names *b) {
  assert_int_equal(a->count, b->count);
  qsort(a->name, (size_t)a->count, sizeof a->name[0], compare_rows);
  qsort(b->name, (size_t)b->count, sizeof b->name[0], compare_rows);
  assert_memory_equal(a->name, b->name, (size_t)a->count * sizeof a->name[0]);
}

static const uint8_t even[12][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 0, 3, 2}, {1, 2, 0, 3}, {1, 3, 2, 0},
                                    {2, 0, 1, 3}, {2, 1, 3, 0}, {2, 3, 0, 1}, {3, 0, 2, 1}, {3, 1, 0, 2}, {3, 2, 1, 0}};

static laves__cut_tet renumbered(const laves__cut_tet *t, const uint8_t by[4]) {
  laves__cut_tet r;
  for (int i = 0; i < 4; i++) {
    r.label[i] = t->label[by[i]];
    r.id[i] = t->id[by[i]];
    r.position[i] = t->position[by[i]];
    for (int o = 0; o < 4; o++) {
      r.length2[i][o] = t->length2[by[i]][by[o]];
      r.fraction[i][o] = t->fraction[by[i]][by[o]];
    }
  }
  return r;
}

static void numbering_does_not_matter(void **state) {
  (void)state;
  uint32_t random = 5;
  for (int pattern = 0; pattern < PATTERNS; pattern++)
    for (int round = 0; round < ROUNDS; round++) {
      const laves__cut_tet t = random_tet(pattern, &random, round % 2), r = renumbered(&t, even[next(&random) % 12]);
      uint8_t pieces[LAVES__PIECES_MAX][4];
      names a = {0}, b = {0};
      if (count_label(&t, LAVES__LABEL_IN) == 0) continue;
      int count = laves__stencil_cut(guarantee, &t, pieces);
      for (int p = 0; p < count; p++) add_name(&a, &t, pieces[p], 4);
      count = laves__stencil_cut(guarantee, &r, pieces);
      for (int p = 0; p < count; p++) add_name(&b, &r, pieces[p], 4);
      assert_same_names(&a, &b);
    }
}

/* ---- conformity ---- */

/* Whether a vertex lies on the face without corner `apex`. */
static bool on_face(int code, int apex) { return code < 4 ? code != apex : code / 4 - 1 != apex && code % 4 != apex; }

/* The pieces' triangles on the face. */
static names face_triangles(const laves__cut_tet *t, int apex) {
  names n = {0};
  uint8_t pieces[LAVES__PIECES_MAX][4];
  const int count = laves__stencil_cut(guarantee, t, pieces);
  for (int p = 0; p < count; p++)
    for (int f = 0; f < 4; f++) {
      uint8_t codes[3];
      bool on = true;
      for (int k = 0; k < 3; k++) {
        codes[k] = pieces[p][laves__tet_face[f][k]];
        on &= on_face(codes[k], apex);
      }
      if (on) add_name(&n, t, codes, 3);
    }
  return n;
}

/* The tet on the other side of the face without corner 3: mirrored there, with corners 0 and 1 swapped. */
static laves__cut_tet neighbour_of(const laves__cut_tet *t, uint32_t *random) {
  static const uint8_t swapped[4] = {1, 0, 2, 3};
  laves__cut_tet r = renumbered(t, swapped);
  const laves__cut_tet fresh = random_tet((int)(next(random) % PATTERNS), random, false);
  const laves__vec3 middle = v3_scale(v3_add(t->position[0], v3_add(t->position[1], t->position[2])), 1.0 / 3);
  r.position[3] = v3_mad(middle, v3_sub(t->position[3], middle), -1);
  r.label[3] = fresh.label[3];
  r.id[3] = fresh.id[3] * 4;
  for (int i = 0; i < 3; i++) {
    r.fraction[i][3] = fresh.fraction[i][3];
    r.fraction[3][i] = fresh.fraction[3][i];
    r.length2[i][3] = r.length2[3][i] = fresh.length2[i][3];
  }
  return renumbered(&r, even[next(random) % 12]);
}

static int corner_without(const laves__cut_tet *t, const laves__cut_tet *other) {
  for (int k = 0; k < 4; k++) {
    bool shared = false;
    for (int j = 0; j < 4; j++) shared |= t->id[k] == other->id[j];
    if (!shared) return k;
  }
  return -1;
}

static void neighbours_agree_on_their_face(void **state) {
  (void)state;
  uint32_t random = 6;
  int triangles = 0;
  for (int pattern = 0; pattern < PATTERNS; pattern++)
    for (int round = 0; round < 4 * ROUNDS; round++) {
      const laves__cut_tet t = random_tet(pattern, &random, round % 2), other = neighbour_of(&t, &random);
      bool inner = false; /* else the face is on the boundary, or outside */
      for (int k = 0; k < 3; k++) inner |= t.label[k] == LAVES__LABEL_IN;
      if (!inner) continue;
      names a = face_triangles(&t, 3), b = face_triangles(&other, corner_without(&other, &t));
      assert_same_names(&a, &b);
      triangles += a.count;
    }
  assert_true(triangles > 50 * ROUNDS);
}

/* Every face of a piece is shared by two pieces, lies on a face of the tet, or is on the surface: has no inner corner. */
static void pieces_leave_no_gaps(void **state) {
  (void)state;
  uint32_t random = 7;
  for (int pattern = 0; pattern < PATTERNS; pattern++)
    for (int round = 0; round < ROUNDS; round++) {
      const laves__cut_tet t = random_tet(pattern, &random, round % 2);
      uint8_t pieces[LAVES__PIECES_MAX][4];
      names all = {0};
      if (count_label(&t, LAVES__LABEL_IN) == 0) continue;
      const int count = laves__stencil_cut(guarantee, &t, pieces);
      bool outside[12];
      for (int f = 0; f < 4 * count; f++) {
        uint8_t codes[3];
        bool surface = true, on[4] = {true, true, true, true};
        for (int k = 0; k < 3; k++) {
          codes[k] = pieces[f / 4][laves__tet_face[f % 4][k]];
          surface &= codes[k] >= 4 || t.label[codes[k]] == LAVES__LABEL_ON;
          for (int apex = 0; apex < 4; apex++) on[apex] &= on_face(codes[k], apex);
        }
        outside[f] = surface || on[0] || on[1] || on[2] || on[3];
        add_name(&all, &t, codes, 3);
      }
      for (int f = 0; f < all.count; f++) {
        int equal = 0;
        for (int g = 0; g < all.count; g++) equal += compare_rows(all.name[f], all.name[g]) == 0;
        assert_int_equal(equal, outside[f] ? 1 : 2);
      }
    }
}

/* ---- keys ---- */

static void lesser_key_starts_the_diagonal(void **state) {
  (void)state;
  for (int swap = 0; swap < 2; swap++) {
    laves__cut_tet t = {.label = {-1, -1, 0, 1}, .id = {5, 6, 7, 8}, .position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    t.length2[0][3] = t.length2[1][3] = 2;
    t.fraction[0][3] = swap ? 0.25 : 0.5;
    t.fraction[1][3] = swap ? 0.5 : 0.25;
    assert_true(laves__diagonal_key(&t, 0, 3) == 2 * (swap ? 0.75 : 0.5));
    const names n = face_triangles(&t, 2);
    int diagonals = 0;
    for (int k = 0; k < n.count; k++)
      for (int i = 0; i < 3; i++) /* the cut of the greater in a triangle without its corner */
        diagonals += n.name[k][i] == name_of(&t, LAVES__CUT(swap ? 0 : 1, 3));
    assert_int_equal(n.count, 2);
    assert_int_equal(diagonals, 2);
  }
}

static void lesser_id_decides_between_equal_keys(void **state) {
  (void)state;
  for (int swap = 0; swap < 2; swap++) {
    laves__cut_tet t = {.label = {-1, -1, -1, 1}, .id = {swap ? 9 : 1, 5, swap ? 1 : 9, 3}};
    uint8_t order[4];
    for (int i = 0; i < 3; i++) {
      t.length2[i][3] = 8;
      t.fraction[i][3] = 0.5;
    }
    const uint8_t wanted[4] = {swap ? 2 : 0, 1, swap ? 0 : 2, 3};
    assert_int_equal(laves__stencil_sort(&t, order), LAVES__STENCIL_IIIO);
    assert_memory_equal(order, wanted, 4);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(all_patterns_are_positive_and_full),
      cmocka_unit_test(two_sides_of_a_plane_fill_the_tet),
      cmocka_unit_test(both_choices_are_positive),
      cmocka_unit_test(takes_the_better_diagonal),
      cmocka_unit_test(numbering_does_not_matter),
      cmocka_unit_test(neighbours_agree_on_their_face),
      cmocka_unit_test(pieces_leave_no_gaps),
      cmocka_unit_test(lesser_key_starts_the_diagonal),
      cmocka_unit_test(lesser_id_decides_between_equal_keys),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
