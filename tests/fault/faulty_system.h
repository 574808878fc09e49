/* System calls of the library that fail on demand: those of programs linked with --wrap for each of them. */
#ifndef LAVES_FAULT_FAULTY_SYSTEM_H
#define LAVES_FAULT_FAULTY_SYSTEM_H

#include <stdbool.h>
#include <stddef.h>

typedef enum faulty_call { FAULTY_OPEN, FAULTY_WRITE, FAULTY_CLOSE, FAULTY_RENAME, FAULTY_LINK, FAULTY_CALL_COUNT } faulty_call;

typedef struct faulty_system {
  faulty_call call; /* that fails */
  int fails_at;     /* which of those calls, from 1; 0: none */
  int reason;       /* errno then */
  size_t room;      /* bytes that can be written before the disk is full; SIZE_MAX: no limit */
  bool dribbles;    /* writes take a few bytes only, and every other one is interrupted */
  int calls[FAULTY_CALL_COUNT];
  int uncached; /* writes that went past the system's cache */
} faulty_system;

/* What all calls look at. */
extern faulty_system faulty;

/* The machine has no memory to speak of, so that all files are large for it. Not reset. */
extern bool faulty_tiny_machine;

/* Nothing fails; calls are counted anew. */
void faulty_reset(void);

extern const char *const faulty_call_names[FAULTY_CALL_COUNT];

#endif
