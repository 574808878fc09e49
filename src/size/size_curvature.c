/* How strongly the surface bends.
 *
 * Triangles: the curvature tensor of a point is the sum over the edges there of 1/2 * angle * length * e e^T over a third of the
 * area of its faces [cohensteiner2003], so that the flat facets of a cylinder tell its radius; the largest absolute eigenvalue is
 * the curvature. Creases do not count, and part the faces of a point in sectors of their own, so that a cap does not dilute
 * the cylinder below it. A face has the mean tensor of its three corners, which evens out how the diagonals of facets fall.
 *
 * Other surfaces: differences of normals over a piece of the surface, about 0.6 of its width apart each way. Where the normal
 * jumps by more than 40 degrees, or bends more when looked at more closely, the piece is too large to tell a tight bend from a
 * crease. */
#include <string.h>

#include "base/jacobi.h"
#include "size/size_parts.h"

/* How far from the middle of a piece normals are taken, in parts of its width: about 0.3 of the size that belongs to it. */
static const double normal_offset = 0.43;
/* How much more a surface may bend when seen at half the distance, in parts and in radians over that distance. */
static const double alike = 1.5, flat_angle = 0.02;

/* xx yy zz xy yz zx */
typedef struct tensor {
  double t[6];
} tensor;

static void add_outer(tensor *to, laves__vec3 e, double weight) {
  const double products[6] = {e.x * e.x, e.y * e.y, e.z * e.z, e.x * e.y, e.y * e.z, e.z * e.x};
  for (int i = 0; i < 6; i++) to->t[i] += weight * products[i];
}

static double largest_eigenvalue(const tensor *t) {
  enum { SWEEPS = 8 };
  const double *v = t->t;
  double m[3][3] = {{v[0], v[3], v[5]}, {v[3], v[1], v[4]}, {v[5], v[4], v[2]}};
  for (int i = 0; i < SWEEPS; i++) {
    double cosine, sine;
    laves__jacobi_rotate(m, 0, 1, &cosine, &sine);
    laves__jacobi_rotate(m, 1, 2, &cosine, &sine);
    laves__jacobi_rotate(m, 0, 2, &cosine, &sine);
  }
  return fmax(fabs(m[0][0]), fmax(fabs(m[1][1]), fabs(m[2][2])));
}

/* ---- triangles ---- */

typedef struct corners {
  const laves__surface *s;
  uint32_t *sector; /* [3 faces] corners of one point that are joined without a crease lead to one of them */
  tensor *tensors;  /* [3 faces] of sectors */
  double *areas;
} corners;

