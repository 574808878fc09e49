/* Thin walls: edges that cross the surface twice.
 *
 *      OUT ------ | material | ------ OUT        an edge with the same sign at both ends that passes through a wall
 *
 * (The mirror image, inner sites on both sides of a gap, is left alone: opening gaps narrower than the size also cuts
 * tunnels under folds.)
 *
 * The cover of crossing edges can't see them, and the wall would be lost. Both ends of such an edge go ON, so that the wall
 * is meshed by tets whose four corners lie on the surface.
 *
 * To find them without looking at every edge: along an edge that does not meet such a place phi is nearly linear. A site is
 * suspected when the values of its neighbours do not fit a plane; an edge between two suspects whose outward directions
 * oppose one another is looked at, at three places. */
#include <string.h>

#include "snap/snap.h"

enum { ROUNDS = 4, SAMPLES = 3 };
static const double misfit_min = 0.3;        /* root mean square deviation from a plane, sizes; a sphere of radius 3 has 0.1 */
static const double reach = 1.2;             /* sizes from the surface within which an end must lie */
static const double opposed = -0.2;          /* cosine between the outward directions at the ends */
static const double depth_min = 0.15;        /* sizes: how deep a sample must lie on the other side */
static const double strictly_opposed = -0.7; /* the same between two sheets of a wall */
static const double sheet_depth = 0.1;       /* sizes: what depth_min is between two sheets */

typedef struct thinning {
  const laves__frame *frame;
  laves__lattice *lattice;
  laves__feet *feet;
  uint32_t *bent;     /* [record_count] bit for each site around which phi is far from linear */
  uint32_t *suspects; /* [record_count] these and those beside them */
  uint32_t *turns_on; /* [record_count] sites that go ON after this round */
} thinning;

/* The end of an edge, its foot, and the surface's outward normal there. */
typedef struct edge_end {
  laves__vec3 at, foot, normal;
} edge_end;

/* Whether phi around a site is far from linear. The star of a site is nearly isotropic, so the slope is a weighted sum. */
static bool is_suspect(const thinning *t, laves__site s) {
  const laves__lattice *lattice = t->lattice;
  const double phi = lattice->record[s.cell].phi[s.site];
  if (!isfinite(phi)) return false;
  const double scale = laves__site_scale(lattice, s);
  if (t->frame->oracle->is_distance && !(fabs(phi) < reach * scale)) return false;
  laves__vec3 at[LAVES__LINK_LIMIT], slope = {0, 0, 0};
  double rise[LAVES__LINK_LIMIT], square = 0;
  int count = 0;
  const laves__vec3 p = laves__site_place(lattice, s);
  const laves__ring ring = laves__ring_of(lattice, s);
  for (int k = 0; k < ring.count; k++) {
    const laves__site n = laves__ring_at(&ring, k);
    if (n.cell < 0 || !isfinite(lattice->record[n.cell].phi[n.site])) continue;
    at[count] = v3_sub(laves__site_place(lattice, n), p);
    rise[count] = lattice->record[n.cell].phi[n.site] - phi;
    slope = v3_mad(slope, at[count], rise[count]);
    square += v3_norm2(at[count]);
    count++;
  }
  if (count < 6) return true; /* half of its star is far away: too little to tell */
  slope = v3_scale(slope, 3 / square);
  double misfit = 0;
  for (int k = 0; k < count; k++) {
    const double d = rise[k] - v3_dot(slope, at[k]);
    misfit += d * d;
  }
  const double steep = v3_norm2(slope);
  return misfit > misfit_min * misfit_min * scale * scale * count * steep;
}

static void find_suspects(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const thinning *t = user;
  for (size_t i = begin; i < end; i++) {
    uint32_t mask = 0;
    for (int site = 0; site < LAVES__C15_SITES; site++)
      if (is_suspect(t, (laves__site){(int32_t)i, (uint8_t)site})) mask |= UINT32_C(1) << site;
    t->bent[i] = mask;
  }
}

static bool is_bent(const thinning *t, laves__site s) { return t->bent[s.cell] >> s.site & 1; }

/* Sites beside a suspect on the other side of the surface are suspects as well: from beyond a wall or gap that holds few sites,
 * phi may look linear. */
static bool is_beside_suspect(const thinning *t, laves__site s) {
  const laves__record *r = &t->lattice->record[s.cell];
  if (!isfinite(r->phi[s.site])) return false;
  if (t->frame->oracle->is_distance && !(fabs(r->phi[s.site]) < reach * laves__site_scale(t->lattice, s))) return false;
  const laves__ring ring = laves__ring_of(t->lattice, s);
  for (int k = 0; k < ring.count; k++) {
    const laves__site n = laves__ring_at(&ring, k);
    if (n.cell < 0 || t->lattice->record[n.cell].sign[n.site] == r->sign[s.site]) continue;
    if (is_bent(t, n)) return true;
  }
  return false;
}

static void find_company(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const thinning *t = user;
  for (size_t i = begin; i < end; i++) {
    t->suspects[i] = t->bent[i];
    for (int site = 0; site < LAVES__C15_SITES; site++)
      if (is_beside_suspect(t, (laves__site){(int32_t)i, (uint8_t)site})) t->suspects[i] |= UINT32_C(1) << site;
  }
}

/* The end of an edge: its foot when ON, else the site. False when the site has no foot near. */
static bool end_of_edge(const thinning *t, laves__site s, edge_end *end) {
  const laves__foot *foot = laves__feet_get(t->feet, s.cell, s.site);
  if (!foot) return false;
  const laves__vec3 p = laves__site_place(t->lattice, s);
  if (!(v3_distance(p, foot->position) < reach * laves__site_scale(t->lattice, s))) return false;
  *end = (edge_end){.at = laves__site_label(t->lattice, s) == LAVES__LABEL_ON ? foot->position : p,
                    .foot = foot->position,
                    .normal = v3(foot->normal[0], foot->normal[1], foot->normal[2])};
  return true;
}

