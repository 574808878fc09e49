/* A scalar image of three axes, as its reader collects it. */
#ifndef LAVES_IO_IMAGE_INPUT_H
#define LAVES_IO_IMAGE_INPUT_H

#include "base/base.h"
#include "base/vec3.h"

typedef struct laves__image_input {
  laves_context *context;
  const char *name;        /* of the file, for messages */
  const char *begin, *end; /* its bytes */
  size_t sizes[3];         /* samples along each axis, each 1 or more; their product is sample_count */
  laves__vec3 origin;      /* where sample (0, 0, 0) stands */
  laves__vec3 axes[3];     /* from a sample to the next along each axis; finite */
  float *narrow;           /* [sample_count], the first axis fastest, for types that fit a float, else NULL ... */
  double *wide;            /* ... and this is not; as the file has them, so perhaps NAN */
  size_t sample_count;
} laves__image_input;

static inline double laves__image_sample(const laves__image_input *image, size_t i) {
  return image->narrow ? (double)image->narrow[i] : image->wide[i];
}

/* NRRD with attached data, or a header whose data is in another file of the same folder. */
laves_result laves__read_nrrd(laves__image_input *image, laves_error *error);
void laves__image_input_free(laves__image_input *image);

#endif
