/* An explicit background: the same tiles give the same mesh as the tiling itself, and any graph gives a valid one. */
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#include "assemble/assemble.h"
#include "background/site.h"
#include "classify/classify.h"
#include "fixtures/graphs.h"
#include "fixtures/hard_solids.h"
#include "fixtures/noise.h"
#include "fixtures/stages.h"
#include "fixtures/stride.h"
#include "snap/snap.h"

enum { ROOM = 2 }; /* cells round the bounds, so that the hull is far */

/* The tiles round the bounds of a frame. */
static laves__graph tiles_around(laves_context *context, const laves__frame *frame, int32_t lower[3], int32_t cells[3]) {
  const laves__box3 box = laves__frame_bounds(frame);
  const double from[3] = {box.lower.x, box.lower.y, box.lower.z}, to[3] = {box.upper.x, box.upper.y, box.upper.z};
  for (int axis = 0; axis < 3; axis++) {
    lower[axis] = (int32_t)floor(from[axis] / LAVES__CELL_SIDE) - ROOM;
    cells[axis] = (int32_t)floor(to[axis] / LAVES__CELL_SIDE) + ROOM + 1 - lower[axis];
  }
  return graph_of_tiling(context, lower, cells);
}

static void must(laves_result result, const laves_error *error) {
  if (result != LAVES_OK) fail_msg("%s", error->text);
}

static laves_mesh *assemble(stages *s) {
  laves_mesh *mesh;
  laves_error error;
  must(laves__assemble(&s->frame, &s->lattice, &s->layer, false, &mesh, &error), &error);
  return mesh;
}

/* All stages on a graph. */
static laves_mesh *mesh_graph(stages *s, laves__graph *graph) {
  laves_error error;
  laves__snap_counts counts = {0};
  must(laves__lattice_of_graph(s->context, graph, &s->lattice, &error), &error);
  must(laves__classify(&s->frame, &s->lattice, &error), &error);
  must(laves__snap(&s->frame, true, &s->lattice, &s->layer, &counts, &error), &error);
  s->pinches = counts.pinches;
  return assemble(s);
}

static size_t count_surface(const laves__layer *layer) {
  size_t count = 0;
  for (size_t v = 0; v < layer->vertex_count; v++) count += layer->depth[v] == 0;
  return count;
}

/* The vertex of the tiling's layer where a site of the graph is, or -1. */
static int32_t vertex_in_tiling(const laves__lattice *l, uint32_t origin, const int32_t lower[3], const int32_t cells[3]) {
  const int32_t i = (int32_t)(origin / LAVES__C15_SITES);
  const int32_t cell =
      laves__lattice_cell(l, lower[0] + i % cells[0], lower[1] + i / cells[0] % cells[1], lower[2] + i / cells[0] / cells[1]);
  return cell < 0 ? -1 : l->record[cell].vertex[origin % LAVES__C15_SITES];
}

static const char *const solids[] = {"sphere(1)", "torus(1, 0.4):move(0.03, 0.02, 0.01)", "torus(1, 0.4) - box(0.5)",
                                     "x^2 + y^2 + z^4 - 1"};

/* `factor`: the graph is this much larger, and the frame's size smaller; `tolerance` in sizes. */
static void compare_with_tiling(const char *expression, double factor, double tolerance) {
  stages plain, s;
  int32_t lower[3], cells[3];
  stages_begin(&plain, expression, 0.11, 0);
  plain.frame.centre = v3_add(plain.frame.centre, v3(0.011, 0.017, 0.005)); /* no site is as far as another */
  stages_snap(&plain);
  laves_mesh *wanted = assemble(&plain);
  stages_begin(&s, expression, 0.11 / factor, 0);
  s.frame.centre = plain.frame.centre;
  laves__graph graph = tiles_around(s.context, &plain.frame, lower, cells);
  if (factor != 1) graph_enlarge(&graph, factor);
  laves_mesh *mesh = mesh_graph(&s, &graph);

  assert_int_equal(s.pinches, plain.pinches);
  assert_int_equal(s.layer.vertex_count, plain.layer.vertex_count);
  assert_int_equal(s.layer.tet_count, plain.layer.tet_count);
  assert_int_equal(count_surface(&s.layer), count_surface(&plain.layer));
  assert_true(count_surface(&s.layer) > 100);
  for (size_t v = 0; v < s.layer.vertex_count; v++) {
    assert_true(s.layer.scale[v] == (float)factor);
    if (s.layer.origin[v] == LAVES__NO_ORIGIN) continue;
    const int32_t other = vertex_in_tiling(&plain.lattice, s.layer.origin[v], lower, cells);
    if (other == -1) fail_msg("%s: a vertex that the tiling has not", expression);
    if (other < 0) continue; /* parted in both */
    assert_int_equal(s.layer.depth[v], plain.layer.depth[other]);
    const laves__vec3 at = v3_scale(s.layer.position[v], 1 / factor);
    if (!(v3_distance(at, plain.layer.position[other]) < tolerance)) fail_msg("%s: a vertex stands elsewhere", expression);
  }
  const laves_check check = check_valid(s.context, mesh, expression);
  assert_int_equal(check.tets, wanted->tet_count);
  assert_int_equal(check.vertices, wanted->vertex_count);
  assert_int_equal(check.faces, wanted->face_count);
  assert_int_equal(mesh->lattice_tet_count, wanted->lattice_tet_count);

  int64_t vertices, tets;
  laves__assemble_estimate(&s.lattice, &s.layer, &vertices, &tets);
  assert_int_equal(tets, mesh->tet_count);
  laves_mesh_free(mesh);
  laves_mesh_free(wanted);
  laves__graph_free(&graph);
  stages_end(&s);
  stages_end(&plain);
}

