/* The size of elements over space: what the user asks for, made into numbers that the graded background can use.
 *
 * Two kinds of answers, which the caller combines by minimum and limits in gradient: sources that can be asked anywhere
 * (laves__size_evaluate), and samples on the surface (laves__size_samples). Coordinates are local to the domain's oracle: input
 * minus origin. Sizes are edge lengths in the units of the input. */
#ifndef LAVES_SIZE_SIZE_H
#define LAVES_SIZE_SIZE_H

#include "domain/oracle.h"

typedef struct laves__size laves__size;

typedef struct laves__size_sample {
  laves__vec3 point;
  double size;
} laves__size_sample;

/* Binds options to a domain; both must outlive the result. base_size: the size that was asked for, resolved to a length.
 * LAVES_ERROR_OPTION (min_size above size, and the like), LAVES_ERROR_INPUT (no such tag, a source that yields no size),
 * LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__size_create(laves_context *context, const laves_domain *domain, const laves_options *options,
                                double base_size, laves__size **size, laves_error *error);
void laves__size_free(laves__size *size);

/* True when the size is laves__size_ceiling() everywhere, which may be less than base_size: then the uniform tiling serves. */
bool laves__size_is_constant(const laves__size *size);

/* sizes[i] at points[i]: the least of the sources that can be asked anywhere, from floor to ceiling; never NaN. Its slope is
 * not limited. Callable from many threads; best with some hundred points at once that lie near one another. */
void laves__size_evaluate(const laves__size *size, size_t count, const laves__vec3 *points, double *sizes);

/* LAVES_OK, or LAVES_ERROR_INPUT when an evaluation so far met a place inside the domain where a source yields no size; the
 * same place for any number of threads. To be asked once after the last evaluation. */
laves_result laves__size_status(const laves__size *size, laves_error *error);

/* What curvature, thickness, features and distance ask for, at points of the surface, below the ceiling only. Where they ask
 * for a size h, samples stand about 0.7 h apart. Sorted, the same for any number of threads. *samples: NULL when there
 * are none, else *count of them, to be freed with laves__free(context, samples, count, sizeof *samples). */
laves_result laves__size_samples(const laves__size *size, laves__size_sample **samples, size_t *count, laves_error *error);

double laves__size_grading(const laves__size *size); /* largest slope of the size */
double laves__size_floor(const laves__size *size);   /* no size is less */
double laves__size_ceiling(const laves__size *size); /* no size is more */

#endif
