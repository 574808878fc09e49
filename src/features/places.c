/* Where held vertices stand.
 *
 * In: holds, the places after snapping.  Out: places on patches, creases and corners, as near as tets stay positive.
 *
 * All go at once; where that turns tets over, their vertices go half the way, and half of that, until none is. Those that are not
 * there yet are marked, and improvement brings them later. */
#include "base/predicates.h"
#include "features/keep.h"

static const double crowd_range = 0.3;                     /* local sizes: vertices of a crease so near its corner are spread */
static const double spread_first = 0.4, spread_next = 0.3; /* local sizes along the crease, the first and each further one */
enum { HALVINGS = 6 };

/* Vertices of one crease that were projected to nearly its end go on along it, one after the other. */
static void spread(const laves__keeping *k, int32_t corner) {
  const laves__rim *rim = &k->rim;
  const laves__features *f = k->features;
  const int32_t centre = k->claimed[corner];
  const double scale = laves__layer_scale(k->layer, centre);
  for (uint32_t e = 0; e < f->corner[corner].crease_count; e++) {
    const int32_t crease = f->corner_crease[f->corner[corner].first_crease + e];
    const int end = f->crease[crease].corner[0] == corner ? 0 : 1;
    const double most = 0.5 * f->crease[crease].length / k->frame->size;
    double way = spread_first * scale;
    for (uint32_t i = rim->first[centre]; i < rim->first[centre + 1]; i++) {
      const int32_t v = laves__rim_next(rim, rim->at[i], centre);
      const laves__hold hold = k->layer->hold[v];
      if (hold.kind != LAVES__HOLD_CREASE || hold.id != crease) continue;
      if (v3_distance(k->layer->position[v], k->layer->position[centre]) > crowd_range * scale) continue;
      k->layer->position[v] =
          laves__frame_from_local(k->frame, laves__crease_point_at(f, crease, end, fmin(way, most) * k->frame->size));
      way += spread_next * scale;
    }
  }
}

/* The place of every held vertex, without a look at tets. */
static void find_places(const laves__keeping *k) {
  laves__layer *layer = k->layer;
  for (size_t v = 0; v < k->rim.vertex_count; v++) {
    if (laves__cancelled_at(k->context, "features", v, k->rim.vertex_count)) return;
    const laves__hold hold = layer->hold[v];
    const bool stays = hold.kind == LAVES__HOLD_SURFACE || (hold.kind == LAVES__HOLD_PATCH && hold.id == k->start_patch[v]);
    if (stays || k->rim.first[v] == k->rim.first[v + 1]) continue;
    laves__vec3 place, direction;
    uint32_t hint = layer->hint[v];
    if (!laves__frame_project_held(k->frame, hold, k->start[v], 4 * laves__layer_scale(layer, (int32_t)v), &hint, &place,
                                   &direction)) {
      layer->off_surface[v] = true;
      continue;
    }
    layer->position[v] = place;
    layer->normal[v] = direction;
    layer->hint[v] = hint;
    layer->off_surface[v] = false;
  }
  for (size_t c = 0; c < k->features->corner_count; c++)
    if (k->claimed[c] != LAVES__NO_FEATURE) spread(k, (int32_t)c);
}

/* Six times the volume over the cube of the longest edge: above what rounding does, far below any tet of use. */
static const double least_volume = 1e-9;

static bool is_thick(const laves__vec3 p[4]) {
  double longest2 = 0;
  for (int i = 0; i < 4; i++) {
    for (int k = 0; k < i; k++) longest2 = fmax(longest2, v3_norm2(v3_sub(p[i], p[k])));
  }
  return v3_det(p[0], p[1], p[2], p[3]) > least_volume * longest2 * sqrt(longest2);
}

static bool is_positive(const laves__keeping *k, size_t tet) {
  laves__vec3 p[4];
  laves__layer_points(k->layer, (int32_t)tet, p);
  return laves__orient3d(p[0], p[1], p[2], p[3]) > 0 && (!k->is_last || is_thick(p));
}

/* Draws vertices that moved back towards their start until every tet is positive. */
static void draw_back(const laves__keeping *k) {
  laves__layer *layer = k->layer;
  bool bad = true;
  for (int round = 0; bad; round++) {
    bad = false;
    for (size_t t = 0; t < layer->tet_count && !laves__cancelled_at(k->context, "features", t, layer->tet_count); t++) {
      if (layer->tet[t][0] < 0 || is_positive(k, t)) continue;
      for (int c = 0; c < 4; c++) {
        const int32_t v = layer->tet[t][c];
        if (layer->depth[v] != 0 || v3_distance(layer->position[v], k->start[v]) == 0) continue;
        layer->position[v] = round < HALVINGS ? v3_lerp(k->start[v], layer->position[v], 0.5) : k->start[v];
        layer->off_surface[v] = true;
        bad = true;
      }
    }
  }
}

void laves__place_held(laves__keeping *k, size_t *off_feature) {
  find_places(k);
  draw_back(k);
  *off_feature = 0;
  for (size_t v = 0; v < k->rim.vertex_count; v++)
    *off_feature += k->layer->hold[v].kind >= LAVES__HOLD_CREASE && k->layer->off_surface[v];
}
