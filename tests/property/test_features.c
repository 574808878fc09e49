/* Creases and corners of whole meshes: every one is there, in every orientation, and the angles beside them are good.
 *
 * LAVES_SEEDS: how many orientations of each solid; more take longer. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/assert_close.h"
#include "fixtures/shapes.h"
#include "fixtures/stages.h"
#include "fixtures/stride.h"

static int orientations(int usual) {
  const char *text = getenv("LAVES_SEEDS");
  return text ? atoi(text) : usual;
}

/* A rotation for a number: none for 0, then about axes and by angles that fill the ranges evenly. */
static void turn(laves_options *o, int number) {
  if (number == 0) return;
  const double golden = 0.61803398874989485, pi = 3.14159265358979323846;
  const double z = 2 * fmod(golden * number, 1) - 1, around = 2 * pi * fmod(0.7548776662 * number, 1);
  const double angle = pi * fmod(0.5698402909 * number + 0.1, 1), r = sqrt(1 - z * z);
  const double u[3] = {r * cos(around), r * sin(around), z}, c = cos(angle), s = sin(angle);
  const double cross[9] = {0, -u[2], u[1], u[2], 0, -u[0], -u[1], u[0], 0};
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) o->rotation[3 * i + k] = (i == k) * c + s * cross[3 * i + k] + (1 - c) * u[i] * u[k];
  o->align = LAVES_ALIGN_ROTATION;
}

typedef struct solid {
  const char *name;
  shape (*make)(void);
  double size, low, high; /* the window that must hold */
  double chord;           /* how far a crease's edges may be from it, sizes */
} solid;

static shape make_box(void) { return shape_box((const double[]){-1, -0.7, -0.5}, (const double[]){1, 0.7, 0.5}, 4); }
static shape make_ell(void) { return shape_ell(); }
static shape make_cylinder(void) { return shape_cylinder(1, 1.5, 180); }
static shape make_wedge(double degrees) {
  const double slope = tan(degrees * 3.14159265358979323846 / 180);
  const double profile[3][2] = {{0, 0}, {2, 0}, {2, 2 * slope}};
  return shape_prism(profile, 3, 0, 1.5);
}
static shape make_wedge45(void) { return make_wedge(45); }
static shape make_wedge30(void) { return make_wedge(30); }
static shape make_plate(void) { return shape_box((const double[]){-1, -1, -0.06}, (const double[]){1, 1, 0.06}, 2); }

static const solid solids[] = {
    {"box", make_box, 0.12, 38, 126, 1e-9},
    {"ell", make_ell, 0.13, 38, 126, 1e-9},
    {"cylinder", make_cylinder, 0.13, 38, 126, 0.05},
    {"wedge of 45 degrees", make_wedge45, 0.1, 38, 126, 1e-9},
    {"wedge of 30 degrees", make_wedge30, 0.09, 25, 140, 1e-9}, /* the crease itself has 30 */
    {"plate as thick as the size", make_plate, 0.12, 36.5, 128, 1e-9},
};

static void keep_all(const solid *about, int number) {
  laves_context *context = laves_context_create(NULL);
  shape s = about->make();
  laves_domain *domain;
  laves_mesh *mesh = NULL;
  laves_report report;
  laves_error error = {0};
  laves_options options = options_of_size(about->size);
  turn(&options, number);
  assert_int_equal(
      laves_domain_from_triangles(context, s.points, s.point_count, s.triangles, s.triangle_count, NULL, &domain, NULL),
      LAVES_OK);
  if (laves_generate(context, domain, &options, &mesh, &report, &error) != LAVES_OK)
    fail_msg("%s %d: %s", about->name, number, error.text);
  const laves_check check = check_valid(context, mesh, about->name);
  laves_feature_check kept;
  size_t count;
  assert_int_equal(laves_check_features(context, mesh, domain, NULL, &kept, NULL, 0, &count, NULL), LAVES_OK);
  print_message("%-28s %2d: %6zu tets, %.1f to %.1f degrees, crease off by %.4f sizes, %zu of %zu corners\n", about->name, number,
                laves_mesh_tet_count(mesh), check.min_dihedral.min, check.max_dihedral.max, kept.to_mesh_max / about->size,
                kept.corners_kept, kept.corners);
  assert_int_equal(check.components, 1);
  assert_int_equal(check.genus, 0);
  assert_int_equal(kept.corners_kept, kept.corners);
  assert_true(kept.to_mesh_max <= about->chord * about->size);
  assert_true(kept.from_mesh_max <= about->chord * about->size);
  assert_true(check.min_dihedral.min >= about->low && check.max_dihedral.max <= about->high);
  assert_int_equal(report.corners_kept, report.corners);
  assert_true(report.crease_kept > 0.98 * report.crease_length);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  shape_free(&s);
  laves_context_free(context);
}

static void creases_are_kept_in_all_orientations(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++)
    for (int number = 0; number<orientations(3); number += test_stride()> 1 ? 2 : 1) keep_all(&solids[i], number);
}

/* A crease sharper than the promised window has tets with its angle, which are told apart from a promise that is broken. */
static void what_a_crease_forces_is_told(void **state) {
  (void)state;
  static const double sharp = 26; /* degrees */
  laves_context *context = laves_context_create(NULL);
  shape s = make_wedge(sharp);
  laves_domain *domain;
  laves_mesh *mesh = NULL;
  laves_report report;
  laves_certificate certificate;
  laves_error error = {0};
  laves_options options = options_of_size(0.09);
  options.guarantee = 28;
  assert_int_equal(
      laves_domain_from_triangles(context, s.points, s.point_count, s.triangles, s.triangle_count, NULL, &domain, NULL),
      LAVES_OK);
  if (laves_generate(context, domain, &options, &mesh, &report, &error) != LAVES_OK) fail_msg("%s", error.text);
  laves_certify_options about = laves_certify_options_default();
  about.domain = domain;
  about.options = &options;
  about.report = &report;
  assert_int_equal(laves_certify(context, mesh, &about, &certificate, NULL), LAVES_OK);
  const size_t outside = certificate.exception_counts[LAVES_EXCEPTION_OUTSIDE_PROMISED];
  print_message("wedge of %g degrees: %zu tets forced, smallest angle %.3f, %zu outside\n", sharp, report.forced_tets,
                certificate.check.min_dihedral.min, outside);
  assert_true(certificate.check.valid);
  assert_true(report.forced_tets > 0);
  assert_int_equal(report.forced_tets, outside);
  assert_true(fabs(certificate.check.min_dihedral.min - sharp) < 1e-3);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  shape_free(&s);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_a_crease_forces_is_told),
      cmocka_unit_test(creases_are_kept_in_all_orientations),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
