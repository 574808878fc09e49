/* Sets of patches are short lists, so they are compared member by member. */
#include "domain/held.h"

/* How much lying along a patch counts against lying near it, in sizes: a face that is turned away by a right angle is half a size
 * further off. */
static const double along_weight = 0.5;
/* How far from a way's middle, and from its ends, a seam may be to be crossed by it. */
static const double seam_reach = 1.2; /* lengths of the way */

/* ---- sets ---- */

int laves__hold_patches(const laves__features *f, laves__hold hold, int32_t room[2], const int32_t **patches) {
  *patches = room;
  switch (hold.kind) {
    case LAVES__HOLD_PATCH:
      room[0] = hold.id;
      return 1;
    case LAVES__HOLD_CREASE:
      room[0] = f->crease[hold.id].patch[0];
      room[1] = f->crease[hold.id].patch[1];
      return room[0] == room[1] ? 1 : 2;
    case LAVES__HOLD_CORNER:
      *patches = f->corner_patch + f->corner[hold.id].first_patch;
      return (int)f->corner[hold.id].patch_count;
    default:
      return 0;
  }
}

bool laves__hold_has_patch(const laves__features *f, laves__hold hold, int32_t patch) {
  int32_t room[2];
  const int32_t *list;
  const int count = laves__hold_patches(f, hold, room, &list);
  if (hold.kind == LAVES__HOLD_SURFACE) return true;
  for (int i = 0; i < count; i++) /* nearly always it is one of them */
    if (list[i] == patch) return true;
  for (int i = 0; i < count; i++)
    if (laves__patches_join(f, list[i], patch)) return true;
  return false;
}

bool laves__holds_meet(const laves__features *f, laves__hold a, laves__hold b) {
  int32_t room[2];
  const int32_t *list;
  if (a.kind == LAVES__HOLD_SURFACE) return true;
  const int count = laves__hold_patches(f, a, room, &list);
  for (int i = 0; i < count; i++)
    if (laves__hold_has_patch(f, b, list[i])) return true;
  return false;
}

bool laves__hold_on_crease(const laves__features *f, laves__hold hold, int32_t crease) {
  if (hold.kind == LAVES__HOLD_CREASE) return hold.id == crease;
  if (hold.kind != LAVES__HOLD_CORNER) return false;
  return f->crease[crease].corner[0] == hold.id || f->crease[crease].corner[1] == hold.id;
}

int32_t laves__holds_crease(const laves__features *f, laves__hold a, laves__hold b) {
  if (a.kind < LAVES__HOLD_CREASE || b.kind < LAVES__HOLD_CREASE) return LAVES__NO_FEATURE;
  if (a.kind == LAVES__HOLD_CREASE) return laves__hold_on_crease(f, b, a.id) ? a.id : LAVES__NO_FEATURE;
  if (b.kind == LAVES__HOLD_CREASE) return laves__hold_on_crease(f, a, b.id) ? b.id : LAVES__NO_FEATURE;
  const laves__corner *corner = &f->corner[a.id];
  for (uint32_t i = 0; a.id != b.id && i < corner->crease_count; i++) {
    const int32_t crease = f->corner_crease[corner->first_crease + i];
    if (laves__hold_on_crease(f, b, crease)) return crease;
  }
  return LAVES__NO_FEATURE;
}

/* ---- faces ---- */

enum { COMMON_MAX = 8 };

typedef struct common {
  int32_t patch[COMMON_MAX];
  int count;
} common;

static void add_common(common *c, int32_t patch) {
  for (int i = 0; i < c->count; i++)
    if (c->patch[i] == patch) return;
  if (c->count < COMMON_MAX) c->patch[c->count++] = patch;
}

/* Whether a patch of vertex `lead` goes with the two others. */
static bool go_with(const laves__features *f, const laves__hold hold[3], int lead, int32_t patch) {
  return laves__hold_has_patch(f, hold[(lead + 1) % 3], patch) && laves__hold_has_patch(f, hold[(lead + 2) % 3], patch);
}

/* The patches of any of three vertices that go with all three. */
static common common_patches(const laves__features *f, const laves__hold hold[3]) {
  common c = {.count = 0};
  for (int lead = 0; lead < 3; lead++) {
    int32_t room[2];
    const int32_t *list;
    const int listed = laves__hold_patches(f, hold[lead], room, &list);
    for (int k = 0; k < listed; k++)
      if (go_with(f, hold, lead, list[k])) add_common(&c, list[k]);
  }
  return c;
}

