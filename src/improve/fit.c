/* Faces are compared with the surface at their centroids and at the middles of their edges. */
#include "improve/fit.h"

#include "mesh/mesh.h"

static void fit_point(const laves__frame *frame, laves__vec3 p, laves__vec3 face_normal, uint32_t hint, double scale,
                      laves__fit *f) {
  laves__vec3 foot, normal;
  if (!laves__frame_project(frame, p, scale, &hint, &foot, &normal)) {
    *f = (laves__fit){1, -1};
    return;
  }
  f->deviation = fmax(f->deviation, v3_distance(p, foot) / scale);
  f->alignment = fmin(f->alignment, v3_dot(face_normal, normal));
}

void laves__fit_face(const laves__frame *frame, const laves__vec3 p[3], uint32_t hint, double scale, laves__fit *fit) {
  const laves__vec3 normal = v3_unit(v3_cross(v3_sub(p[1], p[0]), v3_sub(p[2], p[0])));
  fit_point(frame, v3_scale(v3_add(v3_add(p[0], p[1]), p[2]), 1.0 / 3), normal, hint, scale, fit);
  for (int v = 0; v < 3; v++) fit_point(frame, v3_lerp(p[v], p[(v + 1) % 3], 0.5), normal, hint, scale, fit);
}

void laves__fit_star(const laves__frame *frame, const laves__layer *layer, int32_t vertex, laves__fit *fit) {
  const laves__star *star = &layer->star[vertex];
  for (int i = 0; i < star->count; i++) {
    const int32_t t = star->tet[i];
    for (int k = 0; k < 4; k++) {
      if (layer->tet[t][k] == vertex || !laves__layer_is_boundary_face(layer, t, k)) continue;
      laves__vec3 p[3];
      for (int v = 0; v < 3; v++) p[v] = layer->position[layer->tet[t][laves__tet_face[k][v]]];
      laves__fit_face(frame, p, layer->hint[vertex], laves__layer_scale(layer, vertex), fit);
    }
  }
}
