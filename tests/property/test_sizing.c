/* Sizes that vary, end to end: each source makes edges as long as it asks where it asks, and nowhere else; whatever the
 * sources, the mesh is valid, lies on the surface, is the same for any number of threads, and has a certificate that holds. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/assert_close.h"
#include "fixtures/folders.h"
#include "fixtures/shapes.h"
#include "fixtures/stages.h"

typedef struct made {
  laves_context *context;
  laves_domain *domain;
  laves_sizing *sizing;
  laves_options options;
  laves_report report;
  laves_result result;
  laves_mesh *mesh;
  laves_check check;
  laves_error error;
} made;

static made begin(int thread_count, double size) {
  laves_context_options threads = laves_context_options_default();
  threads.thread_count = thread_count;
  made m = {.context = laves_context_create(&threads), .options = options_of_size(size)};
  assert_int_equal(laves_sizing_create(m.context, &m.sizing, &m.error), LAVES_OK);
  m.options.sizing = m.sizing;
  return m;
}

static made of_expression(const char *text, double size) {
  made m = begin(0, size);
  if (laves_domain_from_expression(m.context, text, &m.domain, &m.error) != LAVES_OK) fail_msg("%s: %s", text, m.error.text);
  return m;
}

static made of_shape(shape s, const int32_t *tags, double size) {
  made m = begin(0, size);
  if (laves_domain_from_triangles(m.context, s.points, s.point_count, s.triangles, s.triangle_count, tags, &m.domain, &m.error) !=
      LAVES_OK)
    fail_msg("%s", m.error.text);
  shape_free(&s);
  return m;
}

static made of_file(const char *path, double size) {
  made m = begin(0, size);
  if (laves_domain_from_file(m.context, path, &m.domain, &m.error) != LAVES_OK) fail_msg("%s", m.error.text);
  return m;
}

static void add_expression(made *m, const char *text) {
  if (laves_sizing_add_expression(m->sizing, text, &m->error) != LAVES_OK) fail_msg("%s: %s", text, m->error.text);
}

static void add_point(made *m, double x, double y, double z, double size, double radius) {
  assert_int_equal(laves_sizing_add_points(m->sizing, (const double[3]){x, y, z}, 1, size, radius, &m->error), LAVES_OK);
}

static void generate_any(made *m) {
  m->result = laves_generate(m->context, m->domain, &m->options, &m->mesh, &m->report, &m->error);
  if (!m->mesh) fail_msg("%s: %s", laves_result_name(m->result), m->error.text);
  m->check = check_valid(m->context, m->mesh, "graded");
}

static void generate(made *m) {
  generate_any(m);
  if (m->result != LAVES_OK) fail_msg("a target was missed");
}

/* Drops the mesh, so that another can be made of the same domain. */
static void again(made *m) {
  laves_mesh_free(m->mesh);
  m->mesh = NULL;
}

static void drop(made *m) {
  laves_mesh_free(m->mesh);
  laves_sizing_free(m->sizing);
  laves_domain_free(m->domain);
  assert_int_equal(laves_context_bytes(m->context), 0);
  laves_context_free(m->context);
}

/* ---- measuring ---- */

typedef double distance_fn(laves__vec3 p);

static laves__vec3 point_of(const laves_mesh *mesh, int32_t vertex) {
  const double *p = laves_mesh_points(mesh) + 3 * (size_t)vertex;
  return v3(p[0], p[1], p[2]);
}

/* The mean of the edges of tets, or of boundary faces, whose middle has a distance in [near, far]. */
static double mean_edge(const laves_mesh *mesh, bool boundary, distance_fn *distance, double near, double far) {
  const int corners = boundary ? 3 : 4;
  const int32_t *simplex = boundary ? laves_mesh_faces(mesh) : laves_mesh_tets(mesh);
  const size_t count = boundary ? laves_mesh_face_count(mesh) : laves_mesh_tet_count(mesh);
  double sum = 0;
  size_t edges = 0;
  for (size_t i = 0; i < count; i++, simplex += corners)
    for (int a = 0; a < corners; a++)
      for (int b = a + 1; b < corners; b++) {
        const laves__vec3 p = point_of(mesh, simplex[a]), q = point_of(mesh, simplex[b]);
        const double at = distance(v3_lerp(p, q, 0.5));
        if (at < near || at > far) continue;
        sum += v3_distance(p, q);
        edges++;
      }
  if (edges < 20) fail_msg("only %zu edges are between %g and %g", edges, near, far);
  return sum / (double)edges;
}

