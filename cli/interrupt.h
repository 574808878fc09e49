/* Ctrl-C and SIGTERM ask the work to stop; a second one stops the program at once. */
#ifndef LAVES_CLI_INTERRUPT_H
#define LAVES_CLI_INTERRUPT_H

#include <stdbool.h>

void interrupt_watch(void);
bool interrupt_asked(void);

#endif
