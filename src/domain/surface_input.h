/* A triangle surface as a file gave it, before it is welded and judged.  Filled by io/read_surface*.c. */
#ifndef LAVES_DOMAIN_SURFACE_INPUT_H
#define LAVES_DOMAIN_SURFACE_INPUT_H

#include "base/base.h"
#include "base/vec3.h"

typedef struct laves__surface_input {
  laves__vec3 *points; /* input coordinates, all finite */
  size_t point_count, point_capacity;
  uint32_t (*triangles)[3]; /* indices into points, all in range; may be degenerate */
  size_t triangle_count, triangle_capacity;
  int32_t *tags;    /* [triangle_capacity] index into tag_names for each triangle, or NULL */
  char **tag_names; /* tag_count of them, each allocated with its length + 1; NULL: none */
  int tag_count;
  uint32_t
      *sources; /* [triangle_capacity] the face of the file that each triangle is a part of, from 0; NULL: all are themselves */
  char format[48]; /* "STL (binary)", ... */
} laves__surface_input;

void laves__surface_input_free(laves_context *context, laves__surface_input *input);
/* Frees all but the names of tags and the format; the counts stay. */
void laves__surface_input_free_arrays(laves_context *context, laves__surface_input *input);

/* Reads a surface from `bytes` (a whole file); the format is found from the content, `name` is for messages and a
 * last resort. On failure input is empty and error says what is wrong and where (line or byte). */
laves_result laves__surface_parse(laves_context *context, const void *bytes, size_t length, const char *name,
                                  laves__surface_input *input, laves_error *error);

#endif