static void tiles_give_the_mesh_of_the_tiling(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i += (size_t)test_stride()) compare_with_tiling(solids[i], 1, 1e-9);
}

static void all_is_relative_to_the_scale(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i += (size_t)test_stride()) {
    compare_with_tiling(solids[i], 2, 1e-9);
    compare_with_tiling(solids[i], 1.0 / 3, 1e-5); /* what projection leaves over */
  }
}

/* Signs are those of the oracle, whatever was spared. */
static void signs_are_the_oracles(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(solids); i++) {
    stages s;
    laves_error error;
    int32_t lower[3], cells[3];
    size_t spared = 0;
    stages_begin(&s, solids[i], 0.1, 0);
    laves__graph graph = tiles_around(s.context, &s.frame, lower, cells);
    must(laves__lattice_of_graph(s.context, &graph, &s.lattice, &error), &error);
    must(laves__classify(&s.frame, &s.lattice, &error), &error);
    for (size_t v = 0; v < graph.vertex_count; v++) {
      double phi;
      laves__frame_evaluate(&s.frame, 1, &graph.position[v], &phi, NULL);
      const laves__site at = laves__site_of((uint32_t)v);
      const laves__record *r = &s.lattice.record[at.cell];
      assert_int_equal(r->sign[at.site], phi < 0 && !graph.hull[v] ? -1 : 1);
      assert_int_equal(r->label[at.site], r->sign[at.site]);
      if (isfinite(r->phi[at.site])) {
        assert_true(fabs(r->phi[at.site] - phi) <= 1e-12 * (1 + fabs(phi)));
        continue;
      }
      spared++;
      const laves__ring ring = laves__ring_of(&s.lattice, at);
      for (int k = 0; k < ring.count; k++)
        assert_int_equal(laves__site_sign(&s.lattice, laves__ring_at(&ring, k)), r->sign[at.site]);
    }
    assert_true(spared > graph.vertex_count / 4);
    laves__graph_free(&graph);
    stages_end(&s);
  }
}

/* Where sizes differ: valid, ON the surface, of the right genus; C15 tiles come first. */
static void sizes_may_differ(void **state) {
  (void)state;
  static const int genus[] = {0, 1};
  for (size_t i = 0; i < LAVES__COUNT_OF(genus); i++) {
    stages s;
    int32_t lower[3], cells[3];
    stages_begin(&s, solids[i], 0.07, 0);
    s.frame.centre = v3_add(s.frame.centre, v3(0.5, 0.1, 0));
    laves__graph graph = tiles_around(s.context, &s.frame, lower, cells);
    graph_swell(&graph, 0.6, 1 / 0.07);
    for (size_t t = 0; t < graph.tet_count; t++)
      if (graph.position[graph.tet[t][0]].x > 0) graph.tile[t] = LAVES__TILE_BCC;
    laves_mesh *mesh = mesh_graph(&s, &graph);
    const laves_check check = check_valid(s.context, mesh, solids[i]);
    assert_int_equal(check.genus, genus[i]);
    for (size_t v = 0; v < s.layer.vertex_count; v++) {
      double phi;
      if (s.layer.depth[v] != 0 || s.layer.off_surface[v]) continue;
      laves__frame_evaluate(&s.frame, 1, &s.layer.position[v], &phi, NULL);
      assert_true(fabs(phi) < 1e-6);
    }
    size_t tiles = 0;
    for (size_t t = 0; t < graph.tet_count; t++) tiles += graph.tile[t] == LAVES__TILE_C15 && graph.flags[t] & LAVES__TET_STAMPED;
    assert_true(tiles > 100);
    assert_int_equal(mesh->lattice_tet_count, tiles);
    for (size_t t = 0; t < tiles; t++) {
      double nearest = HUGE_VAL;
      for (int k = 0; k < 4; k++) nearest = fmin(nearest, mesh->points[mesh->tets[t][k]].x);
      assert_true(nearest <= s.frame.centre.x + s.domain->oracle.origin.x + 1e-12);
    }
    laves_mesh_free(mesh);
    laves__graph_free(&graph);
    stages_end(&s);
  }
}

