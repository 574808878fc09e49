/* After the repair the kept tets of every ON site form one fan, or are listed as parted, whatever the labels were. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/hard_solids.h"
#include "fixtures/random_expression.h"
#include "fixtures/stages.h"
#include "snap/snap.h"

/* How many pieces a set of tets of a star falls into, by repeated marking. */
static int pieces_of(int site, uint64_t set) {
  int pieces = 0;
  while (set) {
    uint64_t piece = set & -set;
    for (bool grown = true; grown;) {
      grown = false;
      for (int k = 0; k < laves__c15_star_size[site]; k++)
        for (int j = 0; j < 3 && piece >> k & 1; j++) {
          const uint64_t next = UINT64_C(1) << laves__c15_star[site][k].across[j];
          if (!(set & next) || piece & next) continue;
          piece |= next;
          grown = true;
        }
    }
    set &= ~piece;
    pieces++;
  }
  return pieces;
}

static uint64_t whole_star(int site) { return (UINT64_C(1) << laves__c15_star_size[site]) - 1; }

static void assert_fans(const laves__lattice *l, const laves__parted *parted, const char *name) {
  size_t listed = 0;
  for (size_t i = 0; i < l->record_count; i++)
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      if (l->record[i].label[site] == LAVES__LABEL_OUT) continue;
      const uint64_t kept = laves__star_kept(l, (int32_t)i, site);
      if (l->record[i].label[site] == LAVES__LABEL_IN) {
        if (kept != whole_star(site)) fail_msg("%s: a site inside has an OUT neighbour", name);
        continue;
      }
      if (kept == whole_star(site)) fail_msg("%s: a site with all its tets is still ON", name);
      const int pieces = pieces_of(site, kept);
      const uint32_t id = (uint32_t)i * LAVES__C15_SITES + (uint32_t)site;
      const laves__parted_site *item = NULL;
      for (size_t p = 0; p < parted->count; p++)
        if (parted->item[p].site == id) item = &parted->item[p];
      if (pieces > 1) {
        if (!item) fail_msg("%s: %d fans at a site that is not listed", name, pieces);
        assert_int_equal(item->fan_count, pieces);
        uint64_t all = 0;
        for (int f = 0; f < pieces; f++) {
          assert_int_equal(all & item->fan[f], 0);
          assert_int_equal(pieces_of(site, item->fan[f]), 1);
          assert_int_equal(pieces_of(site, whole_star(site) & ~item->fan[f]), 1);
          all |= item->fan[f];
        }
        assert_int_equal(all, kept);
        listed++;
      } else {
        assert_null(item);
        if (kept && pieces_of(site, whole_star(site) & ~kept) != 1) fail_msg("%s: a wall is left", name);
      }
    }
  assert_int_equal(listed, parted->count);
  for (size_t p = 1; p < parted->count; p++) assert_true(parted->item[p - 1].site < parted->item[p].site);
}

static size_t repair(stages *s, const char *name, size_t *parts) {
  laves__parted parted = {0};
  size_t pinches = 0;
  laves_error error;
  assert_int_equal(laves__pinch_repair(&s->lattice, &parted, &pinches, &error), LAVES_OK);
  assert_fans(&s->lattice, &parted, name);
  if (parts) *parts = parted.count;
  laves__parted_free(s->context, &parted);
  return pinches;
}

static void hard_solids_become_manifolds(void **state) {
  (void)state;
  size_t pinches = 0;
  for (int i = 0; i < hard_solid_count; i++) {
    if (hard_solids[i].scale == 5 || hard_solids[i].scale == -1) continue; /* beyond the bounds */
    const laves_function function = hard_function(&hard_solids[i]);
    stages s;
    stages_begin_function(&s, &function, 0.19);
    stages_cover(&s);
    pinches += repair(&s, hard_solids[i].name, NULL);
    stages_end(&s);
  }
  assert_true(pinches > 100);
}

/* A tet with four corners ON may stay or not, or only one of these, as chance will. */
static void make_solid(const laves__lattice *l, laves__record *r, int tet, uint64_t *seed) {
  laves__site corner[4];
  laves__tet_sites(r, tet, corner);
  for (int k = 0; k < 4; k++)
    if (corner[k].cell < 0 || laves__site_label(l, corner[k]) != LAVES__LABEL_ON) return;
  if (random_unit(seed) < 0.5) laves__flip_bit(r->eligible, tet);
  if (random_unit(seed) < 0.5) laves__flip_bit(r->solid, tet);
}

