/* What the files of the size field share.
 *
 *   sizing.c          the public list of sources
 *   size.c            the story: options and sources bound to a domain, and their minimum
 *   size_depth.c      depth below the surface, for any domain
 *   size_field.c      expressions and scripts
 *   size_place.c      points, curves and tags
 *   size_patch.c      pieces of the surface, whole and parted
 *   size_samples.c    the surface sampled as finely as what it asks for
 *   size_curvature.c  curvature
 *   size_thickness.c  walls and gaps
 *   size_feature.c    creases that come close
 *
 * Coordinates are local to the oracle. */
#ifndef LAVES_SIZE_SIZE_PARTS_H
#define LAVES_SIZE_SIZE_PARTS_H

#include "domain/script.h"
#include "domain/surface.h"
#include "domain/tape.h"
#include "size/size.h"
#include "size/sizing.h"

/* Edges of the surface with a greater angle between their faces, and jumps of the normal by as much, are creases: the cosine
 * of 40 degrees. */
#define LAVES__CREASE_COSINE 0.766044443118978

/* How far apart samples stand, in sizes. */
#define LAVES__SAMPLE_SPACING 0.7

/* Points of one batch; what depends on it lies on the stack. */
enum { LAVES__SIZE_BATCH = 256 };

/* ---- pieces of the surface ---- */

/* A piece about `point`: a part of triangle `face`, or where face is LAVES__NONE of the tangent plane. */
typedef struct laves__patch {
  laves__vec3 point, normal;
  laves__vec3 corners[3]; /* of a part of a triangle */
  double width;           /* about the distance to the middles of neighbours of its kind */
  uint32_t face;
} laves__patch;

enum { LAVES__PATCH_PARTS = 4 };

/* Patches that cover the surface: its triangles whole, or about `spacing` wide where it is not made of triangles. */
laves_result laves__patches_of_domain(laves_context *context, const laves_domain *domain, double spacing, laves__patch **patches,
                                      size_t *count, laves_error *error);
/* Parts a patch; returns how many parts there are (those of a curved surface may leave it). */
int laves__patch_part(const laves__oracle *oracle, const laves__patch *patch, laves__patch parts[LAVES__PATCH_PARTS]);

/* ---- depth ---- */

/* Depth below the surface. Where phi is no distance, the surface is stood in for by samples with their tangent planes. */
typedef struct laves__depth {
  laves_context *context;
  const laves__oracle *oracle;
  bool direct; /* -phi is the depth */
  laves__bvh cloud;
  laves__vec3 *normals; /* [cloud.count] by slot */
  double spacing;
} laves__depth;

laves_result laves__depth_build(laves_context *context, const laves_domain *domain, double spacing, laves__depth *depth,
                                laves_error *error);
void laves__depth_free(laves__depth *depth);
/* Zero outside and on the surface. */
void laves__depth_evaluate(const laves__depth *depth, size_t count, const laves__vec3 *points, double *depths);

/* ---- expressions ---- */

typedef struct laves__size_field {
  const laves__source *source;
  laves__model model; /* owns the surfaces that the script names */
  laves__oracle *leaves;
  laves__tape tape;
  bool uses_depth;
} laves__size_field;

/* Runs the script. Its shape of `d` is bound by _bind. */
laves_result laves__size_field_make(laves_context *context, const laves__source *source, laves__vec3 origin,
                                    laves__size_field *field, laves_error *error);
void laves__size_field_bind(laves__size_field *field, const laves__depth *depth);
void laves__size_field_free(laves_context *context, laves__size_field *field);
/* The value, where the field is one number everywhere. */
bool laves__size_field_is_constant(const laves__size_field *field, double *value);

/* ---- places ---- */

typedef struct laves__size_place {
  laves__bvh bvh; /* over points, segments, or triangles */
  double size, radius;
} laves__size_place;

laves_result laves__size_place_make(laves_context *context, const laves__source *source, const laves_domain *domain,
                                    laves__size_place *place, laves_error *error);
/* The lesser of `size` and what the place asks for at a point. */
double laves__size_place_least(const laves__size_place *place, double grading, laves__vec3 point, double size);

/* ---- all ---- */

struct laves__size_failure;

struct laves__size {
  laves_context *context;
  const laves_domain *domain;
  const laves__oracle *oracle;
  double base, floor, ceiling; /* of any size; base: at the surface, where ceiling may be more */
  double grading, growth;
  double curvature_elements, thickness_elements, feature_elements, max_distance;
  laves__depth depth;
  laves__size_field *fields;
  size_t field_count, field_capacity;
  laves__size_place *places;
  size_t place_count, place_capacity;
  const laves__source **backgrounds;
  size_t background_count, background_capacity;
  struct laves__size_failure *failure;
};

/* ---- on the surface ---- */

/* Largest curvature of each triangle, 1 / length; NULL: none. */
typedef struct laves__curvature {
  const laves__size *size;
  double *of_face;
  size_t face_count;
} laves__curvature;

laves_result laves__curvature_build(const laves__size *size, laves__curvature *curvature, laves_error *error);
void laves__curvature_free(laves__curvature *curvature);
/* Curvature at a patch, seen at the scale of its width; *unresolved: the normal jumps, and only smaller parts can tell a
 * tight bend from a crease. */
double laves__curvature_at(const laves__curvature *curvature, const laves__patch *patch, bool *unresolved);

/* Thickness of the wall or gap before and behind a patch where that is less than reach, else INFINITY. */
double laves__thickness_at(const laves__size *size, const laves__patch *patch, double reach);

/* Samples of what close creases ask for. */
laves_result laves__feature_samples(const laves__size *size, laves__size_sample **samples, size_t *count, size_t *capacity,
                                    laves_error *error);

#endif
