/* Points and polylines of a file, of any format that can hold them. */
#ifndef LAVES_IO_READ_LINES_H
#define LAVES_IO_READ_LINES_H

#include "base/vec3.h"
#include "io/line_list.h"
#include "io/mesh_input.h"

typedef struct laves__lines {
  laves_context *context;
  laves__vec3 *points; /* finite; some may be used by nothing */
  size_t point_count, point_capacity;
  laves__line_list list; /* indices are in range, loose pieces joined, and there is something in it */
} laves__lines;

/* Finds the format from the content and reads it; `name` for messages. Free the lines in any case.
 * LAVES_ERROR_INPUT, LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__lines_parse(laves_context *context, const char *name, const char *bytes, size_t length, laves__lines *lines,
                                laves_error *error);
/* The same of a file. */
laves_result laves__lines_read(laves_context *context, const char *path, laves__lines *lines, laves_error *error);
void laves__lines_free(laves__lines *lines);

/* The readers, one for each format; laves__read_gmsh() and laves__read_vtu() are in mesh_input.h. input->lines is set. */
laves_result laves__read_lines_text(laves__mesh_input *input, laves_error *error);
laves_result laves__read_lines_obj(laves__mesh_input *input, laves_error *error);
laves_result laves__read_lines_vtk(laves__mesh_input *input, laves_error *error);

#endif
