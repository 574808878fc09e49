/* What a mesh will cost before it is made: tets, vertices, memory and time from volume, area and size. */
#ifndef LAVES_CLI_ESTIMATE_H
#define LAVES_CLI_ESTIMATE_H

#include "input.h"

typedef struct estimate {
  double volume, area; /* of the domain; sampled where the input does not say */
  bool sampled;
  double size;
  double tets, vertices;
  double bytes, cpu_seconds; /* of meshing, rough */
} estimate;

/* By the size options of the run; without one: about 50 thousand tets. Takes about a second at most.
 * @return false when the domain is empty as far as the samples tell */
bool estimate_make(session *run, const input *in, estimate *result);

/* What the library expects: the memory and, from its creases, the time; where sizes vary, also sizes and counts in the place of
 * those above. */
laves_result estimate_expect(session *run, const input *in, const laves_sizing *sizing, const laves_features *features,
                             estimate *result);

void estimate_write_json(json *out, const estimate *result);

#endif
