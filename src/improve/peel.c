/* Peeling: in walls thinner than the size some tets between the two surfaces stay flat whatever is done. One that borders
 * on the outside can be taken away.
 *
 *   boundary faces   allowed when                                  what happens
 *   4                always                                        a tet by itself is gone
 *   3                always                                        the corner between the three goes with it
 *   2                the edge between the other two faces is       that edge becomes a boundary edge
 *                    inside the mesh
 *   1                never: the corner opposite is on the boundary already and would be touched twice
 */
#include "improve/peel.h"

#include "improve/guard.h"
#include "mesh/mesh.h"

/* Whether an edge lies on the boundary; all its ends are on the surface, so their stars are known. */
static bool is_boundary_edge(const laves__layer *layer, int32_t a, int32_t b) {
  const laves__star *star = &layer->star[a];
  for (int i = 0; i < star->count; i++) {
    const int32_t t = star->tet[i];
    if (laves__layer_corner(layer, t, b) < 0) continue;
    for (int k = 0; k < 4; k++)
      if (layer->tet[t][k] != a && layer->tet[t][k] != b && laves__layer_is_boundary_face(layer, t, k)) return true;
  }
  return false;
}

/* Whether creases and corners stand without the tet: no vertex of them goes, no edge of theirs comes to lie inside the boundary's
 * faces, and new faces have a patch. */
static bool keeps_features(const laves__frame *frame, const laves__layer *layer, int32_t tet, int outer_count, const int inner[4],
                           int inner_count) {
  const int32_t *corner = layer->tet[tet];
  if (!layer->hold) return true;
  if (outer_count == 3 && laves__layer_hold(layer, corner[inner[0]]).kind >= LAVES__HOLD_CREASE) return false;
  if (outer_count == 2 && laves__is_crease_edge(frame, layer, corner[inner[0]], corner[inner[1]])) return false;
  for (int i = 0; i < inner_count && outer_count < 4; i++) {
    laves__hold hold[3];
    for (int j = 0; j < 3; j++) hold[j] = layer->hold[corner[laves__tet_face[inner[i]][j]]];
    if (!laves__face_is_legal(frame->features, hold)) return false;
  }
  for (int i = 0; i < 4 && outer_count == 4; i++)
    if (layer->hold[corner[i]].kind >= LAVES__HOLD_CREASE) return false;
  return true;
}

bool laves__peel_tet(const laves__frame *frame, laves__layer *layer, int32_t tet) {
  const int32_t *corner = layer->tet[tet];
  int outer[4], outer_count = 0, inner[4], inner_count = 0;
  for (int k = 0; k < 4; k++)
    if (layer->depth[corner[k]] != 0) return false;
  for (int k = 0; k < 4; k++) {
    if (laves__layer_is_boundary_face(layer, tet, k))
      outer[outer_count++] = k;
    else
      inner[inner_count++] = k;
  }
  if (outer_count < 2) return false;
  /* The two inner faces share the edge between the corners opposite the outer ones. */
  if (outer_count == 2 && is_boundary_edge(layer, corner[outer[0]], corner[outer[1]])) return false;
  /* Where three faces are outer, their common corner must have no other tet; where a vertex is parted it may. */
  if (outer_count == 3 && layer->star[corner[inner[0]]].count != 1) return false;
  if (!keeps_features(frame, layer, tet, outer_count, inner, inner_count)) return false;
  for (int k = 0; k < 4; k++) laves__star_remove(&layer->star[corner[k]], tet);
  layer->tet[tet][0] = -1;
  return true;
}
