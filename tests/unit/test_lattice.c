/* Look-ups in the sparse lattice against brute force on plain positions. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "background/lattice.h"
#include "fixtures/random_expression.h"

enum { SIDE = 6 }; /* cells of the test's block */

/* A lattice with records in a random share of the cells of a block around the zero point, some bricks wholly inside. */
static void make_lattice(laves_context *context, uint64_t *seed, laves__lattice *l) {
  const laves__box3 bounds = {v3(-8, -8, -8), v3(8, 8, 8)};
  assert_int_equal(laves__lattice_create(context, bounds, l, NULL), LAVES_OK);
  for (size_t i = 0; i < l->directory_count; i++) l->directory[i] = random_unit(seed) < 0.5 ? LAVES__IN : LAVES__OUT;
  for (int32_t z = -SIDE / 2; z < SIDE / 2; z++)
    for (int32_t y = -SIDE / 2; y < SIDE / 2; y++)
      for (int32_t x = -SIDE / 2; x < SIDE / 2; x++)
        if (random_unit(seed) < 0.6) assert_true(laves__lattice_add_record(l, x, y, z) >= 0);
  laves__lattice_link(l);
}

static void label_at_random(laves__lattice *l, uint64_t *seed) {
  for (size_t i = 0; i < l->record_count; i++)
    for (int site = 0; site < LAVES__C15_SITES; site++) l->record[i].label[site] = (int8_t)((int)(random_unit(seed) * 3) - 1);
}

