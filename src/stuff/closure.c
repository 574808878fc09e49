/* The closure: relaxes boundary vertices until every piece is inside the window of a guarantee above the first.
 *
 * While a background tet has a piece outside, all of its snapped sites and cuts that are not relaxed yet go a fixed share of
 * the way to where the tet is best: a site to its place, a cut to the middle of its edge. What is proved is that a tet all of
 * whose boundary vertices are relaxed is inside. A vertex is relaxed once, so this ends, and then every tet is inside: it
 * passed the test, or it has nothing left to relax. */
#include <string.h>

#include "base/predicates.h"
#include "stuff/stuffing.h"

typedef struct closure {
  laves__stuffing *s;
  size_t records;
  bool *dirty;         /* [records] has tets to look at */
  uint64_t (*miss)[3]; /* [records] tets with a piece outside */
} closure;

static bool is_inside(const laves__stuffing *s, const laves__cut_tet *tet) {
  uint8_t pieces[LAVES__PIECES_MAX][4];
  const int count = laves__stencil_cut(s->guarantee, tet, pieces);
  for (int p = 0; p < count; p++) {
    laves__vec3 corner[4];
    for (int k = 0; k < 4; k++) corner[k] = laves__code_position(tet, pieces[p][k]);
    if (!(laves__guarantee_margin(s->guarantee, corner) >= 1)) return false;
  }
  return true;
}

/* Where four sites snap and none is inside, the tet is dropped; but it must not be turned inside out, or its neighbours would
 * overlap. Relaxed, it is not. */
static bool is_turned(const laves__cut_tet *tet) {
  for (int k = 0; k < 4; k++)
    if (tet->label[k] != LAVES__LABEL_ON) return false;
  return laves__orient3d(tet->position[0], tet->position[1], tet->position[2], tet->position[3]) <= 0;
}

static void judge_records(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const closure *c = user;
  for (size_t i = begin; i < end; i++) {
    memset(c->miss[i], 0, sizeof c->miss[i]);
    for (int tet = 0; c->dirty[i] && tet < LAVES__C15_TETS; tet++) {
      laves__cut_tet now;
      const bool kept = laves__stuffed_tet(c->s, (int32_t)i, tet, &now);
      if (kept ? !is_inside(c->s, &now) : is_turned(&now)) laves__flip_bit(c->miss[i], tet);
    }
  }
}

static void note_move(laves__stuffing *s, double distance) {
  s->relaxed_count++;
  s->relaxed_max = fmax(s->relaxed_max, distance);
}

static bool relax_site(laves__stuffing *s, laves__site site) {
  if (site.cell < 0 || laves__site_id(site) >= s->site_count) return false;
  laves__snapped *snapped = &s->snapped[laves__site_id(site)];
  if (snapped->along == UINT8_MAX || snapped->relaxed) return false;
  const double way = s->guarantee->relaxation * snapped->share;
  note_move(s, way * sqrt(s->links.length2[site.site][snapped->along]));
  snapped->share -= way;
  return snapped->relaxed = true;
}

static bool relax_cut(laves__stuffing *s, laves__site inner, laves__site outer, int slot) {
  laves__crossings *c = &s->crossings[s->crossed[laves__site_id(inner)]];
  if (c->relaxed >> slot & 1) return false;
  const double middle = s->guarantee->thresholds->middle[laves__kind_of(inner.site)][laves__kind_of(outer.site)];
  const double way = s->guarantee->relaxation * (middle - c->fraction[slot]);
  note_move(s, fabs(way) * sqrt(s->links.length2[inner.site][slot]));
  c->fraction[slot] += way;
  c->relaxed |= (uint16_t)(1u << slot);
  return true;
}

static bool relax_tet(laves__stuffing *s, const laves__record *r, int tet) {
  laves__site corner[4];
  bool changed = false;
  laves__tet_sites(r, tet, corner);
  for (int i = 0; i < 4; i++) {
    const laves__label label = laves__site_label(s->lattice, corner[i]);
    if (label == LAVES__LABEL_ON) changed |= relax_site(s, corner[i]);
    for (int o = 0; label == LAVES__LABEL_IN && o < 4; o++)
      if (laves__site_label(s->lattice, corner[o]) == LAVES__LABEL_OUT)
        changed |= relax_cut(s, corner[i], corner[o], s->links.slot[tet][i][o]);
  }
  return changed;
}

/* Relaxes what missed; the cells around are looked at next. */
static bool relax_missed(closure *c, bool *next) {
  bool any = false;
  for (size_t i = 0; i < c->records; i++) {
    bool changed = false;
    for (int tet = 0; tet < LAVES__C15_TETS; tet++)
      if (laves__bit(c->miss[i], tet)) changed |= relax_tet(c->s, &c->s->lattice->record[i], tet);
    for (int k = 0; changed && k < 27; k++) {
      const int32_t around = c->s->lattice->record[i].around[k];
      if (around >= 0 && (size_t)around < c->records) next[around] = true;
    }
    any |= changed;
  }
  return any;
}

laves_result laves__close(laves__stuffing *s, laves_error *error) {
  laves_context *context = s->lattice->context;
  closure c = {.s = s, .records = s->site_count / LAVES__C15_SITES};
  laves_result result = LAVES_OK;
  bool *next = laves__alloc(context, c.records, sizeof *next);
  c.dirty = laves__alloc(context, c.records, sizeof *c.dirty);
  c.miss = laves__alloc(context, c.records, sizeof *c.miss);
  if (!next || !c.dirty || !c.miss) {
    result = laves__fail_memory(context, error);
    goto cleanup;
  }
  for (size_t i = 0; i < c.records; i++) c.dirty[i] = s->lattice->record[i].zone != 0;
  for (bool again = true; again;) {
    if (!laves__parallel_for(context, "stuff", c.records, 16, judge_records, &c)) {
      result = laves__fail_cancelled(error);
      goto cleanup;
    }
    memset(next, 0, c.records * sizeof *next);
    again = relax_missed(&c, next);
    bool *swap = c.dirty;
    c.dirty = next;
    next = swap;
  }
cleanup:
  laves__free(context, next, c.records, sizeof *next);
  laves__free(context, c.dirty, c.records, sizeof *c.dirty);
  laves__free(context, c.miss, c.records, sizeof *c.miss);
  return result;
}
