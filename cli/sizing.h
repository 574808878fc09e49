/* Sizes that vary, from the command line: --size-field, --refine, and the numbers beside them. */
#ifndef LAVES_CLI_SIZING_H
#define LAVES_CLI_SIZING_H

#include "session.h"

/* Reads and checks the sources that --size-field and --refine name.
 * @param sizing  out: NULL when there are none; free with laves_sizing_free() whatever the result */
laves_result sizing_open(session *run, laves_sizing **sizing);

/* Copies the size options given into the library's; the input's box is for those that are fractions of it. */
void sizing_options(const settings *given, const laves_sizing *sizing, const laves_domain_info *info, laves_options *options);

/* Whether anything of it was given that makes sizes vary. */
bool sizing_is_asked(const settings *given);

/* Writes the member "sizing": what was asked for. */
void sizing_write_json(json *out, const settings *given);

#endif
