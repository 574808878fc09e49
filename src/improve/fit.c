/* Faces are compared with the surface at their centroids and at the middles of their edges. */
#include "improve/fit.h"

#include "improve/guard.h"
#include "mesh/mesh.h"

/* What no face may be. */
static const laves__fit bad_fit = {1, -1};

static void fit_point(const laves__frame *frame, laves__hold hold, laves__vec3 p, laves__vec3 face_normal, uint32_t hint,
                      double scale, laves__fit *f) {
  laves__vec3 foot, normal;
  if (!laves__frame_project_held(frame, hold, p, scale, &hint, &foot, &normal)) {
    *f = bad_fit;
    return;
  }
  f->deviation = fmax(f->deviation, v3_distance(p, foot) / scale);
  f->alignment = fmin(f->alignment, v3_dot(face_normal, normal));
}

/* Whether any of the corners is held to a feature. */
static bool is_held(const laves__layer *layer, const int32_t face[3]) {
  for (int j = 0; j < 3; j++)
    if (laves__layer_hold(layer, face[j]).kind != LAVES__HOLD_SURFACE) return true;
  return false;
}

void laves__fit_face(const laves__frame *frame, const laves__layer *layer, const int32_t face[3], laves__fit *fit) {
  const uint32_t hint = layer->hint[face[0]];
  const double scale = laves__layer_scale(layer, face[0]);
  laves__vec3 p[3];
  for (int j = 0; j < 3; j++) p[j] = layer->position[face[j]];
  const laves__vec3 normal = v3_unit(v3_cross(v3_sub(p[1], p[0]), v3_sub(p[2], p[0])));
  laves__hold hold = {0, LAVES__HOLD_SURFACE};
  if (is_held(layer, face)) hold = (laves__hold){laves__layer_face_patch(frame, layer, face), LAVES__HOLD_PATCH};
  if (hold.id == LAVES__NO_FEATURE) {
    *fit = bad_fit;
    return;
  }
  fit_point(frame, hold, v3_scale(v3_add(v3_add(p[0], p[1]), p[2]), 1.0 / 3), normal, hint, scale, fit);
  for (int v = 0; v < 3; v++) fit_point(frame, hold, v3_lerp(p[v], p[(v + 1) % 3], 0.5), normal, hint, scale, fit);
}

void laves__fit_star(const laves__frame *frame, const laves__layer *layer, int32_t vertex, laves__fit *fit) {
  if (layer->patch) return; /* what may change lies in planes and stays in them */
  const laves__star *star = &layer->star[vertex];
  for (int i = 0; i < star->count; i++) {
    const int32_t t = star->tet[i];
    for (int k = 0; k < 4; k++) {
      if (layer->tet[t][k] == vertex || !laves__layer_is_boundary_face(layer, t, k)) continue;
      int32_t face[3];
      int at = 0;
      while (at < 2 && layer->tet[t][laves__tet_face[k][at]] != vertex) at++;
      for (int v = 0; v < 3; v++) face[v] = layer->tet[t][laves__tet_face[k][(at + v) % 3]];
      laves__fit_face(frame, layer, face, fit);
    }
  }
}
