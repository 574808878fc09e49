/* What a mesh will cost before it is made.
 *
 * The tiling takes 136 tets and 24 vertices per cubic cell of side 2.5118 h, h the mean edge: 8.5815 V/h^3 and 1.5144 V/h^3.
 * The boundary changes that in proportion to A/h^2, by about half a layer of vertices.
 *
 * Volume and area of an implicit solid come from quasi-random samples: the volume from the share of points inside, the area
 * from the share of short segments that cross the surface (Crofton: a surface of area A in a box of volume B is met by a
 * random segment of length s with the chance A s / 2B). The samples are M. Roberts's additive recurrence, "The unreasonable
 * effectiveness of quasirandom sequences", 2018. */
#include "estimate.h"

#include <math.h>
#include <stdlib.h>

#include "features.h"
#include "sizing.h"

/* Tets and vertices per V/h^3: counts of one cell over its side in mean edges, cubed. */
static const double tets_in_volume = 8.5815, vertices_in_volume = 1.5144;
/* The same per A/h^2, fitted to spheres, a torus, bunny, dragon, fertility and a plate of 50 to 860 thousand tets: the
 * counts come within 2 % of those that are made. */
static const double tets_on_area = -0.15, vertices_on_area = 0.68;
static const double default_tets = 50e3;

/* Seconds of `laves mesh` with its certificate, on one core, fitted to 17 surfaces and 7 formulas of 50 and 500 thousand tets,
 * three of them of 5 million, too: where there are few creases or none, within a factor of 2. Creases take long where they are
 * closer than the size allows: each as much as here where a scan is rough or letters are engraved, up to six times that in
 * walls thinner than the size, a fifth on a well resolved part; less in meshes of less surface than this many size^2. */
static const double seconds_per_tet = 3e-7, seconds_per_area = 8.5e-5, seconds_per_triangle = 3e-6, seconds_per_crease = 0.06;
static const double area_of_small = 2000;
/* Where sizes vary, measured on a sphere and bunny; half of it to a quarter where they follow the curvature of a formula. */
static const double seconds_per_varying_tet = 1.1e-5;

/* Samples are taken until there are enough or the time is up: a soup of triangles answers slowly. */
enum { SAMPLES = 1 << 17, BATCH = 1 << 8 };
static const double sampling_seconds = 1.0;

/* x_k = frac(1/2 + k a) in five dimensions, a_j = g^-j with g^6 = g + 1. */
static void sample_at(size_t index, double numbers[5]) {
  static const double g = 1.1673039782614187;
  double step = 1;
  for (int j = 0; j < 5; ++j) {
    step /= g;
    const double x = 0.5 + step * (double)(index + 1);
    numbers[j] = x - floor(x);
  }
}

typedef struct sampler {
  double lower[3], upper[3]; /* the box, with room for the segments */
  double segment;            /* their length */
  size_t inside, crossings;
} sampler;

/* Two ends of the segment with its start at a sample point and a direction spread evenly over the sphere. */
static void make_segment(const sampler *box, size_t index, double ends[6]) {
  double r[5];
  sample_at(index, r);
  const double z = 2 * r[3] - 1, angle = 6.283185307179586 * r[4], ring = sqrt(1 - z * z);
  const double direction[3] = {ring * cos(angle), ring * sin(angle), z};
  for (int j = 0; j < 3; ++j) {
    ends[j] = box->lower[j] + r[j] * (box->upper[j] - box->lower[j]);
    ends[3 + j] = ends[j] + box->segment * direction[j];
  }
}

static void sample_batch(const laves_domain *domain, sampler *box, size_t first) {
  double points[BATCH][6], values[BATCH][2];
  for (size_t i = 0; i < BATCH; ++i) make_segment(box, first + i, points[i]);
  laves_domain_evaluate(domain, points[0], 2 * (size_t)BATCH, values[0]);
  for (size_t i = 0; i < BATCH; ++i) {
    box->inside += values[i][0] < 0;
    box->crossings += (values[i][0] < 0) != (values[i][1] < 0);
  }
}

