/* Sizes from a file: a background mesh or image with a number at each place, the wished edge length there.
 *
 * docs/size-files.md tells users of formats, units and interpolation. Sizes are finite and greater than 0, at every place
 * asked for, and but for rounding never less or more than those in the file. */
#ifndef LAVES_SIZE_BACKGROUND_H
#define LAVES_SIZE_BACKGROUND_H

#include "base/base.h"
#include "base/vec3.h"

typedef struct laves__background_sizes laves__background_sizes;

/* Reads NRRD, VTU, Gmsh .msh or .pos, told apart by their content.
 * array_name: of the array or view with the sizes; NULL: the only one in the file, or else the one named "size". NRRD has
 *   one array without a name, so there it must be NULL.
 * sizes out: free with laves__background_free() before the context; NULL on failure.
 * LAVES_ERROR_INPUT when the file is none of these, damaged, has no such array (the sentence lists the names) or a size that
 * is not finite or not greater than 0; LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED.
 * Cost: n log n for tets and points, n for images. */
laves_result laves__background_load(laves_context *context, const char *path, const char *array_name,
                                    laves__background_sizes **sizes, laves_error *error);

/* The same from the bytes of a file; `name` is its path, for messages and for the data that an NRRD header keeps elsewhere. */
laves_result laves__background_parse(laves_context *context, const char *name, const char *bytes, size_t length,
                                     const char *array_name, laves__background_sizes **sizes, laves_error *error);

/* Sizes at points in the coordinates of the file. Linear within the tet, constant where the file has one number for each tet,
 * trilinear between the samples of an image, the number of the nearest point where the file has points alone; outside: of
 * the nearest place of the background. Callable from many threads at once; about 1 us a point, more for points far outside. */
void laves__background_evaluate(const laves__background_sizes *background, size_t count, const laves__vec3 *points,
                                double *sizes);

/* NULL is allowed. */
void laves__background_free(laves__background_sizes *background);

#endif
