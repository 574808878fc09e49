/* Formats by name and extension. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "laves/laves.h"

static void test_names(void **state) {
  (void)state;
  for (int i = 0; i < LAVES_FORMAT_COUNT; i++) {
    const char *name = laves_format_name((laves_format)i);
    assert_non_null(name);
    assert_int_equal(laves_format_from_name(name), i);
  }
  assert_null(laves_format_name(LAVES_FORMAT_COUNT));
  assert_int_equal(laves_format_from_name("VTU"), LAVES_FORMAT_VTU);
  assert_int_equal(laves_format_from_name("gmsh"), LAVES_FORMAT_COUNT);
  assert_int_equal(laves_format_from_name(NULL), LAVES_FORMAT_COUNT);
}

static void test_extensions(void **state) {
  (void)state;
  assert_int_equal(laves_format_from_path("a/b.c/mesh.vtu"), LAVES_FORMAT_VTU);
  assert_int_equal(laves_format_from_path("mesh.MSH"), LAVES_FORMAT_GMSH41);
  assert_int_equal(laves_format_from_path("mesh.1.node"), LAVES_FORMAT_TETGEN);
  assert_int_equal(laves_format_from_path("mesh.meshb"), LAVES_FORMAT_MEDIT);
  assert_int_equal(laves_format_from_path("mesh.vtk"), LAVES_FORMAT_VTK);
  assert_int_equal(laves_format_from_path("mesh.hdf"), LAVES_FORMAT_VTKHDF);
  assert_int_equal(laves_format_from_path("mesh.e"), LAVES_FORMAT_EXODUS);
  assert_int_equal(laves_format_from_path("mesh.inp"), LAVES_FORMAT_ABAQUS);
  assert_int_equal(laves_format_from_path("mesh.nas"), LAVES_FORMAT_NASTRAN);
  assert_int_equal(laves_format_from_path("mesh.npz"), LAVES_FORMAT_NPZ);
  assert_int_equal(laves_format_from_path("mesh.off"), LAVES_FORMAT_OFF);
  assert_int_equal(laves_format_from_path("mesh"), LAVES_FORMAT_COUNT);
  assert_int_equal(laves_format_from_path("a.vtu/mesh"), LAVES_FORMAT_COUNT);
  assert_int_equal(laves_format_from_path("mesh."), LAVES_FORMAT_COUNT);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_names), cmocka_unit_test(test_extensions)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
