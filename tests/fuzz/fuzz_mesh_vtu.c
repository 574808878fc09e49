/* Fuzzes the reader of VTU: any bytes must be read or refused, with nothing left behind. A compressed byte may become 1032,
 * and a number of one byte an index or coordinate in arrays that grow by doubling. */
#include "fuzz/fuzz_mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) { return fuzz_mesh(bytes, length, laves__read_vtu, 60000); }