/* Segments as long as a hundredth of the diagonal: short against the parts of the solid, long enough to meet the surface. */
static void sample_domain(session *run, const input *in, estimate *result) {
  static const double segment_share = 0.01;
  sampler box = {.segment = segment_share * input_diagonal(&in->info)};
  double box_volume = 1;
  for (int j = 0; j < 3; ++j) {
    box.lower[j] = in->info.lower[j] - box.segment;
    box.upper[j] = in->info.upper[j] + box.segment;
    box_volume *= box.upper[j] - box.lower[j];
  }
  const double start = progress_now();
  size_t taken = 0;
  bool wanted = true;
  while (wanted && taken < SAMPLES) {
    sample_batch(in->domain, &box, taken);
    taken += BATCH;
    wanted = progress_report(&run->bar, "sample", (double)taken / SAMPLES) && progress_now() - start < sampling_seconds;
  }
  progress_clear(&run->bar);
  if (isnan(result->volume)) result->volume = box_volume * (double)box.inside / (double)taken;
  if (isnan(result->area)) result->area = 2 * box_volume * (double)box.crossings / ((double)taken * box.segment);
  result->sampled = true;
}

static double count_at(double size, double volume, double area, double per_volume, double per_area) {
  return fmax(per_volume * volume / (size * size * size) + per_area * area / (size * size), 0);
}

/* The size at which the count is the wished one; the count falls as the size grows. */
static double solve_size(const estimate *of, double wished, double per_volume, double per_area) {
  double low = 1e-6 * cbrt(of->volume), high = 1e3 * cbrt(of->volume);
  for (int i = 0; i < 80; ++i) {
    const double middle = sqrt(low * high);
    if (count_at(middle, of->volume, of->area, per_volume, per_area) > wished) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return sqrt(low * high);
}

static double choose_size(const input *in, const settings *given, const estimate *of) {
  if (given->size > 0) return given->size;
  if (given->relative_size > 0) return given->relative_size * input_diagonal(&in->info);
  if (given->vertices > 0) return solve_size(of, (double)given->vertices, vertices_in_volume, vertices_on_area);
  return solve_size(of, given->tets > 0 ? (double)given->tets : default_tets, tets_in_volume, tets_on_area);
}

bool estimate_make(session *run, const input *in, estimate *result) {
  *result = (estimate){.volume = in->info.volume, .area = in->info.area};
  if (isnan(result->volume) || isnan(result->area)) sample_domain(run, in, result);
  if (!(result->volume > 0)) return false;
  const double size = choose_size(in, run->given, result);
  result->size = size;
  result->tets = count_at(size, result->volume, result->area, tets_in_volume, tets_on_area);
  result->vertices = count_at(size, result->volume, result->area, vertices_in_volume, vertices_on_area);
  return true;
}

static double expect_seconds(const input *in, const estimate *of, bool varying, size_t creases) {
  const double tiles_on_area = of->area / (of->size * of->size);
  const double meshing =
      varying ? seconds_per_varying_tet * of->tets : seconds_per_tet * of->tets + seconds_per_area * tiles_on_area;
  const double keeping = seconds_per_crease * (double)creases * fmin(1, tiles_on_area / area_of_small);
  return meshing + keeping + seconds_per_triangle * (double)in->info.triangle_count;
}

laves_result estimate_expect(session *run, const input *in, const laves_sizing *sizing, const laves_features *features,
                             estimate *result) {
  const bool varying = sizing_is_asked(run->given);
  laves_options options = laves_options_default();
  laves_expectation expected;
  options.size = varying ? run->given->size : result->size;
  options.relative_size = varying ? run->given->relative_size : 0;
  options.tet_target = varying ? run->given->tets : 0;
  options.vertex_target = varying ? run->given->vertices : 0;
  sizing_options(run->given, sizing, &in->info, &options);
  features_options(run->given, features, &options);
  const laves_result outcome = laves_estimate(run->context, in->domain, &options, &expected, &run->error);
  if (outcome != LAVES_OK) return session_settle(run, outcome);
  result->bytes = fmax(expected.peak_bytes, expected.certify_bytes);
  if (varying) {
    result->size = expected.size;
    result->tets = expected.tets;
    result->vertices = expected.vertices;
  }
  result->cpu_seconds = expect_seconds(in, result, varying, expected.creases);
  return session_settle(run, outcome);
}

void estimate_write_json(json *out, const estimate *result) {
  json_number(out, "size", result->size);
  json_number(out, "volume", result->volume);
  json_number(out, "area", result->area);
  json_boolean(out, "sampled", result->sampled);
  json_number(out, "tets", result->tets);
  json_number(out, "vertices", result->vertices);
  json_number(out, "memory_bytes", result->bytes);
  json_number(out, "cpu_seconds", result->cpu_seconds);
}
