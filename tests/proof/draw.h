/* Pictures for docs/proof.md. */
#ifndef LAVES_TESTS_PROOF_DRAW_H
#define LAVES_TESTS_PROOF_DRAW_H

#include "sample.h"

/* Writes FOLDER/NAME.vtu, a mesh with two parts: the background tet as it was, and the pieces that became of it. */
bool draw_extreme(const extreme *e, const char *folder, const char *name);

#endif
