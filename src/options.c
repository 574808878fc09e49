/* Checking options and finding the size.
 *
 * A volume V holds 8.5815 V / h^3 tiles and 1.5144 V / h^3 sites (136 and 24 for each cubic period of side 2.5118 h). The
 * boundary adds half a layer of vertices; what it adds was measured on smooth shapes and serves as a first guess only: the
 * pipeline counts after labelling and corrects. */
#include "options.h"

#include "background/c15_table.h"

static const uint32_t options_cookie = 0x4f707473;

static const double default_tets = 50000;
static const double cell_side = LAVES__C15_PERIOD / LAVES__C15_MEAN_EDGE;
/* For each size^2 of surface, measured on spheres and tori at 10^4 to 10^6 tets. */
static const double tets_per_area = 0.0, vertices_per_area = 0.55;
static const double count_tolerance = 0.012; /* of the wished count, where 0.03 is promised */

laves_options laves_options_default(void) {
  return (laves_options){.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                         .method = LAVES_METHOD_AUTO,
                         .guarantee = 14.4,
                         .improve = true,
                         .min_dihedral = 40,
                         .max_dihedral = 125,
                         .volume_length = 0.6,
                         .grading = 0.3,
                         .feature_angle = 40,
                         .keep_thin = true,
                         .cookie = options_cookie};
}

static laves_result check_range(const char *name, double value, double low, double high, laves_error *error) {
  if (value >= low && value <= high) return LAVES_OK;
  return laves__fail(error, LAVES_ERROR_OPTION, "%s is %g but must lie between %g and %g", name, value, low, high);
}

static laves_result check_rotation(const double r[9], laves_error *error) {
  static const double tolerance = 1e-6;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      const double dot = r[3 * i] * r[3 * j] + r[3 * i + 1] * r[3 * j + 1] + r[3 * i + 2] * r[3 * j + 2];
      if (!(fabs(dot - (i == j)) < tolerance))
        return laves__fail(error, LAVES_ERROR_OPTION, "rotation is not a rotation matrix: rows %d and %d have the product %g", i,
                           j, dot);
    }
  const laves__vec3 rows[3] = {{r[0], r[1], r[2]}, {r[3], r[4], r[5]}, {r[6], r[7], r[8]}};
  if (v3_dot(rows[0], v3_cross(rows[1], rows[2])) < 0)
    return laves__fail(error, LAVES_ERROR_OPTION, "rotation mirrors space (determinant -1); change the sign of one row");
  return LAVES_OK;
}

/* Zero, which leaves a source out, or in its range. */
static laves_result check_optional(const char *name, double value, double low, double high, laves_error *error) {
  if (value == 0 || (value >= low && value <= high && isfinite(value))) return LAVES_OK;
  if (high == INFINITY)
    return laves__fail(error, LAVES_ERROR_OPTION, "%s is %g but must be zero (none) or a positive number", name, value);
  return laves__fail(error, LAVES_ERROR_OPTION, "%s is %g but must be zero (none) or lie between %g and %g", name, value, low,
                     high);
}

static laves_result check_sizing(const laves_options *o, laves_error *error) {
  laves_result result = check_range("grading", o->grading, 0.05, 1, error);
  if (result == LAVES_OK) result = check_optional("min_size", o->min_size, 0, INFINITY, error);
  if (result == LAVES_OK) result = check_optional("curvature_elements", o->curvature_elements, 3, 1000, error);
  if (result == LAVES_OK) result = check_optional("thickness_elements", o->thickness_elements, 0.5, 100, error);
  if (result == LAVES_OK) result = check_optional("feature_elements", o->feature_elements, 0.5, 100, error);
  if (result == LAVES_OK) result = check_optional("max_distance", o->max_distance, 0, INFINITY, error);
  if (result == LAVES_OK) result = check_range("interior_growth", o->interior_growth, 0, 1, error);
  if (result == LAVES_OK) result = check_optional("max_size", o->max_size, 0, INFINITY, error);
  return result;
}

