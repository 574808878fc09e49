/* Ctrl-C, SIGTERM and the end of --timeout ask the work to stop; a second signal stops the program at once. */
#ifndef LAVES_CLI_INTERRUPT_H
#define LAVES_CLI_INTERRUPT_H

#include <stdbool.h>

void interrupt_watch(void);
/* Asks the work to stop when so many seconds have passed. */
void interrupt_after(double seconds);

bool interrupt_asked(void);
/* Whether it was the time, and no signal, that asked first. */
bool interrupt_by_time(void);

#endif
