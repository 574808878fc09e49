/* Arrays of a mesh as little-endian rows, for laves__output_rows(): `user` is the mesh, which may be streamed. For the formats
 * that hold whole arrays: VTKHDF, XDMF, NumPy's. */
#ifndef LAVES_IO_MESH_PACK_H
#define LAVES_IO_MESH_PACK_H

#include <stddef.h>

size_t laves__pack_points(const void *user, size_t begin, size_t end, char *bytes); /* double[3] */
size_t laves__pack_tets(const void *user, size_t begin, size_t end,
                        char *bytes); /* int32_t[4], or [10] of a mesh of second order */
/* Cell data of all cells (io/mesh_cells.h): int32_t, uint8_t, int32_t. */
size_t laves__pack_cell_regions(const void *user, size_t begin, size_t end, char *bytes);
size_t laves__pack_cell_classes(const void *user, size_t begin, size_t end, char *bytes);
size_t laves__pack_cell_sources(const void *user, size_t begin, size_t end, char *bytes);

#endif
