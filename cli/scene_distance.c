/* Colours of a scene by distance.
 *
 * Surfaces answer with true distances.  Other solids answer with some phi whose zero is the surface: there the distance is |phi|
 * over the length of its gradient, by central differences over a small part of the face, which is right to first order. */
#include "scene_distance.h"

#include <math.h>
#include <stdlib.h>

#include "interrupt.h"

enum { FACE_SAMPLES = 7, GRADIENT_SAMPLES = 6, BATCH_FACES = 256 };

/* Of the longest edge of a face: large over rounding, small over what bends. */
static const double step_share = 1e-3;

/* Corners, middles of edges, centroid. */
static void face_samples(const scene_face *face, double samples[FACE_SAMPLES][3]) {
  for (int k = 0; k < 3; ++k) {
    samples[6][k] = 0;
    for (int i = 0; i < 3; ++i) {
      samples[i][k] = face->points[i][k];
      samples[3 + i][k] = 0.5 * (face->points[i][k] + face->points[(i + 1) % 3][k]);
      samples[6][k] += face->points[i][k] / 3;
    }
  }
}

static double longest_edge(const scene_face *face) {
  double longest = 0;
  for (int i = 0; i < 3; ++i) {
    const double *a = face->points[i], *b = face->points[(i + 1) % 3];
    longest = fmax(longest, sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2])));
  }
  return longest;
}

/* Length of the gradient of phi at a point. */
static double gradient_length(const laves_domain *domain, const double place[3], double step) {
  double points[GRADIENT_SAMPLES][3], values[GRADIENT_SAMPLES], squares = 0;
  for (int i = 0; i < GRADIENT_SAMPLES; ++i) {
    for (int k = 0; k < 3; ++k) points[i][k] = place[k] + (i / 2 == k ? (i % 2 ? step : -step) : 0);
  }
  laves_domain_evaluate(domain, points[0], GRADIENT_SAMPLES, values);
  for (int k = 0; k < 3; ++k) {
    const double slope = (values[2 * k + 1] - values[2 * k]) / (2 * step);
    squares += slope * slope;
  }
  return sqrt(squares);
}

/* The furthest sample of a face, whose values of phi are given. */
static double face_distance(const laves_domain *domain, bool exact, const scene_face *face, const double *values) {
  double samples[FACE_SAMPLES][3], furthest = 0;
  const double step = step_share * longest_edge(face);
  face_samples(face, samples);
  for (int i = 0; i < FACE_SAMPLES; ++i) {
    const double length = exact || !(step > 0) ? 1 : gradient_length(domain, samples[i], step);
    if (length > 0) furthest = fmax(furthest, fabs(values[i]) / length);
  }
  return furthest;
}

/* Faces [first, end) of the scene, which are BATCH_FACES at most. */
static void measure_batch(const laves_domain *domain, bool exact, const scene *subject, size_t first, size_t end,
                          double *distances) {
  double samples[BATCH_FACES * FACE_SAMPLES][3] = {{0}}, values[BATCH_FACES * FACE_SAMPLES];
  for (size_t i = first; i < end; ++i) face_samples(&subject->faces[i], &samples[(i - first) * FACE_SAMPLES]);
  laves_domain_evaluate(domain, samples[0], (end - first) * FACE_SAMPLES, values);
  for (size_t i = first; i < end; ++i) {
    const scene_face *face = &subject->faces[i];
    distances[i] = face->boundary ? face_distance(domain, exact, face, &values[(i - first) * FACE_SAMPLES]) : 0;
  }
}

bool scene_measure_distances(const laves_domain *domain, const laves_domain_info *info, scene *subject, double *furthest) {
  double *distances = malloc((subject->face_count + 1) * sizeof *distances);
  if (!distances) return false;
  *furthest = 0;
  for (size_t first = 0; first < subject->face_count && !interrupt_asked(); first += BATCH_FACES) {
    const size_t end = first + BATCH_FACES < subject->face_count ? first + BATCH_FACES : subject->face_count;
    measure_batch(domain, info->kind == LAVES_DOMAIN_SURFACE, subject, first, end, distances);
    for (size_t i = first; i < end; ++i) *furthest = fmax(*furthest, distances[i]);
  }
  if (!interrupt_asked()) scene_colour_distances(subject, distances, *furthest);
  free(distances);
  return !interrupt_asked();
}