laves_result laves__options_check(const laves_options *o, laves_error *error) {
  if (o->cookie != options_cookie)
    return laves__fail(error, LAVES_ERROR_OPTION, "the options did not come from laves_options_default()");
  const int given = (o->size != 0) + (o->relative_size != 0) + (o->tet_target != 0) + (o->vertex_target != 0);
  if (given > 1)
    return laves__fail(error, LAVES_ERROR_OPTION, "%d of size, relative_size, tet_target and vertex_target are given; give one",
                       given);
  laves_result result = LAVES_OK;
  if (o->size != 0 && !(o->size > 0 && isfinite(o->size)))
    return laves__fail(error, LAVES_ERROR_OPTION, "size is %g but must be a positive number", o->size);
  if (o->relative_size != 0) result = check_range("relative_size", o->relative_size, 1e-6, 0.5, error);
  if (result == LAVES_OK && o->tet_target != 0) result = check_range("tet_target", (double)o->tet_target, 1, 1e11, error);
  if (result == LAVES_OK && o->vertex_target != 0)
    result = check_range("vertex_target", (double)o->vertex_target, 1, 2147483647, error);
  if (result == LAVES_OK && (unsigned)o->method > LAVES_METHOD_STUFF)
    result = laves__fail(error, LAVES_ERROR_OPTION, "method is %d, which is no laves_method", (int)o->method);
  if (result == LAVES_OK) result = check_range("guarantee", o->guarantee, 0, 28, error);
  if (result == LAVES_OK) result = check_range("min_dihedral", o->min_dihedral, 0, 60, error);
  if (result == LAVES_OK) result = check_range("max_dihedral", o->max_dihedral, 80, 180, error);
  if (result == LAVES_OK) result = check_range("volume_length", o->volume_length, 0, 0.8, error);
  if (result == LAVES_OK) result = check_sizing(o, error);
  if (result == LAVES_OK) result = check_optional("feature_angle", o->feature_angle, 1, 179, error);
  if (result == LAVES_OK && (unsigned)o->regions > LAVES_REGIONS_PARTS)
    result = laves__fail(error, LAVES_ERROR_OPTION, "regions is %d, which is no laves_regions", (int)o->regions);
  if (result == LAVES_OK && (unsigned)o->align > LAVES_ALIGN_ROTATION)
    result = laves__fail(error, LAVES_ERROR_OPTION, "align is %d, which is no laves_align", (int)o->align);
  if (result == LAVES_OK && o->align == LAVES_ALIGN_ROTATION) result = check_rotation(o->rotation, error);
  return result;
}

const laves__guarantee *laves__options_guarantee(const laves_options *o) {
  if (o->method == LAVES_METHOD_STUFF) return laves__guarantee_find(o->guarantee);
  return o->method == LAVES_METHOD_SNAP || o->guarantee == 0 ? NULL : laves__guarantee_find(o->guarantee);
}

laves__mat3 laves__options_rotation(const laves_options *o, const laves__oracle *oracle) {
  const double *r = o->rotation;
  if (o->align == LAVES_ALIGN_ROTATION) return (laves__mat3){{{r[0], r[1], r[2]}, {r[3], r[4], r[5]}, {r[6], r[7], r[8]}}};
  if (o->align == LAVES_ALIGN_PCA) return laves__principal_axes(oracle);
  return (laves__mat3){{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

/* The h at which volume_rate V / h^3 + area_rate A / h^2 is `count`: Newton on 1/h from the volume's term alone. */
static double size_for_count(double count, double volume, double area, double volume_rate, double area_rate) {
  enum { STEPS = 20 };
  double x = cbrt(count / (volume_rate * volume));
  for (int i = 0; i < STEPS; i++) {
    const double value = (volume_rate * volume * x + area_rate * area) * x * x - count;
    const double slope = (3 * volume_rate * volume * x + 2 * area_rate * area) * x;
    x -= value / slope;
  }
  return 1 / x;
}

double laves__options_size(const laves_options *o, const laves__oracle *oracle, double volume) {
  const double period = cell_side * cell_side * cell_side, area = isfinite(oracle->area) ? oracle->area : 0;
  if (o->size > 0) return o->size;
  if (o->relative_size > 0) return o->relative_size * box3_diagonal(oracle->bounds);
  if (o->vertex_target > 0)
    return size_for_count((double)o->vertex_target, volume, area, LAVES__C15_SITES / period, vertices_per_area);
  return size_for_count(o->tet_target > 0 ? (double)o->tet_target : default_tets, volume, area, LAVES__C15_TETS / period,
                        tets_per_area);
}

double laves__options_correction(const laves_options *o, int64_t tets, int64_t vertices) {
  const double wished = o->tet_target > 0 ? (double)o->tet_target : (double)o->vertex_target;
  const double got = o->tet_target > 0 ? (double)tets : (double)vertices;
  if (wished <= 0 || got <= 0 || fabs(got / wished - 1) <= count_tolerance) return 1;
  return cbrt(got / wished);
}
