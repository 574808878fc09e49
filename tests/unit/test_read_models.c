/* Every surface among the development models: counts of points and triangles as the files give them, and time. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "domain/surface_input.h"
#include "io/file.h"

typedef struct model {
  const char *name, *format;
  size_t point_count, triangle_count;
} model;

static const model MODELS[] = {
    {"1002_tray_bottom.STL", "STL (ASCII)", 13560, 4520},
    {"20mm-xyz-cube.stl", "STL (binary)", 780, 260},
    {"Offset1.obj", "OBJ", 2287, 4418},
    {"beetle.obj", "OBJ", 1148, 2053},
    {"block.obj", "OBJ", 2798, 5604},
    {"bunny-nonmanifold.ply", "PLY (ASCII)", 8171, 16301},
    {"bunny.obj", "OBJ", 3301, 6598},
    {"cow.obj", "OBJ", 2904, 5804},
    {"cube.off", "OFF", 8, 12},
    {"decimated-knight.off", "OFF", 502, 1000},
    {"dragon.obj", "OBJ", 50000, 100000},
    {"fandisk.obj", "OBJ", 6475, 12946},
    {"featuretype.ply", "PLY (ASCII)", 5096, 3476},
    {"fertility.off", "OFF", 4494, 9000},
    {"fixed_top.ply", "PLY (binary, little endian)", 2374, 4772},
    {"hand_closed.obj", "OBJ", 7993, 15982},
    {"homer.obj", "OBJ", 6002, 12000},
    {"horse.ply", "PLY (binary, little endian)", 48485, 96966},
    {"hour_glass.off", "OFF", 259, 512},
    {"joint.obj", "OBJ", 221, 446},
    {"octagonal_pocket.stl", "STL (binary)", 9786, 3262},
    {"penguin_micro.off", "OFF", 3362, 6720},
    {"plate_holes.STL", "STL (binary)", 3756, 1252},
    {"rabbit.obj", "OBJ", 644, 1252},
    {"rocker-arm.obj", "OBJ", 10044, 20088},
    {"self_intersectA.obj", "OBJ", 8582, 17160},
    {"soup.stl", "STL (binary)", 300, 100},
    {"spot.obj", "OBJ", 2930, 5856},
    {"spot_soup.stl", "STL (binary)", 17388, 5796},
    {"teapot.obj", "OBJ", 3644, 6320},
    {"torus_far.ply", "PLY (binary, big endian)", 2304, 4608},
    {"truck.obj", "OBJ", 2956, 4770},
};

static void check_model(laves_context *context, const char *folder, const model *expected) {
  laves_error error = {0};
  char path[600];
  char *bytes;
  size_t length;
  snprintf(path, sizeof path, "%s/%s", folder, expected->name);
  assert_int_equal(laves__file_read(context, path, &bytes, &length, &error), LAVES_OK);
  laves__surface_input input;
  const double start = laves__wall_seconds();
  const laves_result result = laves__surface_parse(context, bytes, length, path, &input, &error);
  const double milliseconds = (laves__wall_seconds() - start) * 1e3;
  if (result != LAVES_OK) {
    fail_msg("%s", error.text);
  }
  print_message("%-24s %-28s %6zu %6zu %2d %7.2f ms\n", expected->name, input.format, input.point_count, input.triangle_count,
                input.tag_count, milliseconds);
  assert_string_equal(input.format, expected->format);
  assert_int_equal(input.point_count, expected->point_count);
  assert_int_equal(input.triangle_count, expected->triangle_count);
  laves__surface_input_free(context, &input);
  laves__free(context, bytes, length + 1, 1);
}

static void models_have_their_counts(void **state) {
  (void)state;
  const char *folder = getenv("LAVES_MODELS");
  char path[600];
  snprintf(path, sizeof path, "%s/bunny.obj", folder ? folder : "");
  FILE *file = folder ? fopen(path, "rb") : NULL;
  if (file == NULL) {
    print_message("skipped: no models in LAVES_MODELS\n");
    skip();
  }
  fclose(file);
  laves_context *context = laves_context_create(NULL);
  for (size_t i = 0; i < LAVES__COUNT_OF(MODELS); ++i) {
    check_model(context, folder, &MODELS[i]);
  }
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(models_have_their_counts)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