/* Whatever the oracle says, what comes out is valid, or nothing; `cubes`: stars of 48 tets. */
static void try_function(const laves_function *function, const char *name, bool cubes, size_t *meshes, size_t *pinches) {
  stages s;
  int32_t lower[3], cells[3];
  stages_begin_function(&s, function, 0.26);
  laves__graph graph = cubes ? graph_of_cubes(s.context, 9) : tiles_around(s.context, &s.frame, lower, cells);
  graph_swell(&graph, 0.3, 1 / 0.26);
  laves_mesh *mesh = mesh_graph(&s, &graph);
  if (mesh->tet_count > 0) {
    check_valid(s.context, mesh, name);
    ++*meshes;
  }
  *pinches += s.pinches;
  laves_mesh_free(mesh);
  laves__graph_free(&graph);
  stages_end(&s);
}

static void hard_solids_are_valid_or_nothing(void **state) {
  (void)state;
  for (int cubes = 0; cubes < 2; cubes++) {
    size_t meshes = 0, pinches = 0;
    for (int i = 0; i < hard_solid_count; i += test_stride()) {
      const laves_function function = hard_function(&hard_solids[i]);
      try_function(&function, hard_solids[i].name, cubes, &meshes, &pinches);
    }
    print_message("%zu meshes, %zu pinches\n", meshes, pinches);
    assert_true(meshes > 20 / (size_t)test_stride() && (test_stride() > 1 || pinches > 10));
  }
}

static void noise_is_valid(void **state) {
  (void)state;
  for (int cubes = 0; cubes < 2; cubes++)
    for (uint64_t run = 0; run < 3; run++) {
      size_t meshes = 0, pinches = 0;
      noise n = {.kind = run == 2 ? NOISE_FRACTAL : NOISE_WHITE, .seed = run, .scale = 4};
      const laves_function function = noise_function(&n);
      try_function(&function, "noise", cubes, &meshes, &pinches);
      assert_int_equal(meshes, 1);
    }
}

static void threads_change_nothing(void **state) {
  (void)state;
  laves_mesh *mesh[2];
  stages s[2];
  laves__graph graph[2];
  for (int i = 0; i < 2; i++) {
    stages_begin(&s[i], solids[2], 0.09, i == 0 ? 1 : 4);
    graph[i] = graph_of_cubes(s[i].context, 26);
    graph_swell(&graph[i], 0.5, 13);
    mesh[i] = mesh_graph(&s[i], &graph[i]);
    check_valid(s[i].context, mesh[i], "on cubes");
    assert_int_equal(mesh[i]->lattice_tet_count, 0);
  }
  assert_true(same_connectivity(mesh[0], mesh[1]));
  assert_memory_equal(mesh[0]->points, mesh[1]->points, mesh[0]->vertex_count * sizeof *mesh[0]->points);
  for (int i = 0; i < 2; i++) {
    laves_mesh_free(mesh[i]);
    laves__graph_free(&graph[i]);
    stages_end(&s[i]);
  }
}

/* All stages within a limit; *before: the most bytes there were before the first stage, *peak: in all. */
static laves_result run_limited(size_t limit, size_t *before, size_t *peak) {
  laves_context_options options = laves_context_options_default();
  options.memory_limit = limit;
  stages s;
  memset(&s, 0, sizeof s);
  s.context = laves_context_create(&options);
  laves_error error;
  laves__snap_counts counts = {0};
  laves_mesh *mesh = NULL;
  noise n = {.kind = NOISE_FRACTAL, .seed = 1, .scale = 2};
  const laves_function function = noise_function(&n);
  must(laves_domain_from_function(s.context, &function, &s.domain, &error), &error);
  s.frame = (laves__frame){.oracle = &s.domain->oracle, .rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, .size = 0.3};
  laves__graph graph = graph_of_cubes(s.context, 8);
  *before = laves_context_peak_bytes(s.context);
  laves_result result = laves__lattice_of_graph(s.context, &graph, &s.lattice, &error);
  if (result == LAVES_OK) result = laves__classify(&s.frame, &s.lattice, &error);
  if (result == LAVES_OK) result = laves__snap(&s.frame, true, &s.lattice, &s.layer, &counts, &error);
  if (result == LAVES_OK) result = laves__assemble(&s.frame, &s.lattice, &s.layer, false, &mesh, &error);
  *peak = laves_context_peak_bytes(s.context);
  laves_mesh_free(mesh);
  laves__graph_free(&graph);
  stages_end(&s);
  return result;
}

static void short_memory_is_told(void **state) {
  (void)state;
  enum { STEPS = 40 };
  size_t before, peak, first, last;
  assert_int_equal(run_limited(0, &before, &peak), LAVES_OK);
  for (size_t step = 0; step < STEPS; step += (size_t)test_stride()) {
    const laves_result result = run_limited(before + (peak - before) * step / STEPS, &first, &last);
    assert_int_equal(result, LAVES_ERROR_MEMORY);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(tiles_give_the_mesh_of_the_tiling),
      cmocka_unit_test(all_is_relative_to_the_scale),
      cmocka_unit_test(signs_are_the_oracles),
      cmocka_unit_test(sizes_may_differ),
      cmocka_unit_test(hard_solids_are_valid_or_nothing),
      cmocka_unit_test(noise_is_valid),
      cmocka_unit_test(threads_change_nothing),
      cmocka_unit_test(short_memory_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
