/* Fuzzes Gmsh's files as surfaces: any bytes must be read or refused, with nothing left behind. */
#include "fuzz/fuzz_surface.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) { return fuzz_surface(bytes, length, "input.msh"); }
