/* An adversary against the proved window: hashed signs at all sites of a block of the tiling and hashed crossings, mostly at
 * the extremes that the rule allows, taken through the mesher's own steps. The worst angles come within a hundredth of a
 * degree of what is proved, and never pass it. LAVES_SEEDS sets the number of blocks. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/predicates.h"
#include "mesh/quality.h"
#include "stuff/stuffing.h"

enum { SIDE = 8, SEEDS = 120 };

static uint64_t hash(uint64_t x) {
  x ^= x >> 33;
  x *= 0xff51afd7ed558ccd;
  x ^= x >> 33;
  x *= 0xc4ceb9fe1a85ec53;
  return x ^ x >> 33;
}

static int seeds(void) {
  const char *text = getenv("LAVES_SEEDS");
  return text ? atoi(text) : SEEDS;
}

/* A block of SIDE^3 cells in an empty lattice; hashed signs in its inner cells. `share` of 256 sites is inside. */
static void make_block(laves_context *context, uint64_t seed, unsigned share, laves__lattice *lattice) {
  const double side = SIDE * LAVES__CELL_SIDE;
  const laves__box3 bounds = {v3(0, 0, 0), v3(side, side, side)};
  assert_int_equal(laves__lattice_create(context, bounds, lattice, NULL), LAVES_OK);
  for (int z = 0; z < SIDE; z++)
    for (int y = 0; y < SIDE; y++)
      for (int x = 0; x < SIDE; x++) {
        const int32_t i = laves__lattice_add_record(lattice, x, y, z);
        assert_true(i >= 0);
        const bool inner = x > 0 && y > 0 && z > 0 && x < SIDE - 1 && y < SIDE - 1 && z < SIDE - 1;
        laves__record *r = &lattice->record[i];
        r->zone = (UINT32_C(1) << LAVES__C15_SITES) - 1;
        for (int site = 0; site < LAVES__C15_SITES; site++) {
          const uint64_t h = hash(seed * 0x9e3779b97f4a7c15 + (uint64_t)i * LAVES__C15_SITES + (uint64_t)site);
          r->sign[site] = r->label[site] = inner && h % 256 < share ? -1 : 1;
        }
      }
  laves__lattice_link(lattice);
}

/* A crossing: just short of a threshold, at it, or anywhere. */
static double hashed_fraction(const laves__guarantee *g, int inner, int outer, uint64_t h) {
  const laves__kind a = laves__kind_of(inner), b = laves__kind_of(outer);
  const double in = g->thresholds->alpha[0][a][b], out = g->thresholds->alpha[1][b][a];
  const double tiny = 1e-9;
  switch (h % 8) {
    case 0:
      return (double)(h >> 11) / 9007199254740992.0;
    case 1:
    case 2:
    case 3:
      return in - tiny;
    case 4:
    case 5:
      return 1 - out + tiny;
    case 6:
      return in;
    default:
      return 1 - out;
  }
}

/* An oracle that is happy with every guess; the crossings that are found with it are replaced. */
static void evaluate_zero(const void *self, size_t count, const laves__vec3 *points, double *phi, uint32_t *hints) {
  (void)self;
  (void)points;
  for (size_t i = 0; i < count; i++) phi[i] = 0;
  for (size_t i = 0; hints && i < count; i++) hints[i] = LAVES__NO_HINT;
}

static void fill_crossings(laves__stuffing *s, uint64_t seed) {
  assert_int_equal(laves__find_crossings(s, NULL), LAVES_OK);
  for (size_t id = 0; id < s->site_count; id++) {
    if (s->crossed[id] < 0) continue;
    laves__crossings *c = &s->crossings[s->crossed[id]];
    const int site = (int)(id % LAVES__C15_SITES);
    for (int k = 0; k < laves__c15_degree[site]; k++)
      c->fraction[k] = hashed_fraction(s->guarantee, site, laves__c15_neighbour[site][k].site, hash(seed + id * 16 + (size_t)k));
  }
}

