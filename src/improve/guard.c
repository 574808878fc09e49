/* All is asked of the stars of boundary vertices, which are known; nothing is stored. */
#include "improve/guard.h"

#include "mesh/mesh.h"

enum { FACES_MAX = 64 };

/* The boundary faces around a vertex: its two other corners, counter-clockwise. */
typedef struct fan {
  int32_t next[FACES_MAX], previous[FACES_MAX], patch[FACES_MAX];
  int count;
} fan;

int32_t laves__layer_face_patch(const laves__frame *frame, const laves__layer *layer, const int32_t face[3]) {
  if (!layer->hold || !frame->features) return LAVES__NO_FEATURE;
  laves__hold hold[3];
  laves__vec3 p[3];
  for (int j = 0; j < 3; j++) {
    hold[j] = layer->hold[face[j]];
    p[j] = layer->position[face[j]];
  }
  return laves__face_patch(frame, hold, p, layer->hint[face[0]]);
}

/* False when there are too many faces to look at. */
static bool find_fan(const laves__frame *frame, const laves__layer *layer, int32_t vertex, fan *f) {
  const laves__star *star = &layer->star[vertex];
  f->count = 0;
  for (int i = 0; i < star->count; i++) {
    const int32_t t = star->tet[i];
    for (int c = 0; c < 4; c++) {
      if (layer->tet[t][c] == vertex || !laves__layer_is_boundary_face(layer, t, c)) continue;
      if (f->count == FACES_MAX) return false;
      int32_t face[3];
      for (int j = 0; j < 3; j++) face[j] = layer->tet[t][laves__tet_face[c][j]];
      const int at = face[0] == vertex ? 0 : face[1] == vertex ? 1 : 2;
      f->next[f->count] = face[(at + 1) % 3];
      f->previous[f->count] = face[(at + 2) % 3];
      f->patch[f->count++] = laves__layer_face_patch(frame, layer, face);
    }
  }
  return true;
}

/* Whether no crease lies between two faces. */
static bool same_patch(const laves__frame *frame, int32_t a, int32_t b) {
  return a == b || (a != LAVES__NO_FEATURE && b != LAVES__NO_FEATURE && laves__patches_join(frame->features, a, b));
}

int laves__given_edge(const laves__layer *layer, int32_t a, int32_t b, int32_t *patch) {
  const laves__star *star = &layer->star[a];
  int count = 0;
  *patch = LAVES__NO_PATCH;
  for (int i = 0; i < star->count; i++) {
    const int32_t t = star->tet[i];
    if (laves__layer_corner(layer, t, b) < 0) continue;
    for (int k = 0; k < 4; k++) {
      const int32_t p = layer->patch[t][k];
      if (p == LAVES__NO_PATCH || layer->tet[t][k] == a || layer->tet[t][k] == b) continue;
      *patch = count++ == 0 || p == *patch ? p : LAVES__NO_PATCH;
    }
  }
  return count;
}

/* Whether all around a vertex is one region. */
static bool within_region(const laves__layer *layer, int32_t vertex) {
  const laves__star *star = &layer->star[vertex];
  for (int i = 1; layer->region && i < star->count; i++)
    if (layer->region[star->tet[i]] != layer->region[star->tet[0]]) return false;
  return true;
}

/* Borders between regions keep their vertices. Around one in a patch all faces are of that patch, so it may go anywhere along
 * them; one on a crease along that. */
static bool given_may_merge(const laves__layer *layer, int32_t gone, int32_t into) {
  int32_t patch;
  const uint8_t kind = layer->hold[gone].kind;
  if (kind == LAVES__HOLD_CORNER || !within_region(layer, gone)) return false;
  const int faces = laves__given_edge(layer, gone, into, &patch);
  return faces == 2 && (kind == LAVES__HOLD_PATCH) == (patch != LAVES__NO_PATCH);
}

bool laves__is_crease_edge(const laves__frame *frame, const laves__layer *layer, int32_t a, int32_t b) {
  if (!layer->hold) return false;
  const int32_t crease = laves__holds_crease(frame->features, layer->hold[a], layer->hold[b]);
  if (crease == LAVES__NO_FEATURE) return false;
  if (frame->features->crease[crease].patch[0] == frame->features->crease[crease].patch[1]) return true;
  fan f;
  if (!find_fan(frame, layer, a, &f)) return true;
  int32_t left = LAVES__NO_FEATURE, right = LAVES__NO_FEATURE;
  for (int i = 0; i < f.count; i++) {
    if (f.next[i] == b) left = f.patch[i];
    if (f.previous[i] == b) right = f.patch[i];
  }
  return !same_patch(frame, left, right);
}

/* Ends of creases between different patches at a vertex. */
static int expected_borders(const laves__features *f, laves__hold hold) {
  if (hold.kind == LAVES__HOLD_CREASE) return f->crease[hold.id].patch[0] != f->crease[hold.id].patch[1] ? 2 : 0;
  if (hold.kind != LAVES__HOLD_CORNER) return 0;
  const laves__corner *corner = &f->corner[hold.id];
  int count = 0;
  for (uint32_t i = 0; i < corner->crease_count; i++) {
    const laves__crease *c = &f->crease[f->corner_crease[corner->first_crease + i]];
    if (c->patch[0] == c->patch[1]) continue;
    count += (c->corner[0] == hold.id) + (c->corner[1] == hold.id);
  }
  return count;
}

