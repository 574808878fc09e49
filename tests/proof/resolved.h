/* What the rule makes of resolved surfaces: measured, not proved. */
#ifndef LAVES_TESTS_PROOF_RESOLVED_H
#define LAVES_TESTS_PROOF_RESOLVED_H

#include "stuff/rule.h"

/* Prints the smallest and largest dihedral angles found for planes, and for balls and cavities of a few radii over the size. */
void print_resolved(const laves__guarantee *guarantee);

#endif
