/* What the files of this folder share. Everything here starts from the arrays of a mesh and trusts none of them. */
#ifndef LAVES_CERTIFY_CERTIFY_H
#define LAVES_CERTIFY_CERTIFY_H

#include "domain/oracle.h"
#include "mesh/face_match.h"
#include "mesh/mesh.h"

/* A boundary as recomputed from the tets: triangles outwards, in the order of their tets. */
typedef struct laves__boundary {
  laves_context *context;
  size_t count;
  int32_t (*faces)[3];
} laves__boundary;

void laves__boundary_free(laves__boundary *boundary);

/* Indices, orientation, conformity, components, and the boundary; fills the fields of those names.
 * *boundary: owned by the caller on success. */
laves_result laves__check_topology(laves_context *context, const laves_mesh *mesh, laves_check *check, laves__boundary *boundary,
                                   laves_error *error);

/* Where a boundary is no manifold: the first of the edges and vertices that laves_check counts. */
typedef struct laves__faults {
  int32_t edges[LAVES_PLACE_CAPACITY][2];
  int32_t vertices[LAVES_PLACE_CAPACITY];
} laves__faults;

/* Edges, fans, components and genus of a boundary, and how many of the mesh's stored faces differ from it. */
laves_result laves__check_boundary(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                   laves_check *check, laves__faults *faults, laves_error *error);

/* Angles, ratios and volume. */
laves_result laves__check_shapes(laves_context *context, const laves_mesh *mesh, laves_check *check, laves_error *error);

/* Area of the boundary. */
laves_result laves__check_area(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                               laves_check *check, laves_error *error);

/* The boundary alone. */
laves_result laves__find_boundary(laves_context *context, const laves_mesh *mesh, laves__boundary *boundary, laves_error *error);

/* Shortest, longest and mean edge, each edge once. */
laves_result laves__check_edges(laves_context *context, const laves_mesh *mesh, laves_check *check, laves_error *error);

/* ---- local sizes ---- */

/* The smoothed length of the boundary's edges at each of its vertices, 0 at other vertices: float[vertex_count], for
 * laves__free(); NULL when memory is short. */
float *laves__local_edges(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary);
/* The same on a face of the boundary. */
double laves__local_edge(const float *edges, const int32_t face[3]);

/* The exponent of the power of two nearest to edge / base; 0 when either is not known. */
int laves__edge_level(double edge, double base);

/* ---- distances ---- */

/* One measured place, in the coordinates of the mesh. */
typedef struct laves__sample {
  laves__vec3 point;
  double distance; /* to the other side; NAN when none was found */
  double weight;   /* in means; 0 for samples that only look for the largest distance */
  int64_t vertex;  /* of the mesh; -1: a point of an edge or face, or of the surface */
  double slack;    /* the true distance is no larger than `distance` plus this; NAN: not known */
  float edge;      /* local edge of the boundary near by; 0: not known */
} laves__sample;

/* Samples in a fixed order: first [0, boundary_count) on the boundary of the mesh with their distances to the domain's surface,
 * then those on the surface with their distances to the boundary. */
typedef struct laves__samples {
  laves_context *context;
  laves__sample *items;
  size_t count, boundary_count, capacity;
  float *edges; /* [vertex_count] laves__local_edges() */
  size_t vertex_count;
  double spacing;                           /* mean edge of the boundary */
  double boundary_cover, surface_cover;     /* how far a point of that side can be from its nearest sample; NAN: unknown */
  double boundary_at_most, surface_at_most; /* no point of that side is further from the other; NAN: unknown */
} laves__samples;

void laves__samples_free(laves__samples *samples);

/* Measures both ways, about six samples a boundary face and five the area of a face, of the faces near by, of the surface.
 * *samples: owned by the caller on success. */
laves_result laves__measure_distances(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                      const laves_domain *domain, laves__samples *samples, laves_error *error);

/* Fills the distances of a check. *samples: owned by the caller on success. */
laves_result laves__check_distances(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                    const laves_domain *domain, laves_check *check, laves__samples *samples, laves_error *error);

