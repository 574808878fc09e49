/* Arrays of numbers as text inside a page: predicted, split into planes of bytes, deflated, base64. */
#ifndef LAVES_CLI_REPORT_BLOCKS_H
#define LAVES_CLI_REPORT_BLOCKS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Bytes that are collected for one block. Zero it before its first use; `failed` is set once memory was short. */
typedef struct report_block {
  uint8_t *bytes;
  size_t count, capacity;
  bool failed;
} report_block;

/* Each appends what a reader finds again in the same order and of the same count. */
void report_block_bytes(report_block *block, const uint8_t *values, size_t count);
/* The low bytes of all, then the high ones. */
void report_block_shorts(report_block *block, const uint16_t *values, size_t count);
/* Four planes of bytes, the lowest first. */
void report_block_floats(report_block *block, const float *values, size_t count);
/* Differences to the value before, the first to zero, with the sign in the lowest bit, as four planes. */
void report_block_indices(report_block *block, const uint32_t *values, size_t count);

/* Writes the block as an element of the page that scripts find by `id`, and empties it. Failed writes show in ferror(file).
 * @return false when memory was short, now or while it was collected, or when the work is to stop */
bool report_block_write(FILE *file, const char *id, report_block *block);
void report_block_free(report_block *block);

#endif
