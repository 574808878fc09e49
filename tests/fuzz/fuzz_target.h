/* The one function of a fuzz target, called by libFuzzer and by replay.c. */
#ifndef LAVES_FUZZ_TARGET_H
#define LAVES_FUZZ_TARGET_H

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

#endif
