/* The boundary of an untrusted mesh, where nothing else is wanted. */
#include "base/predicates.h"
#include "certify/certify.h"
#include "mesh/face_match.h"

void laves__boundary_free(laves__boundary *boundary) {
  if (boundary->context) laves__free(boundary->context, boundary->faces, boundary->count, sizeof *boundary->faces);
  *boundary = (laves__boundary){0};
}

laves_result laves__find_boundary(laves_context *context, const laves_mesh *mesh, laves__boundary *boundary, laves_error *error) {
  uint64_t *slots;
  size_t count;
  *boundary = (laves__boundary){0};
  laves_result result = laves__boundary_slots(context, "check", (const int32_t(*)[4])mesh->tets, mesh->tet_count,
                                              mesh->vertex_count, &slots, &count, error);
  if (result != LAVES_OK) return result;
  int32_t(*faces)[3] = laves__alloc(context, count, sizeof *faces);
  if (!faces) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  for (size_t i = 0; i < count; i++) {
    const size_t tet = slots[i] / 4;
    laves__vec3 p[4];
    const int orientation = laves__tet_corners(mesh, tet, p) ? laves__orient3d(p[0], p[1], p[2], p[3]) : 0;
    laves__face_outwards(mesh->tets[tet], (int)(slots[i] % 4), orientation, faces[i]);
  }
  *boundary = (laves__boundary){context, count, faces};
clean_up:
  laves__free(context, slots, count, sizeof *slots);
  return result;
}
