/* What a report shows of each tetrahedron: its angles and ratios, which tile it is, and how often each value occurs.
 *
 * The formulas are those of laves_check; what is drawn and counted here must agree with the certificate beside it, and a test
 * compares them. Tiles are told by the squares of their edges, as the certificate counts them (src/certify/lattice_shapes.c): in
 * quarters of the lattice's unit those of C15 are 8, 11 and 12, those of BCC 12 and 16. */
#include "report_shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "interrupt.h"

#define DEGREES 57.295779513082323
#define REGULAR_RADIUS_EDGE 0.61237243569579452 /* sqrt(6) / 4 */
/* Mean edge of the tiling over its quarter unit: (48 sqrt 8 + 96 sqrt 11 + 16 sqrt 12) / 160. */
#define MEAN_EDGE 3.184913173150872
/* An angle this little below a bin's lower edge belongs there: exact tiles have angles of 60 degrees but for rounding. */
#define BIN_SLACK 1e-9

/* Edges 01 02 03 12 13 23: edge i is opposite 5 - i. */
static const int edge_ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

bool report_tet_corners(const laves_mesh *mesh, size_t tet, double p[4][3]) {
  const size_t vertex_count = laves_mesh_vertex_count(mesh);
  for (int k = 0; k < 4; ++k) {
    const int32_t v = laves_mesh_tets(mesh)[4 * tet + (size_t)k];
    if (v < 0 || (size_t)v >= vertex_count) return false;
    memcpy(p[k], laves_mesh_points(mesh) + 3 * (size_t)v, sizeof p[k]);
  }
  return true;
}

static void cross(const double a[3], const double b[3], double out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static double angle_between(const double a[3], const double b[3]) {
  const double cosine = -dot(a, b) / sqrt(dot(a, a) * dot(b, b));
  return acos(cosine > 1 ? 1 : cosine < -1 ? -1 : cosine) * DEGREES;
}

/* Outward normals of the four faces, face i opposite corner i, of twice its area. */
static void face_normals(double p[4][3], double normals[4][3]) {
  static const int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  for (int f = 0; f < 4; ++f) {
    double u[3], v[3];
    for (int i = 0; i < 3; ++i) {
      u[i] = p[faces[f][1]][i] - p[faces[f][0]][i];
      v[i] = p[faces[f][2]][i] - p[faces[f][0]][i];
    }
    cross(u, v, normals[f]);
  }
}

/* 3 r / R and R / shortest edge over the regular one's. */
static void measure_radii(double p[4][3], double normals[4][3], const double squares[6], double *ratio, double *edge) {
  double e[3][3], areas = 0, offset[3] = {0}, vw[3], wu[3], uv[3], shortest = INFINITY;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) e[k][i] = p[k + 1][i] - p[0][i];
  cross(e[1], e[2], vw);
  cross(e[2], e[0], wu);
  cross(e[0], e[1], uv);
  for (int i = 0; i < 3; ++i) offset[i] = squares[0] * vw[i] + squares[1] * wu[i] + squares[2] * uv[i];
  for (int f = 0; f < 4; ++f) areas += sqrt(dot(normals[f], normals[f]));
  for (int i = 0; i < 6; ++i) shortest = fmin(shortest, squares[i]);
  const double determinant = dot(e[0], vw), length = sqrt(dot(offset, offset));
  const double by_area = length * areas, by_edge = 2 * fabs(determinant) * sqrt(shortest) * REGULAR_RADIUS_EDGE;
  *ratio = by_area > 0 ? 6 * determinant * fabs(determinant) / by_area : NAN;
  *edge = by_edge > 0 ? length / by_edge : NAN;
}

static void count_in(size_t *bins, int bin_count, double place) {
  if (!isfinite(place)) return;
  const double last = bin_count - 1;
  ++bins[(int)(place < 0 ? 0 : place > last ? last : place)];
}

static bool close_to(double a, double b, double tolerance) { return fabs(a - b) <= tolerance * b; }

