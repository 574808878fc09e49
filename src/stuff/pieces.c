/* From labels, snaps and crossings to points and pieces: what the layer needs beyond the whole tets. */
#include "stuff/stuffing.h"

/* How far the surface may be from a boundary vertex for its normal to be of use: a relaxed vertex goes a third of an edge. */
static const double normal_reach = 0.6;
/* A vertex further than this from the surface, in sizes, counts as off it. */
static const double on_surface = 1e-6;

laves__vec3 laves__stuffed_position(const laves__stuffing *s, laves__site site) {
  const laves__record *r = &s->lattice->record[site.cell];
  const laves__vec3 place = laves__site_position(r->xyz, site.site);
  const laves__snapped snapped = s->snapped[laves__site_id(site)];
  if (snapped.along == UINT8_MAX) return place;
  const laves__site other = laves__neighbour(r, site.site, snapped.along);
  return v3_lerp(place, laves__site_position(s->lattice->record[other.cell].xyz, other.site), snapped.share);
}

static laves__vec3 corner_position(const laves__stuffing *s, const laves__record *owner, int tet, int k, laves__site corner) {
  if (corner.cell >= 0 && laves__site_id(corner) < s->site_count) return laves__stuffed_position(s, corner);
  const int shift = laves__c15_tet[tet][k].shift;
  const int32_t cell[3] = {owner->xyz[0] + (shift & 1), owner->xyz[1] + (shift >> 1 & 1), owner->xyz[2] + (shift >> 2)};
  return laves__site_position(cell, corner.site);
}

bool laves__stuffed_tet(const laves__stuffing *s, int32_t record, int tet, laves__cut_tet *out) {
  const laves__record *r = &s->lattice->record[record];
  laves__site corner[4];
  bool any_in = false;
  laves__tet_sites(r, tet, corner);
  for (int k = 0; k < 4; k++) {
    out->label[k] = (int8_t)laves__site_label(s->lattice, corner[k]);
    any_in |= out->label[k] == LAVES__LABEL_IN;
  }
  for (int k = 0; k < 4; k++) {
    out->id[k] = corner[k].cell >= 0 ? laves__site_id(corner[k]) : UINT32_MAX - (uint32_t)k;
    out->position[k] = corner_position(s, r, tet, k, corner[k]);
  }
  for (int i = 0; i < 4; i++)
    for (int o = 0; o < 4 && out->label[i] == LAVES__LABEL_IN; o++) {
      if (out->label[o] != LAVES__LABEL_OUT) continue;
      const int slot = s->links.slot[tet][i][o];
      out->length2[i][o] = s->links.length2[corner[i].site][slot];
      out->fraction[i][o] = s->crossings[s->crossed[laves__site_id(corner[i])]].fraction[slot];
    }
  return any_in;
}

/* ---- vertices ---- */

/* The surface near a boundary vertex: normal, hint, and whether the vertex is on it. */
static void find_normal(const laves__frame *frame, laves__foot *foot) {
  laves__vec3 nearest, normal;
  foot->hint = LAVES__NO_HINT;
  foot->state = LAVES__FOOT_OFF;
  if (!laves__frame_project(frame, foot->position, normal_reach, &foot->hint, &nearest, &normal)) return;
  foot->normal[0] = (float)normal.x;
  foot->normal[1] = (float)normal.y;
  foot->normal[2] = (float)normal.z;
  if (v3_distance(nearest, foot->position) <= on_surface) foot->state = LAVES__FOOT_FOUND;
}

typedef struct vertex_search {
  const laves__stuffing *s;
  const uint32_t *wanted;
  const laves__feet *feet;
  laves__foot *cut;
} vertex_search;

static void find_sites(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const vertex_search *search = user;
  for (size_t i = begin; i < end; i++)
    for (uint32_t mask = search->wanted[i]; mask; mask &= mask - 1) {
      const int site = __builtin_ctz(mask);
      laves__foot *foot = laves__feet_at(search->feet, i, site);
      foot->position = laves__stuffed_position(search->s, (laves__site){(int32_t)i, (uint8_t)site});
      find_normal(search->s->frame, foot);
    }
}

static void find_cuts(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const vertex_search *search = user;
  for (size_t i = begin; i < end; i++) find_normal(search->s->frame, &search->cut[i]);
}

/* Feet of all sites that snapped. */
static laves_result place_sites(const laves__stuffing *s, laves__feet *feet, laves_error *error) {
  laves_context *context = s->lattice->context;
  const size_t records = s->lattice->record_count;
  uint32_t *wanted = laves__alloc_zeroed(context, records, sizeof *wanted);
  if (!wanted) return laves__fail_memory(context, error);
  for (size_t id = 0; id < s->site_count; id++)
    if (s->snapped[id].along != UINT8_MAX) wanted[id / LAVES__C15_SITES] |= UINT32_C(1) << id % LAVES__C15_SITES;
  laves_result result = LAVES_OK;
  vertex_search search = {.s = s, .wanted = wanted, .feet = feet};
  if (!laves__feet_make(s->lattice, wanted, feet))
    result = laves__fail_memory(context, error);
  else if (!laves__parallel_for(context, "stuff", s->site_count / LAVES__C15_SITES, 16, find_sites, &search))
    result = laves__fail_cancelled(error);
  laves__free(context, wanted, records, sizeof *wanted);
  return result;
}

