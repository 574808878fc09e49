/* Crossings: every edge from an inner to an outer site is given one point where the surface crosses it.
 *
 * The sign changes between the ends, so a bracket is known; many brackets shrink together, so that the oracle is asked in
 * batches, by false position with the Illinois weight, and by halving where that is slow or a value is infinite. An edge
 * whose labels differ though its signs do not (it joins a place made by snapping) is crossed in the middle. */
#include "stuff/stuffing.h"

#include <string.h>

enum { BATCH = 256, STEPS = 60, FALSE_POSITION_STEPS = 12 };
static const double close_enough = 1e-9; /* width of a bracket, share of the edge */

typedef struct bracket {
  laves__vec3 a, b;         /* ends: inner, outer */
  double low, high;         /* shares of the edge; inside at low, outside at high */
  double low_phi, high_phi; /* with Illinois weights */
  double at;                /* asked */
  int side;                 /* of the last answer */
  double *result;
} bracket;

static double next_point(const bracket *e, int step) {
  const double middle = 0.5 * (e->low + e->high);
  const double slope = e->high_phi - e->low_phi;
  if (step >= FALSE_POSITION_STEPS || !(slope > 0) || !isfinite(slope)) return middle;
  const double margin = 0.5 * close_enough, at = e->low - e->low_phi / slope * (e->high - e->low);
  return fmin(fmax(at, e->low + margin), e->high - margin);
}

static void narrow(bracket *e, double phi) {
  if (phi < 0) {
    e->low = e->at;
    e->low_phi = phi;
    if (e->side < 0) e->high_phi *= 0.5;
    e->side = -1;
  } else {
    e->high = e->at;
    e->high_phi = isnan(phi) ? HUGE_VAL : phi;
    if (e->side > 0) e->low_phi *= 0.5;
    e->side = 1;
  }
}

static void solve(const laves__frame *frame, bracket *e, size_t count) {
  laves__vec3 at[BATCH];
  double phi[BATCH];
  size_t active[BATCH], active_count = count;
  for (size_t i = 0; i < count; i++) active[i] = i;
  for (int step = 0; step < STEPS && active_count > 0; step++) {
    for (size_t i = 0; i < active_count; i++) {
      bracket *b = &e[active[i]];
      b->at = next_point(b, step);
      at[i] = v3_lerp(b->a, b->b, b->at);
    }
    laves__frame_evaluate(frame, active_count, at, phi, NULL);
    size_t left = 0;
    for (size_t i = 0; i < active_count; i++) {
      bracket *b = &e[active[i]];
      narrow(b, phi[i]);
      if (b->high - b->low > close_enough && fabs(phi[i]) > 1e-3 * close_enough) active[left++] = active[i];
    }
    active_count = left;
  }
  for (size_t i = 0; i < count; i++) *e[i].result = e[i].at;
}

static void find_some(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  laves__stuffing *s = user;
  bracket batch[BATCH];
  size_t count = 0;
  for (size_t id = begin; id < end; id++) {
    if (s->crossed[id] < 0) continue;
    const laves__site site = laves__site_of((uint32_t)id);
    const laves__record *r = &s->lattice->record[site.cell];
    laves__crossings *c = &s->crossings[s->crossed[id]];
    for (int k = 0; k < laves__c15_degree[site.site]; k++) {
      if (!(c->set >> k & 1)) continue;
      const laves__site n = laves__neighbour(r, site.site, k);
      const laves__record *other = &s->lattice->record[n.cell];
      if (r->sign[site.site] >= other->sign[n.site]) {
        c->fraction[k] = 0.5;
        continue;
      }
      batch[count++] = (bracket){.a = laves__site_position(r->xyz, site.site),
                                 .b = laves__site_position(other->xyz, n.site),
                                 .high = 1,
                                 .low_phi = r->phi[site.site],
                                 .high_phi = other->phi[n.site],
                                 .result = &c->fraction[k]};
      if (count < BATCH) continue;
      solve(s->frame, batch, count);
      count = 0;
    }
  }
  solve(s->frame, batch, count);
}

/* The bits of a site's neighbours that are OUT, if the site is IN. */
static uint16_t outer_neighbours(const laves__lattice *lattice, laves__site site) {
  const laves__record *r = &lattice->record[site.cell];
  uint16_t set = 0;
  for (int k = 0; r->label[site.site] == LAVES__LABEL_IN && k < laves__c15_degree[site.site]; k++) {
    const laves__site n = laves__neighbour(r, site.site, k); /* in a record, as classification promises */
    if (n.cell >= 0 && lattice->record[n.cell].label[n.site] == LAVES__LABEL_OUT) set |= (uint16_t)(1u << k);
  }
  return set;
}

static void count_crossed(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  laves__stuffing *s = user;
  for (size_t id = begin; id < end; id++) s->crossed[id] = outer_neighbours(s->lattice, laves__site_of((uint32_t)id)) ? 0 : -1;
}

laves_result laves__find_crossings(laves__stuffing *s, laves_error *error) {
  laves_context *context = s->lattice->context;
  s->crossed = laves__alloc(context, s->site_count, sizeof *s->crossed);
  if (!s->crossed) return laves__fail_memory(context, error);
  if (!laves__parallel_for(context, "stuff", s->site_count, 512, count_crossed, s)) return laves__fail_cancelled(error);
  for (size_t id = 0; id < s->site_count; id++)
    if (s->crossed[id] == 0) s->crossed[id] = (int32_t)s->crossing_count++;
  s->crossings = laves__alloc_zeroed(context, s->crossing_count, sizeof *s->crossings);
  if (!s->crossings) return laves__fail_memory(context, error);
  for (size_t id = 0; id < s->site_count; id++)
    if (s->crossed[id] >= 0) s->crossings[s->crossed[id]].set = outer_neighbours(s->lattice, laves__site_of((uint32_t)id));
  if (!laves__parallel_for(context, "stuff", s->site_count, 1024, find_some, s)) return laves__fail_cancelled(error);
  return LAVES_OK;
}

laves__crossings *laves__crossing_at(const laves__stuffing *s, laves__site site, int k, int *slot) {
  const laves__site other = laves__neighbour(&s->lattice->record[site.cell], site.site, k);
  const uint32_t here = laves__site_id(site);
  if (here < s->site_count && s->crossed[here] >= 0 && s->crossings[s->crossed[here]].set >> k & 1) {
    *slot = k;
    return &s->crossings[s->crossed[here]];
  }
  if (other.cell < 0 || laves__site_id(other) >= s->site_count) return NULL;
  const int32_t list = s->crossed[laves__site_id(other)];
  *slot = s->links.back[site.site][k];
  return list >= 0 && s->crossings[list].set >> *slot & 1 ? &s->crossings[list] : NULL;
}

void laves__free_stuffing(laves__stuffing *s) {
  laves_context *context = s->lattice->context;
  laves__free(context, s->crossed, s->site_count, sizeof *s->crossed);
  laves__free(context, s->crossings, s->crossing_count, sizeof *s->crossings);
  laves__free(context, s->snapped, s->site_count, sizeof *s->snapped);
  s->crossed = NULL;
  s->crossings = NULL;
  s->snapped = NULL;
  s->crossing_count = 0;
}
