/* The symmetries of the tiling, checked exactly: a few tets stand for all. */
#ifndef LAVES_TESTS_PROOF_SYMMETRY_H
#define LAVES_TESTS_PROOF_SYMMETRY_H

#include "background/c15_table.h"

/* Finds tets such that each of the 136 is the image of one of them under an isometry that carries the whole tiling to
 * itself: sites to sites of the same kind, edges to edges, tets to tets. Returns how many; *isometries counts the isometries
 * up to periods, and orbit[i] how many tets `representative[i]` stands for. */
int find_representatives(int representative[LAVES__C15_TETS], int orbit[LAVES__C15_TETS], int *isometries);

#endif
