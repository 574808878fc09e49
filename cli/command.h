/* The commands: each takes what the command line said and returns the exit code. */
#ifndef LAVES_CLI_COMMAND_H
#define LAVES_CLI_COMMAND_H

#include "options.h"

int command_mesh(const settings *given);
int command_check(const settings *given);
int command_improve(const settings *given);
int command_info(const settings *given);
int command_tiling(const settings *given);
int command_view(const settings *given);
int command_report(const settings *given);

#endif