int laves__feature_faults(const laves__frame *frame, const laves__layer *layer, int32_t vertex) {
  fan f;
  if (!layer->hold || layer->patch || layer->depth[vertex] != 0) return 0;
  const laves__hold hold = layer->hold[vertex];
  if (!find_fan(frame, layer, vertex, &f)) return FACES_MAX;
  int faults = 0, borders = 0;
  for (int i = 0; i < f.count; i++) {
    faults += f.patch[i] == LAVES__NO_FEATURE && hold.kind != LAVES__HOLD_SURFACE;
    int beyond = -1;
    for (int j = 0; j < f.count; j++)
      if (f.previous[j] == f.next[i]) beyond = j;
    if (beyond < 0 || same_patch(frame, f.patch[beyond], f.patch[i])) continue;
    borders++;
    faults += laves__holds_crease(frame->features, hold, layer->hold[f.next[i]]) == LAVES__NO_FEATURE;
  }
  const int missing = expected_borders(frame->features, hold) - borders;
  return faults + (missing < 0 ? -missing : missing);
}

/* Whether a vertex is a corner of an earlier tet of a star. */
static bool seen_before(const laves__layer *layer, const laves__star *star, int count, int32_t vertex) {
  for (int i = 0; i < count; i++)
    if (laves__layer_corner(layer, star->tet[i], vertex) >= 0) return true;
  return false;
}

double laves__crease_sag(const laves__frame *frame, const laves__layer *layer, int32_t vertex) {
  const laves__star *star = &layer->star[vertex];
  const double scale = laves__layer_scale(layer, vertex);
  double sag = 0;
  if (layer->patch || laves__layer_hold(layer, vertex).kind < LAVES__HOLD_CREASE) return 0; /* given ones are straight */
  for (int i = 0; i < star->count; i++)
    for (int k = 0; k < 4; k++) {
      const int32_t w = layer->tet[star->tet[i]][k];
      if (w == vertex || layer->depth[w] != 0 || layer->hold[w].kind < LAVES__HOLD_CREASE) continue;
      const int32_t crease = laves__holds_crease(frame->features, layer->hold[vertex], layer->hold[w]);
      if (crease == LAVES__NO_FEATURE || seen_before(layer, star, i, w)) continue;
      const laves__hold hold = {crease, LAVES__HOLD_CREASE};
      const laves__vec3 middle = v3_lerp(layer->position[vertex], layer->position[w], 0.5);
      laves__vec3 foot, tangent;
      uint32_t hint = LAVES__NO_HINT;
      if (laves__frame_project_held(frame, hold, middle, scale, &hint, &foot, &tangent))
        sag = fmax(sag, v3_distance(foot, middle) / scale);
    }
  return sag;
}

bool laves__may_merge(const laves__frame *frame, const laves__layer *layer, int32_t gone, int32_t into) {
  if (!layer->hold || layer->depth[gone] != 0) return true;
  if (layer->patch) return given_may_merge(layer, gone, into);
  const laves__hold from = layer->hold[gone], to = layer->hold[into];
  switch (from.kind) {
    case LAVES__HOLD_CORNER:
      return false;
    case LAVES__HOLD_CREASE:
      return laves__hold_on_crease(frame->features, to, from.id) && laves__is_crease_edge(frame, layer, gone, into);
    case LAVES__HOLD_PATCH:
      return laves__hold_has_patch(frame->features, to, from.id);
    default:
      return to.kind == LAVES__HOLD_SURFACE;
  }
}

/* The cosine of the angle inside a tet between the faces opposite two corners. */
static double face_cosine(const laves__vec3 p[4], int i, int j) {
  laves__vec3 n[2];
  for (int k = 0; k < 2; k++) {
    const uint8_t *face = laves__tet_face[k ? j : i];
    n[k] = v3_unit(v3_cross(v3_sub(p[face[1]], p[face[0]]), v3_sub(p[face[2]], p[face[0]])));
  }
  return -v3_dot(n[0], n[1]);
}

unsigned laves__given_fixed_edges(double sharp_cosine, const laves__layer *layer, int32_t tet) {
  const int32_t *patch = layer->patch[tet];
  unsigned fixed = 0;
  int count = 0;
  for (int k = 0; k < 4; k++) count += patch[k] != LAVES__NO_PATCH;
  if (count < 2) return 0;
  laves__vec3 p[4];
  laves__layer_points(layer, tet, p);
  for (int e = 0; e < 6; e++) {
    const uint8_t *others = laves__tet_edge[5 - e]; /* the faces at the edge are opposite the two other corners */
    if (patch[others[0]] == LAVES__NO_PATCH || patch[others[1]] == LAVES__NO_PATCH || patch[others[0]] == patch[others[1]])
      continue;
    if (face_cosine(p, others[0], others[1]) > sharp_cosine) fixed |= 1u << e;
  }
  return fixed;
}

unsigned laves__fixed_edges(const laves__features *f, double sharper_than, const laves__layer *layer, int32_t tet) {
  unsigned fixed = 0;
  const int32_t *v = layer->tet[tet];
  for (int e = 0; e < 6; e++) {
    const int32_t a = v[laves__tet_edge[e][0]], b = v[laves__tet_edge[e][1]];
    if (layer->depth[a] != 0 || layer->depth[b] != 0) continue;
    const int32_t crease = laves__holds_crease(f, layer->hold[a], layer->hold[b]);
    if (crease == LAVES__NO_FEATURE || !(f->crease[crease].least_angle < sharper_than)) continue;
    const uint8_t *others = laves__tet_edge[5 - e]; /* the faces at the edge are opposite the two other corners */
    if (laves__layer_is_boundary_face(layer, tet, others[0]) && laves__layer_is_boundary_face(layer, tet, others[1]))
      fixed |= 1u << e;
  }
  return fixed;
}
