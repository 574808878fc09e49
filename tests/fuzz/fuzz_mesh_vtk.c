/* Fuzzes the reader of VTK's legacy files: any bytes must be read or refused, with nothing left behind. */
#include "fuzz/fuzz_mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) { return fuzz_mesh(bytes, length, laves__read_vtk, 500); }
