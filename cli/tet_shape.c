/* The shape of one tetrahedron: angles and ratios, normalised so that the regular one has 1. What is drawn is looked at, not
 * decided by, so plain floating point suffices here; what judges meshes is the library's own (laves_check_mesh). */
#include "tet_shape.h"

#include <math.h>
#include <string.h>

const int tet_face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

static const double pi = 3.14159265358979323846;

static void subtract(const double a[3], const double b[3], double out[3]) {
  for (int i = 0; i < 3; i++) {
    out[i] = a[i] - b[i];
  }
}

static void cross(const double a[3], const double b[3], double out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void tet_corners(const laves_mesh *mesh, int64_t tet, double p[4][3]) {
  for (int k = 0; k < 4; k++) {
    memcpy(p[k], laves_mesh_points(mesh) + 3 * laves_mesh_tets(mesh)[4 * tet + k], sizeof p[k]);
  }
}

/* Normals of the faces, as long as twice their areas. */
static void face_normals(double p[4][3], double normals[4][3]) {
  for (int f = 0; f < 4; f++) {
    double u[3], v[3];
    subtract(p[tet_face[f][1]], p[tet_face[f][0]], u);
    subtract(p[tet_face[f][2]], p[tet_face[f][0]], v);
    cross(u, v, normals[f]);
  }
}

void tet_dihedral_angles(double p[4][3], double angles[6]) {
  double normals[4][3];
  int count = 0;
  face_normals(p, normals);
  for (int a = 0; a < 4; a++) {
    for (int b = a + 1; b < 4; b++) {
      double c = -dot(normals[a], normals[b]) / sqrt(dot(normals[a], normals[a]) * dot(normals[b], normals[b]));
      angles[count++] = acos(fmax(-1, fmin(1, c))) * 180 / pi;
    }
  }
}

double tet_dihedral_score(double p[4][3]) {
  double angles[6], smallest = 180, largest = 0;
  tet_dihedral_angles(p, angles);
  for (int i = 0; i < 6; i++) {
    smallest = fmin(smallest, angles[i]);
    largest = fmax(largest, angles[i]);
  }
  return fmax(0, fmin(1, fmin(smallest / 60, (180 - largest) / 105)));
}

/* The smallest and the mean squared edge. */
static void squared_edges(double p[4][3], double *least, double *mean) {
  double edge[3];
  *least = INFINITY;
  *mean = 0;
  for (int a = 0; a < 4; a++) {
    for (int b = a + 1; b < 4; b++) {
      subtract(p[b], p[a], edge);
      *least = fmin(*least, dot(edge, edge));
      *mean += dot(edge, edge) / 6;
    }
  }
}

double tet_edge_length(double p[4][3]) {
  double least, mean;
  squared_edges(p, &least, &mean);
  return sqrt(mean);
}

/* Six times the volume. */
static double determinant(double p[4][3]) {
  double u[3], v[3], w[3], n[3];
  subtract(p[1], p[0], u);
  subtract(p[2], p[0], v);
  subtract(p[3], p[0], w);
  cross(u, v, n);
  return dot(n, w);
}

double tet_volume_length(double p[4][3]) { return fmax(0, sqrt(2) * determinant(p) / pow(tet_edge_length(p), 3)); }

/* R = |u^2 (v x w) + v^2 (w x u) + w^2 (u x v)| / (2 det), edges from corner 0. */
static double circumradius(double p[4][3]) {
  double edges[3][3], sum[3] = {0, 0, 0}, n[3];
  for (int i = 0; i < 3; i++) {
    subtract(p[i + 1], p[0], edges[i]);
  }
  for (int i = 0; i < 3; i++) {
    cross(edges[(i + 1) % 3], edges[(i + 2) % 3], n);
    for (int k = 0; k < 3; k++) {
      sum[k] += dot(edges[i], edges[i]) * n[k];
    }
  }
  return sqrt(dot(sum, sum)) / fabs(2 * determinant(p));
}

double tet_radius_ratio(double p[4][3]) {
  double normals[4][3], twice_area = 0, volume6 = determinant(p);
  face_normals(p, normals);
  for (int f = 0; f < 4; f++) {
    twice_area += sqrt(dot(normals[f], normals[f]));
  }
  /* r = 3 V / area. */
  return volume6 > 0 ? 3 * (volume6 / twice_area) / circumradius(p) : 0;
}

double tet_radius_edge(double p[4][3]) {
  static const double regular = 0.61237243569579452; /* sqrt(6) / 4 */
  double least, mean;
  squared_edges(p, &least, &mean);
  return determinant(p) != 0 ? circumradius(p) / (sqrt(least) * regular) : INFINITY;
}
