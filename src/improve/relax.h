/* The quick start. */
#ifndef LAVES_IMPROVE_RELAX_H
#define LAVES_IMPROVE_RELAX_H

#include "improve/measure.h"

/* Laplace sweeps over the surface vertices; where a sweep would make a tet worse than the worst was, its vertices stay.
 * Qualities must be up to date and stay so. LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__relax_surface(const laves__frame *frame, const laves__measure *measure, int sweeps, laves__layer *layer,
                                  laves_error *error);

#endif