/* Whether squares, times `scale`, are of the one tile of BCC: two opposite ones 16, the others 12. */
static bool is_bcc_tile(const double squares[6], double scale, double tolerance) {
  int pairs = 0;
  for (int i = 0; i < 3; ++i) {
    const double a = squares[i] * scale, b = squares[5 - i] * scale;
    if (close_to(a, 16, tolerance) && close_to(b, 16, tolerance)) {
      ++pairs;
    } else if (!close_to(a, 12, tolerance) || !close_to(b, 12, tolerance)) {
      return false;
    }
  }
  return pairs == 1;
}

/* Whether squares, times `scale`, are of a tile of C15: six of 8; three of 8 round a face and three of 11 at its apex; one of 12
 * opposite one of 8, and four of 11. */
static bool is_c15_tile(const double squares[6], double scale, double tolerance) {
  static const int apex[4][3] = {{0, 1, 2}, {0, 3, 4}, {1, 3, 5}, {2, 4, 5}}; /* the edges of each corner */
  int kinds[6], shorts = 0, longs = 0, at = 0;
  for (int i = 0; i < 6; ++i) {
    const double square = squares[i] * scale;
    kinds[i] = close_to(square, 8, tolerance)    ? 8
               : close_to(square, 11, tolerance) ? 11
               : close_to(square, 12, tolerance) ? 12
                                                 : 0;
    if (kinds[i] == 0) return false;
    shorts += kinds[i] == 8;
    longs += kinds[i] == 12;
    if (kinds[i] == 12) at = i;
  }
  if (longs == 1) return shorts == 1 && kinds[5 - at] == 8;
  if (longs > 1 || shorts != 3) return longs == 0 && shorts == 6;
  for (int c = 0; c < 4; ++c)
    if (kinds[apex[c][0]] == 11 && kinds[apex[c][1]] == 11 && kinds[apex[c][2]] == 11) return true;
  return false;
}

/* Whether one square of a unit is the other times a power of four. */
static bool is_alike(double unit2, double base2, double tolerance) {
  int exponent;
  if (!(base2 > 0)) return false;
  (void)frexp(2 * unit2 / base2, &exponent);
  return close_to(unit2, ldexp(base2, 2 * ((exponent - 1) >> 1)), tolerance);
}

static report_class class_of(const double squares[6], double unit2, double tolerance) {
  double least = INFINITY;
  for (int i = 0; i < 6; ++i) least = fmin(least, squares[i]);
  if (!(least > 0)) return REPORT_LAYER;
  if (is_alike(least / 8, unit2, tolerance) && is_c15_tile(squares, 8 / least, tolerance)) return REPORT_TILE;
  if (is_alike(least / 12, unit2, tolerance) && is_bcc_tile(squares, 12 / least, tolerance)) return REPORT_BCC_TILE;
  return REPORT_LAYER;
}

static void measure(report_shapes *out, size_t tet, double p[4][3], double unit2, double tolerance) {
  double normals[4][3], squares[6], least = INFINITY, most = -INFINITY, ratio, edge;
  for (int i = 0; i < 6; ++i) {
    double e[3];
    for (int k = 0; k < 3; ++k) e[k] = p[edge_ends[i][1]][k] - p[edge_ends[i][0]][k];
    squares[i] = dot(e, e);
  }
  face_normals(p, normals);
  double angles[6];
  bool whole = true;
  for (int i = 0; i < 6; ++i) {
    angles[i] = angle_between(normals[edge_ends[i][0]], normals[edge_ends[i][1]]);
    whole = whole && isfinite(angles[i]);
  }
  for (int i = 0; whole && i < 6; ++i) {
    count_in(out->dihedrals, DIHEDRAL_BINS, angles[i] + BIN_SLACK);
    least = fmin(least, angles[i]);
    most = fmax(most, angles[i]);
  }
  measure_radii(p, normals, squares, &ratio, &edge);
  count_in(out->ratios, RATIO_BINS, (ratio + BIN_SLACK) * RATIO_BINS);
  count_in(out->edges, EDGE_BINS, (edge - 1 + BIN_SLACK) / 0.02);
  out->min_dihedral[tet] = (float)(whole ? least : NAN);
  out->max_dihedral[tet] = (float)(whole ? most : NAN);
  out->radius_ratio[tet] = (float)ratio;
  out->radius_edge[tet] = (float)edge;
  out->classes[tet] = (uint8_t)class_of(squares, unit2, tolerance);
}

