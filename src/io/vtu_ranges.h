/* VTU files of any size, read by ranges. */
#ifndef LAVES_IO_VTU_RANGES_H
#define LAVES_IO_VTU_RANGES_H

#include "mesh/mesh_stream.h"

/* Opens a file with appended raw data, plain or compressed, in one piece; anything else is refused with a sentence. It takes
 * half a MiB, and for compressed files a block of each array and 8 bytes for every block.
 * *stream: free with laves__vtu_ranges_close(); NULL on failure. `path` must outlive it. */
laves_result laves__vtu_ranges_open(laves_context *context, const char *path, laves__mesh_stream **stream, laves_error *error);
void laves__vtu_ranges_close(laves__mesh_stream *stream);

#endif
