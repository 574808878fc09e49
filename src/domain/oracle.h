/* The oracle: what classify, snap and improve may ask of a domain, whatever it is made of.
 *
 * Coordinates are local to the domain: input coordinates minus `origin`, so that a part a kilometre from the zero point
 * loses no digits. All functions are pure, read only, safe from many threads, and deterministic. */
#ifndef LAVES_DOMAIN_ORACLE_H
#define LAVES_DOMAIN_ORACLE_H

#include "base/base.h"
#include "base/vec3.h"

typedef enum laves__side { LAVES__OUTSIDE = 1, LAVES__UNDECIDED = 0, LAVES__INSIDE = -1 } laves__side;

/* No hint: any query may start cold. */
#define LAVES__NO_HINT UINT32_MAX

/* The answer of a projection. */
typedef struct laves__projection {
  laves__vec3 foot, normal; /* undefined where none was found */
  uint32_t hint;            /* before: to start from; after: of the foot */
  bool found;
} laves__projection;

struct laves__feature_wish;
struct laves__features;
struct laves__feature_lines;

typedef struct laves__oracle {
  void *self;
  laves__vec3 origin; /* input coordinates of the local zero point */
  laves__box3 bounds; /* local; contains the surface, tightly where it can */
  bool is_distance;   /* |phi| is the distance to the surface (to 1e-6 relative), so balls of that radius hold none */
  double volume;      /* exact, or NAN */
  double area;        /* exact, or NAN */

  /* phi[i] at points[i], negative inside. Points of one call should lie near one another. hints, unless NULL, receives
   * for each point what `project` can start from (the nearest feature), or LAVES__NO_HINT; before the call hints[0] holds what is
   * known of a point near the first, or LAVES__NO_HINT, which makes it quicker and changes no value. */
  void (*evaluate)(const void *self, size_t count, const laves__vec3 *points, double *phi, uint32_t *hints);

  /* A point of the surface {phi = 0} nearest to `point` (for implicit solids: near it, found by Newton steps along the
   * gradient), its outward unit normal, and a new hint. *hint may be LAVES__NO_HINT. `reach` is the distance beyond which
   * the caller has no use for the answer. False when none was found within reach; outputs then undefined. */
  bool (*project)(const void *self, laves__vec3 point, double reach, uint32_t *hint, laves__vec3 *foot, laves__vec3 *normal);

  /* The same for many points, with the same answers; NULL: they are projected one by one. */
  void (*project_many)(const void *self, size_t count, const laves__vec3 *points, double reach, laves__projection *answers);

  /* As many points as a call of these two had best have where more can be asked at once, since a call has a price of its own
   * (a callback); 0: it is all the same, and points that are near one another do better. */
  size_t batch;

  /* Which side the whole ball (centre, radius) and the whole box (centre +- half) lie on; either may be used, both contain
   * the region that the caller means. UNDECIDED is always a correct answer; the others are certain. */
  laves__side (*side)(const void *self, laves__vec3 centre, double radius, laves__vec3 half);

  /* Tag of the surface at a foot given by `project` and its hint; NULL: no tags. */
  int32_t (*tag)(const void *self, laves__vec3 foot, uint32_t hint);

  /* The same for the face of the input file, from 0, that the foot lies on; -1: on none (in a hole that was closed).
   * NULL: the domain is not made of faces. */
  int32_t (*source)(const void *self, laves__vec3 foot, uint32_t hint);

  /* The named region that a point inside is in; NULL: no regions are named. */
  int32_t (*region)(const void *self, laves__vec3 point);

  /* Deterministic samples of the surface, spaced by about `spacing`, at most `capacity` of them into points; returns
   * how many there are. NULL: not available. */
  size_t (*sample)(const void *self, double spacing, laves__vec3 *points, size_t capacity);

  /* Where the surface is made of flat faces, all of which bound the solid: their number, and the corners of each.
   * 0 and NULL: it is not. */
  size_t flat_face_count;
  void (*flat_face)(const void *self, size_t face, laves__vec3 corners[3]);

  /* Where the surface is made of triangles, whether or not all of them bound the solid: they; see surface.h. Else NULL. */
  const struct laves__surface *surface;

  /* Up to `capacity` thin walls or gaps, thinnest first; without memory none, and places[0].thickness is NAN. NULL: not
   * available. */
  size_t (*thin_places)(const void *self, laves_thin_kind kind, laves_thin_place *places, size_t capacity);

  /* Patches, and segments of creases, as features.h tells; NULL: the surface is one smooth patch as far as is known.
   * features->oracle and context are set. */
  laves_result (*find_features)(const struct laves__feature_wish *wish, struct laves__features *features,
                                struct laves__feature_lines *lines, laves_error *error);

  /* Points and lines to keep that come with the domain, in input coordinates; NULL: none. */
  const struct laves_features *drawn;

  void (*free)(laves_context *context, void *self);
} laves__oracle;

/* Projects many points, in one call or one by one; answers[i].hint must be set. */
void laves__project_many(const laves__oracle *oracle, size_t count, const laves__vec3 *points, double reach,
                         laves__projection *answers);

/* The public handle. */
struct laves_domain {
  laves_context *context;
  laves__oracle oracle;
  laves_domain_info info; /* in input coordinates */
  char format[48];
  char input_hash[LAVES_HASH_CAPACITY]; /* SHA-256 of the bytes it was made from; empty when they are the caller's arrays */
  char **tag_names;                     /* info.tag_count of them, each allocated with its length + 1 */
  char **region_names;
  int region_count;
};

/* Makers, one file each; they fill oracle, info, format and tags of a zeroed domain. */

/* Triangles as read: polygons already fanned; see surface_input.h. Takes the content of `input` over. options: NULL: defaults. */
struct laves__surface_input;
laves_result laves__surface_build(laves_context *context, struct laves__surface_input *input,
                                  const laves_surface_options *options, laves_domain *domain, laves_error *error);

/* Whether they are the caller's to use: LAVES_OK, LAVES_ERROR_OPTION. */
laves_result laves__surface_options_check(const laves_surface_options *options, laves_error *error);

/* A Lua chunk; `is_expression`: "return " is put in front. `name` for messages; `folder`: where surface leaves are
 * looked for when their path is relative (NULL: the current folder). */
laves_result laves__implicit_build(laves_context *context, const char *text, size_t length, bool is_expression, const char *name,
                                   const char *folder, laves_domain *domain, laves_error *error);

laves_result laves__function_build(laves_context *context, const laves_function *function, laves_domain *domain,
                                   laves_error *error);
/* How many values of a caller's function were no numbers since it became a domain, and the least of the places by x, y and z, in
 * input coordinates. 0 for domains of other kinds. */
size_t laves__function_gaps(const laves_domain *domain, laves__vec3 *place);

#endif
