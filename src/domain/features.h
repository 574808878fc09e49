/* The features of a domain: patches, the creases along which they meet, and the corners at which creases end.
 *
 *      patch 0 ___________ patch 1            a crease is a polyline with the same two patches on either side all along;
 *             /          /                    it ends at corners, or is closed. A line that the user drew on a patch has that
 *            /  crease  o corner              patch on both sides. A corner may also stand alone: a cone's tip, a fixed vertex.
 *           /__________/|
 *
 * Who makes them: feature_surface.c from the angles between triangles, feature_implicit.c from the expression of an implicit
 * solid, feature_lines.c from what the user drew. All of them give segments between points, with the patches on both
 * sides; feature_chain.c joins segments to creases and finds the corners.
 *
 * Coordinates are those of the oracle (local, in units of the input). Read only once made; safe from many threads. */
#ifndef LAVES_DOMAIN_FEATURES_H
#define LAVES_DOMAIN_FEATURES_H

#include "domain/oracle.h"
#include "domain/surface.h"

/* Neither patch nor crease nor corner. */
#define LAVES__NO_FEATURE (-1)

/* ---- what the user drew ---- */

/* Input coordinates. */
struct laves_features {
  laves_context *context;
  laves__vec3 *point; /* single points */
  size_t point_count, point_capacity;
  laves__vec3 *vertex; /* of all polylines */
  size_t vertex_count, vertex_capacity;
  size_t *line_end; /* [line_count] one past the last vertex of each */
  size_t line_count, line_capacity;
};

/* ---- what the makers give ---- */

/* A stretch of a crease. Where it turns by less than the chain's limit in a point with two segments of the same patches, the
 * crease goes on. */
typedef struct laves__feature_segment {
  uint32_t ends[2]; /* points */
  int32_t patch[2]; /* left and right of ends[0] -> ends[1], seen from outside */
  double angle;     /* inside the solid, degrees: 90 a box's edge, 270 a notch, 180 where nothing is sharp */
  bool drawn;       /* by the user: kept however short */
} laves__feature_segment;

/* A point that is a corner whatever meets there. */
typedef struct laves__feature_point {
  uint32_t point;
  int32_t patch; /* on which it lies where no crease ends at it, or LAVES__NO_FEATURE: all around are found */
} laves__feature_point;

typedef struct laves__feature_lines {
  laves_context *context;
  laves__vec3 *point;
  size_t point_count, point_capacity;
  laves__feature_segment *segment;
  size_t segment_count, segment_capacity;
  laves__feature_point *fixed;
  size_t fixed_count, fixed_capacity;
} laves__feature_lines;

/* Adds one; false when memory is short. The point's index goes to *index. */
bool laves__feature_lines_add_point(laves__feature_lines *lines, laves__vec3 point, uint32_t *index);
bool laves__feature_lines_add_segment(laves__feature_lines *lines, const laves__feature_segment *segment);
bool laves__feature_lines_fix(laves__feature_lines *lines, uint32_t point, int32_t patch);
void laves__feature_lines_free(laves__feature_lines *lines);

/* ---- the features ---- */

typedef struct laves__crease {
  uint32_t first, count; /* its points: features->line[first .. first + count) */
  bool closed;           /* the last point is the first again */
  int32_t patch[2];      /* left and right; equal where a line was drawn on a patch, or a crease fades away */
  int32_t corner[2];     /* at the first and at the last point; LAVES__NO_FEATURE when closed */
  double length;
  double least_angle, most_angle; /* inside the solid, along it, degrees */
  bool drawn;
} laves__crease;

typedef struct laves__corner {
  laves__vec3 position;
  uint32_t first_crease, crease_count; /* features->corner_crease[first .. + count), ascending; a crease that comes twice: once */
  uint32_t end_count;                  /* ends of creases at it; a crease from it back to it has two */
  uint32_t first_patch, patch_count;   /* features->corner_patch[first .. + count), ascending: all around it */
  bool fixed;                          /* a tip, or drawn */
} laves__corner;

