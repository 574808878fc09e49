/* Numbers in the byte order of the network, for the formats that have it: legacy VTK and NetCDF. */
#ifndef LAVES_IO_BIG_ENDIAN_H
#define LAVES_IO_BIG_ENDIAN_H

#include <stdint.h>
#include <string.h>

static inline void laves__put_big32(char *bytes, uint32_t value) {
  const uint32_t swapped = __builtin_bswap32(value);
  memcpy(bytes, &swapped, sizeof swapped);
}

static inline void laves__put_big64(char *bytes, uint64_t value) {
  const uint64_t swapped = __builtin_bswap64(value);
  memcpy(bytes, &swapped, sizeof swapped);
}

static inline void laves__put_big_double(char *bytes, double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  laves__put_big64(bytes, bits);
}

#endif
