/* Writes one small mesh in every format into a folder, for other programs to read: write_formats FOLDER.
 * The unit cube with two regions and six face tags; see tests/fixtures/tagged_cube.h. */
#include <stdio.h>

#include "fixtures/tagged_cube.h"

static const struct {
  const char *name;
  laves_format format;
  bool ascii;
  int compression;
} files[] = {
    {"zlib.vtu", LAVES_FORMAT_VTU, false, 1},       {"raw.vtu", LAVES_FORMAT_VTU, false, 0},
    {"ascii.vtu", LAVES_FORMAT_VTU, true, 0},       {"binary22.msh", LAVES_FORMAT_GMSH22, false, 0},
    {"ascii22.msh", LAVES_FORMAT_GMSH22, true, 0},  {"binary41.msh", LAVES_FORMAT_GMSH41, false, 0},
    {"ascii41.msh", LAVES_FORMAT_GMSH41, true, 0},  {"text.mesh", LAVES_FORMAT_MEDIT, true, 0},
    {"binary.meshb", LAVES_FORMAT_MEDIT, false, 0}, {"tetgen.node", LAVES_FORMAT_TETGEN, true, 0},
    {"mesh.vtkhdf", LAVES_FORMAT_VTKHDF, false, 0}, {"binary.vtk", LAVES_FORMAT_VTK, false, 0},
    {"ascii.vtk", LAVES_FORMAT_VTK, true, 0},       {"mesh.xdmf", LAVES_FORMAT_XDMF, false, 0},
    {"mesh.exo", LAVES_FORMAT_EXODUS, false, 0},    {"text.inp", LAVES_FORMAT_ABAQUS, true, 0},
    {"text.bdf", LAVES_FORMAT_NASTRAN, true, 0},    {"mesh.npz", LAVES_FORMAT_NPZ, false, 0},
    {"grid.npz", LAVES_FORMAT_DMTET, false, 0},     {"binary.stl", LAVES_FORMAT_STL, false, 0},
    {"ascii.stl", LAVES_FORMAT_STL, true, 0},       {"text.obj", LAVES_FORMAT_OBJ, true, 0},
    {"binary.ply", LAVES_FORMAT_PLY, false, 0},     {"ascii.ply", LAVES_FORMAT_PLY, true, 0},
    {"text.off", LAVES_FORMAT_OFF, true, 0},
};

static int write_all(laves_context *context, const laves_mesh *mesh, const char *folder, const char *prefix) {
  for (size_t i = 0; i < LAVES__COUNT_OF(files); i++) {
    char path[1000];
    snprintf(path, sizeof path, "%s/%s-%s", folder, prefix, files[i].name);
    laves_write_options options = laves_write_options_default();
    options.format = files[i].format;
    options.ascii = files[i].ascii;
    options.compression = files[i].compression;
    laves_error error;
    if (laves_mesh_write(context, mesh, path, &options, &error) == LAVES_OK) continue;
    fprintf(stderr, "%s: %s\n", path, error.text);
    return 1;
  }
  return 0;
}

int main(int argc, char **argv) {
  if (argc != 2) return 1;
  laves_context *context = laves_context_create(NULL);
  laves_mesh *plain = fixture_plain_cube(context, 6), *tagged = fixture_tagged_cube(context, 6);
  const int failed = write_all(context, plain, argv[1], "plain") || write_all(context, tagged, argv[1], "tagged");
  laves_mesh_free(plain);
  laves_mesh_free(tagged);
  laves_context_free(context);
  return failed;
}