/* That the mean of edges of tets is about what is asked: cubes come in powers of two, so it is within a factor of 0.7 to 1.44. */
static void expect_edges(const made *m, distance_fn *distance, double near, double far, double size) {
  const double mean = mean_edge(m->mesh, false, distance, near, far);
  if (mean < 0.65 * size || mean > 1.45 * size)
    fail_msg("edges between %g and %g are %g long on average, not about %g", near, far, mean, size);
}

static int by_value(const void *left, const void *right) {
  const double a = *(const double *)left, b = *(const double *)right;
  return a < b ? -1 : a > b;
}

/* That 5 to 95 % of the edges are 0.6 to 1.5 times as long as wished at their middle. */
static void expect_fidelity(const made *m, distance_fn *wish) {
  const size_t tets = laves_mesh_tet_count(m->mesh);
  const int32_t *tet = laves_mesh_tets(m->mesh);
  double *ratio = malloc(6 * tets * sizeof *ratio);
  size_t count = 0;
  assert_non_null(ratio);
  for (size_t t = 0; t < tets; t++, tet += 4)
    for (int a = 0; a < 4; a++)
      for (int b = a + 1; b < 4; b++) {
        const laves__vec3 p = point_of(m->mesh, tet[a]), q = point_of(m->mesh, tet[b]);
        ratio[count++] = v3_distance(p, q) / wish(v3_lerp(p, q, 0.5));
      }
  qsort(ratio, count, sizeof *ratio, by_value);
  const double low = ratio[count / 20], high = ratio[count - count / 20];
  free(ratio);
  if (low < 0.6 || high > 1.5) fail_msg("5 to 95 %% of the edges are %.2f to %.2f times as long as wished", low, high);
}

static double from_origin(laves__vec3 p) { return v3_norm(p); }
static double from_pole(laves__vec3 p) { return v3_distance(p, v3(0, 0, 0.9)); }
static double from_axis(laves__vec3 p) { return hypot(p.x, p.y); }
static double from_right(laves__vec3 p) { return 1 - p.x; }
static double below_sphere(laves__vec3 p) { return 1 - v3_norm(p); }
static double anywhere(laves__vec3 p) {
  (void)p;
  return 0;
}

/* The boundary vertices are on the unit sphere. */
static void expect_on_sphere(const made *m) {
  const int32_t *faces = laves_mesh_faces(m->mesh);
  assert_int_equal(m->report.off_surface, 0);
  for (size_t i = 0; i < 3 * laves_mesh_face_count(m->mesh); i++) assert_close(v3_norm(point_of(m->mesh, faces[i])), 1, 1e-9);
}

/* ---- sources ---- */

static void points_refine(void **state) {
  (void)state;
  made m = of_expression("sphere(1)", 0.3);
  add_point(&m, 0, 0, 0.9, 0.06, 0.1);
  generate(&m);
  expect_edges(&m, from_pole, 0, 0.1, 0.06);
  expect_edges(&m, from_pole, 1.1, 2, 0.3);
  expect_on_sphere(&m);
  drop(&m);
}

static void curves_refine(void **state) {
  (void)state;
  made m = of_expression("sphere(1)", 0.3);
  const double line[] = {0, 0, -1, 0, 0, 0, 0, 0, 1};
  assert_int_equal(laves_sizing_add_curve(m.sizing, line, 3, 0.1, 0.05, &m.error), LAVES_OK);
  generate(&m);
  expect_edges(&m, from_axis, 0, 0.05, 0.1);
  expect_edges(&m, from_axis, 0.8, 1, 0.3);
  drop(&m);
}

static void tags_refine(void **state) {
  (void)state;
  shape box = shape_box((const double[3]){-1, -1, -1}, (const double[3]){1, 1, 1}, 1);
  int32_t tags[12] = {0};
  for (size_t i = 0; i < box.triangle_count; i++) {
    bool right = true;
    for (int k = 0; k < 3; k++) right &= box.points[3 * box.triangles[3 * i + (size_t)k]] == 1;
    tags[i] = right ? 7 : 3;
  }
  made m = of_shape(box, tags, 0.3);
  assert_int_equal(laves_sizing_add_tag(m.sizing, "7", 0.1, 0.1, &m.error), LAVES_OK);
  generate_any(&m); /* the edges of a box miss the window */
  expect_edges(&m, from_right, 0, 0.1, 0.1);
  expect_edges(&m, from_right, 1, 2, 0.3);
  drop(&m);
}

