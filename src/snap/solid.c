/* Tetrahedra with four corners ON the surface.
 *
 * Where the solid is resolved they are flat remainders between the surface and the first inner vertices, and are left away.
 * In a wall about as thick as the size they are the wall. What tells them apart is where their middle lies, once the
 * corners have moved: clearly inside, and of a shape that improvement can work with. */
#include <string.h>

#include "mesh/quality.h"
#include "snap/snap.h"

/* Sizes: how deep the middle must lie; less where a corner is ON for the sake of a thin part. */
static const double depth_min = 0.12, thin_depth_min = 0.03;
static const double cosine_limit = 0.9945; /* dihedral angles within 6 and 174 degrees */
static const double volume6_min = 1e-3;    /* six times the volume, in cubes of the size; a regular tet has 0.71 */

typedef struct search {
  const laves__frame *frame;
  laves__lattice *lattice;
  const laves__feet *feet;
} search;

/* The corners of a tet at their feet; false unless all four are ON and have one. */
static bool all_on(const search *s, const laves__record *r, int tet, laves__vec3 p[4], bool *forced) {
  laves__site corner[4];
  laves__tet_sites(r, tet, corner);
  for (int k = 0; k < 4; k++)
    if (corner[k].cell < 0 || laves__site_label(s->lattice, corner[k]) != LAVES__LABEL_ON) return false;
  *forced = false;
  for (int k = 0; k < 4; k++) {
    const laves__foot *foot = laves__feet_get(s->feet, corner[k].cell, corner[k].site);
    if (!foot) return false;
    p[k] = foot->position;
    *forced |= s->lattice->record[corner[k].cell].forced >> corner[k].site & 1;
  }
  return true;
}

bool laves__solid_shape(const laves__vec3 p[4]) {
  if (!(v3_det(p[0], p[1], p[2], p[3]) > volume6_min)) return false;
  double cosines[6];
  laves__tet_dihedral_cosines(p, cosines);
  for (int e = 0; e < 6; e++)
    if (!(fabs(cosines[e]) < cosine_limit)) return false;
  return true;
}

static void judge_records(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const search *s = user;
  for (size_t i = begin; i < end; i++) {
    laves__record *r = &s->lattice->record[i];
    memset(r->solid, 0, sizeof r->solid);
    memset(r->eligible, 0, sizeof r->eligible);
    bool any_on = false;
    for (int shift = 0; shift < 8 && !any_on; shift++) {
      const int32_t cell = r->around[13 + (shift & 1) + 3 * (shift >> 1 & 1) + 9 * (shift >> 2)];
      for (int site = 0; cell >= 0 && site < LAVES__C15_SITES && !any_on; site++)
        any_on = s->lattice->record[cell].label[site] == LAVES__LABEL_ON;
    }
    for (int tet = 0; any_on && tet < LAVES__C15_TETS; tet++) {
      laves__vec3 p[4];
      bool forced;
      if (!all_on(s, r, tet, p, &forced) || !laves__solid_shape(p)) continue;
      laves__flip_bit(r->eligible, tet);
      const laves__vec3 middle = v3_scale(v3_add(v3_add(p[0], p[1]), v3_add(p[2], p[3])), 0.25);
      if (laves__lies_inside(s->frame, middle, forced ? thin_depth_min : depth_min)) laves__flip_bit(r->solid, tet);
    }
  }
}

laves_result laves__find_solid(const laves__frame *frame, laves__lattice *lattice, const laves__feet *feet, laves_error *error) {
  search s = {frame, lattice, feet};
  if (!laves__parallel_for(lattice->context, "snap", lattice->record_count, 16, judge_records, &s))
    return laves__fail_cancelled(error);
  return LAVES_OK;
}
