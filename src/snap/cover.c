/* The vertex cover of the crossing edges.
 *
 *        OUT        OUT                    OUT        OUT
 *          \  x    /                         \       /
 *     ------\-----/-------- surface  ==>  ----- ON ---------
 *            \   /                              |
 *             IN (near)                        IN
 *
 * Greedy: sites near crossings in the order of their distance to the surface; a site goes ON when it still has a neighbour
 * of the other sign that is not ON. Then, furthest first, a site whose neighbours of the other sign are all ON takes its
 * sign back. Nearest first keeps the moves small (at most about 0.6 of an edge where the surface is resolved).
 *
 * Ties are broken by the number of the site, so the cover depends on nothing but the domain and the lattice. */
#include "base/sort.h"
#include "snap/snap.h"

typedef struct candidates {
  const laves__frame *frame;
  laves__lattice *lattice;
  const laves__feet *feet;
  uint64_t *key; /* distance, then record * 24 + site */
  size_t count;
} candidates;

static bool has_crossing(const laves__lattice *lattice, laves__site s) {
  const laves__ring ring = laves__ring_of(lattice, s);
  const int sign = laves__site_sign(lattice, s);
  for (int k = 0; k < ring.count; k++)
    if (laves__site_sign(lattice, laves__ring_at(&ring, k)) != sign) return true;
  return false;
}

/* |phi| where that is a distance, else the distance to the foot that projection finds; in local sizes. */
static void measure(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  candidates *c = user;
  for (size_t i = begin; i < end; i++) {
    const uint32_t id = (uint32_t)c->key[i];
    const laves__site s = laves__site_of(id);
    double distance = fabs(c->lattice->record[s.cell].phi[s.site]);
    if (!c->frame->oracle->is_distance) {
      const laves__foot *foot = laves__feet_get(c->feet, s.cell, s.site);
      distance = foot ? v3_distance(laves__site_place(c->lattice, s), foot->position) : HUGE_VAL;
    }
    distance /= laves__site_scale(c->lattice, s);
    c->key[i] = laves__sort_key(distance < 1e30 ? distance : 1e30, id);
  }
}

typedef struct gather {
  laves__lattice *lattice;
  uint32_t *mask; /* [record_count] bit for each site with a crossing edge */
} gather;

static void find_crossings(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const gather *g = user;
  for (size_t i = begin; i < end; i++) {
    uint32_t mask = 0;
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      const laves__site s = {(int32_t)i, (uint8_t)site};
      if (has_crossing(g->lattice, s) && !laves__is_hull(g->lattice, s)) mask |= UINT32_C(1) << site;
    }
    g->mask[i] = mask;
  }
}

/* Whether a site has a neighbour of the other sign that is not ON. */
static bool is_exposed(const laves__lattice *lattice, laves__site s) {
  const laves__ring ring = laves__ring_of(lattice, s);
  const int sign = laves__site_sign(lattice, s);
  for (int k = 0; k < ring.count; k++) {
    const laves__site n = laves__ring_at(&ring, k);
    if (laves__site_sign(lattice, n) != sign && laves__site_label(lattice, n) != LAVES__LABEL_ON) return true;
  }
  return false;
}

static void cover(const candidates *c) {
  laves__lattice *lattice = c->lattice;
  for (size_t i = 0; i < c->count; i++) {
    const laves__site s = laves__site_of((uint32_t)c->key[i]);
    if (is_exposed(lattice, s)) lattice->record[s.cell].label[s.site] = LAVES__LABEL_ON;
  }
  for (size_t i = c->count; i-- > 0;) {
    const laves__site s = laves__site_of((uint32_t)c->key[i]);
    laves__record *r = &lattice->record[s.cell];
    if (r->label[s.site] == LAVES__LABEL_ON && !is_exposed(lattice, s)) r->label[s.site] = r->sign[s.site];
  }
}

laves_result laves__cover(const laves__frame *frame, laves__lattice *lattice, laves__feet *feet, laves_error *error) {
  laves_context *context = lattice->context;
  const size_t records = lattice->record_count;
  laves_result result = LAVES_OK;
  uint64_t *scratch = NULL;
  candidates c = {.frame = frame, .lattice = lattice, .feet = feet};
  size_t capacity = 0;
  gather g = {lattice, laves__alloc(context, records, sizeof *g.mask)};
  if (!g.mask) {
    result = laves__fail_memory(context, error);
    goto cleanup;
  }
  if (!laves__parallel_for(context, "snap", records, 16, find_crossings, &g)) {
    result = laves__fail_cancelled(error);
    goto cleanup;
  }
  if (!frame->oracle->is_distance) result = laves__feet_find(frame, lattice, g.mask, feet, error);
  if (result != LAVES_OK) goto cleanup;
  for (size_t i = 0; i < records; i++) capacity += (size_t)__builtin_popcount(g.mask[i]);
  c.key = laves__alloc(context, capacity, sizeof *c.key);
  scratch = laves__alloc(context, capacity, sizeof *scratch);
  if (!c.key || !scratch) {
    result = laves__fail_memory(context, error);
    goto cleanup;
  }
  for (size_t i = 0; i < records; i++)
    for (uint32_t mask = g.mask[i]; mask; mask &= mask - 1)
      c.key[c.count++] = (uint32_t)i * LAVES__C15_SITES + (uint32_t)__builtin_ctz(mask);
  if (!laves__parallel_for(context, "snap", c.count, 64, measure, &c)) {
    result = laves__fail_cancelled(error);
    goto cleanup;
  }
  laves__sort_u64(c.key, scratch, c.count);
  cover(&c);
cleanup:
  laves__free(context, scratch, capacity, sizeof *scratch);
  laves__free(context, c.key, capacity, sizeof *c.key);
  laves__free(context, g.mask, records, sizeof *g.mask);
  return result;
}
