/* Features that are kept, from the command line: --features, --feature-angle, --feature-tags, --no-keep-thin. */
#ifndef LAVES_CLI_FEATURES_H
#define LAVES_CLI_FEATURES_H

#include "session.h"

/* Reads the files that --features names.
 * @param features  out: NULL when there are none; free with laves_features_free() whatever the result */
laves_result features_open(session *run, laves_features **features);

/* Copies what was given into the library's options. */
void features_options(const settings *given, const laves_features *features, laves_options *options);

/* Writes the member "features": what was asked for. */
void features_write_json(json *out, const settings *given);

#endif
