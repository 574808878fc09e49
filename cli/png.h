/* Writes a picture as a PNG file. */
#ifndef LAVES_CLI_PNG_H
#define LAVES_CLI_PNG_H

#include <stdbool.h>
#include <stdint.h>

/* Writes rows from top to bottom, whole or not at all (whole_file.h).
 * `pixels`: uint8_t[height][width][channels], channels 3 (RGB) or 4 (RGBA, not premultiplied), sRGB.
 * Returns false when the file cannot be written or memory is short; errno tells which. */
bool png_write(const char *path, const uint8_t *pixels, int width, int height, int channels);

#endif