/* Random labels that no cover would give, but without an edge from IN to OUT, which is all that the repair relies on. */
static void random_labels_become_manifolds(void **state) {
  (void)state;
  for (uint64_t run = 0; run < 12; run++) {
    uint64_t seed = run;
    stages s;
    stages_begin(&s, "sphere(1)", 0.22, 0);
    stages_classify(&s);
    laves__lattice *l = &s.lattice;
    const double share = 0.15 + 0.05 * (double)run;
    for (size_t i = 0; i < l->record_count; i++)
      for (int site = 0; site < LAVES__C15_SITES; site++)
        if (random_unit(&seed) < share && l->record[i].label[site] == LAVES__LABEL_IN)
          l->record[i].label[site] = LAVES__LABEL_OUT;
    for (size_t i = 0; i < l->record_count; i++)
      for (int site = 0; site < LAVES__C15_SITES; site++) {
        laves__record *r = &l->record[i];
        if (r->label[site] != LAVES__LABEL_OUT) continue;
        for (int k = 0; k < laves__c15_degree[site]; k++) {
          const laves__site n = laves__neighbour(r, site, k);
          if (n.cell >= 0 && l->record[n.cell].label[n.site] == LAVES__LABEL_IN)
            l->record[n.cell].label[n.site] = LAVES__LABEL_ON;
        }
      }
    for (size_t i = 0; i < l->record_count && run % 2; i++)
      for (int tet = 0; tet < LAVES__C15_TETS; tet++) make_solid(l, &l->record[i], tet, &seed);
    repair(&s, "random labels", NULL);
    stages_end(&s);
  }
}

static void sound_solids_are_left_alone(void **state) {
  (void)state;
  stages s;
  stages_begin(&s, "torus(1, 0.3)", 0.05, 0);
  stages_cover(&s);
  assert_int_equal(repair(&s, "torus", NULL), 0);
  stages_end(&s);
}

/* Two balls that meet in one vertex are parted there, not joined and not trimmed. */
static void touching_parts_are_set_apart(void **state) {
  (void)state;
  stages s;
  stages_begin(&s, "sphere(1)", 0.3, 0);
  stages_classify(&s);
  laves__lattice *l = &s.lattice;
  for (size_t i = 0; i < l->record_count; i++)
    for (int site = 0; site < LAVES__C15_SITES; site++) l->record[i].label[site] = LAVES__LABEL_OUT;
  for (size_t i = 0; i < l->directory_count; i++)
    if (l->directory[i] == LAVES__IN) l->directory[i] = LAVES__OUT;
  for (size_t i = 0; i < l->brick_count; i++)
    for (int c = 0; c < LAVES__BRICK_CELLS; c++)
      if (l->brick[i].cell[c] == LAVES__IN) l->brick[i].cell[c] = LAVES__OUT;
  laves__lattice_link(l);
  /* A vertex v of 16 neighbours; two of them, the furthest from each other, go IN with all their neighbours ON. */
  size_t record = 0;
  for (; record < l->record_count; record++) {
    bool all = true;
    for (int k = 0; k < 27; k++) all &= l->record[record].around[k] >= 0;
    if (all) break;
  }
  assert_true(record < l->record_count);
  const laves__record *r = &l->record[record];
  int a = 0, b = 0;
  double widest = 0;
  for (int i = 0; i < laves__c15_degree[0]; i++)
    for (int j = 0; j < i; j++) {
      const laves__site p = laves__neighbour(r, 0, i), q = laves__neighbour(r, 0, j);
      const double d =
          v3_distance(laves__site_position(l->record[p.cell].xyz, p.site), laves__site_position(l->record[q.cell].xyz, q.site));
      if (d <= widest) continue;
      widest = d;
      a = i;
      b = j;
    }
  const laves__site inside[2] = {laves__neighbour(r, 0, a), laves__neighbour(r, 0, b)};
  for (int n = 0; n < 2; n++) {
    laves__record *c = &l->record[inside[n].cell];
    c->label[inside[n].site] = LAVES__LABEL_IN;
    for (int k = 0; k < laves__c15_degree[inside[n].site]; k++) {
      const laves__site s1 = laves__neighbour(c, inside[n].site, k);
      assert_true(s1.cell >= 0);
      l->record[s1.cell].label[s1.site] = LAVES__LABEL_ON;
    }
  }
  size_t parts;
  assert_int_equal(repair(&s, "touching", &parts), 1);
  assert_int_equal(parts, 1);
  stages_end(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(hard_solids_become_manifolds),
      cmocka_unit_test(random_labels_become_manifolds),
      cmocka_unit_test(sound_solids_are_left_alone),
      cmocka_unit_test(touching_parts_are_set_apart),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
