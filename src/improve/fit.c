/* Faces are compared with the surface at their centroids and at the middles of their edges. */
#include "improve/fit.h"

#include "improve/guard.h"
#include "mesh/mesh.h"

/* What no face may be. */
static const laves__fit bad_fit = {1, -1};

/* Where the surface is next to a place. */
static laves__projection find_foot(const laves__frame *frame, laves__hold hold, laves__vec3 p, uint32_t hint, double scale) {
  laves__projection answer = {.hint = hint};
  answer.found = laves__frame_project_held(frame, hold, p, scale, &answer.hint, &answer.foot, &answer.normal);
  return answer;
}

static void compare(const laves__projection *surface, laves__vec3 p, laves__vec3 face_normal, double scale, laves__fit *f) {
  if (!surface->found) {
    *f = bad_fit;
    return;
  }
  f->deviation = fmax(f->deviation, v3_distance(p, surface->foot) / scale);
  f->alignment = fmin(f->alignment, v3_dot(face_normal, surface->normal));
}

/* Whether any of the corners is held to a feature. */
static bool is_held(const laves__layer *layer, const int32_t face[3]) {
  for (int j = 0; j < 3; j++)
    if (laves__layer_hold(layer, face[j]).kind != LAVES__HOLD_SURFACE) return true;
  return false;
}

/* Feet of the middles of a vertex's edges: two faces share each, and feet may be dear. */
enum { SPOKES_MAX = 32 };
typedef struct spokes {
  int count;
  int32_t end[SPOKES_MAX];
  laves__hold hold[SPOKES_MAX];
  laves__projection foot[SPOKES_MAX];
} spokes;

static laves__projection spoke_foot(const laves__frame *frame, const laves__layer *layer, laves__hold hold, int32_t vertex,
                                    int32_t end, laves__vec3 middle, spokes *s) {
  for (int i = 0; i < s->count; i++)
    if (s->end[i] == end && s->hold[i].kind == hold.kind && s->hold[i].id == hold.id) return s->foot[i];
  const laves__projection foot = find_foot(frame, hold, middle, layer->hint[vertex], laves__layer_scale(layer, vertex));
  if (s->count < SPOKES_MAX) {
    s->end[s->count] = end;
    s->hold[s->count] = hold;
    s->foot[s->count++] = foot;
  }
  return foot;
}

/* The spokes are the edges of the face's first corner. */
static void fit_face(const laves__frame *frame, const laves__layer *layer, const int32_t face[3], spokes *s, laves__fit *fit) {
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
  const laves__vec3 centroid = v3_scale(v3_add(v3_add(p[0], p[1]), p[2]), 1.0 / 3), rim = v3_lerp(p[1], p[2], 0.5);
  laves__projection foot = find_foot(frame, hold, centroid, hint, scale);
  compare(&foot, centroid, normal, scale, fit);
  foot = find_foot(frame, hold, rim, hint, scale);
  compare(&foot, rim, normal, scale, fit);
  for (int j = 1; j < 3; j++) {
    const laves__vec3 middle = v3_lerp(p[0], p[j], 0.5);
    foot = spoke_foot(frame, layer, hold, face[0], face[j], middle, s);
    compare(&foot, middle, normal, scale, fit);
  }
}

void laves__fit_face(const laves__frame *frame, const laves__layer *layer, const int32_t face[3], laves__fit *fit) {
  spokes none;
  none.count = 0;
  fit_face(frame, layer, face, &none, fit);
}

void laves__fit_star(const laves__frame *frame, const laves__layer *layer, int32_t vertex, laves__fit *fit) {
  if (layer->patch) return; /* what may change lies in planes and stays in them */
  const laves__star *star = &layer->star[vertex];
  spokes shared;
  shared.count = 0;
  for (int i = 0; i < star->count; i++) {
    const int32_t t = star->tet[i];
    for (int k = 0; k < 4; k++) {
      if (layer->tet[t][k] == vertex || !laves__layer_is_boundary_face(layer, t, k)) continue;
      int32_t face[3];
      int at = 0;
      while (at < 2 && layer->tet[t][laves__tet_face[k][at]] != vertex) at++;
      for (int v = 0; v < 3; v++) face[v] = layer->tet[t][laves__tet_face[k][(at + v) % 3]];
      fit_face(frame, layer, face, &shared, fit);
    }
  }
}
