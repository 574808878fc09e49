/* laves tiling: the tiling over whole periods, measured and set beside Table 1 of "Guaranteed Quality Isotropic
 * Tetrahedral Meshing of Arbitrary Geometric Domains" (section 3.2), and written as a mesh. */
#include <math.h>
#include <stdio.h>

#include "command.h"
#include "output.h"
#include "session.h"
#include "summary.h"
#include "text.h"

enum { TETS_IN_CELL = 136 };

typedef struct tiling_run {
  laves_mesh *mesh;
  laves_check check;
  outputs plan;
  double size;
  int cells[3];
  bool has_check;
} tiling_run;

/* One row of the paper's Table 1: minimum, maximum, average, standard deviation, as printed. */
typedef struct table_row {
  const char *key, *name;
  const char *printed[4];
  int digits; /* after the point, of ours */
} table_row;

static const table_row rows[] = {
    {"min_dihedral", "Min. dihedral angle", {"60.0", "70.53", "64.4", "4.54"}, 2},
    {"max_dihedral", "Max. dihedral angle", {"70.53", "74.21", "72.86", "1.36"}, 2},
    {"radius_ratio", "Normalised aspect ratio", {"0.972", "1.0", "0.982", "0.01"}, 4},
    {"radius_edge", "Normalised radius-edge", {"1.0", "1.16", "1.11", "0.06"}, 4},
};
enum { ROW_COUNT = sizeof rows / sizeof rows[0] };

static const laves_statistic *row_values(const laves_check *check, int row) {
  const laves_statistic *values[ROW_COUNT] = {&check->min_dihedral, &check->max_dihedral, &check->radius_ratio,
                                              &check->radius_edge};
  return values[row];
}

static void say_table(const tiling_run *all) {
  text_say("%-25s %8s %8s %8s %8s", "Quality measure", "minimum", "maximum", "average", "std. dev.");
  for (int i = 0; i < ROW_COUNT; ++i) {
    const laves_statistic *v = row_values(&all->check, i);
    const int d = rows[i].digits;
    text_say("%-25s %8.*f %8.*f %8.*f %8.*f", rows[i].name, d, v->min, d, v->max, d, v->mean, d, v->deviation);
    text_say("%-25s %8s %8s %8s %8s", "  as the paper prints it", rows[i].printed[0], rows[i].printed[1], rows[i].printed[2],
             rows[i].printed[3]);
  }
  text_say(
      "\nThe extremes agree to every digit printed. The paper's averages and deviations do not: they fit no whole\n"
      "number of periods, so they must come from some finite patch. Ours are those of the infinite tiling.");
}

static void say_tiling(const tiling_run *all) {
  text_buffer tets, vertices;
  text_say("C15 tiling, %d x %d x %d cells: %s (%d in each cell), %s, edges %.6g .. %.6g\n", all->cells[0], all->cells[1],
           all->cells[2], text_plural(&tets, all->check.tets, "tet"), TETS_IN_CELL,
           text_plural(&vertices, all->check.vertices, "vertex"), all->check.edge_min, all->check.edge_max);
  say_table(all);
  outputs_say(&all->plan);
}

static laves_result tiling_steps(session *run, tiling_run *all) {
  const settings *given = run->given;
  all->size = given->size > 0 ? given->size : 1;
  for (int i = 0; i < 3; ++i) all->cells[i] = (int)given->cells.values[i];
  laves_result result = outputs_plan(run, NULL, NULL, &all->plan);
  if (result != LAVES_OK) return result;
  result = session_settle(run, laves_generate_tiling(run->context, all->cells, all->size, &all->mesh, &run->error));
  if (result != LAVES_OK) return result;
  result = session_settle(run, laves_check_mesh(run->context, all->mesh, NULL, &all->check, &run->error));
  if (result != LAVES_OK) return result;
  all->has_check = true;
  result = outputs_write(run, all->mesh, NULL, &all->plan);
  if (result == LAVES_OK && session_speaks(run)) say_tiling(all);
  return result;
}

static void tiling_json(json *out, const session *run, const void *facts) {
  const tiling_run *all = facts;
  if (!all->has_check) return;
  char hash[33];
  laves_mesh_hash(all->mesh, hash);
  json_text(out, "hash", hash);
  json_number(out, "size", all->size);
  json_numbers(out, "cells", (const double[3]){all->cells[0], all->cells[1], all->cells[2]}, 3);
  summary_check_json(out, &all->check);
  outputs_write_json(out, &all->plan);
  json_open_object(out, "seconds");
  json_number(out, "write", all->plan.seconds);
  json_number(out, "total", progress_now() - run->start);
  json_close(out);
}

int command_tiling(const settings *given) {
  session run;
  tiling_run all = {0};
  if (!session_open(&run, given)) return laves_result_exit_code(LAVES_ERROR_MEMORY);
  laves_result result = tiling_steps(&run, &all);
  session_write_json(&run, &result, tiling_json, &all);
  laves_mesh_free(all.mesh);
  return session_close(&run, result);
}
