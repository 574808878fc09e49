/* Patches and creases of a triangle surface.
 *
 * In: the surface, which edges are creases (feature_edges.c).  Out: a patch for each face, segments, tips.
 *
 * Patches are what hangs together without crossing a crease; feature_seam.c splits those that are on both its sides. A tip is a
 * point without creases whose faces' angles miss more than a radian of the full turn, such as a cone's: it is a corner by itself,
 * where the faces are large enough to mean it. */
#include "domain/features.h"

#include <string.h>

#include "domain/feature_edges.h"
#include "domain/feature_seam.h"

static const double tip_defect = 1;  /* radians */
static const double tip_edges = 0.5; /* sizes: all edges of a tip are longer */
static const double turn = 6.283185307179586, degrees = 57.29577951308232;

typedef struct patches {
  const laves__surface *surface;
  const laves__features *features;
  int32_t *of_face; /* [faces] */
  bool *on_border;  /* [points] of creases */
} patches;

/* ---- the callbacks ---- */

static int32_t patch_at(const void *self, laves__vec3 foot, uint32_t hint) {
  const patches *p = self;
  (void)foot;
  return hint < p->surface->face_count ? p->of_face[hint] : LAVES__NO_FEATURE;
}

static bool project_patch(const void *self, int32_t patch, laves__vec3 point, double reach, uint32_t *hint, laves__vec3 *foot,
                          laves__vec3 *normal) {
  const patches *p = self;
  const laves__part part = {p->of_face, patch, p->features, p->on_border};
  return laves__surface_project_part(p->surface, &part, point, reach, hint, foot, normal);
}

static void free_patches(laves_context *context, void *self) {
  patches *p = self;
  if (!p) return;
  laves__free(context, p->of_face, p->surface->face_count, sizeof *p->of_face);
  laves__free(context, p->on_border, p->surface->point_count, sizeof *p->on_border);
  laves__free(context, p, 1, sizeof *p);
}

/* ---- patches ---- */

static bool find_patches(const laves__feature_edges *e, patches *p, int32_t *count) {
  const laves__surface *s = e->surface;
  uint32_t *stack = laves__alloc(e->context, s->face_count, sizeof *stack);
  if (!stack) return false;
  memset(p->of_face, 0xff, s->face_count * sizeof *p->of_face);
  for (uint32_t first = 0; first < s->face_count; first++) {
    if (p->of_face[first] != LAVES__NO_FEATURE) continue;
    size_t top = 0;
    stack[top++] = first;
    p->of_face[first] = *count;
    while (top > 0) {
      const uint32_t f = stack[--top];
      for (uint32_t h = 3 * f; h < 3 * f + 3; h++) {
        const uint32_t g = s->across[h];
        if (e->is_crease[h] || g == LAVES__NONE || p->of_face[g / 3] != LAVES__NO_FEATURE) continue;
        p->of_face[g / 3] = *count;
        stack[top++] = g / 3;
      }
    }
    ++*count;
  }
  laves__free(e->context, stack, s->face_count, sizeof *stack);
  return true;
}

/* ---- lines ---- */

/* The angle inside the solid, in degrees, at an edge of its left face. */
static double inner_angle(const laves__feature_edges *e, uint32_t h) {
  const laves__surface *s = e->surface;
  const laves__vec3 left = e->normal[h / 3], right = e->normal[s->across[h] / 3], across = v3_cross(left, right);
  const laves__vec3 along = v3_sub(s->points[laves__half_end(s, h)], s->points[laves__half_start(s, h)]);
  const double between = laves__angle(v3_norm(across), v3_dot(left, right)) * degrees;
  return v3_dot(across, along) > 0 ? 180 - between : 180 + between;
}

/* A point of the lines for a point of the surface, made when first met. */
static bool line_point(const laves__surface *s, laves__feature_lines *lines, uint32_t *index, uint32_t point) {
  return index[point] != LAVES__NONE || laves__feature_lines_add_point(lines, s->points[point], &index[point]);
}