bool laves__face_is_legal(const laves__features *f, const laves__hold hold[3]) {
  bool free = true;
  for (int lead = 0; lead < 3; lead++) {
    int32_t room[2];
    const int32_t *list;
    const int listed = laves__hold_patches(f, hold[lead], room, &list);
    free = free && hold[lead].kind == LAVES__HOLD_SURFACE;
    for (int k = 0; k < listed; k++)
      if (go_with(f, hold, lead, list[k])) return true;
  }
  return free;
}

/* How badly a face fits a patch. */
static double misfit(const laves__frame *frame, int32_t patch, const laves__vec3 p[3], laves__vec3 normal, uint32_t hint) {
  static const double reach = 2; /* sizes */
  const laves__vec3 middle = v3_scale(v3_add(p[0], v3_add(p[1], p[2])), 1.0 / 3);
  laves__vec3 foot, n;
  const laves__hold hold = {patch, LAVES__HOLD_PATCH};
  if (!laves__frame_project_held(frame, hold, middle, reach, &hint, &foot, &n)) return reach + along_weight;
  return v3_distance(middle, foot) - along_weight * v3_dot(normal, n);
}

int32_t laves__face_patch(const laves__frame *frame, const laves__hold hold[3], const laves__vec3 p[3], uint32_t hint) {
  const common c = common_patches(frame->features, hold);
  if (c.count == 0) return LAVES__NO_FEATURE;
  if (c.count == 1) return c.patch[0];
  const laves__vec3 normal = v3_unit(v3_cross(v3_sub(p[1], p[0]), v3_sub(p[2], p[0])));
  int best = 0;
  double least = HUGE_VAL;
  for (int i = 0; i < c.count; i++) {
    const double m = misfit(frame, c.patch[i], p, normal, hint);
    if (m >= least) continue;
    least = m;
    best = i;
  }
  return c.patch[best];
}

/* ---- places ---- */

bool laves__frame_project_held(const laves__frame *frame, laves__hold hold, laves__vec3 point, double reach, uint32_t *hint,
                               laves__vec3 *foot, laves__vec3 *direction) {
  const laves__features *f = frame->features;
  if (hold.kind == LAVES__HOLD_SURFACE) return laves__frame_project(frame, point, reach, hint, foot, direction);
  if (hold.kind == LAVES__HOLD_CORNER) {
    *foot = laves__frame_from_local(frame, f->corner[hold.id].position);
    *direction = v3(0, 0, 0);
    return true;
  }
  laves__vec3 local_foot, local_direction;
  const laves__vec3 local = laves__frame_to_local(frame, point);
  const bool found = hold.kind == LAVES__HOLD_CREASE
                         ? laves__crease_project(f, hold.id, local, reach * frame->size, &local_foot, &local_direction)
                         : f->project_patch(f->self, hold.id, local, reach * frame->size, hint, &local_foot, &local_direction);
  if (!found) return false;
  *foot = laves__frame_from_local(frame, local_foot);
  *direction = m3_mul_transposed(&frame->rotation, local_direction);
  return v3_finite(*foot) && v3_finite(*direction);
}

/* ---- seams ---- */

/* On which side of a crease a point lies; 0: on it, or beyond its ends. */
static int side_of(const laves__frame *frame, int32_t crease, laves__vec3 p, double reach, laves__vec3 normal) {
  laves__vec3 foot, tangent;
  uint32_t hint = LAVES__NO_HINT;
  const laves__hold hold = {crease, LAVES__HOLD_CREASE};
  if (!laves__frame_project_held(frame, hold, p, reach, &hint, &foot, &tangent)) return 0;
  const laves__vec3 from = v3_sub(p, foot), across = v3_cross(normal, tangent);
  const double along = fabs(v3_dot(from, tangent)), aside = v3_dot(from, across);
  if (along > 1e-6 * reach && along > fabs(aside)) return 0; /* beyond an end */
  return aside > 0 ? 1 : aside < 0 ? -1 : 0;
}

bool laves__way_crosses_seam(const laves__frame *frame, laves__vec3 a, laves__vec3 b, int32_t patch, laves__vec3 normal_a,
                             laves__vec3 normal_b, int32_t *crease) {
  const laves__features *f = frame->features;
  const double reach = seam_reach * v3_distance(a, b);
  laves__vec3 foot, tangent;
  *crease = laves__seam_near(f, patch, laves__frame_to_local(frame, v3_lerp(a, b, 0.5)), reach * frame->size, &foot, &tangent);
  if (*crease == LAVES__NO_FEATURE) return false;
  return side_of(frame, *crease, a, reach, normal_a) * side_of(frame, *crease, b, reach, normal_b) < 0;
}
