/* The check of a mesh: everything that laves_check says, recomputed from the arrays alone.
 *
 * It shares the search for equal faces and the measures of a tet with the rest of the library, and nothing with the
 * stages that make meshes. Garbage is expected: indices are tested before use, and points need not be finite. */
#include <string.h>

#include "certify/certify.h"

bool laves__check_is_valid(const laves_check *check) {
  return check->bad_indices == 0 && check->inverted_tets == 0 && check->nonconforming_faces == 0 &&
         check->nonmanifold_edges == 0 && check->nonmanifold_vertices == 0;
}

void laves__survey_free(laves__survey *survey) {
  laves__samples_free(&survey->samples);
  laves__boundary_free(&survey->boundary);
}

laves_result laves__survey_mesh(laves_context *context, const laves_mesh *mesh, const laves_domain *domain, laves_check *check,
                                laves__survey *survey, laves_error *error) {
  const laves_result held = laves__mesh_require_arrays(mesh, "a check", error);
  if (held != LAVES_OK) return held;
  laves__progress_reset(context);
  memset(check, 0, sizeof *check);
  memset(survey, 0, sizeof *survey);
  check->vertices = mesh->vertex_count;
  check->tets = mesh->tet_count;
  check->faces = mesh->face_count;
  check->domain_volume = NAN;

  laves__boundary *boundary = &survey->boundary;
  laves_result result = laves__check_topology(context, mesh, check, boundary, error);
  if (result == LAVES_OK) result = laves__check_boundary(context, mesh, boundary, check, &survey->faults, error);
  if (result == LAVES_OK) result = laves__check_shapes(context, mesh, check, error);
  if (result == LAVES_OK) result = laves__check_area(context, mesh, boundary, check, error);
  if (result == LAVES_OK) result = laves__check_edges(context, mesh, check, error);
  if (result == LAVES_OK && domain)
    result = laves__check_distances(context, mesh, boundary, domain, check, &survey->samples, error);
  if (result != LAVES_OK) laves__survey_free(survey);
  check->valid = result == LAVES_OK && laves__check_is_valid(check);
  return result;
}

laves_result laves_check_mesh(laves_context *context, const laves_mesh *mesh, const laves_domain *domain, laves_check *check,
                              laves_error *error) {
  laves__survey survey;
  const laves_result result = laves__survey_mesh(context, mesh, domain, check, &survey, error);
  if (result == LAVES_OK) laves__survey_free(&survey);
  return result;
}
