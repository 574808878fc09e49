/* The exact orientation of four points.
 *
 * The determinant det[b-a, c-a, d-a] is first computed in double precision together with a bound of its rounding error.
 * Only when its absolute value is below the bound is it computed again, without any error, as an expansion: a sum of
 * doubles that do not overlap, in order of growing magnitude, whose last term therefore carries the sign. Differences of
 * coordinates are expansions of at most two terms; sums and products of expansions are expansions again.
 *
 * Everything relies on round-to-even doubles without contraction; fma() is used where one rounding is meant.
 *
 * Source: J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997:
 * sections 2.2 to 2.5 for the arithmetic, section 4.3 for the bound.  [shewchuk1997] */
#include "base/predicates.h"

#include <stddef.h>

/* Half a unit in the last place of 1. */
#define EPSILON 0x1p-53
/* The computed determinant is off by at most this times its permanent: [shewchuk1997], sec. 4.3, eq. for Orient3d, A. */
#define FILTER_BOUND ((7 + 56 * EPSILON) * EPSILON)

enum {
  DIFFERENCE_TERMS = 2,
  PRODUCT_TERMS = 2 * DIFFERENCE_TERMS * DIFFERENCE_TERMS,
  MINOR_TERMS = 2 * PRODUCT_TERMS,
  TRIPLE_TERMS = 2 * DIFFERENCE_TERMS * MINOR_TERMS,
  DETERMINANT_TERMS = 3 * TRIPLE_TERMS,
};

/* terms[0 .. count-1], smallest first, none zero; count 0 is the number zero. */
typedef struct expansion {
  size_t count;
  double *terms;
} expansion;

/* a + b = sum + error, exactly. */
static double two_sum(double a, double b, double *error) {
  const double sum = a + b;
  const double b_virtual = sum - a;
  *error = (a - (sum - b_virtual)) + (b - b_virtual);
  return sum;
}

static void append(expansion *e, double term) {
  if (term != 0) e->terms[e->count++] = term;
}

/* e += value, in place: [shewchuk1997], Grow-Expansion. Writing trails reading, because zeros are dropped. */
static void grow(expansion *e, double value) {
  const size_t count = e->count;
  e->count = 0;
  for (size_t i = 0; i < count; i++) {
    double error;
    value = two_sum(value, e->terms[i], &error);
    append(e, error);
  }
  append(e, value);
}

static void difference(double a, double b, expansion *out) {
  double error;
  const double value = two_sum(a, -b, &error);
  out->count = 0;
  append(out, error);
  append(out, value);
}

/* out += sign * e * f. Each product of two terms is two terms exactly; `out` must have room for all of them. */
static void add_product(const expansion *e, const expansion *f, double sign, expansion *out) {
  for (size_t i = 0; i < e->count; i++)
    for (size_t j = 0; j < f->count; j++) {
      const double product = e->terms[i] * f->terms[j];
      const double error = fma(e->terms[i], f->terms[j], -product);
      if (error != 0) grow(out, sign * error);
      if (product != 0) grow(out, sign * product);
    }
}

/* The rows of the matrix as expansions: u = b - a, v = c - a, w = d - a, by coordinate. */
typedef struct rows {
  double storage[3][3][DIFFERENCE_TERMS];
  expansion at[3][3];
} rows;

static void rows_set(rows *r, laves__vec3 a, laves__vec3 b, laves__vec3 c, laves__vec3 d) {
  const laves__vec3 points[3] = {b, c, d};
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 3; k++) r->at[i][k].terms = r->storage[i][k];
    difference(points[i].x, a.x, &r->at[i][0]);
    difference(points[i].y, a.y, &r->at[i][1]);
    difference(points[i].z, a.z, &r->at[i][2]);
  }
}

static int exact_sign(laves__vec3 a, laves__vec3 b, laves__vec3 c, laves__vec3 d) {
  rows r;
  rows_set(&r, a, b, c, d);
  double determinant_terms[DETERMINANT_TERMS];
  expansion determinant = {0, determinant_terms};
  for (int k = 0; k < 3; k++) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    double minor_terms[MINOR_TERMS];
    expansion minor = {0, minor_terms};
    add_product(&r.at[1][l], &r.at[2][m], 1, &minor);
    add_product(&r.at[1][m], &r.at[2][l], -1, &minor);
    add_product(&r.at[0][k], &minor, 1, &determinant);
  }
  if (determinant.count == 0) return 0;
  return determinant.terms[determinant.count - 1] > 0 ? 1 : -1;
}

laves__plane laves__plane_of(laves__vec3 a, laves__vec3 b, laves__vec3 c) {
  const laves__vec3 u = v3_sub(b, a), v = v3_sub(c, a);
  const double yz = u.y * v.z, zy = u.z * v.y, zx = u.z * v.x, xz = u.x * v.z, xy = u.x * v.y, yx = u.y * v.x;
  return (laves__plane){a, b, c, v3(yz - zy, zx - xz, xy - yx),
                        v3(fabs(yz) + fabs(zy), fabs(zx) + fabs(xz), fabs(xy) + fabs(yx))};
}

/* The determinant expanded by its last row in the place of its first: the same steps, so the same bound. */
int laves__plane_side(const laves__plane *p, laves__vec3 d) {
  const laves__vec3 w = v3_sub(d, p->a);
  const double determinant = w.x * p->normal.x + w.y * p->normal.y + w.z * p->normal.z;
  const double bound = FILTER_BOUND * (fabs(w.x) * p->permanent.x + fabs(w.y) * p->permanent.y + fabs(w.z) * p->permanent.z);
  if (determinant > bound) return 1;
  if (-determinant > bound) return -1;
  return exact_sign(p->a, p->b, p->c, d);
}

int laves__orient3d(laves__vec3 a, laves__vec3 b, laves__vec3 c, laves__vec3 d) {
  const laves__vec3 u = v3_sub(b, a), v = v3_sub(c, a), w = v3_sub(d, a);
  const double yz = v.y * w.z, zy = v.z * w.y;
  const double zx = v.z * w.x, xz = v.x * w.z;
  const double xy = v.x * w.y, yx = v.y * w.x;
  const double determinant = u.x * (yz - zy) + u.y * (zx - xz) + u.z * (xy - yx);
  const double permanent =
      fabs(u.x) * (fabs(yz) + fabs(zy)) + fabs(u.y) * (fabs(zx) + fabs(xz)) + fabs(u.z) * (fabs(xy) + fabs(yx));
  const double bound = FILTER_BOUND * permanent;
  if (determinant > bound) return 1;
  if (-determinant > bound) return -1;
  return exact_sign(a, b, c, d);
}