static double wish_by_depth(laves__vec3 p) { return fmin(0.25, 0.06 + 0.3 * fmax(0, below_sphere(p))); }

static void expressions_of_depth_hold(void **state) {
  (void)state;
  made m = of_expression("sphere(1)", 0.25);
  add_expression(&m, "0.06 + 0.3*d");
  generate(&m);
  expect_fidelity(&m, wish_by_depth);
  expect_on_sphere(&m);
  drop(&m);
}

static double wish_of_image(laves__vec3 p) { return 0.16 + 0.1 * p.x; }

/* An image of two values along x, which are 0.05 at -1.1 and 0.27 at 1.1. */
static void backgrounds_hold(void **state) {
  (void)state;
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 20];
  assert_true(fixture_folder_make(folder));
  snprintf(path, sizeof path, "%s/sizes.nrrd", folder);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fputs(
      "NRRD0004\ntype: double\ndimension: 3\nsizes: 2 2 2\nspace dimension: 3\n"
      "space directions: (2.2,0,0) (0,2.2,0) (0,0,2.2)\nspace origin: (-1.1,-1.1,-1.1)\nencoding: ascii\n\n"
      "0.05 0.27 0.05 0.27 0.05 0.27 0.05 0.27\n",
      file);
  fclose(file);
  made m = of_expression("sphere(1)", 0.3);
  if (laves_sizing_add_background(m.sizing, path, NULL, &m.error) != LAVES_OK) fail_msg("%s", m.error.text);
  generate(&m);
  expect_fidelity(&m, wish_of_image);
  drop(&m);
  fixture_folder_remove(folder);
}

/* N elements round the tube of a torus, as a formula and as triangles. */
static void curvature_counts_elements(void **state) {
  (void)state;
  for (int kind = 0; kind < 2; kind++) {
    for (int elements = 8; elements <= 14; elements += 6) {
      made m = kind ? of_shape(shape_torus(1, 0.25, 96, 32), NULL, 0.4) : of_expression("torus(1, 0.25)", 0.4);
      m.options.curvature_elements = elements;
      generate_any(&m);
      const double mean = mean_edge(m.mesh, true, anywhere, 0, 0), asked = 2 * M_PI * 0.25 / elements;
      if (mean < 0.65 * asked || mean > 1.45 * asked) fail_msg("N = %d: edges are %g long, not about %g", elements, mean, asked);
      assert_int_equal(m.check.genus, 1);
      drop(&m);
    }
  }
}

/* How often a line along z through (x, y) passes from tet to tet: it is in count of them. */
static int tets_along(const laves_mesh *mesh, double x, double y) {
  const int32_t *tet = laves_mesh_tets(mesh);
  int crossed = 0;
  for (size_t t = 0; t < laves_mesh_tet_count(mesh); t++, tet += 4) {
    double low = INFINITY, high = -INFINITY;
    for (int a = 0; a < 4; a++)
      for (int b = 0; b < 4; b++)
        for (int c = 0; c < 4; c++) { /* where the line meets the face a, b, c */
          const laves__vec3 p = point_of(mesh, tet[a]), q = point_of(mesh, tet[b]), r = point_of(mesh, tet[c]);
          const double area = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
          const double u = ((x - p.x) * (r.y - p.y) - (y - p.y) * (r.x - p.x)) / area;
          const double v = ((q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x)) / area;
          if (!(u >= 0 && v >= 0 && u + v <= 1)) continue;
          const double z = p.z + u * (q.z - p.z) + v * (r.z - p.z);
          low = fmin(low, z);
          high = fmax(high, z);
        }
    crossed += high > low;
  }
  return crossed;
}

/* A plate that the size alone would lose; with N elements across, each line meets N tets and the plate is whole. */
static void walls_have_elements_across(void **state) {
  (void)state;
  for (int elements = 1; elements <= 2; elements++) {
    made m = of_expression("rounded_box{x=1.2, y=1.2, z=0.15, r=0.05}", 0.4);
    m.options.thickness_elements = elements;
    generate_any(&m);
    assert_int_equal(m.check.components, 1);
    assert_int_equal(m.check.genus, 0);
    for (int i = 0; i < 7; i++) {
      const double x = -0.45 + 0.1511 * i, y = 0.41 - 0.1313 * i;
      const int crossed = tets_along(m.mesh, x, y);
      if (crossed < 2 * elements) fail_msg("N = %d: %d tets at (%g, %g)", elements, crossed, x, y);
    }
    assert_close(m.check.volume, 1.2 * 1.2 * 0.15, 0.03);
    drop(&m);
  }
}

