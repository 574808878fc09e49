/* A part of an improved layer made anew: what is far from it stays, and both make one mesh. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "assemble/assemble.h"
#include "base/predicates.h"
#include "fixtures/stages.h"
#include "improve/improve.h"
#include "stuff/graft.h"
#include "stuff/stuff.h"
#include "stuff/zone.h"

static const char *const solid = "box(2, 1.8, 2.1)";
static const double size = 0.07;
static const laves__window window = {.min_dihedral = 40, .max_dihedral = 125, .volume_length = 0.6, .held_max = 180};

/* A layer that is improved, one made anew by stuffing in cells around one place, and what is known of the first. */
typedef struct pair {
  stages s; /* the improved layer is its layer */
  laves__layer made, before;
  laves__known_lattice known;
} pair;

/* The cells of which the centre is within `reach` sizes of a place become the zone; returns how many. */
static size_t zone_spot(laves__lattice *lattice, laves__vec3 place, double reach) {
  size_t count = 0;
  for (size_t i = 0; i < lattice->record_count; i++) {
    laves__record *r = &lattice->record[i];
    const laves__vec3 centre =
        v3((r->xyz[0] + 0.5) * LAVES__CELL_SIDE, (r->xyz[1] + 0.5) * LAVES__CELL_SIDE, (r->xyz[2] + 0.5) * LAVES__CELL_SIDE);
    if (v3_distance(centre, place) > reach) continue;
    r->zone = (UINT32_C(1) << LAVES__C15_SITES) - 1;
    count++;
  }
  return count;
}

static void copy_places(const laves__layer *from, laves__layer *to) {
  laves_error error;
  assert_int_equal(laves__layer_create(from->context, from->vertex_count, from->tet_count, to, &error), LAVES_OK);
  memcpy(to->position, from->position, from->vertex_count * sizeof *from->position);
  memcpy(to->origin, from->origin, from->vertex_count * sizeof *from->origin);
}

static void pair_begin(pair *p, double reach, int threads) {
  laves_error error;
  laves__stuff_counts counts;
  memset(p, 0, sizeof *p);
  stages_begin(&p->s, solid, size, threads);
  stages_snap(&p->s);
  assert_int_equal(laves__improve(&p->s.frame, &window, &p->s.layer, &error), LAVES_OK);
  assert_true(laves__known_take(&p->s.lattice, &p->known));
  if (reach > 0) assert_in_range(zone_spot(&p->s.lattice, v3(1 / size, 0, 0), reach), 4, 60);
  assert_int_equal(laves__stuff(&p->s.frame, &laves__guarantees[0], &p->s.lattice, &p->made, &counts, &error), LAVES_OK);
  copy_places(&p->s.layer, &p->before);
}

static void pair_end(pair *p) {
  laves__known_free(&p->known);
  laves__layer_free(&p->before);
  laves__layer_free(&p->made);
  stages_end(&p->s);
}

static void graft(pair *p) {
  laves_error error;
  bool done;
  assert_int_equal(laves__graft(&p->known, &p->s.lattice, &p->made, &p->s.layer, &done, &error), LAVES_OK);
  assert_true(done);
  assert_null(p->made.context); /* it is freed */
}

static size_t count_fresh(const laves__layer *layer) {
  size_t count = 0;
  for (size_t v = 0; v < layer->vertex_count; v++) count += layer->fresh[v];
  return count;
}

/* Vertices at sites that are further than `reach` from the place stand where they did, bit for bit; returns how many. */
static size_t count_same(const pair *p, double reach) {
  const laves__layer *now = &p->s.layer, *before = &p->before;
  size_t count = 0, next = 0;
  for (size_t v = 0; v < now->vertex_count; v++) {
    if (now->origin[v] == LAVES__NO_ORIGIN || now->fresh[v]) continue;
    while (before->origin[next] != now->origin[v]) next++; /* the order is kept */
    assert_true(next < before->vertex_count);
    if (reach > 0 && v3_distance(now->position[v], v3(1 / size, 0, 0)) < reach) continue;
    assert_memory_equal(&now->position[v], &before->position[next], sizeof now->position[v]);
    count++;
  }
  return count;
}

static void assert_valid(pair *p, const char *name, char hash[33]) {
  laves_mesh *mesh;
  laves_error error;
  assert_int_equal(laves__assemble(&p->s.frame, &p->s.lattice, &p->s.layer, false, &mesh, &error), LAVES_OK);
  const laves_check check = check_valid(p->s.context, mesh, name);
  assert_int_equal(check.components, 1);
  assert_int_equal(check.genus, 0);
  assert_true(fabs(check.volume - 2 * 1.8 * 2.1) < 0.3); /* creases are not kept here */
  laves_mesh_hash(mesh, hash);
  laves_mesh_free(mesh);
}

