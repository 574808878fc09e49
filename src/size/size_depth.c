/* How deep points lie below the surface.
 *
 * In: a domain.  Out: depths, zero outside. For surfaces, and wherever phi is a distance, the depth is -phi. Other functions say
 * nothing about distances; there the surface is sampled, and the depth is the distance to the nearest sample, or near by, to its
 * tangent plane. With samples s apart the error is at most about s/8 far away, and of second order in s near the surface, which
 * is far below what a size needs. */
#include "size/size_parts.h"

/* From this many spacings on the sample itself is taken, below its tangent plane. */
static const double plane_range = 4;
/* Samples are no closer than this part of the diagonal. */
static const double finest_spacing = 1.0 / 256;

static laves_result build_cloud(const laves__patch *patches, size_t count, laves__depth *d, laves_error *error) {
  laves_context *context = d->context;
  laves_result result = LAVES_OK;
  laves__vec3 *points = laves__alloc(context, count, sizeof *points);
  uint32_t(*faces)[3] = laves__alloc(context, count, sizeof *faces);
  uint32_t *order = laves__alloc(context, count, sizeof *order);
  d->normals = laves__alloc(context, count, sizeof *d->normals);
  if (points && faces && order && d->normals) {
    for (uint32_t i = 0; i < count; i++) {
      points[i] = patches[i].point;
      faces[i][0] = faces[i][1] = faces[i][2] = i;
    }
    if (!laves__bvh_build(context, points, (const uint32_t(*)[3])faces, count, order, &d->cloud))
      result = laves__fail_memory(context, error);
    for (size_t i = 0; result == LAVES_OK && i < count; i++) d->normals[i] = patches[order[i]].normal;
  } else {
    result = laves__fail_memory(context, error);
  }
  if (result != LAVES_OK) {
    laves__free(context, d->normals, count, sizeof *d->normals);
    d->normals = NULL;
  }
  laves__free(context, points, count, sizeof *points);
  laves__free(context, faces, count, sizeof *faces);
  laves__free(context, order, count, sizeof *order);
  return result;
}

laves_result laves__depth_build(laves_context *context, const laves_domain *domain, double spacing, laves__depth *depth,
                                laves_error *error) {
  const laves__oracle *oracle = &domain->oracle;
  *depth = (laves__depth){.context = context, .oracle = oracle, .direct = oracle->is_distance || oracle->surface};
  if (depth->direct) return LAVES_OK;
  laves__patch *patches;
  size_t count;
  depth->spacing = fmax(spacing, finest_spacing * box3_diagonal(oracle->bounds));
  laves_result result = laves__patches_of_domain(context, domain, depth->spacing, &patches, &count, error);
  if (result != LAVES_OK) return result;
  if (count == 0)
    result = laves__fail(error, LAVES_ERROR_INPUT, "the depth below the surface cannot be found: no point of the surface can");
  if (result == LAVES_OK) result = build_cloud(patches, count, depth, error);
  laves__free(context, patches, count, sizeof *patches);
  return result;
}

void laves__depth_free(laves__depth *d) {
  if (!d->context) return;
  laves__free(d->context, d->normals, d->cloud.count, sizeof *d->normals);
  laves__bvh_free(d->context, &d->cloud);
  *d = (laves__depth){0};
}

static double cloud_distance(const laves__depth *d, laves__vec3 p) {
  laves__nearest nearest = {INFINITY, LAVES__NONE};
  laves__bvh_nearest(&d->cloud, p, &nearest);
  if (nearest.slot == LAVES__NONE) return 0;
  const double distance = sqrt(nearest.distance2);
  if (distance > plane_range * d->spacing) return distance;
  return fabs(v3_dot(v3_sub(p, d->cloud.triangles[nearest.slot].a), d->normals[nearest.slot]));
}

void laves__depth_evaluate(const laves__depth *depth, size_t count, const laves__vec3 *points, double *depths) {
  depth->oracle->evaluate(depth->oracle->self, count, points, depths, NULL);
  for (size_t i = 0; i < count; i++) {
    if (!(depths[i] < 0))
      depths[i] = 0;
    else
      depths[i] = depth->direct ? -depths[i] : cloud_distance(depth, points[i]);
  }
}