/* Two blocks a tenth apart, which the size alone would join or cut back. */
static void gaps_have_elements_across(void **state) {
  (void)state;
  made m =
      of_expression("rounded_box{x=0.8, y=0.8, z=0.8, r=0.2} | rounded_box{x=0.8, y=0.8, z=0.8, r=0.2}:move(0.9, 0, 0)", 0.3);
  m.options.thickness_elements = 1.5;
  generate_any(&m);
  assert_int_equal(m.check.components, 2);
  assert_int_equal(m.check.boundary_components, 2);
  drop(&m);
}

static double from_step(laves__vec3 p) { return hypot(p.x - 1.2, p.z - 0.43); }

static void close_creases_have_elements_between(void **state) {
  (void)state;
  made m = of_file("demo/bracket.obj", 0.2);
  m.options.feature_elements = 1;
  generate_any(&m);
  expect_edges(&m, from_step, 0, 0.05, 0.06);
  expect_edges(&m, from_step, 0.5, 0.8, 0.2);
  drop(&m);
}

/* The wall of a bracket, thinner than the size, is there from floor to top. */
static void thin_walls_of_surfaces_are_whole(void **state) {
  (void)state;
  made m = of_file("demo/bracket.obj", 0.2);
  m.options.thickness_elements = 1;
  generate_any(&m);
  assert_int_equal(m.check.components, 1);
  assert_int_equal(m.check.genus, 0);
  for (int i = 0; i < 5; i++) assert_true(tets_along(m.mesh, 0.0613, 0.1 + 0.2511 * i) > 20);
  drop(&m);
}

static void distance_is_kept(void **state) {
  (void)state;
  laves_place place;
  size_t count;
  made m = of_expression("sphere(1)", 0.5);
  m.options.max_distance = 0.02;
  generate(&m);
  assert_int_equal(laves_check_distance(m.context, m.mesh, m.domain, 0.02, &place, 1, &count, &m.error), LAVES_OK);
  if (count > 0) fail_msg("%zu places are too far, the first by %g", count, place.value);
  drop(&m);
}

static void a_distance_that_cannot_be_kept_is_told(void **state) {
  (void)state;
  made m = of_expression("sphere(1)", 0.5);
  m.options.max_distance = 0.001;
  m.options.min_size = 0.4;
  generate_any(&m);
  assert_int_equal(m.result, LAVES_TARGET_MISSED);
  assert_true(m.report.warning_count > 0);
  drop(&m);
}

static double wish_of_growth(laves__vec3 p) { return 0.08 + 0.3 * fmax(0, below_sphere(p) - 0.06); }

static void insides_grow(void **state) {
  (void)state;
  made m = of_expression("sphere(1)", 0.08);
  generate(&m);
  const size_t uniform_tets = laves_mesh_tet_count(m.mesh);
  const double uniform = mean_edge(m.mesh, true, anywhere, 0, 0);
  again(&m);
  m.options.interior_growth = 0.3;
  generate(&m);
  assert_close(mean_edge(m.mesh, true, anywhere, 0, 0), uniform, 0.1 * uniform);
  expect_fidelity(&m, wish_of_growth);
  expect_on_sphere(&m);
  assert_true((double)laves_mesh_tet_count(m.mesh) < 0.65 * (double)uniform_tets);
  drop(&m);
}

/* ---- rules ---- */

static double gentle(laves__vec3 p) { return fmin(0.4, 0.1 + 0.15 * fmax(0, from_pole(p) - 0.05)); }

static void grading_limits_the_slope(void **state) {
  (void)state;
  size_t tets[2];
  for (int i = 0; i < 2; i++) {
    made m = of_expression("sphere(1)", 0.4);
    m.options.grading = i ? 0.5 : 0.15;
    add_point(&m, 0, 0, 0.9, 0.1, 0.05);
    add_expression(&m, "0.1 + 100*sqrt(x*x + y*y + (z - 0.9)^2)"); /* far steeper than allowed */
    generate_any(&m);
    tets[i] = laves_mesh_tet_count(m.mesh);
    if (i == 0) expect_fidelity(&m, gentle);
    expect_edges(&m, from_pole, 0, 0.12, 0.1);
    expect_edges(&m, from_pole, 0.5, 0.6, i ? 0.35 : 0.175);
    drop(&m);
  }
  assert_true(tets[0] > 2 * tets[1]);
}