static void what_is_far_stays_bit_for_bit(void **state) {
  (void)state;
  pair p;
  laves_error error;
  char hash[33];
  pair_begin(&p, 3, 0);
  graft(&p);
  laves__layer *layer = &p.s.layer;
  const size_t fresh = count_fresh(layer);
  assert_in_range(fresh, 50, layer->vertex_count / 3);
  assert_true(count_same(&p, 0) > layer->vertex_count / 2);
  for (size_t t = 0; t < layer->tet_count; t++) {
    laves__vec3 q[4];
    laves__layer_points(layer, (int32_t)t, q);
    assert_true(laves__orient3d(q[0], q[1], q[2], q[3]) > 0);
  }
  assert_valid(&p, "grafted", hash);
  const size_t bad = laves__improve_outside(&window, layer);
  assert_int_equal(laves__improve(&p.s.frame, &window, layer, &error), LAVES_OK);
  assert_true(laves__improve_outside(&window, layer) < bad / 4);
  assert_true(count_same(&p, 20) > 500); /* and while the fresh part is improved */
  assert_valid(&p, "grafted and improved", hash);
  pair_end(&p);
}

/* Nothing changed, nothing is fresh: the mesh is the same, though the other layer is not improved. */
static void without_a_change_nothing_is_taken(void **state) {
  (void)state;
  pair p;
  char before[33], after[33];
  pair_begin(&p, 0, 0);
  assert_valid(&p, "before", before);
  graft(&p);
  assert_int_equal(count_fresh(&p.s.layer), 0);
  assert_valid(&p, "after", after);
  assert_string_equal(before, after);
  pair_end(&p);
}

/* What is forgotten everywhere is made anew everywhere. */
static void all_of_it_may_be_taken(void **state) {
  (void)state;
  pair p;
  char hash[33];
  pair_begin(&p, 3, 0);
  for (size_t i = 0; i < p.known.count + 3; i++) laves__known_forget(&p.known, i);
  const size_t made = p.made.vertex_count, tets = p.made.tet_count;
  graft(&p);
  assert_int_equal(count_fresh(&p.s.layer), made);
  assert_int_equal(p.s.layer.tet_count, tets);
  assert_valid(&p, "all anew", hash);
  pair_end(&p);
}

static void threads_change_nothing(void **state) {
  (void)state;
  char hash[2][33];
  for (int i = 0; i < 2; i++) {
    pair p;
    laves_error error;
    pair_begin(&p, 3, i + 1);
    graft(&p);
    assert_int_equal(laves__improve(&p.s.frame, &window, &p.s.layer, &error), LAVES_OK);
    assert_valid(&p, "by threads", hash[i]);
    pair_end(&p);
  }
  assert_string_equal(hash[0], hash[1]);
}

/* A cube with a spot of noise on one side: the promise holds, and the creases that are far from the spot are kept. */
static void a_spot_of_noise_costs_no_creases_elsewhere(void **state) {
  (void)state;
  static const char *const spotted = "box(2) - (gyroid{period=0.17, thickness=0.07} & sphere(0.25):move(1,0,0))";
  char hash[2][33];
  for (int i = 0; i < 2; i++) {
    laves_context_options context_options = laves_context_options_default();
    context_options.thread_count = i + 1;
    laves_context *context = laves_context_create(&context_options);
    laves_options options = options_of_size(0.1);
    options.guarantee = 28;
    laves_report report;
    laves_mesh *mesh = mesh_of_expression(context, spotted, &options, &report);
    const laves_check check = check_valid(context, mesh, "cube with a spot");
    assert_true(check.min_dihedral.min >= report.promised_min_dihedral);
    assert_true(check.max_dihedral.max <= report.promised_max_dihedral);
    assert_in_range(report.stuffed_vertices, 1, 1000);
    assert_true(report.crease_kept > 24); /* the edges of the cube */
    laves_mesh_hash(mesh, hash[i]);
    laves_mesh_free(mesh);
    laves_context_free(context);
  }
  assert_string_equal(hash[0], hash[1]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_far_stays_bit_for_bit),
      cmocka_unit_test(without_a_change_nothing_is_taken),
      cmocka_unit_test(all_of_it_may_be_taken),
      cmocka_unit_test(threads_change_nothing),
      cmocka_unit_test(a_spot_of_noise_costs_no_creases_elsewhere),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