static void lattice_covers_its_bounds(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves__lattice l;
  const laves__box3 bounds = {v3(-31.5, 2, 700), v3(-31, 40, 700.1)};
  assert_int_equal(laves__lattice_create(context, bounds, &l, NULL), LAVES_OK);
  for (int axis = 0; axis < 3; axis++) {
    const double first = l.lower[axis] * LAVES__CELL_SIDE;
    const double last = (l.lower[axis] + l.bricks[axis] * LAVES__BRICK_SIDE) * LAVES__CELL_SIDE;
    assert_true(first + LAVES__CELL_SIDE <= v3_at(bounds.lower, axis) && last - LAVES__CELL_SIDE >= v3_at(bounds.upper, axis));
    assert_true(l.bricks[axis] <=
                (v3_at(bounds.upper, axis) - v3_at(bounds.lower, axis)) / LAVES__CELL_SIDE / LAVES__BRICK_SIDE + 3);
    assert_int_equal(l.lower[axis] % LAVES__BRICK_SIDE, 0);
  }
  assert_int_equal(laves__lattice_cell(&l, l.lower[0] - 1, l.lower[1], l.lower[2]), LAVES__OUT);
  assert_int_equal(laves__lattice_cell(&l, 1 << 30, -(1 << 30), 0), LAVES__OUT);
  laves__lattice_free(&l);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void sizes_beyond_the_index_are_refused(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves__lattice l;
  laves_error error;
  const double widths[] = {1e5, 1e9, 1e300, INFINITY};
  for (size_t i = 0; i < LAVES__COUNT_OF(widths); i++) {
    const double w = widths[i];
    assert_int_equal(laves__lattice_create(context, (laves__box3){v3(-w, -w, -w), v3(w, w, w)}, &l, &error), LAVES_ERROR_OPTION);
    assert_non_null(strstr(error.text, "larger size"));
    laves__lattice_free(&l);
  }
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void records_are_found_again(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves__lattice l;
  uint64_t seed = 1;
  make_lattice(context, &seed, &l);
  assert_true(l.record_count > 50);
  for (size_t i = 0; i < l.record_count; i++) {
    const laves__record *r = &l.record[i];
    assert_int_equal(laves__lattice_cell(&l, r->xyz[0], r->xyz[1], r->xyz[2]), i);
    assert_int_equal(laves__lattice_add_record(&l, r->xyz[0], r->xyz[1], r->xyz[2]), i);
    for (int k = 0; k < 27; k++)
      assert_int_equal(r->around[k],
                       laves__lattice_cell(&l, r->xyz[0] + k % 3 - 1, r->xyz[1] + k / 3 % 3 - 1, r->xyz[2] + k / 9 - 1));
  }
  laves__lattice_free(&l);
  laves_context_free(context);
}

/* New records take the sign of the cell that they were. */
static void records_inherit_the_sign_of_their_cell(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves__lattice l;
  assert_int_equal(laves__lattice_create(context, (laves__box3){v3(0, 0, 0), v3(1, 1, 1)}, &l, NULL), LAVES_OK);
  l.directory[0] = LAVES__IN;
  const int32_t *c = l.lower;
  const int32_t in = laves__lattice_add_record(&l, c[0] + 1, c[1] + 1, c[2] + 1);
  for (size_t i = 0; i < l.directory_count; i++)
    if (i) l.directory[i] = LAVES__OUT;
  assert_int_equal(laves__lattice_cell(&l, c[0], c[1], c[2]), LAVES__IN);
  const int32_t out = l.bricks[0] > 1 ? laves__lattice_add_record(&l, c[0] + LAVES__BRICK_SIDE, c[1], c[2]) : -1;
  for (int site = 0; site < LAVES__C15_SITES; site++) {
    assert_int_equal(l.record[in].sign[site], -1);
    assert_true(l.record[in].phi[site] == -HUGE_VAL);
    if (out >= 0) assert_int_equal(l.record[out].label[site], LAVES__LABEL_OUT);
  }
  laves__lattice_free(&l);
  laves_context_free(context);
}

/* The site at a position (a corner of the tiling), by search through the cells around. */
static bool is_at(const laves__lattice *l, laves__site s, laves__vec3 p) {
  if (s.cell < 0) return true; /* nothing to compare */
  return v3_distance(laves__site_position(l->record[s.cell].xyz, s.site), p) < 1e-9;
}

static void neighbours_and_corners_stand_where_the_tiling_says(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves__lattice l;
  uint64_t seed = 2;
  make_lattice(context, &seed, &l);
  size_t found = 0;
  for (size_t i = 0; i < l.record_count; i++) {
    const laves__record *r = &l.record[i];
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      const laves__vec3 p = laves__site_position(r->xyz, site);
      for (int k = 0; k < laves__c15_degree[site]; k++) {
        const laves__site s = laves__neighbour(r, site, k);
        if (s.cell < 0) continue;
        found++;
        const double length = v3_distance(p, laves__site_position(l.record[s.cell].xyz, s.site));
        assert_true(length > 0.88 && length < LAVES__C15_LONGEST_EDGE + 1e-12);
      }
    }
    for (int tet = 0; tet < LAVES__C15_TETS; tet++) {
      laves__site s[4];
      laves__tet_sites(r, tet, s);
      for (int k = 0; k < 4; k++) {
        const laves__c15_corner corner = laves__c15_tet[tet][k];
        const int32_t cell[3] = {r->xyz[0] + (corner.shift & 1), r->xyz[1] + (corner.shift >> 1 & 1),
                                 r->xyz[2] + (corner.shift >> 2)};
        assert_true(is_at(&l, s[k], laves__site_position(cell, corner.site)));
        assert_int_equal(s[k].cell, laves__lattice_cell(&l, cell[0], cell[1], cell[2]));
      }
    }
  }
  assert_true(found > 10000);
  laves__lattice_free(&l);
  laves_context_free(context);
}

/* The cell of corner k of a tet of a star, as in laves__c15_link. */
static int cell_in_star(laves__c15_star_tet star, int k) {
  const int shift = laves__c15_tet[star.tet][k].shift;
  return star.cell + (shift & 1) + 3 * (shift >> 1 & 1) + 9 * (shift >> 2);
}

static bool has_corner(laves__c15_star_tet star, laves__c15_link link) {
  for (int k = 0; k < 4; k++)
    if (k != star.corner && laves__c15_tet[star.tet][k].site == link.site && cell_in_star(star, k) == link.cell) return true;
  return false;
}

static void neighbours_know_their_tets(void **state) {
  (void)state;
  for (int site = 0; site < LAVES__C15_SITES; site++)
    for (int n = 0; n < laves__c15_degree[site]; n++) {
      uint32_t with = 0;
      for (int k = 0; k < laves__c15_star_size[site]; k++)
        with |= (uint32_t)has_corner(laves__c15_star[site][k], laves__c15_neighbour[site][n]) << k;
      assert_int_equal(laves__c15_star_with[site][n], with);
    }
}

/* Every third tet counts as solid, which matters where no corner is IN. */
static void make_solid_in_part(laves__lattice *l) {
  for (size_t i = 0; i < l->record_count; i++)
    for (size_t tet = i % 3; tet < LAVES__C15_TETS; tet += 3) l->record[i].solid[tet / 64] |= UINT64_C(1) << tet % 64;
}

static bool is_kept(const laves__lattice *l, const laves__record *owner, int tet, const laves__site corners[4]) {
  bool any_out = false;
  for (int k = 0; k < 4; k++) any_out |= laves__site_label(l, corners[k]) == LAVES__LABEL_OUT;
  return laves__tet_kept(l, corners) || (!any_out && laves__bit(owner->solid, tet));
}

/* star_kept decides as tet_kept does for each tet of the star. */
static void stars_agree_with_tets(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves__lattice l;
  uint64_t seed = 3;
  make_lattice(context, &seed, &l);
  label_at_random(&l, &seed);
  make_solid_in_part(&l);
  size_t kept_tets = 0, stars = 0;
  for (size_t i = 0; i < l.record_count; i++) {
    const laves__record *r = &l.record[i];
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      const uint64_t kept = laves__star_kept(&l, (int32_t)i, site);
      for (int k = 0; k < laves__c15_star_size[site]; k++) {
        const laves__c15_star_tet star = laves__c15_star[site][k];
        const int32_t owner = r->around[star.cell];
        if (owner < 0) continue; /* only records own tets with all cells around linked */
        laves__site corners[4];
        laves__tet_sites(&l.record[owner], star.tet, corners);
        assert_int_equal(corners[star.corner].cell, i);
        assert_int_equal(corners[star.corner].site, site);
        assert_int_equal(kept >> k & 1, is_kept(&l, &l.record[owner], star.tet, corners));
        kept_tets += kept >> k & 1;
        stars++;
      }
      assert_int_equal(kept >> laves__c15_star_size[site], 0);
    }
  }
  assert_true(stars > 20000 && kept_tets > stars / 50);
  laves__lattice_free(&l);
  laves_context_free(context);
}

static void short_memory_is_told(void **state) {
  (void)state;
  laves_context_options options = laves_context_options_default();
  options.memory_limit = 4000;
  laves_context *context = laves_context_create(&options);
  laves__lattice l;
  laves_error error;
  assert_int_equal(laves__lattice_create(context, (laves__box3){v3(0, 0, 0), v3(1, 1, 1)}, &l, &error), LAVES_OK);
  assert_int_equal(laves__lattice_add_record(&l, 0, 0, 0), -1);
  laves__lattice_free(&l);
  assert_int_equal(laves__lattice_create(context, (laves__box3){v3(0, 0, 0), v3(400, 400, 400)}, &l, &error), LAVES_ERROR_MEMORY);
  laves__lattice_free(&l);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lattice_covers_its_bounds),
      cmocka_unit_test(sizes_beyond_the_index_are_refused),
      cmocka_unit_test(records_are_found_again),
      cmocka_unit_test(records_inherit_the_sign_of_their_cell),
      cmocka_unit_test(neighbours_and_corners_stand_where_the_tiling_says),
      cmocka_unit_test(neighbours_know_their_tets),
      cmocka_unit_test(stars_agree_with_tets),
      cmocka_unit_test(short_memory_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
