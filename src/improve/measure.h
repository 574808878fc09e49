/* The quality that improvement raises: one number for a tetrahedron, 1 on the border of the asked window.
 *
 *     q = min over the six dihedral angles t of  (1 - cos t) / (1 - cos lo),  (1 + cos t) / (1 + cos hi)
 *     and VL / vt,  VL = sqrt(2) 6V / l_rms^3  the volume-length ratio (1 for the regular tetrahedron)
 *
 * q >= 1 means inside the window. Where a second, wider window is held, tets outside it count as flat, so that no step that
 * makes one is taken. Flat and inverted tets get their volume (at most FLAT, in cubes of the local size), so that untangling
 * is part of the same ascent. Angles that the input fixes, at creases sharper than the window that one tet fills alone, are left
 * out, with the volume-length ratio of their tets: they must not drag their neighbours down. Angles come from the four face
 * normals N_i (outwards, opposite corner i): cos t_ij = -n_i . n_j. */
#ifndef LAVES_IMPROVE_MEASURE_H
#define LAVES_IMPROVE_MEASURE_H

#include "improve/guard.h"
#include "improve/improve.h"

/* Six times the volume, in cubes of the local size, below which a tet counts as flat; a regular one has 0.71. */
#define LAVES__FLAT 1e-4
#define LAVES__SQRT2 1.4142135623730951

typedef struct laves__measure {
  double low_scale;    /* 1 / (1 - cos lo) */
  double high_scale;   /* 1 / (1 + cos hi) */
  double length_scale; /* 1 / vt, or a large number when not asked */
  double held_low;     /* 1 - cos of the least angle that is held, 1 + cos of the largest; -1: none is */
  double held_high;
  const laves__features *sharp; /* creases of which some are sharper than the next; NULL: none */
  double sharper_than;          /* degrees */
  double sharp_cosine;          /* of that, where the boundary is given and has such edges; 0: it has none */
  double weighs_from; /* where the worst is at least this, a step must also lower what all tets that it touches lack of what is
                         asked, taken together; see improve.c */
} laves__measure;

laves__measure laves__measure_of(const laves__window *window);

/* The pairs of faces, in the order of laves__tet_edge. */
static const uint8_t laves__face_pair[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/* The dihedral angle between faces i and j is at the edge between the two other corners. */
static inline bool laves__is_fixed(unsigned fixed, int pair) { return fixed >> (5 - pair) & 1; }

static inline unsigned laves__measure_fixed(const laves__measure *m, const laves__layer *layer, int32_t tet) {
  if (m->sharp_cosine != 0) return laves__given_fixed_edges(m->sharp_cosine, layer, tet);
  return m->sharp ? laves__fixed_edges(m->sharp, m->sharper_than, layer, tet) : 0;
}

static inline void laves__face_normals(const laves__vec3 p[4], laves__vec3 n[4]) {
  const laves__vec3 ab = v3_sub(p[1], p[0]), ac = v3_sub(p[2], p[0]), ad = v3_sub(p[3], p[0]);
  n[1] = v3_cross(ad, ac);
  n[2] = v3_cross(ab, ad);
  n[3] = v3_cross(ac, ab);
  n[0] = v3_scale(v3_add(v3_add(n[1], n[2]), n[3]), -1);
}

static inline double laves__edge_sum(const laves__vec3 p[4]) {
  return v3_norm2(v3_sub(p[1], p[0])) + v3_norm2(v3_sub(p[2], p[0])) + v3_norm2(v3_sub(p[3], p[0])) +
         v3_norm2(v3_sub(p[2], p[1])) + v3_norm2(v3_sub(p[3], p[1])) + v3_norm2(v3_sub(p[3], p[2]));
}

/* `cube`: that of the local size; `fixed`: edges that are left out. */
static inline double laves__quality(const laves__measure *m, const laves__vec3 p[4], double cube, unsigned fixed) {
  laves__vec3 n[4];
  laves__face_normals(p, n);
  const double volume6 = -v3_dot(n[3], v3_sub(p[3], p[0]));
  if (!(volume6 > LAVES__FLAT * cube)) return volume6 / cube;
  double per_length[4];
  for (int i = 0; i < 4; i++) per_length[i] = 1 / sqrt(v3_norm2(n[i]));
  double least = 1, most = -1; /* of n_i . n_j */
  for (int e = 0; e < 6; e++) {
    const int i = laves__face_pair[e][0], j = laves__face_pair[e][1];
    const double d = v3_dot(n[i], n[j]) * per_length[i] * per_length[j];
    if (fixed && laves__is_fixed(fixed, e)) continue;
    if (d < least) least = d;
    if (d > most) most = d;
  }
  if (1 + least < m->held_low || 1 - most < m->held_high) return LAVES__FLAT;
  const double mean = laves__edge_sum(p) / 6;
  double q = (1 + least) * m->low_scale;
  const double high = (1 - most) * m->high_scale, length = LAVES__SQRT2 * volume6 / (mean * sqrt(mean)) * m->length_scale;
  if (high < q) q = high;
  if (length < q && !fixed) q = length;
  return q > LAVES__FLAT ? q : LAVES__FLAT;
}

/* Whether a tet is beyond help: bad, and so deep that none of its vertices is one of those that do the work. No operation may
 * leave one, though the worst be better than before: it would stay. */
#define LAVES__DEEP_FLOOR 0.8
static inline bool laves__is_stranded(const laves__layer *layer, const int32_t tet[4], double quality) {
  if (quality >= LAVES__DEEP_FLOOR) return false;
  for (int k = 0; k < 4; k++)
    if (layer->depth[tet[k]] < LAVES__DEPTH_MOVES) return false;
  return true;
}

static inline double laves__layer_quality(const laves__measure *m, const laves__layer *layer, int32_t tet) {
  laves__vec3 p[4];
  laves__layer_points(layer, tet, p);
  return laves__quality(m, p, laves__layer_cube(layer, tet), laves__measure_fixed(m, layer, tet));
}

/* Whether a step must also lower what all tets that it touches lack. */
static inline bool laves__weighs_all(const laves__measure *m, double worst) { return worst >= m->weighs_from; }

/* What a tet lacks; that it is outside counts by itself, so that one that is far outside is not traded for many that are so by
 * little. */
#define LAVES__OUTSIDE_COST 0.02
static inline double laves__shortfall(double quality) { return quality < 1 ? LAVES__OUTSIDE_COST + 1 - quality : 0; }

/* The same for the tets [begin, end), several at once: quality[t - begin] of those that live. The digits are the same. */
void laves__measure_tets(const laves__measure *m, const laves__layer *layer, size_t begin, size_t end, double *quality);

#endif
