/* Stuffing as a stage: crossings, the window, relaxation, the rim of a zone, and the same mesh for any number of threads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "assemble/assemble.h"
#include "fixtures/stages.h"
#include "fixtures/stride.h"
#include "stuff/stuff.h"
#include "stuff/stuffing.h"
#include "stuff/zone.h"

static laves_options options_of_method(double size, laves_method method, bool improve) {
  laves_options options = options_of_size(size);
  options.method = method;
  options.improve = improve;
  return options;
}

static void crossings_lie_on_the_surface(void **state) {
  (void)state;
  stages s;
  laves_error error;
  stages_begin(&s, "x^4 + y^4 + z^4 - 1", 0.2, 1);
  stages_classify(&s);
  laves__zone_everything(&s.lattice);
  laves__stuffing stuffing = {.frame = &s.frame,
                              .guarantee = &laves__guarantees[0],
                              .lattice = &s.lattice,
                              .site_count = s.lattice.record_count * LAVES__C15_SITES};
  laves__links_fill(&stuffing.links);
  assert_int_equal(laves__find_crossings(&stuffing, &error), LAVES_OK);
  size_t count = 0;
  for (size_t id = 0; id < stuffing.site_count; id++) {
    const laves__site site = laves__site_of((uint32_t)id);
    const laves__record *r = &s.lattice.record[site.cell];
    for (int k = 0; k < laves__c15_degree[site.site]; k++) {
      const laves__site other = laves__neighbour(r, site.site, k);
      int slot;
      const laves__crossings *c = laves__crossing_at(&stuffing, site, k, &slot);
      assert_int_equal(c != NULL, r->sign[site.site] != laves__site_sign(&s.lattice, other));
      if (!c || r->sign[site.site] > 0) continue;
      const laves__vec3 p = v3_lerp(laves__site_position(r->xyz, site.site),
                                    laves__site_position(s.lattice.record[other.cell].xyz, other.site), c->fraction[slot]);
      double phi;
      laves__frame_evaluate(&s.frame, 1, &p, &phi, NULL);
      assert_true(fabs(phi) < 1e-7);
      count++;
    }
  }
  assert_true(count > 1000);
  laves__free_stuffing(&stuffing);
  stages_end(&s);
}

static void stuffed_vertices_lie_on_the_surface(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  const laves_options options = options_of_method(0.15, LAVES_METHOD_STUFF, false);
  laves_report report;
  laves_mesh *mesh = mesh_of_expression(context, "sphere(1)", &options, &report);
  const laves_check check = check_valid(context, mesh, "stuffed sphere");
  assert_true(check.min_dihedral.min >= 14.4 && check.max_dihedral.max <= 149.65);
  assert_int_equal(check.genus, 0);
  assert_int_equal(check.components, 1);
  assert_int_equal(report.relaxed_vertices, 0);
  assert_int_equal(report.off_surface, 0);
  assert_true(report.stuffed_vertices > 500);
  for (size_t f = 0; f < mesh->face_count; f++)
    for (int k = 0; k < 3; k++) assert_true(fabs(v3_norm(mesh->points[mesh->faces[f][k]]) - 1) < 1e-7);
  laves_mesh_free(mesh);
  laves_context_free(context);
}

/* The higher the guarantee, the more vertices of a rough solid are moved, and it is told how many and how far. */
static void relaxation_is_told(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  size_t fewer = 0;
  for (int i = 0; i < LAVES__GUARANTEES; i++) {
    laves_options options = options_of_method(0.1, LAVES_METHOD_STUFF, false);
    options.guarantee = laves__guarantees[i].min_dihedral;
    laves_report report;
    laves_mesh *mesh = mesh_of_expression(context, "sin(23*x)*sin(21*y)*sin(22*z) & sphere(1)", &options, &report);
    const laves_check check = check_valid(context, mesh, "relaxed waves");
    assert_true(check.min_dihedral.min >= laves__guarantees[i].min_dihedral);
    assert_true(check.max_dihedral.max <= laves__guarantees[i].max_dihedral);
    assert_true(report.promised_min_dihedral == laves__guarantees[i].min_dihedral);
    assert_int_equal(report.relaxed_vertices > 0, report.relaxed_max > 0);
    assert_true(report.relaxed_max < 0.51 * report.size);
    assert_true(report.relaxed_vertices >= fewer);
    assert_true(i > 0 || report.relaxed_vertices == 0);
    fewer = report.relaxed_vertices;
    laves_mesh_free(mesh);
  }
  assert_true(fewer > 100);
  laves_context_free(context);
}

/* Half of a snapped solid is stuffed: the mesh conforms across the rim. What floated by itself beyond it stays away. */
static void zones_join(void **state) {
  (void)state;
  static const char *const solids[] = {"sphere(1)", "torus(1, 0.3)", "sphere(1) - sphere(0.8)",
                                       "sphere(1) | box(2, 0.05, 0.05):move(-1, 0, 0)"};
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++) {
    stages s;
    laves_error error;
    laves_mesh *mesh;
    laves__stuff_counts counts;
    stages_begin(&s, solids[i], 0.13, 2);
    stages_snap(&s);
    for (size_t r = 0; r < s.lattice.record_count; r++)
      if (s.lattice.record[r].xyz[0] > 0) s.lattice.record[r].zone = (UINT32_C(1) << LAVES__C15_SITES) - 1;
    laves__layer_free(&s.layer);
    assert_int_equal(laves__stuff(&s.frame, &laves__guarantees[0], &s.lattice, &s.layer, &counts, &error), LAVES_OK);
    assert_true(counts.vertices > 0);
    assert_int_equal(laves__assemble(&s.frame, &s.lattice, &s.layer, false, &mesh, &error), LAVES_OK);
    const laves_check check = check_valid(s.context, mesh, solids[i]);
    assert_int_equal(check.components, 1);
    assert_int_equal(check.genus, i == 1);
    assert_int_equal(counts.specks > 0, i == 3);
    laves_mesh_free(mesh);
    stages_end(&s);
  }
}

