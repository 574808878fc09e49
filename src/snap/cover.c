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

static bool has_crossing(const laves__lattice *lattice, const laves__record *r, int site) {
  for (int k = 0; k < laves__c15_degree[site]; k++)
    if (laves__site_sign(lattice, laves__neighbour(r, site, k)) != r->sign[site]) return true;
  return false;
}

/* |phi| where that is a distance, else the distance to the foot that projection finds. */
static void measure(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  candidates *c = user;
  for (size_t i = begin; i < end; i++) {
    const uint32_t id = (uint32_t)c->key[i];
    const int32_t record = (int32_t)(id / LAVES__C15_SITES);
    const int site = (int)(id % LAVES__C15_SITES);
    double distance = fabs(c->lattice->record[record].phi[site]);
    if (!c->frame->oracle->is_distance) {
      const laves__foot *foot = laves__feet_get(c->feet, record, site);
      distance = foot ? v3_distance(laves__site_position(c->lattice->record[record].xyz, site), foot->position) : HUGE_VAL;
    }
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
    const laves__record *r = &g->lattice->record[i];
    uint32_t mask = 0;
    for (int site = 0; site < LAVES__C15_SITES; site++)
      if (has_crossing(g->lattice, r, site)) mask |= UINT32_C(1) << site;
    g->mask[i] = mask;
  }
}

/* Whether a site has a neighbour of the other sign that is not ON. */
static bool is_exposed(const laves__lattice *lattice, const laves__record *r, int site) {
  for (int k = 0; k < laves__c15_degree[site]; k++) {
    const laves__site s = laves__neighbour(r, site, k);
    if (laves__site_sign(lattice, s) != r->sign[site] && laves__site_label(lattice, s) != LAVES__LABEL_ON) return true;
  }
  return false;
}

static void cover(const candidates *c) {
  laves__lattice *lattice = c->lattice;
  for (size_t i = 0; i < c->count; i++) {
    const uint32_t id = (uint32_t)c->key[i];
    laves__record *r = &lattice->record[id / LAVES__C15_SITES];
    const int site = (int)(id % LAVES__C15_SITES);
    if (is_exposed(lattice, r, site)) r->label[site] = LAVES__LABEL_ON;
  }
  for (size_t i = c->count; i-- > 0;) {
    const uint32_t id = (uint32_t)c->key[i];
    laves__record *r = &lattice->record[id / LAVES__C15_SITES];
    const int site = (int)(id % LAVES__C15_SITES);
    if (r->label[site] == LAVES__LABEL_ON && !is_exposed(lattice, r, site)) r->label[site] = r->sign[site];
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
