/* What a mesh file holds, as its reader collects it, and the mesh made from that. */
#ifndef LAVES_IO_MESH_INPUT_H
#define LAVES_IO_MESH_INPUT_H

#include "io/scan.h"
#include "mesh/mesh.h"

struct laves__line_list;

/* Numbers that a file holds beside its mesh, such as sizes, for readers that are asked for them. */
typedef struct laves__mesh_values {
  bool wanted;
  const char *array; /* the name of the array; NULL: the only one of the file, or else the one named "size" */
  bool per_tet;      /* one for each tet, else one for each point */
  double *items;     /* NAN where the file has none */
  size_t count, capacity;
} laves__mesh_values;

typedef struct laves__mesh_input {
  laves_context *context;
  const char *name;        /* of the file, for messages */
  const char *begin, *end; /* its bytes */
  laves__vec3 *points;
  size_t point_count, point_capacity;
  int32_t (*tets)[4];
  int32_t *regions;
  size_t tet_count, tet_capacity, region_capacity;
  int32_t (*faces)[3]; /* triangles of the file, whether on the boundary or not */
  int32_t *face_tags;
  size_t face_count, face_capacity, face_tag_capacity;
  bool polygons; /* wanted, as of a surface: quadrangles come as two triangles, and face_elements is filled (Gmsh only) */
  int32_t *face_elements; /* [face_count] of which of the file's elements of a surface, from 0, each is a part */
  size_t face_element_capacity;
  laves__group *groups;
  size_t group_count, group_capacity;
  laves__mesh_values values;      /* read by VTU, Gmsh and .pos only */
  struct laves__line_list *lines; /* point and line elements, by VTU and Gmsh only; NULL: they are passed over */
  bool higher_order;              /* elements had more nodes than corners: vertices that are no corner are dropped */
} laves__mesh_input;

/* The adders return false when memory is short. Corners count from 0 and are checked at the end. */
bool laves__mesh_input_add_point(laves__mesh_input *input, laves__vec3 point);
bool laves__mesh_input_add_tet(laves__mesh_input *input, const int32_t corners[4], int32_t region);
bool laves__mesh_input_add_face(laves__mesh_input *input, const int32_t corners[3], int32_t tag);
bool laves__mesh_input_add_value(laves__mesh_input *input, double value);
/* `length` bytes of name; cut when long. */
bool laves__mesh_input_add_group(laves__mesh_input *input, int dimension, int32_t tag, const char *name, size_t length);

/* Finds which of the arrays that a file has is meant by values.array; names may come more than once, and the first is
 * taken. The sentence of a failure lists the names. */
laves_result laves__mesh_input_choose_array(const laves__mesh_input *input, const laves__word *names, size_t count,
                                            size_t *chosen, laves_error *error);

/* Whether the text is among the first few thousand bytes, where a file says what it is. */
bool laves__mesh_input_mentions(const laves__mesh_input *input, const char *text);
/* Asks whether to cancel, telling how far reading has come; `at` is the place in the file. Call it every few ten thousand
 * items. */
bool laves__mesh_input_cancelled(const laves__mesh_input *input, const char *at);
/* LAVES_ERROR_INPUT with "name: sentence". */
laves_result laves__mesh_input_fail(const laves__mesh_input *input, laves_error *error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* There are tets, their corners exist, and all coordinates are finite. */
laves_result laves__mesh_input_check(const laves__mesh_input *input, laves_error *error);
/* Makes the mesh: checks, finds the boundary, gives its faces the tags of the triangles that coincide with them (0 where there is
 * none; no tags at all where the file has no triangles), and adds the names. Where every tet is negative, which is some
 * programs' convention, all are turned. */
laves_result laves__mesh_input_finish(laves__mesh_input *input, laves_mesh **mesh, laves_error *error);
void laves__mesh_input_free(laves__mesh_input *input);

/* The readers, one for each format. */
laves_result laves__read_vtu(laves__mesh_input *input, laves_error *error);
laves_result laves__read_gmsh(laves__mesh_input *input, laves_error *error);
laves_result laves__read_medit_text(laves__mesh_input *input, laves_error *error);
laves_result laves__read_medit_binary(laves__mesh_input *input, laves_error *error);
/* VTK's legacy unstructured grids, and Abaqus's input files. */
laves_result laves__read_vtk(laves__mesh_input *input, laves_error *error);
laves_result laves__read_abaqus(laves__mesh_input *input, laves_error *error);
/* Gmsh's parsed post-processing views: values are required; tets that share no point, or points alone. */
laves_result laves__read_pos(laves__mesh_input *input, laves_error *error);
/* The three files of TetGen one after the other; each sets begin and end first. `base` is the number of the first point,
 * found by the first. */
laves_result laves__read_tetgen_node(laves__mesh_input *input, int64_t *base, laves_error *error);
laves_result laves__read_tetgen_ele(laves__mesh_input *input, int64_t base, laves_error *error);
laves_result laves__read_tetgen_face(laves__mesh_input *input, int64_t base, laves_error *error);

#endif
