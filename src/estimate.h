/* Counts of a graded mesh from the leaves of its octree, for laves_estimate() and for the pipeline's first guess; and whether a
 * mesh of one size will fit into memory. */
#ifndef LAVES_ESTIMATE_H
#define LAVES_ESTIMATE_H

#include "graded/wishes.h"

/* Stretches the frame, and with it all sizes, until the estimate meets the count that is asked for, if one is; the counts at
 * the end. LAVES_ERROR_INPUT when a source of sizes failed, LAVES_ERROR_OPTION, LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED. */
laves_result laves__estimate_graded(laves_context *context, const laves_options *options, laves__wishes *wishes,
                                    laves__frame *frame, laves_expectation *counts, laves_error *error);

/* LAVES_ERROR_MEMORY, with a size that fits, when a mesh of one size cannot be within the context's limit; LAVES_ERROR_CANCELLED.
 */
laves_result laves__refuse_uniform(laves_context *context, const laves_options *options, const laves__oracle *oracle,
                                   double volume, double size, laves_error *error);

#endif