bool report_shapes_make(const laves_mesh *mesh, const laves_certificate *certificate, report_shapes *out) {
  const size_t count = laves_mesh_tet_count(mesh);
  const double unit = certificate->lattice_size / MEAN_EDGE;
  *out = (report_shapes){.count = count};
  out->min_dihedral = malloc((count + 1) * sizeof(float));
  out->max_dihedral = malloc((count + 1) * sizeof(float));
  out->radius_ratio = malloc((count + 1) * sizeof(float));
  out->radius_edge = malloc((count + 1) * sizeof(float));
  out->classes = calloc(count + 1, 1);
  if (!out->min_dihedral || !out->max_dihedral || !out->radius_ratio || !out->radius_edge || !out->classes) return false;
  for (size_t tet = 0; tet < count; ++tet) {
    double p[4][3];
    if (interrupt_asked()) return false;
    if (report_tet_corners(mesh, tet, p)) {
      measure(out, tet, p, unit * unit, certificate->lattice_tolerance);
    } else {
      out->min_dihedral[tet] = out->max_dihedral[tet] = out->radius_ratio[tet] = out->radius_edge[tet] = NAN;
    }
    ++out->class_counts[out->classes[tet]];
  }
  return true;
}

void report_shapes_free(report_shapes *shapes) {
  free(shapes->min_dihedral);
  free(shapes->max_dihedral);
  free(shapes->radius_ratio);
  free(shapes->radius_edge);
  free(shapes->classes);
  *shapes = (report_shapes){0};
}

/* ---- the worst ---- */

enum { TAIL_BINS = 1 << 14 };

/* The bin of a value, bin 0 the worst; what cannot be measured is worst. */
static int tail_bin(float value, double best, double worst) {
  if (isnan(value)) return 0;
  const double place = ((double)value - worst) / (best - worst) * TAIL_BINS;
  return place < 0 ? 0 : place > TAIL_BINS - 1 ? TAIL_BINS - 1 : (int)place;
}

/* Whole bins from the worst on while they fit, then the first ones of the next. */
static void choose_tail(const float *values, size_t count, double best, double worst, size_t most, size_t *bins,
                        uint8_t *chosen) {
  memset(bins, 0, TAIL_BINS * sizeof *bins);
  for (size_t i = 0; i < count; ++i) ++bins[tail_bin(values[i], best, worst)];
  int last = 0;
  size_t whole = 0;
  while (last < TAIL_BINS && whole + bins[last] <= most) whole += bins[last++];
  size_t left = most - whole;
  for (size_t i = 0; i < count; ++i) {
    const int bin = tail_bin(values[i], best, worst);
    if (bin > last || (bin == last && left == 0)) continue;
    left -= bin == last;
    chosen[i] = 1;
  }
}

bool report_shapes_worst(const report_shapes *shapes, size_t most, uint8_t *chosen) {
  size_t *bins = malloc(TAIL_BINS * sizeof *bins);
  if (!bins) return false;
  choose_tail(shapes->min_dihedral, shapes->count, 75, 0, most, bins, chosen);
  choose_tail(shapes->max_dihedral, shapes->count, 60, 180, most, bins, chosen);
  choose_tail(shapes->radius_ratio, shapes->count, 1, 0, most, bins, chosen);
  choose_tail(shapes->radius_edge, shapes->count, 1, 5, most, bins, chosen);
  free(bins);
  return !interrupt_asked();
}
