/* The quality of many tetrahedra at once.
 *
 * What laves__quality() does for one tet, step by step and in the same order, so that the digits are the same, in one loop
 * without jumps, which compilers turn into vector code. Tets with edges that are left out, at creases sharper than the window,
 * are few and are measured one by one. See measure.h for the formulas. */
#include "base/wide.h"
#include "improve/measure.h"

enum { LANES = 64 };

typedef struct batch {
  double corner[4][3][LANES];
  double cube[LANES];    /* of the local size */
  double quality[LANES]; /* out */
} batch;

static inline laves__vec3 corner(const batch *b, int i, int lane) {
  return v3(b->corner[i][0][lane], b->corner[i][1][lane], b->corner[i][2][lane]);
}

static inline double lesser(double a, double b) { return a < b ? a : b; }
static inline double greater(double a, double b) { return a > b ? a : b; }

LAVES__WIDE static void measure_batch(const laves__measure *m, batch *restrict b) {
  const double low_scale = m->low_scale, high_scale = m->high_scale, length_scale = m->length_scale;
  const double held_low = m->held_low, held_high = m->held_high;
  for (int i = 0; i < LANES; i++) {
    const laves__vec3 p0 = corner(b, 0, i), p1 = corner(b, 1, i), p2 = corner(b, 2, i), p3 = corner(b, 3, i);
    const laves__vec3 ab = v3_sub(p1, p0), ac = v3_sub(p2, p0), ad = v3_sub(p3, p0);
    const laves__vec3 n1 = v3_cross(ad, ac), n2 = v3_cross(ab, ad), n3 = v3_cross(ac, ab);
    const laves__vec3 n0 = v3_scale(v3_add(v3_add(n1, n2), n3), -1);
    const double volume6 = -v3_dot(n3, ad);
    const double r0 = 1 / sqrt(v3_norm2(n0)), r1 = 1 / sqrt(v3_norm2(n1)), r2 = 1 / sqrt(v3_norm2(n2)),
                 r3 = 1 / sqrt(v3_norm2(n3));
    /* In the order of laves__face_pair. A cosine that is NAN changes neither. */
    const double d01 = v3_dot(n0, n1) * r0 * r1, d02 = v3_dot(n0, n2) * r0 * r2, d03 = v3_dot(n0, n3) * r0 * r3;
    const double d12 = v3_dot(n1, n2) * r1 * r2, d13 = v3_dot(n1, n3) * r1 * r3, d23 = v3_dot(n2, n3) * r2 * r3;
    const double least = lesser(d23, lesser(d13, lesser(d12, lesser(d03, lesser(d02, lesser(d01, 1))))));
    const double most = greater(d23, greater(d13, greater(d12, greater(d03, greater(d02, greater(d01, -1))))));
    const double edges = v3_norm2(ab) + v3_norm2(ac) + v3_norm2(ad) + v3_norm2(v3_sub(p2, p1)) + v3_norm2(v3_sub(p3, p1)) +
                         v3_norm2(v3_sub(p3, p2));
    const double mean = edges / 6;
    const double low = (1 + least) * low_scale, high = (1 - most) * high_scale;
    const double length = LAVES__SQRT2 * volume6 / (mean * sqrt(mean)) * length_scale;
    const double q = lesser(length, lesser(high, low));
    const bool held = !(1 + least < held_low) & !(1 - most < held_high);
    const double standing = (held & (q > LAVES__FLAT)) ? q : LAVES__FLAT;
    b->quality[i] = volume6 > LAVES__FLAT * b->cube[i] ? standing : volume6 / b->cube[i];
  }
}

/* tets[lane]: which tet stands in a lane. */
static void take_out(const laves__measure *m, batch *b, const size_t *tets, int count, size_t first, double *quality) {
  measure_batch(m, b);
  for (int lane = 0; lane < count; lane++) quality[tets[lane] - first] = b->quality[lane];
}

void laves__measure_tets(const laves__measure *m, const laves__layer *layer, size_t begin, size_t end, double *quality) {
  batch b = {.cube = {0}}; /* lanes that stay empty are measured, too */
  size_t tets[LANES];
  int count = 0;
  for (size_t t = begin; t < end; t++) {
    const int32_t tet = (int32_t)t;
    if (layer->tet[t][0] < 0) continue;
    const unsigned fixed = laves__measure_fixed(m, layer, tet);
    laves__vec3 p[4];
    laves__layer_points(layer, tet, p);
    if (fixed) {
      quality[t - begin] = laves__quality(m, p, laves__layer_cube(layer, tet), fixed);
      continue;
    }
    for (int i = 0; i < 4; i++) {
      b.corner[i][0][count] = p[i].x;
      b.corner[i][1][count] = p[i].y;
      b.corner[i][2][count] = p[i].z;
    }
    b.cube[count] = laves__layer_cube(layer, tet);
    tets[count++] = t;
    if (count < LANES) continue;
    take_out(m, &b, tets, count, begin, quality);
    count = 0;
  }
  if (count > 0) take_out(m, &b, tets, count, begin, quality);
}