typedef struct laves__features {
  laves_context *context;
  const laves__oracle *oracle;
  int32_t patch_count;
  laves__crease *crease;
  size_t crease_count, crease_capacity;
  laves__corner *corner;
  size_t corner_count, corner_capacity;
  laves__vec3 *line; /* the points of all creases */
  size_t line_count, line_capacity;
  int32_t *corner_crease, *corner_patch;
  size_t corner_crease_capacity, corner_patch_capacity;
  laves__bvh tree;                      /* over the segments of all creases, as triangles of two equal corners */
  uint32_t *slot_crease, *slot_segment; /* [slot_count] the crease at each slot, and its segment's first point in `line` */
  size_t slot_count;

  /* Patches that go together though they are two: pairs, the lesser << 32 | the greater, ascending. */
  uint64_t *joined;
  size_t joined_pairs, joined_capacity;
  bool has_seams; /* creases with one patch on both sides */

  size_t dropped_count; /* creases that were too short, or lay amid others that were: noise */
  size_t joined_count;  /* gaps between creases that were closed */

  /* What the maker knows of its patches; `self` is its own, freed by free_self. */
  void *self;
  int32_t (*patch_at)(const void *self, laves__vec3 foot, uint32_t hint); /* of a point of the surface */
  /* As laves__oracle.project, on one patch only. hint: as there. */
  bool (*project_patch)(const void *self, int32_t patch, laves__vec3 point, double reach, uint32_t *hint, laves__vec3 *foot,
                        laves__vec3 *normal);
  /* Improves a point of a crease's polyline to one of the true crease, and the tangent; NULL: polylines are exact. */
  void (*refine)(const void *self, int32_t crease, laves__vec3 *foot, laves__vec3 *tangent);
  void (*free_self)(laves_context *context, void *self);
} laves__features;

/* What is to be found. */
typedef struct laves__feature_wish {
  double angle;                /* degrees by which the normal must jump; 0: nothing is found by itself */
  bool tags;                   /* lines between parts of the surface with different tags, too */
  const laves_features *drawn; /* the user's; NULL: none */
  double size;                 /* what is shorter is noise, unless drawn; units of the input */
} laves__feature_wish;

/* Finds the features of a domain. None is no error: then crease_count and corner_count are 0. Free whatever is returned.
 * LAVES_ERROR_INPUT (a drawn point or line is off the surface), LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__features_find(laves_context *context, const laves__oracle *oracle, const laves__feature_wish *wish,
                                  laves__features *features, laves_error *error);
void laves__features_free(laves__features *features);

/* Joins segments to creases and finds the corners; fills all but patches and callbacks. The lines are left to the caller. */
laves_result laves__features_chain(const laves__feature_lines *lines, const laves__feature_wish *wish, laves__features *features,
                                   laves_error *error);

/* The makers, which laves__oracle.find_features calls: patches, callbacks, and segments, for laves__features_find. */
laves_result laves__features_of_surface(const laves__feature_wish *wish, laves__features *features, laves__feature_lines *lines,
                                        laves_error *error);
/* What the user drew, on top of what the makers found. */
laves_result laves__features_drawn(const laves__feature_wish *wish, const laves__features *features, laves__feature_lines *lines,
                                   laves_error *error);

/* ---- questions ---- */

/* Whether vertices on two patches may share an edge: they are one, or parts of one that a crease has split. */
bool laves__patches_join(const laves__features *features, int32_t a, int32_t b);

/* The nearest point of a crease within reach, and the unit tangent along its points there. */
bool laves__crease_project(const laves__features *features, int32_t crease, laves__vec3 point, double reach, laves__vec3 *foot,
                           laves__vec3 *tangent);
/* The crease nearest to a point within reach, or LAVES__NO_FEATURE; foot and tangent as above. */
int32_t laves__crease_near(const laves__features *features, laves__vec3 point, double reach, laves__vec3 *foot,
                           laves__vec3 *tangent);

/* The same among creases that have `patch` on both sides. */
int32_t laves__seam_near(const laves__features *features, int32_t patch, laves__vec3 point, double reach, laves__vec3 *foot,
                         laves__vec3 *tangent);
/* The same among creases with `patch` on one side and a patch of `others` on the other; others NULL: any. */
int32_t laves__crease_between(const laves__features *features, int32_t patch, const int32_t *others, int other_count,
                              laves__vec3 point, double reach, laves__vec3 *foot);
/* The point of a crease at a way along it from its first (end 0) or last point (end 1); its other end where it is shorter. */
laves__vec3 laves__crease_point_at(const laves__features *features, int32_t crease, int end, double way);

#endif
