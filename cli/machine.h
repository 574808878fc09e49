/* What the machine has. */
#ifndef LAVES_CLI_MACHINE_H
#define LAVES_CLI_MACHINE_H

#include <stdint.h>

/* Bytes of memory that the program may take without pushing the machine into swapping or being killed: the least of the machine's
 * memory, of the control group's limit (containers) and of the limit on the address space; 0 when none of them can be told. */
int64_t machine_memory(void);

#endif
