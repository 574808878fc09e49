/* Thin walls and narrow gaps keep their topology, in every position of the lattice, whether the solid is a surface or an
 * expression. LAVES_SEEDS sets how many of the 12 positions are tried. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/stages.h"
#include "fixtures/stride.h"
#include "fixtures/thin_solids.h"

enum { POSITIONS = 2, POSITIONS_MAX = 12 };

static int position_count(void) {
  const char *text = getenv("LAVES_SEEDS");
  const int count = text ? atoi(text) : test_stride() > 1 ? 1 : POSITIONS;
  return count < POSITIONS_MAX ? count : POSITIONS_MAX;
}

static laves_options turned_options(int position) {
  laves_options options = options_of_size(1);
  options.align = LAVES_ALIGN_ROTATION;
  thin_rotation(position, options.rotation);
  return options;
}

/* Meshes one solid and compares its topology with the truth; the report must agree. Returns the check. */
static laves_check mesh_thin(laves_context *context, thin_kind kind, double width, bool triangles, int position) {
  char name[100];
  snprintf(name, sizeof name, "%s of %g from %s, position %d", thin_name(kind), width, triangles ? "triangles" : "an expression",
           position);
  laves_domain *domain = thin_domain(context, kind, width, triangles);
  const laves_options options = turned_options(position);
  const thin_topology truth = thin_truth(kind);
  laves_mesh *mesh;
  laves_report report;
  laves_error error = {.text = ""};
  if (laves_generate(context, domain, &options, &mesh, &report, &error) != LAVES_OK) fail_msg("%s: %s", name, error.text);
  const laves_check check = check_valid(context, mesh, name);
  if (check.components != truth.components || check.boundary_components != truth.boundary_components ||
      check.genus != truth.genus)
    fail_msg("%s: %zu parts, %zu pieces of boundary, genus %lld", name, check.components, check.boundary_components,
             (long long)check.genus);
  assert_int_equal(report.pieces, check.boundary_components);
  assert_int_equal(report.genus, check.genus);
  assert_int_equal(report.topology_known, triangles);
  if (triangles) {
    assert_int_equal(report.domain_pieces, truth.boundary_components);
    assert_int_equal(report.domain_genus, truth.genus);
  }
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  return check;
}

/* All positions of one solid, from triangles and as an expression. */
static void try_width(laves_context *context, thin_kind kind, double width) {
  double least = 180, most = 0;
  for (int position = 0; position < position_count(); position++)
    for (int triangles = 0; triangles < 2; triangles++) {
      const laves_check check = mesh_thin(context, kind, width, triangles, position);
      least = fmin(least, check.min_dihedral.min);
      most = fmax(most, check.max_dihedral.max);
    }
  print_message("%-12s %.2f: %.1f to %.1f degrees\n", thin_name(kind), width, least, most);
  if (kind == THIN_SHELL || kind == GAP_ROUND) /* smooth: no edge of the solid has a say */
    assert_true(width < 0.75 ? least > 30 && most < 140 : least >= 35 && most <= 130);
}

static void walls_keep_their_topology(void **state) {
  (void)state;
  static const double widths[] = {0.5, 0.75, 1, 1.5, 2, 3};
  laves_context *context = laves_context_create(NULL);
  for (int kind = THIN_PLATE; kind <= THIN_TUBE; kind++)
    for (size_t i = 0; i < LAVES__COUNT_OF(widths); i += (size_t)test_stride()) try_width(context, (thin_kind)kind, widths[i]);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void gaps_stay_open(void **state) {
  (void)state;
  static const double widths[] = {0.75, 1, 1.5, 2};
  laves_context *context = laves_context_create(NULL);
  for (int kind = GAP_PLATES; kind <= GAP_ROUND; kind++)
    for (size_t i = 0; i < LAVES__COUNT_OF(widths); i += (size_t)test_stride()) try_width(context, (thin_kind)kind, widths[i]);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

/* A gap of 0.3 sizes is below what is promised: where a mesh closes it, the report says so, and where. */
static void what_is_lost_is_named(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  int named = 0;
  for (int position = 0; position<6; position += test_stride()> 1 ? 3 : 1) {
    laves_domain *domain = thin_domain(context, GAP_PLATES, 0.3, true);
    laves_options options = turned_options(position);
    laves_mesh *mesh;
    laves_report report;
    assert_int_equal(laves_generate(context, domain, &options, &mesh, &report, NULL), LAVES_OK);
    assert_true(report.topology_known);
    const bool lost = report.pieces != report.domain_pieces || report.genus != report.domain_genus;
    bool said = false;
    for (int i = 0; i < report.warning_count; i++) said |= strstr(report.warnings[i], "genus") != NULL;
    assert_int_equal(lost, said);
    if (lost) {
      assert_true(report.lost_count > 0);
      bool gap = false;
      for (size_t i = 0; i < report.lost_count; i++)
        gap |= report.lost[i].kind == LAVES_THIN_GAP && fabs(report.lost[i].thickness - 0.3) < 0.01 &&
               fabs(report.lost[i].place[2]) < 0.16;
      assert_true(gap);
      named++;
    }
    laves_mesh_free(mesh);
    laves_domain_free(domain);
  }
  print_message("a gap of 0.3 sizes was closed, and named, in %d positions\n", named);
  assert_true(named > 0);
  laves_context_free(context);
}

/* Without the rules for thin parts a plate of half a size is not one plate. */
static void the_rules_can_be_left_out(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain = thin_domain(context, THIN_PLATE, 0.5, true);
  laves_options options = turned_options(1);
  options.method = LAVES_METHOD_SNAP;
  options.keep_thin = false;
  laves_mesh *mesh = NULL;
  laves_report report;
  laves_error error;
  const laves_result result = laves_generate(context, domain, &options, &mesh, &report, &error);
  assert_true(result == LAVES_ERROR_INPUT || report.pieces != 1 || report.genus != 0);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  laves_context_free(context);
}

/* Gaps are found by chords outwards, as walls are inwards. */
static void gaps_are_found(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_thin_place places[4];
  laves_domain *domain = thin_domain(context, GAP_PLATES, 0.7, true);
  assert_true(laves_domain_gap_places(domain, places, 4) == 4);
  for (int i = 0; i < 4; i++) {
    assert_int_equal(places[i].kind, LAVES_THIN_GAP);
    assert_true(fabs(places[i].thickness - 0.7) < 1e-6 && fabs(places[i].place[2]) < 1e-6);
  }
  assert_true(laves_domain_thin_places(domain, places, 4) > 0);
  assert_int_equal(places[0].kind, LAVES_THIN_WALL);
  laves_domain_free(domain);
  domain = thin_domain(context, THIN_PLATE, 1, true);
  assert_int_equal(laves_domain_gap_places(domain, places, 4), 0);
  laves_domain_free(domain);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(walls_keep_their_topology), cmocka_unit_test(gaps_stay_open), cmocka_unit_test(what_is_lost_is_named),
      cmocka_unit_test(the_rules_can_be_left_out), cmocka_unit_test(gaps_are_found),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
