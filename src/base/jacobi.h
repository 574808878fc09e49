/* Eigenvalues of small symmetric matrices, one classical rotation at a time. */
#ifndef LAVES_BASE_JACOBI_H
#define LAVES_BASE_JACOBI_H

#include <math.h>

/* Turns the entries (p, q) and (q, p) of a symmetric matrix to zero; the eigenvalues stay. The rotation's cosine and sine, 1 and
 * 0 when there was nothing to turn, are for the caller's eigenvectors. */
static inline void laves__jacobi_rotate(double m[3][3], int p, int q, double *cosine, double *sine) {
  *cosine = 1;
  *sine = 0;
  if (m[p][q] == 0) return;
  const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
  const double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
  const double c = 1 / sqrt(t * t + 1), s = t * c;
  for (int k = 0; k < 3; k++) {
    const double a = m[k][p], b = m[k][q];
    m[k][p] = c * a - s * b;
    m[k][q] = s * a + c * b;
  }
  for (int k = 0; k < 3; k++) {
    const double a = m[p][k], b = m[q][k];
    m[p][k] = c * a - s * b;
    m[q][k] = s * a + c * b;
  }
  *cosine = c;
  *sine = s;
}

#endif
