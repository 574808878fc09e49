/* What the user asked (laves_options) made into what the pipeline needs. */
#ifndef LAVES_OPTIONS_H
#define LAVES_OPTIONS_H

#include "domain/frame.h"
#include "stuff/rule.h"

/* Checks the options: LAVES_ERROR_OPTION with a sentence that names the option and its range. */
laves_result laves__options_check(const laves_options *options, laves_error *error);

/* The guarantee whose rule stuffing follows, which is promised unless 0 was asked for; NULL: nothing is stuffed. */
const laves__guarantee *laves__options_guarantee(const laves_options *options);

/* The rotation of the lattice that the options ask for. */
laves__mat3 laves__options_rotation(const laves_options *options, const laves__oracle *oracle);

/* The size that gives about the wished number of tets or vertices for a volume and area (NAN: unknown), from what one unit
 * of volume and of surface hold; or the size given. */
double laves__options_size(const laves_options *options, const laves__oracle *oracle, double volume);

/* Whether a count must be met, and if so the factor by which the size must change to meet it: 1 when `tets` and
 * `vertices` are near enough. */
double laves__options_correction(const laves_options *options, int64_t tets, int64_t vertices);

#endif
