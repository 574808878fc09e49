/* Tips and ridges: parts of the solid that stick out beyond the last sites inside, between the edges.
 *
 *            foot of b
 *              /|\            b is outside; the feet of three ON sites around it and its own make a tet
 *             / | \           that lies inside the solid and is not flat: the surface bends away there,
 *   b .      /  |  \          and the mesh would end at the three. So b goes ON, and the search goes on
 *        ON ----------- ON     from it.
 *
 * On a surface that is resolved the foot of b lies between the three, the tet is flat, and nothing happens. */
#include "mesh/mesh.h"
#include "snap/snap.h"

enum { ROUNDS = 8, NEIGHBOURS_MIN = 3 };
static const double reach = 0.8;        /* sizes: how far the foot may be from the site */
static const double advance_min = 0.45; /* sizes: how far it must lie from each of the three feet */
static const double height_min = 0.45;  /* sizes: how high it must stand over them */
static const double depth_min = 0.03;   /* sizes: how deep the middle of the tet must lie */

typedef struct tips {
  const laves__frame *frame;
  laves__lattice *lattice;
  laves__feet *feet;
  uint32_t *wanted; /* [record_count] sites to look at */
  uint32_t *fresh;  /* [record_count] sites that went ON in the last round */
  bool first_round;
} tips;

/* Whether an outside site has enough neighbours ON, one of them fresh after the first round. */
static bool is_candidate(const tips *t, laves__site s) {
  const laves__record *r = &t->lattice->record[s.cell];
  if (r->label[s.site] != LAVES__LABEL_OUT || r->sign[s.site] < 0 || laves__is_hull(t->lattice, s)) return false;
  if (t->frame->oracle->is_distance && !(r->phi[s.site] < reach * laves__site_scale(t->lattice, s))) return false;
  int on = 0;
  bool fresh = t->first_round;
  const laves__ring ring = laves__ring_of(t->lattice, s);
  for (int k = 0; k < ring.count; k++) {
    const laves__site n = laves__ring_at(&ring, k);
    if (n.cell < 0 || laves__site_label(t->lattice, n) != LAVES__LABEL_ON) continue;
    on++;
    fresh |= t->fresh[n.cell] >> n.site & 1;
  }
  return on >= NEIGHBOURS_MIN && fresh;
}

static void find_candidates(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const tips *t = user;
  for (size_t i = begin; i < end; i++) {
    t->wanted[i] = 0;
    for (int site = 0; site < LAVES__C15_SITES; site++)
      if (is_candidate(t, (laves__site){(int32_t)i, (uint8_t)site})) t->wanted[i] |= UINT32_C(1) << site;
  }
}

/* The height of a corner over the opposite face. */
static double apex_height(const laves__vec3 p[4], int corner) {
  const uint8_t *f = laves__tet_face[corner];
  return v3_det(p[0], p[1], p[2], p[3]) / v3_norm(v3_cross(v3_sub(p[f[1]], p[f[0]]), v3_sub(p[f[2]], p[f[0]])));
}

/* Whether the tet of a star, with the other three corners ON at their feet, reaches further into the solid. */
static bool tet_reaches(const tips *t, laves__star_tet star, laves__vec3 foot, double scale) {
  if (star.tet.cell < 0) return false;
  laves__site corner[4];
  laves__corners_of(t->lattice, star.tet, corner);
  laves__vec3 p[4];
  for (int k = 0; k < 4; k++) {
    p[k] = foot;
    if (k == star.corner) continue;
    if (corner[k].cell < 0 || laves__site_label(t->lattice, corner[k]) != LAVES__LABEL_ON) return false;
    const laves__foot *other = laves__feet_get(t->feet, corner[k].cell, corner[k].site);
    if (!other || v3_distance(other->position, foot) < advance_min * scale) return false;
    p[k] = other->position;
  }
  if (!laves__solid_shape(p, scale) || apex_height(p, star.corner) < height_min * scale) return false;
  const laves__vec3 middle = v3_scale(v3_add(v3_add(p[0], p[1]), v3_add(p[2], p[3])), 0.25);
  return laves__lies_inside(t->frame, middle, depth_min * scale);
}

/* Keeps of `wanted` only the sites that shall go ON. Reads labels, writes to the record's own place. */
static void look_at_sites(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const tips *t = user;
  for (size_t i = begin; i < end; i++) {
    for (uint32_t mask = t->wanted[i]; mask; mask &= mask - 1) {
      const laves__site s = {(int32_t)i, (uint8_t)__builtin_ctz(mask)};
      const double scale = laves__site_scale(t->lattice, s);
      const laves__foot *foot = laves__feet_get(t->feet, s.cell, s.site);
      bool reaches = false;
      if (foot && v3_distance(foot->position, laves__site_place(t->lattice, s)) < reach * scale)
        for (int k = 0, size = laves__star_size(t->lattice, s); k < size && !reaches; k++)
          reaches = tet_reaches(t, laves__star_at(t->lattice, s, k), foot->position, scale);
      if (!reaches) t->wanted[i] &= ~(mask & -mask);
    }
  }
}

static bool turn_on(const tips *t) {
  bool any = false;
  for (size_t i = 0; i < t->lattice->record_count; i++) {
    t->fresh[i] = t->wanted[i];
    t->lattice->record[i].forced |= t->wanted[i];
    for (uint32_t mask = t->wanted[i]; mask; mask &= mask - 1) {
      t->lattice->record[i].label[__builtin_ctz(mask)] = LAVES__LABEL_ON;
      any = true;
    }
  }
  return any;
}

laves_result laves__tip_cover(const laves__frame *frame, laves__lattice *lattice, laves__feet *feet, laves_error *error) {
  laves_context *context = lattice->context;
  const size_t records = lattice->record_count;
  laves_result result = LAVES_OK;
  tips t = {frame,
            lattice,
            feet,
            laves__alloc(context, records, sizeof *t.wanted),
            laves__alloc_zeroed(context, records, sizeof *t.fresh),
            true};
  if (!t.wanted || !t.fresh) result = laves__fail_memory(context, error);
  for (int round = 0; result == LAVES_OK && round < ROUNDS; round++) {
    if (!laves__parallel_for(context, "snap", records, 16, find_candidates, &t)) result = laves__fail_cancelled(error);
    if (result == LAVES_OK) result = laves__feet_find(frame, lattice, t.wanted, feet, error);
    if (result != LAVES_OK) break;
    if (!laves__parallel_for(context, "snap", records, 16, look_at_sites, &t))
      result = laves__fail_cancelled(error);
    else if (!turn_on(&t))
      break;
    t.first_round = false;
  }
  laves__free(context, t.fresh, records, sizeof *t.fresh);
  laves__free(context, t.wanted, records, sizeof *t.wanted);
  return result;
}