/* The places where samples are further than a limit from the other side; see laves_check_distance(). The limit is `distance`
 * times the power of two nearest to the local edge over `base`, and places further beyond their limits come first; base 0: it is
 * the same everywhere. limits: out, double[capacity], or NULL. */
laves_result laves__distant_places(laves_context *context, const laves__samples *samples, const laves_domain *domain,
                                   double distance, double base, laves_place *places, double *limits, size_t capacity,
                                   size_t *count, laves_error *error);

/* How far a point of a triangle can be from the nearest of its corners. */
double laves__corner_cover(laves__vec3 a, laves__vec3 b, laves__vec3 c);

struct laves__boundary_tree;

/* A sample of a surface, and the share of the surface that it stands for, up to a common factor. */
typedef struct laves__domain_sample {
  laves__vec3 point;
  double weight;
} laves__domain_sample;

/* Samples of a domain's surface (local coordinates), about `spacing` apart times the power of two that the tree tells of the
 * edges near by, for domains that offer none themselves. Returns how many, at most `capacity`; none when the search would
 * cost too much at that spacing. */
size_t laves__sample_surface(laves_context *context, const laves__oracle *oracle, const struct laves__boundary_tree *tree,
                             double spacing, laves__domain_sample *samples, size_t capacity);

/* The smallest radius of curvature of the domain's surface within about `reach` of a point (coordinates of the mesh),
 * seen at that scale; INFINITY where it is flat or absent. */
double laves__curvature_radius(const laves_domain *domain, laves__vec3 point, double reach);

/* Sets the place of a tet, and how bent the surface is there, at the scale of its longest edge. domain: NULL: that is left as it
 * is. */
void laves__place_of_tet(const laves__vec3 p[4], const laves_domain *domain, laves_place *place);

/* ---- all of a check ---- */

/* What a check leaves for others to look into. */
typedef struct laves__survey {
  laves__boundary boundary;
  laves__faults faults;
  laves__samples samples; /* empty without a domain */
} laves__survey;

/* laves_check_mesh(), with its findings. *survey: owned by the caller on success. */
laves_result laves__survey_mesh(laves_context *context, const laves_mesh *mesh, const laves_domain *domain, laves_check *check,
                                laves__survey *survey, laves_error *error);
void laves__survey_free(laves__survey *survey);

/* Whether nothing that a check counts is wrong. */
bool laves__check_is_valid(const laves_check *check);

/* ---- certificates ---- */

/* The hash of points and tets, as mesh_digest.c defines it. */
laves_result laves__mesh_digest(laves_context *context, const laves_mesh *mesh, char text[LAVES_HASH_CAPACITY],
                                laves_error *error);

/* Counts the tets that are exact tiles by their shape; fills the members lattice_... and bcc_tets. */
laves_result laves__find_tiles(laves_context *context, const laves_mesh *mesh, laves_certificate *certificate,
                               laves_error *error);

struct laves__feature_findings;

/* Fills the exceptions, and what they say of the windows. The certificate's check, windows, features and size are filled.
 * features: NULL: none were looked for. */
laves_result laves__list_exceptions(laves_context *context, const laves_mesh *mesh, const laves_domain *domain,
                                    const laves__survey *survey, const struct laves__feature_findings *features,
                                    laves_certificate *certificate, laves_error *error);

/* ---- tets and boundaries ---- */

/* The corners of a tet; false when it has none that can be measured (bad indices, or points that are not finite). */
static inline bool laves__tet_corners(const laves_mesh *mesh, size_t tet, laves__vec3 corners[4]) {
  const int32_t *t = mesh->tets[tet];
  if (!laves__tet_usable(t, mesh->vertex_count)) return false;
  for (int i = 0; i < 4; i++) corners[i] = mesh->points[t[i]];
  return v3_finite(corners[0]) && v3_finite(corners[1]) && v3_finite(corners[2]) && v3_finite(corners[3]);
}

/* ---- sorting ---- */

typedef struct laves__keyed {
  uint64_t key, value;
} laves__keyed;

/* Sorts by key, keeping the order of equal keys; `scratch` has room for as many.
 * context: asked whether to cancel; then the order is none and the result false. NULL: it is not asked. */
bool laves__sort_keyed(laves_context *context, laves__keyed *items, laves__keyed *scratch, size_t count);

#endif
