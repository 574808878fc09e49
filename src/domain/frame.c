/* Coordinates between the lattice and the domain. */
#include "domain/frame.h"

/* Points that are turned at once; more where the oracle likes more. */
enum { CHUNK = 64, CHUNK_MAX = 512 };

static size_t chunk_of(const laves__oracle *oracle) {
  const size_t wanted = oracle->batch < CHUNK_MAX ? oracle->batch : CHUNK_MAX;
  return wanted > CHUNK ? wanted : CHUNK;
}

laves__vec3 laves__frame_to_local(const laves__frame *frame, laves__vec3 lattice) {
  return v3_mad(frame->centre, m3_mul(&frame->rotation, lattice), frame->size);
}

laves__vec3 laves__frame_from_local(const laves__frame *frame, laves__vec3 local) {
  return m3_mul_transposed(&frame->rotation, v3_scale(v3_sub(local, frame->centre), 1 / frame->size));
}

laves__vec3 laves__frame_to_input(const laves__frame *frame, laves__vec3 lattice) {
  return v3_add(frame->oracle->origin, laves__frame_to_local(frame, lattice));
}

laves__box3 laves__frame_bounds(const laves__frame *frame) {
  const laves__box3 b = frame->oracle->bounds;
  laves__box3 bounds = box3_empty();
  for (int corner = 0; corner < 8; corner++) {
    const laves__vec3 local =
        v3(corner & 1 ? b.upper.x : b.lower.x, corner & 2 ? b.upper.y : b.lower.y, corner & 4 ? b.upper.z : b.lower.z);
    bounds = box3_add(bounds, laves__frame_from_local(frame, local));
  }
  return bounds;
}

void laves__frame_evaluate(const laves__frame *frame, size_t count, const laves__vec3 *points, double *phi, uint32_t *hints) {
  laves__vec3 local[CHUNK_MAX];
  const size_t chunk = chunk_of(frame->oracle);
  const double per_size = 1 / frame->size;
  for (size_t begin = 0; begin < count; begin += chunk) {
    const size_t n = count - begin < chunk ? count - begin : chunk;
    for (size_t i = 0; i < n; i++) local[i] = laves__frame_to_local(frame, points[begin + i]);
    if (hints && begin > 0) hints[begin] = hints[begin - 1];
    frame->oracle->evaluate(frame->oracle->self, n, local, phi + begin, hints ? hints + begin : NULL);
    for (size_t i = 0; i < n; i++) phi[begin + i] *= per_size;
  }
}

bool laves__frame_project(const laves__frame *frame, laves__vec3 point, double reach, uint32_t *hint, laves__vec3 *foot,
                          laves__vec3 *normal) {
  const laves__oracle *oracle = frame->oracle;
  laves__vec3 local_foot, local_normal;
  if (!oracle->project(oracle->self, laves__frame_to_local(frame, point), reach * frame->size, hint, &local_foot, &local_normal))
    return false;
  *foot = laves__frame_from_local(frame, local_foot);
  *normal = m3_mul_transposed(&frame->rotation, local_normal);
  return v3_finite(*foot) && v3_finite(*normal);
}

void laves__frame_project_many(const laves__frame *frame, size_t count, const laves__vec3 *points, double reach,
                               laves__projection *answers) {
  laves__vec3 local[CHUNK_MAX];
  const size_t chunk = chunk_of(frame->oracle);
  for (size_t begin = 0; begin < count; begin += chunk) {
    const size_t n = count - begin < chunk ? count - begin : chunk;
    for (size_t i = 0; i < n; i++) local[i] = laves__frame_to_local(frame, points[begin + i]);
    laves__project_many(frame->oracle, n, local, reach * frame->size, answers + begin);
    for (laves__projection *a = answers + begin; a < answers + begin + n; a++) {
      if (!a->found) continue;
      a->foot = laves__frame_from_local(frame, a->foot);
      a->normal = m3_mul_transposed(&frame->rotation, a->normal);
      a->found = v3_finite(a->foot) && v3_finite(a->normal);
    }
  }
}

/* Half the extent, along one local axis, of a turned cube. */
static double turned_half(laves__vec3 row, double half) { return half * (fabs(row.x) + fabs(row.y) + fabs(row.z)); }

laves__side laves__frame_side(const laves__frame *frame, laves__vec3 centre, double half) {
  static const double sqrt3 = 1.7320508075688774;
  const double rounding = 1 + 1e-12; /* covers the rounding of the transform itself */
  const double h = half * frame->size * rounding;
  const laves__vec3 *row = frame->rotation.row;
  const laves__vec3 extent = v3(turned_half(row[0], h), turned_half(row[1], h), turned_half(row[2], h));
  return frame->oracle->side(frame->oracle->self, laves__frame_to_local(frame, centre), h * sqrt3, extent);
}
