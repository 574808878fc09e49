/* Sizes near points, curves and tagged parts of the surface.
 *
 * In: points, polylines, or the triangles with a tag.  Out: a tree over them; points and segments are triangles without area.
 * The size is that of the place within its radius and grows beyond by the grading, so only what is near enough to bind has to
 * be searched. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "size/size_parts.h"

/* What a tree is built from. */
typedef struct shapes {
  laves__vec3 *points;
  uint32_t (*faces)[3];
  size_t point_count, face_count;
} shapes;

static bool reserve(laves_context *context, shapes *s, size_t point_count, size_t face_count) {
  s->points = laves__alloc(context, point_count, sizeof *s->points);
  s->faces = laves__alloc(context, face_count, sizeof *s->faces);
  s->point_count = point_count;
  s->face_count = face_count;
  return s->points && s->faces;
}

/* Each point alone, or joined to the next. */
static bool take_points(laves_context *context, const laves__source *source, laves__vec3 origin, shapes *s) {
  const size_t count = source->point_count;
  const bool joined = source->kind == LAVES__SOURCE_CURVE && count > 1;
  if (!reserve(context, s, count, joined ? count - 1 : count)) return false;
  for (size_t i = 0; i < count; i++) s->points[i] = v3_sub(source->points[i], origin);
  for (uint32_t i = 0; i < s->face_count; i++) {
    s->faces[i][0] = i;
    s->faces[i][1] = s->faces[i][2] = joined ? i + 1 : i;
  }
  return true;
}

/* The number of a tag, by its name or in decimal. */
static bool find_tag(const laves_domain *domain, const char *name, int32_t *tag) {
  for (int i = 0; i < domain->info.tag_count; i++)
    if (strcmp(domain->tag_names[i], name) == 0) {
      *tag = i;
      return true;
    }
  char *end;
  errno = 0;
  const long number = strtol(name, &end, 10);
  *tag = (int32_t)number;
  return end != name && *end == '\0' && errno == 0 && number >= INT32_MIN && number <= INT32_MAX;
}

static laves_result take_tag(laves_context *context, const laves__source *source, const laves_domain *domain, shapes *s,
                             laves_error *error) {
  const laves__surface *surface = domain->oracle.surface;
  int32_t tag = 0;
  size_t count = 0;
  if (!surface && domain->info.tag_count > 0)
    return laves__fail(
        error, LAVES_ERROR_INPUT,
        "there are no triangles with the tag '%s' to refine near, as the input is a formula; give points, curves or "
        "a size field",
        source->text);
  if (!surface || !surface->tags)
    return laves__fail(error, LAVES_ERROR_INPUT, "there is no tag '%s' to refine near: the input has no named parts",
                       source->text);
  if (find_tag(domain, source->text, &tag))
    for (size_t f = 0; f < surface->face_count; f++) count += surface->tags[f] == tag;
  if (count == 0)
    return laves__fail(error, LAVES_ERROR_INPUT,
                       "there is no tag '%s' to refine near among the %d named parts of the input; laves info lists them",
                       source->text, domain->info.tag_count);
  if (!reserve(context, s, 3 * count, count)) return laves__fail_memory(context, error);
  uint32_t next = 0;
  for (size_t f = 0, k = 0; f < surface->face_count; f++) {
    if (surface->tags[f] != tag) continue;
    for (int i = 0; i < 3; i++) {
      s->points[next] = surface->points[surface->faces[f][i]];
      s->faces[k][i] = next++;
    }
    k++;
  }
  return LAVES_OK;
}

laves_result laves__size_place_make(laves_context *context, const laves__source *source, const laves_domain *domain,
                                    laves__size_place *place, laves_error *error) {
  *place = (laves__size_place){.size = source->size, .radius = source->radius};
  shapes s = {0};
  uint32_t *order = NULL;
  laves_result result = LAVES_OK;
  if (source->kind == LAVES__SOURCE_TAG)
    result = take_tag(context, source, domain, &s, error);
  else if (!take_points(context, source, domain->oracle.origin, &s))
    result = laves__fail_memory(context, error);
  if (result == LAVES_OK) {
    order = laves__alloc(context, s.face_count, sizeof *order);
    if (!order || !laves__bvh_build(context, s.points, (const uint32_t(*)[3])s.faces, s.face_count, order, &place->bvh))
      result = laves__fail_memory(context, error);
  }
  laves__free(context, order, s.face_count, sizeof *order);
  laves__free(context, s.points, s.point_count, sizeof *s.points);
  laves__free(context, s.faces, s.face_count, sizeof *s.faces);
  return result;
}

double laves__size_place_least(const laves__size_place *place, double grading, laves__vec3 point, double size) {
  if (size <= place->size) return size;
  const double reach = place->radius + (size - place->size) / grading;
  laves__nearest nearest = {reach * reach, LAVES__NONE};
  laves__bvh_nearest(&place->bvh, point, &nearest);
  if (nearest.slot == LAVES__NONE) return size;
  return fmin(size, place->size + grading * fmax(0, sqrt(nearest.distance2) - place->radius));
}
