/* Points and lines that the solids of a script carry along: keep() in docs/implicit.md.
 *
 * A shape names what it carries by a number, 0 for nothing. Numbers are nodes of a graph in the store of expressions: what was
 * drawn, two of them together, one of them moved; so copies cost nothing until the script has ended and all is listed. A
 * failed call returns 0 and leaves its reason in the store. Not thread-safe. */
#ifndef LAVES_DOMAIN_KEPT_H
#define LAVES_DOMAIN_KEPT_H

#include "domain/expression.h"

/* The most points of what one shape carries, copies counted, and nodes of a store. */
#define LAVES__KEPT_LIMIT 1000000u

/* What is drawn next; laves__kept_take() makes all since its last call a node. Lines of fewer than two vertices are none. */
bool laves__kept_add_point(laves__expression *e, laves__vec3 point);
bool laves__kept_add_vertex(laves__expression *e, laves__vec3 vertex);
bool laves__kept_end_line(laves__expression *e);
uint32_t laves__kept_take(laves__expression *e);

uint32_t laves__kept_both(laves__expression *e, uint32_t a, uint32_t b);
uint32_t laves__kept_moved(laves__expression *e, uint32_t a, const laves__affine *map);

/* Whether some call found too many points. */
bool laves__kept_is_too_large(const laves__expression *e);
/* All points and lines that a node means; *features is NULL where it means none, else the caller's. */
laves_result laves__kept_list(laves__expression *e, uint32_t kept, laves_features **features, laves_error *error);
void laves__kept_free(laves__expression *e);

#endif
