/* An allocator that refuses on demand, and counts what it gave. One thread. */
#ifndef LAVES_FAULT_REFUSER_H
#define LAVES_FAULT_REFUSER_H

#include <stdbool.h>
#include <stddef.h>

#include "laves/laves.h"

typedef struct refuser {
  size_t asked;    /* how many blocks were asked for, or asked to be resized */
  size_t refused;  /* which of them is refused, from 1; 0: none */
  bool for_good;   /* all that follow are refused too, as on a machine whose memory is used up */
  size_t blocks;   /* held now */
  size_t mistakes; /* blocks given back with a size that they never had */
} refuser;

/* A context of one thread whose memory comes from the refuser. */
laves_context *refuser_context(refuser *r);

#endif
