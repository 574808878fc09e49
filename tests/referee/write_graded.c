/* Writes a graded background for the referee of certificates: write_graded FILE.msh, in Gmsh 2.2 as text. */
#include <stdio.h>

#include "background/graph.h"
#include "fixtures/graded.h"

int main(int argc, char **argv) {
  if (argc != 2) return 1;
  laves_context *context = laves_context_create(NULL);
  size_t tiles[3];
  laves_mesh *mesh = fixture_graded(context, tiles);
  laves_write_options options = laves_write_options_default();
  options.format = LAVES_FORMAT_GMSH22;
  options.ascii = true;
  laves_error error;
  const laves_result result = laves_mesh_write(context, mesh, argv[1], &options, &error);
  if (result != LAVES_OK) fprintf(stderr, "%s: %s\n", argv[1], error.text);
  printf("%zu %zu\n", tiles[LAVES__TILE_C15], tiles[LAVES__TILE_BCC]);
  laves_mesh_free(mesh);
  laves_context_free(context);
  return result != LAVES_OK;
}