typedef struct extremes {
  double min, max, ratio;
  size_t tets;
} extremes;

static void measure_piece(const laves__cut_tet *tet, const uint8_t piece[4], extremes *e) {
  laves__vec3 p[4];
  double cosine[6];
  for (int k = 0; k < 4; k++) p[k] = laves__code_position(tet, piece[k]);
  assert_int_equal(laves__orient3d(p[0], p[1], p[2], p[3]), 1);
  laves__tet_dihedral_cosines(p, cosine);
  for (int i = 0; i < 6; i++) {
    const double degrees = acos(cosine[i]) * (180 / 3.14159265358979323846);
    e->min = fmin(e->min, degrees);
    e->max = fmax(e->max, degrees);
  }
  e->ratio = fmin(e->ratio, laves__tet_radius_ratio(p));
  e->tets++;
}

static void measure_block(const laves__stuffing *s, extremes *e) {
  for (size_t i = 0; i < s->lattice->record_count; i++)
    for (int which = 0; which < LAVES__C15_TETS; which++) {
      laves__cut_tet tet;
      uint8_t pieces[LAVES__PIECES_MAX][4];
      if (!laves__stuffed_tet(s, (int32_t)i, which, &tet)) continue;
      const int count = laves__stencil_cut(s->guarantee, &tet, pieces);
      for (int p = 0; p < count; p++) measure_piece(&tet, pieces[p], e);
    }
}

static void attack(laves_context *context, const laves__guarantee *g, uint64_t seed, unsigned share, extremes *e) {
  laves__lattice lattice;
  const laves__oracle oracle = {.evaluate = evaluate_zero};
  const laves__frame frame = {.oracle = &oracle, .rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, .size = 1};
  make_block(context, seed, share, &lattice);
  laves__stuffing s = {
      .frame = &frame, .guarantee = g, .lattice = &lattice, .site_count = lattice.record_count * LAVES__C15_SITES};
  laves__parted parted = {0};
  size_t unsnapped = 0;
  bool grown = false;
  laves__links_fill(&s.links);
  fill_crossings(&s, seed);
  assert_int_equal(laves__warp(&s, NULL), LAVES_OK);
  assert_int_equal(laves__unpinch(&s, &parted, &unsnapped, &grown, NULL), LAVES_OK);
  assert_false(grown);
  assert_int_equal(parted.count, 0);
  if (g->relaxation > 0) assert_int_equal(laves__close(&s, NULL), LAVES_OK);
  measure_block(&s, e);
  laves__free_stuffing(&s);
  laves__lattice_free(&lattice);
}

static void attack_all(const laves__guarantee *g, int count, extremes *e) {
  laves_context *context = laves_context_create(NULL);
  *e = (extremes){180, 0, 1, 0};
  for (int seed = 0; seed < count; seed++) {
    static const unsigned shares[] = {40, 90, 128, 160, 200, 230};
    attack(context, g, (uint64_t)seed + 1, shares[seed % 6], e);
  }
  print_message("promised %g to %g, proved %g to %g, attained %.4f to %.4f, radius ratio %.4f, by %zu tets\n", g->min_dihedral,
                g->max_dihedral, g->proved_min, g->proved_max, e->min, e->max, e->ratio, e->tets);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
  assert_true(e->min >= g->proved_min);
  assert_true(e->max <= g->proved_max);
}

static void the_surface_window_is_attained(void **state) {
  (void)state;
  extremes e;
  attack_all(&laves__guarantees[0], seeds(), &e);
  assert_true(e.min <= laves__guarantees[0].proved_min + 0.01);
  assert_true(e.max >= laves__guarantees[0].proved_max - 0.01);
}

static void the_relaxed_windows_hold(void **state) {
  (void)state;
  for (int i = 1; i < LAVES__GUARANTEES; i++) {
    extremes e;
    attack_all(&laves__guarantees[i], (seeds() + 5) / 6, &e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_surface_window_is_attained),
      cmocka_unit_test(the_relaxed_windows_hold),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
