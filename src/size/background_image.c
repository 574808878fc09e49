/* Sizes between the samples of an image: trilinear, held at the border.
 *
 * A place becomes three sample numbers by the inverse of the axes, each held between the first and the last sample; the
 * eight samples around are blended. Outside this is the value at the nearest place of the image when the axes are at right
 * angles, and else at the place to which the axes lead. */
#include <float.h>

#include "size/background_parts.h"

enum { SAMPLES_PER_QUESTION = 1 << 20 }; /* between two questions whether to cancel */

/* Axes whose volume is less than this share of the product of their lengths are taken to lie in one plane; sample numbers
 * would then have less than half of the digits of a double. */
static const double least_volume_share = 1e-8;

static bool invert_axes(const laves__vec3 axes[3], laves__mat3 *inverse) {
  const laves__vec3 normals[3] = {v3_cross(axes[1], axes[2]), v3_cross(axes[2], axes[0]), v3_cross(axes[0], axes[1])};
  const double volume = v3_dot(axes[0], normals[0]);
  const double lengths = v3_norm(axes[0]) * v3_norm(axes[1]) * v3_norm(axes[2]);
  if (!(fabs(volume) > least_volume_share * lengths) || !(fabs(volume) > DBL_MIN) || !isfinite(lengths)) return false;
  for (int a = 0; a < 3; a++) inverse->row[a] = v3_scale(normals[a], 1 / volume);
  return v3_finite(inverse->row[0]) && v3_finite(inverse->row[1]) && v3_finite(inverse->row[2]);
}

static laves_result check_samples(const laves__image_input *image, laves_error *error) {
  for (size_t i = 0; i < image->sample_count; i++) {
    const double value = laves__image_sample(image, i);
    if (!(value > 0) || !isfinite(value))
      return laves__fail(error, LAVES_ERROR_INPUT,
                         "%s: sample (%zu, %zu, %zu), counted from 0, has the size %g; sizes must be greater than 0 and finite",
                         image->name, i % image->sizes[0], i / image->sizes[0] % image->sizes[1],
                         i / image->sizes[0] / image->sizes[1], value);
    if (i % SAMPLES_PER_QUESTION == SAMPLES_PER_QUESTION - 1 &&
        laves__cancelled(image->context, "read", (double)i / (double)image->sample_count))
      return laves__fail_cancelled(error);
  }
  return LAVES_OK;
}

laves_result laves__background_image_make(laves__image_input *input, laves__background_image *image, laves_error *error) {
  laves__mat3 to_index;
  if (!invert_axes(input->axes, &to_index))
    return laves__fail(error, LAVES_ERROR_INPUT, "%s: the axes of the image must not be zero, nor lie in one plane", input->name);
  const laves_result result = check_samples(input, error);
  if (result != LAVES_OK) return result;
  *image = (laves__background_image){.samples = *input, .to_index = to_index};
  image->samples.name = image->samples.begin = image->samples.end = NULL;
  input->narrow = NULL;
  input->wide = NULL;
  return LAVES_OK;
}

/* The sample before a place on an axis, and how far beyond it the place is: 0 to 1. Places that are no number go to 0. */
static size_t find_sample(double place, size_t size, double *beyond) {
  const double last = (double)(size - 1);
  const double held = place > 0 ? (place < last ? place : last) : 0;
  size_t before = (size_t)held;
  if (before + 1 >= size) before = size > 1 ? size - 2 : 0;
  *beyond = held - (double)before;
  return before;
}

static double blend(double a, double b, double t) { return t >= 1 ? b : a + t * (b - a); }

double laves__background_image_at(const laves__background_image *image, laves__vec3 p) {
  const laves__image_input *s = &image->samples;
  const laves__vec3 place = m3_mul(&image->to_index, v3_sub(p, s->origin));
  double t[3];
  const size_t i = find_sample(place.x, s->sizes[0], &t[0]);
  const size_t j = find_sample(place.y, s->sizes[1], &t[1]);
  const size_t k = find_sample(place.z, s->sizes[2], &t[2]);
  const size_t step_x = s->sizes[0] > 1, step_y = s->sizes[1] > 1 ? s->sizes[0] : 0;
  const size_t step_z = s->sizes[2] > 1 ? s->sizes[0] * s->sizes[1] : 0;
  const size_t first = i + s->sizes[0] * (j + s->sizes[1] * k);
  double layers[2];
  for (int z = 0; z < 2; z++) {
    const size_t low = first + (z ? step_z : 0), high = low + step_y;
    layers[z] = blend(blend(laves__image_sample(s, low), laves__image_sample(s, low + step_x), t[0]),
                      blend(laves__image_sample(s, high), laves__image_sample(s, high + step_x), t[0]), t[1]);
  }
  return blend(layers[0], layers[1], t[2]);
}