/* The first cut of every list of crossings; the total. A crossing is a cut when its outer end did not snap. */
static size_t number_cuts(const laves__stuffing *s, uint32_t *first) {
  uint32_t next = 0;
  for (size_t id = 0; id < s->site_count; id++) {
    if (s->crossed[id] < 0) continue;
    laves__crossings *c = &s->crossings[s->crossed[id]];
    const laves__site site = laves__site_of((uint32_t)id);
    const laves__record *r = &s->lattice->record[site.cell];
    for (int k = 0; k < laves__c15_degree[site.site]; k++)
      if (r->label[site.site] != LAVES__LABEL_IN ||
          laves__site_label(s->lattice, laves__neighbour(r, site.site, k)) != LAVES__LABEL_OUT)
        c->set &= (uint16_t) ~(1u << k);
    first[s->crossed[id]] = next;
    next += (uint32_t)__builtin_popcount(c->set);
  }
  return next;
}

static void place_cuts(const laves__stuffing *s, const uint32_t *first, laves__foot *foot) {
  for (size_t id = 0; id < s->site_count; id++) {
    if (s->crossed[id] < 0) continue;
    const laves__crossings *c = &s->crossings[s->crossed[id]];
    const laves__site site = laves__site_of((uint32_t)id);
    const laves__record *r = &s->lattice->record[site.cell];
    laves__foot *next = foot + first[s->crossed[id]];
    for (int k = 0; k < laves__c15_degree[site.site]; k++) {
      if (!(c->set >> k & 1)) continue;
      const laves__site other = laves__neighbour(r, site.site, k);
      (next++)->position = v3_lerp(laves__site_position(r->xyz, site.site),
                                   laves__site_position(s->lattice->record[other.cell].xyz, other.site), c->fraction[k]);
    }
  }
}

/* ---- pieces ---- */

static bool is_cut(const laves__cut_tet *tet) {
  return tet->label[0] > 0 || tet->label[1] > 0 || tet->label[2] > 0 || tet->label[3] > 0;
}

/* A corner code of a background tet as the layer's builder knows it. */
static uint32_t layer_corner(const laves__stuffing *s, const uint32_t *first, const laves__cut_tet *tet, int which, int code) {
  if (code < 4) return tet->id[code];
  const int i = code / 4 - 1, o = code % 4;
  const int32_t list = s->crossed[tet->id[i]];
  const int slot = s->links.slot[which][i][o];
  const unsigned before = s->crossings[list].set & ((1u << slot) - 1);
  return LAVES__CUT_VERTEX | (first[list] + (uint32_t)__builtin_popcount(before));
}

static laves_result cut_tets(const laves__stuffing *s, const uint32_t *first, laves__cuts *cuts, laves_error *error) {
  laves_context *context = s->lattice->context;
  for (size_t i = 0; i < s->site_count / LAVES__C15_SITES; i++) {
    if (i % 1024 == 0 && laves__cancelled(context, "stuff", 1)) return laves__fail_cancelled(error);
    for (int which = 0; which < LAVES__C15_TETS; which++) {
      laves__cut_tet tet;
      uint8_t pieces[LAVES__PIECES_MAX][4];
      if (!laves__stuffed_tet(s, (int32_t)i, which, &tet) || !is_cut(&tet)) continue;
      const int count = laves__stencil_cut(s->guarantee, &tet, pieces);
      if (!laves__grow(context, &cuts->tet, &cuts->tet_capacity, cuts->tet_count + (size_t)count, sizeof *cuts->tet))
        return laves__fail_memory(context, error);
      for (int p = 0; p < count; p++) {
        for (int k = 0; k < 4; k++) cuts->tet[cuts->tet_count][k] = layer_corner(s, first, &tet, which, pieces[p][k]);
        cuts->tet_count++;
      }
    }
  }
  return LAVES_OK;
}

laves_result laves__make_pieces(laves__stuffing *s, laves__feet *feet, laves__cuts *cuts, laves_error *error) {
  laves_context *context = s->lattice->context;
  laves_result result = place_sites(s, feet, error);
  if (result != LAVES_OK) return result;
  uint32_t *first = laves__alloc(context, s->crossing_count, sizeof *first);
  if (!first) return laves__fail_memory(context, error);
  cuts->context = context;
  cuts->vertex_count = number_cuts(s, first);
  cuts->vertex = laves__alloc_zeroed(context, cuts->vertex_count, sizeof *cuts->vertex);
  if (cuts->vertex) {
    place_cuts(s, first, cuts->vertex);
    vertex_search search = {.s = s, .cut = cuts->vertex};
    if (!laves__parallel_for(context, "stuff", cuts->vertex_count, 16, find_cuts, &search)) result = laves__fail_cancelled(error);
    if (result == LAVES_OK) result = cut_tets(s, first, cuts, error);
  } else {
    result = laves__fail_memory(context, error);
  }
  laves__free(context, first, s->crossing_count, sizeof *first);
  return result;
}