static double wish_of_both(laves__vec3 p) { return fmin(wish_by_depth(p), fmin(0.25, 0.06 + 0.2 * from_origin(p))); }

static void the_least_size_counts(void **state) {
  (void)state;
  made m = of_expression("sphere(1)", 0.25);
  add_expression(&m, "0.06 + 0.3*d");
  add_expression(&m, "0.06 + 0.2*sqrt(x*x + y*y + z*z)");
  add_expression(&m, "9 + x"); /* asks for nothing */
  generate(&m);
  expect_fidelity(&m, wish_of_both);
  drop(&m);
}

static void counts_are_met(void **state) {
  (void)state;
  made m = of_expression("sphere(1)", 0);
  add_expression(&m, "0.1 + 0.2*abs(x)");
  m.options.tet_target = 6000;
  generate(&m);
  assert_close((double)laves_mesh_tet_count(m.mesh), 6000, 180);
  drop(&m);
}

/* Every source at once. */
static void ask_for_all(made *m) {
  add_expression(m, "0.08 + 0.3*d");
  add_point(m, 0, 0, 0.9, 0.05, 0.1);
  m->options.curvature_elements = 16;
  m->options.thickness_elements = 1;
  m->options.interior_growth = 0.2;
}

static void threads_do_not_matter(void **state) {
  (void)state;
  char hash[2][33];
  for (int i = 0; i < 2; i++) {
    made m = begin(i ? 3 : 1, 0.2);
    assert_int_equal(laves_domain_from_expression(m.context, "torus(1, 0.3)", &m.domain, &m.error), LAVES_OK);
    ask_for_all(&m);
    generate_any(&m);
    laves_mesh_hash(m.mesh, hash[i]);
    drop(&m);
  }
  assert_string_equal(hash[0], hash[1]);
}

static void constant_fields_are_uniform(void **state) {
  (void)state;
  char hash[2][33];
  made m = of_expression("torus(1, 0.4)", 0.15);
  generate(&m);
  laves_mesh_hash(m.mesh, hash[0]);
  again(&m);
  m.options.size = 0.5;
  add_expression(&m, "0.15");
  generate(&m);
  laves_mesh_hash(m.mesh, hash[1]);
  assert_string_equal(hash[0], hash[1]);
  drop(&m);
}

static void certificates_hold(void **state) {
  (void)state;
  laves_difference differences[8];
  size_t count;
  laves_certificate certificate;
  laves_certify_options what = laves_certify_options_default();
  made m = of_expression("torus(1, 0.3)", 0.2);
  ask_for_all(&m);
  generate_any(&m);
  what.domain = m.domain;
  what.options = &m.options;
  what.report = &m.report;
  assert_int_equal(laves_certify(m.context, m.mesh, &what, &certificate, &m.error), LAVES_OK);
  assert_true(certificate.check.valid);
  assert_true(certificate.promise_holds);
  assert_int_equal(laves_certificate_verify(m.context, m.mesh, m.domain, NULL, &certificate, differences, 8, &count, &m.error),
                   LAVES_OK);
  if (count > 0) fail_msg("%s", differences[0].text);
  drop(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(points_refine),
      cmocka_unit_test(curves_refine),
      cmocka_unit_test(tags_refine),
      cmocka_unit_test(expressions_of_depth_hold),
      cmocka_unit_test(backgrounds_hold),
      cmocka_unit_test(curvature_counts_elements),
      cmocka_unit_test(walls_have_elements_across),
      cmocka_unit_test(gaps_have_elements_across),
      cmocka_unit_test(close_creases_have_elements_between),
      cmocka_unit_test(thin_walls_of_surfaces_are_whole),
      cmocka_unit_test(distance_is_kept),
      cmocka_unit_test(a_distance_that_cannot_be_kept_is_told),
      cmocka_unit_test(insides_grow),
      cmocka_unit_test(grading_limits_the_slope),
      cmocka_unit_test(the_least_size_counts),
      cmocka_unit_test(counts_are_met),
      cmocka_unit_test(threads_do_not_matter),
      cmocka_unit_test(constant_fields_are_uniform),
      cmocka_unit_test(certificates_hold),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
