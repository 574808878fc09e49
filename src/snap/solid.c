/* Tetrahedra with four corners ON the surface.
 *
 * Where the solid is resolved they are flat remainders between the surface and the first inner vertices, and are left away.
 * In a wall about as thick as the size they are the wall. What tells them apart is where their middle lies, once the
 * corners have moved: clearly inside, and of a shape that improvement can work with. */
#include <string.h>

#include "mesh/mesh.h"
#include "mesh/quality.h"
#include "snap/snap.h"

/* Sizes: how deep the middle must lie; less where a corner is ON for the sake of a thin part. */
static const double depth_min = 0.12, thin_depth_min = 0.03;
/* Sizes: how far outside an edge or a face of a tet in a wall may pass; a surface of radius 1.5 rises 0.09 over an edge. */
static const double pierced_min = 0.1;
static const double cosine_limit = 0.9945; /* dihedral angles within 6 and 174 degrees */
static const double volume6_min = 1e-3;    /* six times the volume, in cubes of the size; a regular tet has 0.71 */

typedef struct search {
  const laves__frame *frame;
  laves__lattice *lattice;
  const laves__feet *feet;
} search;

/* The corners of a tet at their feet and the mean of their scales; false unless all four are ON and have a foot. */
static bool all_on(const search *s, laves__tet tet, laves__vec3 p[4], double *scale, bool *forced) {
  laves__site corner[4];
  laves__corners_of(s->lattice, tet, corner);
  for (int k = 0; k < 4; k++)
    if (corner[k].cell < 0 || laves__site_label(s->lattice, corner[k]) != LAVES__LABEL_ON) return false;
  *forced = false;
  *scale = 0;
  for (int k = 0; k < 4; k++) {
    const laves__foot *foot = laves__feet_get(s->feet, corner[k].cell, corner[k].site);
    if (!foot) return false;
    p[k] = foot->position;
    *scale += 0.25 * laves__site_scale(s->lattice, corner[k]);
    *forced |= s->lattice->record[corner[k].cell].forced >> corner[k].site & 1;
  }
  return true;
}

bool laves__solid_shape(const laves__vec3 p[4], double scale) {
  if (!(v3_det(p[0], p[1], p[2], p[3]) > volume6_min * (scale * scale * scale))) return false;
  double cosines[6];
  laves__tet_dihedral_cosines(p, cosines);
  for (int e = 0; e < 6; e++)
    if (!(fabs(cosines[e]) < cosine_limit)) return false;
  return true;
}

/* Which sites that the tets of a cell of the tiling can use are ON; false: none. */
static bool find_on(const laves__lattice *lattice, const laves__record *r, uint32_t on[8]) {
  uint32_t any = 0;
  for (int shift = 0; shift < 8; shift++) {
    const int32_t cell = r->around[13 + (shift & 1) + 3 * (shift >> 1 & 1) + 9 * (shift >> 2)];
    on[shift] = 0;
    for (int site = 0; cell >= 0 && site < LAVES__C15_SITES; site++)
      if (lattice->record[cell].label[site] == LAVES__LABEL_ON) on[shift] |= UINT32_C(1) << site;
    any |= on[shift];
  }
  return any != 0;
}

/* Whether the outside reaches deep into a tet of a wall, though its middle lies inside: a hole narrower than the size passes
 * there, and would be closed. */
static bool is_pierced(const search *s, const laves__vec3 p[4], double scale) {
  enum { STEPS = 4, POINTS = 4 + 6 * (STEPS - 1) };
  laves__vec3 at[POINTS];
  int count = 0;
  for (int k = 0; k < 4; k++) {
    const uint8_t *f = laves__tet_face[k];
    at[count++] = v3_scale(v3_add(v3_add(p[f[0]], p[f[1]]), p[f[2]]), 1.0 / 3);
  }
  for (int e = 0; e < 6; e++)
    for (int i = 1; i < STEPS; i++) at[count++] = v3_lerp(p[laves__tet_edge[e][0]], p[laves__tet_edge[e][1]], (double)i / STEPS);
  return laves__any_lies_outside(s->frame, count, at, pierced_min * scale);
}

static void judge_tet(const search *s, laves__tet tet) {
  laves__vec3 p[4];
  double scale;
  bool forced;
  if (!all_on(s, tet, p, &scale, &forced) || !laves__solid_shape(p, scale)) return;
  laves__toggle_tet(s->lattice, tet, LAVES__TET_ELIGIBLE);
  const laves__vec3 middle = v3_scale(v3_add(v3_add(p[0], p[1]), v3_add(p[2], p[3])), 0.25);
  if (laves__lies_inside(s->frame, middle, (forced ? thin_depth_min : depth_min) * scale) && !(forced && is_pierced(s, p, scale)))
    laves__toggle_tet(s->lattice, tet, LAVES__TET_SOLID);
}

/* A cell of the tiling: four bits rule out most tets. */
static void judge_cell(const search *s, int32_t record) {
  laves__record *r = &s->lattice->record[record];
  uint32_t on[8];
  memset(r->solid, 0, sizeof r->solid);
  memset(r->eligible, 0, sizeof r->eligible);
  if (!find_on(s->lattice, r, on)) return;
  for (int tet = 0; tet < LAVES__C15_TETS; tet++) {
    uint32_t all = 1;
    for (int k = 0; k < 4; k++) all &= on[laves__c15_tet[tet][k].shift] >> laves__c15_tet[tet][k].site;
    if (all) judge_tet(s, (laves__tet){record, (uint8_t)tet});
  }
}

static void judge_chunks(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const search *s = user;
  for (size_t chunk = begin; chunk < end; chunk++) {
    const int size = laves__chunk_size(s->lattice, chunk);
    if (s->lattice->graph) {
      memset(s->lattice->graph->flags + chunk * LAVES__C15_TETS, 0, (size_t)size);
      for (int tet = 0; tet < size; tet++) judge_tet(s, (laves__tet){(int32_t)chunk, (uint8_t)tet});
    } else {
      judge_cell(s, (int32_t)chunk);
    }
  }
}

laves_result laves__find_solid(const laves__frame *frame, laves__lattice *lattice, const laves__feet *feet, laves_error *error) {
  search s = {frame, lattice, feet};
  if (!laves__parallel_for(lattice->context, "snap", laves__chunk_count(lattice), 16, judge_chunks, &s))
    return laves__fail_cancelled(error);
  return LAVES_OK;
}