/* The whole component of a zone, and no other. */
static void zones_take_components(void **state) {
  (void)state;
  stages s;
  stages_begin(&s, "sphere(0.5):move(-2, 0, 0) | sphere(0.5):move(2, 0, 0)", 0.1, 1);
  stages_classify(&s);
  for (size_t r = 0; r < s.lattice.record_count; r++) assert_int_equal(s.lattice.record[r].zone, 0);
  s.lattice.record[0].zone = 1;
  const bool left = s.lattice.record[0].xyz[0] < 0;
  assert_true(laves__zone_components(&s.lattice));
  for (size_t r = 0; r < s.lattice.record_count; r++)
    assert_int_equal(s.lattice.record[r].zone != 0, (s.lattice.record[r].xyz[0] < 0) == left);
  stages_end(&s);
}

/* Snapping alone breaks a window that the default then keeps. */
static void broken_promises_are_mended(void **state) {
  (void)state;
  static const char waves[] = "sin(11*x)*sin(12*y)*sin(13*z) & sphere(1)";
  laves_context *context = laves_context_create(NULL);
  laves_report report;
  const laves_options snapped = options_of_method(0.1, LAVES_METHOD_SNAP, false);
  laves_mesh *mesh = mesh_of_expression(context, waves, &snapped, &report);
  laves_check check = check_valid(context, mesh, "snapped waves");
  assert_true(check.min_dihedral.min < 14.4 || check.max_dihedral.max > 149.65);
  assert_true(report.promised_min_dihedral == 0 && report.promised_max_dihedral == 180);
  assert_int_equal(report.stuffed_vertices, 0);
  laves_mesh_free(mesh);
  const laves_options mended = options_of_method(0.1, LAVES_METHOD_AUTO, false);
  mesh = mesh_of_expression(context, waves, &mended, &report);
  check = check_valid(context, mesh, "mended waves");
  assert_true(check.min_dihedral.min >= 14.4 && check.max_dihedral.max <= 149.65);
  assert_true(report.stuffed_vertices > 0);
  laves_mesh_free(mesh);
  laves_context_free(context);
}

static void threads_change_nothing(void **state) {
  (void)state;
  static const laves_method methods[] = {LAVES_METHOD_AUTO, LAVES_METHOD_STUFF};
  for (int i = 0; i<4; i += test_stride()> 1 ? 3 : 1) {
    char first[33], other[33];
    for (int threads = 1; threads <= 3; threads += 2) {
      laves_context_options many = laves_context_options_default();
      many.thread_count = threads;
      laves_context *context = laves_context_create(&many);
      laves_options options = options_of_method(test_stride() > 1 ? 0.4 : 0.22, methods[i % 2], true);
      options.guarantee = i / 2 ? 28 : 14.4;
      laves_mesh *mesh = mesh_of_expression(context, "sin(11*x)*sin(12*y)*sin(13*z) & sphere(1)", &options, NULL);
      laves_mesh_hash(mesh, threads == 1 ? first : other);
      if (threads > 1) assert_string_equal(first, other);
      laves_mesh_free(mesh);
      laves_context_free(context);
    }
  }
}

static void limited_memory_is_told(void **state) {
  (void)state;
  for (size_t limit = 100000; limit < 2000000; limit += 190000) {
    laves_context_options limited = laves_context_options_default();
    limited.memory_limit = limit;
    laves_context *context = laves_context_create(&limited);
    const laves_options options = options_of_method(0.2, LAVES_METHOD_STUFF, true);
    laves_domain *domain;
    laves_mesh *mesh;
    if (laves_domain_from_expression(context, "sphere(1)", &domain, NULL) == LAVES_OK) {
      const laves_result result = laves_generate(context, domain, &options, &mesh, NULL, NULL);
      assert_true(result == LAVES_OK || result == LAVES_ERROR_MEMORY);
      assert_int_equal(mesh != NULL, result == LAVES_OK);
      laves_mesh_free(mesh);
      laves_domain_free(domain);
    }
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
  }
}

/* A lone site would stand for the whole solid with a piece as large as an edge. */
static void lumps_are_refused(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  const laves_options options = options_of_size(9);
  laves_domain *domain;
  laves_mesh *mesh;
  laves_error error;
  assert_int_equal(laves_domain_from_expression(context, "sphere(1)", &domain, &error), LAVES_OK);
  assert_int_equal(laves_generate(context, domain, &options, &mesh, NULL, &error), LAVES_ERROR_INPUT);
  assert_null(mesh);
  assert_non_null(strstr(error.text, "choose a smaller size"));
  laves_domain_free(domain);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(crossings_lie_on_the_surface),
      cmocka_unit_test(stuffed_vertices_lie_on_the_surface),
      cmocka_unit_test(relaxation_is_told),
      cmocka_unit_test(zones_join),
      cmocka_unit_test(zones_take_components),
      cmocka_unit_test(broken_promises_are_mended),
      cmocka_unit_test(threads_change_nothing),
      cmocka_unit_test(limited_memory_is_told),
      cmocka_unit_test(lumps_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