static bool add_segments(const laves__feature_edges *e, const patches *p, laves__feature_lines *lines, uint32_t *index) {
  const laves__surface *s = e->surface;
  for (uint32_t h = 0; h < 3 * s->face_count; h++) {
    if (!e->is_crease[h] || s->across[h] < h) continue;
    const uint32_t a = laves__half_start(s, h), b = laves__half_end(s, h);
    if (!line_point(s, lines, index, a) || !line_point(s, lines, index, b)) return false;
    const laves__feature_segment g = {
        .ends = {index[a], index[b]}, .patch = {p->of_face[h / 3], p->of_face[s->across[h] / 3]}, .angle = inner_angle(e, h)};
    if (!laves__feature_lines_add_segment(lines, &g)) return false;
    p->on_border[a] = p->on_border[b] = true;
  }
  return true;
}

/* Whether a point with these faces around it is a tip. */
static bool is_tip(const laves__feature_edges *e, uint32_t point) {
  const laves__surface *s = e->surface;
  double missing = turn, shortest = HUGE_VAL;
  if (e->degree[point] > 0 || s->doubtful_points[point] || e->first[point] == e->first[point + 1]) return false;
  for (uint32_t k = e->first[point]; k < e->first[point + 1]; k++) {
    const uint32_t h = e->at[k], *face = s->faces[h / 3];
    const laves__vec3 o = s->points[point], u = v3_sub(s->points[face[(h % 3 + 1) % 3]], o);
    const laves__vec3 v = v3_sub(s->points[face[(h % 3 + 2) % 3]], o);
    missing -= laves__angle(v3_norm(v3_cross(u, v)), v3_dot(u, v));
    shortest = fmin(shortest, v3_norm(u));
  }
  return missing > tip_defect && shortest > tip_edges * e->wish->size;
}

static bool add_tips(const laves__feature_edges *e, const patches *p, laves__feature_lines *lines, uint32_t *index) {
  const laves__surface *s = e->surface;
  for (uint32_t point = 0; e->wish->angle > 0 && point < s->point_count; point++) {
    if (!is_tip(e, point)) continue;
    if (!line_point(s, lines, index, point)) return false;
    if (!laves__feature_lines_fix(lines, index[point], p->of_face[e->at[e->first[point]] / 3])) return false;
  }
  return true;
}

static bool fill(const laves__feature_edges *e, patches *p, laves__features *features, laves__feature_lines *lines) {
  const size_t points = e->surface->point_count;
  uint32_t *index = laves__alloc(e->context, points, sizeof *index);
  if (!index) return false;
  memset(index, 0xff, points * sizeof *index);
  features->patch_count = 0;
  features->dropped_count = e->dropped;
  features->joined_count = e->joined;
  const bool done = find_patches(e, p, &features->patch_count) && laves__split_seams(e, p->of_face, features) &&
                    add_segments(e, p, lines, index) && add_tips(e, p, lines, index);
  laves__free(e->context, index, points, sizeof *index);
  return done;
}

laves_result laves__features_of_surface(const laves__feature_wish *wish, laves__features *features, laves__feature_lines *lines,
                                        laves_error *error) {
  laves_context *context = features->context;
  const laves__surface *s = features->oracle->surface;
  laves__feature_edges edges = {0};
  patches *p = laves__alloc_zeroed(context, 1, sizeof *p);
  bool done = p != NULL;
  if (done) {
    p->surface = s;
    p->features = features;
    p->of_face = laves__alloc(context, s->face_count, sizeof *p->of_face);
    p->on_border = laves__alloc_zeroed(context, s->point_count, sizeof *p->on_border);
    done = p->of_face && p->on_border && laves__feature_edges_find(context, s, wish, &edges) && fill(&edges, p, features, lines);
  }
  laves__feature_edges_free(&edges);
  if (!done) {
    free_patches(context, p);
    return laves__fail_memory(context, error);
  }
  features->self = p;
  features->patch_at = patch_at;
  features->project_patch = project_patch;
  features->free_self = free_patches;
  return LAVES_OK;
}