/* The share of the way from one end to the other after which it is behind the surface at its own foot, taken as a plane;
 * behind is inside for a wall (side -1), outside for a gap (side 1). 0 where it is there from the start. */
static double entry(const edge_end *from, const edge_end *to, int side) {
  const double a = side * v3_dot(v3_sub(from->at, from->foot), from->normal);
  const double b = side * v3_dot(v3_sub(to->at, from->foot), from->normal);
  return b > a ? fmin(fmax(-a / (b - a), 0), 1) : 0;
}

static bool lies_beyond(const thinning *t, laves__vec3 point, double depth, int side) {
  return side < 0 ? laves__lies_inside(t->frame, point, depth) : laves__lies_outside(t->frame, point, depth);
}

/* Whether an edge passes through a wall (side -1) or a gap (1): see the drawing. */
static bool passes_through(const thinning *t, laves__site s, laves__site other, int side) {
  const laves__label free = side < 0 ? LAVES__LABEL_OUT : LAVES__LABEL_IN;
  if (laves__site_label(t->lattice, s) != free && laves__site_label(t->lattice, other) != free) return false;
  edge_end a, b;
  if (!end_of_edge(t, s, &a) || !end_of_edge(t, other, &b)) return false;
  const double cosine = v3_dot(a.normal, b.normal);
  if (cosine > opposed) return false;
  const double scale = 0.5 * (laves__site_scale(t->lattice, s) + laves__site_scale(t->lattice, other));
  if (side < 0 && laves__site_sign(t->lattice, s) == laves__site_sign(t->lattice, other) && is_bent(t, s) && is_bent(t, other))
    for (int i = 0; i < SAMPLES; i++)
      if (laves__lies_inside(t->frame, v3_lerp(a.at, b.at, (i + 1.0) / (SAMPLES + 1)), depth_min * scale)) return true;
  if (cosine > strictly_opposed) return false;
  const double begin = entry(&a, &b, side), end = 1 - entry(&b, &a, side);
  return begin < end && lies_beyond(t, v3_lerp(a.at, b.at, 0.5 * (begin + end)), sheet_depth * scale, side);
}

/* Whether a site goes ON for the sake of a wall or gap that it stands beside. */
static bool shall_turn_on(const thinning *t, laves__site s) {
  const laves__label label = laves__site_label(t->lattice, s);
  if (label == LAVES__LABEL_ON) return false;
  const int side = label == LAVES__LABEL_OUT ? -1 : 1;
  const laves__ring ring = laves__ring_of(t->lattice, s);
  for (int k = 0; k < ring.count; k++) {
    const laves__site n = laves__ring_at(&ring, k);
    if (n.cell >= 0 && t->suspects[n.cell] >> n.site & 1 && passes_through(t, s, n, side)) return true;
  }
  return false;
}

/* Reads labels only; what changes goes to turns_on of the site's own record. Both ends look at the edge, each for itself. */
static void look_at_edges(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const thinning *t = user;
  for (size_t i = begin; i < end; i++) {
    t->turns_on[i] = 0;
    for (uint32_t mask = t->suspects[i]; mask; mask &= mask - 1)
      if (shall_turn_on(t, (laves__site){(int32_t)i, (uint8_t)__builtin_ctz(mask)})) t->turns_on[i] |= mask & -mask;
  }
}

static bool turn_on(const thinning *t) {
  bool any = false;
  for (size_t i = 0; i < t->lattice->record_count; i++)
    for (uint32_t mask = t->turns_on[i]; mask; mask &= mask - 1) {
      laves__record *r = &t->lattice->record[i];
      if (r->label[__builtin_ctz(mask)] == LAVES__LABEL_OUT) r->forced |= mask & -mask;
      r->label[__builtin_ctz(mask)] = LAVES__LABEL_ON;
      any = true;
    }
  return any;
}

laves_result laves__thin_cover(const laves__frame *frame, laves__lattice *lattice, laves__feet *feet, laves_error *error) {
  laves_context *context = lattice->context;
  const size_t records = lattice->record_count;
  laves_result result = LAVES_OK;
  thinning t = {frame,
                lattice,
                feet,
                laves__alloc(context, records, sizeof *t.bent),
                laves__alloc(context, records, sizeof *t.suspects),
                laves__alloc(context, records, sizeof *t.turns_on)};
  if (!t.bent || !t.suspects || !t.turns_on) {
    result = laves__fail_memory(context, error);
    goto cleanup;
  }
  if (!laves__parallel_for(context, "snap", records, 16, find_suspects, &t)) result = laves__fail_cancelled(error);
  if (result == LAVES_OK && !laves__parallel_for(context, "snap", records, 16, find_company, &t))
    result = laves__fail_cancelled(error);
  if (result == LAVES_OK) result = laves__feet_find(frame, lattice, t.suspects, feet, error);
  for (int round = 0; result == LAVES_OK && round < ROUNDS; round++) {
    if (!laves__parallel_for(context, "snap", records, 16, look_at_edges, &t))
      result = laves__fail_cancelled(error);
    else if (!turn_on(&t))
      break;
  }
  if (result == LAVES_OK) result = laves__side_cover(frame, t.suspects, lattice, feet, error);
cleanup:
  laves__free(context, t.turns_on, records, sizeof *t.turns_on);
  laves__free(context, t.suspects, records, sizeof *t.suspects);
  laves__free(context, t.bent, records, sizeof *t.bent);
  return result;
}
