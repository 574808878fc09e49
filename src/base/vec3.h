/* Points and vectors in space; all functions are pure. double[3] and laves__vec3 have the same layout. */
#ifndef LAVES_BASE_VEC3_H
#define LAVES_BASE_VEC3_H

#include <math.h>
#include <stdbool.h>

typedef struct laves__vec3 {
  double x, y, z;
} laves__vec3;

typedef struct laves__box3 {
  laves__vec3 lower, upper;
} laves__box3;

/* Row-major: rows are the images of the axes' coordinates, so (m v).x = m.row[0] . v. */
typedef struct laves__mat3 {
  laves__vec3 row[3];
} laves__mat3;

static inline laves__vec3 v3(double x, double y, double z) { return (laves__vec3){x, y, z}; }
/* Coordinate i, 0 to 2: to read, and to write. An index from the address of x would be undefined, and compilers use that. */
static inline double v3_at(laves__vec3 a, int i) { return i == 0 ? a.x : i == 1 ? a.y : a.z; }
static inline double *v3_slot(laves__vec3 *a, int i) { return i == 0 ? &a->x : i == 1 ? &a->y : &a->z; }
static inline laves__vec3 v3_add(laves__vec3 a, laves__vec3 b) { return v3(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline laves__vec3 v3_sub(laves__vec3 a, laves__vec3 b) { return v3(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline laves__vec3 v3_scale(laves__vec3 a, double s) { return v3(a.x * s, a.y * s, a.z * s); }
/* a + s b */
static inline laves__vec3 v3_mad(laves__vec3 a, laves__vec3 b, double s) {
  return v3(a.x + b.x * s, a.y + b.y * s, a.z + b.z * s);
}
static inline laves__vec3 v3_lerp(laves__vec3 a, laves__vec3 b, double t) { return v3_mad(a, v3_sub(b, a), t); }
static inline laves__vec3 v3_min(laves__vec3 a, laves__vec3 b) {
  return v3(a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z);
}
static inline laves__vec3 v3_max(laves__vec3 a, laves__vec3 b) {
  return v3(a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z);
}
static inline double v3_dot(laves__vec3 a, laves__vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline laves__vec3 v3_cross(laves__vec3 a, laves__vec3 b) {
  return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double v3_norm2(laves__vec3 a) { return v3_dot(a, a); }
static inline double v3_norm(laves__vec3 a) { return sqrt(v3_dot(a, a)); }
static inline double v3_distance(laves__vec3 a, laves__vec3 b) { return v3_norm(v3_sub(a, b)); }
/* The zero vector stays zero. */
static inline laves__vec3 v3_unit(laves__vec3 a) {
  const double n = v3_norm(a);
  return n > 0 ? v3_scale(a, 1 / n) : a;
}
static inline bool v3_finite(laves__vec3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }
/* Six times the signed volume: det[b-a, c-a, d-a]. */
static inline double v3_det(laves__vec3 a, laves__vec3 b, laves__vec3 c, laves__vec3 d) {
  return v3_dot(v3_sub(b, a), v3_cross(v3_sub(c, a), v3_sub(d, a)));
}
static inline laves__vec3 m3_mul(const laves__mat3 *m, laves__vec3 v) {
  return v3(v3_dot(m->row[0], v), v3_dot(m->row[1], v), v3_dot(m->row[2], v));
}
/* The transposed matrix times v: the inverse rotation. */
static inline laves__vec3 m3_mul_transposed(const laves__mat3 *m, laves__vec3 v) {
  return v3_add(v3_scale(m->row[0], v.x), v3_add(v3_scale(m->row[1], v.y), v3_scale(m->row[2], v.z)));
}
static inline laves__box3 box3_empty(void) {
  return (laves__box3){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}
static inline laves__box3 box3_add(laves__box3 b, laves__vec3 p) { return (laves__box3){v3_min(b.lower, p), v3_max(b.upper, p)}; }
static inline laves__vec3 box3_centre(laves__box3 b) { return v3_scale(v3_add(b.lower, b.upper), 0.5); }
static inline double box3_diagonal(laves__box3 b) { return v3_distance(b.lower, b.upper); }

#endif
