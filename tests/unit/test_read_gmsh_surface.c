/* Gmsh's files as surfaces: triangles, quadrangles, groups by their names. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/folders.h"
#include "fixtures/parse_surface.h"
#include "fixtures/tagged_cube.h"
#include "io/file.h"

#define NODES2 "$Nodes\n5\n10 0 0 0\n7 1 0 0\n3 1 1 0\n4 0 1 0\n99 5 5 5\n$EndNodes\n"
#define HEAD2 "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
#define NAMES2 "$PhysicalNames\n3\n2 5 \"the top\"\n3 6 \"solid\"\n1 6 \"edge\"\n$EndPhysicalNames\n"
#define ELEMENTS2 "$Elements\n4\n1 15 2 1 1 99\n2 3 2 5 1 10 7 3 4\n3 2 2 6 2 10 7 3\n4 9 2 0 9 10 3 4 7 7 7\n$EndElements\n"

/* A quadrangle, a triangle, one of second order; the node that none of them uses is left out. */
static void elements_become_faces(void **state) {
  (void)state;
  const small_file file = TEXT_FILE("a.msh", HEAD2 NAMES2 NODES2 ELEMENTS2);
  assert_surface(file, "Gmsh 2.2 (ASCII)", 4, 4);
  assert_triangles(file, (const uint32_t[]){0, 1, 2, 0, 2, 3, 0, 1, 2, 0, 2, 3}, 12);
  assert_tag_names(file, "the top,the top,surface 6,surface 9");
}

static void faces_know_their_elements(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves__surface_input input;
  parse_surface(context, TEXT_FILE("a.msh", HEAD2 NODES2 ELEMENTS2), &input);
  static const uint32_t SOURCES[] = {0, 0, 1, 2};
  assert_non_null(input.sources);
  assert_memory_equal(input.sources, SOURCES, sizeof SOURCES);
  laves__surface_input_free(context, &input);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void one_surface_without_a_name_is_no_tag(void **state) {
  (void)state;
  assert_tag_names(TEXT_FILE("a.msh", HEAD2 NODES2 "$Elements\n1\n1 2 2 6 2 10 7 3\n$EndElements\n"), "");
}

static void entities_of_version_4_have_groups(void **state) {
  (void)state;
  assert_tag_names(TEXT_FILE("a",
                             "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 8 \"skin\"\n$EndPhysicalNames\n"
                             "$Entities\n0 0 2 0\n1 0 0 0 1 1 0 1 8 0\n2 0 0 0 1 1 0 0 0\n$EndEntities\n"
                             "$Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n$EndNodes\n"
                             "$Elements\n2 2 1 2\n2 1 2 1\n1 1 2 3\n2 2 3 1\n2 1 2 3 4\n$EndElements\n"),
                   "skin,surface 2,surface 2");
}

/* The surface of a volume mesh, as laves writes it in every form. */
static void volume_meshes_give_their_triangles(void **state) {
  (void)state;
  static const struct {
    laves_format format;
    bool ascii;
    const char *name;
  } forms[] = {{LAVES_FORMAT_GMSH22, true, "Gmsh 2.2 (ASCII)"},
               {LAVES_FORMAT_GMSH22, false, "Gmsh 2.2 (binary)"},
               {LAVES_FORMAT_GMSH41, true, "Gmsh 4.1 (ASCII)"},
               {LAVES_FORMAT_GMSH41, false, "Gmsh 4.1 (binary)"}};
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 10];
  assert_true(fixture_folder_make(folder));
  snprintf(path, sizeof path, "%s/a.msh", folder);
  laves_context *context = laves_context_create(NULL);
  laves_mesh *mesh = fixture_tagged_cube(context, 4);
  for (size_t i = 0; i < LAVES__COUNT_OF(forms); i++) {
    laves_write_options options = laves_write_options_default();
    options.format = forms[i].format;
    options.ascii = forms[i].ascii;
    assert_int_equal(laves_mesh_write(context, mesh, path, &options, NULL), LAVES_OK);
    char *bytes;
    size_t length;
    assert_int_equal(laves__file_read(context, path, &bytes, &length, NULL), LAVES_OK);
    laves__surface_input input;
    parse_surface(context, (small_file){"a.msh", bytes, length}, &input);
    assert_string_equal(input.format, forms[i].name);
    assert_int_equal(input.triangle_count, mesh->face_count);
    assert_int_equal(input.point_count, 125 - 27);
    for (size_t f = 0; f < input.triangle_count; f++) {
      const uint32_t *t = input.triangles[f];
      const laves__vec3 sum = v3_add(input.points[t[0]], v3_add(input.points[t[1]], input.points[t[2]]));
      const int tag = fixture_cube_tag(v3_scale(sum, 1.0 / 3));
      char generated[20];
      snprintf(generated, sizeof generated, "boundary_%d", tag);
      assert_string_equal(input.tag_names[input.tags[f]], tag == 10 ? "x low" : tag == 11 ? "x high" : generated);
    }
    laves__surface_input_free(context, &input);
    laves__free(context, bytes, length + 1, 1);
  }
  laves_mesh_free(mesh);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
  fixture_folder_remove(folder);
}

static void faults_are_told(void **state) {
  (void)state;
  assert_refused(TEXT_FILE("a.msh", HEAD2 NODES2), "a.msh: the Gmsh 2.2 (ASCII) file has no faces");
  assert_refused(TEXT_FILE("a.msh", HEAD2 NODES2 "$Elements\n1\n1 2 2 6 2 10 7 8\n$EndElements\n"), "uses node 8");
  assert_refused(TEXT_FILE("a.msh", "$MeshFormat\n1.0 0 8\n$EndMeshFormat\n"), "version 1 of the Gmsh format");
}

static void damage_is_safe(void **state) {
  (void)state;
  const small_file file = TEXT_FILE("a.msh", HEAD2 NAMES2 NODES2 ELEMENTS2);
  assert_damage_is_safe(file);
  assert_short_memory_is_safe(file);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(elements_become_faces),
      cmocka_unit_test(faces_know_their_elements),
      cmocka_unit_test(one_surface_without_a_name_is_no_tag),
      cmocka_unit_test(entities_of_version_4_have_groups),
      cmocka_unit_test(volume_meshes_give_their_triangles),
      cmocka_unit_test(faults_are_told),
      cmocka_unit_test(damage_is_safe),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
