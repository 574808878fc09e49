/* laves check --stream MESH: the check of a mesh that stays in its file. */
#ifndef LAVES_CLI_CHECK_STREAM_H
#define LAVES_CLI_CHECK_STREAM_H

#include "options.h"

/* @return the exit code */
int check_stream(const settings *given);

#endif