static uint32_t next_corner(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
static uint32_t point_of(const laves__surface *s, uint32_t corner) { return s->faces[corner / 3][corner % 3]; }

static uint32_t find_sector(uint32_t *sector, uint32_t c) {
  while (sector[c] != c) {
    sector[c] = sector[sector[c]];
    c = sector[c];
  }
  return c;
}

static void join_sectors(uint32_t *sector, uint32_t a, uint32_t b) {
  a = find_sector(sector, a);
  b = find_sector(sector, b);
  sector[a > b ? a : b] = a > b ? b : a;
}

/* Whether the surface goes on smoothly across the edge that starts at corner h, with its faces alike in direction. */
static bool is_smooth(const laves__surface *s, uint32_t h) {
  const uint32_t g = s->across[h];
  if (g == LAVES__NONE || point_of(s, h) == point_of(s, g)) return false;
  return v3_dot(laves__face_normal(s, h / 3), laves__face_normal(s, g / 3)) >= LAVES__CREASE_COSINE;
}

static void find_sectors(corners *c) {
  const uint32_t half_count = (uint32_t)(3 * c->s->face_count);
  for (uint32_t h = 0; h < half_count; h++) c->sector[h] = h;
  for (uint32_t h = 0; h < half_count; h++) {
    const uint32_t g = c->s->across[h];
    if (!is_smooth(c->s, h) || g < h) continue;
    join_sectors(c->sector, h, next_corner(g));
    join_sectors(c->sector, next_corner(h), g);
  }
}

/* The angle between the faces beside an edge, with its sign: positive where convex. */
static double edge_angle(const laves__surface *s, uint32_t h, laves__vec3 along) {
  const laves__vec3 m = laves__face_normal(s, h / 3), n = laves__face_normal(s, s->across[h] / 3);
  return laves__angle(v3_dot(v3_cross(m, n), along), v3_dot(m, n));
}

static void sum_tensors(corners *c) {
  const laves__surface *s = c->s;
  for (uint32_t f = 0; f < s->face_count; f++) {
    const laves__triangle *t = &s->bvh.triangles[f];
    const double area = 0.5 * v3_norm(v3_cross(v3_sub(t->b, t->a), v3_sub(t->c, t->a)));
    for (uint32_t i = 0; i < 3; i++) {
      const uint32_t h = 3 * f + i;
      c->areas[find_sector(c->sector, h)] += area / 3;
      if (!is_smooth(s, h) || s->across[h] < h) continue;
      const laves__vec3 edge = v3_sub(s->points[point_of(s, next_corner(h))], s->points[point_of(s, h)]);
      const double length = v3_norm(edge);
      const laves__vec3 along = v3_unit(edge);
      const double weight = 0.5 * edge_angle(s, h, along) * length;
      add_outer(&c->tensors[find_sector(c->sector, h)], along, weight);
      add_outer(&c->tensors[find_sector(c->sector, next_corner(h))], along, weight);
    }
  }
}

static void fill_faces(corners *c, double *of_face) {
  for (uint32_t f = 0; f < c->s->face_count; f++) {
    tensor mean = {{0}};
    for (uint32_t i = 0; i < 3; i++) {
      const uint32_t sector = find_sector(c->sector, 3 * f + i);
      for (int k = 0; k < 6 && c->areas[sector] > 0; k++) mean.t[k] += c->tensors[sector].t[k] / (3 * c->areas[sector]);
    }
    of_face[f] = largest_eigenvalue(&mean);
  }
}

laves_result laves__curvature_build(const laves__size *size, laves__curvature *curvature, laves_error *error) {
  const laves__surface *s = size->oracle->surface;
  *curvature = (laves__curvature){.size = size};
  if (!s) return LAVES_OK;
  laves_context *context = size->context;
  const size_t half_count = 3 * s->face_count;
  laves_result result = LAVES_OK;
  corners c = {.s = s};
  c.sector = laves__alloc(context, half_count, sizeof *c.sector);
  c.tensors = laves__alloc_zeroed(context, half_count, sizeof *c.tensors);
  c.areas = laves__alloc_zeroed(context, half_count, sizeof *c.areas);
  curvature->of_face = laves__alloc(context, s->face_count, sizeof *curvature->of_face);
  if (curvature->of_face) curvature->face_count = s->face_count;
  if (c.sector && c.tensors && c.areas && curvature->of_face) {
    find_sectors(&c);
    sum_tensors(&c);
    fill_faces(&c, curvature->of_face);
  } else {
    result = laves__fail_memory(context, error);
  }
  laves__free(context, c.sector, half_count, sizeof *c.sector);
  laves__free(context, c.tensors, half_count, sizeof *c.tensors);
  laves__free(context, c.areas, half_count, sizeof *c.areas);
  return result;
}

void laves__curvature_free(laves__curvature *c) {
  if (!c->size) return;
  laves__free(c->size->context, c->of_face, c->face_count, sizeof *c->of_face);
  *c = (laves__curvature){0};
}

/* ---- other surfaces ---- */

/* How the normal turns between two feet, per length; false where it jumps. */
static bool normal_slope(const laves__projection *from, const laves__projection *to, laves__vec3 *slope) {
  const double length = v3_distance(from->foot, to->foot);
  if (!(length > 0) || v3_dot(from->normal, to->normal) < LAVES__CREASE_COSINE) return false;
  *slope = v3_scale(v3_sub(to->normal, from->normal), 1 / length);
  return true;
}

/* The larger of the absolute eigenvalues of the symmetric part of the matrix (a b; c d). */
static double largest_of_two(double a, double b, double c, double d) {
  const double mean = 0.5 * (a + d), difference = 0.5 * (a - d), off = 0.5 * (b + c);
  return fabs(mean) + sqrt(difference * difference + off * off);
}

/* Whether the normal turns smoothly over a stretch: as much per length over its inner half as over the whole. */
static bool bends_smoothly(const laves__projection wide[2], const laves__projection narrow[2], double slack, laves__vec3 *slope) {
  laves__vec3 whole;
  if (!normal_slope(&wide[0], &wide[1], &whole) || !normal_slope(&narrow[0], &narrow[1], slope)) return false;
  return v3_norm(*slope) <= alike * v3_norm(whole) + slack;
}

/* Seen at half the distance a smooth surface bends as before, and a crease, however blunt, twice as much. */
static double curvature_by_normals(const laves__oracle *oracle, const laves__patch *p, bool *unresolved) {
  const laves__vec3 axis = fabs(p->normal.x) < 0.6 ? v3(1, 0, 0) : fabs(p->normal.y) < 0.6 ? v3(0, 1, 0) : v3(0, 0, 1);
  const laves__vec3 u = v3_unit(v3_cross(p->normal, axis)), v = v3_cross(p->normal, u);
  const double offset = normal_offset * p->width;
  laves__vec3 points[8];
  laves__projection feet[8];
  for (int i = 0; i < 8; i++) {
    const double share = (i & 1 ? 1 : -1) * (i & 4 ? 0.5 : 1);
    points[i] = v3_mad(p->point, i & 2 ? v : u, share * offset);
    feet[i].hint = LAVES__NO_HINT;
  }
  laves__project_many(oracle, 8, points, 2 * p->width, feet);
  for (int i = 0; i < 8; i++) *unresolved |= !feet[i].found || v3_dot(feet[i].normal, p->normal) < LAVES__CREASE_COSINE;
  if (*unresolved) return 0;
  laves__vec3 along_u, along_v;
  const double slack = flat_angle / offset;
  *unresolved = !bends_smoothly(feet, feet + 4, slack, &along_u) || !bends_smoothly(feet + 2, feet + 6, slack, &along_v);
  if (*unresolved) return 0;
  return largest_of_two(v3_dot(along_u, u), v3_dot(along_u, v), v3_dot(along_v, u), v3_dot(along_v, v));
}

double laves__curvature_at(const laves__curvature *curvature, const laves__patch *patch, bool *unresolved) {
  *unresolved = false;
  if (patch->face != LAVES__NONE) return curvature->of_face[patch->face];
  return curvature_by_normals(curvature->size->oracle, patch, unresolved);
}
