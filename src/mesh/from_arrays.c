/* A mesh from the caller's arrays: they are checked, copied, and the boundary faces are found.
 *
 * Indices out of range are refused here, because nothing in the library could work with them; everything else that may
 * be wrong (inverted, flat, doubled or repeated corners) is let through for laves_check_mesh() to tell. */
#include <string.h>

#include "base/predicates.h"
#include "mesh/face_match.h"

static laves_result check_indices(laves_context *context, const int32_t *tets, size_t tet_count, size_t vertex_count,
                                  laves_error *error) {
  for (size_t i = 0; i < 4 * tet_count; i++) {
    if (laves__cancelled_at(context, "boundary", i, 4 * tet_count)) return laves__fail_cancelled(error);
    if (tets[i] < 0 || (size_t)tets[i] >= vertex_count)
      return laves__fail(error, LAVES_ERROR_INPUT, "tetrahedron %zu uses vertex %ld, but the vertices are 0 to %ld", i / 4,
                         (long)tets[i], (long)vertex_count - 1);
  }
  return LAVES_OK;
}

/* The boundary faces, outwards even where a tet is inverted. False when cancelled. */
static bool copy_faces(laves_mesh *mesh, const uint64_t *slots) {
  for (size_t i = 0; i < mesh->face_count; i++) {
    if (laves__cancelled_at(mesh->context, "boundary", i, mesh->face_count)) return false;
    const int32_t *tet = mesh->tets[slots[i] / 4];
    const laves__vec3 *p = mesh->points;
    const int orientation = laves__orient3d(p[tet[0]], p[tet[1]], p[tet[2]], p[tet[3]]);
    laves__face_outwards(tet, (int)(slots[i] % 4), orientation, mesh->faces[i]);
  }
  return true;
}

laves_result laves_mesh_from_arrays(laves_context *context, const double *points, size_t vertex_count, const int32_t *tets,
                                    size_t tet_count, const int32_t *regions, laves_mesh **mesh, laves_error *error) {
  laves__progress_reset(context);
  *mesh = NULL;
  if (vertex_count > INT32_MAX)
    return laves__fail(error, LAVES_ERROR_INPUT, "%zu vertices are more than the %ld that indices can tell apart", vertex_count,
                       (long)INT32_MAX);
  laves_result result = check_indices(context, tets, tet_count, vertex_count, error);
  if (result != LAVES_OK) return result;

  uint64_t *slots = NULL;
  size_t face_count = 0;
  result =
      laves__boundary_slots(context, "boundary", (const int32_t(*)[4])tets, tet_count, vertex_count, &slots, &face_count, error);
  if (result != LAVES_OK) return result;
  laves_mesh *made = laves__mesh_create(context, vertex_count, tet_count, face_count, regions != NULL, false);
  if (!made) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  if (vertex_count) memcpy(made->points, points, vertex_count * sizeof *made->points);
  if (tet_count) memcpy(made->tets, tets, tet_count * sizeof *made->tets);
  if (regions && tet_count) memcpy(made->regions, regions, tet_count * sizeof *made->regions);
  if (copy_faces(made, slots)) {
    *mesh = made;
  } else {
    laves_mesh_free(made);
    result = laves__fail_cancelled(error);
  }
clean_up:
  laves__free(context, slots, face_count, sizeof *slots);
  return result;
}
