/* Shape of one tetrahedron from its corners.
 *
 * With the outward normals n_i of the faces opposite corner i, as long as twice the area, the dihedral angle at an edge
 * is the one between the faces opposite the two corners that are not on the edge: cos = - n_k . n_l / (|n_k| |n_l|).
 * With u, v, w from corner 0 and D = det[u, v, w] = 6 V, the circumcentre lies (|u|^2 v x w + |v|^2 w x u + |w|^2 u x v)
 * / (2 D) from corner 0, and the inradius is 3 V over the area. */
#include "mesh/quality.h"

#include "mesh/mesh.h"

#define REGULAR_RADIUS_EDGE 0.61237243569579452 /* sqrt(6) / 4 */
#define SQRT_2 1.4142135623730951

static void face_normals(const laves__vec3 p[4], laves__vec3 normals[4]) {
  for (int i = 0; i < 4; i++) {
    const uint8_t *f = laves__tet_face[i];
    normals[i] = v3_cross(v3_sub(p[f[1]], p[f[0]]), v3_sub(p[f[2]], p[f[0]]));
  }
}

void laves__tet_dihedral_cosines(const laves__vec3 p[4], double cosines[6]) {
  laves__vec3 normals[4];
  double inverse_norm[4];
  face_normals(p, normals);
  for (int i = 0; i < 4; i++) inverse_norm[i] = 1 / v3_norm(normals[i]);
  for (int i = 0; i < 6; i++) {
    const int k = laves__tet_edge[5 - i][0], l = laves__tet_edge[5 - i][1];
    cosines[i] = -v3_dot(normals[k], normals[l]) * inverse_norm[k] * inverse_norm[l];
  }
}

double laves__tet_volume_length(const laves__vec3 p[4]) {
  double squares = 0;
  for (int i = 0; i < 6; i++) squares += v3_norm2(v3_sub(p[laves__tet_edge[i][1]], p[laves__tet_edge[i][0]]));
  const double mean_square = squares / 6;
  if (!(mean_square > 0)) return 0;
  return SQRT_2 * v3_det(p[0], p[1], p[2], p[3]) / (mean_square * sqrt(mean_square));
}

/* Twice the determinant times the vector from corner 0 to the circumcentre; *determinant is 6 V. */
static laves__vec3 scaled_circumcentre(const laves__vec3 p[4], double *determinant) {
  const laves__vec3 u = v3_sub(p[1], p[0]), v = v3_sub(p[2], p[0]), w = v3_sub(p[3], p[0]);
  const laves__vec3 vw = v3_cross(v, w), wu = v3_cross(w, u), uv = v3_cross(u, v);
  *determinant = v3_dot(u, vw);
  return v3_add(v3_scale(vw, v3_norm2(u)), v3_add(v3_scale(wu, v3_norm2(v)), v3_scale(uv, v3_norm2(w))));
}

double laves__tet_radius_ratio(const laves__vec3 p[4]) {
  laves__vec3 normals[4];
  double determinant, twice_area = 0;
  const double offset = v3_norm(scaled_circumcentre(p, &determinant));
  face_normals(p, normals);
  for (int i = 0; i < 4; i++) twice_area += v3_norm(normals[i]);
  const double divisor = offset * twice_area;
  if (!(divisor > 0)) return 0;
  return 6 * determinant * fabs(determinant) / divisor;
}

double laves__tet_radius_edge(const laves__vec3 p[4]) {
  double determinant, shortest = INFINITY;
  const double offset = v3_norm(scaled_circumcentre(p, &determinant));
  for (int i = 0; i < 6; i++) shortest = fmin(shortest, v3_norm2(v3_sub(p[laves__tet_edge[i][1]], p[laves__tet_edge[i][0]])));
  const double divisor = 2 * fabs(determinant) * sqrt(shortest) * REGULAR_RADIUS_EDGE;
  return divisor > 0 ? offset / divisor : INFINITY;
}
