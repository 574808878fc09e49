/* Creases of a surface: edges between triangles that are turned against one another, or that have different tags. */
#include "domain/features.h"

laves_result laves__features_of_surface(const laves__feature_wish *wish, laves__features *features, laves__feature_lines *lines,
                                        laves_error *error) {
  (void)wish;
  (void)features;
  (void)lines;
  (void)error;
  return LAVES_OK;
}
