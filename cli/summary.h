/* What people read when a command has run: the input, the mesh, its angles. All on stderr. */
#ifndef LAVES_CLI_SUMMARY_H
#define LAVES_CLI_SUMMARY_H

#include "input.h"
#include "json.h"
#include "laves/laves.h"

/* One line on what the input is; then its defects, in one line or, when `all`, each on its own with a place. */
void summary_input(const input *in, bool all);

/* Topology and quality of a mesh, then the histogram. */
void summary_check(const laves_check *check);

/* All of a checked mesh: its file's name, counts, whether it is valid and why not, then the above. */
void summary_verdict(const char *path, const laves_check *check);

/* Why a mesh is not valid; nothing for a valid one. */
void summary_faults(const laves_check *check);

/* A line with the dihedral angles as a row of blocks, the height of each the logarithm of its count. */
void summary_histogram(const size_t bins[LAVES_HISTOGRAM_BINS]);

/* The members of a checked mesh in a JSON object. */
void summary_check_json(json *out, const laves_check *check);

#endif
