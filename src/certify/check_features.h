/* What the files share that hold a mesh against the features of its domain, and what they find.
 *
 *   check_features.c      the story: edges of the boundary -> which of them lie on creases -> the three below -> lists of places
 *   check_creases.c       from the domain to the mesh: creases, corners
 *   check_sharp_edges.c   from the mesh to the domain: sharp edges, faces across creases
 *   check_edge_angles.c   dihedral angles at creases and away from them */
#ifndef LAVES_CERTIFY_CHECK_FEATURES_H
#define LAVES_CERTIFY_CHECK_FEATURES_H

#include "certify/boundary_edges.h"
#include "certify/certify.h"
#include "domain/features.h"

/* What is known of a vertex of the mesh, as bits. */
enum {
  LAVES__TOUCHES = 1,       /* within the tolerance of a crease or corner */
  LAVES__TOUCHES_SHARP = 2, /* of a crease sharper than 70 degrees */
};

/* What was found of a crease of the domain. */
typedef struct laves__crease_finding {
  double distance; /* the largest of its samples to a boundary edge */
  laves__vec3 place;
  double local_edge; /* mean of the boundary's edges near by; 0: not known */
  double sampled;    /* length that its samples stand for */
  double sum;        /* of distance times length */
  double kept;       /* of that, within the tolerance of edges that run along creases */
  bool is_short, is_kept;
  double least_dihedral; /* of tets at edges that lie on it; INFINITY: none */
  int64_t tet;
} laves__crease_finding;

/* A growing list of places. */
typedef struct laves__feature_places {
  laves_feature_place *items;
  size_t count, capacity;
} laves__feature_places;

typedef struct laves__feature_findings {
  laves_context *context;
  const laves_mesh *mesh;
  const laves__boundary *boundary;
  const laves__oracle *oracle;
  const laves__features *features; /* the caller's */
  laves_feature_check *check;
  laves__boundary_edges edges;
  uint8_t *touch;                /* [mesh->vertex_count] */
  bool *runs_along;              /* [edges.count] both ends are within the tolerance of creases */
  int32_t *edge_crease;          /* [edges.count] the crease on which a whole edge lies, or LAVES__NO_FEATURE */
  laves__crease_finding *crease; /* [features->crease_count] */
  laves__feature_places places[LAVES_FEATURE_FAULT_COUNT]; /* in the end worst first */
} laves__feature_findings;

/* Whether options came from their maker and are in range. */
laves_result laves__check_feature_options(const laves_feature_options *options, laves_error *error);

/* The features of a domain as the options ask for them. *features: free whatever is returned. */
laves_result laves__find_features_for(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                      const laves__oracle *oracle, const laves_feature_options *options,
                                      laves__features *features, laves_error *error);

/* Measures a mesh against features that are known, by the options' angle and tolerance (0: as told there). boundary: of the
 * mesh; it, mesh and features must outlive the findings. *findings: free whatever is returned. */
laves_result laves__check_features_of(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                      const laves__features *features, const laves_feature_options *options,
                                      laves_feature_check *check, laves__feature_findings *findings, laves_error *error);
void laves__feature_findings_free(laves__feature_findings *findings);

/* Adds a place whose members are NAN and -1 but for those given; NULL when memory is short. */
laves_feature_place *laves__feature_place_add(laves__feature_findings *f, laves_feature_fault fault, laves__vec3 local);

/* The steps. */
laves_result laves__check_creases(laves__feature_findings *f, laves_error *error);
laves_result laves__check_corners(laves__feature_findings *f, laves_error *error);
laves_result laves__check_sharp_edges(laves__feature_findings *f, laves_error *error);
laves_result laves__check_straddling(laves__feature_findings *f, laves_error *error);
laves_result laves__check_edge_angles(laves__feature_findings *f, laves_error *error);
laves_result laves__check_sharp_creases(laves__feature_findings *f, laves_error *error);

/* The least angle inside the solid, in degrees, of the creases on which an edge of a tet lies; NAN: none does. */
double laves__feature_angle_at(const laves__feature_findings *f, int64_t tet);

#endif
