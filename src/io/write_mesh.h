/* The writers of mesh files, one function for each format.  They write to an open output, whose first failure sticks, so
 * they return nothing. Numbers in binary files are little-endian, as is every machine that this is built for. */
#ifndef LAVES_IO_WRITE_MESH_H
#define LAVES_IO_WRITE_MESH_H

#include "io/output.h"
#include "mesh/mesh.h"

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "binary files are written from memory as it stands");

/* compression: of zlib, 0 none .. 9. */
void laves__write_vtu(laves__output *out, const laves_mesh *mesh, bool ascii, int compression);
void laves__write_gmsh22(laves__output *out, const laves_mesh *mesh, bool ascii);
void laves__write_gmsh41(laves__output *out, const laves_mesh *mesh, bool ascii);
void laves__write_medit_text(laves__output *out, const laves_mesh *mesh);
void laves__write_medit_binary(laves__output *out, const laves_mesh *mesh);
void laves__write_tetgen_node(laves__output *out, const laves_mesh *mesh);
void laves__write_tetgen_ele(laves__output *out, const laves_mesh *mesh);
void laves__write_tetgen_face(laves__output *out, const laves_mesh *mesh);
void laves__write_vtk(laves__output *out, const laves_mesh *mesh, bool ascii);
void laves__write_abaqus(laves__output *out, const laves_mesh *mesh);
void laves__write_nastran(laves__output *out, const laves_mesh *mesh);
void laves__write_npz(laves__output *out, const laves_mesh *mesh);
void laves__write_dmtet(laves__output *out, const laves_mesh *mesh);
void laves__write_vtkhdf(laves__output *out, const laves_mesh *mesh);
void laves__write_exodus(laves__output *out, const laves_mesh *mesh);
/* An XDMF file and the HDF5 file beside it; `name` is that of the latter, without a folder. */
void laves__write_xdmf(laves__output *out, const laves_mesh *mesh, const char *name);
void laves__write_xdmf_data(laves__output *out, const laves_mesh *mesh);
void laves__write_stl_text(laves__output *out, const laves_mesh *mesh);
void laves__write_stl_binary(laves__output *out, const laves_mesh *mesh);
void laves__write_obj(laves__output *out, const laves_mesh *mesh);
void laves__write_ply(laves__output *out, const laves_mesh *mesh, bool ascii);
void laves__write_off(laves__output *out, const laves_mesh *mesh);

#endif
